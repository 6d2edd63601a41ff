"""Signatures of structures with plastic drift, from their correlations with reference structures.

The plastic drifts of two structures are correlated if both slip at the same instants, which does not
follow from their covariances. A table over all pairs would have too many parameters. The signature of a
structure, eq. (9) of ``docs/drift.md``, describes it by its correlations with a few reference structures
on the same ground, so that each structure can be tabulated alone. The signature is derived with the
drift closure, and its correction is interpolated in a map of simulations.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from typing import NamedTuple

import numpy as np
import xarray as xr

from stochlin.analyses.linearization.drift_map import (
    CORRECTED_GROUNDS,
    ELASTIC,
    NEARNESS,
    REFERENCE,
    SIGNATURE,
    drift_map,
    hold_at_ends,
)
from stochlin.analyses.linearization.equivalent_systems import (
    Law,
    Oscillators,
    Solved,
    in_columns,
    solve_oscillators,
)
from stochlin.analyses.linearization.tolerance import Tolerance
from stochlin.kernels.basics.arrays import Array, on_arrays
from stochlin.kernels.basics.slabs import in_ranges
from stochlin.kernels.correlation.nearness import Nearness, eased
from stochlin.kernels.correlation.signatures import OWN, Insight, basis_of, insight
from stochlin.kernels.linearization.covariance import EquivalentSystem, Forcing
from stochlin.kernels.linearization.drift import DriftingSide, drifting_correlation
from stochlin.models.grounds import Ground, WhiteNoise
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.structures import DRIFT

# The map of `Nearness` has R/p from the first value up, and hardening up to the second.
KNOWN_NEARNESS = (0.5, 0.5)
# T/Tg for which a Kanai-Tajimi ground of damping 1 acts on the structure like white noise.
AS_ON_WHITE_NOISE = 5.0
GROUNDS = 64  # number of grounds with scalar parameters whose solved references are kept
TOGETHER = 512  # structures that are compared with the references together


class References(NamedTuple):
    """Solved reference structures on several grounds."""

    sides: DriftingSide  # arrays (..., grounds, references)
    basis: Array  # (grounds, references, references) `basis_of` their correlations


def drifting_side(values: Mapping[str, Array]) -> DriftingSide:
    """Structures of `solve_oscillators` by the drift closure."""
    system, forcing = EquivalentSystem(*values["system"]), Forcing(*values["forcing"])
    drift = values["drift_std"], values["drift_rate"]
    with np.errstate(all="ignore"):  # failed cells are NaN
        side = DriftingSide.of(system, forcing, *drift, list(values["drift_shares"]))
    return DriftingSide(*side[:-1], np.array(side.kicks))  # type: ignore[arg-type]


def solved_references(
    ground: Ground, soil: Array, tolerance: Tolerance, table: xr.Dataset
) -> References:
    """The references in the ``table`` of a map on grounds with the parameters ``soil`` (g, grounds)."""
    names = "period", "damping", "hardening", "elastic_ductility_std"
    rows = [np.tile(table[f"reference_{name}"].values, soil.shape[1]) for name in names]
    each = np.repeat(soil, table.sizes[REFERENCE], axis=1)
    period = rows[0] * dict(zip(ground.cells(), each, strict=True))["period"]
    one = np.ones_like(period)
    cells = Oscillators(period, rows[1], rows[2], rows[3], one, one, each)
    law = Law(np.arange(period.size), np.empty((0, period.size)), one > 0, Bilinear.closures[DRIFT])
    side = drifting_side(solve_oscillators(cells, [law], ground, tolerance, drifts=True))
    shape = soil.shape[1], table.sizes[REFERENCE]
    sides: DriftingSide = on_arrays(lambda x: x.reshape((*x.shape[:-1], *shape)), side)
    return References(sides, basis_of(_definite(gram_of(sides))))


def gram_of(sides: DriftingSide) -> Array:
    """Correlations (..., k, k) of k structures with one another."""
    own = on_arrays(lambda x: x[..., :, None], sides)
    other = on_arrays(lambda x: x[..., None, :], sides)
    with np.errstate(all="ignore"):
        return drifting_correlation(own, other)


def _definite(gram: Array) -> Array:
    """Correlations of the references; NaN where rounding errors dominate them."""
    finite = np.isfinite(gram).all(axis=(-2, -1), keepdims=True)
    least = np.linalg.eigvalsh(np.where(finite, gram, np.eye(gram.shape[-1])))[..., :1, None]
    return np.where(finite & (least > -OWN / 2), gram, np.nan)


@lru_cache(maxsize=GROUNDS)
def _solved_once(ground: Ground, tolerance: Tolerance) -> References:
    soil = in_columns([*ground.cells().values()], 1)
    return solved_references(ground, soil, tolerance, drift_map())


def derived_signatures(side: DriftingSide, known: References, place: Array) -> Array:
    """Signatures (references, n), eq. (9), of structures on the grounds of these places (n,)."""

    @np.errstate(all="ignore")
    def part(cells: slice) -> Array:
        own = on_arrays(lambda x: x[..., cells, None], side)
        here = on_arrays(lambda x: x[..., place[cells], :], known.sides)
        return np.einsum("nij,nj->in", known.basis[place[cells]], drifting_correlation(own, here))

    return np.hstack(in_ranges(part, place.size, TOGETHER))


def insights(
    solved: Solved, side: DriftingSide, tolerance: Tolerance
) -> tuple[Insight | None, Nearness | None]:
    """What simulations say of structures that were solved with the drift closure.

    It is nothing if the map does not have this kind of ground, or if all structures are elastic. On
    white noise there is no `Insight`.
    """
    ground, point = solved.ground, solved.point
    yields = any(structure.yields for structure in solved.structures)
    if type(ground) not in CORRECTED_GROUNDS or not yields:
        return None, None
    if isinstance(ground, WhiteNoise):
        one = np.ones_like(point[:1])
        return None, _nearness(np.concatenate([point, one, AS_ON_WHITE_NOISE * one]), solved.oscillators)
    place, soil = np.zeros(point.shape[1], int), solved.oscillators.soil
    if any(array.ndim for array in ground.arrays().values()):
        grounds, place = np.unique(soil, axis=1, return_inverse=True)
        known = solved_references(ground, grounds, tolerance, drift_map())
    else:
        known = _solved_once(ground, tolerance)
    seen = insight(derived_signatures(side, known, place.ravel()), hold_at_ends(SIGNATURE, point))
    return seen, _nearness(point, solved.oscillators)


@np.errstate(divide="ignore", invalid="ignore", over="ignore")  # of elastic structures: log 0, trust 0
def _nearness(point: Array, cells: Oscillators) -> Nearness:
    place = np.log([cells.period, *point[:3]])
    least, most = KNOWN_NEARNESS
    trust = np.log(point[0] / ELASTIC) / np.log(least / ELASTIC)
    trust = eased(trust) * eased(np.log(point[1]) / np.log(most))
    return Nearness(place, hold_at_ends(NEARNESS, point), trust)
