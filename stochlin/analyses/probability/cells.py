"""Two structures in a finite earthquake: every cell of their table, by formula and by simulation."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import xarray as xr

from stochlin.analyses.correlation.correlation import correlate
from stochlin.analyses.linearization.linearization import linearize
from stochlin.analyses.linearization.transient_systems import (
    Moments,
    course_of,
    numbered,
    of_cells,
    oscillators_of,
    side_of,
    solve_course,
    spread_over,
)
from stochlin.analyses.probability.crossings import bandwidths, chances, gap_for
from stochlin.analyses.probability.simulated import simulate_course
from stochlin.analyses.simulation.finite_motions import quantile_intervals, share_interval
from stochlin.analyses.tables import labels
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress
from stochlin.kernels.probability.drift_growth import drift_variances
from stochlin.kernels.simulation.separation_histories import Histories
from stochlin.messages import sentence
from stochlin.models.envelopes import Envelope
from stochlin.models.grounds import Ground
from stochlin.models.structures import Gap, Structure


class PairTable(NamedTuple):
    """Cells, moments, and where each pair and gap is."""

    structures_of_pair: Array  # (2, p): numbers of both
    moments: Moments
    pair_number: xr.DataArray  # number of the pair, -1 where invalid
    cell_number: xr.DataArray  # number of the (pair, gap), likewise
    gap: Array  # (c,)
    pair_of_cell: Array  # (c,)
    status: xr.DataArray
    solved: tuple[xr.Dataset, xr.Dataset]  # both, linearized in the stationary motion

    @classmethod
    def of(
        cls,
        first: Structure,
        second: Structure,
        ground: Ground,
        distance: Gap,
        duration: float,
        envelope: Envelope | None,
        points: int,
    ) -> PairTable:
        """Check, number and solve the cells."""
        solved = linearize(first, ground), linearize(second, ground)
        one = side_of(first, ground, duration, "first", 0)
        two = side_of(second, ground, duration, "second", one.cells.period.size)
        gap = distance.arrays()["gap"]
        try:
            xr.align(one.position, two.position, gap, join="exact", copy=False)
        except (xr.AlignmentError, ValueError) as error:
            raise ValueError(
                "first, second, ground and gap share a dimension that differs in coordinates or "
                f"length: {sentence(error)}; give them different dimension names for a table"
            ) from error
        left, right = xr.broadcast(one.position, two.position)
        both = (left >= 0) & (right >= 0)
        pair_number = numbered(both)
        spread, wide = xr.broadcast(pair_number, gap)
        good = (spread >= 0) & (wide > 0) & np.isfinite(wide)
        status = xr.apply_ufunc(np.maximum, one.status, two.status)
        status = status.broadcast_like(good).where((spread < 0) | good, labels.INVALID_INPUT)
        structures = np.stack([of_cells(side, pair_number) for side in (left, right)])
        cell_number = numbered(good)
        if not good.any():
            raise ValueError("no pair has valid parameters; correct those that are out of range")
        sides = (one, two)
        shortest = float(oscillators_of(sides).period.min())
        course = course_of(envelope, duration, shortest, points)
        return cls(
            structures,
            solve_course(sides, ground, structures, course),
            pair_number,
            cell_number,
            of_cells(wide, cell_number).astype(float),
            of_cells(spread, cell_number),
            status.transpose(*good.dims).astype(np.int8),
            solved,
        )


def by_formula(pairs: PairTable, ground: Ground, confidence: float) -> xr.Dataset:
    """What linearization says, and what it says with the drift put back."""
    moments, course = pairs.moments, pairs.moments.course
    bandwidth = bandwidths(moments, pairs.structures_of_pair, ground)
    both = moments.difference
    table, required = xr.Dataset(), None
    nothing = np.zeros_like(moments.own.displacement), np.zeros_like(both.d_d)
    for ending, (own, apart) in (("", nothing), ("_corrected", _drift(pairs, ground))):
        if required is None or np.isnan(apart).any() or apart.any():
            found = chances(both, bandwidth, apart, pairs.gap, pairs.pair_of_cell, course)
            required = gap_for(both, bandwidth, apart, confidence, course)
        table[f"instantaneous_probability{ending}"] = spread_over(found.now, pairs.cell_number)
        table[f"confidence_of_no_pounding{ending}"] = spread_over(found.vanmarcke, pairs.cell_number)
        if not ending:
            table["confidence_of_no_pounding_poisson"] = spread_over(found.poisson, pairs.cell_number)
        shown = np.sqrt(np.maximum((moments.own.displacement + own)[course.shown], 0))
        for number, side in enumerate(moments.sides, start=1):
            table[f"displacement_std{ending}_{number}"] = spread_over(shown, side.position)
        spread = np.sqrt((both.d_d + apart)[course.shown])
        table[f"difference_std{ending}"] = spread_over(spread, pairs.pair_number)
        table[f"required_gap{ending}"] = spread_over(required, pairs.pair_number)
    one, two = (
        np.sqrt(moments.own.displacement[course.shown][:, side]) for side in pairs.structures_of_pair
    )
    with np.errstate(invalid="ignore", divide="ignore"):
        rho = moments.difference.product[course.shown] / (one * two)
    return table.assign(rho=spread_over(np.where(one * two > 0, rho, np.nan), pairs.pair_number))


def by_simulation(
    pairs: PairTable,
    ground: Ground,
    confidence: float,
    counts: tuple[int, int],
    progress: Progress | None,
) -> xr.Dataset:
    """What simulated motions say, with errors; ``counts`` are paths and seed."""
    paths, seed = counts
    cells, moments = (pairs.gap, pairs.pair_of_cell), pairs.moments
    found = simulate_course(
        moments.sides, pairs.structures_of_pair, cells, ground, moments.course, paths, seed, progress
    )
    return simulated_table(found, pairs.cell_number, pairs.pair_number, confidence, seed)


def simulated_table(
    found: Histories, cell: xr.DataArray, pair: xr.DataArray, confidence: float, seed: int
) -> xr.Dataset:
    """Probabilities and standard deviations; numbers of gaps and pairs say where they are in a table."""
    n = len(found.largest)
    alive = found.survivors
    lower, upper = share_interval(alive, n)
    stem = "confidence_of_no_pounding_simulated"
    table = xr.Dataset(
        {
            "instantaneous_probability_simulated": spread_over(found.beyond / n, cell),
            stem: spread_over(alive / n, cell),
            f"{stem}_lower": spread_over(lower, cell),
            f"{stem}_upper": spread_over(upper, cell),
        }
    )
    mean = found.squares / n
    error = np.sqrt(np.maximum(found.fourths / n - mean**2, 0) / n) / (
        2 * np.sqrt(np.where(mean > 0, mean, 1.0))
    )
    names = ("displacement_std_simulated_1", "displacement_std_simulated_2", "difference_std_simulated")
    for row, name in enumerate(names):
        table[name] = spread_over(np.sqrt(mean[:, row]), pair)
    table["difference_std_simulated_standard_error"] = spread_over(error[:, 2], pair)
    gaps = quantile_intervals(found.largest, np.array([confidence]))
    for ending, (values,) in zip(("", "_lower", "_upper"), gaps, strict=True):
        table[f"required_gap_simulated{ending}"] = spread_over(values, pair)
    return table.assign_attrs(paths=n, seed=seed)


def _drift(pairs: PairTable, ground: Ground) -> tuple[Array, Array]:
    """Variances of the drift; NaN where the map of the bias does not reach."""
    own, both, sides, course = pairs.moments
    first, second = (side.structure for side in sides)
    solved = zip(pairs.solved, sides, strict=True)
    biases = [of_cells(table.bias, side.position) for table, side in solved]
    shared = of_cells(correlate(first, second, ground).bias, pairs.pair_number)
    hardening, bias = oscillators_of(sides).hardening, np.concatenate(biases)
    return drift_variances(own, both, pairs.structures_of_pair, course.times, hardening, bias, shared)
