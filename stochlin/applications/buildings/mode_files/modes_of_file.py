"""The modes of a file, and what the reader of a format asks."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.messages import brief, listed
from stochlin.models.parameters import Range
from stochlin.models.units import size_of

MODE_NUMBERS = Range(1, 1e9, include_lower=True, include_upper=True)
# share of the largest displacements below which a mode does not move along the direction
LEAST_ALONG_DIRECTION = 0.01


class AskedModes(NamedTuple):
    """What the caller says of a file that has several directions, points or towers, or no units."""

    direction: str | None = None  # "UX" or "UY"
    points: tuple[str, ...] = ()
    tower: str | None = None
    mass_units: str | None = None
    length_units: str | None = None


class ModesOfFile(NamedTuple):
    """The modes in a file, in SI; modes in the order of the file, floors in any order.

    ``participation`` and ``modal_masses`` are along the direction, if the file has them.
    ``left_out`` are the numbers of modes that do not move along it, and ``turning`` of those that
    turn in plan, where the shapes are not those of points that the caller names.
    """

    modes: Sequence[int]  # numbers in the file
    periods: Array  # [s] (modes,)
    shapes: Array  # (modes, floors)
    masses: Array  # [kg] (floors,)
    levels: Array  # above the ground [m] (floors,); 0 or less of floors that cannot pound
    participation: Array | None = None  # (modes,)
    modal_masses: Array | None = None  # [kg] (modes,)
    left_out: Sequence[int] = ()
    turning: Sequence[int] = ()


ADVICE_ON_FREQUENCIES = "write 1/f of frequencies, and 2 pi/omega of angular ones"


def check_moving(modes: Sequence[int], moved: Array, where: str, most: float = 0.0) -> None:
    """Raise a ValueError for modes whose displacements are nothing beside the largest ones."""
    sizes = np.abs(moved)
    if unmoved := [*np.asarray(modes)[~(sizes > LEAST_ALONG_DIRECTION * max(most, *sizes))]]:
        what = (
            f"{where}: mode {listed(unmoved)} hardly moves along the direction, where it has mass"
        )
        raise ValueError(
            f"{what}; allowed: shapes of the same analysis and direction as the masses"
        )


def check_seconds(unit: str, where: str) -> None:
    """Raise a ValueError for periods in another unit, if a file states it."""
    if size_of(unit or "s", "s") != 1:
        cure = "convert them" if size_of(unit, "s") else ADVICE_ON_FREQUENCIES
        raise ValueError(f"{where}: periods are in {brief(unit)}; allowed: s, so {cure}")
