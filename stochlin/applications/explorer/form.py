"""The form of the explorer: keys of a case file with their values, and the file with other ones."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from contextlib import suppress
from importlib.resources import files
from types import MappingProxyType
from typing import Any, NamedTuple

from stochlin.applications.cases.reading.buildings import Oscillator, Regular
from stochlin.applications.cases.reading.case import NUMBERED
from stochlin.applications.cases.reading.explained import form_of_table, table_of
from stochlin.applications.cases.reading.kinds import (
    FROM_TO,
    NUMBER,
    TRUTH,
    Key,
    Kind,
    ListOf,
    Quantity,
    Word,
)
from stochlin.applications.cases.reading.site import CODES, NONE, ByParameters, Motion, grounds
from stochlin.applications.cases.reading.tables import Form, key_lines
from stochlin.models.envelopes import ENVELOPES
from stochlin.solver.tables.toml import toml_tables, toml_text

Tables = Mapping[str, Any]
"""The tables of a case file by their names."""

SHOWN = "site", "motion", "building", "separation"  # on which the gap depends
ALWAYS = {"separation": ["existing"]}  # keys that are shown where the file does not have them
AS_IN_FILE = "as in the file"
TIMES = 4.0  # a slider goes from the value over this to the value times this
STEP = 0.025  # of a slider: a power of that number
WRITTEN = re.compile(r'[^=#]*=\s*("[^"]*"|\[[^\]]*\]|[^\s#]+)')  # a key and its value in a line


class Entry(NamedTuple):
    """A key of a table, and its value as the file has it; None where it does not have it."""

    table: str
    name: str
    key: Key
    value: Any

    @property
    def text(self) -> str:
        """The value as it is written in a file, a text without its quotation marks."""
        value = self.value
        return value if isinstance(value, str) else "" if value is None else json.dumps(value)

    def read(self, text: str) -> Any:
        """The value of a text that is written so; None for an empty one."""
        with suppress(ValueError, RecursionError):
            value = json.loads(text)
            values = value if isinstance(value, list) else [value]
            if all(isinstance(each, (float, int, str)) for each in values):
                return value
        return text.strip() or None

    def slid(self, at: float) -> Any:
        """The value times `TIMES` to a power from -1 to 1, in its unit."""
        written = NUMBER.fullmatch(str(self.value))
        if at == 0 or written is None or FROM_TO.fullmatch(str(self.value)):
            return self.value
        number = float(written[1]) * TIMES**at
        shown = f"{float(f'{number:.3g}'):g}" if isinstance(self.key.kind, Quantity) else f"{number:.0f}"
        return self.read(f"{shown}{written[2]}")

    def reach(self) -> tuple[float, float] | None:
        """Lowest and highest power for which the key accepts the value; None if it has no slider."""
        reached = {}
        for at in (number * STEP for number in range(-round(1 / STEP), round(1 / STEP) + 1)):
            with suppress(ValueError):
                self.key.kind.read(self.slid(at), lambda warning: None)
                reached[at] = str(self.slid(at))
        return (min(reached), max(reached)) if len({*reached.values()}) > 2 else None


class Way(NamedTuple):
    """A way to write a table: its form, keys that it has as well, and values that choose it."""

    form: type[Form]
    also: tuple[str, ...] = ()
    values: Tables = MappingProxyType({})


class Choice(NamedTuple):
    """A choice between several ways to write a table, and the present one."""

    table: str
    name: str
    label: str
    ways: Mapping[str, Way]
    present: str


_OF_STOREYS = ("storeys", "storey_height")
BUILDINGS = {
    "oscillator, reduction factor": Way(Oscillator, ("reduction_factor", "hardening")),
    "oscillator, yield displacement": Way(Oscillator, ("yield_displacement", "hardening")),
    "oscillator, ductility": Way(Oscillator, ("ductility", "hardening")),
    "oscillator, elastic": Way(Oscillator, ("elastic",)),
    "equal storeys": Way(Regular, (*_OF_STOREYS, "base_shear_coefficient", "hardening")),
    "equal storeys, elastic": Way(Regular, (*_OF_STOREYS, "elastic")),
}


def form_of(tables: Tables) -> Iterator[tuple[str, list[Choice], list[Entry]]]:
    """Titles of the tables on which the gap depends, with their choices and entries."""
    for name, table in tables.items():
        if _kind(name) in SHOWN and isinstance(table, dict):
            form, keys = form_of_table(_kind(name), table)
            called = f": {table['name']}" if "name" in table else ""
            choices = [
                Choice(name, each, label, {**ways, present: ways.get(present, Way(form))}, present)
                for each, label, ways, present in _choices(_kind(name), table, form, keys)
            ]
            title = f"{name.replace('_', ' ').capitalize()}{called}"
            yield title, choices, list(_entries(name, table, keys))


def _kind(name: str) -> str:
    """The name of a table in tables of keys."""
    return "building" if NUMBERED.fullmatch(name) else name


def _entries(name: str, table: Tables, keys: Mapping[str, Key]) -> Iterator[Entry]:
    """Numbers, lists of numbers and truth values that the table has."""
    for each in dict.fromkeys([*table, *ALWAYS.get(name, ())]):
        kind = keys[each].kind if each in keys else None
        of_all = kind.kind if isinstance(kind, ListOf) else kind
        whole = isinstance(of_all, Kind) and of_all.example.isdigit()
        if whole or of_all is TRUTH or isinstance(of_all, Quantity):
            yield Entry(name, each, keys[each], table.get(each))


def _choices(
    kind: str, table: Tables, form: type[Form], keys: Mapping[str, Key]
) -> Iterator[tuple[str, str, Mapping[str, Way], str]]:
    """How the table is written, and words that it has: key, label, ways and the present one of each."""
    if kind == "site":
        ways = {each: Way(ByParameters, ("intensity",), {"ground": each}) for each in grounds()}
        ways |= {code: Way(of_code, (), {"spectrum": code}) for code, of_code in CODES.items()}
        yield "ground", "Ground", ways, str(table.get("spectrum", table.get("ground")))
    elif kind == "motion":
        ways = {each: Way(Motion, (), {"envelope": each}) for each in [*ENVELOPES, NONE]}
        yield "envelope", "Envelope", ways, str(table.get("envelope", NONE))
    elif kind == "building":
        strength = next((each for each in form.one_of if table.get(each, False) is not False), "")
        fitting = (each for each, way in BUILDINGS.items() if way.form is form and strength in way.also)
        yield "", "Described as", BUILDINGS, next(fitting, AS_IN_FILE)
    for each, key in keys.items():
        if isinstance(key.kind, Word) and each in table and each not in ("ground", "envelope"):
            ways = {word: Way(form, (), {each: word}) for word in key.kind.words.split(", ")}
            yield each, key.about, ways, str(table[each])


def chosen(tables: Tables, choice: Choice, option: str) -> dict[str, Any]:
    """The tables with one of them written in another way; numbers that stay keep their values."""
    form, also, values = choice.ways[option]
    table = {**tables[choice.table], **values}
    keys = form.keys(table_of(table))
    others = {*form.one_of} - {*also} if {*form.one_of} & {*also} else ()
    changed = {name: value for name, value in table.items() if name in keys and name not in others}
    for name in [*(name for name, key in keys.items() if key.needed), *also]:
        instead = (other for names in form.at_most if name in names for other in names)
        if not any(other in changed for other in (name, *instead)):
            changed[name] = _usual(choice.table, name, keys[name])
    return {**tables, choice.table: changed}


def _usual(table: str, name: str, key: Key) -> Any:
    """A value with which a key can begin."""
    text = files("stochlin.applications.explorer").joinpath("usual.toml").read_text("utf-8")
    usual = toml_tables(text)[_kind(table)]
    return usual[name] if name in usual else json.loads(key.kind.example)


def changed_text(text: str, entry: Entry) -> str:
    """The text of a case file with the value of an entry, or without its key for None.

    Only the line of the key changes, so that comments stay; where this is not possible, all is written
    anew.
    """
    tables, line = toml_tables(text), key_lines(text).get((entry.table, entry.name))
    others = {name: old for name, old in tables[entry.table].items() if name != entry.name}
    if entry.value is None:
        return toml_text({**tables, entry.table: others})
    wanted = {**tables, entry.table: {**others, entry.name: entry.value}}
    if line is not None:
        lines, written = text.splitlines(), toml_text({entry.name: entry.value}).strip()
        lines[line - 1] = WRITTEN.sub(lambda _: written, lines[line - 1], count=1)
        changed = "\n".join(lines) + "\n"
        with suppress(ValueError):
            if toml_tables(changed) == wanted:
                return changed
    return toml_text(wanted)
