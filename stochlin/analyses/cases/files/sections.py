"""Tables of a TOML file, read key by key; errors name the file, the line and the key."""

from __future__ import annotations

import math
import re
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from stochlin.analyses.cases.files.keys import NEEDED, Column, Key, Place
from stochlin.analyses.cases.files.quantities import (
    FROM_TO,
    NUMBER,
    SPREAD,
    Quantity,
    in_si,
    is_uncertain,
    with_unit,
)
from stochlin.analyses.cases.files.schema import keys_at
from stochlin.analyses.tables.toml import BACKSLASH, read_toml
from stochlin.messages import (
    LONGEST_MESSAGE,
    DoubtfulInput,
    brief,
    hint,
    listed,
    nearest,
    plain,
    sentence,
)
from stochlin.models.arguments import A_LABEL, Whole, is_label
from stochlin.models.parameters import Model
from stochlin.models.uncertain import Uncertain
from stochlin.removed import instead_of

One = TypeVar("One", bound=Model)

MOST_LISTED = 32  # of the keys that are allowed
_BARE, _QUOTED = r"[A-Za-z0-9_-]+", r"\"[^\"]*\"|'[^']*'"
_DOTTED = rf"(?:{_BARE}|{_QUOTED})(?:\s*\.\s*(?:{_BARE}|{_QUOTED}))*"
_HEADER = re.compile(rf"\s*(\[\[?)\s*({_DOTTED})\s*\]")
_KEY = re.compile(rf"\s*({_DOTTED})\s*=")


@dataclass(frozen=True)
class Section:
    """One table of a TOML file, with its place and the line numbers of all keys."""

    file: str
    place: Place
    values: Mapping[str, Any]
    lines: Mapping[Place, int]
    doubts: set[Place] = field(default_factory=set, compare=False, repr=False)  # keys warned of

    def __contains__(self, key: str) -> bool:
        return key in self.values

    def name(self, key: str = "") -> str:
        """The key with the names of its tables, as in ``building_1.period``."""
        parts = (part for part in (*self.place, key) if isinstance(part, str) and part)
        return ".".join(plain(part, 40) for part in parts)

    def error(self, key: str, what: str) -> ValueError:
        """A ValueError at a key, or at the table for an empty key."""
        places = [(*self.place, key), *(self.place[:n] for n in range(len(self.place), 0, -1))]
        line = next((self.lines[place] for place in places if place in self.lines), None)
        where = self.file if line is None else f"{self.file}, line {line}"
        a_value = key in self and not isinstance(self.values[key], dict)
        subject = f"{self.name(key)} = {brief(self.values[key])}" if a_value else self.name(key)
        return ValueError(f"{where}: {subject} {what}".replace(":  ", ": "))

    def doubt(self, key: str, what: str) -> None:
        """Warn, once in the same words, of the value of a key, which is allowed but implausible."""
        if (*self.place, key, what) not in self.doubts:
            self.doubts.add((*self.place, key, what))
            warnings.warn(str(self.error(key, what)), DoubtfulInput, stacklevel=2)

    @contextmanager
    def naming(self, key: str, what: str = "cannot be used") -> Iterator[None]:
        """Add the file, the line and the key to errors and warnings that occur inside the context."""
        try:
            with warnings.catch_warnings(record=True) as caught:
                warnings.simplefilter("always", DoubtfulInput)
                yield
        except (OSError, ValueError) as error:
            if str(error).startswith(self.file):
                raise
            raise self.error(key, f"{what}: {sentence(error, LONGEST_MESSAGE)}") from error
        placed = [warning for warning in caught if str(warning.message).startswith(self.file)]
        for warning in caught:
            if issubclass(warning.category, DoubtfulInput) and warning not in placed:
                if not placed:  # or the number behind it was told with its key
                    self.doubt(key, f"is doubtful: {warning.message}")
            else:
                warnings.warn_explicit(
                    warning.message, warning.category, warning.filename, warning.lineno
                )

    @property
    def keys(self) -> Mapping[str, Key]:
        """The keys that the table may have, as the schema says, by name."""
        return keys_at(self.place)

    def read(self, name: str) -> Any:
        """The value of a key of the schema, numbers in SI; its default if it is missing and has one."""
        key = self.keys[name]
        if name not in self and key.default is not NEEDED:
            return key.default
        if isinstance(key.kind, Quantity):
            return self.number(name, key.kind)
        if isinstance(key.kind, Whole):
            return self.whole(name, key.kind)
        if isinstance(key.kind, type):
            of_kind: dict[type, Any] = {bool: self.truth, str: self.text, Column: self.column}
            return of_kind[key.kind](name)
        return self.text(name, key.kind)

    def only(self, *allowed: str, elsewhere: Sequence[str] = ()) -> None:
        """Raise a ValueError for a key that is not allowed, and suggest the nearest known one.

        Keys that no result depends on are allowed, and checked.
        """
        known = {*allowed}
        for key in self.values:
            if key in self.keys and self.keys[key].noted:
                self.read(key)
            elif key not in known:
                near = "" if key in elsewhere else nearest(key, (*allowed, *elsewhere))
                beside = ", which is given as well" if near in self else ""
                said = instead_of(key) or (f"did you mean {near}{beside}? " if near else "")
                raise self.error(
                    key,
                    f"is not a key that is known here; {said}allowed: {listed(allowed, MOST_LISTED)}",
                )

    def need(self, key: str, example: str) -> Any:
        """The value of a key as written; a ValueError with the example if it is missing."""
        if key not in self:
            raise self.error(key, f"is missing; write, for instance, {key} = {example}")
        return self.values[key]

    def number(self, key: str, quantity: Quantity) -> float:
        """A number in SI, from a text with a unit; for a ratio from a number or per cent."""
        return self._number(key, self.need(key, quantity.example), quantity)

    def parameter(self, key: str, quantity: Quantity) -> float | Uncertain:
        """A number in SI, or an uncertain one such as ``"1 s +- 20 %"`` or ``"0.8 to 1.2 s"``."""
        value = self.values.get(key)
        if not is_uncertain(value):
            return self.number(key, quantity)
        spread, ends = SPREAD.fullmatch(value), FROM_TO.fullmatch(value)
        example = next(iter(quantity.spellings))
        if spread is None and ends is None:
            raise self.error(
                key,
                f'does not give a valid spread; allowed: "10 {example} +- 20 %", the standard '
                f'deviation of its logarithm, or "8 to 12 {example}", evenly between both',
            )
        if spread is not None and float(spread[2]) > 100:
            raise self.error(key, f"has a spread of {spread[2]} %; allowed: 0 to 100 %")
        with self.naming(key, "cannot be read"):
            if spread is not None:
                return Uncertain(with_unit(spread[1], quantity), float(spread[2]) / 100)
            assert ends is not None
            low, high = ends.groups()
            alone, unit_of_high = map(NUMBER.fullmatch, (low, high))
            if alone and unit_of_high and not alone[2].strip():  # both have the unit of the second
                low = f"{low} {unit_of_high[2].strip()}"
            return Uncertain.between(*(with_unit(text, quantity) for text in (low, high)))

    def parameters(self, key: str, quantity: Quantity) -> list[float] | Uncertain:
        """A list of numbers in SI; uncertain ones have the same spread and a common factor."""
        values = self.values.get(key)
        if not isinstance(values, list) or not any(map(is_uncertain, values)):
            return self.numbers(key, quantity)
        alone = (replace(self, values={key: value}) for value in values)
        each = [section.parameter(key, quantity) for section in alone]
        first = next(number for number in each if isinstance(number, Uncertain))
        alike = [
            number.median
            for number in each
            if isinstance(number, Uncertain)
            and number.kind == first.kind
            and math.isclose(number.spread, first.spread, rel_tol=1e-6)
        ]
        if len(alike) < len(each):
            raise self.error(
                key,
                "has numbers with different spreads; allowed: one spread for all of them, since they "
                "vary together, by one factor",
            )
        return Uncertain(np.array(alike), first.spread, first.kind)

    def parameter_or_list(self, key: str, quantity: Quantity) -> float | list[float] | Uncertain:
        """A number in SI or a list of them, with or without uncertainty."""
        listed = isinstance(self.values.get(key), list)
        return self.parameters(key, quantity) if listed else self.parameter(key, quantity)

    def numbers(self, key: str, quantity: Quantity) -> list[float]:
        """A list of at least one number in SI."""
        example = f"[{quantity.example}, {quantity.example}]"
        values = self.need(key, example)
        if not isinstance(values, list) or not values:
            raise self.error(key, f"is no list of numbers; allowed: a list, as {example}")
        return [
            self._number(key, value, quantity, f"has a number {place} that ")
            for place, value in enumerate(values, 1)
        ]

    def number_or_list(self, key: str, quantity: Quantity) -> float | list[float]:
        """A number in SI, or a list of them."""
        listed = isinstance(self.values.get(key), list)
        return self.numbers(key, quantity) if listed else self.number(key, quantity)

    def _number(self, key: str, given: Any, quantity: Quantity, which: str = "") -> float:
        if is_uncertain(given):
            raise self.error(
                key,
                f"{which}cannot be uncertain; allowed: one number, as {quantity.example}; what "
                "describes a building or the ground can: period, damping, hardening, strength, mass, "
                "intensity",
            )
        try:
            value = in_si(given, quantity)
        except ValueError as error:
            raise self.error(key, f"{which}{error}") from error
        if not quantity.allowed.contains(value):
            shown = quantity.meant(given, value) if quantity.units == "1" else f", in {quantity.units}"
            raise self.error(key, f"{which}is out of range; allowed: {quantity.allowed}{shown}")
        if not quantity.plausible.holds(value):
            usual, meant = quantity.plausible.usually, quantity.meant(given, value)
            self.doubt(key, f"{which}is doubtful: {usual}{meant}")
        return value

    def model(self, kind: type[One], names: Sequence[str]) -> One:
        """A model from these of its parameters, which the file must have."""
        return self.made(kind, {n: self.number(n, Quantity.declared(kind, n)) for n in names})

    def described(self, kind: type[Model], names: Sequence[str]) -> Any:
        """A model as from `model`, or an uncertain model if parameters are uncertain."""
        return self.made(kind, {n: self.parameter(n, Quantity.declared(kind, n)) for n in names})

    def given(self, kind: type[Model], names: Sequence[str]) -> dict[str, float]:
        """Those of the parameters of a model that the file has, by name."""
        return {n: self.number(n, Quantity.declared(kind, n)) for n in names if n in self}

    def made(self, kind: Callable[..., One], values: Mapping[str, Any]) -> One:
        """The model with these parameters; a ValueError at the table if they cannot be combined."""
        try:
            return kind(**values)
        except ValueError as error:
            raise self.error("", f"does not fit: {error}") from error

    def text(self, key: str, choices: Sequence[str] = (), default: str | None = None) -> str:
        """A line of text, one of the choices if there are any; the default if it is missing."""
        if key not in self and default is not None:
            return default
        value = self.need(key, f'"{choices[0]}"' if choices else '"..."')
        if not is_label(value):
            of_path = f"; {BACKSLASH}" if isinstance(value, str) and not value.isprintable() else ""
            raise self.error(key, f"is no line of text; allowed: {A_LABEL}, in quotation marks{of_path}")
        if choices and value not in choices:
            said = hint(value, choices)
            raise self.error(key, f"is not known; {said}allowed: {', '.join(choices)}")
        return value

    def texts(self, key: str) -> list[str]:
        """A list of texts, also of one that is written alone."""
        values = self.need(key, '["..."]')
        if not isinstance(values, list):
            return [self.text(key)]
        return [replace(self, values={key: value}).text(key) for value in values]

    def column(self, key: str) -> str | int:
        """A column of a file: its name, or its index from 0."""
        return self.text(key) if isinstance(self.values[key], str) else self.whole(key, Whole(0))

    def truth(self, key: str, default: bool = False) -> bool:
        """A truth value; the default if it is missing."""
        value = self.values.get(key, default)
        if not isinstance(value, bool):
            raise self.error(key, "is neither true nor false; allowed: true, false")
        return value

    def whole(self, key: str, limits: Whole) -> int:
        """A whole number within the limits."""
        value = self.need(key, str(limits.lowest))
        if not limits.contains(value):
            raise self.error(key, limits.refusal(value))
        return int(value)

    def section(self, key: str, needed: bool = True) -> Section:
        """The table of this name; an empty one if it is missing and not needed."""
        return self._inner(key, self.values.get(key, None if needed else {}), (*self.place, key))

    def sections(self, key: str) -> list[Section]:
        """All tables of this name, in the order of the file; empty if there is none."""
        tables = self.values.get(key, [])
        if not isinstance(tables, list):
            name = self.name(key)
            raise self.error(key, f"is no list of tables; allowed: lines [[{name}]], keys below them")
        return [self._inner(key, table, (*self.place, key, n)) for n, table in enumerate(tables)]

    def _inner(self, key: str, values: Any, place: Place) -> Section:
        if not isinstance(values, dict):
            what = "is no table" if key in self else "is missing"
            raise self.error(key, f"{what}; allowed: a line [{self.name(key)}] and its keys below it")
        return replace(self, place=place, values=values)


def read_sections(path: Path) -> Section:
    """The whole file as one section; an OSError if it cannot be read, a ValueError if not TOML."""
    text, values = read_toml(path)
    return Section(plain(path.name), (), values, key_lines(text))


def key_lines(text: str) -> dict[Place, int]:
    """Line number, from 1, of each key and table; keys of tables within braces have none.

    The TOML parser does not provide line numbers. Messages omit a line number that is not found here.
    """
    lines: dict[Place, int] = {}
    implied: dict[Place, int] = {}  # tables that dotted names open
    counts: dict[Place, int] = {}
    table: Place = ()
    within = False  # inside of a text of several lines
    for number, line in enumerate(text.splitlines(), 1):
        header, key = _HEADER.match(line), _KEY.match(line)
        place: Place = ()
        if not within and header:
            place = table = _parts(header[2])
            if header[1] == "[[":
                counts[table] = counts.get(table, -1) + 1
                lines.setdefault(table, number)
                place = table = (*table, counts[table])
        elif not within and key:
            place = (*table, *_parts(key[1]))
        lines.setdefault(place, number)
        implied |= {place[:n]: number for n in range(1, len(place)) if place[:n] not in implied}
        if (line.count('"""') + line.count("'''")) % 2:
            within = not within
    return implied | lines


def _parts(dotted: str) -> Place:
    return tuple(part.strip("\"'") for part in re.findall(rf"{_QUOTED}|{_BARE}", dotted))
