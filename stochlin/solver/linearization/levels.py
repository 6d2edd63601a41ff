"""Stationary responses of bilinear structures by the drift closure at levels of shaking."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization.covariance import EquivalentSystem, Forcing
from stochlin.kernels.linearization.filters import Filter
from stochlin.kernels.linearization.levels import (
    StructureInTime,
    StructureRows,
    Tables,
    lagged,
    levels_for,
    moving,
    structure_rows,
)
from stochlin.models.envelopes import Envelope, envelope_at, strong_seconds
from stochlin.models.grounds import Ground
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.structures import DRIFT, Structure
from stochlin.solver.linearization.equivalent_systems import LawOfCells, Oscillators, Solved
from stochlin.solver.linearization.strength import strength_in_metres
from stochlin.solver.tables import labels
from stochlin.solver.tables.cells import ONE, Flat
from stochlin.solver.tables.checks import USUAL_TOLERANCE

INSTANTS = 65  # of a motion, at least
STEPS_OF_LAG = 2  # of the lag of a structure from one instant to the next
LEAST_ENVELOPE = 1e-6
GROWTH = StructureRows._fields.index("growth")
# Range [standard deviations], step of the logarithm, and least number of steps on each side, of the
# strengths of motions with a scatter. The peaks scatter by a logarithmic standard deviation of 0.15
# or more for one strength, so that probabilities are smooth in the strength; the error of the mean
# is about 0.001.
STRENGTH_REACH = 3.2
STRENGTH_STEP = 0.25
FEWEST_STRENGTH_STEPS = 4
ELASTIC_STRENGTH = 1.0  # yield displacement [m] of elastic structures, which have the hardening 1
# a structure of the law of all
YIELDING_STRUCTURE = Bilinear(1.0, 0.05, 0.05, reduction_factor=1.0)


def strengths(scatter: float) -> tuple[Array, Array]:
    """Factors on the motion, over which formulas are averaged, and their weights with the sum 1."""
    if not scatter:
        return np.ones(1), np.ones(1)
    steps = max(FEWEST_STRENGTH_STEPS, int(np.ceil(STRENGTH_REACH * scatter / STRENGTH_STEP)))
    normal = np.linspace(-STRENGTH_REACH, STRENGTH_REACH, 2 * steps + 1)
    weights = np.exp(-0.5 * normal**2)
    return np.exp(scatter * normal), weights / weights.sum()


class EnvelopesInTime(NamedTuple):
    """Motions of one duration and shape, in m sizes."""

    times: Array  # (instants,) [s]
    scale: float  # largest value of all envelopes
    spread: float  # size of the largest motion over that of the smallest
    envelope: Array  # (instants, m), over the scale
    squares: Array  # (steps, m) squared envelopes in the middle of each step of the lag, likewise
    weights: Array  # (m,) of the sizes, over which results are averaged
    strong_seconds: float  # duration of the stationary motion of equal energy [s]

    @classmethod
    def of(
        cls,
        envelope: Envelope | None,
        duration: float,
        sizes: Array,
        weights: Array,
        instants: int = INSTANTS,
    ) -> EnvelopesInTime:
        """The course of motions of these sizes (m,)."""
        times = np.linspace(0, duration, instants)
        steps = (instants - 1) * STEPS_OF_LAG
        middle = (np.arange(steps) + 0.5) * duration / steps
        within = envelope_at(envelope, middle)[:, None] * sizes
        scale = float(within.max())
        spread = float(sizes.max() / sizes.min())
        now = np.maximum(envelope_at(envelope, times)[:, None] * sizes / scale, LEAST_ENVELOPE)
        strong = strong_seconds(duration, envelope)
        return cls(times, scale, spread, now, (within / scale) ** 2, weights, strong)

    @property
    def step(self) -> float:
        """From one instant to the next [s]."""
        return float(self.times[1])


def in_metres(structure: Structure, ground: Ground, duration: float) -> Structure:
    """The structure with its strength in metres; invalid where its period exceeds the duration."""
    metres: Structure = strength_in_metres(structure, ground)
    period = metres.arrays()["period"]
    return replace(metres, period=period.where(period <= duration)) if period.ndim else metres


def why_no_drift(structures: Sequence[Any]) -> str:
    """Why structures have no drift closure in finite motions; empty if they have."""
    for structure in structures:
        if not isinstance(structure, Structure):
            return "the drift closure is only available for oscillators"
        if structure.yields and DRIFT not in structure.closure_names():
            return f"no {DRIFT} closure for {type(structure).__name__}"
        if not structure.settles().any():
            return f"no {DRIFT} closure without stiffness after yielding"
    return ""


class SolvedLevels(NamedTuple):
    """n structures, each on its own ground, at all levels of shaking."""

    levels: Array
    solved: Solved  # one level after the other, of one structure after the other
    soil: Filter  # of all of these
    system: EquivalentSystem
    forcing: Forcing
    rows: StructureRows
    tables: Tables
    failed: Array  # (n,) whether a level has no solution


def yielding(structures: Oscillators) -> Oscillators:
    """The same structures, of which those that are elastic have a strength and the hardening 1."""
    elastic = ~np.isfinite(structures.strength)
    return structures._replace(
        hardening=np.where(elastic, 1.0, structures.hardening),
        strength=np.where(elastic, ELASTIC_STRENGTH, structures.strength),
    )


def distinct(structures: Oscillators) -> tuple[Array, Array]:
    """Columns of the different structures and their grounds, and the numbers of those of each cell.

    The strengths are in metres.
    """
    cells = yielding(structures)
    rows = [cells.period, cells.damping, cells.hardening, cells.strength, *cells.soil]
    columns, number = np.unique(np.array(rows), axis=1, return_inverse=True)
    return columns, number.ravel()


def solve_levels(columns: Array, ground: Ground, levels: Array) -> SolvedLevels:
    """Structures in columns of `distinct`, solved at all levels together."""
    repeated = np.repeat(columns, levels.size, axis=1)
    period, damping, hardening, strength, *soil = repeated
    soil[list(ground.cells()).index("intensity")] *= np.tile(levels**2, columns.shape[1])
    ones = np.ones_like(period)
    cells = Oscillators(
        period, damping, hardening, strength, np.zeros_like(ones), ones, np.array(soil)
    )
    table = Flat(ONE, np.arange(period.size), {})
    unsolved = Solved((YIELDING_STRUCTURE,), ground, (table,), (slice(0, period.size),), cells, {})
    solved = unsolved.by_laws([LawOfCells.bilinear(period.size, DRIFT)], DRIFT, USUAL_TOLERANCE)
    values = solved.values
    filters = ground.filter_of(cells.soil)
    system = EquivalentSystem(*values["system"])
    forcing = Forcing(*values["forcing"])
    drift = values["drift_std"], values["drift_rate"]
    with np.errstate(all="ignore"):  # failed levels are NaN
        rows = structure_rows(system, forcing, filters, drift, values["displacement_std"], levels)
        tables = Tables.of(levels, np.array(rows))
    failed = (values["status"] >= labels.NOT_CONVERGED).reshape(-1, levels.size)
    return SolvedLevels(
        levels, solved, filters, system, forcing, rows, tables, np.any(failed, axis=1)
    )


class StructuresInTime(NamedTuple):
    """Structures of c cells in motions of one course; equal ones are solved once."""

    course: EnvelopesInTime
    solved: SolvedLevels  # the different structures
    number: Array  # (c,) of the structure of each cell
    squares: Array  # (instants, structures, m) squared levels

    def moving(self, numbers: Array) -> StructureInTime:
        """The structures with these numbers (n,) in all motions, over (instants, n m)."""
        course = self.course
        motions = self.course.weights.size
        square = self.squares[:, numbers].reshape(course.times.size, -1)
        envelope = np.tile(course.envelope, numbers.size)
        return moving(
            self.solved.tables, square, envelope, np.repeat(numbers, motions), course.step
        )


def structures_in_time(
    cells: Oscillators, ground: Ground, course: EnvelopesInTime
) -> StructuresInTime:
    """Structures of cells with strengths in metres, from rest on."""
    columns, number = distinct(cells.stronger(ground, course.scale**2))
    solved = solve_levels(columns, ground, levels_for(course.spread))
    behind = lagged(solved.tables, GROWTH, course.squares, course.step / STEPS_OF_LAG)[
        ::STEPS_OF_LAG
    ]
    instants, structures, motions = behind.shape
    at_levels = solved.tables.at(
        behind.reshape(instants, -1), np.repeat(np.arange(structures), motions)
    )
    lags = StructureRows(*at_levels).resonant.reshape(behind.shape)
    squares = lags * behind + (1 - lags) * course.envelope[:, None] ** 2
    return StructuresInTime(course, solved, number, squares)
