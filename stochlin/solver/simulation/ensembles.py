"""Structures and their ground, prepared for a simulation of many motions (an ensemble).

Here the models become the arrays that the compiled time steps take. The time step is chosen, and the
computing time is estimated. The parameters of each single structure in a table are called a cell.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import scipy.linalg
import xarray as xr

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import cores
from stochlin.kernels.basics.systems import System
from stochlin.kernels.linearization.filters import Filter
from stochlin.kernels.simulation.ensemble import (
    Crowd,
    Oscillators,
    Plan,
    SteppedStructures,
    UncertainGround,
)
from stochlin.kernels.simulation.laws import BILINEAR, OTHER, VISCOUS
from stochlin.kernels.simulation.stepping import LANES, FilterSteps, filter_steps
from stochlin.kernels.simulation.time_step import Elements
from stochlin.models.grounds import Ground
from stochlin.models.structures import Structure
from stochlin.solver.linearization.equivalent_systems import solve_structure, solved_together
from stochlin.solver.linearization.tolerance import Tolerance
from stochlin.solver.simulation.connected_structures import SteppedGroup, laws_of
from stochlin.solver.tables import labels
from stochlin.solver.tables.cellwise import row_of
from stochlin.solver.tables.work import check_work

# The response is sampled this often in the shortest period. More samples would hardly make the estimated
# variance more accurate.
SAMPLES_PER_PERIOD = 2


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

    It has floors: an oscillator has one, a building with storeys has one for each storey. After the
    floors come the modes that yield.
    """

    crowd: Crowd  # all structures, grouped by the kind of their time steps, with ground and plan
    order: Array  # for each valid floor, its row in the crowd
    scale: Array  # for each valid floor, the unit in which its displacement is computed [m]
    memory: float  # [s], the longest time in which a vibration or a plastic drift decays
    valid: Array  # (n,) for each floor, whether it can be simulated
    period: Array  # [s], for each valid floor, the longest period of its structure
    drift_time: Array  # [s], for each valid floor, the time in which its plastic drift decays

    @property
    def plan(self) -> Plan:
        """Time step, duration, number and seed of the motions."""
        return self.crowd.plan

    @property
    def drift_memory(self) -> Array:
        """`drift_time` of all floors (n,) [s]; NaN of those that cannot be simulated."""
        times = np.full(self.valid.size, np.nan)
        times[self.valid] = self.drift_time
        return times

    def with_plan(self, **changes: Any) -> SimulationRun:
        """The run with other entries of the plan."""
        return self._replace(crowd=self.crowd._replace(plan=self.plan._replace(**changes)))


def cells_of(
    structure: Structure, ground: Ground, stationary: bool = True
) -> tuple[SimulationCells, xr.DataArray]:
    """The cells of a structure in one row, and for each cell of its table the position in this row.

    The decay time of the plastic drift is only computed for a ``stationary`` run, which needs it for its
    duration. Otherwise it is 0.
    """
    elastic = solved_together((structure,), ground).labelled(0, ["yield_displacement", "status"])
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
    with np.errstate(divide="ignore", invalid="ignore"):
        slow = np.where(pace > 0, 1 / (hardening * pace), 0)
        decay = 1 / (damping * (2 * np.pi / period))
    status = np.ravel(elastic["status"])
    cells = SimulationCells(
        period,
        damping,
        hardening,
        uy,
        np.reshape(rest, (len(rest), period.size)).T,
        np.full(period.size, structure.step(), object),
        decay,
        np.nan_to_num(slow),
        (status < labels.NOT_CONVERGED) & (row_of(structure.settles(), like) | (not stationary)),
    )
    return cells, xr.full_like(like, 0, dtype=int).copy(data=np.arange(period.size).reshape(like.shape))


def cells_of_all(
    structures: Sequence[Structure], ground: Ground, stationary: bool = True
) -> SimulationCells:
    """The cells of structures with scalar parameters, in their order."""
    return join_cells([cells_of(structure, ground, stationary)[0] for structure in structures])


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
    connected: Sequence[SteppedGroup] = (),
    floors: Sequence[int] | None = None,
    drift_times: Array | None = None,
    scatter: float = 0.0,
    grounds: Sequence[Ground] = (),
    moments: bool = True,
    step: float | None = None,
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
    connected : sequence of SteppedGroup
        Buildings with storeys and linked structures.
    floors : sequence of int, optional
        For each of the ``cells`` its number among the floors. Required with ``connected`` ones.
    drift_times : Array, optional
        For each floor the time in which its plastic drift decays [s]. The default are the times of the
        ``cells``.
    grounds : sequence of Ground
        Samples of an uncertain ground, one for each motion.
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
    count = own + sum(group.watched.size for group in connected)
    if moments:
        check_memory(count if cells is None or connected else int(cells.valid.sum()), paths)
    groups = list(connected)
    if cells is not None:
        groups = [*_oscillators(cells, np.arange(own) if floors is None else np.array(floors)), *groups]
        drift_times = cells.drift_time if drift_times is None else drift_times
    rows, (scale, period) = np.full(count, -1), np.full((2, count), np.nan)
    begin = 0
    for group in groups:
        rows[group.watched] = begin + np.arange(group.watched.size)
        scale[group.watched], period[group.watched] = group.scale, group.period
        begin += group.watched.size
    soil = ground.lone_filter()
    rates = -np.linalg.eigvals(soil.arrays.matrix).real if soil.states else np.array([np.inf])
    soils = [each.lone_filter() for each in grounds] or [soil]
    periods = [float(2 * np.pi / np.float64(each.fastest)) for each in soils if each.states]
    periods += [group.shortest for group in groups]
    memory = max(float((1 / rates).max()), *(group.slowest for group in groups))
    dt = step or min(periods) / steps_per_period
    every = max(1, steps_per_period // SAMPLES_PER_PERIOD)
    known = rows >= 0
    steps, roots = zip(*(ground_steps(each, dt) for each in soils), strict=True)
    plan = Plan(dt, every, 0, 0, groups=int(np.ceil(paths / LANES)), seed=seed, scatter=scatter)
    soil_steps = UncertainGround(steps, roots) if grounds else steps[0]
    return SimulationRun(
        Crowd([group.part for group in groups], soil_steps, roots[0], plan),
        rows[known],
        scale[known],
        memory,
        known,
        period[known],
        np.asarray(drift_times)[known],
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
    check_work(
        f"{structures} structures on one ground need",
        "simulate fewer structures at a time",
        numbers=structures**2 * (4.0 * LANES * at_once + 12),
    )


def seconds_of(run: SimulationRun, steps: float, distances: float = 0.0) -> float:
    """Seconds that one core takes for this many time ``steps``, approximately.

    At each step, ``distances`` relative displacements are recorded.
    """
    parts = run.crowd.parts
    kinds = [part.elements.kind for part in parts if isinstance(part, SteppedStructures)]
    together = sum(part.size for part in parts if isinstance(part, Oscillators))
    all_kinds = np.concatenate([np.full(together, BILINEAR), *kinds])
    step = (
        8e-9  # of the ground
        + 1.2e-9 * float((all_kinds < VISCOUS).sum())
        + 2.4e-7 * float((all_kinds == VISCOUS).sum())  # whose force is a power of the velocity
        + 6e-8 * float((all_kinds >= OTHER).sum())
        + 2e-9 * sum(kind.size**2 for kind in kinds)  # pairs of storeys of one building
        + 1e-9 * distances
    )
    return step * steps * run.plan.groups * LANES


def _oscillators(cells: SimulationCells, floors: Array) -> list[SteppedGroup]:
    """The valid structures, bilinear ones together; ``floors`` are the numbers of all cells.

    Displacements of bilinear structures are computed in units of the yield displacement, others in m.
    """
    valid = cells.valid
    w = 2 * np.pi / cells.period[valid]
    yields = np.isfinite(cells.yield_displacement[valid])
    alpha = np.where(yields, cells.hardening[valid], 1.0)
    scale = np.where(yields, cells.yield_displacement[valid], 1.0)
    friction, post, couple = 2 * cells.damping[valid] * w, alpha * w**2, (1 - alpha) * w**2
    step, law, period, slowest = (
        column[valid] for column in (cells.step, cells.law, cells.period, cells.damping_time)
    )
    bilinear = (step == BILINEAR) | ~yields
    groups: list[SteppedGroup] = []

    def add(part: Oscillators | SteppedStructures, members: Array, unit: Any) -> None:
        own = period[members]
        memory = float(slowest[members].max())
        groups.append(SteppedGroup(part, floors[valid][members], float(own.min()), memory, own, unit))

    together = np.flatnonzero(bilinear)
    if together.size:
        columns = np.stack([friction, post, couple, 1 / scale], axis=1)
        add(Oscillators(columns[together]), together, scale[together])
    for n in np.flatnonzero(~bilinear):
        spring = ([value] for value in (post[n], couple[n], scale[n]))
        unit = np.ones((1, 1))
        system = System(unit[0], friction[n] * unit, unit, unit, *map(np.array, spring))
        kinds, states, of_kinds = laws_of([step[n]])
        own = law[n][None, np.isfinite(law[n])]
        add(SteppedStructures(Elements(system, kinds, states, own), of_kinds), np.array([n]), 1.0)
    return groups


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
