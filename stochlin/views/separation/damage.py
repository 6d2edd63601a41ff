"""The damage of each storey in a table: residual drift, ductilities, energy and index."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from stochlin.models.systems import stack_of
from stochlin.views.shared.blocks import Block, Table, Text
from stochlin.views.shared.words import MISSING, along, centimetres, per_cent

if TYPE_CHECKING:
    from stochlin.analyses.cases.separation import CaseAnswer

HEADS = (
    "element",
    "residual drift [cm]",
    "of its height",
    "peak ductility",
    "cumulative ductility",
    "energy [J/kg]",
)
INDEX = "Park-Ang index"
NOTE = (
    "Means over the simulated motions. Residual drift: absolute value at rest after the motion. "
    "Cumulative ductility: 1 plus the energy that the element dissipates by yielding over its yield "
    "force times its yield drift. Energy: that energy over the mass of the building."
)


def damage_blocks(answer: CaseAnswer) -> list[Block]:
    """A row for each element that a building has, its storeys or itself; none if it is not asked for."""
    table = answer.separation
    if "residual_drift_mean" not in table:
        return []
    rows, with_index = [], "park_ang_mean" in table
    for number, building in enumerate(answer.case.one_or_two, start=1):
        own = table.isel(element=np.flatnonzero(table.element_structure == number))
        stack = stack_of(building.structure)
        mass = float(stack.system.mass.sum())
        heights = np.diff(stack.levels, prepend=0.0)
        for row in along(own, "element"):
            drift, storey = float(row.residual_drift_mean), int(row.storey)
            height = heights[storey - 1] if storey else np.nan
            where = f", storey {storey}" if storey else f", {row.element.item()}"
            numbers = (
                f"{float(row.peak_ductility_mean):.1f}",
                f"{float(row.cumulative_ductility_mean):.1f}",
                f"{float(row.dissipated_energy_mean) / mass:.3g}",
                *([f"{float(row.park_ang_mean):.2f}"] if with_index else []),
            )
            rows.append(
                (
                    f"{building.name}{'' if stack.is_oscillator else where}",
                    centimetres(drift),
                    per_cent(drift / height, 2),
                    *(MISSING if number == "nan" else number for number in numbers),
                )
            )
    return [Table.of((*HEADS, *([INDEX] if with_index else [])), rows), Text(NOTE, "note")]
