"""Summary of one motion for a row of buildings: peaks, and sums and extremes over the impacts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr

from stochlin.analyses.pounding.histories import by_floor, energy_transferred
from stochlin.analyses.pounding.rows import Building, Standing
from stochlin.analyses.pounding.runs import RowResponse
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.pounding import impacts

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
    "step_error": WHOLE,
}


def summary(standing: Standing, response: RowResponse, alone: RowResponse) -> dict[str, Array]:
    """Summary of one motion, arrays by name, see `DIMENSIONS`."""
    values = _peaks(standing, response, alone) | _tallies(standing, response)
    return values | _columns(standing, response)


def step_error(standing: Standing, response: RowResponse, finer: RowResponse) -> float:
    """Largest relative change of a peak displacement or largest force from steps twice as long [-].

    The steps are of second order, so that the error that remains in the finer response is about a third
    of the change. A peak counts beside the largest of its structure.
    """
    whole = np.maximum.reduceat(finer.peaks, standing.first[:-1])
    largest = np.repeat(whole, np.diff(standing.first))
    moved = np.abs(response.peaks - finer.peaks) / np.where(largest > 0, largest, 1.0)
    hardest, more = (_tallies(standing, each)["hardest_force"] for each in (response, finer))
    hits = np.isfinite(hardest) & np.isfinite(more)
    changes = np.abs(hardest[hits] - more[hits]) / more[hits]
    return float(max(moved.max(), changes.max(initial=0.0)))


def labelled(
    values: Mapping[str, Array], first: Array, structures: Sequence[Building], *over: str
) -> dict[str, xr.Variable]:
    """A summary as arrays over named dimensions, several along the additional dimension ``over``.

    The coordinates are those of `floor_coords`.
    """
    return {
        name: by_floor(array, first, structures, *over)
        if DIMENSIONS[name] == FLOOR
        else xr.Variable([*over, *filter(None, [DIMENSIONS[name]])], array)
        for name, array in values.items()
    }


def _peaks(standing: Standing, response: RowResponse, alone: RowResponse) -> dict[str, Array]:
    """Largest absolute values in the row and of each building alone."""
    values: dict[str, Array] = {}
    first = standing.first
    for ending, own in (("", response), ("_alone", alone)):
        to = own.to
        shear = own.of(to.force, to.force + first[-1])
        values |= {
            f"peak{ending}": own.peaks,
            f"peak_acceleration{ending}": own.of(to.acceleration, to.force),
            f"peak_storey_shear{ending}": shear,
            f"peak_base_shear{ending}": shear[first[:-1]],
        }
    apart = values["peak_alone"]
    unknown = np.full_like(apart, np.nan)
    values["amplification"] = np.divide(values["peak"], apart, out=unknown, where=apart > 0)
    if standing.row.parts.spring.size:
        values["peak_link_force"] = response.of(response.to.pull, response.to.entering)
    return values | {"energy_balance_error": response.numbers[response.to.imbalance]}


def _tallies(standing: Standing, response: RowResponse) -> dict[str, Array]:
    """Number, extremes and lost energy of the impacts of each contact, and energy received."""
    line, contacts = response.impacts.T, standing.row.contacts
    where = line[impacts.CONTACT].astype(np.int64)
    hit = where == np.arange(contacts.gap.size)[:, None]
    at_most = {
        "hardest_force": line[impacts.LARGEST],
        "fastest_approach": line[impacts.APPROACH],
        "longest_impact": line[impacts.END] - line[impacts.BEGIN],
        "deepest_compression": np.where(contacts.jumps, np.nan, line[impacts.DEEPEST]),
    }
    values: dict[str, Array] = {"impacts": hit.sum(axis=1)}
    for name, each in at_most.items():  # NaN without an impact, or where one has no such value
        most = np.array([np.maximum.reduce(each[own], initial=-np.inf) for own in hit])
        values[name] = np.where(np.isfinite(most), most, np.nan)
    values["contact_energy"] = hit @ line[impacts.LOST]
    received = np.zeros(standing.first.size - 1)
    left = np.array([place.building for place in standing.places], np.int64)[where]
    for side, energy in enumerate(energy_transferred(response).T):
        np.add.at(received, left + side, energy)
    values["energy_received"] = received
    return values


def _columns(standing: Standing, response: RowResponse) -> dict[str, Array]:
    """Largest force on columns that a slab meets [N], also over the storey shear at yield [-].

    Contacts slab to slab are NaN.
    """
    struck = np.array([bool(m.struck) for m in standing.places])
    if not struck.any():
        return {}
    most, storeys = np.zeros(struck.size), standing.arrangement.storeys
    where = response.impacts[:, impacts.CONTACT].astype(np.int64)
    np.maximum.at(most, where, response.impacts[:, impacts.LARGEST])
    floor = [
        standing.first[m.building + (m.struck != "left")] + m.storey if m.struck else 0
        for m in standing.places
    ]
    strength = (storeys.elastic * storeys.strength)[floor]
    force = np.where(struck, most, np.nan)
    share = np.where(np.isfinite(strength), force / strength, np.nan)
    return {"column_force": force, "column_force_share": share}
