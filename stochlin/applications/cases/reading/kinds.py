"""What a key of a case file accepts: a number with its unit, a word, a text, a list, a table."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Collection, Mapping
from dataclasses import MISSING, dataclass, field, fields
from typing import Any, ClassVar, NamedTuple

import numpy as np

from stochlin.messages import brief, hint, plain
from stochlin.models.arguments import A_LABEL, Whole, is_label, is_number, is_whole
from stochlin.models.parameters import Model, Range
from stochlin.models.plausible import ANY, PLAUSIBLE, Plausible
from stochlin.models.uncertain import Uncertain
from stochlin.models.units import UNITS, size_of
from stochlin.solver.tables.toml import BACKSLASH

Warn = Callable[[str], None]  # called with what is doubtful about a value that is allowed
NUMBER = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)(.*)", re.DOTALL)
SPREAD = re.compile(r"(.+?)(?:\+-|\+/-|±)\s*(\d++\.?\d*+|\.\d++)\s*+%\s*", re.DOTALL)
FROM_TO = re.compile(r"(.+?)\sto\s(.+)", re.DOTALL)
UNCERTAIN = re.compile(r"\+-|\+/-|±|\bto\b")
OF_POWER = "N/m^", "N (s/m)^"  # units of nonlinear springs and dashpots, with any exponent
DESCRIBED = "period, damping, hardening, strength, mass, intensity"


@dataclass(frozen=True)
class Quantity:
    """A number in a unit, or a ratio; in SI when it is read."""

    units: str
    allowed: Range
    plausible: Plausible = ANY
    uncertain: bool = False  # whether it may have a spread, as "4 in +- 10 %"

    @property
    def spellings(self) -> Mapping[str, float]:
        """Units that examples show, with their values in SI."""
        names = UNITS.get(self.units, (self.units,))
        if self.units.startswith(OF_POWER):
            names = self.units, f"k{self.units}", f"M{self.units}"
        return {name: self.size(name) or 1.0 for name in names}

    @property
    def example(self) -> str:
        """A value as it is written in a file."""
        ratio = "0.05" if self.allowed.contains(0.05) else "1.5"
        return ratio if self.units == "1" else f'"1 {next(iter(self.spellings))}"'

    @property
    def words(self) -> str:
        """What is accepted, for documentation."""
        units = "" if self.units == "1" else f" in {', '.join(self.spellings)}"
        return f"a number{units}; {self.allowed}"

    def size(self, unit: str) -> float | None:
        """A unit in SI, also in other spellings; None if it is no unit of this quantity."""
        return 1.0 if unit == self.units != "1" else size_of(unit, self.units)

    def read(self, written: Any, warn: Warn) -> float | Uncertain:
        """The number in SI; a ValueError if it is not valid."""
        if not (isinstance(written, str) and UNCERTAIN.search(written)):
            return self.certain(written, warn)
        if not self.uncertain:
            allowed = f"one number, as {self.example}; what describes a building or the ground can"
            raise ValueError(f"cannot be uncertain; allowed: {allowed}: {DESCRIBED}")
        if spread := SPREAD.fullmatch(written):
            if float(spread[2]) > 100:
                raise ValueError(f"has a spread of {spread[2]} %; allowed: 0 to 100 %")
            return Uncertain(self.certain(spread[1], warn), float(spread[2]) / 100)
        if ends := FROM_TO.fullmatch(written):
            low, high = ends.groups()
            alone, unit = NUMBER.fullmatch(low), NUMBER.fullmatch(high)
            if alone and unit and not alone[2].strip():  # both have the unit of the second
                low = f"{low} {unit[2].strip()}"
            return Uncertain.between(*(self.certain(text, warn) for text in (low, high)))
        unit_shown = next(iter(self.spellings))
        raise ValueError(
            f'does not give a valid spread; allowed: "10 {unit_shown} +- 20 %", the standard deviation '
            f'of its logarithm, or "8 to 12 {unit_shown}", evenly between both'
        )

    def certain(self, written: Any, warn: Warn) -> float:
        """A number in SI without a spread."""
        value = self.in_si(written)
        if not self.allowed.contains(value):
            question = self._meant(written, value) if self.units == "1" else f", in {self.units}"
            raise ValueError(f"is out of range; allowed: {self.allowed}{question}")
        if not self.plausible.holds(value):
            warn(f"is doubtful: {self.plausible.usually}{self._meant(written, value)}")
        return value

    def in_si(self, written: Any) -> float:
        """A number in SI, within its range or not."""
        number, unit = self._split(written)
        if re.match(r",\s*\d", unit):
            signs = (".", "") if number and re.match(r",\d{3}(?!\d)", unit) else (".",)
            pointed = " or ".join(f'"{plain(written.strip().replace(",", sign), 40)}"' for sign in signs)
            raise ValueError(f"has a comma; allowed: a decimal point, as {pointed}")
        if not unit and self.units != "1":
            ways = ", ".join(self._ways(number))
            raise ValueError(f"has no unit; allowed: a text with one of its units, {ways}")
        size = self.size(unit) if unit else 1.0
        if size is None:
            raise ValueError(f"has the unknown unit {brief(unit)}; allowed: {', '.join(self.spellings)}")
        return number * size

    def _split(self, written: Any) -> tuple[float, str]:
        """The number and its unit as they are written."""
        if isinstance(written, str) and (match := NUMBER.fullmatch(written)):
            return float(match[1]), match[2].strip()
        if is_number(written) or is_whole(written):
            return (float(written) if is_number(written) else math.inf), ""
        text = "a number" if self.units == "1" else "a text with a number and its unit"
        raise ValueError(f"is no number; allowed: {text}, as {self.example}")

    def _ways(self, number: float) -> dict[str, float]:
        """Ways to write a number, with their values in SI."""
        shown = f"{number:.12g}"
        if self.units != "1":
            return {f'"{shown} {unit}"': size * number for unit, size in self.spellings.items()}
        of_percent = 1 in (self.allowed.upper, self.plausible.high)  # a share
        percent = {f'"{shown} %" or {number / 100:g}': number / 100} if of_percent else {}
        return {shown: number, **percent}

    def _meant(self, written: Any, value: float) -> str:
        """Another way to write the number that is allowed and plausible, as a question; or nothing."""
        for text, other in self._ways(self._split(written)[0]).items():
            fits = self.allowed.contains(other) and self.plausible.holds(other)
            a_slip = self.units == "1" and other < value < 2  # of a ratio: such percentages are rare
            if fits and not a_slip and not math.isclose(other, value):
                return f"; did you mean {text}?"
        return ""


class Kind(NamedTuple):
    """What a key accepts: how it is read, in words, and an example."""

    read: Callable[[Any, Warn], Any]
    words: str
    example: str


def _text(written: Any, warn: Warn) -> str:
    if not is_label(written):
        of_path = f"; {BACKSLASH}" if isinstance(written, str) and not written.isprintable() else ""
        raise ValueError(f"is no line of text; allowed: {A_LABEL}, in quotation marks{of_path}")
    return written


def _truth(written: Any, warn: Warn) -> bool:
    if not isinstance(written, bool):
        raise ValueError("is neither true nor false; allowed: true, false")
    return written


def integer(lowest: int, highest: int | None = None) -> Kind:
    """A whole number between two limits."""
    limits = Whole(lowest, highest)

    def read(written: Any, warn: Warn) -> int:
        if not limits.contains(written):
            raise ValueError(limits.refusal(written))
        return int(written)

    return Kind(read, str(limits), str(lowest))


def _column(written: Any, warn: Warn) -> str | int:
    return (TEXT if isinstance(written, str) else integer(0)).read(written, warn)


TEXT = Kind(_text, "a text", '"..."')
TRUTH = Kind(_truth, "true or false", "true")
COLUMN = Kind(_column, "a column, by its title or number", "0")


@dataclass(frozen=True)
class Word:
    """One of some words; those of a registry are listed when they are needed."""

    names: Callable[[], Collection[Any]] | Collection[Any]

    @property
    def words(self) -> str:
        """What is accepted, for documentation."""
        return ", ".join(self.names() if callable(self.names) else self.names)

    @property
    def example(self) -> str:
        """A value as it is written in a file."""
        return f'"{self.words.partition(", ")[0]}"'

    def read(self, written: Any, warn: Warn) -> str:
        """The word."""
        known = self.words.split(", ")
        if _text(written, warn) not in known:
            raise ValueError(f"is not known; {hint(written, known)}allowed: {self.words}")
        return str(written)


@dataclass(frozen=True)
class ListOf:
    """A list of values; ``single`` says what becomes of a value that stands without a list."""

    kind: Any
    single: str = ""  # refused, or "listed", or "alone" for a value that stands for all
    length: int | None = None

    @property
    def words(self) -> str:
        """What is accepted, for documentation."""
        return f"a list, each {self.kind.words}"

    @property
    def example(self) -> str:
        """A value as it is written in a file."""
        return self.kind.example if self.single else self._list

    def read(self, written: Any, warn: Warn) -> Any:
        """The values in a list; one uncertain value if they are uncertain."""
        if not isinstance(written, list) and self.single:
            value = self.kind.read(written, warn)
            return value if self.single == "alone" else [value]
        if not isinstance(written, list) or not written or len(written) != (self.length or len(written)):
            count = "" if self.length is None else f" of {self.length}"
            raise ValueError(f"is no list{count}; allowed: a list, as {self._list}")
        values = [self._value(place, each, warn) for place, each in enumerate(written, 1)]
        uncertain = [value for value in values if isinstance(value, Uncertain)]
        spreads = {(value.kind, round(value.spread, 6)) for value in uncertain}
        if not uncertain:
            return values
        if len(spreads) > 1 or len(uncertain) < len(values):
            what = "has numbers with different spreads; allowed: one spread for all of them"
            raise ValueError(f"{what}, since they vary together, by one factor")
        medians = np.array([value.median for value in uncertain])
        return Uncertain(medians, uncertain[0].spread, uncertain[0].kind)

    @property
    def _list(self) -> str:
        return f"[{', '.join([self.kind.example] * (self.length or 2))}]"

    def _value(self, place: int, written: Any, warn: Warn) -> Any:
        which = f"has a number {place} that"
        try:
            return self.kind.read(written, lambda what: warn(f"{which} {what}"))
        except ValueError as error:
            raise ValueError(f"{which} {error}") from error


@dataclass(frozen=True)
class Inner:
    """A table below this one, or several of the same name."""

    several: bool = False
    words: ClassVar[str] = "a table of its own"
    example: ClassVar[str] = "{ }"


class Key(NamedTuple):
    """A key of a table: what it accepts, its name for readers, and its value if it is missing."""

    kind: Any
    about: str
    default: Any = MISSING

    @property
    def needed(self) -> bool:
        """Whether a table must have it."""
        return self.default is MISSING


def key(kind: Any, about: str, default: Any = MISSING) -> Any:
    """Declare a key as a field of a form."""
    return field(default=default, metadata={"key": Key(kind, about, default)})


def key_of(model: type[Model], name: str, uncertain: bool = False, single: str | None = None) -> Key:
    """A parameter of a model as a key: a number, or as in `ListOf` with ``single``."""
    parameter = model.__dataclass_fields__[name]
    plausible = PLAUSIBLE.get(name, ANY)
    quantity = Quantity(model.units(name), model.allowed(name), plausible, uncertain)
    kind = quantity if single is None else ListOf(quantity, single)
    return Key(kind, parameter.metadata["long_name"].capitalize(), parameter.default)


def of(
    model: type[Model],
    name: str,
    about: str = "",
    default: Any = MISSING,
    *,
    uncertain: bool = True,
    single: str | None = None,
) -> Any:
    """Declare a key that is a parameter of a model, as in `key_of`, with another name or default."""
    known = key_of(model, name, uncertain, single)
    return key(known.kind, about or known.about, default)


def keys_of(form: type) -> dict[str, Key]:
    """The keys of a form by name."""
    return {each.name: each.metadata["key"] for each in fields(form) if "key" in each.metadata}


def keys_of_model(
    model: type[Model] | None, names: Collection[str] | None = None, **options: Any
) -> dict[str, Key]:
    """The parameters of a model that a table names, or these of them, as keys by `key_of`."""
    if names is None:
        names = () if model is None else model.parameter_names()
    return {name: key_of(model, name, **options) for name in names} if model else {}
