"""Results for buildings in a row, as labelled arrays: histories, impacts, summary of a motion."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
import xarray as xr

from stochlin.applications.pounding.rows import CONTACT_SIDES, ContactPlace, PreparedRow
from stochlin.kernels.basics.arrays import Array, matrix_products
from stochlin.kernels.pounding.run import RowResponse
from stochlin.kernels.records.runs import SampledMotion
from stochlin.models.buildings.base import FLOOR
from stochlin.models.links import Link
from stochlin.solver.simulation.structures_in_motion import STRUCTURE
from stochlin.solver.tables.labels import LINK, link_coordinates

CONTACT = "contact"
OF_ROW = ""  # in place of a dimension, for a number of the row of buildings
# units of the coordinates of contacts
COORDINATE_UNITS = {"level": {"units": "m"}, "share": {"units": "1"}}
Quantities = dict[str, tuple[str, Any]]
"""Values by name, each with its last dimension; FLOOR also stands for the structure."""


def labelled(values: Quantities, prepared: PreparedRow, *over: str) -> dict[str, xr.Variable]:
    """Values as arrays over named dimensions, the first of which are ``over``.

    The coordinates are those of `floor_coords`; a dataset takes them once, since to align those of
    every array takes longer than all else.
    """
    return {
        name: _by_floor(array, prepared, *over)
        if dimension == FLOOR
        else xr.Variable([*over, *filter(None, [dimension])], array)
        for name, (dimension, array) in values.items()
    }


def _by_floor(values: Array, prepared: PreparedRow, *over: str) -> xr.Variable:
    """Values of all floors (..., n) over ``structure`` and, for shear buildings, ``floor``.

    Cells above the roof of a building are NaN.
    """
    first = prepared.first
    sizes = np.diff(first)
    wide = np.full((*values.shape[:-1], sizes.size, sizes.max()), np.nan)
    for b, size in enumerate(sizes):
        wide[..., b, :size] = values[..., first[b] : first[b + 1]]
    if not prepared.assembly.has_storeys:
        return xr.Variable((*over, STRUCTURE), wide[..., 0])
    return xr.Variable((*over, STRUCTURE, FLOOR), wide)


def floor_coords(prepared: PreparedRow) -> dict[str, Any]:
    """Coordinates of the numbers of the structures and, for shear buildings, of the floors."""
    sizes = np.diff(prepared.first)
    coords = {STRUCTURE: (STRUCTURE, np.arange(1, sizes.size + 1), {"long_name": "structure"})}
    if prepared.assembly.has_storeys:
        coords[FLOOR] = (FLOOR, np.arange(1, sizes.max() + 1), {"long_name": "floor"})
    return coords


def _course(prepared: PreparedRow, response: RowResponse, ground: SampledMotion) -> Quantities:
    """Displacements, velocities, accelerations, forces and energies in a response history."""
    row = prepared.row
    assembly = prepared.assembly
    system = row.elements.system
    n = row.parts.mass.size
    history = response.history
    motion = history.motions
    q = history.coordinates.q.T
    v = history.coordinates.v.T
    z = history.elements.z.T
    extension = matrix_products(q, system.extensions)
    rate = matrix_products(v, system.extensions)
    force = system.post * extension + system.couple * z
    stored = 0.5 * (system.post * extension**2 + system.couple * z**2)
    drag = _drags(prepared, rate)
    contact_force, contact_energy = _contact_forces(prepared, response, q)
    load = matrix_products(v, system.damping) + matrix_products(force + drag, system.extensions.T)
    shear = matrix_products(force[:, :n], assembly.shear_shares)
    largest_input = motion.largest_input
    imbalance = np.zeros_like(largest_input)
    np.divide(np.abs(motion.missing_energy), largest_input, out=imbalance, where=largest_input > 0)
    by_structure = partial(np.add.reduceat, indices=assembly.first_coordinate[:-1], axis=1)
    # A floor moves with the ground as far as the modes of a building leave out mass.
    carried = np.multiply.outer(ground.acceleration, 1 - system.shapes.sum(axis=1))
    acceleration = -(load + matrix_products(contact_force, row.contacts.weights.T)) / system.mass
    values: Quantities = {
        "displacement": (FLOOR, matrix_products(q, system.shapes)),
        "velocity": (FLOOR, matrix_products(v, system.shapes)),
        "acceleration": (FLOOR, matrix_products(acceleration, system.shapes) + carried),
        "storey_shear": (FLOOR, shear),
        "base_shear": (STRUCTURE, shear[:, prepared.first[:-1]]),
        "input_energy": (STRUCTURE, by_structure(history.coordinates.input_energy.T[:, :n])),
        "kinetic_energy": (STRUCTURE, by_structure(0.5 * row.parts.mass * v[:, :n] ** 2)),
        "elastic_energy": (STRUCTURE, by_structure(stored[:, :n])),
        "viscous_energy": (
            STRUCTURE,
            by_structure(history.coordinates.viscous_energy.T[:, :n]),
        ),
        "hysteretic_energy": (STRUCTURE, by_structure(history.elements.dissipated[:n].T)),
        "contact_force": (CONTACT, contact_force),
        "contact_stored_energy": (OF_ROW, contact_energy),
        "contact_lost_energy": (OF_ROW, history.contacts.dissipated.sum(axis=0)),
        "energy_balance_error": (OF_ROW, imbalance),
    }
    if row.contacts.of_wall.any():
        values["wall_displacement"] = OF_ROW, q[:, n]
        values["wall_energy"] = OF_ROW, history.coordinates.input_energy[n]
    if row.parts.spring.size:
        linear = force[:, row.parts.spring] + row.parts.constant * rate[:, row.parts.spring]
        power = np.where(row.parts.dashpot >= 0, drag[:, row.parts.dashpot], 0.0)
        values["link_force"] = LINK, linear + power
        values["link_stored_energy"] = OF_ROW, stored[:, n:].sum(axis=1)
        values["link_lost_energy"] = OF_ROW, history.links.dissipated.sum(axis=0)
    return values


def _drags(prepared: PreparedRow, rate: Array) -> Array:
    """Forces of dashpots with an exponent among the elements [N] (times, e), zero of the others."""
    elements = prepared.row.elements
    dashpots = prepared.row.parts.dashpot
    drag = np.zeros_like(rate)
    for i in dashpots[dashpots >= 0]:
        c, a = elements.parameters[i, :2]
        drag[:, i] = c * np.abs(rate[:, i]) ** a * np.sign(rate[:, i])
    return drag


def _contact_forces(prepared: PreparedRow, response: RowResponse, q: Array) -> tuple[Array, Array]:
    """Forces of the contacts [N] (times, c), and the energy stored in all of them [J] (times,)."""
    contacts = prepared.row.contacts
    if contacts.jumps:
        states = response.history.contacts
        return (states.mean_force * states.sticks).T, np.zeros(len(q))
    impacts = response.history.impacts
    force = np.where(np.isnan(impacts.begin), 0.0, impacts.force).T
    penetration = np.maximum(matrix_products(q, contacts.weights) - contacts.gap, 0.0)
    power = contacts.law["exponent"] + 1.0
    return force, (contacts.law["stiffness"] * penetration**power / power).sum(axis=1)


def histories(
    prepared: PreparedRow, response: RowResponse, ground: SampledMotion, times: xr.DataArray
) -> xr.Dataset:
    """Dataset of the histories of a response, at these times [s], and of its impacts."""
    time = times.to_numpy().astype(float)
    impacts = response.impacts
    course = _course(prepared, response, ground)
    return xr.Dataset(
        {
            **labelled(course, prepared, "time"),
            "impact_time": ("impact", time[0] + impacts["begin"]),
            "impact_contact": ("impact", impacts["contact"] + 1),
            "approach_velocity": ("impact", impacts["approach_velocity"]),
            "largest_force": ("impact", impacts["largest_force"]),
            "impact_duration": ("impact", impacts["end"] - impacts["begin"]),
            "energy_lost": ("impact", impacts["dissipated"]),
            "energy_transferred": (("impact", "side"), energy_transferred(response)),
        },
        coords={
            "time": ("time", time, {"units": "s", "long_name": "time"}),
            **floor_coords(prepared),
            "side": ("side", list(CONTACT_SIDES), {"long_name": "side of the contact"}),
        },
    )


def energy_transferred(response: RowResponse) -> Array:
    """Work of each impact on the structures on its left and right [J], (impacts, 2)."""
    impacts = response.impacts
    right = impacts["work_on_right"]
    left = -right - impacts["dissipated"] - impacts["stored"]
    return np.stack([left, right], axis=-1)


def contacts(places: Sequence[ContactPlace], links: Sequence[Link | None]) -> xr.Dataset:
    """Coordinates of contacts and links: structures, floors, level [m] and kind of each contact."""
    columns: dict[str, tuple[Sequence[Any], str]] = {
        "contact": (range(1, len(places) + 1), "contact"),
        "left": ([m.building + 1 for m in places], "structure on the left"),
        "right": (
            [0 if m.wall == "right" else m.building + 2 for m in places],
            "structure on the right",
        ),
    }
    if np.isfinite([m.level for m in places]).any():
        columns |= {
            "kind": ([m.kind for m in places], "what meets"),
            "level": ([m.level for m in places], "level of the contact above the ground"),
            "floor_left": ([m.floor_left + 1 for m in places], "floor on the left"),
            "floor_right": ([m.floor_right + 1 for m in places], "floor on the right"),
        }
    if any(m.wall for m in places):
        columns["wall"] = [m.fixed for m in places], "what the wall is fixed to"
    if any(m.struck for m in places):
        columns |= {
            "column": ([m.struck for m in places], "side whose column is met"),
            "storey": ([m.storey + 1 if m.struck else 0 for m in places], "storey of the column"),
            "share": ([m.share for m in places], "share of the floor above in its displacement"),
        }
    coords: dict[str, Any] = {
        name: ("contact", list(values), {"long_name": text} | COORDINATE_UNITS.get(name, {}))
        for name, (values, text) in columns.items()
    }
    tied = [number for number, link in enumerate(links, start=1) if link is not None]
    return xr.Dataset(coords=coords | (link_coordinates(tied) if tied else {}))


def summary(
    prepared: PreparedRow,
    response: RowResponse,
    alone: RowResponse,
    coarser: RowResponse | None = None,
) -> Quantities:
    """Summary of one motion, from the responses of the row and of each building alone.

    The error of the time steps needs the response of the row in ``coarser`` ones.
    """
    values = _peaks(prepared, response, alone) | _tallies(prepared, response)
    values |= _columns(prepared, values["hardest_force"][1])
    if coarser is not None:
        values["step_error"] = OF_ROW, _step_error(prepared, coarser, response)
    return values


def _step_error(prepared: PreparedRow, response: RowResponse, finer: RowResponse) -> float:
    """Largest relative change of a peak or largest force from steps twice as long [-].

    The steps are of second order, so that the error that remains in the finer response is about a
    third of the change. A displacement counts beside the largest of its structure, all else beside
    itself.
    """
    largest_of_structure = np.maximum.reduceat(finer.peaks, prepared.first[:-1])
    largest = np.repeat(largest_of_structure, np.diff(prepared.first))
    displacement_change = np.abs(response.peaks - finer.peaks) / np.where(largest > 0, largest, 1.0)
    pairs = zip(compared_peaks(prepared, response), compared_peaks(prepared, finer), strict=True)
    changes = [_largest_change(coarse, fine) for coarse, fine in pairs]
    return float(max(displacement_change.max(), *changes))


def compared_peaks(prepared: PreparedRow, response: RowResponse) -> list[Array]:
    """Peaks of drifts, storey shears and accelerations, and largest forces of contacts."""
    floors = response.floors
    peaks = response.end.peaks
    by_modes = [np.full(stick.coordinates, stick.by_modes) for stick in prepared.assembly.sticks]
    extensions = response.end.largest[floors : floors + prepared.row.parts.mass.size]
    return [
        np.where(np.concatenate(by_modes), 0.0, extensions),
        peaks.shear[:floors],
        peaks.acceleration[:floors],
        _tallies(prepared, response)["hardest_force"][1],
    ]


def _largest_change(coarse: Array, fine: Array) -> float:
    """Largest relative change of values that are known and positive in both."""
    both = (coarse > 0) & (fine > 0)
    return float((np.abs(coarse[both] - fine[both]) / fine[both]).max(initial=0.0))


def _peaks(prepared: PreparedRow, response: RowResponse, alone: RowResponse) -> Quantities:
    """Largest absolute values in the row and of each building alone."""
    values: Quantities = {}
    first = prepared.first
    floors = response.floors
    has_shear = np.isfinite(prepared.assembly.shear_shares).all(axis=1)
    for ending, motion in (("", response), ("_alone", alone)):
        peaks = motion.end.peaks
        shear = np.where(has_shear, peaks.shear[:floors], np.nan)
        values |= {
            f"peak{ending}": (FLOOR, motion.peaks),
            f"peak_acceleration{ending}": (FLOOR, peaks.acceleration[:floors]),
            f"peak_storey_shear{ending}": (FLOOR, shear),
            f"peak_base_shear{ending}": (STRUCTURE, shear[first[:-1]]),
        }
    moves = np.where(alone.peaks > 0, alone.peaks, np.nan)
    values["amplification"] = FLOOR, response.peaks / moves
    springs = prepared.row.parts.spring
    if springs.size:
        values["peak_link_force"] = LINK, response.end.links.largest_force
        values["peak_link_stroke"] = LINK, response.end.largest[floors + springs]
        values["link_energy"] = LINK, response.end.links.dissipated
    values["energy_balance_error"] = OF_ROW, response.end.motions.imbalance
    return values


def _tallies(prepared: PreparedRow, response: RowResponse) -> Quantities:
    """Number, extremes and lost energy of the impacts of each contact, and energy received."""
    impacts = response.impacts
    contacts = prepared.row.contacts
    where = impacts["contact"]
    hit = where == np.arange(contacts.gap.size)[:, None]
    extremes = {
        "hardest_force": impacts["largest_force"],
        "fastest_approach": impacts["approach_velocity"],
        "longest_impact": impacts["end"] - impacts["begin"],
        "deepest_compression": impacts["largest_penetration"],
    }
    undefined = ("hardest_force", "deepest_compression") if contacts.jumps else ()
    values: Quantities = {"impacts": (CONTACT, hit.sum(axis=1))}
    for name, values_of_impacts in extremes.items():
        without_impact = np.nan if name in undefined else 0.0
        largest = [values_of_impacts[at].max(initial=without_impact) for at in hit]
        values[name] = CONTACT, np.array(largest)
    values["contact_energy"] = CONTACT, hit @ impacts["dissipated"]
    received = np.zeros(prepared.first.size + 1)  # also of a wall on the left and on the right
    left = np.array([m.building + 1 for m in prepared.places], np.int64)
    for side, energy in enumerate(energy_transferred(response).T):
        np.add.at(received, left[where] + side, energy)
    values["energy_received"] = STRUCTURE, received[1:-1]
    return values


def _columns(prepared: PreparedRow, hardest: Array) -> Quantities:
    """Largest force on columns that a slab meets [N], also over the storey shear at yield [-].

    Contacts slab to slab are NaN.
    """
    struck = np.array([bool(m.struck) for m in prepared.places])
    if not struck.any():
        return {}
    storeys = prepared.assembly.storeys
    floor = [
        prepared.first[m.building + (m.struck != "left")] + m.storey if m.struck else 0
        for m in prepared.places
    ]
    strength = prepared.assembly.of_elements(storeys.elastic * storeys.strength, np.inf, np.inf)
    force = np.where(struck, hardest, np.nan)
    strength = strength[floor]
    share = np.where(np.isfinite(strength), force / strength, np.nan)
    return {"column_force": (CONTACT, force), "column_force_share": (CONTACT, share)}
