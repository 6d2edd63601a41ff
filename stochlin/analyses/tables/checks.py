"""Checks of plain arguments: whole numbers, durations, probabilities, gaps."""

from __future__ import annotations

import math
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


def check_duration(duration: object) -> float:
    """The duration; a ValueError unless it is a time that a motion can last."""
    if duration is None:
        raise ValueError("duration is missing; give the length of the motion in seconds")
    if not is_number(duration) or not 0 < duration < math.inf:
        raise ValueError(f"duration = {duration!r}; allowed: a positive number of seconds")
    return duration


def check_confidence(confidence: object) -> None:
    """Raise a ValueError unless it is a probability between 0 and 1."""
    if not is_number(confidence) or not 0 < confidence < 1:
        raise ValueError(f"confidence = {confidence!r}; allowed: a probability between 0 and 1")


def check_gap(gap: object) -> None:
    """Raise a ValueError unless the existing gap is open."""
    if not is_number(gap) or not 0 < gap < math.inf:
        raise ValueError(f"gap = {gap!r}; allowed: a positive number of metres")
