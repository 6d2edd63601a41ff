"""Summary of one motion for a row of buildings: peaks, and sums and extremes over the impacts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr

from stochlin.analyses.pounding.histories import (
    Course,
    by_floor,
    energy_lost,
    energy_transferred,
    largest_force,
)
from stochlin.analyses.pounding.rows import Building, Meeting
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.pounding import impacts
from stochlin.kernels.pounding import run as kernel
from stochlin.kernels.pounding.rows import Row

FLOOR, STRUCTURE, CONTACT, LINK, WHOLE = "floor", "structure", "contact", "link", ""
# Dimension of each variable of a summary; FLOOR also stands for the structure.
DIMENSIONS: Mapping[str, str] = {
    "peak": FLOOR,
    "peak_alone": FLOOR,
    "amplification": FLOOR,
    "peak_acceleration": FLOOR,
    "peak_acceleration_alone": FLOOR,
    "peak_storey_shear": FLOOR,
    "peak_storey_shear_alone": FLOOR,
    "peak_base_shear": STRUCTURE,
    "peak_base_shear_alone": STRUCTURE,
    "energy_received": STRUCTURE,
    "impacts": CONTACT,
    "hardest_force": CONTACT,
    "fastest_approach": CONTACT,
    "longest_impact": CONTACT,
    "deepest_compression": CONTACT,
    "contact_energy": CONTACT,
    "column_force": CONTACT,
    "column_force_share": CONTACT,
    "peak_link_force": LINK,
    "energy_balance_error": WHOLE,
}


def summary(
    row: Row, places: Sequence[Meeting], found: Course, run: kernel.Run, alone: kernel.Run
) -> dict[str, Array]:
    """Summary of one motion, arrays by name, see `DIMENSIONS`."""
    values = _peaks(row, found, run, alone) | _tallies(row, places, run)
    return values | _columns(row, places, run)


def labelled(
    values: Mapping[str, Array], row: Row, structures: Sequence[Building], *over: str
) -> dict[str, xr.Variable]:
    """A summary as arrays over named dimensions, several along the additional dimension ``over``.

    The coordinates are those of `floor_coords`.
    """
    return {
        name: by_floor(array, row, structures, *over)
        if DIMENSIONS[name] == FLOOR
        else xr.Variable([*over, *filter(None, [DIMENSIONS[name]])], array)
        for name, array in values.items()
    }


def _peaks(row: Row, found: Course, run: kernel.Run, alone: kernel.Run) -> dict[str, Array]:
    """Largest absolute values in the row and of each building alone, also between outputs."""
    values: dict[str, Array] = {}
    for ending, one in (("", run), ("_alone", alone)):
        values |= {
            f"peak{ending}": np.abs(one.peaks).max(axis=0),
            f"peak_acceleration{ending}": one.most.acceleration,
            f"peak_storey_shear{ending}": one.most.shear,
            f"peak_base_shear{ending}": one.most.shear[row.first[:-1]],
        }
    history = found.floors | found.structures
    for name in ("acceleration", "storey_shear", "base_shear"):  # outputs are not always ends of steps
        values[f"peak_{name}"] = np.maximum(values[f"peak_{name}"], np.abs(history[name]).max(axis=0))
    apart = values["peak_alone"]
    unknown = np.full_like(apart, np.nan)
    values["amplification"] = np.divide(values["peak"], apart, out=unknown, where=apart > 0)
    for name, pull in found.links.items():
        values[f"peak_{name}"] = np.maximum(run.most.pull, np.abs(pull).max(axis=0))
    return values


def _tallies(row: Row, places: Sequence[Meeting], run: kernel.Run) -> dict[str, Array]:
    """Number, extremes and lost energy of the impacts of each contact, and energy received."""
    line = run.impacts.T
    where = line[impacts.CONTACT].astype(np.int64)
    hit = where == np.arange(row.gap.size)[:, None]
    at_most = {
        "hardest_force": largest_force(run),
        "fastest_approach": line[impacts.APPROACH],
        "longest_impact": line[impacts.END] - line[impacts.BEGIN],
        "deepest_compression": np.where(row.jumps, np.nan, line[impacts.DEEPEST]),
    }
    values: dict[str, Array] = {"impacts": hit.sum(axis=1)}
    for name, each in at_most.items():  # NaN without an impact, or where one has no such value
        most = np.array([np.maximum.reduce(each[own], initial=-np.inf) for own in hit])
        values[name] = np.where(np.isfinite(most), most, np.nan)
    values["contact_energy"] = hit @ energy_lost(run)
    received = np.zeros(row.first.size - 1)
    left = np.array([place.building for place in places], np.int64)[where]
    for side, given in enumerate(energy_transferred(run).T):
        np.add.at(received, left + side, given)
    values["energy_received"] = received
    return values


def _columns(row: Row, places: Sequence[Meeting], run: kernel.Run) -> dict[str, Array]:
    """Largest force on columns that a slab meets [N], also over the storey shear at yield [-].

    Contacts slab to slab are NaN.
    """
    struck = np.array([bool(m.struck) for m in places])
    if not struck.any():
        return {}
    most = np.zeros(struck.size)
    where = run.impacts[:, impacts.CONTACT].astype(np.int64)
    np.maximum.at(most, where, largest_force(run))
    floor = np.where([m.struck == "left" for m in places], row.left, row.right)
    strength = (row.post[floor] + row.couple[floor]) * row.strength[floor]
    force = np.where(struck, most, np.nan)
    share = np.where(np.isfinite(strength), force / strength, np.nan)
    return {"column_force": force, "column_force_share": share}
