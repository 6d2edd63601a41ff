"""Parameters and models in words, with their numbers in the units that are shown."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from stochlin.kernels.basics.arrays import Array
from stochlin.messages import brief

LARGE = {"kg": ("t", 1e-3), "N/m": ("MN/m", 1e-6), "N s/m": ("MN s/m", 1e-6)}
SHORT_LENGTH = 0.5  # m: lengths below, such as drifts, are shown in cm
NAMES_OF_ARGUMENTS = {"first": "building 1", "second": "building 2", "envelope_model": "envelope"}
ROLES = ("first", "second", "ground", "envelope", "envelope_model", "contact", "gap", "record")
# Numbers with decimals, and not within a name.
DECIMALS = re.compile(r"(?<![\w.])\d+\.\d+(?:e[+-]?\d+)?(?![\w.])")
OF_BUILDING = re.compile(r"_([12])$")


def shown_unit(units: str, largest: float = math.inf) -> tuple[str, float]:
    """The unit in which numbers up to this size are shown, and what one in SI is multiplied by."""
    unit, scale = LARGE.get(units, (units, 1.0))
    if units == "m" and largest < SHORT_LENGTH:
        unit = "cm"
        scale = 100.0
    return "" if units == "1" else unit.replace("^2", "²").replace("^3", "³"), scale


def span(values: Array | float, units: str) -> str:
    """A number in SI in the unit that is shown, or the range of several: ``100 to 300 MN/m``."""
    lone = np.ndim(values) == 0
    ends = (
        [float(values)]
        if lone
        else [reach.reduce(values, axis=None) for reach in (np.fmin, np.fmax)]
    )
    unit, scale = shown_unit(units, max(map(abs, ends)))
    return f"{' to '.join(dict.fromkeys(f'{scale * end:.6g}' for end in ends))} {unit}".rstrip()


def stated(name: str, value: Any, units: str | None) -> str:
    """A parameter with its value in words; without units if these are None."""
    if hasattr(value, "spread"):  # uncertain
        text = value.describe(units or "1")
    elif isinstance(value, xr.DataArray) and value.ndim:
        over = f"over {', '.join(map(str, value.dims))}"
        if value.chunks is None:  # the range of a lazy array would have to be computed
            numbers = value.to_numpy()
            shown = span(numbers, units or "1")
            several = numbers.size > 1 and np.ptp(numbers) == 0
            text = f"{f'{numbers.size} times ' if several else ''}{shown} {over}"
        else:
            text = f"{value.size} values in chunks {over}"
    else:
        text = brief(value) if units is None or value is None else span(value, units)
    label = OF_BUILDING.sub(r" of building \1:", name).replace("_", " ")
    return f"{label} {text}"


def roles_in_words(attrs: Mapping[Any, Any], *roles: str) -> list[str]:
    """A line for each of these roles that a dataset's attributes describe; all if none is named."""
    return [
        f"{NAMES_OF_ARGUMENTS.get(r, r)}: {three_digits(attrs[r].removeprefix(f'{r} '))}"
        for r in roles or ROLES
        if r in attrs
    ]


def three_digits(text: str) -> str:
    """A description of models with its numbers to three digits."""
    return DECIMALS.sub(_shortened, text)


def _shortened(decimals: re.Match[str]) -> str:
    value = float(decimals[0])
    return f"{value:.0f}" if abs(value) >= 1000 else f"{value:.3g}"
