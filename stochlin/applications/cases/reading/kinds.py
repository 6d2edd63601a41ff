"""What a key of a case file accepts: a number with its unit, a word, a text, a list, a table."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Collection, Sequence
from dataclasses import MISSING, dataclass, field, fields, replace
from typing import Any, ClassVar, NamedTuple

import numpy as np
from scipy.constants import g

from stochlin.applications.sheets.columns import COUNTED_FROM_1
from stochlin.files.toml import BACKSLASH
from stochlin.messages import brief, hint
from stochlin.models.arguments import A_LABEL, Whole, is_label, is_number, is_whole
from stochlin.models.parameters import Model, Range
from stochlin.models.plausible import ANY, Plausible
from stochlin.models.uncertain import Uncertain, median_of
from stochlin.models.units import UNITS, likely_unit, size_of

Warn = Callable[[str], None]  # called with what is doubtful about a value that is allowed
NUMBER_AND_UNIT = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)(.*)", re.DOTALL)
VALUE_AND_SPREAD = re.compile(r"(.+?)(?:\+-|\+/-|±)\s*(100|\d{1,2}(?:\.\d*+)?)\s*+%\s*", re.DOTALL)
FROM_TO = re.compile(r"(.+?)\sto\s(.+)", re.DOTALL)
# Numbers with a sign between thousands, or with a decimal comma: sign, digits, decimals and unit.
_THOUSANDS = re.compile(
    r"\s*([-+]?)(\d{1,3}([ ,.'\u2019_\xa0\u202f])\d{3}(?:\3\d{3})*)"
    r"(?:[.,](\d+))?(\s*(?:[^\d.,'\u2019].*)?)",
    re.DOTALL,
)
_HYPHEN = re.compile(r"[-\u2013]\s*(\d.*)", re.DOTALL)  # between two ends, before the second
# of an inch, after the whole ones
_INCH_FRACTION = re.compile(r"(\d{1,4})/(\d{1,4})\s*([A-Za-z]+)")
_NUMBER_WITH_COMMA = re.compile(r"\s*([-+]?)(\d*),(\d+)(\s*(?:[^\d.,'\u2019].*)?)", re.DOTALL)
UNCERTAIN = re.compile(r"\+-|\+/-|±|\bto\b")
LONGEST_NUMBER = 40  # characters of a number that messages repeat
POWER_UNITS = "N/m^", "N (s/m)^"  # units of nonlinear springs and dashpots, with any exponent


@dataclass(frozen=True)
class WithUnit:
    """A number in a unit, or a ratio; in SI when it is read."""

    units: str
    allowed: Range
    plausible: Plausible = ANY
    uncertain: bool = False  # whether it may have a spread, as "4 in +- 10 %"

    @property
    def spellings(self) -> Sequence[str]:
        """Units that messages show; those of a ratio are a percentage."""
        if self.units.startswith(POWER_UNITS):
            return self.units, f"k{self.units}", f"M{self.units}"
        return UNITS.get(self.units, (self.units,))

    @property
    def words(self) -> str:
        """What is accepted, in words."""
        units = "" if self.units == "1" else f" in {', '.join(self.spellings)}"
        return f"a number{units}; {self.allowed}"

    def size(self, unit: str) -> float | None:
        """A unit in SI, also in other spellings; None if it is no unit of this quantity."""
        return 1.0 if unit == self.units != "1" else size_of(unit, self.units)

    def read(self, written: Any, warn: Warn) -> float | Uncertain:
        """The number in SI, with a warning for an implausible median; a ValueError if not valid."""
        value = self.with_spread(written)
        if text := self.plausible.doubt(float(median_of(value))):
            warn(f"is doubtful: {text}")
        return value

    def with_spread(self, written: Any) -> float | Uncertain:
        """The number in SI, which may be uncertain; a ValueError if it is not valid."""
        if not (isinstance(written, str) and UNCERTAIN.search(written)):
            return self.certain(written)
        if not self.uncertain:
            raise ValueError(f"cannot be uncertain; allowed: {self.words}")
        if spread := VALUE_AND_SPREAD.fullmatch(written):
            return Uncertain(self.certain(spread[1]), float(spread[2]) / 100)
        if ends := FROM_TO.fullmatch(written):
            low, high = ends.groups()
            alone = NUMBER_AND_UNIT.fullmatch(low)
            unit = NUMBER_AND_UNIT.fullmatch(high)
            if alone and unit and not alone[2].strip():  # both have the unit of the second
                low = f"{low} {unit[2].strip()}"
            return Uncertain.between(self.certain(low), self.certain(high))
        median = UNCERTAIN.split(written, maxsplit=1)[0].strip()
        number = NUMBER_AND_UNIT.fullmatch(median) if len(median) < LONGEST_NUMBER else None
        value = float(number[1]) if number else 10.0
        unit_of_median = number[2] if number else f" {self.spellings[0]}"
        two_ends = f"{0.8 * value:g} to {1.2 * value:g}{unit_of_median}"
        ways = f'"{value:g}{unit_of_median} +- 20 %", or two ends, "{two_ends}"'
        raise ValueError(f"has no valid spread; allowed: a share of up to 100 %, {ways}")

    def certain(self, written: Any) -> float:
        """A number in SI without a spread."""
        value = self.in_si(written)
        if not self.allowed.contains(value):
            percent = self.allowed.upper == 1 and 2 <= value <= 100 and "%" not in str(written)
            cure = f'; for {value:g} % write "{value:g} %"' if percent else ""
            units = "" if self.units == "1" else f", in {self.units}"
            raise ValueError(f"is out of range; allowed: {self.allowed}{units}{cure}")
        return value

    def in_si(self, written: Any) -> float:
        """A number in SI, within its range or not."""
        if isinstance(written, str) and (readings := with_points(written)):
            ways = " or ".join(f'"{reading}"' for reading in readings)
            raise ValueError(f"has a sign within its number that is no decimal point; write {ways}")
        if isinstance(written, str) and (match := NUMBER_AND_UNIT.fullmatch(written)):
            number = float(match[1])
            unit = match[2].strip()
        elif is_number(written) or is_whole(written):
            number = float(written) if is_number(written) else math.inf
            unit = ""
        else:
            raise ValueError(f"is no number; allowed: {self.words}")
        if not unit and self.units != "1":
            ways = ", ".join(f'"{number:.12g} {unit}"' for unit in self.spellings)
            raise ValueError(f"has no unit; allowed: a text with one of its units, {ways}")
        size = self.size(unit) if unit else 1.0
        if size is None:
            self._check_written(number, unit)
            what = f"has the unknown unit {brief(unit)}; {likely_unit(unit, self.units)}"
            raise ValueError(f"{what}allowed: {', '.join(self.spellings)}")
        return number * size

    def _check_written(self, number: float, unit: str) -> None:
        """Raise a ValueError that says how to write what stands in place of a unit, if known."""
        if (other := _HYPHEN.fullmatch(unit)) and self.uncertain:
            raise ValueError(
                f'has a hyphen between two ends; write "{number:g} to {other[1].strip()}"'
            )
        if (part := _INCH_FRACTION.fullmatch(unit)) and int(part[2]):
            decimals = f"{number + int(part[1]) / int(part[2]):.12g} {part[3]}"
            raise ValueError(f'has a fraction; write "{decimals}"')
        if self.units == "kg" and (force := size_of(unit, "N")):
            mass = f"{number * force / g / 1000:.4g} t"
            raise ValueError(f'is a weight, in {brief(unit)}; write its mass, "{mass}"')


def with_points(text: str) -> list[str]:
    """What a number with signs between thousands or a decimal comma may mean, with a decimal point.

    None of a number that has no such sign.
    """
    readings = []
    if grouped := _THOUSANDS.fullmatch(text):
        minus, digits, sign, decimals, unit = grouped.groups()
        several = digits.count(sign) > 1 or decimals is not None
        if sign == "." and not several:
            return []
        whole = digits.replace(sign, "")
        readings.append(f"{minus}{whole}{f'.{decimals}' if decimals else ''}{unit}")
        if several or sign != ",":
            return readings
    if decimal := _NUMBER_WITH_COMMA.fullmatch(text):
        minus, whole, decimals, unit = decimal.groups()
        readings.append(f"{minus}{whole or 0}.{decimals}{unit}")
    return readings


class Kind(NamedTuple):
    """What a key accepts: how it is read, and in words."""

    read: Callable[[Any, Warn], Any]
    words: str


def _text(written: Any, warn: Warn) -> str:
    if not is_label(written):
        of_path = f"; {BACKSLASH}" if isinstance(written, str) and not written.isprintable() else ""
        raise ValueError(f"is no line of text; allowed: {A_LABEL}, in quotation marks{of_path}")
    return written


def _truth(written: Any, warn: Warn) -> bool:
    if not isinstance(written, bool):
        raise ValueError("is neither true nor false; allowed: true, false")
    return written


class Integer(Whole):
    """A whole number between two limits."""

    words = property(Whole.__str__)

    def read(self, written: Any, warn: Warn) -> int:
        """The number."""
        if not self.contains(written):
            raise ValueError(self.refusal(written))
        return int(written)


class _ColumnNumber(Integer):
    """The number of a column."""

    def read(self, written: Any, warn: Warn) -> int:
        """The number."""
        if not self.contains(written):
            raise ValueError(f"is no column; allowed: a title, or a number, since {COUNTED_FROM_1}")
        return int(written)


def text_or(other: Any, words: str) -> Kind:
    """A text, or what another kind accepts."""
    return Kind(
        lambda value, warn: (TEXT if isinstance(value, str) else other).read(value, warn), words
    )


TEXT = Kind(_text, "a text")
TRUTH = Kind(_truth, "true or false")
COMPONENT = text_or(Integer(1), "a component, by its name or its number from 1")
COLUMN_OF_FILE = text_or(_ColumnNumber(1), "a column, by its title or its number from 1")


@dataclass(frozen=True)
class Word:
    """One of some words; those of a registry are listed when they are needed."""

    names: Callable[[], Collection[str]] | Collection[str]

    @property
    def allowed(self) -> list[str]:
        """The words."""
        return list(self.names() if callable(self.names) else self.names)

    @property
    def words(self) -> str:
        """What is accepted."""
        return ", ".join(self.allowed)

    def read(self, written: Any, warn: Warn) -> str:
        """The word."""
        if written not in self.allowed:
            near = hint(written, self.allowed) if isinstance(written, str) else ""
            raise ValueError(f"is not known; {near}allowed: {self.words}")
        return str(written)


@dataclass(frozen=True)
class ListOf:
    """A list of values; ``single`` says what becomes of a value that stands without a list."""

    kind: Any
    single: str = ""  # refused, or "listed", or "alone" for a value that stands for all
    length: int | None = None

    @property
    def words(self) -> str:
        """What is accepted, in words."""
        return (
            f"a list{'' if self.length is None else f' of {self.length}'}, each {self.kind.words}"
        )

    def read(self, written: Any, warn: Warn) -> Any:
        """The values in a list; one uncertain value if they are uncertain."""
        if not isinstance(written, list) and self.single:
            value = self.kind.read(written, warn)
            return value if self.single == "alone" else [value]
        if (
            not isinstance(written, list)
            or not written
            or len(written) != (self.length or len(written))
        ):
            raise ValueError(f"is no such list; allowed: {self.words}")
        values = [self._value(place, value, warn) for place, value in enumerate(written, 1)]
        spreads = {isinstance(x, Uncertain) and (x.kind, round(x.spread, 6)) for x in values}
        if spreads == {False}:
            return values
        if len(spreads) > 1:
            raise ValueError(
                "has numbers with different spreads; allowed: one spread for all of them"
            )
        return replace(values[0], median=np.array([value.median for value in values]))

    def _value(self, place: int, written: Any, warn: Warn) -> Any:
        which = f"has a number {place} that"
        try:
            return self.kind.read(written, lambda what: warn(f"{which} {what}"))
        except ValueError as error:
            raise ValueError(f"{which} {error}") from error


@dataclass(frozen=True)
class Inner:
    """A table below this one, or several of the same name, which is read by one of its forms."""

    forms: Sequence[Any]
    several: bool = False
    later: bool = False  # by another part of the reader, since its form depends on other tables
    words: ClassVar[str] = "a table of its own"


class Key(NamedTuple):
    """A key of a table: what it accepts, its name for readers, and its value if it is missing."""

    kind: Any
    about: str
    default: Any = MISSING


def key(kind: Any, about: str, default: Any = MISSING) -> Any:
    """Declare a key as a field of a form."""
    return field(default=default, metadata={"key": Key(kind, about, default)})


def key_of(
    model: type[Model], name: str, uncertain: bool = False, single: str | None = None
) -> Key:
    """A parameter of a model as a key: a number, or as in `ListOf` with ``single``."""
    parameter = model.__dataclass_fields__[name]
    quantity = WithUnit(model.units(name), model.allowed(name), model.limits()[name], uncertain)
    kind = quantity if single is None else ListOf(quantity, single)
    return Key(kind, parameter.metadata["long_name"].capitalize(), parameter.default)


def of(
    model: type[Model], name: str, about: str = "", default: Any = MISSING, **options: Any
) -> Any:
    """Declare a key that is a parameter of a model, by default one that may be uncertain."""
    parameter = key_of(model, name, **{"uncertain": True, **options})
    return key(parameter.kind, about or parameter.about, default)


def keys_of(form: type) -> dict[str, Key]:
    """The keys of a form by name."""
    return {field.name: field.metadata["key"] for field in fields(form) if "key" in field.metadata}


def keys_of_model(
    model: type[Model] | None, names: Collection[str] | None = None, **options: Any
) -> dict[str, Key]:
    """The parameters of a model that a table names, or these of them, as keys by `key_of`."""
    if model is None:
        return {}
    chosen = model.parameter_names() if names is None else names
    return {name: key_of(model, name, **options) for name in chosen}
