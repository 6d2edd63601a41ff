"""Buildings in a row, with all that is watched in their motions, as kernels take them."""

from __future__ import annotations

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.rows import Rows
from stochlin.kernels.pounding.run import BuildingRow
from stochlin.kernels.simulation.account import Parts
from stochlin.kernels.simulation.contacts import Contacts
from stochlin.models.systems import Arrangement
from stochlin.solver.simulation.connected_structures import elements_of


def structure_of_floors(system: Arrangement) -> Array:
    """Number of the structure of each floor, from 0."""
    return np.repeat(np.arange(len(system.stacks)), np.diff(system.first))


def row_of(system: Arrangement, contacts: Contacts) -> BuildingRow:
    """Buildings with their links and these contacts as kernels take them."""
    elements, law = elements_of(system, np.arange(len(system.stacks)))
    storeys, ties = system.storeys, system.ties
    structure = np.repeat(np.arange(len(system.stacks)), np.diff(system.first_coordinate))
    n, others = structure.size, elements.kind.size - structure.size
    powers = np.array([tie.link.is_power_law for tie in ties], bool)
    dashpot = np.where(powers, n + len(ties) + np.cumsum(powers) - 1, -1)
    constant = [0.0 if tie.link.is_power_law else tie.link.number("damping_constant") for tie in ties]
    shares = np.nan_to_num(system.shear_shares)  # shears that are not known are left out later
    parts = Parts(
        mass=storeys.mass,
        structure=structure,
        elements=n,
        damping=storeys.damping,
        shear=(
            Rows.of(shares @ (storeys.post[:, None] * storeys.extensions)),
            Rows.of(shares * storeys.couple),
        ),
        watched=Rows.of(np.concatenate([elements.system.shapes, elements.system.extensions])),
        limit=np.concatenate([*(s.limits for s in system.stacks), np.full(others, np.inf)]),
        spring=n + np.arange(len(ties)),
        dashpot=dashpot.astype(np.int64),
        constant=np.array(constant, float),
    )
    return BuildingRow(elements, law, contacts, parts)
