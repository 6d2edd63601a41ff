"""Signatures of drifting structures: how they move together with references that were simulated.

Two structures drift together as far as they slip at the same moments, and that cannot be seen from
either of their covariances. It can be tabulated structure by structure all the same: by the
correlations with a few reference structures on the same ground. The derived signature comes from
the derived correlations, and its correction from the map of simulations.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np
import xarray as xr

from stochlin.analyses.correlation.derived_pairs import derived_correlation
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
from stochlin.analyses.tables.cellwise import Cells, Solved, cellwise
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.correlation.nearness import AXES, ENTRIES, Nearness
from stochlin.kernels.correlation.signatures import Insight, insight, signature
from stochlin.models.grounds import Ground, WhiteNoise
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.structures import DRIFT, Structure

OTHER = "other_reference"
OF_NEARNESS = AXES + ENTRIES + 1
KNOWN_NEARNESS = (0.5, 0.5)  # R/p from which, and hardening up to which the map has it; elastic: none
# Periods of the ground from which on the broadest Kanai-Tajimi ground is white for a structure.
AS_ON_WHITE_NOISE = 5.0
GROUNDS = 64  # of numbers, whose references are kept
PEAK_FACTOR = 3.0  # of the references, by which a reduction factor is told from R/p


def references(ground: Ground) -> Bilinear:
    """The reference structures of the map, over ``drift_reference`` and the dimensions of the ground."""
    table = drift_map()
    return Bilinear(
        table.reference_period * ground.arrays()["period"],
        table.reference_damping,
        table.reference_hardening,
        reduction_factor=PEAK_FACTOR * table.reference_elastic_ductility_std,
        peak_factor=PEAK_FACTOR,
    )


def derived_signatures(solved: Sequence[Solved], known: Solved, gram: xr.DataArray | Array) -> list[Any]:
    """Signatures of structures over the references, all with the drifts of `solve_derived`.

    ``gram`` has the correlations of the references.
    """
    core = ([REFERENCE], [REFERENCE, OTHER])
    joint = [derived_correlation(side, known) for side in solved]
    return [cellwise(_signature, one, gram, core=core, result=[REFERENCE])[0] for one in joint]


def derived_gram(known: xr.Dataset) -> xr.DataArray:
    """Correlations of the references with one another."""
    return derived_correlation(known, known.rename({REFERENCE: OTHER}))


def _solved_references(ground: Ground, tolerance: Tolerance) -> tuple[xr.Dataset, xr.DataArray]:
    known = solve_derived(references(ground), ground, DRIFT, tolerance)
    return known, derived_gram(known)


_solved_once = lru_cache(maxsize=GROUNDS)(_solved_references)


@lru_cache(maxsize=GROUNDS)
def _plain_references(ground: Ground, tolerance: Tolerance) -> tuple[Solved, Array]:
    """The same without labels, for lone cells."""
    known, gram = _solved_once(ground, tolerance)
    return {name: array.values for name, array in known.items()}, gram.values


def _signature(joint: Array, gram: Array) -> Array:
    """Of cells whose ground could be solved; NaN elsewhere."""
    good = np.asarray(np.isfinite(gram).all(axis=(-2, -1)))
    safe = np.where(good[..., None, None], gram, np.eye(gram.shape[-1]))
    return np.where(good[..., None], signature(joint, safe), np.nan)


def insights(
    structures: tuple[Structure, Structure],
    solved: Sequence[Solved],
    ground: Ground,
    tolerance: Tolerance,
) -> list[list[Cells]]:
    """Arrays of what the map knows of both structures, flat; none where it does not know the ground.

    Those of the `Insight`, and then those of the `Nearness`.
    """
    if type(ground) not in CORRECTED_GROUNDS or not any(structure.yields for structure in structures):
        return [[], []]
    pairs = list(zip(structures, solved, strict=True))
    points = [point_of(structure, ground, side) for structure, side in pairs]
    if isinstance(ground, WhiteNoise):
        soil = [1.0, AS_ON_WHITE_NOISE]
        both = zip(points, pairs, strict=True)
        return [_like([*point, *soil], one.cells()["period"]) for point, (one, _) in both]
    one_ground = all(array.ndim == 0 for array in ground.arrays().values())
    of_arrays = None if one_ground else _solved_references(ground, tolerance)
    told = []
    for point, side in zip(points, solved, strict=True):
        labelled = any(isinstance(array, xr.DataArray) for array in side.values())
        known = of_arrays or (_solved_once if labelled else _plain_references)(ground, tolerance)
        (own,) = derived_signatures([side], *known)
        correction = hold_at_ends(SIGNATURE, point)
        core = ([REFERENCE], *([] for _ in correction))
        kinds = (float,) * (2 * len(correction) + 1)
        seen = cellwise(_insight, own, *correction, core=core, kinds=kinds)
        told.append([*seen, *_like(point, point[-1])])
    return told


def _like(point: list[Cells], period: Cells) -> list[Cells]:
    """Arrays of the `Nearness`; periods are compared with one another only."""
    arrays = (period, *point[:3], *hold_at_ends(NEARNESS, point))
    return list(cellwise(_nearness, *arrays, kinds=(float,) * OF_NEARNESS))


@np.errstate(divide="ignore", invalid="ignore")  # elastic: log 0, and not trusted
def _nearness(*arrays: Array) -> tuple[Array, ...]:
    strength, hardening = arrays[1:3]
    place = [np.log(value) for value in arrays[:AXES]]
    least, most = KNOWN_NEARNESS
    trust = np.log(strength / ELASTIC) / np.log(least / ELASTIC)
    trust = np.clip(trust, 0, 1) * np.clip(np.log(hardening) / np.log(most), 0, 1)
    return tuple(np.broadcast_arrays(*place, *arrays[AXES:], trust))


@np.errstate(invalid="ignore")  # cells that are not solved are NaN
def _insight(own: Array, *correction: Array) -> tuple[Array, ...]:
    together = np.broadcast_arrays(*np.moveaxis(own, -1, 0), *correction)
    found = insight(*np.array(together).reshape(2, len(correction), *together[0].shape))
    return (*found.known, *found.derived, found.unseen)


def insight_of(arrays: tuple[Array, ...] | list[Array]) -> tuple[Insight | None, Nearness]:
    """From arrays as `insights` lists them."""
    seen, like = arrays[:-OF_NEARNESS], arrays[-OF_NEARNESS:]
    nearness = Nearness(np.stack(like[:AXES]), np.stack(like[AXES:-1]), like[-1])
    if not seen:
        return None, nearness
    half = len(seen) // 2
    known, derived = (np.stack(part) for part in (seen[:half], seen[half : 2 * half]))
    return Insight(known, derived, seen[-1]), nearness
