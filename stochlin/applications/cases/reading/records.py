"""The records and the hazard of a site in a case file."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import xarray as xr

from stochlin.applications.cases.reading.kinds import (
    COLUMN_OF_FILE,
    COMPONENT,
    TEXT,
    TRUTH,
    Integer,
    Key,
    Kind,
    ListOf,
    WithUnit,
    Word,
    key,
    keys_of,
)
from stochlin.applications.cases.reading.tables import Form, TomlTable
from stochlin.applications.records.records import copies, read_record
from stochlin.applications.sites.hazard_files import read_hazard
from stochlin.applications.sites.suites import (
    read_records,
    scale_records,
    scaled_record,
)
from stochlin.messages import brief
from stochlin.models.hazards import MEASURES, Hazard, HazardCurve, PowerLawHazard
from stochlin.models.parameters import POSITIVE, Range
from stochlin.models.plausible import PLAUSIBLE

POSITIVE_TIME = WithUnit("s", POSITIVE)
POSITIVE_YEARS = WithUnit("yr", POSITIVE)
RETURN_PERIOD = WithUnit("yr", POSITIVE, PLAUSIBLE["return_period"])
POSITIVE_NUMBER = WithUnit("1", POSITIVE)
TWO_TIMES = ListOf(POSITIVE_TIME, length=2)
FACTOR_OF_RECORD = WithUnit("1", POSITIVE, PLAUSIBLE["scale of a record"])
SA_PERIOD = WithUnit("s", POSITIVE, PLAUSIBLE["period"])
PGA = WithUnit("m/s^2", POSITIVE, PLAUSIBLE["pga"])
RESPONSE = WithUnit("m/s^2", POSITIVE, PLAUSIBLE["sa"])
LON_LAT = ListOf(WithUnit("1", Range(-360.0, 360.0, True, True)), length=2)
SITE = Kind(
    lambda value, warn: (LON_LAT if isinstance(value, list) else Integer(1)).read(value, warn),
    "its number from 1, or its longitude and latitude",
)
INTENSITIES: dict[str, WithUnit] = dict.fromkeys(MEASURES, WithUnit("m/s^2", POSITIVE))
INTENSITIES["intensity"] = WithUnit("m^2/s^3", POSITIVE)
READING = ("units", "dt", "column", "time_column", "component", "wrapped", "skip")


class Reading(Form):
    """How a file of a record is read, as in `read_record`."""

    path: str = key(TEXT, "File beside the case file; of a suite its folder, or a table of files")
    units: str | None = key(TEXT, "Unit of the accelerations", None)
    dt: float | None = key(POSITIVE_TIME, "Time step", None)
    column: str | int | None = key(COLUMN_OF_FILE, "Column of the accelerations", None)
    time_column: str | int | None = key(
        COLUMN_OF_FILE, "Column of the times, in place of the time step", None
    )
    component: str | int | None = key(COMPONENT, "Component, by its name or number from 1", None)
    wrapped: bool = key(TRUTH, "Read all numbers as one series, written in rows", False)
    skip: int = key(Integer(0), "Number of lines at the beginning that are left out", 0)


class Record(Reading):
    """A record of a site."""

    name: str = key(TEXT, "Name in results", "")
    scale: float = key(FACTOR_OF_RECORD, "Factor on the accelerations", 1.0)

    def read(self) -> xr.DataArray:
        """The record with its factor."""
        path = self.table.path("path")
        with self.table.naming("path", "cannot be read: "), self.table.asking("path"):
            record = read_record(path, **self.values_of(*READING))
        if self.scale == 1:
            return record
        scaled = scaled_record(record, self.scale)
        if text := PLAUSIBLE["peak of a record"].doubt(peak := float(abs(scaled).max())):
            self.table.warn("scale", f"is doubtful: the peak is {peak:.3g} m/s^2 with it; {text}")
        return scaled


class Suite(Reading):
    """Records of a folder or a table of files, with what they are scaled to."""

    one_of: ClassVar[Any] = {"": ("pga", "sa", "scale_to")}
    goes_with = (("sa", "sa_period"), ("sa_period", "sa"), ("band", "scale_to"))

    pga: float | None = key(PGA, "Peak acceleration to which each record is scaled", None)
    sa: float | None = key(RESPONSE, "Spectral acceleration to which each is scaled", None)
    sa_period: float | None = key(SA_PERIOD, "Its period", None)
    scale_to: str | None = key(Word(("spectrum",)), "Scale each to the spectrum of the site", None)
    band: list[float] | None = key(TWO_TIMES, "Periods between which it is scaled to it", None)

    def read(self, spectrum: xr.DataArray | None) -> dict[str, xr.DataArray]:
        """The records, scaled to their goal if they have one."""
        goal: dict[str, Any] = self.values_of("pga", "sa", "band")
        if self.sa_period is not None:
            goal["period"] = self.sa_period
        if self.scale_to is not None:
            if spectrum is None:
                raise self.table.error("scale_to", "needs a site by its spectrum; allowed: pga, sa")
            goal["spectrum"] = spectrum
        path = self.table.path("path")
        with self.table.naming("path"), self.table.asking("path"):
            suite = read_records(path, **self.values_of(*READING))
        beside = path if path.is_dir() else path.parent
        self.table.source.files.extend(beside / record.attrs["file"] for record in suite.values())
        key = "band" if self.band else "path"
        with self.table.naming(key), self.table.asking(key):
            return scale_records(suite, **goal) if goal else suite


def read_records_of(
    singly: Sequence[Record], suite: Suite | None, spectrum: xr.DataArray | None
) -> dict[str, xr.DataArray]:
    """All records by name, in the order of the file; no name is used twice."""
    read: list[Any] = [(form, form.name or Path(form.path).name, form.read()) for form in singly]
    if suite is not None:
        read += [(suite, *item) for item in suite.read(spectrum).items()]
    records: dict[str, xr.DataArray] = {}
    for form, name, record in read:
        if name in records:
            what = f"names a record {brief(name)}, as another one is; allowed: another name"
            raise form.table.error("name" if "name" in form.table else "path", what)
        records[name] = record
    names = [*records]
    for first, later in copies([record.to_numpy() for record in records.values()]):
        if first < len(singly):  # those of a suite are asked about where it is read
            both = f"{names[first]} and {names[later]}"
            read[later][0].table.warn(
                "path", f"is doubtful: {both} are the same motion; is it to count twice?"
            )
            break
    return records


class OfHazard(Form):
    """Keys of every hazard."""

    stated: ClassVar[str]  # the key that states the intensities

    measure: str = key(Word(MEASURES), "Measure of the shaking; intensity is S0")
    sa_period: float | None = key(SA_PERIOD, "Period of the spectral acceleration", None)

    @property
    def of(self) -> dict[str, Any]:
        """The measure and its period."""
        return {"measure": self.measure, "period": self.sa_period}


class OfFile(OfHazard):
    """A file of intensities and annual frequencies, or several of them."""

    stated: ClassVar[str] = "file"
    one_of: ClassVar[Any] = {"": ("site", "coordinates")}

    file: list[str] = key(ListOf(TEXT, "listed"), "File of this site, of OpenQuake or of the USGS")
    units: str | None = key(Word(INTENSITIES["pga"].spellings), "Unit in the file", None)
    site: int | None = key(Integer(1), "Number of the site in a file of OpenQuake", None)
    coordinates: list[float] | None = key(LON_LAT, "Its longitude and latitude, in its place", None)
    investigation_time: float | None = key(
        POSITIVE_YEARS, "Time in which probabilities of the file hold", None
    )
    column: str | int | None = key(COLUMN_OF_FILE, "Column of the intensities", None)
    frequency_column: str | int | None = key(
        COLUMN_OF_FILE, "Column of the frequencies, or probabilities", None
    )

    def hazard(self) -> Hazard:
        """The curve of the file."""
        paths = self.table.paths("file", self.file)
        options = self.values_of("units", "investigation_time", "column", "frequency_column")
        options["site"] = self.coordinates or self.site
        with self.table.naming("file", period="sa_period"):
            return read_hazard(paths, **self.of, **options)


class OfPoints(OfHazard):
    """A few points of a curve."""

    stated: ClassVar[str] = "intensities"
    one_of: ClassVar[Any] = {"annual frequencies": ("frequencies", "return_periods")}

    intensities: list[float] = key(ListOf(INTENSITIES["pga"]), "Intensities of a few points")
    frequencies: list[float] | None = key(ListOf(POSITIVE_NUMBER), "Their annual frequencies", None)
    return_periods: list[float] | None = key(ListOf(POSITIVE_YEARS), "Their return periods", None)

    @classmethod
    def keys(cls, table: TomlTable) -> dict[str, Key]:
        """The intensities have the unit of their measure."""
        keys = keys_of(cls)
        quantity = INTENSITIES.get(str(table.values.get("measure")), INTENSITIES["pga"])
        return keys | {"intensities": keys["intensities"]._replace(kind=ListOf(quantity))}

    def hazard(self) -> Hazard:
        """The curve through the points."""
        rates = self.frequencies or [1 / years for years in self.return_periods or ()]
        with self.table.naming("intensities", "does not fit the others: ", period="sa_period"):
            return HazardCurve(tuple(self.intensities), tuple(rates), **self.of)


class OfPowerLaw(OfHazard):
    """A power law; ``k0`` is the annual frequency of exceedance of 1 in the unit of the file."""

    stated: ClassVar[str] = "k0"

    k0: float = key(POSITIVE_NUMBER, "Annual frequency of exceedance of one unit, of a power law")
    k: float = key(POSITIVE_NUMBER, "Exponent of the power law")
    units: str = key(Kind(TEXT.read, 'a unit of the measure, as "g"'), "Unit of k0")

    def hazard(self) -> Hazard:
        """The law in SI units."""
        intensity = INTENSITIES[self.measure]
        unit = intensity.size(self.table.value("units", Word(intensity.spellings))) or 1.0
        with self.table.naming("k", period="sa_period"), np.errstate(over="ignore"):
            return PowerLawHazard(float(self.k0 * np.float64(unit) ** self.k), self.k, **self.of)


HAZARDS = (OfFile, OfPoints, OfPowerLaw)
