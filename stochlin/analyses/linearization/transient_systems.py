"""From models to the equations of transient linearization: cells, pairs of them, and instants."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import groupby
from typing import NamedTuple

import numpy as np
import scipy.linalg
import xarray as xr

from stochlin.analyses.linearization.equivalent_systems import solve_elastic
from stochlin.analyses.tables import labels
from stochlin.analyses.tables.cellwise import row_of
from stochlin.analyses.tables.checks import check_duration
from stochlin.analyses.tables.work import check_work
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization.filters import Matrices
from stochlin.kernels.linearization.fixed_point import Closure
from stochlin.kernels.linearization.transient import (
    Coefficients,
    Difference,
    Filters,
    Own,
    Structures,
    Transient,
)
from stochlin.models.envelopes import Envelope
from stochlin.models.grounds import Ground
from stochlin.models.parameters import expect
from stochlin.models.structures import Structure

STEPS_PER_PERIOD = 16  # of the shortest period, for integrals over time
STRONG = 0.5  # of the envelope's largest value: shaking is strong until it falls below for good
SCANNED = 4096  # instants at which an envelope is looked at
COLUMNS = 8  # numbers that are held of each structure and pair at an instant
INSTANT = 6e-4  # [s] of integration, roughly
POINTS = 101  # instants of a result


class Oscillators(NamedTuple):
    """Structures in a row, (n,)."""

    period: Array
    damping: Array
    hardening: Array
    yield_displacement: Array  # infinite where elastic
    elastic_std: Array  # of the displacement, were it elastic [m]


class Side(NamedTuple):
    """One structure: its cells in a row, and where each is."""

    structure: Structure
    cells: Oscillators
    law: Array  # (k, n)
    ground: Mapping[str, Array]  # its parameters, (n,) each
    status: xr.DataArray
    position: xr.DataArray  # of each cell in the row of all sides, -1 where invalid


class Course(NamedTuple):
    """The instants of a finite motion."""

    envelope: Envelope | None
    duration: float
    times: Array  # for integrals
    shown: Array  # indices of the instants of the result
    strong_end: float  # [s]

    def value(self, time: float) -> float:
        """The envelope at an instant."""
        return 1.0 if self.envelope is None else float(self.envelope.at(np.asarray(time)))


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


def side_of(structure: Structure, ground: Ground, duration: float, role: str, first: int) -> Side:
    """The cells of a structure, numbered from ``first``; those longer than the motion are invalid."""
    period = structure.arrays()["period"]
    check_duration(duration, {role: structure})
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
    )


def numbered(valid: xr.DataArray, first: int = 0) -> xr.DataArray:
    """Numbers of the cells that are valid, in their order; -1 where they are not."""
    flat = valid.to_numpy().ravel()
    number = np.where(flat, first + np.cumsum(flat) - 1, -1)
    return xr.DataArray(number.reshape(valid.shape), dims=valid.dims, coords=valid.coords)


def of_cells(array: xr.DataArray, at: xr.DataArray) -> Array:
    """The values of the cells that have a number in ``at``, in their order."""
    return row_of(array, at)[at.to_numpy().ravel() >= 0]


def oscillators_of(sides: Sequence[Side]) -> Oscillators:
    """The structures of all sides in one row."""
    return Oscillators(*map(np.concatenate, zip(*(side.cells for side in sides), strict=True)))


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
    values = np.ones(SCANNED) if envelope is None else envelope.at(scan)
    strong = np.flatnonzero(values >= STRONG * values.max())
    last = duration if strong[-1] == SCANNED - 1 else float(scan[strong[-1] + 1])
    return Course(envelope, float(duration), times, shown, last)


def solve_course(sides: Sequence[Side], ground: Ground, pairs: Array, course: Course) -> Moments:
    """Second moments of all structures and pairs (2, p) of them, from rest."""
    period, damping, hardening, uy, scale = oscillators_of(sides)
    check_work(
        f"{pairs.shape[1]} pairs at {course.times.size} instants need",
        "take fewer cells at a time",
        memory=8 * COLUMNS * course.times.size * (period.size + pairs.shape[1]),
    )
    w = 2 * np.pi / period
    elastic = np.isinf(uy)
    structures = Structures(
        w, 2 * damping * w, np.where(elastic, 0.0, (1 - hardening) * w**2), uy, scale
    )
    filters = _filters(ground, grounds_of(sides))
    closure = _coefficients(sides) if not elastic.all() else None
    transient = Transient(structures, filters, pairs, closure, course.value)
    kinks = () if course.envelope is None else course.envelope.kinks()
    return Moments(*transient.solve(course.times, kinks), tuple(sides), course)


def over_time(table: xr.Dataset, course: Course) -> xr.Dataset:
    """The table with its instants, the envelope there, and whether strong shaking is over."""
    time = labels.axis("time", "time", course.times[course.shown], "s")
    flag = {
        "long_name": f"whether the envelope has fallen for good below {STRONG:g} of its largest value",
        "flag_values": np.arange(2, dtype=np.int8),
        "flag_meanings": "strong_shaking permanent_set_not_represented",
    }
    return (
        table.assign(
            envelope=("time", np.array([course.value(instant) for instant in time.values])),
            permanent_set=("time", (time.values > course.strong_end).astype(np.int8), flag),
        )
        .assign_coords(time=time)
        .assign_attrs(
            duration_s=course.duration,
            envelope_model="none" if course.envelope is None else course.envelope.describe(),
            strong_shaking_end_s=course.strong_end,
        )
    )


def _coefficients(sides: Sequence[Side]) -> Coefficients:
    """Equivalent coefficients of all cells, each by the closure of its law; neighbours alike at once."""

    def closure_of(side: Side) -> Closure | None:
        return side.structure.closure("gaussian") if side.structure.yields else None

    alike = [(closure, [s.law for s in members]) for closure, members in groupby(sides, closure_of)]
    groups = [(closure, np.concatenate(laws, axis=1)) for closure, laws in alike]
    ends = np.cumsum([law.shape[1] for _, law in groups])[:-1]

    def coefficients(latent: Array) -> Array:
        parts = zip(groups, np.split(latent, ends, axis=1), strict=True)
        found = [
            closure(part, law).coefficients if closure else np.zeros((2, law.shape[1]))
            for (closure, law), part in parts
        ]
        return np.concatenate(found, axis=1)

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
