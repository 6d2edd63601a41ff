"""Equations of transient linearization from models: structures, their pairs, and instants."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress
from stochlin.kernels.linearization.transient import Covariances, Difference, Law, Own, Structures
from stochlin.models.envelopes import Envelope, envelope_at
from stochlin.models.grounds import Ground
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.parameters import CASE
from stochlin.models.structures import Structure
from stochlin.models.systems import AnyStructure, Stack, first_period, stack_of
from stochlin.solver.linearization.equivalent_systems import solve_elastic
from stochlin.solver.tables import labels
from stochlin.solver.tables.cellwise import row_of
from stochlin.solver.tables.checks import check_duration
from stochlin.solver.tables.work import check_work

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
    unit: Array  # (n,) size of the displacement [m], in which errors count
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
    def law(self) -> Array:
        """Parameters of the law (k, n m) for all elements, cell by cell."""
        parameters = self.stack.law_parameters
        wide = np.broadcast_to(parameters, (*self.stack.system.mass.shape, parameters.shape[-1]))
        return wide.reshape(self.stack.system.mass.size, -1 if wide.size else 0).T

    @property
    def limits(self) -> Array:
        """Extension of each element at which the structure falls (n, m) [m]; infinite if it cannot."""
        return self.stack.limits

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
    period, oscillator = first_period(structure), structure
    if not isinstance(oscillator, Structure):  # of the first mode, whose response is only a unit
        modes = stack_of(structure).system.modes()
        oscillator = Bilinear(float(modes.period[0]), float(modes.damping[0]))
    elastic = solve_elastic(oscillator, ground)
    status = elastic.status.where(elastic.status >= labels.NOT_CONVERGED, labels.CONVERGED)
    status = status.where(period <= duration, labels.INVALID_INPUT)
    position = numbered(status < labels.NOT_CONVERGED, first)

    def rows(model: Structure | Ground) -> dict[str, Array]:
        return {name: of_cells(array, position).astype(float) for name, array in model.arrays().items()}

    model = structure
    if isinstance(model, Structure):
        strength = elastic.yield_displacement if model.yields else None
        model = replace(model, mass=None, reduction_factor=None, yield_displacement=strength)
        cells = {name: xr.DataArray(row, dims=CASE) for name, row in rows(model).items()}
        model = model.with_arrays(cells)
    stack = stack_of(model)
    soil, count = rows(ground), int((position >= 0).sum())
    stack = stack._replace(system=stack.system.over_cells(count))
    periods, unit = (of_cells(array, position) for array in (period, elastic.displacement_std))
    seen = stack.system.shapes[-1:]
    return StructureCells(structure, stack, periods, unit, soil, status, position, seen)


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
        numbers=COLUMNS * instants,
        seconds=1e-4 * instants,
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
    covariances = Covariances(equations, pairs, course.values)
    evaluations = RATES * course.duration * covariances.fastest
    check_work(
        f"{pairs.shape[1]} pairs at {course.times.size} instants, with {elements} storeys, would take",
        "take fewer cells at a time, storeys together, or a shorter motion",
        numbers=COLUMNS * course.times.size * elements * count,
        seconds=8e-11 * evaluations * count * states**3,
    )
    kinks = () if course.envelope is None else course.envelope.kinks()
    moments = covariances.solve(course.times, kinks, progress)
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
    system, below = side.stack.system, ground.filter(side.ground)
    unit = side.unit * np.array([np.ones_like(side.period), 2 * np.pi / side.period])
    return Structures(system, below, law, seen=side.seen, limit=side.limits, unit=unit)


def spread_over(values: Array, at: xr.DataArray) -> xr.DataArray:
    """Array with the dimensions of ``at`` from values of numbered cells, (n,) or (time, n)."""
    place = at.to_numpy().ravel()
    filled = np.full((*values.shape[:-1], place.size), np.nan)
    filled[..., place >= 0] = values[..., place[place >= 0]]
    lead = ("time",) if values.ndim == 2 else ()
    return xr.DataArray(
        filled.reshape((*values.shape[:-1], *at.shape)), dims=(*lead, *at.dims), coords=at.coords
    )
