"""Formats of files with the modes of a building, one file each, and what they have in common."""

from stochlin.applications.buildings.mode_files.modes_of_file import (
    ADVICE_ON_FREQUENCIES,
    MODE_NUMBERS,
    AskedModes,
    ModesOfFile,
    check_moving,
    check_seconds,
)

__all__ = [
    "ADVICE_ON_FREQUENCIES",
    "MODE_NUMBERS",
    "AskedModes",
    "ModesOfFile",
    "check_moving",
    "check_seconds",
]
