"""The records of a case file: single ones, and a suite that is scaled."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import xarray as xr

from stochlin.applications.cases.reading.kinds import (
    COLUMN,
    TEXT,
    TRUTH,
    ListOf,
    Quantity,
    Word,
    integer,
    key,
)
from stochlin.applications.cases.reading.tables import Form, Table
from stochlin.applications.records.records import read_record
from stochlin.applications.sites.suites import (
    doubtful_factor,
    read_records,
    scale_records,
    scaled_record,
)
from stochlin.messages import brief
from stochlin.models.parameters import POSITIVE
from stochlin.models.plausible import PLAUSIBLE

TIME = Quantity("s", POSITIVE)
FACTOR = Quantity("1", POSITIVE)
PEAK, RESPONSE = (Quantity("m/s^2", POSITIVE, PLAUSIBLE[name]) for name in ("pga", "sa"))
READING = ("units", "dt", "column", "time_column", "component", "wrapped", "skip")


@dataclass(frozen=True, kw_only=True)
class Reading(Form):
    """How a file of a record is read, as in `read_record`."""

    path: str = key(TEXT, "File beside the case file; of a suite its folder, or a table of files")
    units: str | None = key(TEXT, "Unit of the accelerations", None)
    dt: float | None = key(TIME, "Time step", None)
    column: str | int | None = key(COLUMN, "Column of the accelerations", None)
    time_column: str | int | None = key(COLUMN, "Column of the times, in place of the time step", None)
    component: str | int | None = key(COLUMN, "Component, by its name or number from 1", None)
    wrapped: bool = key(TRUTH, "Read all numbers as one series, written in rows", False)
    skip: int = key(integer(0), "Number of lines at the beginning that are left out", 0)


@dataclass(frozen=True, kw_only=True)
class Record(Reading):
    """A record of a site."""

    name: str = key(TEXT, "Name in results", "")
    scale: float = key(FACTOR, "Factor on the accelerations", 1.0)

    def read(self) -> xr.DataArray:
        """The record with its factor."""
        with self.table.naming("path", "cannot be read"):
            record = read_record(self.table.path("path"), **self.given(*READING))
        if self.scale == 1:
            return record
        if warning := doubtful_factor(self.scale):
            self.table.warn("scale", f"is doubtful: {warning}")
        return scaled_record(record, self.scale)


@dataclass(frozen=True, kw_only=True)
class Suite(Reading):
    """Records of a folder or a table of files, with what they are scaled to."""

    at_most = (("pga", "sa", "scale_to"),)
    goes_with = (("sa", "sa_period"), ("sa_period", "sa"), ("band", "scale_to"))

    skip_unreadable: bool = key(TRUTH, "Leave out what cannot be read, with a warning", False)
    pga: float | None = key(PEAK, "Peak acceleration to which each record is scaled", None)
    sa: float | None = key(RESPONSE, "Spectral acceleration to which each is scaled", None)
    sa_period: float | None = key(TIME, "Its period", None)
    scale_to: str | None = key(Word(("spectrum",)), "Scale each to the spectrum of the site", None)
    band: list[float] | None = key(
        ListOf(TIME, length=2), "The two periods between which it is scaled to the spectrum", None
    )

    def read(self) -> dict[str, xr.DataArray]:
        """The records as they are in their files."""
        if self.band and not self.band[0] < self.band[1]:
            raise self.table.error("band", 'is no band; allowed: two periods, as ["0.2 s", "2 s"]')
        options = self.given(*READING, "skip_unreadable")
        path = self.table.path("path")
        with self.table.naming("path"):
            suite = read_records(path, **options)
        beside = path if path.is_dir() else path.parent
        self.table.source.files.extend(beside / record.attrs["file"] for record in suite.values())
        return suite

    def scaled(
        self, suite: dict[str, xr.DataArray], spectrum: xr.DataArray | None
    ) -> dict[str, xr.DataArray]:
        """The records scaled to their goal, if they have one."""
        goal: dict[str, Any] = self.given("pga", "sa", "band")
        if self.sa_period is not None:
            goal["period"] = self.sa_period
        if self.scale_to is not None:
            goal["spectrum"] = spectrum
        with self.table.naming("path"):
            return scale_records(suite, **goal) if goal else suite


def read_single_records(tables: list[Table]) -> dict[str, xr.DataArray]:
    """The single records by name, in the order of the file."""
    records: dict[str, xr.DataArray] = {}
    for table in tables:
        record = table.read(Record)
        name = record.name or (table.source.path.parent / record.path).name
        if name in records:
            where = "name" if record.name else "path"
            raise table.error(where, "is used twice; give it another name")
        records[name] = record.read()
    return records


def check_names(suite: Mapping[str, Any], records: Mapping[str, Any], table: Table) -> None:
    """Raise a ValueError if a record of the suite has the name of a single one."""
    if twice := next((name for name in suite if name in records), ""):
        what = f"has {brief(twice)}, which site.records also has; give that another name"
        raise table.error("path", what)
