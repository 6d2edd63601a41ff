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

from stochlin.analyses.correlation.drift.derived import OF_A_SIDE, derived_correlation
from stochlin.analyses.linearization.bias_map import point_of
from stochlin.analyses.linearization.drift_map import (
    CORRECTED_GROUNDS,
    ELASTIC,
    NEARNESS,
    REFERENCE,
    SIGNATURE,
    drift_map,
    hold_at_ends,
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


def derived_signatures(solved: Sequence[Solved], known: Solved, gram: xr.DataArray | Array) -> list[Any]:
    """Signatures, eq. (9), of structures over ``drift_reference``, one for each of ``solved``.

    ``known`` are the references; both are solved by `solve_derived`. ``gram`` holds the correlations of
    the references with one another.
    """
    core = ([REFERENCE], [REFERENCE, OTHER])
    joint = [derived_correlation(side, known) for side in solved]
    return [cellwise(_signature, rho, gram, core=core, result=[REFERENCE])[0] for rho in joint]


def derived_gram(known: xr.Dataset) -> xr.DataArray:
    """Correlations of the references with one another."""
    return derived_correlation(known, known.rename({REFERENCE: OTHER}))


def _solved_references(ground: Ground, tolerance: Tolerance) -> tuple[xr.Dataset, xr.DataArray]:
    known = solve_derived(references(ground), ground, DRIFT, tolerance)
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
def _plain_references(ground: Ground, tolerance: Tolerance) -> tuple[Solved, Array]:
    """`_solved_references` as numbers without labels, for single cells."""
    known, gram = _solved_once(ground, tolerance)
    return {name: array.values for name, array in known.items()}, gram.values


def _signature(joint: Array, gram: Array) -> Array:
    """Signatures of cells; NaN where the references could not be solved on the ground."""
    good = np.asarray(np.isfinite(gram).all(axis=(-2, -1)))
    safe = np.where(good[..., None, None], gram, np.eye(gram.shape[-1]))
    return np.where(good[..., None], signature(joint, safe), np.nan)


def insights(
    structures: tuple[Structure, Structure],
    solved: Sequence[Solved],
    ground: Ground,
    tolerance: Tolerance,
) -> list[list[Cells]]:
    """Arrays of the `Insight`, then of the `Nearness`, of each structure.

    The lists are empty if the map does not have this kind of ground, or if both structures are elastic.
    On white noise there is no `Insight`.
    """
    if type(ground) not in CORRECTED_GROUNDS or not any(structure.yields for structure in structures):
        return [[], []]
    pairs = list(zip(structures, solved, strict=True))
    points = [point_of(structure, ground, side) for structure, side in pairs]
    if isinstance(ground, WhiteNoise):
        soil = [1.0, AS_ON_WHITE_NOISE]
        both = zip(points, pairs, strict=True)
        return [_like([*point, *soil], structure.cells()["period"]) for point, (structure, _) in both]
    one_ground = all(array.ndim == 0 for array in ground.arrays().values())
    labelled = any(is_labelled(*side.values()) for side in solved)
    if one_ground and not labelled:  # two single cells take hardly longer than one
        sides = {name: np.array([side[name] for side in solved])[:, None] for name in OF_A_SIDE}
        place: list[Cells] = [np.array(values) for values in zip(*points, strict=True)]
        rows = [
            np.asarray(row) for row in _insight_of(sides, place, *_plain_references(ground, tolerance))
        ]
        return [[row[n, ...] for row in rows] for n in range(len(pairs))]
    of_arrays = (_solved_once if one_ground else _solved_references)(ground, tolerance)
    return [_insight_of(side, point, *of_arrays) for point, side in zip(points, solved, strict=True)]


def _insight_of(
    side: Solved, point: list[Cells], known: Solved, gram: xr.DataArray | Array
) -> list[Cells]:
    """Arrays of the `Insight`, then of the `Nearness`, from the references and their `derived_gram`."""
    (own,) = derived_signatures([side], known, gram)
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
