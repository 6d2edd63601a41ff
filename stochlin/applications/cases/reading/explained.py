"""What a case file may say, from its forms: tables of keys for documentation and examples."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import MISSING
from pathlib import Path
from typing import Any, NamedTuple

from stochlin.applications.cases.reading.buildings import FORMS
from stochlin.applications.cases.reading.case import Whole
from stochlin.applications.cases.reading.codes import Numbers, Simulated, Wanted
from stochlin.applications.cases.reading.hazards import OfFile, OfPoints, OfPowerLaw
from stochlin.applications.cases.reading.kinds import Key
from stochlin.applications.cases.reading.measures import Devices, OfContact, OfMeasure
from stochlin.applications.cases.reading.records import Record, Suite
from stochlin.applications.cases.reading.site import (
    Asce7,
    ByParameters,
    Eurocode8,
    Motion,
    MotionOfRecord,
    OfRecord,
    SpectrumFile,
    WithMotionOfRecord,
)
from stochlin.applications.cases.reading.tables import EXAMPLES, Form, Source, Table

GROUNDS = (ByParameters, OfRecord, WithMotionOfRecord, Eurocode8, Asce7, SpectrumFile)
TABLES: Mapping[str, Sequence[type[Form]]] = {
    "": [Whole],
    "site": GROUNDS,
    "site.records": [Record],
    "site.suite": [Suite],
    "site.hazard": [OfFile, OfPoints, OfPowerLaw],
    "motion": [Motion, MotionOfRecord],
    "building": FORMS,
    "separation": [Wanted],
    "separation.numbers": [Numbers],
    "simulation": [Simulated],
    "contact": [OfContact],
    "measures": [OfMeasure],
    "measures.dampers": [Devices],
}


class Row(NamedTuple):
    """A key with all that is known of it, and the forms that have it, if not all have."""

    name: str
    key: Key
    forms: Sequence[type[Form]]

    @property
    def example(self) -> str:
        """A value as it is written in a file."""
        return str(EXAMPLES.get(self.name, self.key.kind.example)).partition(", or ")[0]

    @property
    def default(self) -> str:
        """The value of a missing key; empty for one that has none."""
        default: Any = self.key.default
        return "" if default in (None, MISSING, (), "") else str(default).lower()


def keys_of_table(name: str) -> Iterator[Row]:
    """The keys of a table in the order of its forms."""
    each = {form: form.keys(table_of({})) for form in TABLES[name]}
    keys: dict[str, Key] = {}
    for known in each.values():  # the first form says what a key is
        keys = keys | {key: value for key, value in known.items() if key not in keys}
    for key, value in keys.items():
        having = [form for form in each if key in each[form]]
        yield Row(key, value, having if len(having) < len(each) else [])


def form_of_table(name: str, values: Mapping[str, Any]) -> tuple[type[Form], dict[str, Key]]:
    """The form that has most of the keys of a table with these values, and all its keys."""
    table = table_of(values)
    each = {form: form.keys(table) for form in TABLES[name]}
    form = table.fitting(each)
    return form, each[form]


def table_of(values: Mapping[str, Any]) -> Table:
    """A table with these values, of no file."""
    return Table(Source(Path("case.toml"), {}), values)
