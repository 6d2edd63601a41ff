"""Signatures of structures with plastic drift, from their correlations with reference structures.

The plastic drifts of two structures are correlated if both slip at the same instants, which does
not follow from their covariances. A table over all pairs would have too many parameters. The
signature of a structure, eq. (9) of ``docs/drift.md``, describes it by its correlations with a few
reference structures on the same ground, so that each structure can be tabulated alone. The
signature is derived with the drift closure, and its correction is interpolated in a map of
simulations.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from typing import NamedTuple

import numpy as np
import xarray as xr

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.slabs import in_ranges
from stochlin.kernels.correlation.corrections import (
    ADDED_VARIANCE,
    ENTRIES,
    PARAMETER_AXES,
    Nearness,
    Signature,
)
from stochlin.kernels.correlation.errors import BOUNDS
from stochlin.kernels.correlation.pairs import Drifting, over_pairs
from stochlin.kernels.linearization.covariance import EquivalentSystem, Forcing, motion_of
from stochlin.kernels.linearization.drift import (
    DriftingSide,
    at_unit_intensity,
    drifting_correlation,
)
from stochlin.models.grounds import Ground
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.structures import DRIFT
from stochlin.solver.linearization.drift_map import (
    DRIFT_REFERENCE,
    ELASTIC_DEMAND,
    NEARNESS,
    SIGNATURE,
    STRENGTH_RATIO,
    drift_map,
    hold_at_ends,
    simulated,
)
from stochlin.solver.linearization.equivalent_systems import (
    LawOfCells,
    Oscillators,
    Solved,
    in_columns,
    solve_oscillators,
)
from stochlin.solver.tables.checks import Tolerance

# places below the diagonal of a matrix
OFF_DIAGONAL = tuple((i, j) for i in range(PARAMETER_AXES) for j in range(i))
# least R/p and largest hardening in the map of `Nearness`
RANGE_OF_NEARNESS = (0.5, 0.5)
# T/Tg from which a Kanai-Tajimi ground of damping 1 acts on the structure like white noise
AS_ON_WHITE_NOISE = 5.0
CACHED_GROUNDS = 64  # number of grounds with scalar parameters whose solved references are kept
BLUR = 0.1  # share of the square of a correction over which the limit of eq. (10) is smoothed
# share of the unit matrix in the correlations of references, against ill-conditioning
UNIT_SHARE = 0.01
SIGNATURES_AT_ONCE = 512  # signatures that are computed together


class References(NamedTuple):
    """Solved reference structures on several grounds."""

    sides: DriftingSide  # those of one ground after those of another
    basis: Array  # (grounds, references, references) `basis_of` their correlations


def drifting_side(values: Mapping[str, Array]) -> DriftingSide:
    """Structures of `solve_oscillators` by the drift closure."""
    system = EquivalentSystem(*values["system"])
    forcing = Forcing(*values["forcing"])
    with np.errstate(all="ignore"):  # failed cells are NaN
        rate = values["drift_rate"]
        increments = values["drift_std"] * np.sqrt(2 * rate * values["drift_shares"])
        return DriftingSide.of(motion_of(system, forcing), rate, increments)


def solved_references(
    ground: Ground, soil: Array, tolerance: Tolerance, table: xr.Dataset
) -> References:
    """The references in the ``table`` of a map on grounds with parameters ``soil`` (g, grounds).

    The ``ground`` is of a kind whose calibration has a soil.
    """
    assert ground.calibration is not None
    assert ground.calibration.soil is not None
    period_name, _ = ground.calibration.soil
    names = "period", "damping", "hardening", "elastic_ductility_std"
    rows = [np.tile(table[f"reference_{name}"].values, soil.shape[1]) for name in names]
    soils = np.repeat(soil, table.sizes[DRIFT_REFERENCE], axis=1)
    period = rows[0] * dict(zip(ground.cells(), soils, strict=True))[period_name]
    ones = np.ones_like(period)
    cells = Oscillators(period, rows[1], rows[2], rows[3], ones, ones, soils)
    law = LawOfCells.bilinear(period.size, DRIFT)
    sides = drifting_side(solve_oscillators(cells, law, ground, tolerance))
    count = table.sizes[DRIFT_REFERENCE]
    gram = _with_references(sides, sides, np.repeat(np.arange(soil.shape[1]), count), count)
    return References(sides, basis_of(_definite(gram.reshape(-1, count, count))))


def _with_references(
    side: DriftingSide, references: DriftingSide, ground: Array, count: int
) -> Array:
    """Correlations (n, count) of structures with the references on their grounds (n,)."""
    places = np.arange(ground.size)[:, None], ground[:, None] * count + np.arange(count)
    return over_pairs(drifting_correlation, side, references, places)[0]


def basis_of(gram: Array) -> Array:
    """Matrix (..., k, k) that makes signatures of correlations with the references, eq. (9).

    ``gram`` are the correlations (..., k, k) of the references; if one of them is NaN, so is the
    matrix.
    """
    good = np.isfinite(gram).all(axis=(-2, -1), keepdims=True)
    size = np.eye(gram.shape[-1])
    factor = np.linalg.cholesky((1 - UNIT_SHARE) * np.where(good, gram, size) + UNIT_SHARE * size)
    return np.where(good, np.sqrt(1 - UNIT_SHARE) * np.linalg.inv(factor), np.nan)


def _definite(gram: Array) -> Array:
    """Correlations of the references; NaN where rounding errors dominate them."""
    finite = np.isfinite(gram).all(axis=(-2, -1), keepdims=True)
    least = np.linalg.eigvalsh(np.where(finite, gram, np.eye(gram.shape[-1])))[..., :1, None]
    return np.where(finite & (least > -UNIT_SHARE / 2), gram, np.nan)


@lru_cache(maxsize=CACHED_GROUNDS)
def _solved_once(ground: Ground, tolerance: Tolerance) -> References:
    soil = in_columns([*ground.cells().values()], 1)
    return solved_references(ground, soil, tolerance, drift_map())


def derived_signatures(side: DriftingSide, references: References, ground: Array) -> Array:
    """Signatures (references, n), eq. (9), of structures on the grounds with these numbers (n,)."""
    rho = _with_references(side, references.sides, ground, references.basis.shape[-1])

    def part(cells: slice) -> Array:
        return np.einsum("nij,nj->in", references.basis[ground[cells]], rho[cells])

    return np.hstack(in_ranges(part, ground.size, SIGNATURES_AT_ONCE))


def drifting(solved: Solved, tolerance: Tolerance) -> Drifting:
    """Structures that were solved with the drift closure, and what simulations add to them.

    Structures of other laws that yield are NaN.
    """
    values = solved.values
    cells = solved.oscillators
    side = drifting_side(values)
    for structure, part in zip(solved.structures, solved.parts, strict=True):
        if structure.yields and not isinstance(structure, Bilinear):
            side.variance[part] = np.nan
    with np.errstate(all="ignore"):  # failed cells are NaN
        signature, nearness = _corrections(solved, side, tolerance)
    return Drifting(
        side,
        values["displacement_std"],
        values["displacement_error"],
        np.searchsorted(BOUNDS, values[STRENGTH_RATIO], side="right").astype(np.int8),
        np.log(cells.period),
        simulated(solved.ground, solved.point, cells.soil),
        np.isinf(values["yield_displacement"]),
        signature,
        nearness,
    )


def _corrections(
    solved: Solved, side: DriftingSide, tolerance: Tolerance
) -> tuple[Signature, Nearness]:
    """What simulations say of structures; nothing if all are elastic or the ground is uncalibrated.

    On white noise the signatures are not corrected.
    """
    ground = solved.ground
    point = solved.point
    calibration = ground.calibration
    ones = np.ones(point.shape[1])
    zeros = np.zeros((ENTRIES, ones.size))
    signature = Signature(zeros, zeros, ones, ones)
    yields = any(
        structure.yields and isinstance(structure, Bilinear) for structure in solved.structures
    )
    if calibration is None or not yields:
        return signature, Nearness(zeros[:PARAMETER_AXES], zeros, np.zeros_like(ones))
    if calibration.soil is None:
        point = np.stack([*point, ones, AS_ON_WHITE_NOISE * ones])
    else:
        number = np.zeros(ones.size, int)
        soil = solved.oscillators.soil.copy()
        row = list(ground.cells()).index("intensity")
        side = at_unit_intensity(side, soil[row])
        soil[row] = 1.0  # correlations stay the same
        if any(array.ndim for array in ground.arrays().values()):
            grounds, number = np.unique(soil, axis=1, return_inverse=True)
            references = solved_references(ground, grounds, tolerance, drift_map())
        else:
            references = _solved_once(ground.with_arrays({"intensity": 1.0}), tolerance)
        derived = derived_signatures(side, references, number.ravel())
        signature = corrected(derived, hold_at_ends(SIGNATURE, ground, point))
    least_ratio, most_hardening = RANGE_OF_NEARNESS
    trust = np.log(point[0] / ELASTIC_DEMAND) / np.log(least_ratio / ELASTIC_DEMAND)
    trust = eased(trust) * eased(np.log(point[1]) / np.log(most_hardening))
    place = np.log([solved.oscillators.period, *point[:3]])
    return signature, Nearness(place, matrix_of(hold_at_ends(NEARNESS, ground, point)), trust)


def corrected(derived: Array, correction: Array) -> Signature:
    """The signatures (k, n) that are derived, with their corrections, eq. (10)."""
    signature = derived + correction
    # A signature has a length of at most 1, since it is the projection of a unit vector.
    square = (signature**2).sum(axis=0)
    blur = BLUR * (correction**2).sum(axis=0)
    signature = signature / np.sqrt((square + 1 + np.hypot(square - 1, 2 * blur)) / 2)
    remaining = np.maximum(1 - (signature**2).sum(axis=0), 0)
    remaining_derived = np.maximum(1 - (derived**2).sum(axis=0), 0)
    ratio = np.sqrt((remaining + ADDED_VARIANCE) / (remaining_derived + ADDED_VARIANCE))
    return Signature(signature, ratio * derived, ratio, np.sqrt(remaining))


def matrix_of(form: Array) -> Array:
    """Lower triangles (ENTRIES, n) of matrices G, whose slopes and correlations the map has."""
    slopes = np.exp(form[:PARAMETER_AXES])
    across = dict(zip(OFF_DIAGONAL, form[PARAMETER_AXES:], strict=True))
    triangle = [(i, j) for i in range(PARAMETER_AXES) for j in range(i + 1)]
    return np.stack([slopes[i] * slopes[j] * across.get((i, j), 1.0) for i, j in triangle])


def eased(share: Array) -> Array:
    """A share that rises smoothly from 0 to 1 where ``share`` does; 0 or 1 beyond."""
    share = np.clip(share, 0, 1)
    return share * share * (3 - 2 * share)
