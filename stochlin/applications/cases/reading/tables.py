"""Tables of a TOML file, read by forms; errors name the file, the line, the key and its value."""

from __future__ import annotations

import re
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, ClassVar, TypeVar

from stochlin.applications.cases.reading.kinds import TEXT, Inner, Key, Word, keys_of
from stochlin.messages import LONGEST_MESSAGE, DoubtfulInput, brief, listed, nearest, plain, sentence
from stochlin.removed import instead_of
from stochlin.solver.tables.inputs import input_path
from stochlin.solver.tables.toml import read_toml

F = TypeVar("F", bound="Form")
Place = tuple[str | int, ...]
"""Names of the tables that contain a key, and the key; numbers count tables of the same name."""
MOST_LISTED = 32
_BARE, _QUOTED = r"[A-Za-z0-9_-]+", r"\"[^\"]*\"|'[^']*'"
_DOTTED = rf"(?:{_BARE}|{_QUOTED})(?:\s*\.\s*(?:{_BARE}|{_QUOTED}))*"
_HEADER = re.compile(rf"\s*(\[\[?)\s*({_DOTTED})\s*\]")
_KEY = re.compile(rf"\s*({_DOTTED})\s*=")
EXAMPLES = {  # of values, in place of those that units and ranges give
    **dict.fromkeys(("reduction_factor", "ductility"), "4"),
    "base_shear_coefficient": "0.15",
    "confidence": '"90 %"',
    "floor_mass": '"400 t"',
    "intensity": '"0.01 m^2/s^3", or pga = "0.3 g", or sa = "0.8 g" with sa_period = "1 s"',
    "participation": "1.3",
    "masses": '["800 t", "600 t"]',
    "pushover": '"push.csv"',
    "stiffnesses": '["1200 MN/m", "1000 MN/m"]',
    "storey_height": '"3.2 m"',
    "storeys": "8",
}


@dataclass
class Source:
    """The file of a case: lines of its keys, files that it names, and warnings that were given."""

    path: Path
    lines: Mapping[Place, int]
    flat: bool = False  # whether files are looked for without their folders, too
    files: list[Path] = field(default_factory=list)
    warned: set[Place] = field(default_factory=set)

    @property
    def name(self) -> str:
        """Name of the file in messages."""
        return plain(self.path.name)


@dataclass(frozen=True)
class Table:
    """One table of a file, with its place."""

    source: Source = field(repr=False)
    values: Mapping[str, Any]
    place: Place = ()

    def __contains__(self, name: str) -> bool:
        return name in self.values

    def called(self, name: str = "") -> str:
        """A key with the names of its tables, as ``building_1.period``."""
        parts = (part for part in (*self.place, name) if isinstance(part, str) and part)
        return ".".join(plain(part, 40) for part in parts)

    def error(self, name: str, what: str) -> ValueError:
        """The error at a key, or at the table for an empty name."""
        whole, lines = (*self.place, name), self.source.lines
        places = (whole[:n] for n in range(len(whole), 0, -1))
        line = next((lines[place] for place in places if place in lines), None)
        where = self.source.name if line is None else f"{self.source.name}, line {line}"
        shown = name in self and not isinstance(self.values[name], dict)
        subject = f"{self.called(name)} = {brief(self.values[name])}" if shown else self.called(name)
        return ValueError(f"{where}: {subject} {what}".replace(":  ", ": "))

    def warn(self, name: str, what: str) -> None:
        """Warn, once in the same words, of a value that is allowed and implausible."""
        if (*self.place, name, what) not in self.source.warned:
            self.source.warned.add((*self.place, name, what))
            warnings.warn(str(self.error(name, what)), DoubtfulInput, stacklevel=2)

    @contextmanager
    def naming(self, name: str, what: str = "cannot be used") -> Iterator[None]:
        """Add the file, the line and the key to errors and warnings of the work inside the context."""
        try:
            with warnings.catch_warnings(record=True) as caught:
                warnings.simplefilter("always", DoubtfulInput)
                yield
        except (OSError, ValueError, ArithmeticError) as error:
            if str(error).startswith(self.source.name):
                raise
            raise self.error(name, f"{what}: {sentence(error, LONGEST_MESSAGE)}") from error
        placed = any(str(warning.message).startswith(self.source.name) for warning in caught)
        for warning in caught:
            text = str(warning.message)
            if not issubclass(warning.category, DoubtfulInput) or text.startswith(self.source.name):
                warnings.warn_explicit(text, warning.category, warning.filename, warning.lineno)
            elif not placed:  # else a number of it was warned of with its key
                self.warn(name, f"is doubtful: {text}")

    def table(self, name: str) -> Table:
        """The table of this name; an empty one if there is none."""
        return self._inner(self.values.get(name, {}), name, (*self.place, name))

    def tables(self, name: str) -> list[Table]:
        """All tables of this name, in the order of the file."""
        values = self.values.get(name, [])
        if not isinstance(values, list):
            called = self.called(name)
            raise self.error(name, f"is no list of tables; allowed: lines [[{called}]], keys below them")
        return [self._inner(each, name, (*self.place, name, n)) for n, each in enumerate(values)]

    def _inner(self, values: Any, name: str, place: Place) -> Table:
        if not isinstance(values, dict):
            called = self.called(name)
            raise self.error(name, f"is no table; allowed: a line [{called}] and its keys below it")
        return replace(self, values=values, place=place)

    def text(self, name: str) -> str:
        """A line of text; an empty one if it is missing."""
        return self.value(name, TEXT) if name in self else ""

    def path(self, name: str) -> Path:
        """The path of a file that the case names."""
        return self.paths(name, [self.text(name)])[0]

    def paths(self, name: str, texts: Sequence[str]) -> list[Path]:
        """The paths of files that the case names, relative to its own file."""
        folder = self.source.path.parent
        paths = [folder / text for text in texts]
        with self.naming(name):
            if self.source.flat:
                within = (".." not in path.parts and path.is_relative_to(folder) for path in paths)
                named = zip(paths, within, strict=True)
                paths = [
                    path if known and path.exists() else folder / path.name for path, known in named
                ]
            self.source.files.extend(paths)
            return [input_path(name, path) for path in paths]

    def value(self, name: str, kind: Any) -> Any:
        """The value of a key, numbers in SI."""
        if isinstance(kind, Inner):
            return self.tables(name) if kind.several else self.table(name)
        try:
            return kind.read(self.values[name], lambda what: self.warn(name, what))
        except ValueError as error:
            raise self.error(name, str(error)) from error

    def fitting(self, forms: Mapping[type[F], Mapping[str, Key]]) -> type[F]:
        """Of forms with their keys, the one that has most of the keys of the table."""
        return max(forms, key=lambda form: len(forms[form].keys() & self.values.keys()))

    def read(self, *forms: type[F]) -> F:
        """The table as a form: of several forms, the one that has most of its keys."""
        each_keys = {form: form.keys(self) for form in forms}
        form = self.fitting(each_keys)
        keys = each_keys[form]
        others = {name for known in each_keys.values() for name in known}
        for name in self.values:
            if name in keys and isinstance(keys[name].kind, Word):  # on which the other keys depend
                self.value(name, keys[name].kind)
        for name in self.values:
            if name not in keys:
                raise self._unknown(name, form, keys, others)
        self._check_together(form)
        if missing := {name: k for name, k in keys.items() if k.needed and name not in self}:
            raise self.missing(missing)
        values = {n: self.value(n, each.kind) for n, each in keys.items() if n in self}
        of_form = keys_of(form)
        more = {n: values.pop(n) for n in [*values] if n not in of_form}
        return form(table=self, more=more, **values)

    def missing(self, keys: Mapping[str, Key]) -> ValueError:
        """The error for missing keys, with an example of each."""
        first, *others = keys
        more = f", and so {'is' if len(others) == 1 else 'are'} {listed(others)}" if others else ""
        return self.error(first, f"is missing{more}; write, for instance, {_examples(keys)}")

    def made(self, build: Callable[..., Any], /, **values: Any) -> Any:
        """A model of these values; its error is at the key that it names."""
        try:
            return build(**values)
        except (ValueError, TypeError) as error:
            text = str(error)
            named = (n for n in self.values if re.search(rf"\b{re.escape(n)}\b", text.partition(";")[0]))
            raise self.error(next(named, ""), f"does not fit: {text}") from error

    def _unknown(
        self, name: str, form: type[Form], keys: Mapping[str, Key], others: set[str]
    ) -> ValueError:
        if elsewhere := form.elsewhere(self, name):
            return self.error(name, elsewhere)
        near = "" if name in others else nearest(name, [*keys, *others])
        beside = ", which is given as well" if near in self else ""
        said = instead_of(name) or (f"did you mean {near}{beside}? " if near else "")
        what = "is not a key that is known here" + f", of {form.described_as}" * bool(form.described_as)
        return self.error(name, f"{what}; {said}allowed: {listed(keys, MOST_LISTED)}")

    def _check_together(self, form: type[Form]) -> None:
        """Raise a ValueError for keys that exclude or need one another."""
        chosen = [name for name, value in self.values.items() if value is not False]
        for names, needed in [(form.one_of, True), *((names, False) for names in form.at_most)]:
            present = [name for name in names if name in chosen]
            if len(present) > 1:
                what = f"is given as well as {present[0]}; allowed: one of {', '.join(names)}"
                raise self.error(present[1], f"{what}, so leave the others out")
            if names and needed and not present:
                examples = _examples({name: keys_of(form)[name] for name in names})
                raise self.error("", f"has no {form.one_called}; allowed: one of {examples}")
        for name, other in form.goes_with:
            if name in chosen and not {other} & {*chosen}:
                what = f"goes with {other}, which is missing; give both, or leave it out"
                raise self.error(name, what)


@dataclass(frozen=True, kw_only=True)
class Form:
    """Base of the forms: what a table of a case file says, numbers in SI.

    ``more`` are the parameters of the model that the table names, such as its hysteresis law.
    """

    described_as: ClassVar[str] = ""  # in messages
    one_of: ClassVar[Sequence[str]] = ()  # of these keys a table has exactly one
    one_called: ClassVar[str] = ""  # what that one gives
    at_most: ClassVar[Sequence[Sequence[str]]] = ()  # of each of these keys it has at most one
    goes_with: ClassVar[Sequence[tuple[str, str]]] = ()  # a key, and the one that it needs

    table: Table = field(compare=False, repr=False)
    more: Mapping[str, Any] = field(default_factory=dict)

    @classmethod
    def keys(cls, table: Table) -> dict[str, Key]:
        """The keys of the form, with those of the models that the table names."""
        return keys_of(cls)

    @classmethod
    def elsewhere(cls, table: Table, name: str) -> str:
        """What is wrong with a key that the form does not have, if it belongs to another one."""
        return ""

    def given(self, *names: str) -> dict[str, Any]:
        """The values of these keys as far as the table has them."""
        return {name: getattr(self, name) for name in names if name in self.table}

    def missing(self, name: str) -> ValueError:
        """The error for a key without which the others say nothing."""
        return self.table.missing({name: keys_of(type(self))[name]})

    def chosen(self) -> str:
        """The key of ``one_of`` that the table has."""
        return next(name for name in self.one_of if self.table.values.get(name, False) is not False)


def _examples(keys: Mapping[str, Key]) -> str:
    return ", ".join(f"{name} = {EXAMPLES.get(name, key.kind.example)}" for name, key in keys.items())


def read_table(path: Path, other: str | None = None) -> Table:
    """The whole file as one table, or another text in its place; errors are those of `read_toml`."""
    text, values = read_toml(path, other)
    return Table(Source(path, key_lines(text), other is not None, [path]), values)


def key_lines(text: str) -> dict[Place, int]:
    """Line number, from 1, of each key and table; messages omit one that is not here.

    The TOML parser does not provide them. A text of several lines is passed over.
    """
    lines: dict[Place, int] = {}
    counts: dict[Place, int] = {}
    table: Place = ()
    passed = re.sub(r'(?s)""".*?"""|\'\'\'.*?\'\'\'', lambda text: "\n" * text[0].count("\n"), text)
    for number, line in enumerate(passed.splitlines(), 1):
        if header := _HEADER.match(line):
            place = table = _parts(header[2])
            if header[1] == "[[":
                counts[table] = counts.get(table, -1) + 1
                table = (*table, counts[table])
                lines.setdefault(table, number)
        elif key := _KEY.match(line):
            place = (*table, *_parts(key[1]))
        else:
            continue
        for n in range(1, len(place) + 1):  # dotted names open tables
            lines.setdefault(place[:n], number)
    return lines


def _parts(dotted: str) -> Place:
    return tuple(part.strip("\"'") for part in re.findall(rf"{_QUOTED}|{_BARE}", dotted))
