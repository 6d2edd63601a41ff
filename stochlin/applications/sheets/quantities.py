"""Quantities of the columns of files, and the words for them, which are in `quantities.toml`."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from stochlin.files.package_data import data_of
from stochlin.models.units import size_of


@dataclass(frozen=True)
class Quantity:
    """What a column may hold, by its name with an article; ``unit`` is that in which it is read."""

    name: str
    words: frozenset[str]  # of titles
    unit: str = ""  # empty of what is no measured quantity
    usual: str = ""  # unit of numbers whose file states none; empty if it is asked for

    def size(self, unit: str) -> float | None:
        """The size of a unit in that of the quantity; None if it is none of this quantity."""
        return _OF_FREQUENCIES.get(unit.strip().lower(), {}).get(self.unit) or size_of(
            unit, self.unit
        )


# Sizes that powers of seconds do not tell apart.
_HZ_SIZES = {"Hz": {"Hz": 1.0, "rad/s": math.tau}, "rad/s": {"Hz": 1 / math.tau, "rad/s": 1.0}}
_HZ_SIZES["1/s"] = {"Hz": 1.0, "rad/s": 1.0}
_SPELLED = {
    "Hz": ("hz", "hertz", "cps", "cycles/s", "cycles/sec"),
    "rad/s": ("rad/s", "rad/sec", "rad s-1", "rad s^-1", "rad/sn"),
    "1/s": ("1/s", "s-1", "s^-1", "1/sec"),
}
_OF_FREQUENCIES = {name: _HZ_SIZES[unit] for unit, names in _SPELLED.items() for name in names}

_READ = {
    key: Quantity(entry.pop("name"), frozenset(entry.pop("words", "").split()), **entry)
    for key, entry in data_of(__package__, "quantities.toml").items()
}
PERIOD_COLUMN = _READ["period"]
FREQUENCY_COLUMN = _READ["frequency"]
ANGULAR_COLUMN = _READ["angular"]
TIME_COLUMN = _READ["time"]
ACCELERATION_COLUMN = _READ["acceleration"]
SPECTRAL_COLUMN = _READ["spectral"]
PEAK_COLUMN = _READ["peak"]
VELOCITY_COLUMN = _READ["velocity"]
PSEUDO_VELOCITY_COLUMN = _READ["pseudo_velocity"]
DISPLACEMENT_COLUMN = _READ["displacement"]
SPECTRAL_DISPLACEMENT_COLUMN = _READ["spectral_displacement"]
FORCE_COLUMN = _READ["force"]
RATE_COLUMN = _READ["rate"]
RETURN_PERIOD_COLUMN = _READ["return_period"]
PROBABILITY_COLUMN = _READ["probability"]
LEVEL_COLUMN = _READ["level"]
DAMPING_COLUMN = _READ["damping"]
INDEX_COLUMN = _READ["index"]
MODE_COLUMN = _READ["mode"]
NAME_COLUMN = _READ["name"]
OTHER_COLUMN = _READ["other"]
STRANGE_COLUMN = _READ["strange"]

QUANTITIES: Mapping[str, tuple[Quantity, ...]] = {
    word: tuple(of for of in _READ.values() if word in of.words)
    for word in frozenset[str]().union(*(of.words for of in _READ.values()))
}
