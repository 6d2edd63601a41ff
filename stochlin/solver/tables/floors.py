"""Coordinates of floors and elements: structure, number and level."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from stochlin.models.systems import Arrangement

FLOOR, ELEMENT, LINK = "floor", "element", "link"
Coordinates = dict[str, tuple[str, Any, dict[str, str]]]


def floor_coordinates(system: Arrangement) -> Coordinates:
    """Coordinates along ``floor``: names, numbers from 1, and levels [m] (NaN for oscillators)."""
    structures, numbers = _places(system)
    return {
        FLOOR: (FLOOR, system.floors, {"long_name": "floor (structure.floor)"}),
        "floor_structure": (FLOOR, structures, {"units": "1", "long_name": "structure of the floor"}),
        "floor_number": (FLOOR, numbers, {"units": "1", "long_name": "number of the floor"}),
        "level": (
            FLOOR,
            np.concatenate([stack.levels for stack in system.stacks]),
            {"units": "m", "long_name": "level of the floor"},
        ),
    }


def element_coordinates(system: Arrangement, links: Sequence[str] = ()) -> Coordinates:
    """Coordinates along ``element``: storeys, named like the floors above them, then modes and links.

    The modes are those that yield, of buildings by their modes.
    """
    structures, numbers = _places(system)
    modes = system.yielding_modes
    owners = np.searchsorted(system.first_coordinate, modes, side="right")
    structures = np.concatenate([structures, owners, np.zeros(len(links), int)])
    numbers = np.append(numbers, np.zeros(modes.size + len(links), int))
    long_name = "structure of the element, 0 for links"
    return {
        ELEMENT: (ELEMENT, [*system.watched, *links], {"long_name": "element (storey, mode or link)"}),
        "element_structure": (ELEMENT, structures, {"units": "1", "long_name": long_name}),
        "storey": (ELEMENT, numbers, {"units": "1", "long_name": "number of the storey, 0 for others"}),
    }


def link_coordinates(numbers: Sequence[int]) -> Coordinates:
    """Coordinates along ``link``: the numbers from 1 of the links in the list that was given."""
    return {LINK: (LINK, list(numbers), {"long_name": "link, by its place in the list"})}


def _places(system: Arrangement) -> tuple[Any, Any]:
    """Numbers from 1 of the structure and of the storey, for all floors."""
    sizes = [stack.levels.size for stack in system.stacks]
    numbers = np.concatenate([np.arange(1, size + 1) for size in sizes])
    return np.repeat(np.arange(1, len(sizes) + 1), sizes), numbers
