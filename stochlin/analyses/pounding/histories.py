"""Histories, impacts and energies of a run of buildings in a row, as labelled data."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr

from stochlin.analyses.pounding.rows import COLUMN, Building, Meeting
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.pounding import impacts
from stochlin.kernels.pounding import run as kernel
from stochlin.kernels.pounding.contact import stored_energy
from stochlin.kernels.pounding.rows import SLACK, Row
from stochlin.models.buildings import ShearBuilding
from stochlin.models.links import Link

SIDES = "left", "right"  # of a contact


def by_floor(
    values: Array, row: Row, structures: Sequence[Building], time: Array | None = None
) -> xr.DataArray:
    """Values (..., n) over ``structure`` and, for shear buildings, ``floor``: NaN above the roof."""
    sizes = np.diff(row.first)
    over = np.full((*values.shape[:-1], sizes.size, sizes.max()), np.nan)
    for b, size in enumerate(sizes):
        over[..., b, :size] = values[..., row.first[b] : row.first[b + 1]]
    coords = {"structure": ("structure", np.arange(1, sizes.size + 1), {"long_name": "structure"})}
    dims: tuple[str, ...] = ("structure", "floor")
    if any(isinstance(structure, ShearBuilding) for structure in structures):
        coords["floor"] = ("floor", np.arange(1, sizes.max() + 1), {"long_name": "floor"})
    else:
        over, dims = over[..., 0], ("structure",)
    if time is not None:
        dims = ("time", *dims)
        coords["time"] = ("time", time, {"units": "s", "long_name": "time"})
    return xr.DataArray(over, dims=dims, coords=coords)


def histories(
    row: Row, structures: Sequence[Building], run: kernel.Run, start: float, time: Array
) -> xr.Dataset:
    """Histories of a run at the times ``time``, its impacts, and the balance of its energies."""
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
    squeezed = np.zeros(time.size)
    if not row.jumps:
        one, two, low = row.weight.T
        apart = one * u[:, row.left] + two * u[:, row.right] + low * u[:, row.lower]
        squeezed = stored_energy(row.element, apart - row.gap).sum(axis=1)
    stretch, pace = (w[:, row.tied[:, 0]] - w[:, row.tied[:, 1]] for w in (u, v))
    post, dashpot, couple, limit = row.tie.T
    held = np.where(row.tie_law == SLACK, np.minimum(stretch + limit, 0.0), stretch - creep)
    strained = 0.5 * (post * stretch**2 + couple * held**2).sum(axis=1)
    kept = [energy for name, energy in energies.items() if name != "input_energy"]
    missing = entering.sum(1) - sum(energy.sum(1) for energy in kept) - squeezed - lost.sum(1)
    missing -= strained + drained.sum(1)
    most = np.maximum.accumulate(np.abs(entering.sum(axis=1)))
    line = run.impacts.T
    force, gone = line[impacts.LARGEST], line[impacts.AFTER] - line[impacts.BEFORE]
    right = line[impacts.HANDED]
    floors = {
        "displacement": u,
        "velocity": v,
        "acceleration": run.accelerations,
        "storey_shear": shear,
    }
    table = xr.Dataset(
        {
            **{name: by_floor(values, row, structures, time) for name, values in floors.items()},
            "base_shear": (("time", "structure"), shear[:, row.first[:-1]]),
            "contact_force": (("time", "contact"), run.forces),
            **{name: (("time", "structure"), energy) for name, energy in energies.items()},
            "contact_stored_energy": ("time", squeezed),
            "contact_lost_energy": ("time", lost.sum(axis=1)),
            "energy_balance_error": (
                "time",
                np.divide(np.abs(missing), most, out=np.zeros_like(most), where=most > 0),
            ),
            "impact_time": ("impact", start + line[impacts.BEGIN]),
            "impact_contact": ("impact", line[impacts.CONTACT].astype(np.int64) + 1),
            "approach_velocity": ("impact", line[impacts.APPROACH]),
            "largest_force": ("impact", np.where(np.isfinite(force), force, np.nan)),
            "impact_duration": ("impact", line[impacts.END] - line[impacts.BEGIN]),
            "energy_lost": ("impact", gone),
            "energy_transferred": (
                ("impact", "side"),
                np.stack([-right - gone - line[impacts.STORED], right], axis=-1),
            ),
        },
        coords={"side": ("side", list(SIDES), {"long_name": "side of the contact"})},
    )
    if not len(row.tied):
        return table
    return table.assign(
        link_force=(("time", "link"), post * stretch + couple * held + dashpot * pace),
        link_stored_energy=("time", strained),
        link_lost_energy=("time", drained.sum(axis=1)),
    )


def peaks(
    table: xr.Dataset, row: Row, structures: Sequence[Building], run: kernel.Run, alone: kernel.Run
) -> dict[str, xr.DataArray]:
    """Largest absolute values in the row, and standing alone; those between outputs too."""
    found: dict[str, xr.DataArray] = {}
    for ending, one in (("", run), ("_alone", alone)):
        values = {
            "peak": np.abs(one.peaks).max(axis=0),
            "peak_acceleration": one.most.acceleration,
            "peak_storey_shear": one.most.shear,
        }
        found |= {f"{name}{ending}": by_floor(each, row, structures) for name, each in values.items()}
        base = one.most.shear[row.first[:-1]]
        found[f"peak_base_shear{ending}"] = xr.DataArray(base, dims="structure")
    for name in ("acceleration", "storey_shear", "base_shear"):  # outputs may lie between steps
        found[f"peak_{name}"] = xr.ufuncs.maximum(found[f"peak_{name}"], abs(table[name]).max("time"))
    if len(row.tied):
        most = np.maximum(run.most.pull, np.abs(table.link_force.values).max(axis=0))
        found["peak_link_force"] = xr.DataArray(most, dims="link")
    return found


def columns(table: xr.Dataset, row: Row, places: Sequence[Meeting]) -> dict[str, xr.DataArray]:
    """What columns bear that a floor of the neighbour meets; NaN where slabs meet."""
    struck = np.array([bool(m.struck) for m in places])
    if not struck.any():
        return {}
    most = np.zeros(struck.size)
    np.maximum.at(most, table.impact_contact.values - 1, table.largest_force.values)
    floor = np.where([m.struck == "left" for m in places], row.left, row.right)
    strength = (row.post[floor] + row.couple[floor]) * row.strength[floor]
    force = np.where(struck, most, np.nan)
    share = np.where(np.isfinite(strength), force / strength, np.nan)
    return {
        "column_force": xr.DataArray(force, dims="contact"),
        "column_force_share": xr.DataArray(share, dims="contact"),
    }


def contacts(places: Sequence[Meeting], links: Sequence[Link | None]) -> xr.Dataset:
    """Coordinates of contacts and links: which structures, which floors, at which level."""
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
