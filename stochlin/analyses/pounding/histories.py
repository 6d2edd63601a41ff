"""Histories, impacts and energies of a run of buildings in a row, as labelled data."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr

from stochlin.analyses.pounding.rows import Building, Meeting
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.pounding import impacts
from stochlin.kernels.pounding import run as kernel
from stochlin.kernels.pounding.contact import stored_energy
from stochlin.kernels.pounding.rows import Row
from stochlin.models.buildings import ShearBuilding
from stochlin.models.links import Link


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
    if isinstance(structures[0], ShearBuilding):
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
    u, v, slip, entering, viscous, hysteretic, lost, drained = np.split(
        run.states, np.cumsum([n, n, n, s, s, s, row.gap.size]), axis=1
    )
    drift = u - np.where(row.below >= 0, u[:, row.below], 0.0)
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
        squeezed = stored_energy(row.element, u[:, row.left] - u[:, row.right] - row.gap).sum(axis=1)
    stretch, pace = (w[:, row.tied[:, 0]] - w[:, row.tied[:, 1]] for w in (u, v))
    strained = 0.5 * (row.tie[:, 0] * stretch**2).sum(axis=1)
    kept = [energy for name, energy in energies.items() if name != "input_energy"]
    missing = entering.sum(1) - sum(energy.sum(1) for energy in kept) - squeezed - lost.sum(1)
    missing -= strained + drained.sum(1)
    most = np.maximum.accumulate(np.abs(entering.sum(axis=1)))
    line = run.impacts.T
    force = line[impacts.LARGEST]
    table = xr.Dataset(
        {
            "displacement": by_floor(u, row, structures, time),
            "velocity": by_floor(v, row, structures, time),
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
            "energy_lost": ("impact", line[impacts.AFTER] - line[impacts.BEFORE]),
        }
    )
    if not len(row.tied):
        return table
    return table.assign(
        link_force=(("time", "link"), row.tie[:, 0] * stretch + row.tie[:, 1] * pace),
        link_stored_energy=("time", strained),
        link_lost_energy=("time", drained.sum(axis=1)),
    )


def contacts(places: Sequence[Meeting], links: Sequence[Link | None]) -> xr.Dataset:
    """Coordinates of contacts and links: which structures, which floors, at which level."""
    coords = {
        "contact": ("contact", np.arange(1, len(places) + 1), {"long_name": "contact"}),
        "left": ("contact", [m.building + 1 for m in places], {"long_name": "structure on the left"}),
        "right": ("contact", [m.building + 2 for m in places], {"long_name": "structure on the right"}),
    }
    if np.isfinite(places[0].level):
        name = {"units": "m", "long_name": "level of the contact above the ground"}
        coords["level"] = ("contact", [m.level for m in places], name)
        for side in ("left", "right"):
            floors = [getattr(m, f"floor_{side}") + 1 for m in places]
            coords[f"floor_{side}"] = ("contact", floors, {"long_name": f"floor on the {side}"})
    tied = [b + 1 for b, link in enumerate(links) if link is not None]
    if tied:
        coords["link"] = ("link", tied, {"long_name": "link, by the structure on its left"})
    return xr.Dataset(coords=coords)
