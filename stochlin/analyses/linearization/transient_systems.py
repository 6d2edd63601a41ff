"""From models to the equations of transient linearization: cells, pairs of them, and instants."""

from __future__ import annotations

from collections.abc import Collection, Hashable, Mapping, Sequence
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
from stochlin.kernels.linearization.augmented import Solved
from stochlin.kernels.linearization.filters import Matrices
from stochlin.kernels.linearization.gaussian import Closure
from stochlin.kernels.linearization.lyapunov import UnsolvableError
from stochlin.kernels.linearization.transient import (
    Coefficients,
    Difference,
    Filters,
    Own,
    Structures,
    Transient,
)
from stochlin.models.buildings import ShearBuilding
from stochlin.models.envelopes import Envelope, envelope_at
from stochlin.models.grounds import Ground
from stochlin.models.parameters import expect
from stochlin.models.structures import Structure
from stochlin.models.systems import AnyStructure, Stack, System, stack_of

STEPS_PER_PERIOD = 16  # of the shortest period, for integrals over time
STRONG = 0.5  # of the envelope's largest value: shaking is strong until it falls below for good
SCANNED = 4096  # instants at which an envelope is looked at
COLUMNS = 8  # numbers that are held of each structure and pair at an instant
INSTANT = 1e-4  # [s] of integration, roughly
RATES = 20  # nodes times sweeps, roughly, for each radian of the fastest mode
PRODUCT = 8e-11  # [s] of each, for the states of a structure cubed
POINTS = 101  # instants of a result
TIME = "time"
LACKING = {"yield_displacement": np.inf, "scale": 1.0}  # of storeys that others have; else 0


class Oscillators(NamedTuple):
    """Structures in a row, (n,)."""

    period: Array
    damping: Array
    hardening: Array
    yield_displacement: Array  # infinite where elastic
    elastic_std: Array  # of the displacement, were it elastic [m]


class Storeys(NamedTuple):
    """A building with storeys, on each of its grounds (n,)."""

    stack: Stack
    period: Array  # (n,), the same for all
    elastic_std: Array  # (n, m) of the drifts, were it elastic [m]


class Side(NamedTuple):
    """One structure: its cells in a row, and where each is."""

    structure: AnyStructure
    cells: Oscillators | Storeys
    law: Array  # (k, n m): of all storeys, cell by cell
    ground: Mapping[str, Array]  # its parameters, (n,) each
    status: xr.DataArray
    position: xr.DataArray  # of each cell in the row of all sides, -1 where invalid
    seen: Array  # (h, m): displacements that are looked at, by those of the floors

    @property
    def has_storeys(self) -> bool:
        """Whether it is a building."""
        return isinstance(self.cells, Storeys)

    def stack(self, cell: int) -> Stack:
        """The structure of a cell, of a mass of 1 kg if it is an oscillator."""
        if isinstance(self.cells, Storeys):
            return self.cells.stack
        period, damping, hardening, uy, _ = (column[cell : cell + 1] for column in self.cells)
        assert isinstance(self.structure, Structure)
        w, share = 2 * np.pi / period, np.where(np.isinf(uy), 1.0, hardening)
        return Stack(
            mass=np.ones(1),
            post=share * w**2,
            couple=(1 - share) * w**2,
            strength=uy,
            damping=(2 * damping * w)[None],
            levels=np.full(1, np.nan),
            law=self.structure,
        )


class Course(NamedTuple):
    """The instants of a finite motion."""

    envelope: Envelope | None
    duration: float
    times: Array  # for integrals
    shown: Array  # indices of the instants of the result
    strong_end: float  # [s]

    def values(self, times: Array) -> Array:
        """The envelope at instants [s]."""
        return envelope_at(self.envelope, times)


class Moments(NamedTuple):
    """Moments of all cells that are valid, over the instants for integrals."""

    own: Own
    difference: Difference
    sides: tuple[Side, ...]
    course: Course


def check_course(duration: float | None, envelope: Envelope | None) -> float:
    """The duration; raises for what is no finite motion. To be called before any work."""
    seconds = check_duration(duration)
    if envelope is None:
        return seconds
    expect(envelope, Envelope, "envelope")
    values = np.asarray(envelope.at(np.linspace(0, seconds, SCANNED)), float)
    if not np.isfinite(values).all() or values.min() < 0:
        raise ValueError(
            f"envelope = {envelope.describe()} is {values[~(values >= 0)][0]:g} within the duration; "
            "allowed: finite values from 0 on"
        )
    if not values.max() > 0:
        raise ValueError(
            f"envelope = {envelope.describe()} is 0 all through duration = {seconds:g}; allowed: some "
            "motion within the duration"
        )
    return seconds


def check_names(roles: str, dims: Collection[Hashable], own: Sequence[str]) -> None:
    """Raise a ValueError if a dimension has the name of one that the result has of its own."""
    for name in own:
        if name in dims:
            raise ValueError(
                f"{roles}: a dimension is named {name!r}, as one of the result is; give it another name"
            )


def side_of(structure: AnyStructure, ground: Ground, duration: float, role: str, first: int) -> Side:
    """The cells of a structure, numbered from ``first``; those longer than the motion are invalid.

    Of a building its roof is looked at.
    """
    check_duration(duration, {role: structure})
    if isinstance(structure, ShearBuilding):
        return _building(structure, ground, role, first)
    period = structure.arrays()["period"]
    elastic = solve_elastic(structure, ground)
    values = structure.arrays()
    like = elastic.yield_displacement
    own = (
        values["period"],
        values["damping"],
        values.get("hardening", xr.DataArray(1.0)),
        like,
        elastic.displacement_std,
    )
    status = elastic.status.where(elastic.status >= labels.NOT_CONVERGED, labels.CONVERGED)
    status = status.where(period <= duration, labels.INVALID_INPUT)
    valid = status < labels.NOT_CONVERGED
    position = numbered(valid, first)

    def row(array: xr.DataArray) -> Array:
        return of_cells(array, position).astype(float)

    law = [row(array) for array in structure.law_parameters()]
    return Side(
        structure,
        Oscillators(*map(row, own)),
        np.array(law).reshape(len(law), int(valid.sum())),
        {name: row(array) for name, array in ground.arrays().items()},
        status,
        position,
        np.ones((1, 1)),
    )


def _building(structure: ShearBuilding, ground: Ground, role: str, first: int) -> Side:
    valid = ground.valid()
    position = numbered(valid, first)
    below = {name: of_cells(array, position).astype(float) for name, array in ground.arrays().items()}
    stack, count = stack_of(structure), int(valid.sum())
    system = System((stack,), ())
    elastic, none = np.full(structure.storeys, -1.0), np.zeros(structure.storeys)
    drifts = []
    for cell in range(count):
        equations = Equations(system, ground_of(ground, below, cell))
        try:
            motion = Solved(equations.augmented(elastic, none, none > 0))
        except UnsolvableError as error:
            raise ArithmeticError(
                f"{role}, elastic: {error}; use storeys whose stiffness over mass differs less"
            ) from error
        drifts.append(motion.std(system.extensions))
    return Side(
        structure,
        Storeys(
            stack,
            np.full(count, float(structure.periods()[0])),
            np.array(drifts).reshape(count, structure.storeys),
        ),
        np.tile(stack.law_parameters.T, count),
        below,
        labels.status_where(valid),
        position,
        np.eye(structure.storeys)[-1:],
    )


def ground_of(ground: Ground, values: Mapping[str, Array], cell: int) -> Ground:
    """The ground of one cell."""
    own: dict[str, Any] = {name: float(row[cell]) for name, row in values.items()}
    return replace(ground, **own)


def numbered(valid: xr.DataArray, first: int = 0) -> xr.DataArray:
    """Numbers of the cells that are valid, in their order; -1 where they are not."""
    flat = valid.to_numpy().ravel()
    number = np.where(flat, first + np.cumsum(flat) - 1, -1)
    return xr.DataArray(number.reshape(valid.shape), dims=valid.dims, coords=valid.coords)


def of_cells(array: xr.DataArray, at: xr.DataArray) -> Array:
    """The values of the cells that have a number in ``at``, in their order."""
    return row_of(array, at)[at.to_numpy().ravel() >= 0]


def oscillators_of(sides: Sequence[Side]) -> Oscillators:
    """The structures of all sides in one row; none of them has storeys."""
    return Oscillators(*map(np.concatenate, zip(*(side.cells for side in sides), strict=True)))


def shortest_period(sides: Sequence[Side]) -> float:
    """Of all cells, of buildings that of their first mode [s]."""
    return float(np.concatenate([side.cells.period for side in sides]).min())


def grounds_of(sides: Sequence[Side]) -> dict[str, Array]:
    """The parameters of their grounds."""
    return {name: np.concatenate([side.ground[name] for side in sides]) for name in sides[0].ground}


def course_of(envelope: Envelope | None, duration: float, shortest: float, points: int) -> Course:
    """Instants so dense that integrals over time are right for the shortest period."""
    stretches = points - 1
    instants = duration * STEPS_PER_PERIOD / shortest
    check_work(
        f"duration = {duration:g} s, with a shortest period of {shortest:.3g} s, would take",
        "shorten it, or leave out the shortest period",
        memory=8 * COLUMNS * instants,
        seconds=INSTANT * instants,
    )
    each = max(1, int(np.ceil(instants / stretches)))
    times = np.linspace(0, duration, stretches * each + 1)
    shown = np.arange(points) * each
    scan = np.linspace(0, duration, SCANNED)
    values = envelope_at(envelope, scan)
    strong = np.flatnonzero(values >= STRONG * values.max())
    last = duration if strong[-1] == SCANNED - 1 else float(scan[strong[-1] + 1])
    return Course(envelope, float(duration), times, shown, last)


def solve_course(sides: Sequence[Side], ground: Ground, pairs: Array, course: Course) -> Moments:
    """Second moments of all structures and pairs (2, p) of them, from rest."""
    structures = _structures(sides)
    fastest = np.sqrt(np.abs(structures.stiffness).sum(axis=-1).max())
    n, m = structures.scale.shape
    check_work(
        f"{pairs.shape[1]} pairs at {course.times.size} instants, with {m} storeys, would take",
        "take fewer cells at a time, storeys together, or a shorter motion",
        memory=8 * COLUMNS * course.times.size * m * (n + pairs.shape[1]),
        seconds=RATES * fastest * course.duration * PRODUCT * (n + 2 * pairs.shape[1]) * (3 * m) ** 3,
    )
    filters = _filters(ground, grounds_of(sides))
    closure = _coefficients(sides) if np.isfinite(structures.yield_displacement).any() else None
    transient = Transient(structures, filters, pairs, closure, course.values)
    kinks = () if course.envelope is None else course.envelope.kinks()
    return Moments(*transient.solve(course.times, kinks), tuple(sides), course)


def over_time(table: xr.Dataset, course: Course) -> xr.Dataset:
    """The table with its instants, the envelope there, and whether strong shaking is over."""
    time = labels.axis(TIME, "time", course.times[course.shown], "s")
    flag = {
        "long_name": f"whether the envelope has fallen for good below {STRONG:g} of its largest value",
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


def _structures(sides: Sequence[Side]) -> Structures:
    """All cells of all sides, as wide as the one with most storeys."""
    parts = [
        _storeys(side.cells, side.seen) if isinstance(side.cells, Storeys) else _oscillators(side.cells)
        for side in sides
    ]
    widest = max(part.scale.shape[1] for part in parts)
    kinds = zip(Structures._fields, zip(*parts, strict=True), strict=True)
    return Structures(
        *(np.concatenate([_widened(name, array, widest) for array in arrays]) for name, arrays in kinds)
    )


def _widened(name: str, array: Array, storeys: int) -> Array:
    """With the storeys that a structure lacks."""
    lead = 2 if name == "seen" else 1
    wider = [(0, 0) if axis < lead else (0, storeys - n) for axis, n in enumerate(array.shape)]
    return np.pad(array, wider, constant_values=LACKING.get(name, 0.0))


def _oscillators(cells: Oscillators) -> Structures:
    period, damping, hardening, uy, scale = cells
    w = 2 * np.pi / period
    coupling = np.where(np.isinf(uy), 0.0, (1 - hardening) * w**2)
    by_drift, by_rate, by_slip = (c[:, None, None] for c in (w**2, 2 * damping * w, coupling))
    seen = np.ones((w.size, 1, 1))
    return Structures(w, by_drift, by_rate, by_slip, uy[:, None], scale[:, None], seen)


def _storeys(cells: Storeys, seen: Array) -> Structures:
    """Of the drifts: floors ``M u'' = -C u' - T' (k d - h y) + M 1 f`` by ``d = T u``."""
    stack, period, scale = cells
    drifts = System((stack,), ()).extensions
    floors = np.linalg.inv(drifts)
    shears = (drifts / stack.mass) @ drifts.T

    def everywhere(array: Array) -> Array:
        return np.broadcast_to(array, (period.size, *array.shape))

    return Structures(
        2 * np.pi / period,
        everywhere(shears * stack.elastic),
        everywhere((drifts / stack.mass) @ stack.damping @ floors),
        everywhere(shears * stack.couple),
        everywhere(stack.strength),
        scale,
        everywhere(seen @ floors),
    )


def _coefficients(sides: Sequence[Side]) -> Coefficients:
    """Equivalent coefficients of all storeys that yield, by the closures of their laws."""
    yielding = [side for side in sides if side.structure.yields]

    def closure_of(side: Side) -> Closure:
        return side.stack(0).law.closure("gaussian")

    def law_of(side: Side) -> Array:
        cells = side.cells
        uy = cells.stack.strength if isinstance(cells, Storeys) else cells.yield_displacement
        return side.law[:, np.isfinite(np.resize(uy, side.law.shape[1]))]

    groups = [
        (closure, np.concatenate([law_of(side) for side in members], axis=1))
        for closure, members in groupby(yielding, closure_of)
    ]
    ends = np.cumsum([law.shape[1] for _, law in groups])

    def coefficients(latent: Array) -> Array:
        found, states = [], latent[0, ..., 0].size
        for (closure, law), end in zip(groups, ends, strict=True):
            part = latent[..., end - law.shape[1] : end]
            of_all = law if states == 1 else np.tile(law, states)
            found.append(closure(part.reshape(3, -1), of_all).coefficients.reshape(2, *part.shape[1:]))
        return np.concatenate(found, axis=-1)

    return coefficients


def _filters(ground: Ground, values: Mapping[str, Array]) -> Filters:
    """Ground filters of the cells, those alike found once."""
    intensity = 2 * np.pi * values["intensity"]
    shape = {name: row for name, row in values.items() if name != "intensity"}
    table = np.stack([np.zeros_like(intensity), *shape.values()])
    alike, which = np.unique(table, axis=1, return_inverse=True)
    found = [
        _in_standard_deviations(
            ground.filter({"intensity": 1.0, **dict(zip(shape, column.tolist(), strict=True))}).arrays
        )
        for column in alike[1:].T
    ]
    matrix, output, covariance = (np.stack(parts)[which.ravel()] for parts in zip(*found, strict=True))
    white = np.zeros_like(intensity) if output.size else intensity
    return Filters(matrix, output * np.sqrt(intensity)[:, None], covariance, white)


def _in_standard_deviations(unit: Matrices) -> tuple[Array, Array, Array]:
    """Matrix, output and covariance of a filter under a unit of noise, its states over their std."""
    matrix, noise, output = unit
    if not noise.size:
        return matrix, output, matrix
    covariance = scipy.linalg.solve_continuous_lyapunov(matrix, -np.outer(noise, noise))
    scale = np.sqrt(np.diag(covariance))
    return matrix * scale / scale[:, None], output * scale, covariance / np.outer(scale, scale)


def spread_over(values: Array, at: xr.DataArray) -> xr.DataArray:
    """Values (..., numbers) laid out where ``at`` has their numbers, after ``time`` if that is there."""
    place = at.to_numpy().ravel()
    filled = np.full((*values.shape[:-1], place.size), np.nan)
    filled[..., place >= 0] = values[..., place[place >= 0]]
    lead = ("time",) if values.ndim == 2 else ()
    return xr.DataArray(
        filled.reshape((*values.shape[:-1], *at.shape)), dims=(*lead, *at.dims), coords=at.coords
    )
