"""Formats of files with the modes of a building, one file each, and what they have in common."""

from stochlin.applications.buildings.mode_files.modes_of_file import (
    MODE_NUMBERS,
    OF_FREQUENCY,
    AskedModes,
    ModesOfFile,
    check_moving,
    check_seconds,
)

__all__ = [
    "MODE_NUMBERS",
    "OF_FREQUENCY",
    "AskedModes",
    "ModesOfFile",
    "check_moving",
    "check_seconds",
]
