"""Structures and their ground, prepared for a simulation of many motions (an ensemble).

Here the models become the arrays that the compiled time steps take. The time step is chosen, and the
computing time is estimated. The parameters of each single structure in a table are called a cell.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import scipy.linalg
import xarray as xr

from stochlin.analyses.linearization.equivalent_systems import derived_together, solve_structure
from stochlin.analyses.linearization.tolerance import Tolerance
from stochlin.analyses.simulation.connected_structures import ConnectedStructures, laws_of
from stochlin.analyses.tables import labels
from stochlin.analyses.tables.cellwise import row_of
from stochlin.analyses.tables.work import check_work
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import cores
from stochlin.kernels.basics.systems import System
from stochlin.kernels.linearization.filters import Filter
from stochlin.kernels.simulation.ensemble import (
    AnyGround,
    Crowd,
    Oscillators,
    Plan,
    SteppedStructures,
    UncertainGround,
)
from stochlin.kernels.simulation.laws import BILINEAR, BOUC_WEN, VISCOUS
from stochlin.kernels.simulation.stepping import LANES, FilterSteps, filter_steps
from stochlin.kernels.simulation.time_step import Elements
from stochlin.models.grounds import Ground
from stochlin.models.structures import Structure

# The response is sampled this often in the shortest period. More samples would hardly make the estimated
# variance more accurate.
SAMPLES_PER_PERIOD = 2
# The computing time is estimated beforehand, and a simulation that would take too long is refused.
STEP = 4e-9  # time [s] that one core needs for one time step of one bilinear structure
# The other parts of a time step, in multiples of STEP: the ground, a structure with another hysteresis
# law, and a relative displacement of two structures that is recorded.
GROUND, OTHER_LAW, PAIR = 4.0, 15.0, 0.25
DASHPOT = 60.0  # a dashpot whose force is a power of the velocity
STOREY = 0.5  # each pair of storeys of a building


class SimulationCells(NamedTuple):
    """The cells of structures in one row of length n; parameters that are not valid are NaN."""

    period: Array  # [s]
    damping: Array  # damping ratio
    hardening: Array  # hardening ratio
    yield_displacement: Array  # [m], infinite for an elastic structure
    law: Array  # (n, k) further parameters of the hysteresis law; shorter rows are filled up with NaN
    step: npt.NDArray[np.object_]  # what `Structure.step` gives
    damping_time: Array  # [s] in which free vibrations decay to 1/e, which is 1/(xi w)
    drift_time: Array  # [s] in which the plastic drift decays, by linearization; 0 if elastic
    valid: Array  # whether the parameters are in range and the elastic response could be computed


class SimulationRun(NamedTuple):
    """A simulation that is ready to run.

    It has floors: an oscillator has one, a building with storeys has one for each storey.
    """

    crowd: Crowd  # all structures, grouped by the kind of their time steps
    order: Array  # for each valid floor, its row in the crowd
    scale: Array  # for each valid floor, the unit in which its displacement is computed [m]
    ground: AnyGround  # time steps of the ground filter
    root: Array  # square root of the stationary covariance of the filter, for its initial states
    plan: Plan  # time step, duration, number and seed of the motions
    memory: float  # [s], the longest time in which a vibration or a plastic drift decays
    valid: Array  # (n,) for each floor, whether it can be simulated
    period: Array  # [s], for each valid floor, the longest period of its structure
    drift_time: Array  # [s], for each valid floor, the time in which its plastic drift decays


def cells_of(
    structure: Structure, ground: Ground, stationary: bool = True
) -> tuple[SimulationCells, xr.DataArray]:
    """The cells of a structure in one row, and for each cell of its table the position in this row.

    The decay time of the plastic drift is only computed for a ``stationary`` run, which needs it for its
    duration. Otherwise it is 0.
    """
    (elastic,) = derived_together((structure,), ground)
    values = structure.arrays()
    like = xr.DataArray(elastic["yield_displacement"])
    k_eq = xr.zeros_like(like)
    # A law may have no linearization; a run that is too short shows it by its change of variance.
    with suppress(ArithmeticError):
        if stationary:
            k_eq = solve_structure(structure, ground, "gaussian", Tolerance(1e-6, 1e-9, 200)).k_eq
    columns = (
        values["period"],
        values["damping"],
        values.get("hardening", xr.DataArray(1.0)),
        like,
        k_eq,
        *structure.law_parameters(),
    )
    period, damping, hardening, uy, pace, *rest = (row_of(a, like).astype(float) for a in columns)
    w = 2 * np.pi / period
    with np.errstate(divide="ignore", invalid="ignore"):
        slow = np.where(pace > 0, 1 / (hardening * pace), 0)
    status = np.ravel(elastic["status"])
    cells = SimulationCells(
        period,
        damping,
        hardening,
        uy,
        np.reshape(rest, (len(rest), period.size)).T,
        np.full(period.size, structure.step(), object),
        1 / (damping * w),
        np.nan_to_num(slow),
        status < labels.NOT_CONVERGED,
    )
    return cells, xr.full_like(like, 0, dtype=int).copy(data=np.arange(period.size).reshape(like.shape))


def cells_of_all(
    structures: Sequence[Structure], ground: Ground, stationary: bool = True
) -> SimulationCells:
    """The cells of structures with scalar parameters, in their order.

    Structures with the same hysteresis law are solved together, which is faster.
    """
    alike: dict[tuple[object, ...], list[int]] = {}
    values = [structure.arrays() for structure in structures]
    for number, structure in enumerate(structures):
        alike.setdefault((structure.step(), *values[number]), []).append(number)
    parts = []
    for numbers in alike.values():
        first = numbers[0]
        columns: dict[str, Any] = {
            n: [float(values[i][n]) for i in numbers] for n in values[first] if n != "mass"
        }
        parts.append(cells_of(replace(structures[first], **columns), ground, stationary)[0])
    order = np.argsort([number for numbers in alike.values() for number in numbers])
    return SimulationCells(*(column[order] for column in join_cells(parts)))


def join_cells(parts: Sequence[SimulationCells]) -> SimulationCells:
    """The cells of several structures, one after another in one row."""
    columns = dict(zip(SimulationCells._fields, zip(*parts, strict=True), strict=True))
    laws = joined_laws(columns.pop("law"))
    return SimulationCells(
        law=laws, **{name: np.concatenate(column) for name, column in columns.items()}
    )


def joined_laws(laws: Sequence[Array]) -> Array:
    """Parameters of several laws, arrays (n, k), in one array.

    Rows with fewer parameters than the longest are filled up with NaN.
    """
    widest = max(law.shape[1] for law in laws)
    wide = [np.pad(law, ((0, 0), (0, widest - law.shape[1])), constant_values=np.nan) for law in laws]
    return np.concatenate(wide)


def prepare(
    cells: SimulationCells | None,
    ground: Ground,
    *,
    paths: int,
    seed: int,
    steps_per_period: int,
    connected: Sequence[ConnectedStructures] = (),
    floors: Sequence[int] | None = None,
    drift_times: Array | None = None,
    scatter: float = 0.0,
    grounds: Sequence[Ground] = (),
    step: float | None = None,
    moments: bool = True,
) -> SimulationRun:
    """Structures and their ground, ready for a simulation whose duration is still open.

    Parameters
    ----------
    cells : SimulationCells or None
        Oscillators that are not linked to others.
    ground : Ground
        The ground that acts on all structures.
    paths, seed, steps_per_period, scatter
        As in `simulate`.
    connected : sequence of ConnectedStructures
        Buildings with storeys and linked structures.
    floors : sequence of int, optional
        For each of the ``cells`` its number among the floors. Required with ``connected`` ones.
    drift_times : Array, optional
        For each floor the time in which its plastic drift decays [s]. The default are the times of the
        ``cells``.
    grounds : sequence of Ground
        Samples of an uncertain ground, one for each motion.
    step : float, optional
        Time step [s]. The default follows from the shortest period.
    moments : bool
        Whether the run will store the moments of all pairs of floors. If so, it is checked whether they
        fit into memory.

    Returns
    -------
    SimulationRun
        The simulation, without its duration.
    """
    if cells is not None and not cells.valid.any():
        raise ValueError("no structure has valid parameters; correct those that are out of range")
    own = 0 if cells is None else cells.valid.size
    count = own + sum(group.floors.size for group in connected)
    if moments:
        check_memory(count if cells is None or connected else int(cells.valid.sum()), paths)
    rows, scale, period = np.full(count, -1), np.full(count, np.nan), np.full(count, np.nan)
    drift_time, parts = np.zeros(count), list[Oscillators | SteppedStructures]()
    soil = ground.lone_filter()
    rates = -np.linalg.eigvals(soil.arrays.matrix).real if soil.states else np.array([np.inf])
    soils = [each.lone_filter() for each in grounds] or [soil]
    periods = [float(2 * np.pi / np.float64(each.fastest)) for each in soils if each.states]
    memory = float((1 / rates).max())
    if cells is not None:
        valid = cells.valid
        mine = np.arange(count) if floors is None else np.array(floors)
        of_cells, order, unit = _oscillators(cells, valid)
        rows[mine[valid]], scale[mine[valid]], parts = order, unit, of_cells
        period[mine], drift_time[mine] = cells.period, cells.drift_time
        periods.append(float(cells.period[valid].min()))
        memory = max(memory, float(cells.damping_time[valid].max()))
    for group in connected:
        begin = sum(part.size for part in parts)
        rows[group.floors] = begin + np.arange(group.floors.size)
        scale[group.floors], period[group.floors] = 1.0, group.period
        periods.append(group.shortest)
        memory = max(memory, group.slowest)
        parts.append(group.part)
    if drift_times is not None:
        drift_time = drift_times
    dt = step or min(periods) / steps_per_period
    every = max(1, steps_per_period // SAMPLES_PER_PERIOD)
    known = rows >= 0
    steps, roots = zip(*(ground_steps(each, dt) for each in soils), strict=True)
    return SimulationRun(
        Crowd(tuple(parts)),
        rows[known],
        scale[known],
        UncertainGround(steps, roots) if grounds else steps[0],
        roots[0],
        Plan(dt, every, 0, 0, groups=int(np.ceil(paths / LANES)), seed=seed, scatter=scatter),
        memory,
        known,
        period[known],
        drift_time[known],
    )


def ground_steps(soil: Filter, dt: float) -> tuple[FilterSteps, Array]:
    """The time steps of the filter of a ground, and the square root of its stationary covariance.

    With the square root, the initial states of the filter are drawn.
    """
    matrix, noise, output = soil.arrays
    intensity = 2 * np.pi * soil.intensity
    return filter_steps(matrix, noise, output, intensity, dt), _root(matrix, noise, intensity)


def check_memory(structures: int, paths: int) -> None:
    """Raise a ValueError if the moments of all pairs of structures would not fit into memory."""
    at_once = min(cores(), -(-paths // LANES))
    needed = 8.0 * structures**2 * (4 * LANES * at_once + 12)
    check_work(
        f"{structures} structures on one ground need",
        "simulate fewer structures at a time",
        memory=needed,
    )


def seconds_of(run: SimulationRun, steps: float, pairs: float) -> float:
    """Estimated computing time [s] of a run of this many time ``steps``.

    At each step, ``pairs`` relative displacements are recorded.
    """
    each = GROUND + PAIR * pairs + sum(_weight(part) for part in run.crowd.parts)
    return STEP * each * steps * run.plan.groups * LANES / cores()


def _weight(part: Oscillators | SteppedStructures) -> float:
    """Estimated time of one step of these structures, over that of one bilinear structure."""
    if isinstance(part, SteppedStructures):
        kind = part.elements.kind
        laws = np.where(kind == VISCOUS, DASHPOT, np.where(kind >= BOUC_WEN, OTHER_LAW, 1.0))
        return float(laws.sum() + STOREY * kind.size**2)
    return float(part.size)


def _oscillators(
    cells: SimulationCells, valid: Array
) -> tuple[list[Oscillators | SteppedStructures], Array, Array]:
    """The valid structures, bilinear ones together, the row of each, and its unit of displacement [m].

    Displacements of bilinear structures are computed in units of the yield displacement, others in m.
    """
    w = 2 * np.pi / cells.period[valid]
    yields = np.isfinite(cells.yield_displacement[valid])
    alpha = np.where(yields, cells.hardening[valid], 1.0)
    scale = np.where(yields, cells.yield_displacement[valid], 1.0)
    friction, post, couple = 2 * cells.damping[valid] * w, alpha * w**2, (1 - alpha) * w**2
    step, law = cells.step[valid], cells.law[valid]
    bilinear = (step == BILINEAR) | ~yields
    together, others = np.flatnonzero(bilinear), np.flatnonzero(~bilinear)
    parts: list[Oscillators | SteppedStructures] = []
    if together.size:
        parts.append(Oscillators(np.stack([friction, post, couple, 1 / scale], axis=1)[together]))
    for n in others:
        spring = ([value] for value in (post[n], couple[n], scale[n]))
        unit = np.ones((1, 1))
        system = System(unit[0], friction[n] * unit, unit, unit, *map(np.array, spring))
        kinds, states, of_kinds = laws_of([step[n]])
        own = law[n][None, np.isfinite(law[n])]
        parts.append(SteppedStructures(Elements(system, kinds, states, own), of_kinds))
    order = np.empty(w.size, int)
    order[np.concatenate([together, others])] = np.arange(w.size)
    return parts, order, np.where(bilinear, scale, 1.0)


def _root(matrix: Array, noise: Array, intensity: float) -> Array:
    """Symmetric square root of the stationary covariance of a filter.

    Normal numbers times this matrix are initial states with which the ground motion is stationary from
    its start. The symmetric root is unique. A root of eigenvectors is not, since their signs may change
    with rounding errors.
    """
    if not len(noise):
        return np.zeros((0, 0))
    covariance = scipy.linalg.solve_continuous_lyapunov(matrix, -intensity * np.outer(noise, noise))
    values, vectors = np.linalg.eigh(0.5 * (covariance + covariance.T))
    root: Array = vectors * np.sqrt(np.maximum(values, 0)) @ vectors.T
    return root
