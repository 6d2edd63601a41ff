"""Correlation of the displacements of two structures on one ground, by every method."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any, Literal, NamedTuple

import xarray as xr

from stochlin.kernels.basics.parallel import Progress
from stochlin.models.arguments import Paths, RelaxationTimes, Seed, StepsPerPeriod, Truth, checked
from stochlin.models.grounds import Ground
from stochlin.models.parameters import Model
from stochlin.models.rules.effective_properties import EffectiveRule, effective_rule
from stochlin.models.structures import DRIFT, Structure
from stochlin.solver.correlation.equation_4 import EQ_4, by_eq_4, effective_pair
from stochlin.solver.correlation.pairs import DIFFERENCE, difference, linearized_pairs
from stochlin.solver.linearization.equivalent_systems import (
    STRUCTURE_VARIABLES,
    Solved,
    check_closure,
    solved_together,
)
from stochlin.solver.linearization.linearization import caution_in_words
from stochlin.solver.tables import labels
from stochlin.solver.tables.checks import Tolerance, check_table
from stochlin.solver.tables.lazy import Cells, in_blocks, is_lazy

Method = Literal["linearization", "white_noise", "effective", "simulation"]


@checked
def correlate(
    first: Structure,
    second: Structure,
    ground: Ground,
    method: Method = "linearization",
    *,
    closure: str = "gaussian",
    rule: str | EffectiveRule = "iwan_1980",
    bias: Truth = True,
    rtol: float = 1e-10,
    max_iterations: int = 200,
    paths: Paths = 256,
    seed: Seed = 0,
    steps_per_period: StepsPerPeriod = 32,
    relaxation_times: RelaxationTimes = 20.0,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Correlation coefficient of the displacements of two structures.

    By linearization, each structure is solved over its own dimensions, and the correlation of a
    pair then follows from one linear equation. A table of ``N1 x N2`` pairs needs ``N1 + N2``
    iterative solutions.

    If a parameter is a dask array, the table is lazy, with the same chunks, and has the same
    numbers; those of the drift closure, and so the biases, agree to about 1e-9, but for the
    difference of nearly equal structures, which magnifies rounding. By simulation it is computed at
    once.

    Parameters
    ----------
    first, second : Bilinear, BoucWen or Hysteretic
        The two structures. For buildings with storeys `linearize_system` and `simulate` have
        ``rho`` of all floors.
    ground : WhiteNoise, KanaiTajimi or CloughPenzien
        The ground; all parameters broadcast by dimension name.
    method : {"linearization", "white_noise", "effective", "simulation"}
        ``"linearization"``: statistical linearization. ``"white_noise"``: eq. (4) with the elastic
        periods and damping ratios, whatever the ground; the standard deviations are those of the
        elastic responses to this ground. ``"effective"``: eq. (4) with the effective periods and
        damping ratios of ``rule`` at the linearized peak ductilities. ``"simulation"``: nonlinear
        simulation of all structures under the same motions, with standard errors.
    closure : str
        Closure of the linearization, as in `linearize`; for linearization and effective properties.
        With ``"drift"`` the correlation includes that of the plastic drifts, derived in
        ``docs/drift.md`` and, on Kanai-Tajimi ground, corrected by a map of simulations.
    rule : str or EffectiveRule
        Rule for effective properties, one of `stochlin.rules.effective_rule_names` or a rule
        object.
    bias : bool
        Whether linearization is compared with the drift closure. Without that, it is much faster,
        and has neither ``bias`` nor ``caution``.
    rtol, max_iterations : float, int
        As in `linearize`, for linearization and effective properties: stop rule of the iteration.
    paths, seed, steps_per_period, relaxation_times
        As in `simulate`: options of the simulation.
    progress : callable, optional
        Called with the share of the simulation that is done.

    Returns
    -------
    xarray.Dataset
        Over the dimensions of the parameters: ``rho`` [-], ``displacement_std_1`` and ``_2`` [m],
        ``ductility_std_1`` and ``_2`` [-], ``yield_displacement_1`` and ``_2`` [m], and ``status``
        (the worse one of the two structures). Every method also gives ``relative_displacement_std``
        [m], the standard deviation of ``u_1 - u_2``, its relative bias
        ``relative_displacement_bias`` [-] (NaN where unknown) and the flag
        ``relative_displacement_caution``.

        Linearization adds ``bias`` [-], by which ``rho`` is too large; ``bias_1`` and ``bias_2``
        [-], the relative errors of the standard deviations; their expected errors ``bias_error``,
        ``_1`` and ``_2`` [-]; and the flag ``caution``, set where one of the three biases exceeds
        0.1 or is unknown. They are against the drift closure, which simulations of bilinear
        structures calibrate. The closure ``"drift"`` adds ``rho_error`` [-], the mean absolute
        error of ``rho`` over simulated pairs of the region (NaN where none were simulated), which
        counts in ``caution``, and ``relative_displacement_error`` [-], the expected relative error
        of ``relative_displacement_std``.

        Effective properties add ``period_eq_1`` and ``_2`` [s], ``damping_eq_1`` and ``_2`` [-],
        and the peak ductilities ``ductility_peak_1`` and ``_2`` [-], which are ``peak_factor``
        times ``ductility_std``.

        Simulation adds ``rho_standard_error`` [-], ``displacement_std_standard_error_1`` and ``_2``
        [m], ``drift_memory_1`` and ``_2`` [s], the relaxation times of the plastic drifts as
        `simulate` gives them, and ``drift_1`` and ``_2`` [-], the change of the variance during the
        run in standard errors. If it exceeds 5, the run was too short to be stationary, and the
        cell is ``not_converged``.

    Raises
    ------
    ValueError, TypeError
        If the method, the closure or the rule is unknown, an argument is of the wrong kind or out
        of range, dimensions do not fit together, or the table would not fit into memory.
    ArithmeticError
        If a single case fails; in a table the cell is NaN and its status gives the reason.

    Notes
    -----
    The linearized ``rho`` of yielding structures is off by 0.05 to 0.2, mostly too large, where
    yielding is moderate, and by up to 1.3 for structures much stiffer than a narrow-band ground.
    The linearized standard deviations are mostly too small. With a hardening ratio of 0.05 and R 2
    to 6, a separation computed from both is 28 to 49 % too small on broad-band ground; on
    narrow-band ground it is 0.69 to 1.31 times the simulated one if ``second`` has the period of
    the ground, and 0.39 to 1.19 times at half and twice that period. Nonlinear simulation, which
    takes seconds, does not have these errors.

    By simulation, a run lasts until the plastic drifts of all structures of the table are
    stationary, but for those of structures that yield rarely: their pairs have the status
    ``not_resolved``, as in `simulate`, and no ``rho``. A table whose simulations, on all grounds
    together, would take more than a quarter of an hour is refused with a ValueError.

    The correlation can be negative if the period of the ground is between those of the structures.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), eqs. (4) to (12), Figs. 3 to 5.

    Examples
    --------
    >>> import numpy as np, xarray as xr, stochlin as sl
    >>> ratio = xr.DataArray([0.5, 1.0], dims="ratio")
    >>> first = sl.Bilinear(period=ratio * 4.0, damping=0.05)
    >>> second = sl.Bilinear(period=4.0, damping=0.05)
    >>> table = sl.correlate(first, second, sl.KanaiTajimi(period=2.0, damping=0.05))
    >>> [round(float(rho), 6) for rho in table.rho]
    [-0.033778, 1.0]
    """
    models: dict[str, Model] = {"first": first, "second": second, "ground": ground}
    simulation: dict[str, Any] = {
        "paths": paths,
        "seed": seed,
        "steps_per_period": steps_per_period,
    }
    simulation |= {"relaxation_times": relaxation_times, "progress": progress}
    tolerance = Tolerance(rtol, max_iterations)
    query = Query(method, closure, tolerance, effective_rule(rule), bias, simulation)
    check_closure(first, closure)
    check_closure(second, closure)
    pairs = partial(_pair_table, query)
    table = pairs(first, second, ground) if method == SIMULATION else in_blocks(pairs, models)
    if method == "linearization" and closure != DRIFT and bias and is_lazy(models):
        # What does not need the bias has blocks of its own, so that to compute it alone costs none.
        alone = in_blocks(partial(_pair_table, query._replace(bias=False)), models)
        table = table.assign(alone.drop_vars([f"{DIFFERENCE}_bias", f"{DIFFERENCE}_caution"]))
    labels.raise_if_lone_failure(table, "correlate", first, second, ground)
    last = labels.NOT_RESOLVED if method == SIMULATION else labels.TOO_STRONG
    table = labels.label(table, last=last)
    return labels.with_run_information(
        table,
        f"Stationary correlation of two structures by {method.replace('_', ' ')}, "
        f"{ground.name} ground",
        f"correlate(method={method!r}, {query.history()})",
        models,
    )


class Query(NamedTuple):
    """Arguments of `correlate` that its methods share; a method may ignore some of them."""

    method: Method
    closure: str
    tolerance: Tolerance
    rule: EffectiveRule
    bias: bool
    simulation: dict[str, Any]  # options of `simulate`

    def history(self) -> str:
        """The arguments that the history of the dataset states."""
        if self.method == SIMULATION:
            return f"paths={self.simulation['paths']}, seed={self.simulation['seed']}"
        if self.method == "white_noise":
            return "eq. (4)"
        rule = f", rule={self.rule.name!r}" if self.method == "effective" else ""
        return f"closure={self.closure!r}{rule}"


def _pair_table(query: Query, first: Structure, second: Structure, ground: Ground) -> xr.Dataset:
    """Variables of `correlate`."""
    check_table(12, first, second, ground)
    variables, attrs = ANSWERS_BY_METHOD[query.method](query, (first, second), ground)
    if not (first.yields or second.yields):
        attrs.pop("comment", None)
    return xr.Dataset(variables | difference(variables), attrs=attrs)


Pair = tuple[Structure, Structure]
Answer = tuple[dict[str, Cells], dict[str, Any]]  # variables and attributes of the dataset


def _by_linearization(query: Query, pair: Pair, ground: Ground) -> Answer:
    comment = caution_in_words(query.closure, ground, labels.CAUTION_PAIR)
    table = linearized_pairs(pair, ground, query.closure, query.tolerance, query.bias)
    return table, {"comment": comment}


def _by_white_noise(query: Query, pair: Pair, ground: Ground) -> Answer:
    inputs = [s.cells()[name] for name in ("period", "damping") for s in pair]
    return _eq_4_variables(inputs, solved_together(pair, ground)), {}


def _by_effective_properties(query: Query, pair: Pair, ground: Ground) -> Answer:
    solved = solved_together(pair, ground, query.closure, query.tolerance)
    effective = effective_pair(solved, query.rule)
    comment = f"Peak ductilities are linearized. {labels.CAUTION_SIGMA}"
    variables = _eq_4_variables([effective[name] for name in EQ_4], solved) | effective
    return variables, {"comment": comment, "rule": query.rule.describe()}


def _by_simulation(query: Query, pair: Pair, ground: Ground) -> Answer:
    from stochlin.solver.correlation.simulated import simulate_pairs

    table = simulate_pairs(*pair, ground, query.simulation)
    return {str(name): array for name, array in table.data_vars.items()}, table.attrs


SIMULATION: Method = "simulation"
ANSWERS_BY_METHOD: Mapping[Method, Callable[[Query, Pair, Ground], Answer]] = {
    "linearization": _by_linearization,
    "white_noise": _by_white_noise,
    "effective": _by_effective_properties,
    SIMULATION: _by_simulation,
}


def _eq_4_variables(inputs: list[Cells], solved: Solved) -> dict[str, Cells]:
    """Correlation by eq. (4) of ``inputs``, and responses of both structures; NaN for failures."""
    sides = [solved.labelled(n, (*STRUCTURE_VARIABLES, "status")) for n in (0, 1)]
    rho, status = by_eq_4(inputs, *(side["status"] for side in sides))
    responses = {
        f"{name}_{n}": side[name]
        for name in STRUCTURE_VARIABLES
        for n, side in enumerate(sides, start=1)
    }
    return {"rho": rho, **responses, "status": status}
