"""The form of the explorer: entries for keys of a case file, and its text with other values."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from contextlib import suppress
from typing import Any, NamedTuple

from stochlin.analyses.cases.buildings import MOST_BUILDINGS
from stochlin.analyses.cases.files.keys import NEEDED, Key, declared
from stochlin.analyses.cases.files.quantities import NUMBER, Quantity, in_si
from stochlin.analyses.cases.files.schema import ASCE_7, EUROCODE_8, OSCILLATOR, REGULAR, keys_at
from stochlin.analyses.cases.files.sections import key_lines
from stochlin.analyses.cases.site import NONE
from stochlin.analyses.tables.toml import toml_tables, toml_text
from stochlin.models.arguments import Whole
from stochlin.models.envelopes import ENVELOPES
from stochlin.models.grounds import GROUNDS
from stochlin.models.grounds.named import ground_names
from stochlin.models.parameters import Model
from stochlin.models.structures import LAWS

Tables = Mapping[str, Any]
"""The tables of a case file by their names."""

EMPTY_TOO = {("separation", "existing")}  # keys that have an entry where the file does not have them
CODES = (EUROCODE_8, ASCE_7)
STRENGTHS = ("intensity", "pga", "sa", "sa_period", "return_period")  # of a ground
NOT_OF_GROUNDS = ("records", "suite", "hazard")  # keys of a site that go with any ground
STARTS = {"floor_mass": "400 t", "soil": "C"}  # of keys without a slider
_OSCILLATOR = ("period", "damping", "name", "system", "storeys", "height", "mass")
_STOREYS = ("period", "damping", "name", "system", "storeys", "storey_height", "floor_mass")
OPTIONAL = ("name", "system", "height", "mass")
# Ways to describe a building that can be chosen, with the keys that it then has.
BUILDINGS: Mapping[str, tuple[str, ...]] = {
    "oscillator, R": (*_OSCILLATOR, "reduction_factor", "hardening"),
    "oscillator, yield displacement": (*_OSCILLATOR, "yield_displacement", "hardening"),
    "oscillator, elastic": (*_OSCILLATOR, "elastic"),
    "regular storeys": (*_STOREYS, "base_shear_coefficient", "hardening"),
    "regular storeys, elastic": (*_STOREYS, "elastic"),
}
AS_IN_FILE = "as in the file"


class Entry(NamedTuple):
    """A key of a table, and its value as the file has it; None where it does not have it."""

    table: str
    key: Key
    value: Any

    @property
    def text(self) -> str:
        """The value as an entry shows it."""
        values = self.value if isinstance(self.value, list) else [self.value]
        return ", ".join("" if value is None else str(value) for value in values)

    def read(self, text: str) -> Any:
        """The value that a text means, written as in a file; None for an empty text."""
        if isinstance(self.value, list):
            return [self._number_or_text(part) for part in text.split(",")]
        return self._number_or_text(text) if text.strip() else None

    def _number_or_text(self, text: str) -> Any:
        kind, text = self.key.kind, text.strip()
        if isinstance(kind, Whole) or (isinstance(kind, Quantity) and kind.units == "1"):
            for number in (int, float):
                with suppress(ValueError):
                    return number(text)
        return text

    @property
    def at(self) -> float | None:
        """Where the slider of the key stands; None if it cannot show the value."""
        kind = self.key.kind
        if self.key.slider is None or isinstance(self.value, list):
            return None
        try:
            return (
                in_si(self.value, kind) / self.key.unit_size
                if isinstance(kind, Quantity)
                else self.value
            )
        except ValueError:  # an uncertain value, or one that is not valid
            return None

    def slid(self, at: float) -> str:
        """The text of a number of the slider, in the unit that the value has."""
        assert self.key.slider is not None
        written = NUMBER.fullmatch(self.value) if isinstance(self.value, str) else None
        unit = written[2].strip() if written else self.key.slider.unit
        size = self.key.kind.size(unit) if isinstance(self.key.kind, Quantity) else None
        return f"{at * self.key.unit_size / (size or 1.0):.6g} {unit}".strip()


class Choice(NamedTuple):
    """A choice between several sets of keys of a table, and the present one."""

    table: str
    label: str
    options: tuple[str, ...]
    present: str


class Group(NamedTuple):
    """The choices and entries of a table."""

    title: str
    choices: list[Choice]
    entries: list[Entry]


def form_of(tables: Tables) -> list[Group]:
    """What the form shows of a case: choices, and the numbers of its site, motion, buildings and gap."""
    buildings = (f"building_{number}" for number in range(1, MOST_BUILDINGS + 1))
    groups = []
    for name in ("site", *buildings, "separation", "motion"):
        table = tables.get(name)
        if isinstance(table, dict):
            own = table.get("name", "")
            title = f"{name.replace('_', ' ').capitalize()}{': ' * bool(own)}{own}"
            groups.append(Group(title, list(_choices(name, table)), list(_entries(name, table))))
    return groups


def _entries(name: str, table: Tables) -> Iterator[Entry]:
    """Numbers, words and truth values that the table has."""
    for key in _keys(name, table).values():
        value = table.get(key.name)
        shown = value is not None or (name, key.name) in EMPTY_TOO
        of_tables = isinstance(value, dict) or (
            isinstance(value, list) and any(isinstance(each, dict) for each in value)
        )
        if shown and not of_tables and (key.kind is bool or not isinstance(key.kind, type)):
            yield Entry(name, key, value)


def _keys(name: str, table: Tables) -> dict[str, Key]:
    """The keys of a table, and the parameters of its model that have no key of their own."""
    keys = dict(keys_at((name,)))
    models: Mapping[str, type[Model]] = {**GROUNDS, **ENVELOPES, **LAWS}
    model = models.get(str(table.get("ground", table.get("envelope", table.get("law")))))
    if model is None:
        return keys
    own = (parameter for parameter in model.parameter_names() if parameter not in keys)
    return keys | {parameter: declared(model, parameter) for parameter in own}


def _choices(name: str, table: Tables) -> Iterator[Choice]:
    """Ground, envelope, and the way in which a building is described."""
    if name == "site":
        present = str(table.get("spectrum", table.get("ground")))
        yield _choice(name, "Ground", (*ground_names(), *GROUNDS, *CODES), present)
    elif name == "motion":
        yield _choice(name, "Envelope", (*ENVELOPES, NONE), str(table.get("envelope", NONE)))
    elif name != "separation":
        yield _choice(name, "Described as", tuple(BUILDINGS), _way_of(table))


def _choice(table: str, label: str, options: tuple[str, ...], present: str) -> Choice:
    return Choice(table, label, tuple(dict.fromkeys((*options, present))), present)


def _way_of(table: Tables) -> str:
    """The way in which a building is described."""
    plain = {name for name, key in keys_at(("building_1",)).items() if key.ways or key.name == "elastic"}
    for way, keys in BUILDINGS.items():
        regular = way.startswith(REGULAR)
        needed = {key for key in keys if key not in OPTIONAL and (regular or key != "storeys")}
        if needed <= table.keys() and plain & table.keys() <= {*keys} and "law" not in table:
            return way
    return AS_IN_FILE


def chosen(tables: Tables, choice: Choice, option: str) -> dict[str, Any]:
    """The tables with the keys of another choice; numbers that stay keep their values."""
    table = tables[choice.table]
    if choice.table == "site":
        kept = {key: table[key] for key in NOT_OF_GROUNDS if key in table}
        changed = {**_site(table, option), **kept}
    elif choice.table == "motion":
        kept = {key: table[key] for key in ("duration", "scatter") if key in table}
        changed = {"envelope": option, **kept, **_started(choice.table, {**table, "envelope": option})}
    else:
        needed = [key for key in BUILDINGS[option] if key in table or key not in OPTIONAL]
        if option.startswith(OSCILLATOR) and "storeys" not in table:
            needed.remove("storeys")
        keys = keys_at((choice.table,))
        changed = {key: table[key] if key in table else _start(keys[key]) for key in needed}
    return {**tables, choice.table: changed}


def _site(table: Tables, option: str) -> dict[str, Any]:
    """The ground or the spectrum of this name, with its numbers."""
    if option in CODES:
        keys = [
            key for key in keys_at(("site",)).values() if option in key.ways and key.default is NEEDED
        ]
        return {"spectrum": option, **{key.name: table.get(key.name, _start(key)) for key in keys}}
    strength = {key: table[key] for key in STRENGTHS if key in table}
    strength = strength or {"intensity": _start(keys_at(("site",))["intensity"])}
    return {"ground": option, **strength, **_started("site", {**table, "ground": option})}


def _started(name: str, table: Tables) -> dict[str, Any]:
    """The parameters of the model that a table names, but the strength of a ground."""
    model = {**GROUNDS, **ENVELOPES}.get(str(table.get("ground", table.get("envelope"))))
    keys = _keys(name, table)
    own = [key for key in (model.parameter_names() if model else ()) if key != "intensity"]
    return {key: table.get(key, _start(keys[key], model)) for key in own}


def _start(key: Key, model: type[Model] | None = None) -> Any:
    """The value of a key with which a choice starts: in the middle of the usual, or of the allowed."""
    if key.kind is bool:
        return True
    if key.slider is not None:
        slider = key.slider
        return f"{slider.start:g} {slider.unit}" if slider.unit else slider.start
    if key.name in STARTS:
        return STARTS[key.name]
    assert model is not None
    assert isinstance(key.kind, Quantity)
    default = model.__dataclass_fields__[key.name].default
    value = default if isinstance(default, float) else key.kind.allowed.middle
    return value if key.kind.units == "1" else f"{value:g} {key.kind.units}"


def changed_text(text: str, entry: Entry, value: Any) -> str:
    """The text of a case file with another value of a key, or without it for None.

    Only the line of the key changes, so that comments stay; where this is not possible, all is written
    anew.
    """
    place, tables = (entry.table, entry.key.name), toml_tables(text)
    table = {key: old for key, old in tables[entry.table].items() if key != entry.key.name}
    wanted = {**tables, entry.table: table if value is None else {**table, entry.key.name: value}}
    lines, numbers = text.splitlines(), key_lines(text)
    line = "" if value is None else toml_text({entry.key.name: value}).strip()
    if place in numbers:
        at = numbers[place] - 1
        value_before = r'[^=#]*=\s*("[^"]*"|\[[^\]]*\]|[^\s#]+)'
        lines[at : at + 1] = [re.sub(value_before, lambda _: line, lines[at], count=1)] if line else []
    elif line:
        lines.insert(numbers.get((entry.table,), 0), line)
    changed = "\n".join(lines) + "\n"
    with suppress(ValueError):
        if toml_tables(changed) == wanted:
            return changed
    return toml_text(wanted)
