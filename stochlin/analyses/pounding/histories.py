"""Response histories, impacts and energies of buildings in a row, as labelled arrays."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from stochlin.analyses.pounding.rows import COLUMN, Building, Meeting
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.pounding import impacts
from stochlin.kernels.pounding import run as kernel
from stochlin.kernels.pounding.contact import stored_energy
from stochlin.kernels.pounding.rows import SLACK, Row, creep_of
from stochlin.models.buildings import ShearBuilding
from stochlin.models.links import Link

SIDES = "left", "right"  # sides of a contact


def by_floor(values: Array, row: Row, structures: Sequence[Building], *over: str) -> xr.Variable:
    """Values of all floors (..., n) over ``structure`` and, for shear buildings, ``floor``.

    Cells above the roof of a building are NaN. The coordinates are those of `floor_coords`; a dataset
    takes them once, since to align those of every array takes longer than all else.
    """
    sizes = np.diff(row.first)
    wide = np.full((*values.shape[:-1], sizes.size, sizes.max()), np.nan)
    for b, size in enumerate(sizes):
        wide[..., b, :size] = values[..., row.first[b] : row.first[b + 1]]
    if not _with_floors(structures):
        return xr.Variable((*over, "structure"), wide[..., 0])
    return xr.Variable((*over, "structure", "floor"), wide)


def floor_coords(row: Row, structures: Sequence[Building]) -> dict[str, Any]:
    """Coordinates of the numbers of the structures and, for shear buildings, of the floors."""
    sizes = np.diff(row.first)
    coords = {"structure": ("structure", np.arange(1, sizes.size + 1), {"long_name": "structure"})}
    if _with_floors(structures):
        coords["floor"] = ("floor", np.arange(1, sizes.max() + 1), {"long_name": "floor"})
    return coords


def _with_floors(structures: Sequence[Building]) -> bool:
    return any(isinstance(structure, ShearBuilding) for structure in structures)


class Course(NamedTuple):
    """Response histories of a row at the output times, by name: of floors, structures, links and all."""

    floors: dict[str, Array]  # (times, n)
    structures: dict[str, Array]  # (times, s)
    links: dict[str, Array]  # (times, l)
    whole: dict[str, Array]  # (times,)


def course(row: Row, run: kernel.Run) -> Course:
    """Displacements, velocities, accelerations, forces and energies from the states of a run."""
    n, s = row.mass.size, row.first.size - 1
    c, ties = row.gap.size, len(row.tied)
    u, v, slip, entering, viscous, hysteretic, lost, drained, creep = np.split(
        run.states, np.cumsum([n, n, n, s, s, s, c, ties]), axis=1
    )
    drift = u - np.where(row.below >= 0, u[:, row.below], 0.0)
    shear = row.post * drift + row.couple * (drift - slip)
    stored = 0.5 * (row.post * drift**2 + row.couple * (drift - slip) ** 2)
    energies = {
        "input_energy": entering,
        "kinetic_energy": np.add.reduceat(0.5 * row.mass * v**2, row.first[:-1], axis=1),
        "elastic_energy": np.add.reduceat(stored, row.first[:-1], axis=1),
        "viscous_energy": viscous,
        "hysteretic_energy": hysteretic,
    }
    squeezed = np.zeros(len(u))
    if not row.jumps:
        one, two, low = row.weight.T
        apart = one * u[:, row.left] + two * u[:, row.right] + low * u[:, row.lower]
        squeezed = stored_energy(row.element, apart - row.gap).sum(axis=1)
    one, two = row.tied.T
    stretch, pace = (w[:, one] - np.where(two >= 0, w[:, two], 0.0) for w in (u, v))
    post, dashpot, couple, limit, exponent, _ = row.tie.T
    slowest = np.array([creep_of(row, j) for j in range(len(row.tied))])
    eased = np.maximum(np.abs(pace), slowest) ** (exponent - 1.0) * pace
    held = np.where(row.tie_law == SLACK, np.minimum(stretch + limit, 0.0), stretch - creep)
    strained = 0.5 * (post * stretch**2 + couple * held**2).sum(axis=1)
    kept = [energy for name, energy in energies.items() if name != "input_energy"]
    missing = entering.sum(1) - sum(energy.sum(1) for energy in kept) - squeezed - lost.sum(1)
    missing -= strained + drained.sum(1)
    most = np.maximum.accumulate(np.abs(entering.sum(axis=1)))
    error = np.divide(np.abs(missing), most, out=np.zeros_like(most), where=most > 0)
    floors = {
        "displacement": u,
        "velocity": v,
        "acceleration": run.accelerations,
        "storey_shear": shear,
    }
    whole = {
        "contact_stored_energy": squeezed,
        "contact_lost_energy": lost.sum(axis=1),
        "energy_balance_error": error,
    }
    if not ties:
        return Course(floors, {"base_shear": shear[:, row.first[:-1]], **energies}, {}, whole)
    whole |= {"link_stored_energy": strained, "link_lost_energy": drained.sum(axis=1)}
    pulls = {"link_force": post * stretch + couple * held + dashpot * eased}
    return Course(floors, {"base_shear": shear[:, row.first[:-1]], **energies}, pulls, whole)


def histories(
    found: Course,
    row: Row,
    structures: Sequence[Building],
    run: kernel.Run,
    start: float,
    time: Array,
) -> xr.Dataset:
    """Dataset of the histories of a run at the times ``time`` [s], and of its impacts."""
    line = run.impacts.T
    return xr.Dataset(
        {
            **{name: by_floor(values, row, structures, "time") for name, values in found.floors.items()},
            **{name: (("time", "structure"), values) for name, values in found.structures.items()},
            **{name: (("time", "link"), values) for name, values in found.links.items()},
            **{name: ("time", values) for name, values in found.whole.items()},
            "contact_force": (("time", "contact"), run.forces),
            "impact_time": ("impact", start + line[impacts.BEGIN]),
            "impact_contact": ("impact", line[impacts.CONTACT].astype(np.int64) + 1),
            "approach_velocity": ("impact", line[impacts.APPROACH]),
            "largest_force": ("impact", largest_force(run)),
            "impact_duration": ("impact", line[impacts.END] - line[impacts.BEGIN]),
            "energy_lost": ("impact", energy_lost(run)),
            "energy_transferred": (("impact", "side"), energy_transferred(run)),
        },
        coords={
            "time": ("time", time, {"units": "s", "long_name": "time"}),
            **floor_coords(row, structures),
            "side": ("side", list(SIDES), {"long_name": "side of the contact"}),
        },
    )


def largest_force(run: kernel.Run) -> Array:
    """Largest force of each impact [N]; NaN for stereomechanical impacts."""
    force = run.impacts[:, impacts.LARGEST]
    return np.where(np.isfinite(force), force, np.nan)


def energy_lost(run: kernel.Run) -> Array:
    """Energy lost in each impact [J]."""
    lost: Array = run.impacts[:, impacts.AFTER] - run.impacts[:, impacts.BEFORE]
    return lost


def energy_transferred(run: kernel.Run) -> Array:
    """Work of each impact on the structures on its left and right [J], (impacts, 2)."""
    right = run.impacts[:, impacts.HANDED]
    return np.stack([-right - energy_lost(run) - run.impacts[:, impacts.STORED], right], axis=-1)


def contacts(places: Sequence[Meeting], links: Sequence[Link | None]) -> xr.Dataset:
    """Coordinates of contacts and links: structures, floors, level [m] and kind of each contact."""
    coords = {
        "contact": ("contact", np.arange(1, len(places) + 1), {"long_name": "contact"}),
        "left": ("contact", [m.building + 1 for m in places], {"long_name": "structure on the left"}),
        "right": ("contact", [m.building + 2 for m in places], {"long_name": "structure on the right"}),
    }
    if np.isfinite([m.level for m in places]).any():
        kinds = [m.kind for m in places]
        coords["kind"] = ("contact", kinds, {"long_name": "what meets"})
        name = {"units": "m", "long_name": "level of the contact above the ground"}
        coords["level"] = ("contact", [m.level for m in places], name)
        for side in SIDES:
            floors = [getattr(m, f"floor_{side}") + 1 for m in places]
            coords[f"floor_{side}"] = ("contact", floors, {"long_name": f"floor on the {side}"})
        if COLUMN in kinds:
            sides = [m.struck for m in places]
            coords["column"] = ("contact", sides, {"long_name": "side whose column is met"})
            storeys = [m.storey + 1 if m.struck else 0 for m in places]
            name = {"long_name": "storey of the column, whose floor above stands as that of its side"}
            coords["storey"] = ("contact", storeys, name)
            name = {"units": "1", "long_name": "share of the floor above in the column's displacement"}
            coords["share"] = ("contact", [m.share for m in places], name)
    tied = [number for number, link in enumerate(links, start=1) if link is not None]
    if tied:
        coords["link"] = ("link", tied, {"long_name": "link, by its place in the list"})
    return xr.Dataset(coords=coords)
