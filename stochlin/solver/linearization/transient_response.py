"""Transient linearization of one structure in a motion of finite duration."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Literal

import numpy as np
import xarray as xr

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization.levels import Tables
from stochlin.kernels.probability import accumulated
from stochlin.models.arguments import Duration, Points, checked
from stochlin.models.envelopes import Envelope
from stochlin.models.grounds import Ground
from stochlin.models.parameters import Model
from stochlin.models.structures import DRIFT, GAUSSIAN, Structure
from stochlin.solver.linearization.equivalent_systems import Oscillators, solve_elastic
from stochlin.solver.linearization.levels import (
    INSTANTS,
    EnvelopesInTime,
    StructuresInTime,
    in_metres,
    strengths,
    structures_in_time,
    why_no_drift,
)
from stochlin.solver.linearization.systems.state_space import problem_of
from stochlin.solver.linearization.transient_systems import (
    POINTS,
    TIME,
    check_course,
    course_of,
    over_time,
    solve_course,
)
from stochlin.solver.tables import labels
from stochlin.solver.tables.cells import flat, together_or_alone
from stochlin.solver.tables.checks import check_duration
from stochlin.solver.tables.lazy import check_names

InTime = Literal["gaussian", "drift"]
IN_TIME = {GAUSSIAN: labels.CAUTION_SIGMA, DRIFT: labels.CAUTION_FINITE_DRIFT}  # comments


@checked
def transient_response(
    structure: Structure,
    ground: Ground,
    duration: Duration,
    *,
    envelope: Envelope | None = None,
    closure: InTime = "gaussian",
    points: Points = POINTS,
) -> xr.Dataset:
    """Standard deviations of the response of a structure over time, by transient linearization.

    The structure is at rest at first. The coefficients of eqs. (9) and (10) by the Gaussian closure
    change with the covariance ``X`` of the response. It obeys ``X' = A X + X A' + b b'``, with the
    state matrix ``A`` of structure and ground, in which the forcing is proportional to the
    envelope, and the white noise ``b`` of unit intensity.

    A law with memory has further states ``e`` besides ``z``, such as the dissipated energy. Its
    coefficients are those of the law in which ``e`` has its mean, and the means grow with the
    response, ``E[e]' = E[rate of e]``, from 0 on (Baber and Wen 1981).

    Parameters
    ----------
    structure : Bilinear, BoucWen, Hysteretic or BoucWenBaberNoori
        The structure. Further states of its law keep their sign when the motion turns, as energies
        do.
    ground : WhiteNoise, KanaiTajimi or CloughPenzien
        The ground; its parameters and those of the structure broadcast by dimension name.
    duration : float
        Duration of the motion [s], at least one period.
    envelope : AminAng, ShinozukaSato or GammaEnvelope, optional
        Envelope ``m`` of the motion, whose evolutionary spectrum is ``m(t)^2 S(w)`` with that of
        the ground, ``S`` (Priestley 1965); without it the motion is stationary from its start.
    closure : {"gaussian", "drift"}
        ``"drift"``: with the plastic drift, for bilinear structures. The response at each instant
        is the stationary one at a level of shaking that follows the envelope with a lag, by eqs.
        (14) to (16) of ``docs/drift.md``.
    points : int
        Number of instants of the result.

    Returns
    -------
    xarray.Dataset
        Over ``time`` [s] and the dimensions of the parameters: ``displacement_std`` [m],
        ``velocity_std`` [m/s], ``z_std`` [-] (0 if elastic), ``c_eq`` [-] and ``k_eq`` [1/s]; and
        ``hysteretic_energy_per_mass`` [m^2/s^2], the mean work done on the hysteretic spring so
        far: what it has dissipated, and the little that it stores. A law with memory adds
        ``state_mean``, the means of its further states over ``state``, as the law measures them.
        Over ``time``: ``envelope`` [-], and ``permanent_set_left_out``, a flag that is 1 after the
        strong shaking. Over the dimensions of the parameters: ``yield_displacement`` [m] and
        ``status``.

        The closure ``"drift"`` adds ``drift_std`` [m], the standard deviation of the slow plastic
        drift in ``displacement_std``, which at the end is that of the permanent displacement; there
        is no flag ``permanent_set_left_out``.

    Raises
    ------
    ValueError, TypeError
        If a number is out of range, the envelope has negative values or is zero within the whole
        duration, or the duration is shorter than a period.
    ArithmeticError
        If a single case fails, or the law has no rates in symbols, as that of `ModifiedClough` and
        `Flag`; in a table the cell is NaN and its status gives the reason.

    Notes
    -----
    The integration has an error of some 1e-5 of the largest standard deviation. Strong shaking ends
    when the envelope falls below half of its maximum for the last time. From then on the result
    does not have the permanent displacement of yielding structures, because the linearized
    structure returns to zero.

    For structures that degrade the errors are largest with a hardening below 0.05 and a period of a
    third of that of the ground or less; `simulate` with a duration does not have them.

    With a hardening of 0 or less the moments grow with time. An ArithmeticError is raised where the
    standard deviation exceeds the displacement at which a softening structure has no force left.

    References
    ----------
    Baber, T. T. and Wen, Y. K. (1981), J. Eng. Mech. Div. ASCE 107, 1069-1087.
    Priestley, M. B. (1965), J. R. Stat. Soc. B 27.
    Roberts, J. B. and Spanos, P. D. (1990). Random vibration and statistical linearization.

    Examples
    --------
    >>> import stochlin as sl
    >>> building = sl.Bilinear(period=0.8, damping=0.05)
    >>> ground = sl.WhiteNoise(0.01)
    >>> late = sl.transient_response(building, ground, duration=40.0).displacement_std[-1]
    >>> bool(abs(late / sl.linearize(building, ground).displacement_std - 1) < 1e-6)
    True
    """
    seconds = check_course(duration, envelope)
    if closure == DRIFT and (missing := why_no_drift([structure])):
        raise ValueError(f"closure = {DRIFT!r}: {missing}; allowed: {GAUSSIAN!r}")
    models: dict[str, Model] = {"structure": structure, "ground": ground}
    solve = _drifting if closure == DRIFT else _of_cells
    of_cells = partial(solve, seconds=seconds, envelope=envelope, points=points)
    table = together_or_alone(of_cells, models, structure.arrays()["period"] <= seconds)
    course = course_of(envelope, seconds, seconds, points)
    table = labels.label(over_time(table, course, drifts=closure == DRIFT))
    if structure.yields:
        table = table.assign_attrs(comment=IN_TIME[closure])
    return labels.with_run_information(
        table.assign_attrs(closure=closure),
        f"Transient linearization, {ground.name} ground",
        f"transient_response(duration={duration:g}, closure={closure!r})",
        models,
    )


def _of_cells(
    structure: Structure, ground: Ground, *, seconds: float, envelope: Envelope | None, points: int
) -> xr.Dataset:
    """Variables of `transient_response` of all cells, in steps that they share."""
    check_duration(seconds, {"structure": structure})
    status = solve_elastic(structure, ground).status
    status = status.where(status >= labels.NOT_CONVERGED, labels.CONVERGED)
    labels.raise_if_lone_failure(xr.Dataset({"status": status}), "transient_response")
    period = structure.arrays()["period"]
    status = status.where(
        (status >= labels.NOT_CONVERGED) | (period <= seconds), labels.INVALID_INPUT
    )
    if status.ndim:  # other cells are left out like those with parameters out of range
        structure = replace(structure, period=period.where(status < labels.NOT_CONVERGED))
    cells = flat({"structure": structure, "ground": ground}, settled=False)
    if not cells.where.size:
        raise ValueError("no structure has valid parameters; correct those that are out of range")
    system, problem = problem_of(cells.models, in_time=True)
    shortest = float(np.min(cells.models["structure"].arrays()["period"]))
    course = course_of(envelope, seconds, shortest, points)
    moments = solve_course(system, problem, np.eye(1), course, shortest)
    uy = problem.system.strength[:, 0]
    couple = problem.system.couple[:, 0]
    # Sums over the one element that yields, or over none.
    parts = moments.z, moments.slip, moments.relaxation, moments.means
    z, slip, relaxation, means = (part[course.shown].sum(axis=-1) for part in parts)
    values = {
        "displacement_std": np.sqrt(np.maximum(moments.displacement[course.shown, :, 0], 0)),
        "velocity_std": np.sqrt(np.maximum(moments.velocity[course.shown, :, 0], 0)),
        "z_std": np.sqrt(np.maximum(z, 0)) / uy,
        "c_eq": slip - 1,
        "k_eq": relaxation,
        "hysteretic_energy_per_mass": couple * np.where(np.isinf(uy), 0.0, uy) ** 2 * means[:, 0],
    }
    variables = (
        *values,
        "yield_displacement",
        "envelope",
        "state",
        "state_mean",
        "permanent_set_left_out",
    )
    shape = cells.shape
    check_names((*shape.dims, *shape.coords), (*variables, "status", TIME))
    table = xr.Dataset(
        {name: ((TIME, *shape.dims), cells.whole(rows)) for name, rows in values.items()},
        coords=shape.coords,
    )
    table["yield_displacement"] = cells.table(uy)
    if means.shape[1] > 1:
        of_states = "time", "state", *shape.dims
        table["state_mean"] = of_states, cells.whole(means[:, 1:])
        table["state"] = "state", [*structure.further_states()]
    return table.assign(status=status.astype(np.int8))


@np.errstate(all="ignore")  # failed structures are NaN
def _drifting(
    structure: Structure, ground: Ground, *, seconds: float, envelope: Envelope | None, points: int
) -> xr.Dataset:
    """Variables of `transient_response` of all cells, by the drift closure."""
    check_duration(seconds, {"structure": structure})
    cells = flat({"structure": in_metres(structure, ground, seconds), "ground": ground})
    if not cells.where.size:
        raise ValueError("no structure has valid parameters; correct those that are out of range")
    steps = -(-(INSTANTS - 1) // (points - 1))
    course = EnvelopesInTime.of(envelope, seconds, *strengths(0.0), (points - 1) * steps + 1)
    structures = structures_in_time(Oscillators.of(cells), ground, course)
    failed = structures.solved.failed[structures.number]
    shape = cells.shape
    table = xr.Dataset(coords=shape.coords)
    for name, row in _with_drift(structures).items():
        table[name] = (TIME, *shape.dims), cells.whole(np.where(failed, np.nan, row)[::steps])
    table["yield_displacement"] = cells.table(Oscillators.of(cells).strength)
    status = labels.status_where(~failed, labels.NOT_CONVERGED)
    return table.assign(status=cells.table(status, blank=labels.INVALID_INPUT))


def _with_drift(structures: StructuresInTime) -> dict[str, Array]:
    """Variables over (instants, c) of structures by the drift closure."""
    solved = structures.solved
    number = structures.number
    values = solved.solved.values
    moves = structures.moving(number)
    level = np.tile(solved.levels, solved.failed.size)
    z = values["z_std"] / level
    work = values["velocity_z_corr"] * values["velocity_std"] / level
    work = work * z * solved.system.coupling * values["yield_displacement"]
    rows = np.array([z, values["c_eq"], values["k_eq"], work])
    z, c_eq, k_eq, work = Tables.of(solved.levels, rows).at(moves.square, number)
    return {
        "displacement_std": np.sqrt(moves.variance),
        "velocity_std": moves.rows.velocity,
        "drift_std": np.sqrt(moves.offset),
        "z_std": np.sqrt(moves.square) * z,
        "c_eq": c_eq,
        "k_eq": k_eq,
        "hysteretic_energy_per_mass": accumulated(moves.square * work, structures.course.times),
    }
