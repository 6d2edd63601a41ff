"""Signatures of structures with plastic drift, from their correlations with reference structures.

The plastic drifts of two structures are correlated if both slip at the same instants, which does not
follow from their covariances. A table over all pairs would have too many parameters. The signature of a
structure, eq. (9) of ``docs/drift.md``, describes it by its correlations with a few reference structures
on the same ground, so that each structure can be tabulated alone. The signature is derived with the
drift closure, and its correction is interpolated in a map of simulations.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np
import xarray as xr

from stochlin.analyses.correlation.drift.derived import Side, derived_correlation, side_of
from stochlin.analyses.linearization.drift_map import (
    CORRECTED_GROUNDS,
    ELASTIC,
    NEARNESS,
    REFERENCE,
    SIGNATURE,
    drift_map,
    hold_at_ends,
    point_of,
)
from stochlin.analyses.linearization.equivalent_systems import solve_derived
from stochlin.analyses.linearization.tolerance import Tolerance
from stochlin.analyses.tables.cellwise import Cells, Solved, cellwise, is_labelled
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.correlation.nearness import AXES, ENTRIES, Nearness, eased
from stochlin.kernels.correlation.signatures import OWN, Insight, insight, signature
from stochlin.models.grounds import Ground, WhiteNoise
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.structures import DRIFT, Structure

OTHER = "other_reference"
OF_NEARNESS = AXES + ENTRIES + 1  # number of arrays of a `Nearness`
# The map of `Nearness` has R/p from the first value up, and hardening up to the second.
KNOWN_NEARNESS = (0.5, 0.5)
# T/Tg for which a Kanai-Tajimi ground of damping 1 acts on the structure like white noise.
AS_ON_WHITE_NOISE = 5.0
GROUNDS = 64  # number of grounds with scalar parameters whose solved references are kept
PEAK_FACTOR = 3.0  # p of the references, with which R follows from R/p


def references(ground: Ground) -> Bilinear:
    """Reference structures of the map, over ``drift_reference`` and the dimensions of the ground."""
    table = drift_map()
    return Bilinear(
        table.reference_period * ground.arrays()["period"],
        table.reference_damping,
        table.reference_hardening,
        reduction_factor=PEAK_FACTOR * table.reference_elastic_ductility_std,
        peak_factor=PEAK_FACTOR,
    )


def derived_signature(side: Side, known: Side, gram: xr.DataArray | Array) -> Any:
    """Signatures, eq. (9), of structures over ``drift_reference``.

    ``known`` are the references, and ``gram`` holds their correlations with one another.
    """
    core = ([REFERENCE], [REFERENCE, OTHER])
    return cellwise(_signature, derived_correlation(side, known), gram, core=core, result=[REFERENCE])[0]


def derived_gram(known: Side) -> xr.DataArray:
    """Correlations of the references with one another."""
    return derived_correlation(known, [values.rename({REFERENCE: OTHER}) for values in known])


def _solved_references(ground: Ground, tolerance: Tolerance) -> tuple[Side, xr.DataArray]:
    known = side_of(solve_derived(references(ground), ground, DRIFT, tolerance))
    core = [REFERENCE, OTHER]
    return known, cellwise(_definite, derived_gram(known), core=[core], result=core)[0]


def _definite(gram: Array) -> Array:
    """Correlations of the references; NaN where rounding errors dominate them."""
    finite = np.asarray(np.isfinite(gram).all(axis=(-2, -1)))
    safe = np.where(finite[..., None, None], gram, np.eye(gram.shape[-1]))
    good = finite & (np.linalg.eigvalsh(safe)[..., 0] > -OWN / 2)
    return np.where(good[..., None, None], gram, np.nan)


_solved_once = lru_cache(maxsize=GROUNDS)(_solved_references)


@lru_cache(maxsize=GROUNDS)
def _plain_references(ground: Ground, tolerance: Tolerance) -> tuple[Side, Array]:
    """`_solved_references` as numbers without labels, for single cells."""
    known, gram = _solved_once(ground, tolerance)
    return [np.asarray(values) for values in known], gram.values


def _signature(joint: Array, gram: Array) -> Array:
    """Signatures of cells; NaN where the references could not be solved on the ground."""
    good = np.asarray(np.isfinite(gram).all(axis=(-2, -1)))
    safe = np.where(good[..., None, None], gram, np.eye(gram.shape[-1]))
    return np.where(good[..., None], signature(joint, safe), np.nan)


def insights(
    structures: tuple[Structure, Structure],
    solved: Sequence[Solved],
    sides: Sequence[Side],
    ground: Ground,
    tolerance: Tolerance,
) -> list[list[Cells]]:
    """Arrays of the `Insight`, then of the `Nearness`, of each structure.

    The lists are empty if the map does not have this kind of ground, or if both structures are elastic.
    On white noise there is no `Insight`.
    """
    if type(ground) not in CORRECTED_GROUNDS or not any(structure.yields for structure in structures):
        return [[], []]
    pairs = zip(structures, solved, strict=True)
    points = [point_of(structure, ground, results) for structure, results in pairs]
    if isinstance(ground, WhiteNoise):
        soil = [1.0, AS_ON_WHITE_NOISE]
        placed = zip(points, structures, strict=True)
        return [_like([*point, *soil], structure.cells()["period"]) for point, structure in placed]
    one_ground = all(array.ndim == 0 for array in ground.arrays().values())
    labelled = any(is_labelled(*side.values()) for side in solved)
    if one_ground and not labelled:  # two single cells take hardly longer than one
        both = [np.array(values)[:, None] for values in zip(*sides, strict=True)]
        place: list[Cells] = [np.array(values) for values in zip(*points, strict=True)]
        rows = [
            np.asarray(row) for row in _insight_of(both, place, *_plain_references(ground, tolerance))
        ]
        return [[row[n, ...] for row in rows] for n in range(len(sides))]
    of_arrays = (_solved_once if one_ground else _solved_references)(ground, tolerance)
    return [_insight_of(side, point, *of_arrays) for point, side in zip(points, sides, strict=True)]


def _insight_of(side: Side, point: list[Cells], known: Side, gram: xr.DataArray | Array) -> list[Cells]:
    """Arrays of the `Insight`, then of the `Nearness`, from the references and their `derived_gram`."""
    own = derived_signature(side, known, gram)
    correction = hold_at_ends(SIGNATURE, point)
    core = ([REFERENCE], *([] for _ in correction))
    kinds = (float,) * (2 * len(correction) + 1)
    seen = cellwise(_insight, own, *correction, core=core, kinds=kinds)
    return [*seen, *_like(point, point[-1])]


def _like(point: list[Cells], period: Cells) -> list[Cells]:
    """Arrays of the `Nearness`; ``period`` in any unit, since only ratios of periods enter."""
    arrays = (period, *point[:3], *hold_at_ends(NEARNESS, point))
    return list(cellwise(_nearness, *arrays, kinds=(float,) * OF_NEARNESS))


@np.errstate(divide="ignore", invalid="ignore", over="ignore")  # of elastic structures: log 0, trust 0
def _nearness(*arrays: Array) -> tuple[Array, ...]:
    strength, hardening = arrays[1:3]
    place = [np.log(value) for value in arrays[:AXES]]
    least, most = KNOWN_NEARNESS
    trust = np.log(strength / ELASTIC) / np.log(least / ELASTIC)
    trust = eased(trust) * eased(np.log(hardening) / np.log(most))
    return tuple(np.broadcast_arrays(*place, *arrays[AXES:], trust))


@np.errstate(invalid="ignore")  # failed cells are NaN
def _insight(own: Array, *correction: Array) -> tuple[Array, ...]:
    together = np.broadcast_arrays(*np.moveaxis(own, -1, 0), *correction)
    result = insight(*np.array(together).reshape(2, len(correction), *together[0].shape))
    return (*result.known, *result.derived, result.unseen)


def insight_of(arrays: tuple[Array, ...] | list[Array]) -> tuple[Insight | None, Nearness]:
    """The `Insight`, None on white noise, and the `Nearness` from one list that `insights` returns."""
    seen, like = arrays[:-OF_NEARNESS], arrays[-OF_NEARNESS:]
    nearness = Nearness(np.stack(like[:AXES]), np.stack(like[AXES:-1]), like[-1])
    if not seen:
        return None, nearness
    half = len(seen) // 2
    known, derived = (np.stack(part) for part in (seen[:half], seen[half : 2 * half]))
    return Insight(known, derived, seen[-1]), nearness
