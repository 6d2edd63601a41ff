"""Numbers of a case file with their units, in SI."""

from __future__ import annotations

import math
import re
import warnings
from collections.abc import Mapping
from typing import Any, NamedTuple, TypeGuard

from stochlin.messages import ImplausibleInput, brief, plain
from stochlin.models.arguments import is_number, is_whole
from stochlin.models.parameters import Model, Range
from stochlin.models.plausible import ANY, PLAUSIBLE, Plausible
from stochlin.models.units import UNITS, size_of

_OF_POWER = ("N/m^", "N (s/m)^")  # units of nonlinear springs and dashpots, with any exponent
_COMMA, _THOUSANDS = re.compile(r",\s*\d"), re.compile(r",\d{3}(?!\d)")
NUMBER = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)(.*)", re.DOTALL)
SPREAD = re.compile(r"(.+?)(?:\+-|\+/-|±)\s*(\d++\.?\d*+|\.\d++)\s*+%\s*", re.DOTALL)
_SIGNS = re.compile(r"\+-|\+/-|±|\bto\b")  # signs of an uncertain value
FROM_TO = re.compile(r"(.+?)\sto\s(.+)", re.DOTALL)


class Quantity(NamedTuple):
    """SI unit, allowed and plausible range of a value, as declared by the parameters of models."""

    units: str
    allowed: Range
    plausible: Plausible = ANY

    @classmethod
    def declared(cls, kind: type[Model], name: str) -> Quantity:
        """The quantity of a declared parameter of a model."""
        return cls(kind.units(name), kind.allowed(name), PLAUSIBLE.get(name, ANY))

    @property
    def spellings(self) -> Mapping[str, float]:
        """Allowed units of the quantity, with their values in SI."""
        names = UNITS.get(self.units, (self.units,))
        if self.units.startswith(_OF_POWER):
            names = self.units, f"k{self.units}", f"M{self.units}"
        return {name: self.size(name) or 1.0 for name in names}

    def size(self, unit: str) -> float | None:
        """A unit of the quantity in SI, also in other spellings; None if it is no such unit."""
        return 1.0 if unit == self.units != "1" else size_of(unit, self.units)

    @property
    def example(self) -> str:
        """An example of a value as it is written in a file."""
        ratio = "0.05" if self.allowed.contains(0.05) else "1.5"
        return ratio if self.units == "1" else f'"1 {next(iter(self.spellings))}"'

    def ways(self, number: float, shown: str) -> dict[str, float]:
        """Ways to write a number in a file, with their values in SI; the plausible ones come first."""
        ways = {f'"{shown} {unit}"': size * number for unit, size in self.spellings.items()}
        if self.units == "1":
            ways = {shown: number}
            if 1 in (self.allowed.upper, self.plausible.high):  # a share
                ways[f'"{shown} %" or {number / 100:g}'] = number / 100
        allowed = {text: value for text, value in ways.items() if self.allowed.contains(value)} or ways
        return dict(sorted(allowed.items(), key=lambda way: not self.plausible.holds(way[1])))

    def meant(self, given: Any, value: float) -> str:
        """Another way to write a number, which is allowed and plausible and may be meant; or nothing."""
        number, _ = _split(given, self)
        for text, other in self.ways(number, f"{number:g}").items():
            fits = self.allowed.contains(other) and self.plausible.holds(other)
            a_slip = self.units == "1" and other < value < 2  # of a ratio: such percentages are rare
            if fits and not a_slip and not math.isclose(other, value):
                return f"; did you mean {text}?"
        return ""


def is_uncertain(given: object) -> TypeGuard[str]:
    """Whether a value is a text with an uncertain number."""
    return isinstance(given, str) and _SIGNS.search(given) is not None


def in_si(given: Any, quantity: Quantity) -> float:
    """A number in SI from a value of a file or an option; a ValueError if it is not valid."""
    value, unit = _split(given, quantity)
    known, size = quantity.spellings, quantity.size(unit)
    if _COMMA.match(unit):
        pointed, whole = (plain(given.strip().replace(",", sign), 40) for sign in (".", ""))
        thousands = (
            f', or no sign between thousands, as "{whole}"' if value and _THOUSANDS.match(unit) else ""
        )
        raise ValueError(f'has a comma; allowed: a decimal point, as "{pointed}"{thousands}')
    if unit and size is None:
        raise ValueError(f"has the unknown unit {brief(unit)}; allowed: {', '.join(known)}")
    return value * size if size else value


def with_unit(text: str, quantity: Quantity) -> float:
    """A number in SI from a text with a unit; for a ratio the unit is not needed."""
    match = NUMBER.fullmatch(text)
    bare = quantity.units == "1" and match and not match[2].strip()
    value = float(text) if bare else in_si(text, quantity)
    if not quantity.plausible.holds(value):
        warnings.warn(quantity.plausible.usually, ImplausibleInput, stacklevel=2)
    return value


def _split(given: Any, quantity: Quantity) -> tuple[float, str]:
    """The number and its unit as written; the unit is empty for a ratio without one."""
    a_number = is_whole(given) or is_number(given)
    match = NUMBER.fullmatch(given) if isinstance(given, str) else None
    ratio = quantity.units == "1"
    if a_number and ratio:
        return (float(given) if is_number(given) else math.inf), ""
    if match is None and not a_number:
        allowed = "a number" if ratio else "a text with a number and its unit"
        raise ValueError(f"is no number; allowed: {allowed}, as {quantity.example}")
    unit = "" if match is None else match[2].strip()
    if not unit and not ratio:
        number = plain(match[1], 20) if match else f"{given:g}" if is_number(given) else brief(given)
        value = float(match[1]) if match else float(given) if is_number(given) else math.nan
        suggested = ", ".join(quantity.ways(value, number))
        raise ValueError(f"has no unit; allowed: a text with one of its units, {suggested}")
    if match and ratio and not unit:
        way = next(iter(quantity.ways(float(match[1]), plain(match[1], 20))))
        bare = "the number without quotation marks, " * (not way.startswith('"'))
        raise ValueError(f"is a text without a unit; allowed: {bare}{way}")
    return float(match[1]) if match else float(given), unit
