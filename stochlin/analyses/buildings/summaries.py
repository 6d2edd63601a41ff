"""What a building by its modes consists of, mode by mode."""

from __future__ import annotations

import xarray as xr

from stochlin.analyses.buildings.variables import VARIABLES
from stochlin.analyses.tables import labels
from stochlin.models.buildings import ModalBuilding
from stochlin.models.buildings.base import FLOOR, MODE


def with_masses(table: xr.Dataset, building: ModalBuilding) -> xr.Dataset:
    """The table of modes with the participation factors and modal masses that the building has.

    ``mass_share`` is the effective modal mass over the mass of all floors, and ``floor_move`` the
    displacement of each floor over that of the oscillator of the mode.
    """
    masses = building.effective_masses()
    table = table.assign(
        participation=(MODE, building.factors()),
        modal_mass=(MODE, masses),
        mass_share=(MODE, masses / float(table["mass"].sum())),
        floor_move=((FLOOR, MODE), building.moves()),
    )
    return labels.label(table, VARIABLES).assign_attrs(building=building.describe())
