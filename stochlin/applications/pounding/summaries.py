"""Summary of one motion for a row of buildings: peaks, and sums and extremes over the impacts."""

from __future__ import annotations

import numpy as np

from stochlin.applications.pounding.histories import (
    CONTACT,
    OF_ROW,
    STRUCTURE,
    Quantities,
    energy_transferred,
)
from stochlin.applications.pounding.rows import Standing
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.pounding import impacts
from stochlin.kernels.pounding.run import RowResponse
from stochlin.kernels.simulation.moving import (
    ACCELERATION,
    APPROACH,
    BEGIN,
    DEEPEST,
    DRAINED,
    END,
    IMBALANCE,
    LARGEST,
    LOST,
    PULL,
    SHEAR,
)
from stochlin.solver.tables.floors import FLOOR, LINK


def summary(
    standing: Standing, response: RowResponse, alone: RowResponse, coarser: RowResponse | None = None
) -> Quantities:
    """Summary of one motion, from the responses of the row and of each building alone.

    The error of the time steps needs the response of the row in ``coarser`` ones.
    """
    values = _peaks(standing, response, alone) | _tallies(standing, response)
    values |= _columns(standing, values["hardest_force"][1])
    if coarser is not None:
        values["step_error"] = OF_ROW, _step_error(standing, coarser, response)
    return values


def _step_error(standing: Standing, response: RowResponse, finer: RowResponse) -> float:
    """Largest relative change of a peak displacement or largest force from steps twice as long [-].

    The steps are of second order, so that the error that remains in the finer response is about a third
    of the change. A peak counts beside the largest of its structure.
    """
    whole = np.maximum.reduceat(finer.peaks, standing.first[:-1])
    largest = np.repeat(whole, np.diff(standing.first))
    moved = np.abs(response.peaks - finer.peaks) / np.where(largest > 0, largest, 1.0)
    hardest, more = (_tallies(standing, each)["hardest_force"][1] for each in (response, finer))
    hits = (hardest > 0) & (more > 0)
    changes = np.abs(hardest[hits] - more[hits]) / more[hits]
    return float(max(moved.max(), changes.max(initial=0.0)))


def _peaks(standing: Standing, response: RowResponse, alone: RowResponse) -> Quantities:
    """Largest absolute values in the row and of each building alone."""
    values: Quantities = {}
    first = standing.first
    for ending, own in (("", response), ("_alone", alone)):
        known = np.isfinite(standing.arrangement.shear_shares).all(axis=1)
        shear = np.where(known, own.moving.watched[: own.floors, SHEAR], np.nan)
        values |= {
            f"peak{ending}": (FLOOR, own.peaks),
            f"peak_acceleration{ending}": (FLOOR, own.moving.watched[: own.floors, ACCELERATION]),
            f"peak_storey_shear{ending}": (FLOOR, shear),
            f"peak_base_shear{ending}": (STRUCTURE, shear[first[:-1]]),
        }
    apart, unknown = alone.peaks, np.full(first[-1], np.nan)
    growth = np.divide(response.peaks, apart, out=unknown, where=apart > 0)
    values["amplification"] = FLOOR, growth
    springs = standing.row.parts.spring
    if springs.size:
        values["peak_link_force"] = LINK, response.moving.links[:, PULL]
        values["peak_link_stroke"] = LINK, response.moving.largest[len(response.peaks) + springs]
        values["link_energy"] = LINK, response.moving.links[:, DRAINED]
    return values | {"energy_balance_error": (OF_ROW, response.moving.motions[IMBALANCE])}


def _tallies(standing: Standing, response: RowResponse) -> Quantities:
    """Number, extremes and lost energy of the impacts of each contact, and energy received."""
    line, contacts = response.impacts.T, standing.row.contacts
    where = line[impacts.CONTACT].astype(np.int64)
    hit = where == np.arange(contacts.gap.size)[:, None]
    at_most = {
        "hardest_force": line[LARGEST],
        "fastest_approach": line[APPROACH],
        "longest_impact": line[END] - line[BEGIN],
        "deepest_compression": line[DEEPEST],
    }
    unknown = ("hardest_force", "deepest_compression") if contacts.jumps else ()
    values: Quantities = {"impacts": (CONTACT, hit.sum(axis=1))}
    for name, each in at_most.items():
        none = np.nan if name in unknown else 0.0
        values[name] = CONTACT, np.array([each[own].max(initial=none) for own in hit])
    values["contact_energy"] = CONTACT, hit @ line[LOST]
    received = np.zeros(standing.first.size - 1)
    for side, energy in enumerate(energy_transferred(response).T):
        np.add.at(received, standing.left[where] + side, energy)
    values["energy_received"] = STRUCTURE, received
    return values


def _columns(standing: Standing, hardest: Array) -> Quantities:
    """Largest force on columns that a slab meets [N], also over the storey shear at yield [-].

    Contacts slab to slab are NaN.
    """
    struck = np.array([bool(m.struck) for m in standing.places])
    if not struck.any():
        return {}
    storeys = standing.arrangement.storeys
    floor = [
        standing.first[m.building + (m.struck != "left")] + m.storey if m.struck else 0
        for m in standing.places
    ]
    strength = standing.arrangement.of_elements(storeys.elastic * storeys.strength, np.inf, np.inf)
    force, strength = np.where(struck, hardest, np.nan), strength[floor]
    share = np.where(np.isfinite(strength), force / strength, np.nan)
    return {"column_force": (CONTACT, force), "column_force_share": (CONTACT, share)}
