"""Coordinates of floors and elements: which structure, which storey, how high."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from stochlin.models.systems import System

FLOOR, ELEMENT = "floor", "element"
Coordinates = dict[str, tuple[str, Any, dict[str, str]]]


def floor_coordinates(system: System) -> Coordinates:
    """Along ``floor``: names, structures and numbers from 1, levels [m], NaN for oscillators."""
    structures, numbers = _places(system)
    return {
        FLOOR: (FLOOR, system.floors, {"long_name": "floor: structure, and its number there"}),
        "floor_structure": (FLOOR, structures, {"units": "1", "long_name": "structure of the floor"}),
        "floor_number": (FLOOR, numbers, {"units": "1", "long_name": "number of the floor"}),
        "level": (FLOOR, system.all("levels"), {"units": "m", "long_name": "height of the floor"}),
    }


def element_coordinates(system: System, links: Sequence[str] = ()) -> Coordinates:
    """Along ``element``: storeys, with the names of the floors on them, and links, which are in none."""
    structures, numbers = (np.append(part, np.zeros(len(links), int)) for part in _places(system))
    told = "structure of the element, 0 for links"
    return {
        ELEMENT: (ELEMENT, [*system.floors, *links], {"long_name": "element: storey or link"}),
        "element_structure": (ELEMENT, structures, {"units": "1", "long_name": told}),
        "storey": (ELEMENT, numbers, {"units": "1", "long_name": "number of the storey, 0 for links"}),
    }


def _places(system: System) -> tuple[Any, Any]:
    sizes = [stack.mass.size for stack in system.stacks]
    numbers = np.concatenate([np.arange(1, size + 1) for size in sizes])
    return np.repeat(np.arange(1, len(sizes) + 1), sizes), numbers
