"""Checks of plain arguments: whole numbers, durations, probabilities, gaps."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any, TypeGuard

import numpy as np
import numpy.typing as npt

from stochlin.messages import brief
from stochlin.models.parameters import Model, expect
from stochlin.models.systems import STRUCTURES, AnyStructure, first_period
from stochlin.models.uncertain import median_of

LONGEST_LABEL, LONGEST_PATH = 200, 4096
A_LABEL = f"a text on one line, {LONGEST_LABEL} characters at most, no control characters"
LARGEST = int(np.finfo(float).max)
MOST_SCATTER = 2.0  # standard deviation of a logarithm: factors from 0.14 to 7 are within one of it
LARGEST_WHOLE = 2**63 - 1  # largest whole number of files and compiled code


def is_number(value: object) -> TypeGuard[float]:
    """Whether ``value`` is a real number in the range of floats, or NaN; True and False are not."""
    known = isinstance(value, (int, float, np.integer, np.floating)) and not isinstance(value, bool)
    return known and not (isinstance(value, int) and abs(value) > LARGEST)


def is_whole(value: object) -> TypeGuard[int]:
    """Whether ``value`` is a whole number; True and False are not."""
    return isinstance(value, (int, np.integer)) and not isinstance(value, bool)


def is_label(value: object) -> TypeGuard[str]:
    """Whether ``value`` is a line of text that can be shown in a table and a picture."""
    if not isinstance(value, str) or not value.isprintable():
        return False
    return bool(value.strip()) and len(value) <= LONGEST_LABEL


def check_label(name: str, value: object) -> None:
    """Raise a ValueError unless ``value`` is a text that can be shown in a table and a picture."""
    if not is_label(value):
        raise ValueError(f"{name} = {brief(value)}; allowed: {A_LABEL}")


def check_whole(name: str, value: object, lowest: int, highest: int | None = None) -> None:
    """Raise a ValueError unless ``value`` is a whole number from ``lowest`` to ``highest``."""
    if not is_whole(value) or not lowest <= value <= (LARGEST_WHOLE if highest is None else highest):
        to = "" if highest is None else f" to {highest}"
        raise ValueError(f"{name} = {brief(value)}; allowed: a whole number from {lowest}{to}")


def check_truth(name: str, value: object) -> None:
    """Raise a TypeError unless ``value`` is True or False."""
    if not isinstance(value, (bool, np.bool_)):
        raise TypeError(f"{name} = {brief(value)}; allowed: True or False")


def check_two_numbers(name: str, value: object) -> None:
    """Raise a TypeError unless ``value`` is a pair of numbers."""
    two = isinstance(value, (tuple, list, np.ndarray)) and len(value) == 2
    if not two or not all(is_number(number) for number in value):  # type: ignore[attr-defined]
        raise TypeError(f"{name} = {brief(value)}; allowed: two numbers")


def as_path(name: str, value: object) -> Path:
    """The path; raises a TypeError or ValueError if ``value`` cannot be one."""
    if not isinstance(value, (str, os.PathLike)):
        raise TypeError(f"{name} = {brief(value)}; allowed: the name of a file, as text or a path")
    if len(os.fspath(value)) > LONGEST_PATH:
        raise ValueError(f"{name} = {brief(value)} is too long; allowed: {LONGEST_PATH} characters")
    return Path(value)


def as_numbers(name: str, value: object, allowed: str) -> npt.NDArray[Any]:
    """The array of ``value``; raises a TypeError unless it has real numbers only."""
    try:
        array = np.asarray(value)
    except (ValueError, TypeError):  # ragged lists; a dataset
        array = np.empty((), object)
    if array.dtype.kind not in "iuf":
        raise TypeError(f"{name} = {brief(value)}; allowed: {allowed}")
    return array


def check_scalars(model: Model, role: str, allowed: str) -> None:
    """Raise a ValueError if a parameter of the model is an array."""
    arrays = [name for name, value in model.arrays().items() if value.ndim]
    if arrays:
        raise ValueError(f"{role}: {', '.join(arrays)} is an array; allowed: {allowed}")


def check_duration(duration: object, structures: Mapping[str, AnyStructure] | None = None) -> float:
    """The duration of a motion [s]; raises a ValueError if it is not positive or too short.

    It must be at least the period of each of the ``structures``, which are by their roles. Arrays of
    periods are not checked.
    """
    if duration is None:
        raise ValueError("duration is missing; give the length of the motion in seconds")
    if not is_number(duration) or not 0 < duration < math.inf:
        raise ValueError(f"duration = {brief(duration)}; allowed: a positive number of seconds")
    for role, structure in (structures or {}).items():
        period = first_period(structure)
        if period.ndim == 0 and float(period) > duration:
            raise ValueError(
                f"duration = {duration:g} s is shorter than the period of {role}, {float(period):g} s; "
                "allowed: one period or more"
            )
    return float(duration)


def standing(first: object, second: object) -> dict[str, Any]:
    """The structures by their roles; if ``second`` is None, one structure beside its property line.

    Raises a TypeError unless they are structures.
    """
    if first is None:
        raise TypeError(
            "first = None; allowed: a structure; for one structure and the property line on its right, "
            "give the structure as first and None as second"
        )
    structures = {"first": first} | ({} if second is None else {"second": second})
    for role, structure in structures.items():
        expect(median_of(structure), STRUCTURES, role)
    return structures


def check_confidence(confidence: object) -> None:
    """Raise a ValueError unless ``confidence`` is a probability between 0 and 1."""
    if not is_number(confidence) or not 0 < confidence < 1:
        raise ValueError(f"confidence = {brief(confidence)}; allowed: a probability between 0 and 1")


def check_scatter(scatter: object) -> None:
    """Raise a ValueError unless ``scatter`` is a standard deviation of the logarithm of the motions."""
    if not is_number(scatter) or not 0 <= scatter <= MOST_SCATTER:
        cure = ""
        if is_number(scatter) and MOST_SCATTER < scatter <= 100:
            cure = f"; for {scatter:g} % write {scatter / 100:g}"
        raise ValueError(
            f"scatter = {brief(scatter)}; allowed: a number from 0 to {MOST_SCATTER:g}, the standard "
            f"deviation of the natural logarithm of a factor on each motion{cure}"
        )


def checked_quantiles(quantiles: object) -> npt.NDArray[np.float64]:
    """The quantiles as an array; raises a ValueError unless they are numbers between 0 and 1."""
    allowed = "numbers between 0 and 1"
    levels = as_numbers("quantiles", quantiles, allowed).astype(float)
    if levels.ndim != 1 or not levels.size or not ((levels > 0) & (levels < 1)).all():
        raise ValueError(f"quantiles = {brief(quantiles)}; allowed: {allowed}")
    return levels


def checked_gap(gap: object) -> float:
    """The existing gap [m]; raises a ValueError unless it is positive."""
    if not is_number(gap) or not 0 < gap < math.inf:
        raise ValueError(f"gap = {brief(gap)}; allowed: a positive number of metres")
    return float(gap)


def check_existing(gap: object, duration: object, structures: Mapping[str, AnyStructure]) -> None:
    """Raise a ValueError unless the gap is positive and the duration passes `check_duration`."""
    open_gap = checked_gap(gap)
    try:
        check_duration(duration, structures)
    except ValueError as error:
        exchanged = is_number(duration) and 0 < duration < 1 <= open_gap
        hint = f"; gap = {open_gap:g} m: are duration and gap exchanged?" if exchanged else ""
        raise ValueError(f"{error}{hint}") from error
