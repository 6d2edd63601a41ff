"""Table of probabilities of pounding for two structures in finite motions, by formula and simulation."""

from __future__ import annotations

from typing import NamedTuple, TypeGuard

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from stochlin.analyses.correlation.correlation import correlate
from stochlin.analyses.linearization.transient_systems import (
    TIME,
    StructureCells,
    TimeGrid,
    TransientMoments,
    course_of,
    numbered,
    of_cells,
    oscillators_of,
    shortest_period,
    side_of,
    solve_course,
    spread_over,
)
from stochlin.analyses.linearization.variables import VARIABLES as LINEARIZATION
from stochlin.analyses.probability.bandwidths import bandwidths
from stochlin.analyses.probability.crossings import RelativeMotion
from stochlin.analyses.probability.strengths import ALONE, STRENGTH
from stochlin.analyses.probability.variables import VARIABLES
from stochlin.analyses.simulation.views import displacement_at, meeting_heights
from stochlin.analyses.tables import labels
from stochlin.analyses.tables.lazy import arrays_of, check_names
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress, part_of
from stochlin.kernels.probability.drift_growth import drift_variances
from stochlin.models.envelopes import Envelope
from stochlin.models.grounds import Ground
from stochlin.models.structures import Gap, Structure
from stochlin.models.systems import AnyStructure

HEIGHT = "height"
AT_HEIGHT = (
    "confidence_of_no_pounding",
    "instantaneous_probability",
    "difference_std",
    "difference_std_simulated",
    "difference_std_simulated_standard_error",
    "required_gap",
    "required_gap_simulated",
    "rho",
)
OF_MOMENTS = 0.9  # share of the progress that the moments have beside the bandwidths


class Solved(NamedTuple):
    """What linearization finds for pairs: it does not depend on gaps."""

    moments: TransientMoments
    bandwidth: Array  # (times, pairs h) bandwidth of ``u_1 - u_2`` [-]


class PairTable(NamedTuple):
    """Cells of p pairs in k strengths of the motion, and the positions of pairs and gaps.

    With storeys there are h heights of contact, and a pair is counted at each of them.
    """

    weights: Array  # (k,) of the strengths of the motion
    every_pair: xr.DataArray  # number of each pair and strength, strength by strength
    structures_of_pair: Array  # (2, k p) numbers of both structures
    sides: tuple[StructureCells, StructureCells]
    course: TimeGrid
    pair_number: xr.DataArray  # number of each pair and height, -1 where invalid
    cell_number: xr.DataArray  # number of each pair, height and gap, -1 where invalid
    gap: Array  # (c,) [m]
    pair_of_cell: Array  # (c,) number of the pair and height
    status: xr.DataArray

    @classmethod
    def of(
        cls,
        first: AnyStructure,
        second: AnyStructure,
        ground: Ground,
        distance: Gap,
        duration: float,
        envelope: Envelope | None,
        points: int,
        weights: Array = ALONE,
    ) -> PairTable:
        """Table of checked pairs; with several weights the ground is over `STRENGTH`."""
        side_1 = side_of(first, ground, duration, "first", 0)
        side_2 = side_of(second, ground, duration, "second", side_1.period.size)
        arrays_of({"first": first, "second": second, "ground": ground, "gap": distance})
        gap = distance.arrays()["gap"]
        left, right = xr.broadcast(side_1.position, side_2.position)
        own = (HEIGHT,) if side_1.has_storeys or side_2.has_storeys else ()
        given = (*left.dims, *left.coords, *right.coords, *gap.dims, *gap.coords)
        check_names(given, {*VARIABLES, "status", TIME, *own} - {*LINEARIZATION, *distance.cells()})
        both = (left >= 0) & (right >= 0)
        status = xr.apply_ufunc(np.maximum, side_1.status, side_2.status)
        every_pair = pair_number = numbered(both)
        if weights.size > 1:
            both, status = both.all(STRENGTH), status.max(STRENGTH)
            every_pair = numbered(both.broadcast_like(left).transpose(STRENGTH, ...))
            pair_number = numbered(both)
        spread, wide = xr.broadcast(pair_number, gap)
        good = (spread >= 0) & (wide > 0) & np.isfinite(wide)
        status = status.broadcast_like(good).where((spread < 0) | good, labels.INVALID_INPUT)
        structures = np.stack([of_cells(side, every_pair) for side in (left, right)])
        if not good.any():
            raise ValueError("no pair has valid parameters; correct those that are out of range")
        sides, heights = _where_they_meet(side_1, side_2)
        at_height = (pair_number * heights.size + heights).where(pair_number >= 0, -1).astype(int)
        cell_number = numbered(xr.broadcast(good, heights)[0])
        return cls(
            weights,
            every_pair,
            structures,
            sides,
            course_of(envelope, duration, shortest_period(sides), points),
            at_height,
            cell_number,
            of_cells(wide, cell_number).astype(float),
            of_cells(at_height, cell_number),
            status.transpose(*good.dims).astype(np.int8),
        )

    def solve(self, ground: Ground, progress: Progress | None = None) -> Solved:
        """Second moments and bandwidths of the pairs by transient linearization."""
        pairs = self.structures_of_pair
        first = part_of(progress, 0.0, OF_MOMENTS)
        moments = solve_course(self.sides, ground, pairs, self.course, first)
        rest = part_of(progress, OF_MOMENTS, 1.0)
        return Solved(moments, bandwidths(moments, pairs, ground, rest))


def _where_they_meet(
    side_1: StructureCells, side_2: StructureCells
) -> tuple[tuple[StructureCells, StructureCells], xr.DataArray]:
    """Both structures with displacements at the heights of contact, and numbers of the heights."""
    if not (side_1.has_storeys or side_2.has_storeys):
        return (side_1, side_2), xr.DataArray(0)
    stacks = side_1.stack, side_2.stack
    heights = meeting_heights(*stacks)
    seen = tuple(np.zeros((heights.size, stack.levels.size)) for stack in stacks)
    for row, height in enumerate(heights):
        for displacements, stack in zip(seen, stacks, strict=True):
            terms = displacement_at(stack, float(height))
            displacements[row, list(terms)] = list(terms.values())
    first, second = (at @ stack.system.shapes for at, stack in zip(seen, stacks, strict=True))
    sides = side_1._replace(seen=first), side_2._replace(seen=second)
    return sides, height_numbers(heights)


def height_numbers(heights: ArrayLike) -> xr.DataArray:
    """Numbers of heights, over the dimension ``height`` [m]."""
    axis = labels.axis(HEIGHT, "height above the ground", np.asarray(heights), "m")
    return axis.copy(data=np.arange(axis.size))


def by_formula(pairs: PairTable, solved: Solved, ground: Ground, confidence: float) -> xr.Dataset:
    """Variables of the table by linearization, and with its known bias corrected."""
    course, (moments, bandwidth) = pairs.course, solved
    own, both = moments.own.displacement, moments.difference
    heights = both.d_d.shape[1] // pairs.structures_of_pair.shape[1]
    of_pair = pairs.structures_of_pair[..., None] * heights + np.arange(heights)
    table, required, weights = xr.Dataset(), None, pairs.weights
    nothing = np.zeros_like(own), np.zeros_like(both.d_d)
    for ending, (drift, apart) in (("", nothing), ("_corrected", _drift(pairs, moments, ground))):
        if required is None or np.isnan(apart).any() or apart.any():
            motion = RelativeMotion(both, bandwidth, apart, course, weights)
            chance = motion.chances(pairs.gap, pairs.pair_of_cell)
            required = motion.gap_for(confidence)
        table[f"instantaneous_probability{ending}"] = spread_over(chance.now, pairs.cell_number)
        table[f"confidence_of_no_pounding{ending}"] = spread_over(chance.vanmarcke, pairs.cell_number)
        if not ending:
            table["confidence_of_no_pounding_poisson"] = spread_over(chance.poisson, pairs.cell_number)
        shown = np.maximum((own + drift)[course.shown], 0)[:, heights - 1 :: heights]
        for number, side in enumerate(moments.sides, start=1):
            variance = spread_over(shown, side.position)
            if STRENGTH in variance.dims:
                variance = variance.dot(xr.DataArray(weights, dims=STRENGTH))
            table[f"displacement_std{ending}_{number}"] = np.sqrt(variance)
        spread = np.sqrt(_mean((both.d_d + apart)[course.shown], weights))
        table[f"difference_std{ending}"] = spread_over(spread, pairs.pair_number)
        table[f"required_gap{ending}"] = spread_over(required, pairs.pair_number)
    std_1, std_2 = (np.sqrt(_mean(own[course.shown][:, side.ravel()], weights)) for side in of_pair)
    with np.errstate(invalid="ignore", divide="ignore"):
        rho = _mean(both.product[course.shown], weights) / (std_1 * std_2)
    table["rho"] = spread_over(np.where(std_1 * std_2 > 0, rho, np.nan), pairs.pair_number)
    return _bounds(table) if HEIGHT in pairs.pair_number.dims else table


def _mean(moments: Array, weights: Array) -> Array:
    """Mean (times, p) of moments (times, k p) over the strengths of the motion."""
    mean: Array = np.einsum("k,tkp->tp", weights, moments.reshape(len(moments), weights.size, -1))
    return mean


def over_heights(table: xr.Dataset) -> xr.Dataset:
    """Table of all heights together: the worst probabilities, and the moments at the highest one.

    Variables of `AT_HEIGHT` are also kept at each height.
    """
    whole = xr.Dataset()
    for name, array in table.items():
        kind = str(name).partition("_")[0]
        if HEIGHT not in array.dims:
            whole[name] = array
        elif kind == "confidence":
            whole[name] = array.min(HEIGHT, skipna=False)
        elif kind in ("instantaneous", "required"):
            whole[name] = array.max(HEIGHT, skipna=False)
        else:
            whole[name] = array.isel({HEIGHT: -1}, drop=True)
        if name in AT_HEIGHT and HEIGHT in array.dims:
            whole[f"{name}_at_height"] = array
    return whole


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


def _drift(pairs: PairTable, moments: TransientMoments, ground: Ground) -> tuple[Array, Array]:
    """Variances [m^2] of the plastic drifts and of their difference; NaN where the bias is unknown."""
    own, both, sides, course = moments
    first, second = (side.structure for side in sides)
    if not (_is_in_map(first) and _is_in_map(second)):
        unknown = np.nan if first.yields or second.yields else 0.0
        return np.full_like(own.displacement, unknown), np.full_like(both.d_d, unknown)
    table = correlate(first, second, ground)
    biases = [of_cells(table[f"bias_{n}"], side.position) for n, side in enumerate(sides, start=1)]
    shared = of_cells(table.bias, pairs.every_pair)
    (_, _, hardening, _), bias = oscillators_of(sides), np.concatenate(biases)
    return drift_variances(own, both, pairs.structures_of_pair, course.times, hardening, bias, shared)
