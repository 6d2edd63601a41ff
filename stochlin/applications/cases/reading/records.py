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

    def read(self, spectrum: xr.DataArray | None) -> dict[str, xr.DataArray]:
        """The records, scaled to their goal if they have one."""
        goal: dict[str, Any] = self.given("pga", "sa", "band")
        if self.sa_period is not None:
            goal["period"] = self.sa_period
        if self.scale_to is not None:
            if spectrum is None:
                what = "is not there: the site has a ground; allowed: pga, sa, or a site by its spectrum"
                raise self.table.error("scale_to", what)
            goal["spectrum"] = spectrum
        path, options = self.table.path("path"), self.given(*READING, "skip_unreadable")
        with self.table.naming("path"):
            suite = read_records(path, **options)
        beside = path if path.is_dir() else path.parent
        self.table.source.files.extend(beside / record.attrs["file"] for record in suite.values())
        with self.table.naming("band" if self.band else "path"):
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


def read_suite(
    table: Table, records: Mapping[str, xr.DataArray], spectrum: xr.DataArray | None
) -> dict[str, xr.DataArray]:
    """The records of a suite by name; none may have the name of a single one."""
    suite = table.read(Suite).read(spectrum)
    if twice := next((name for name in suite if name in records), ""):
        what = f"has {brief(twice)}, which site.records also has; give that another name"
        raise table.error("path", what)
    return suite
