"""Tables of a TOML file, read by forms; errors name the file, the line, the key and its value."""

from __future__ import annotations

import re
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import MISSING, dataclass, field, replace
from pathlib import Path
from typing import Any, ClassVar, TypeVar, dataclass_transform

from stochlin.applications.cases.reading.kinds import (
    TEXT,
    Inner,
    Key,
    ListOf,
    WithUnit,
    Word,
    keys_of,
)
from stochlin.files.inputs import input_path
from stochlin.files.toml import read_toml
from stochlin.messages import (
    LONGEST_MESSAGE,
    DoubtfulInput,
    as_written,
    brief,
    listed,
    nearest,
    plain,
    sentence,
)
from stochlin.models.plausible import unquestioned
from stochlin.models.uncertain import median_of
from stochlin.removed import instead_of

F = TypeVar("F", bound="Form")
M = TypeVar("M")
Place = tuple[str | int, ...]
"""Names of the tables that contain a key, and the key; numbers count tables of the same name."""
MOST_LISTED = 32
_BARE = r"[A-Za-z0-9_-]+"
_QUOTED = r"\"[^\"]*\"|'[^']*'"
_DOTTED = rf"(?:{_BARE}|{_QUOTED})(?:\s*\.\s*(?:{_BARE}|{_QUOTED}))*"
_TABLE_HEADER = re.compile(rf"\s*(\[\[?)\s*({_DOTTED})\s*\]")
_KEY = re.compile(rf"\s*({_DOTTED})\s*=")


@dataclass
class Source:
    """The file of a case with its text, the lines of its keys, and the files that it names."""

    path: Path
    text: str
    files: list[Path]

    def __post_init__(self) -> None:
        self.lines = key_lines(self.text)

    @property
    def name(self) -> str:
        """Name of the file in messages."""
        return plain(self.path.name)


@dataclass(frozen=True)
class TomlTable:
    """One table of a file, with its place."""

    source: Source = field(repr=False)
    values: Mapping[str, Any]
    place: Place = ()
    # The keys of its form, once it is read, with the length of those that take a list of so many.
    keys: Mapping[str, int] = field(default_factory=dict, repr=False, compare=False)

    def __contains__(self, name: str) -> bool:
        return name in self.values

    def called(self, name: str = "") -> str:
        """A key with the names of its tables, as ``building_1.period``."""
        parts = (part for part in (*self.place, name) if isinstance(part, str) and part)
        return ".".join(plain(part, 40) for part in parts)

    def error(self, name: str, what: str) -> ValueError:
        """The error at a key, or at the table for an empty name."""
        whole = (*self.place, name)
        lines = self.source.lines
        places = (whole[:n] for n in range(len(whole), 0, -1))
        line = next((lines[place] for place in places if place in lines), None)
        where = self.source.name if line is None else f"{self.source.name}, line {line}"
        shown = name in self and not isinstance(self.values[name], dict)
        subject = (
            f"{self.called(name)} = {brief(self.values[name])}" if shown else self.called(name)
        )
        return ValueError(f"{where}: {subject} {what}".replace(":  ", ": "))

    def warn(self, name: str, what: str) -> None:
        """Warn of a value that is allowed and implausible."""
        warnings.warn(str(self.error(name, what)), DoubtfulInput, stacklevel=2)

    @contextmanager
    def naming(
        self, name: str | None, what: str = "cannot be used: ", **called: str
    ) -> Iterator[None]:
        """Add the file, the line and the key, or the one it names, to errors inside the context.

        Arguments that an error asks for are written as keys, by the names in ``called`` if these
        differ.
        """
        try:
            yield
        except (OSError, ValueError, TypeError, ArithmeticError) as error:
            names = dict(zip(self.keys, self.keys, strict=True)) | called
            text = as_written(sentence(error, LONGEST_MESSAGE), names, self._as_key)
            if name is None:
                about = text.partition(";")[0]
                name = next(
                    (n for n in self.values if re.search(rf"\b{re.escape(n)}\b", about)), ""
                )
            raise self.error(name, f"{what}{text}") from error

    def _as_key(self, name: str, value: str | None) -> str:
        """A key with a value that Python has written, or with dots in its place."""
        dots = '"..."'
        if length := self.keys[name]:
            dots = f"[{', '.join([dots] * length)}]"
        text = (value or dots).replace("'", '"')
        return f"{name} = {text.lower() if text in ('True', 'False') else text}"

    @contextmanager
    def asking(self, name: str) -> Iterator[None]:
        """Add the file, the line and this key to warnings of doubtful input inside the context.

        They are also given before an error, which may follow from what they ask about.
        """
        caught: list[warnings.WarningMessage] = []
        try:
            with warnings.catch_warnings(record=True) as caught:
                warnings.simplefilter("always", DoubtfulInput)
                yield
        finally:
            for warning in caught:
                if issubclass(warning.category, DoubtfulInput):
                    self.warn(name, f"is doubtful: {warning.message}")
                else:
                    warnings.warn_explicit(
                        warning.message, warning.category, warning.filename, warning.lineno
                    )

    def table(self, name: str, *number: int, forms: Sequence[type[Form]] = ()) -> TomlTable:
        """The table of this name, of several that of a number; an empty one if there is none."""
        values = self.values.get(name, {})
        for n in number:
            values = values[n]
        if not isinstance(values, dict):
            below = f"a line [{self.called(name)}], keys below it"
            raise self.error(
                name, f"is no table; allowed: {_as_table(name, values, forms) or below}"
            )
        return replace(self, values=values, place=(*self.place, name, *number))

    def paths(self, name: str, texts: Sequence[str]) -> list[Path]:
        """The paths of files that the case names, relative to its own file."""
        if not self.source.files:
            raise self.error(name, "names a file; allowed in case files alone, not in a dictionary")
        with self.naming(name):
            paths = [input_path(name, self.source.path.parent / text) for text in texts]
        self.source.files.extend(paths)
        return paths

    def path(self, name: str) -> Path:
        """The path of one file."""
        return self.paths(name, [self.value(name, TEXT)])[0]

    def value(self, name: str, kind: Any) -> Any:
        """The value of a key, numbers in SI."""
        if isinstance(kind, Inner):
            if not kind.several:
                table = self.table(name, forms=kind.forms)
                return table if kind.later else table.read(*kind.forms)
            if not isinstance(self.values[name], list):
                raise self.error(
                    name, f"is no list of tables; allowed: lines [[{self.called(name)}]]"
                )
            places = range(len(self.values[name]))
            return [self.table(name, n, forms=kind.forms).read(*kind.forms) for n in places]
        with self.naming(name, ""):
            return kind.read(self.values[name], lambda what: self.warn(name, what))

    def fitting(self, forms: Sequence[type[F]]) -> type[F]:
        """The form that has most of the keys of the table."""
        return max(forms, key=lambda form: len(form.keys(self).keys() & self.values.keys()))

    def read(self, *forms: type[F]) -> F:
        """The table as a form: of several forms, the one that has most of its keys."""
        form = self.fitting(forms)
        keys = form.keys(self)
        for name in self.values:
            if name in keys and isinstance(keys[name].kind, Word):  # on which the other keys depend
                self.value(name, keys[name].kind)
        for name in self.values:
            if name not in keys:
                raise self._unknown(name, form, keys)
        self._check_together(form)
        missing = [n for n, key in keys.items() if key.default is MISSING and n not in self]
        if missing:
            also = f" (and also {listed(missing[1:])})" if missing[1:] else ""
            raise self.error(
                missing[0], f"is missing{also}; allowed: {keys[missing[0]].kind.words}"
            )
        values = {n: self.value(n, key.kind) for n, key in keys.items() if n in self}
        more = {n: values.pop(n) for n in [*values] if n not in keys_of(form)}
        kinds = {n: key.kind for n, key in keys.items()}
        lengths = {
            n: (kind.length or 0) if isinstance(kind, ListOf) else 0 for n, kind in kinds.items()
        }
        return form(table=replace(self, keys=lengths), more=more, **values)

    @unquestioned()
    def made(self, build: Callable[..., M], /, **values: Any) -> M:
        """A model of these values; its error is at the key that it names."""
        with self.naming(None, "does not fit: "):
            return build(**values)

    def asked(self, model: M) -> M:
        """The model, with a warning of what follows from its parameters and is implausible."""
        for text in median_of(model).doubts():
            self.warn("", f"is doubtful: {text}")
        return model

    def _unknown(self, name: str, form: type[Form], keys: Mapping[str, Key]) -> ValueError:
        names = [key for key in keys if key not in self]
        for key, declared in keys.items():  # also those of tables below this one
            for inner in getattr(declared.kind, "forms", ()):
                names += [f"{key}.{below}" for below in inner.keys(self)]
        near = nearest(name, names)
        said = instead_of(name) or (f"did you mean {near}? " if near else "")
        what = "is not a key that is known here"
        if form.described_as:
            what += f", of {form.described_as}"
        return self.error(name, f"{what}; {said}allowed: {listed(keys, MOST_LISTED)}")

    def _check_together(self, form: type[Form]) -> None:
        """Raise a ValueError for keys that exclude or need one another."""
        chosen = [name for name, value in self.values.items() if value is not False]
        for what, names in form.one_of.items():
            present = [name for name in names if name in chosen]
            allowed = f"; allowed: one of {', '.join(names)}"
            if len(present) > 1:
                raise self.error(present[1], f"is given as well as {present[0]}{allowed}")
            if what and not present:
                raise self.error("", f"has no {what}{allowed}")
        for name, other in form.goes_with:
            if name in chosen and other not in chosen:
                raise self.error(
                    name, f"needs {other}, which is missing; allowed: both, or neither"
                )


@dataclass_transform(frozen_default=True, kw_only_default=True)
@dataclass(frozen=True, kw_only=True)
class Form:
    """Base of the forms, which are dataclasses: what a table of a case file says, numbers in SI.

    ``more`` are the parameters of the model that the table names, such as its hysteresis law.
    """

    described_as: ClassVar[str] = ""  # in messages
    # What exactly one of these keys gives; of those without such a name there may be none.
    one_of: ClassVar[Mapping[str, Sequence[str]]] = {}
    goes_with: ClassVar[Sequence[tuple[str, str]]] = ()  # a key, and the one that it needs

    table: TomlTable = field(compare=False, repr=False)
    more: Mapping[str, Any] = field(default_factory=dict)

    def __init_subclass__(cls) -> None:
        """Make each form a dataclass."""
        dataclass(frozen=True, kw_only=True)(cls)

    @classmethod
    def keys(cls, table: TomlTable) -> dict[str, Key]:
        """The keys of the form, with those of the models that the table names."""
        return keys_of(cls)

    def values_of(self, *names: str) -> dict[str, Any]:
        """The values of these keys as far as the table has them."""
        return {name: getattr(self, name) for name in names if name in self.table}

    def chosen(self, what: str) -> str:
        """The key of ``one_of`` that the table has."""
        names = self.one_of[what]
        return next(name for name in names if self.table.values.get(name, False) is not False)


def _as_table(name: str, written: Any, forms: Sequence[type[Form]]) -> str:
    """A table with what stands in its place, if one of its numbers can be that; else nothing."""
    keys = {n: accepted.kind for form in forms for n, accepted in form.keys(NO_TABLE).items()}
    fitting = []
    for key, kind in keys.items():
        with suppress(ValueError):
            if isinstance(kind, WithUnit) and isinstance(written, str):
                kind.read(written, lambda _: None)
                fitting.append(key)
    return f'{name} = {{ {fitting[0]} = "{written}" }}' if len(fitting) == 1 else ""


def read_table(path: Path, other: str | None = None) -> TomlTable:
    """The whole file as a table, or another text in its place; errors are those of `read_toml`."""
    text, values = read_toml(path, other)
    return TomlTable(Source(path, text, [path]), values)


def key_lines(text: str) -> dict[Place, int]:
    """Line number, from 1, of each key and table; messages omit one that is not here.

    The TOML parser does not provide them.
    """
    lines: dict[Place, int] = {}
    counts: dict[Place, int] = {}
    table: Place = ()
    for number, line in enumerate(text.splitlines(), 1):
        if header := _TABLE_HEADER.match(line):
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


NO_TABLE = TomlTable(Source(Path("case.toml"), "", []), {})  # an empty one, of no file
