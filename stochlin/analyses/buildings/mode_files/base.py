"""What all formats of files with modes have in common, and the registry of the formats."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import ClassVar, NamedTuple

from stochlin.analyses.buildings.sheets import Sheet
from stochlin.kernels.basics.arrays import Array
from stochlin.models.parameters import Range
from stochlin.registry import Registry

MODE_NUMBERS = Range(1, 1e9, include_lower=True, include_upper=True)


class AskedModes(NamedTuple):
    """What the caller says of a file that has several directions or points, or states no units."""

    direction: str | None = None  # "UX" or "UY"
    points: tuple[str, ...] = ()
    mass_units: str | None = None
    length_units: str | None = None


class ModesOfFile(NamedTuple):
    """The modes in a file, in SI; modes in the order of the file, floors in any order.

    ``participation`` and ``modal_masses`` are along the direction, if the file has them. ``left_out``
    are the numbers of modes that do not move along it, and ``turning`` of those that turn in plan, where
    the shapes are not those of points that the caller names.
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


class ModeFile(ABC):
    """A format of files with modes."""

    header: ClassVar[str]  # how a file of this format begins, for messages
    takes: ClassVar[Sequence[str]]  # the arguments of `AskedModes` that have a meaning for it

    @staticmethod
    @abstractmethod
    def buildings(sheets: Sequence[Sheet]) -> Sequence[Sequence[Sheet]]:
        """The sheets of each building whose modes they have in this format."""

    @staticmethod
    @abstractmethod
    def read(sheets: Sequence[Sheet], asked: AskedModes) -> ModesOfFile:
        """The modes in the sheets; a ValueError names line and column of what does not fit."""


MODE_FILES: Registry[type[ModeFile]] = Registry(
    "format of modes", "stochlin.analyses.buildings.mode_files"
)
