"""Probability of pounding of a pair by transient linearization and crossing theory."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple, TypeGuard

import numpy as np
import xarray as xr

from stochlin.applications.probability.axes import HEIGHT, Draws, ResultAxes, over_heights
from stochlin.applications.probability.bandwidths import bandwidths
from stochlin.applications.probability.crossings import RelativeMotion
from stochlin.applications.probability.strengths import ALONE, at_strengths, strengths
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress, part_of
from stochlin.kernels.probability.drift_growth import drift_variances
from stochlin.models.grounds import Ground
from stochlin.models.structures import Gap, Structure
from stochlin.models.systems import AnyStructure
from stochlin.models.uncertain import median_of
from stochlin.solver.correlation.correlation import correlate
from stochlin.solver.linearization.strength import strength_in_metres
from stochlin.solver.linearization.transient_systems import (
    StructureCells,
    TimeGrid,
    TransientMoments,
    oscillators_of,
    side_of,
    solve_course,
)
from stochlin.solver.simulation.views import displacement_at, meeting_heights
from stochlin.solver.tables import labels

OF_MOMENTS = 0.9  # share of the progress that the moments have beside the bandwidths


class MovingPair(NamedTuple):
    """Two structures in k strengths of a motion, and the h heights at which they can meet."""

    sides: tuple[StructureCells, StructureCells]  # k cells each
    heights: Array  # (h,) [m]
    course: TimeGrid
    weights: Array  # (k,) of the strengths, with the sum 1

    @classmethod
    def of(
        cls, first: AnyStructure, second: AnyStructure, ground: Ground, course: TimeGrid, weights: Array
    ) -> MovingPair:
        """The pair; with several weights the ground is an array over as many strengths.

        Raises an ArithmeticError if the elastic response of a structure cannot be computed.
        """
        sides: list[StructureCells] = []
        for role, structure in (("first", first), ("second", second)):
            side = side_of(structure, ground, course.duration, role, len(sides) * weights.size)
            labels.raise_if_lone_failure(xr.Dataset({"status": side.status.max()}), role)
            sides.append(side)
        stacks = [side.stack for side in sides]
        heights = meeting_heights(*stacks)
        if not np.isnan(heights[0]):
            for n, stack in enumerate(stacks):
                at = np.zeros((heights.size, stack.levels.size))
                for row, height in enumerate(heights):
                    terms = displacement_at(stack, float(height))
                    at[row, list(terms)] = list(terms.values())
                sides[n] = sides[n]._replace(seen=at @ stack.system.shapes)
        return cls((sides[0], sides[1]), heights, course, weights)

    @property
    def numbers(self) -> Array:
        """Numbers (2, k) of both structures in each strength."""
        return np.arange(2 * self.weights.size).reshape(2, -1)

    def mean(self, moments: Array) -> Array:
        """Mean (instants of the result, h) of moments (times, k h) over the strengths."""
        shown = moments[self.course.shown]
        mean: Array = np.einsum("k,tkh->th", self.weights, shown.reshape(*self._shape(shown)))
        return mean

    def _shape(self, moments: Array) -> tuple[int, int, int]:
        return len(moments), self.weights.size, self.heights.size

    def solve(self, ground: Ground, progress: Progress | None) -> tuple[TransientMoments, Array]:
        """Second moments, and bandwidths (times, k h), by transient linearization."""
        first, rest = part_of(progress, 0.0, OF_MOMENTS), part_of(progress, OF_MOMENTS, 1.0)
        moments = solve_course(self.sides, ground, self.numbers, self.course, first)
        return moments, bandwidths(moments, self.numbers, ground, rest)


def by_formula(
    structures: Sequence[Any],
    ground: Any,
    distance: Gap,
    course: TimeGrid,
    confidence: float,
    draws: Draws,
    progress: Progress | None,
) -> xr.Dataset:
    """Results by linearization, and with its known bias corrected, averaged over the scatter."""
    (first, second), ground, weights = map(median_of, structures), median_of(ground), ALONE
    if draws.scatter:
        factors, weights = strengths(draws.scatter)
        first, second = (strength_in_metres(structure, ground) for structure in (first, second))
        ground = at_strengths(ground, factors)
    pair = MovingPair.of(first, second, ground, course, weights)
    moments, bandwidth = pair.solve(ground, progress)
    own, both = np.split(moments.own.displacement, 2, axis=1), moments.difference
    axes, count = ResultAxes(pair.heights, distance), pair.heights.size
    cells = np.tile(axes.gaps, count), np.repeat(np.arange(count), axes.gaps.size)
    table, motion = xr.Dataset(), None
    nothing = np.zeros_like(moments.own.displacement), np.zeros_like(both.d_d)
    for ending, (drift, apart) in (("", nothing), ("_corrected", _drift(pair, moments, ground))):
        if motion is None or np.isnan(apart).any() or apart.any():
            motion = RelativeMotion(both, bandwidth, apart, course, weights)
            chances = motion.chances(*cells)
            required = motion.gap_for(confidence)
        now, poisson, vanmarcke = (axes.array(each.reshape(len(each), count, -1)) for each in chances)
        table[f"instantaneous_probability{ending}"] = now
        table[f"confidence_of_no_pounding{ending}"] = vanmarcke
        if not ending:
            table["confidence_of_no_pounding_poisson"] = poisson
        variances = *map(np.add, own, np.split(drift, 2, axis=1)), both.d_d + apart
        names = f"displacement_std{ending}_1", f"displacement_std{ending}_2", f"difference_std{ending}"
        for name, variance in zip(names, variances, strict=True):
            std = np.sqrt(pair.mean(np.maximum(variance, 0)))
            table[name] = axes.array(std, gaps=False)
        table[f"required_gap{ending}"] = axes.array(required, gaps=False)
    product = np.sqrt(pair.mean(own[0])) * np.sqrt(pair.mean(own[1]))
    with np.errstate(invalid="ignore", divide="ignore"):
        rho = np.where(product > 0, pair.mean(both.product) / product, np.nan)
    table["rho"] = axes.array(rho, gaps=False)
    return _bounds(table) if HEIGHT in table.dims else table


def _bounds(table: xr.Dataset) -> xr.Dataset:
    """Table of all heights together, with Boole's bound of the confidence and the governing height."""
    missed = (1 - table.confidence_of_no_pounding).sum(HEIGHT, skipna=False)
    governing = table.required_gap.fillna(-1.0).idxmax(HEIGHT)
    return over_heights(table).assign(
        confidence_of_no_pounding_at_least=(1 - missed).clip(0),
        governing_height=governing.where(table.required_gap.notnull().all(HEIGHT)),
    )


def _is_in_map(structure: AnyStructure) -> TypeGuard[Structure]:
    """Whether it is an oscillator with a stationary linearization, whose bias may be known."""
    if not isinstance(structure, Structure):
        return False
    return not structure.yields or (structure.linearizes and bool(structure.settles().any()))


def _drift(pair: MovingPair, moments: TransientMoments, ground: Ground) -> tuple[Array, Array]:
    """Variances [m^2] of the plastic drifts and of their difference; NaN where the bias is unknown."""
    own, both, sides, course = moments
    first, second = (side.structure for side in sides)
    if not (_is_in_map(first) and _is_in_map(second)):
        unknown = np.nan if first.yields or second.yields else 0.0
        return np.full_like(own.displacement, unknown), np.full_like(both.d_d, unknown)
    table, count = correlate(first, second, ground), pair.weights.size
    *biases, shared = (
        np.broadcast_to(table[name].values, count) for name in ("bias_1", "bias_2", "bias")
    )
    (_, _, hardening, _), bias = oscillators_of(sides), np.concatenate(biases)
    return drift_variances(own, both, pair.numbers, course.times, hardening, bias, shared)
