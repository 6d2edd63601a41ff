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
_SIZES = {"Hz": {"Hz": 1.0, "rad/s": math.tau}, "rad/s": {"Hz": 1 / math.tau, "rad/s": 1.0}}
_SIZES["1/s"] = {"Hz": 1.0, "rad/s": 1.0}
_SPELLED = {
    "Hz": ("hz", "hertz", "cps", "cycles/s", "cycles/sec"),
    "rad/s": ("rad/s", "rad/sec", "rad s-1", "rad s^-1", "rad/sn"),
    "1/s": ("1/s", "s-1", "s^-1", "1/sec"),
}
_OF_FREQUENCIES = {name: _SIZES[unit] for unit, names in _SPELLED.items() for name in names}

_READ = {
    key: Quantity(entry.pop("name"), frozenset(entry.pop("words", "").split()), **entry)
    for key, entry in data_of(__package__, "quantities.toml").items()
}
PERIOD = _READ["period"]
FREQUENCY = _READ["frequency"]
ANGULAR = _READ["angular"]
TIME = _READ["time"]
ACCELERATION = _READ["acceleration"]
SPECTRAL = _READ["spectral"]
PEAK = _READ["peak"]
VELOCITY = _READ["velocity"]
PSEUDO_VELOCITY = _READ["pseudo_velocity"]
DISPLACEMENT = _READ["displacement"]
SPECTRAL_DISPLACEMENT = _READ["spectral_displacement"]
FORCE = _READ["force"]
RATE = _READ["rate"]
RETURN_PERIOD = _READ["return_period"]
PROBABILITY = _READ["probability"]
LEVEL = _READ["level"]
DAMPING = _READ["damping"]
INDEX = _READ["index"]
MODE = _READ["mode"]
NAME = _READ["name"]
OTHER = _READ["other"]
STRANGE = _READ["strange"]

QUANTITIES: Mapping[str, tuple[Quantity, ...]] = {
    word: tuple(of for of in _READ.values() if word in of.words)
    for word in frozenset[str]().union(*(of.words for of in _READ.values()))
}
