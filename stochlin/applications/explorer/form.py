"""The form of the explorer: values of a case file, and the file with other ones."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import MISSING, replace
from itertools import islice
from typing import Any, NamedTuple

from stochlin.applications.cases.reading.case import NUMBERED, forms_of
from stochlin.applications.cases.reading.kinds import (
    FROM_TO,
    NUMBER_AND_UNIT,
    TRUTH,
    Integer,
    Key,
    ListOf,
    WithUnit,
    Word,
)
from stochlin.applications.cases.reading.site import FITTED
from stochlin.applications.cases.reading.tables import NO_TABLE, Place, key_lines
from stochlin.files.toml import toml_tables
from stochlin.messages import plain

# besides the buildings, tables on which the gap depends
SHOWN_TABLES = "site", "motion", "separation"
SLIDER_FACTOR = 4.0  # a slider goes from the value over this to the value times this
MOST_TABLES = 32  # with fields; the others are in the text of the file alone
LONGEST_ENTRY = 1000  # characters of a line with an entry
LONGEST_TITLE = 60  # characters of a name in a title
SLIDER_STEP = 0.025  # of a slider: a power of that number
WRITTEN = re.compile(r'[^=#]*=\s*("[^"]*"|\[[^\]]*\]|[^\s#]+)')  # a key and its value in a line


class FormEntry(NamedTuple):
    """A key of a table and its value, and the words among which it can be chosen."""

    table: str
    name: str
    key: Key
    value: Any
    words: Sequence[str] = ()

    @property
    def text(self) -> str:
        """The value as it is written in a file, a text without its quotation marks."""
        return self.value if isinstance(self.value, str) else json.dumps(self.value)

    def read(self, text: str) -> Any:
        """The value of a text that is written so."""
        with suppress(ValueError, RecursionError):
            value = json.loads(text)
            values = value if isinstance(value, list) else [value]
            if all(isinstance(item, (float, int, str)) for item in values):
                return value
        return text.strip()

    def slid(self, at: float) -> Any:
        """The value times `SLIDER_FACTOR` to a power from -1 to 1, in its unit."""
        written = NUMBER_AND_UNIT.fullmatch(str(self.value))
        if at == 0 or written is None or FROM_TO.fullmatch(str(self.value)):
            return self.value
        number = float(written[1]) * SLIDER_FACTOR**at
        shown = (
            f"{float(f'{number:.3g}'):g}"
            if isinstance(self.key.kind, WithUnit)
            else f"{number:.0f}"
        )
        return self.read(f"{shown}{written[2]}")

    def reach(self) -> tuple[float, float] | None:
        """Lowest and highest power whose value the key accepts; None if it has no slider."""
        reached = {}
        steps = round(1 / SLIDER_STEP)
        for at in (number * SLIDER_STEP for number in range(-steps, steps + 1)):
            with suppress(ValueError):
                self.key.kind.read(self.slid(at), lambda warning: None)
                reached[at] = str(self.slid(at))
        return (min(reached), max(reached)) if len({*reached.values()}) > 2 else None


class Lines(NamedTuple):
    """The lines of a text, and the numbers, from 1, of those with its keys."""

    texts: Sequence[str]
    numbers: Mapping[Place, int]

    @classmethod
    def of(cls, text: str) -> Lines:
        """The lines of a case file."""
        return cls(text.splitlines(), key_lines(text))

    def line_of(self, table: str, name: str, value: Any) -> int:
        """Number of the line that has a key and its whole value; 0 if there is no such line."""
        number = self.numbers.get((table, name), 0)
        written = self.texts[number - 1]
        with suppress(ValueError):
            if number and len(written) <= LONGEST_ENTRY and toml_tables(written) == {name: value}:
                return number
        return 0


def form_of(text: str) -> Iterator[tuple[str, list[FormEntry]]]:
    """Titles of the tables on which the gap depends, with the values that they have."""
    tables = toml_tables(text)  # which refuses what takes too long to be read
    lines = Lines.of(text)
    shown = (name for name in tables if name in SHOWN_TABLES or NUMBERED.fullmatch(name))
    for name in islice(shown, MOST_TABLES):
        table = tables[name]
        if isinstance(table, dict):
            called = f": {plain(table['name'], LONGEST_TITLE)}" if "name" in table else ""
            yield (
                f"{name.replace('_', ' ').capitalize()}{called}",
                list(_entries(name, table, lines)),
            )


def _entries(name: str, table: Mapping[str, Any], lines: Lines) -> Iterator[FormEntry]:
    """Words, numbers, lists of numbers and truth values of a table."""
    keys = _keys(name, table)
    for key, value in ((key, value) for key, value in table.items() if key in keys):
        accepted = keys[key].kind
        of_all = accepted.kind if isinstance(accepted, ListOf) else accepted
        number = isinstance(of_all, (Integer, WithUnit))
        words = _words(name, table, key, accepted) if isinstance(accepted, Word) else []
        chosen = isinstance(value, str) and value in words and len(words) > 1
        if (number or of_all is TRUTH or chosen) and lines.line_of(name, key, value):
            yield FormEntry(name, key, keys[key], value, words)


def _keys(name: str, values: Mapping[str, Any]) -> Mapping[str, Key]:
    """The keys that a table with these values accepts."""
    table = replace(NO_TABLE, values=values)
    return table.fitting(forms_of("building_1" if NUMBERED.fullmatch(name) else name)).keys(table)


def _words(table: str, values: Mapping[str, Any], name: str, accepted: Word) -> list[str]:
    """The words of a key with which the other keys of its table are all that it needs."""
    fitting = []
    for word in (word for word in accepted.allowed if word != FITTED):  # which has other keys
        keys = _keys(table, {**values, name: word})
        needed = {n for n, key in keys.items() if key.default is MISSING}
        if needed <= values.keys() <= keys.keys():
            fitting.append(word)
    return fitting


def changed_text(text: str, entry: FormEntry) -> str:
    """The text of a case file with the value of an entry; only its line changes, comments stay."""
    value = toml_tables(text)[entry.table][entry.name]
    lines = Lines.of(text)
    changed = list(lines.texts)
    at = lines.line_of(entry.table, entry.name, value) - 1
    written = f"{entry.name} = {json.dumps(entry.value, ensure_ascii=False)}".replace(
        "\x7f", r"\u007f"
    )
    changed[at] = WRITTEN.sub(lambda _: written, changed[at], count=1)
    return "\n".join(changed) + "\n"
