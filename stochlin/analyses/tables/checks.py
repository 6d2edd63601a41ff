"""Checks of plain arguments: whole numbers, durations, probabilities, gaps."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TypeGuard

import numpy as np

from stochlin.models.parameters import Model


def is_number(value: object) -> TypeGuard[float]:
    """Whether it is a real number; a truth value is none."""
    return isinstance(value, (int, float, np.integer, np.floating)) and not isinstance(value, bool)


def is_whole(value: object) -> TypeGuard[int]:
    """Whether it is a whole number; a truth value is none."""
    return isinstance(value, (int, np.integer)) and not isinstance(value, bool)


def check_whole(name: str, value: object, lowest: int, highest: int | None = None) -> None:
    """Raise a ValueError unless it is a whole number of this range."""
    if not is_whole(value) or not lowest <= value <= (math.inf if highest is None else highest):
        to = "" if highest is None else f" to {highest}"
        raise ValueError(f"{name} = {value!r}; allowed: a whole number from {lowest}{to}")


def check_scalars(model: Model, role: str, allowed: str) -> None:
    """Raise a ValueError if a parameter is an array."""
    arrays = [name for name, value in model.arrays().items() if value.ndim]
    if arrays:
        raise ValueError(f"{role}: {', '.join(arrays)} is an array; allowed: {allowed}")


def check_duration(duration: object, structures: Mapping[str, Model] | None = None) -> float:
    """The duration; a ValueError unless it is a time that a motion of these structures can last.

    ``structures`` go by their roles. One swings a period at least; of arrays of periods the cells that
    do not are left to the caller.
    """
    if duration is None:
        raise ValueError("duration is missing; give the length of the motion in seconds")
    if not is_number(duration) or not 0 < duration < math.inf:
        raise ValueError(f"duration = {duration!r}; allowed: a positive number of seconds")
    for role, structure in (structures or {}).items():
        period = structure.arrays()["period"]
        if period.ndim == 0 and float(period) > duration:
            raise ValueError(
                f"duration = {duration:g} s is shorter than the period of {role}, {float(period):g} s; "
                "allowed: a period and more"
            )
    return float(duration)


def check_confidence(confidence: object) -> None:
    """Raise a ValueError unless it is a probability between 0 and 1."""
    if not is_number(confidence) or not 0 < confidence < 1:
        raise ValueError(f"confidence = {confidence!r}; allowed: a probability between 0 and 1")


def check_existing(gap: object, duration: object, structures: Mapping[str, Model]) -> None:
    """Raise a ValueError unless the existing gap is open, and the motion as `check_duration` asks."""
    if not is_number(gap) or not 0 < gap < math.inf:
        raise ValueError(f"gap = {gap!r}; allowed: a positive number of metres")
    try:
        check_duration(duration, structures)
    except ValueError as error:
        exchanged = is_number(duration) and 0 < duration < 1 <= gap
        told = f"; gap = {gap:g} m: are the two exchanged?" if exchanged else ""
        raise ValueError(f"{error}{told}") from error
