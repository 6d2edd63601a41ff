"""Correlation of the floors of two structures, of which one or both are buildings with storeys."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from stochlin.messages import brief
from stochlin.models.grounds import Ground
from stochlin.models.structures import GAUSSIAN
from stochlin.models.systems import AnyStructure
from stochlin.solver.linearization.systems.systems import linearize_system
from stochlin.solver.simulation.simulation import simulate
from stochlin.solver.tables.floors import FLOOR

if TYPE_CHECKING:
    from stochlin.solver.correlation.correlation import Query

LINEARIZATION, SIMULATION = "linearization", "simulation"
OF_FLOORS = ("displacement_std", "displacement_std_standard_error", "drift", "drift_memory")


def floor_pairs(pair: tuple[AnyStructure, AnyStructure], ground: Ground, query: Query) -> xr.Dataset:
    """Dataset of `correlate` over all pairs of floors, with ``details`` for its history."""
    if query.method == LINEARIZATION:
        if query.closure != GAUSSIAN:
            raise ValueError(
                f"closure = {brief(query.closure)} is only available for oscillators; allowed for "
                f"buildings with storeys: {GAUSSIAN}"
            )
        rtol, most = query.tolerance.rtol, query.tolerance.max_iterations
        table = linearize_system(pair, ground, rtol=rtol, max_iterations=most)
        details = f"closure={query.closure!r}"
    elif query.method == SIMULATION:
        table, details = simulate(pair, ground, **query.settings._asdict()), query.settings.history
    else:
        raise ValueError(
            f"method = {query.method!r} is only available for oscillators; allowed for buildings with "
            "storeys: linearization, simulation; or give the building's oscillator()"
        )
    return _between(table).assign_attrs(details=details)


def _between(table: xr.Dataset) -> xr.Dataset:
    """Part of a table of a system: floors of structure 1 over ``floor``, of 2 over ``floor_2``."""
    owner = table.floor_structure.values
    sides = [np.flatnonzero(owner == n) for n in (1, 2)]
    dims = (FLOOR, f"{FLOOR}_2")
    pairs = xr.Dataset(
        {
            name: (dims, table[name].values[np.ix_(*sides)])
            for name in ("rho", "rho_standard_error", "relative_displacement_std")
            if name in table
        },
        attrs={name: value for name, value in table.attrs.items() if not name.startswith("structure_")},
    )
    for number, (dim, own) in enumerate(zip(dims, sides, strict=True), start=1):
        for name in OF_FLOORS:
            if name in table:
                pairs[f"{name}_{number}"] = (dim, table[name].values[own])
        pairs[f"ductility_std_{number}"] = (dim, table.ductility_std.values[own])
        attrs = {"units": "m", "long_name": f"level of the floor, structure {number}"}
        pairs = pairs.assign_coords(
            {
                dim: (dim, table.floor.values[own], {"long_name": f"floor of structure {number}"}),
                dim.replace(FLOOR, "level"): (dim, table.level.values[own], attrs),
            }
        )
    return pairs.assign(status=np.int8(table.status.values.max()))
