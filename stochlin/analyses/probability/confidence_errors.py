"""Where the confidence of no pounding by formula is accurate: by a simulation beside it, or by region.

The regions were chosen on half of 840 random pairs, 762 of them yielding, in finite motions with four
gaps each, by comparison with simulation.
"""

from __future__ import annotations

import numpy as np
import xarray as xr

from stochlin.analyses.linearization.drift_map import CORRECTED_GROUNDS
from stochlin.analyses.linearization.equivalent_systems import STRENGTH_RATIO, solve_elastic
from stochlin.models.grounds import Ground
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.structures import Structure
from stochlin.models.systems import AnyStructure

STEM, ENDINGS = "confidence_of_no_pounding", ("", "_corrected")
OFF = 0.1  # most by which a confidence with the flag 0 is too large
MEANINGS = ("too_large_by_0.1_at_most", "may_be_larger_than_that", "outside_of_what_was_checked")
# Ranges of the checked pairs: R/p, hardening and damping of yielding structures, ratio of the periods.
STRENGTH, HARDENING, DAMPING, RATIO = (0.0, 3.0), (0.02, 0.3), (0.02, 0.1), 3.0
STIFF = 0.5  # ratio of the shorter period to that of the ground below which no formula is accurate
WEAK_YIELDING, MODERATE = 0.5, 4.0 / 3  # largest R/p: weak yielding, moderate yielding
APART = 1.5  # smallest ratio of periods that are well separated
# Smallest corrected confidence that is accurate, and largest difference of the formula from it.
SAFE, NEAR = 0.85, 0.05
ROUNDING = 1e-9


def cautions(
    first: AnyStructure, second: AnyStructure, ground: Ground, table: xr.Dataset, scatter: float
) -> dict[str, xr.DataArray]:
    """Flags of the confidence by formula at the end of the motion, and of the corrected one.

    The formula is accurate for elastic pairs, for weak yielding, and where an accurate correction
    changes it little. The correction is accurate for a large confidence, and for moderate yielding with
    well separated periods.
    """
    plain, corrected = (table[f"{STEM}{ending}"].isel(time=-1, drop=True) for ending in ENDINGS)
    if not (isinstance(first, Structure) and isinstance(second, Structure)):
        unknown = _flag(plain, xr.full_like(plain, 2))
        return {"caution": unknown, "caution_corrected": unknown}
    pair = (first, second)
    most = xr.apply_ufunc(np.maximum, *(_strength(side, ground) for side in pair))
    period_1, period_2 = (side.arrays()["period"] for side in pair)
    shorter = xr.apply_ufunc(np.minimum, period_1, period_2)
    apart = period_1 * period_2 / shorter**2
    soil = ground.arrays().get("period", xr.DataArray(0.0))
    inside = _checked(pair, ground, scatter) & (most <= STRENGTH[1]) & (apart <= RATIO + ROUNDING)
    soft = shorter >= STIFF * soil
    elastic = xr.DataArray(not (first.yields or second.yields))
    sure = soft & ((corrected >= SAFE) | ((apart >= APART) & (most <= MODERATE)))
    hardly = soft & (most <= WEAK_YIELDING + ROUNDING)
    little = soft & (corrected >= SAFE) & (plain <= corrected + NEAR)
    flags = {}
    for name, good, known in (
        ("caution", hardly | little, inside),
        ("caution_corrected", sure, inside & corrected.notnull()),
    ):
        value = xr.where(known, xr.where(good, 0, 1), 2)  # type: ignore[no-untyped-call]
        value = xr.where(elastic, 0, value)  # type: ignore[no-untyped-call]
        flags[name] = _flag(plain, value)
    return flags


def measured_cautions(table: xr.Dataset) -> dict[str, xr.DataArray]:
    """The flags of `cautions` by the simulation in the table: 0 for `OFF` at most, and 1 for more.

    The formulas are compared with the lower end of the interval of the simulated confidence.
    """
    last = table.isel(time=-1, drop=True)
    most = last[f"{STEM}_simulated_lower"] + OFF
    source = f"by the simulation beside it: {table.attrs['paths']} motions, seed {table.attrs['seed']}"
    flags = {}
    for ending in ENDINGS:
        plain = last[f"{STEM}{ending}"]
        flags[f"caution{ending}"] = _flag(plain, (plain > most).astype(np.int8))
        flags[f"caution{ending}"].attrs["comment"] = source
    return flags


def _strength(structure: Structure, ground: Ground) -> xr.DataArray:
    """R/p of a structure, and 0 if it is elastic."""
    return solve_elastic(structure, ground)[STRENGTH_RATIO] if structure.yields else xr.DataArray(0.0)


def _checked(pair: tuple[Structure, Structure], ground: Ground, scatter: float) -> xr.DataArray:
    """Whether the kinds and parameters of a pair are within the checked ranges."""
    inside = xr.DataArray(type(ground) in CORRECTED_GROUNDS and not scatter)
    for structure in pair:
        if structure.yields:
            values = structure.arrays()
            inside = inside & isinstance(structure, Bilinear)
            for name, (low, high) in (("hardening", HARDENING), ("damping", DAMPING)):
                inside = inside & (values[name] >= low - ROUNDING) & (values[name] <= high + ROUNDING)
    return inside


def _flag(like: xr.DataArray, value: xr.DataArray) -> xr.DataArray:
    """Flag over the dimensions and coordinates of ``like``, and 2 where ``like`` is NaN."""
    shown = value.broadcast_like(like).where(like.notnull(), 2).transpose(*like.dims)
    flag = like.copy(data=shown.values.astype(np.int8))
    flag.attrs = {
        "long_name": "caution flag of the confidence at the end of the motion",
        "flag_values": np.arange(len(MEANINGS), dtype=np.int8),
        "flag_meanings": " ".join(MEANINGS),
    }
    return flag
