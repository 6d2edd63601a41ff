"""Reduction factor of a structure, and the strength for a given ductility."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
import xarray as xr
from scipy.optimize import elementwise

from stochlin.kernels.basics.arrays import Array
from stochlin.messages import brief
from stochlin.models.arguments import checked
from stochlin.models.grounds import Ground
from stochlin.models.parameters import POSITIVE, Model, Parameter, parameter
from stochlin.models.structures import DRIFT, GAUSSIAN, AnyStructure, Structure
from stochlin.solver.linearization.drift_map import STRENGTH_RATIO, with_correction
from stochlin.solver.linearization.equivalent_systems import (
    JUDGED,
    STRUCTURE_VARIABLES,
    LawOfCells,
    Oscillators,
    Solved,
    check_closure,
    in_columns,
    solve_elastic,
    solve_oscillators,
    solved_together,
)
from stochlin.solver.linearization.linearization import caution_in_words, judged
from stochlin.solver.tables import labels
from stochlin.solver.tables.cells import flat
from stochlin.solver.tables.checks import Tolerance
from stochlin.solver.tables.lazy import in_blocks

TOLERANCE = Tolerance(1e-12, 200)
# Largest relative error of the ductility that is found. Where the ductility jumps with R, a search
# ends at the jump, with a larger error.
REACHED = 1e-6


@dataclass(frozen=True)
class DuctilityTarget(Model):
    """Given mean peak ductility."""

    of_arguments = True

    ductility: Parameter = parameter("1", "mean peak ductility", POSITIVE)


@checked
def strength_for_ductility(
    structure: Structure,
    ground: Ground,
    ductility: Parameter,
    *,
    peak_factor: Parameter | None = None,
    closure: str = GAUSSIAN,
) -> xr.Dataset:
    """Strength for a given mean peak ductility.

    The reduction factor ``R`` is the solution of ``p ductility_std = ductility``, with
    ``ductility_std`` by linearization.

    Parameters
    ----------
    structure : Bilinear, BoucWen or Hysteretic
        The structure with its hardening; a strength that it may have is not used.
    ground : WhiteNoise, KanaiTajimi or CloughPenzien
        The ground.
    ductility : float or array
        Mean peak ductility [-], positive; all parameters broadcast by dimension name.
    peak_factor : float or array, optional
        Peak factor ``p`` [-] of the ductility and in the definition of ``R``. The default is that
        of the structure.
    closure : str
        Closure of the linearization, as in `linearize`.

    Returns
    -------
    xarray.Dataset
        Over the dimensions of the parameters: ``reduction_factor`` [-] and ``yield_displacement``
        [m]; ``displacement_std`` [m], ``ductility_std`` [-] and ``ductility_peak`` [-] of a
        structure with this strength; ``status``, which is ``not_converged`` where the search fails;
        ``bias`` [-], the relative error of these displacements and ductilities from a map of
        simulations; and the flag ``caution``, set where the bias exceeds 10 % or is unknown, both
        as in `linearize`.

    Raises
    ------
    ValueError, TypeError
        If the structure has no hardening, the closure is unknown, a scalar is out of range, or
        dimensions do not fit.
    ArithmeticError
        If the search fails for a single case.

    Notes
    -----
    The ductility is about ``R`` for small ``R``, and proportional to ``R`` for large ``R``. In 400
    random cases (T/Tg 0.05 to 10, damping 0.005 to 0.2, hardening 0.001 to 1, ground damping 0.01
    to 0.9; 141 values of ``R`` from 0.01 to 1e5), it always increased with ``R``, with every
    closure of the bilinear law except ``"drift"``, so that there is exactly one solution. With
    ``"drift"`` it decreased by up to 10 % for 2 of 60 structures near the resonance of a
    narrow-band ground; there, several strengths have the same ductility, and one of them is found.

    The search fails if the linearization does not converge for the required ``R`` (some above 10
    000; with ``"clipped"`` also some where the ductility nearly jumps).

    The strength has the error of the linearized ductility. The Gaussian closure underestimates the
    ductility, so that its strength is too small; with the drift closure the error is 0.9 % on
    average, as in `linearize`. A structure with a period of 0.6 s (damping and hardening 0.05) and
    the strength for a ductility of 4 by the drift closure has by nonlinear simulation a ductility
    of 4.0 on a broad band (0.42 s, damping 0.6) and on a lake bed (2 s, 0.05); by the Gaussian
    closure 6.2 and 20.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), Fig. 5, for reduction factors and ductilities.

    Examples
    --------
    >>> import stochlin as sl
    >>> building = sl.Bilinear(period=0.5, damping=0.05, hardening=0.05)
    >>> ground = sl.KanaiTajimi(period=0.42, damping=0.6)
    >>> table = sl.strength_for_ductility(building, ground, ductility=4.0)
    >>> round(float(table.ductility_peak), 9)
    4.0
    """
    check_closure(structure, closure)
    if structure.hardening is None:
        raise ValueError(
            f"{type(structure).__name__}: hardening is not given; what yields needs it"
        )
    factor = structure.peak_factor if peak_factor is None else peak_factor
    strong = replace(structure, yield_displacement=None, reduction_factor=1.0, peak_factor=factor)
    strong.check_settles(type(structure).__name__)
    target = DuctilityTarget(ductility)
    models: dict[str, Model] = {"structure": strong, "ground": ground, "target": target}
    table = labels.label(in_blocks(partial(_with_strength, closure), models))
    arguments = f"{structure.describe()}, {ground.describe()}, ductility={brief(ductility)}"
    case = f"strength_for_ductility({arguments})"
    labels.raise_if_lone_failure(table, case)
    return labels.with_run_information(
        table.assign_attrs(closure=closure, comment=caution_in_words(closure, ground)),
        f"Strength for a peak ductility, {closure} closure, {ground.name} ground",
        f"strength_for_ductility(closure={closure!r})",
        models,
    )


def _with_strength(
    closure: str, structure: Structure, ground: Ground, target: DuctilityTarget
) -> xr.Dataset:
    """The variables that `strength_for_ductility` returns."""
    reduction = _search(structure, ground, target, closure)
    if not reduction.ndim and np.isnan(reduction):
        elastic = replace(structure, reduction_factor=None)
        what = f"no strength of {elastic.describe()} on {ground.describe()} was found"
        ductility = float(target.arrays()["ductility"])
        raise ArithmeticError(f"{what} that has the ductility {ductility:g}; give another one")
    yielding = replace(structure, reduction_factor=reduction)
    solved = judged((yielding,), ground, closure, TOLERANCE).dataset()
    valid = structure.valid() & structure.settles() & ground.valid() & target.valid()
    peak = yielding.arrays()["peak_factor"] * solved.ductility_std
    reached = np.abs(peak / target.arrays()["ductility"] - 1) < REACHED
    status = solved.status.where(reached, labels.NOT_CONVERGED).where(valid, labels.INVALID_INPUT)
    table = (
        solved[list(STRUCTURE_VARIABLES)]
        .assign(reduction_factor=reduction, ductility_peak=peak)
        .where(reached)
    )
    table["status"] = status.astype(np.int8)
    return table.assign(solved[list(JUDGED)]).assign(bias=solved.bias.where(reached))


@checked
def reduction_factor(structure: Structure, ground: Ground) -> xr.Dataset:
    """Reduction factor ``R = p sigma_el / uy`` of a structure on a ground.

    Here ``p`` is the peak factor of the structure, ``sigma_el`` the standard deviation of its
    elastic displacement and ``uy`` its yield displacement. `linearize` gives the yield displacement
    for ``R``.

    Parameters
    ----------
    structure : Bilinear, BoucWen or Hysteretic
        The structure with a strength, as ``yield_displacement`` or ``reduction_factor``.
    ground : WhiteNoise, KanaiTajimi or CloughPenzien
        The ground; its parameters and those of the structure broadcast by dimension name.

    Returns
    -------
    xarray.Dataset
        Over the dimensions of the parameters: ``reduction_factor`` [-], ``yield_displacement`` [m]
        and ``status``.

    Raises
    ------
    ValueError, TypeError
        If the structure has no strength, or dimensions do not fit.
    ArithmeticError
        As in `linearize`.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), Fig. 5.

    Examples
    --------
    >>> import stochlin as sl
    >>> building = sl.Bilinear(period=1.0, damping=0.05, hardening=0.05, yield_displacement=0.1)
    >>> R = sl.reduction_factor(building, sl.WhiteNoise(0.01)).reduction_factor
    >>> same = sl.Bilinear(period=1.0, damping=0.05, hardening=0.05, reduction_factor=R)
    >>> round(float(sl.linearize(same, sl.WhiteNoise(0.01)).yield_displacement), 12)
    0.1
    """
    if not structure.yields:
        what = f"{structure.describe()} has no strength"
        raise ValueError(f"{what}; allowed: with a yield_displacement or a reduction_factor")
    elastic = solve_elastic(structure, ground)
    peak = structure.arrays()["peak_factor"] * elastic.displacement_std
    table = labels.label(
        elastic[["yield_displacement", "status"]].assign(
            reduction_factor=peak / elastic.yield_displacement
        ),
    )
    labels.raise_if_lone_failure(table, "reduction_factor", structure, ground)
    return labels.with_run_information(
        table,
        f"Reduction factor of the stationary response, {ground.name} ground",
        "reduction_factor()",
        {"structure": structure, "ground": ground},
    )


def _search(
    structure: Structure, ground: Ground, target: DuctilityTarget, closure: str
) -> xr.DataArray:
    """Reduction factor of every cell by Chandrupatla's method in a bracket; NaN where it fails."""
    table = flat({"structure": structure, "ground": ground, "target": target})
    cells = Oscillators.of(table)
    law = LawOfCells.of(table, closure)
    (wanted,) = in_columns([table.models["target"].ductility], cells.period.size)
    result = np.full(wanted.size, np.nan)

    def excess(log_r: Array, index: Array) -> Array:
        """Logarithm of the ratio of the peak ductility to its target for the cells of ``index``."""
        at = index.astype(int)
        weaker = cells.at(at)._replace(strength=np.exp(log_r))
        values = solve_oscillators(weaker, law.at(at), ground, TOLERANCE)
        if closure == DRIFT:
            point = weaker.point(ground, values[STRENGTH_RATIO])
            values = with_correction(ground, weaker.soil, point, values)
        return np.log(weaker.peak_factor * values["ductility_std"] / wanted[at])

    if wanted.size:
        index = np.arange(wanted.size, dtype=float)
        start = np.log(wanted)  # the solution if the structure stays elastic
        around = elementwise.bracket_root(
            excess, start - 0.4, start + 0.4, args=(index,), maxiter=30
        )
        root = elementwise.find_root(excess, around.bracket, args=(index,), maxiter=60)
        result = np.where(root.success, np.exp(root.x), np.nan)
    return xr.DataArray(table.array(result))


def solved_reduction_factor(structure: Structure, solved: Solved) -> float:
    """Reduction factor of a single structure that was solved; NaN if elastic."""
    factor = float(structure.arrays()["peak_factor"]) * solved.values[STRENGTH_RATIO].item()
    return factor if structure.yields else np.nan


def strength_in_metres(structure: AnyStructure, ground: Ground) -> Any:
    """The structure with its strength as a yield displacement [m] instead of a reduction factor."""
    if not (isinstance(structure, Structure) and structure.by_reduction_factor):
        return structure
    uy = solved_together((structure,), ground).labelled(0, ["yield_displacement"])[
        "yield_displacement"
    ]
    if not np.ndim(uy) and not 0 < float(uy) < np.inf:
        what = f"the elastic response of {structure.describe()} to {ground.describe()}"
        raise ArithmeticError(f"{what} cannot be computed; give less extreme parameters")
    return replace(structure, reduction_factor=None, yield_displacement=uy)
