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
from stochlin.models.envelopes import Envelope
from stochlin.models.grounds import Ground
from stochlin.models.structures import Gap, Structure


class Pair(NamedTuple):
    """Cells, moments, and where each pair and gap is."""

    pairs: Array  # (2, p)
    moments: Moments
    pair_at: xr.DataArray  # number of the pair, -1 where invalid
    cell_at: xr.DataArray  # number of the (pair, gap), likewise
    gap: Array  # (c,)
    pair: Array  # (c,)
    status: xr.DataArray

    @classmethod
    def of(
        cls,
        first: Structure,
        second: Structure,
        ground: Ground,
        wanted: Gap,
        duration: float,
        envelope: Envelope | None,
        points: int,
    ) -> Pair:
        """Check, number and solve the cells."""
        one = side_of(first, ground, duration, "first", 0)
        two = side_of(second, ground, duration, "second", one.cells.period.size)
        gap = wanted.arrays()["gap"]
        try:
            xr.align(one.position, two.position, gap, join="exact", copy=False)
        except (xr.AlignmentError, ValueError) as error:
            raise ValueError(
                "first, second, ground and gap share a dimension that differs in coordinates or "
                f"length: {error}; give them different dimension names for a table"
            ) from error
        left, right = xr.broadcast(one.position, two.position)
        both = (left >= 0) & (right >= 0)
        pair_at = numbered(both)
        spread, wide = xr.broadcast(pair_at, gap)
        good = (spread >= 0) & (wide > 0) & np.isfinite(wide)
        status = xr.apply_ufunc(np.maximum, one.status, two.status)
        status = status.broadcast_like(good).where((spread < 0) | good, labels.INVALID_INPUT)
        pairs = np.stack([of_cells(side, pair_at) for side in (left, right)])
        cell_at = numbered(good)
        if not good.any():
            raise ValueError("no pair has valid parameters; correct those that are out of range")
        sides = (one, two)
        shortest = float(oscillators_of(sides).period.min())
        course = course_of(envelope, duration, shortest, points)
        return cls(
            pairs,
            solve_course(sides, ground, pairs, course),
            pair_at,
            cell_at,
            of_cells(wide, cell_at).astype(float),
            of_cells(spread, cell_at),
            status.transpose(*good.dims).astype(np.int8),
        )


def by_formula(pair: Pair, ground: Ground, confidence: float) -> xr.Dataset:
    """What linearization says, and what it says with the drift put back."""
    moments, course = pair.moments, pair.moments.course
    bandwidth = bandwidths(moments, pair.pairs, ground)
    both = moments.difference
    table, required = xr.Dataset(), None
    nothing = np.zeros_like(moments.own.displacement), np.zeros_like(both.d_d)
    for ending, (own, apart) in (("", nothing), ("_corrected", _drift(pair, ground))):
        if required is None or np.isnan(apart).any() or apart.any():
            found = chances(both, bandwidth, apart, pair.gap, pair.pair, course)
            required = gap_for(both, bandwidth, apart, confidence, course)
        table[f"instantaneous_probability{ending}"] = spread_over(found.now, pair.cell_at)
        table[f"confidence_of_no_pounding{ending}"] = spread_over(found.vanmarcke, pair.cell_at)
        if not ending:
            table["confidence_of_no_pounding_poisson"] = spread_over(found.poisson, pair.cell_at)
        shown = np.sqrt(np.maximum((moments.own.displacement + own)[course.shown], 0))
        for number, side in enumerate(moments.sides, start=1):
            table[f"displacement_std{ending}_{number}"] = spread_over(shown, side.position)
        spread = np.sqrt((both.d_d + apart)[course.shown])
        table[f"difference_std{ending}"] = spread_over(spread, pair.pair_at)
        table[f"required_gap{ending}"] = spread_over(required, pair.pair_at)
    one, two = (np.sqrt(moments.own.displacement[course.shown][:, side]) for side in pair.pairs)
    with np.errstate(invalid="ignore", divide="ignore"):
        rho = moments.difference.product[course.shown] / (one * two)
    return table.assign(rho=spread_over(np.where(one * two > 0, rho, np.nan), pair.pair_at))


def by_simulation(
    pair: Pair,
    ground: Ground,
    confidence: float,
    counts: tuple[int, int],
    progress: Progress | None,
) -> xr.Dataset:
    """What simulated motions say, with errors; ``counts`` are paths and seed."""
    paths, seed = counts
    cells, moments = (pair.gap, pair.pair), pair.moments
    found = simulate_course(
        moments.sides, pair.pairs, cells, ground, moments.course, paths, seed, progress
    )
    n = len(found.largest)
    alive = found.survivors
    lower, upper = share_interval(alive, n)
    stem = "confidence_of_no_pounding_simulated"
    table = xr.Dataset(
        {
            "instantaneous_probability_simulated": spread_over(found.beyond / n, pair.cell_at),
            stem: spread_over(alive / n, pair.cell_at),
            f"{stem}_lower": spread_over(lower, pair.cell_at),
            f"{stem}_upper": spread_over(upper, pair.cell_at),
        }
    )
    mean = found.squares / n
    error = np.sqrt(np.maximum(found.fourths / n - mean**2, 0) / n) / (
        2 * np.sqrt(np.where(mean > 0, mean, 1.0))
    )
    names = ("displacement_std_simulated_1", "displacement_std_simulated_2", "difference_std_simulated")
    for row, name in enumerate(names):
        table[name] = spread_over(np.sqrt(mean[:, row]), pair.pair_at)
    table["difference_std_simulated_standard_error"] = spread_over(error[:, 2], pair.pair_at)
    gaps = quantile_intervals(found.largest, np.array([confidence]))
    for ending, (values,) in zip(("", "_lower", "_upper"), gaps, strict=True):
        table[f"required_gap_simulated{ending}"] = spread_over(values, pair.pair_at)
    return table.assign_attrs(paths=n, seed=seed)


def _drift(pair: Pair, ground: Ground) -> tuple[Array, Array]:
    """Variances of the drift; NaN where the map of the bias does not reach."""
    own, both, sides, course = pair.moments
    first, second = (side.structure for side in sides)
    biases = [of_cells(linearize(side.structure, ground).bias, side.position) for side in sides]
    shared = of_cells(correlate(first, second, ground).bias, pair.pair_at)
    hardening, bias = oscillators_of(sides).hardening, np.concatenate(biases)
    return drift_variances(own, both, pair.pairs, course.times, hardening, bias, shared)
