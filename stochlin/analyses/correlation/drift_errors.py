"""How far ``rho`` of the drift closure was off where it was checked, by region.

Mean absolute errors over 2750 random pairs of unequal bilinear structures, each simulated, drawn as
`benchmarks/drift.py` draws them, with another seed; rounded to .01.
"""

from __future__ import annotations

import numpy as np
import xarray as xr

from stochlin.analyses.linearization.bias_map import KNOWN_GROUNDS, place_in_map
from stochlin.analyses.tables.cellwise import cellwise
from stochlin.kernels.basics.arrays import Array
from stochlin.models.grounds import Ground, WhiteNoise
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.structures import Structure

PERIODS, GROUND_DAMPINGS = (0.2, 0.5, 0.9, 5.0), (0.03, 0.1, 0.3, 1.0)  # of the shorter T/Tg; of xig
# By PERIODS, and within each by GROUND_DAMPINGS.
ERRORS = np.array([0.04, 0.03, 0.02, 0.03, 0.02, 0.02, 0.02, 0.02, 0.02])
ON_WHITE_NOISE = 0.03
STRENGTH, HARDENING, DAMPING = (0.0, 4.0), (0.02, 1.0), (0.01, 0.1)  # R/p from rare yielding on
RATIO = 3.0  # of the periods
ROUNDING = 1e-9


def expected_rho_error(
    first: Structure, second: Structure, ground: Ground, sides: list[xr.Dataset]
) -> xr.DataArray:
    """Mean error of ``rho`` in the region of each pair; 0 if both are elastic, NaN where not checked."""
    known = type(ground) in KNOWN_GROUNDS and all(isinstance(s, Bilinear) for s in (first, second))
    white = isinstance(ground, WhiteNoise)
    arrays: list[xr.DataArray] = []
    for structure, side in zip((first, second), sides, strict=True):
        place = place_in_map(structure, ground, side)
        arrays += cellwise(_region, *place, white=white, known=known, kinds=(np.int8, float))
        arrays.append(np.isinf(side.yield_displacement))
    (error,) = cellwise(_error, *arrays, white=white)
    return error


@np.errstate(divide="ignore", invalid="ignore")  # invalid cells are in no region
def _region(
    strength: Array,
    hardening: Array,
    damping: Array,
    ground_damping: Array,
    period: Array,
    ground_period: Array,
    *,
    white: bool,
    known: bool,
) -> tuple[Array, Array]:
    """Number of a structure's region, -1 outside, and the logarithm of its period."""
    inside = known & _within(strength, STRENGTH) & _within(hardening, HARDENING)
    inside = inside & _within(damping, DAMPING)
    region = np.zeros(np.shape(period), int)
    if not white:
        ratio = period / ground_period
        inside = inside & _within(ratio, PERIODS) & _within(ground_damping, GROUND_DAMPINGS)
        region = (len(GROUND_DAMPINGS) - 1) * _band(ratio, PERIODS) + _band(
            ground_damping, GROUND_DAMPINGS
        )
    region, logarithm = np.broadcast_arrays(np.where(inside, region, -1), np.log(period))
    return region.astype(np.int8), logarithm


def _error(
    region_1: Array, log_1: Array, elastic_1: Array, region_2: Array, log_2: Array, elastic_2: Array,
    *, white: bool,
) -> Array:  # fmt: skip
    # Both have the ground's column: the lower number is that of the shorter period, or outside.
    region = np.minimum(region_1, region_2)
    region = np.where(np.abs(log_1 - log_2) <= np.log(RATIO) + ROUNDING, region, -1)
    values = np.full(1, ON_WHITE_NOISE) if white else ERRORS
    error = np.append(values, np.nan)[region]
    return np.asarray(np.where(elastic_1 & elastic_2, 0.0, error))


def _within(value: Array, ends: tuple[float, ...]) -> Array:
    inside: Array = (value >= ends[0] * (1 - ROUNDING)) & (value <= ends[-1] * (1 + ROUNDING))
    return inside


def _band(value: Array, edges: tuple[float, ...]) -> Array:
    return np.searchsorted(edges[1:-1], value, side="right")
