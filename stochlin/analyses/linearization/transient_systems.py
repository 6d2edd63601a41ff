"""Equations of transient linearization from models: structures, their pairs, and instants."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from stochlin.analyses.linearization.equivalent_systems import solve_elastic
from stochlin.analyses.linearization.systems.state_space import Equations
from stochlin.analyses.tables import labels
from stochlin.analyses.tables.cellwise import row_of
from stochlin.analyses.tables.checks import check_duration
from stochlin.analyses.tables.work import check_work
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress
from stochlin.kernels.basics.systems import System
from stochlin.kernels.linearization.systems.lyapunov import INACCURATE, UNSTABLE
from stochlin.kernels.linearization.systems.response import responses
from stochlin.kernels.linearization.transient import Covariances, Difference, Law, Own, Structures
from stochlin.models.buildings import MultistoreyBuilding
from stochlin.models.envelopes import Envelope, envelope_at
from stochlin.models.grounds import Ground
from stochlin.models.parameters import CASE
from stochlin.models.systems import AnyStructure, Arrangement, Stack, falls_at, stack_of

STEPS_PER_PERIOD = 16  # instants in the shortest period, for integrals over time
STRONG = 0.5  # share of the envelope's maximum below which shaking is no longer strong
SCANNED = 4096  # instants at which an envelope is evaluated for checks
COLUMNS = 8  # numbers that are stored for each structure or pair at an instant
RATES = 6  # evaluations of the rates for each radian of the fastest mode, expected
POINTS = 101  # instants of a result
TIME = "time"


class StructureCells(NamedTuple):
    """One of the structures, with its n valid cells in a row."""

    structure: AnyStructure
    stack: Stack  # its system has the leading axis of the cells; an oscillator has a mass of 1 kg
    period: Array  # (n,) [s]; that of a building is its first one
    elastic_std: Array  # (n, m) standard deviations of the elastic extensions [m]
    law: Array  # (k, n m) parameters of the law for all elements, cell by cell
    ground: Mapping[str, Array]  # parameters of the ground, (n,) each
    status: xr.DataArray
    position: xr.DataArray  # number of each cell in the row of all structures, -1 if invalid
    seen: Array  # (h, m) factors that give the displacements of the result from the coordinates

    @property
    def has_storeys(self) -> bool:
        """Whether the structure is a building with storeys."""
        return not self.stack.is_oscillator

    @property
    def elements(self) -> int:
        """Number of storeys or modes; 1 for oscillators."""
        return self.stack.coordinates

    @property
    def limits(self) -> Array:
        """Extension of each element at which the structure falls (n, m) [m]; infinite if it cannot."""
        if self.has_storeys:
            return self.stack.limits
        largest = of_cells(self.stack.law.largest_z(), self.position)[:, None]
        system = self.stack.system
        return falls_at(system.post, system.couple, system.strength * largest)

    def stack_at(self, cell: int) -> Stack:
        """The structure of one cell."""
        return self.stack._replace(system=self.stack.system.at(cell))


class TimeGrid(NamedTuple):
    """The instants of a finite motion."""

    envelope: Envelope | None
    duration: float
    times: Array  # [s], for integrals over time
    shown: Array  # indices of the instants of the result
    strong_end: float  # end of the strong shaking [s]

    def values(self, times: Array) -> Array:
        """Values of the envelope at times [s]."""
        return envelope_at(self.envelope, times)


class TransientMoments(NamedTuple):
    """Second moments of all valid cells at the instants of the course."""

    own: Own
    difference: Difference
    sides: tuple[StructureCells, ...]
    course: TimeGrid


def check_course(duration: float | None, envelope: Envelope | None) -> float:
    """The duration [s], checked together with the envelope."""
    seconds = check_duration(duration)
    if envelope is None:
        return seconds
    values = np.asarray(envelope.at(np.linspace(0, seconds, SCANNED)), float)
    if not np.isfinite(values).all() or values.min() < 0:
        raise ValueError(
            f"envelope = {envelope.describe()} is {values[~(values >= 0)][0]:g} within the duration; "
            "allowed: finite values from 0 on"
        )
    if not values.max() > 0:
        raise ValueError(
            f"envelope = {envelope.describe()} is 0 during the whole duration = {seconds:g}; allowed: "
            "positive values within the duration"
        )
    return seconds


def side_of(
    structure: AnyStructure, ground: Ground, duration: float, role: str, first: int
) -> StructureCells:
    """Valid cells of a structure, numbered from ``first``; the displacement of a building is its roof's.

    Cells with a period longer than the motion are invalid.
    """
    check_duration(duration, {role: structure})
    if isinstance(structure, MultistoreyBuilding):
        return _building(structure, ground, role, first)
    elastic = solve_elastic(structure, ground)
    values = structure.arrays()
    own = (
        values["period"],
        values["damping"],
        values.get("hardening", xr.DataArray(1.0)),
        elastic.yield_displacement,
        elastic.displacement_std,
    )
    status = elastic.status.where(elastic.status >= labels.NOT_CONVERGED, labels.CONVERGED)
    status = status.where(values["period"] <= duration, labels.INVALID_INPUT)
    valid = status < labels.NOT_CONVERGED
    position = numbered(valid, first)

    def row(array: xr.DataArray) -> Array:
        return of_cells(array, position).astype(float)

    period, damping, hardening, uy, std = (row(array)[:, None] for array in own)
    w, share = 2 * np.pi / period, np.where(np.isinf(uy), 1.0, hardening)
    mass, friction, unit = np.ones_like(w), (2 * damping * w)[..., None], np.ones((1, 1))
    system = System(mass, friction, unit, unit, share * w**2, (1 - share) * w**2, uy)
    law = [row(array) for array in structure.law_parameters()]
    return StructureCells(
        structure,
        Stack(system, np.full(1, np.nan), structure, unit),
        period[:, 0],
        std,
        np.array(law).reshape(len(law), int(valid.sum())),
        {name: row(array) for name, array in ground.arrays().items()},
        status,
        position,
        np.ones((1, 1)),
    )


def _building(structure: MultistoreyBuilding, ground: Ground, role: str, first: int) -> StructureCells:
    """`side_of` for a building with storeys."""
    valid = ground.valid()
    position = numbered(valid, first)
    below = {name: of_cells(array, position).astype(float) for name, array in ground.arrays().items()}
    stack, count = stack_of(structure), int(valid.sum())
    elastic, none = np.full(stack.coordinates, -1.0), np.zeros(stack.coordinates)
    rows = {name: xr.DataArray(row, dims=CASE) for name, row in below.items()}
    equations = Equations(Arrangement((stack,), ()), ground.with_arrays(rows))
    drifts = np.empty((count, stack.coordinates))
    for cells, response in responses(equations.state_space(elastic, none, none > 0)):
        drifts[cells] = response.std(stack.system.extensions)
        if not np.isfinite(drifts[cells]).all():
            raise ArithmeticError(
                f"{role}, elastic: {INACCURATE if response.stable.all() else UNSTABLE}; use storeys "
                "whose stiffness over mass differs less"
            )
    return StructureCells(
        structure,
        stack._replace(system=equations.system),
        np.full(count, float(structure.mode_periods()[0])),
        drifts,
        np.tile(stack.law_parameters.T, count),
        below,
        labels.status_where(valid),
        position,
        stack.system.shapes[-1:],
    )


def ground_of(ground: Ground, values: Mapping[str, Array], cell: int) -> Ground:
    """Ground of one cell, from the parameters of all cells."""
    own: dict[str, Any] = {name: float(row[cell]) for name, row in values.items()}
    return replace(ground, **own)


def numbered(valid: xr.DataArray, first: int = 0) -> xr.DataArray:
    """Consecutive numbers of the valid cells from ``first`` on, and -1 for the others."""
    flat = valid.to_numpy().ravel()
    number = np.where(flat, first + np.cumsum(flat) - 1, -1)
    return xr.DataArray(number.reshape(valid.shape), dims=valid.dims, coords=valid.coords)


def of_cells(array: xr.DataArray, at: xr.DataArray) -> Array:
    """Values of the cells with a number in ``at``, in the order of the cells."""
    return row_of(array, at)[at.to_numpy().ravel() >= 0]


def oscillators_of(sides: Sequence[StructureCells]) -> tuple[Array, Array, Array, Array]:
    """Periods [s], damping and hardening ratios and yield displacements [m] (n,) of all structures.

    None of them is a building with storeys.
    """
    systems = [side.stack.system for side in sides]
    damping, post, elastic, uy = (
        np.concatenate([getattr(system, name).ravel() for system in systems])
        for name in ("damping", "post", "elastic", "strength")
    )
    period = np.concatenate([side.period for side in sides])
    return period, damping * period / (4 * np.pi), post / elastic, uy


def shortest_period(sides: Sequence[StructureCells]) -> float:
    """Shortest period of all cells [s]; that of a building is its first one."""
    return float(np.concatenate([side.period for side in sides]).min())


def grounds_of(sides: Sequence[StructureCells]) -> dict[str, Array]:
    """Parameters of the grounds of all cells, in one row."""
    return {name: np.concatenate([side.ground[name] for side in sides]) for name in sides[0].ground}


def course_of(envelope: Envelope | None, duration: float, shortest: float, points: int) -> TimeGrid:
    """Instants of a motion, close enough for integrals over time with the shortest period."""
    stretches = points - 1
    instants = duration * STEPS_PER_PERIOD / shortest
    check_work(
        f"duration = {duration:g} s, with a shortest period of {shortest:.3g} s, would take",
        "shorten it, or leave out the shortest period",
        {"instants of a motion": instants, "numbers": COLUMNS * instants},
    )
    each = max(1, int(np.ceil(instants / stretches)))
    times = np.linspace(0, duration, stretches * each + 1)
    shown = np.arange(points) * each
    scan = np.linspace(0, duration, SCANNED)
    values = envelope_at(envelope, scan)
    strong = np.flatnonzero(values >= STRONG * values.max())
    last = duration if strong[-1] == SCANNED - 1 else float(scan[strong[-1] + 1])
    return TimeGrid(envelope, float(duration), times, shown, last)


def solve_course(
    sides: Sequence[StructureCells],
    ground: Ground,
    pairs: Array,
    course: TimeGrid,
    progress: Progress | None = None,
) -> TransientMoments:
    """Second moments of all structures and of pairs of them, which are at rest at first.

    ``pairs`` (2, p) has the numbers of their cells. ``progress`` is called with the share of the
    duration that is done.
    """
    equations = [_equations(side, ground) for side in sides]
    states = max(part.matrix.shape[-1] for part in equations)
    elements = max(side.elements for side in sides)
    count = sum(side.period.size for side in sides) + 2 * pairs.shape[1]
    evaluations = RATES * course.duration * max(part.fastest for part in equations)
    check_work(
        f"{pairs.shape[1]} pairs at {course.times.size} instants, with {elements} storeys, would take",
        "take fewer cells at a time, storeys together, or a shorter motion",
        {
            "cubes of states in motion": evaluations * count * states**3,
            "numbers": COLUMNS * course.times.size * elements * count,
        },
    )
    kinks = () if course.envelope is None else course.envelope.kinks()
    moments = Covariances(equations, pairs, course.values).solve(course.times, kinks, progress)
    return TransientMoments(*moments, tuple(sides), course)


def over_time(table: xr.Dataset, course: TimeGrid) -> xr.Dataset:
    """The table with the times, the envelope, and a flag for the end of the strong shaking."""
    time = labels.axis(TIME, "time", course.times[course.shown], "s")
    flag = {
        "long_name": f"envelope finally below {STRONG:g} of its maximum",
        "flag_values": np.arange(2, dtype=np.int8),
        "flag_meanings": "strong_shaking permanent_set_not_represented",
    }
    return (
        table.assign(
            envelope=("time", course.values(time.to_numpy())),
            permanent_set=("time", (time.values > course.strong_end).astype(np.int8), flag),
        )
        .assign_coords(time=time)
        .assign_attrs(
            duration_s=course.duration,
            envelope_model="none" if course.envelope is None else course.envelope.describe(),
            strong_shaking_end_s=course.strong_end,
        )
    )


def _equations(side: StructureCells, ground: Ground) -> Structures:
    """Equations of the cells of a structure."""
    yields = side.structure.yields
    law = Law(side.stack.law.closure_in_time(), side.law) if yields else None
    return Structures(
        side.stack.system,
        ground.filter(side.ground),
        law,
        scale=side.elastic_std,
        frequency=2 * np.pi / side.period,
        seen=side.seen,
        limit=side.limits,
    )


def spread_over(values: Array, at: xr.DataArray) -> xr.DataArray:
    """Array with the dimensions of ``at`` from values of numbered cells, (n,) or (time, n)."""
    place = at.to_numpy().ravel()
    filled = np.full((*values.shape[:-1], place.size), np.nan)
    filled[..., place >= 0] = values[..., place[place >= 0]]
    lead = ("time",) if values.ndim == 2 else ()
    return xr.DataArray(
        filled.reshape((*values.shape[:-1], *at.shape)), dims=(*lead, *at.dims), coords=at.coords
    )
