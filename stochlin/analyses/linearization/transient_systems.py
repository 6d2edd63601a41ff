"""Equations of transient linearization from models: structures, their pairs, and instants."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import groupby
from typing import Any, NamedTuple

import numpy as np
import scipy.linalg
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
from stochlin.kernels.linearization.filters import Matrices
from stochlin.kernels.linearization.gaussian import ClosureInTime
from stochlin.kernels.linearization.systems.lyapunov import INACCURATE, UNSTABLE
from stochlin.kernels.linearization.systems.response import StationaryResponse, alike
from stochlin.kernels.linearization.transient import (
    NODES,
    NODES_OF_STOREYS,
    ChainEquations,
    Difference,
    Filters,
    LawsInTime,
    Own,
    StoreyChains,
    Transient,
)
from stochlin.models.buildings import MultistoreyBuilding
from stochlin.models.envelopes import Envelope, envelope_at
from stochlin.models.grounds import Ground
from stochlin.models.parameters import CASE
from stochlin.models.systems import AnyStructure, Arrangement, Stack, falls_at, stack_of

STEPS_PER_PERIOD = 16  # instants in the shortest period, for integrals over time
STRONG = 0.5  # share of the envelope's maximum below which shaking is no longer strong
SCANNED = 4096  # instants at which an envelope is evaluated for checks
COLUMNS = 8  # numbers that are stored for each structure or pair at an instant
AT_NODES = 100  # numbers in a panel for each one of the matrices of the filters
RATES = 20  # evaluations of the rates for each radian of the fastest mode, expected
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
    for cells, part in alike(equations.state_space(elastic, none, none > 0)):
        response = StationaryResponse(part)
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
    groups = _groups(sides, ground)
    fastest = max(group.fastest() for group in groups)
    n, m = sum(side.period.size for side in sides), max(side.elements for side in sides)
    k, filters = groups[0].filters.matrix.shape[-1], sum(group.filters.matrix.size for group in groups)
    evaluations = RATES * fastest * course.duration
    check_work(
        f"{pairs.shape[1]} pairs at {course.times.size} instants, with {m} storeys, would take",
        "take fewer cells at a time, storeys together, or a shorter motion",
        {
            "cubes of states in motion": evaluations
            * ((n + 2 * pairs.shape[1]) * (3 * m) ** 3 + 3 * m * k * n + filters),
            "numbers": COLUMNS * course.times.size * m * (n + pairs.shape[1]) + AT_NODES * filters,
        },
    )
    laws = _laws_in_time(sides) if any(group.yields.any() for group in groups) else None
    transient = Transient(groups, pairs, laws, course.values)
    kinks = () if course.envelope is None else course.envelope.kinks()
    return TransientMoments(*transient.solve(course.times, kinks, progress), tuple(sides), course)


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


def _groups(sides: Sequence[StructureCells], ground: Ground) -> list[ChainEquations]:
    """Equations of all cells; sides with the same number of elements are one group."""
    groups = []
    nodes = NODES_OF_STOREYS if any(side.elements > 1 for side in sides) else NODES
    for _, members in groupby(sides, lambda side: side.elements):
        alike = list(members)
        parts = zip(*map(_structures, alike), strict=True)
        structures = StoreyChains(*map(np.concatenate, parts))
        groups.append(ChainEquations(structures, _filters(ground, grounds_of(alike)), nodes))
    return groups


def _structures(side: StructureCells) -> StoreyChains:
    """Equations of the extensions ``d = E u``, from ``M u'' = -C u' - E' (k d - h y) + M 1 f``."""
    mass, damping, extensions, _, _, couple, strength = side.stack.system
    floors, by_forces = np.linalg.inv(extensions), extensions / mass[:, None]
    shears, seen = by_forces @ extensions.T, side.seen @ floors
    return StoreyChains(
        2 * np.pi / side.period,
        shears * side.stack.system.elastic[:, None],
        by_forces @ damping @ floors,
        shears * couple[:, None],
        strength,
        side.limits,
        side.elastic_std,
        np.broadcast_to(extensions.sum(axis=1), mass.shape),
        np.broadcast_to(seen, (len(mass), *seen.shape)),
    )


def _laws_in_time(sides: Sequence[StructureCells]) -> LawsInTime:
    """The closures of all yielding elements by their laws, whose first state is the energy."""
    yielding = [side for side in sides if side.structure.yields]

    def closure_of(side: StructureCells) -> ClosureInTime:
        return side.stack.law.closure_in_time()

    def law_of(side: StructureCells) -> Array:
        return side.law[:, np.isfinite(side.stack.system.strength.ravel())]

    groups = [
        (closure, np.concatenate([law_of(side) for side in members], axis=1))
        for closure, members in groupby(yielding, closure_of)
    ]
    ends = np.cumsum([law.shape[1] for _, law in groups])
    states = 1 + max(closure.states for closure, _ in groups)

    def closure(latent: Array, means: Array) -> tuple[Array, Array]:
        coefficients, rates = np.empty((2, *latent.shape[1:])), np.zeros(means.shape)
        rates[0] = latent.prod(axis=0)
        for (of_law, law), end in zip(groups, ends, strict=True):
            cells, own = slice(end - law.shape[1], end), slice(1, 1 + of_law.states)
            part = latent[..., cells]
            spread = law.reshape(len(law), *(1,) * (part.ndim - 2), law.shape[1])
            spread = np.broadcast_to(spread, (len(law), *part.shape[1:]))
            rows = np.concatenate([spread, means[own, ..., cells]])
            flat = part.reshape(3, -1), rows.reshape(len(rows), part[0].size)
            found = of_law.closure(*flat).coefficients
            coefficients[..., cells] = found.reshape(2, *part.shape[1:])
            rates[own, ..., cells] = of_law.mean_rates(*flat).reshape(of_law.states, *part.shape[1:])
        return coefficients, rates

    return LawsInTime(states, closure)


def _filters(ground: Ground, values: Mapping[str, Array]) -> Filters:
    """Ground filters of the cells; equal filters are computed once."""
    intensity = 2 * np.pi * values["intensity"]
    shape = {name: row for name, row in values.items() if name != "intensity"}
    table = np.stack([np.zeros_like(intensity), *shape.values()])
    alike, which = np.unique(table, axis=1, return_inverse=True)

    def unit(column: Array) -> Matrices:
        parameters = dict(zip(shape, column.tolist(), strict=True))
        return ground.filter({"intensity": 1.0, **parameters}).arrays

    filters = [_in_standard_deviations(unit(column)) for column in alike[1:].T]
    cells = which.ravel()
    if len(filters) == 1 and np.ptp(intensity) == 0:  # one ground for all
        cells, intensity = cells[:1], intensity[:1]
    matrix, *parts = (np.stack(parts)[cells] for parts in zip(*filters, strict=True))
    return Filters(
        matrix, *(np.sqrt(intensity).reshape(-1, *(1,) * (part.ndim - 1)) * part for part in parts)
    )


def _in_standard_deviations(unit: Matrices) -> Filters:
    """One filter under unit white noise, with states of unit variance."""
    matrix, noise, output = unit
    if not noise.size:
        return Filters(matrix, output, output, np.array(1.0))
    covariance = scipy.linalg.solve_continuous_lyapunov(matrix, -np.outer(noise, noise))
    scale = np.sqrt(np.diag(covariance))
    push = covariance @ output
    return Filters(matrix * scale / scale[:, None], output * scale, push / scale, np.array(0.0))


def spread_over(values: Array, at: xr.DataArray) -> xr.DataArray:
    """Array with the dimensions of ``at`` from values of numbered cells, (n,) or (time, n)."""
    place = at.to_numpy().ravel()
    filled = np.full((*values.shape[:-1], place.size), np.nan)
    filled[..., place >= 0] = values[..., place[place >= 0]]
    lead = ("time",) if values.ndim == 2 else ()
    return xr.DataArray(
        filled.reshape((*values.shape[:-1], *at.shape)), dims=(*lead, *at.dims), coords=at.coords
    )
