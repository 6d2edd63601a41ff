"""The hazard of a site in a case file: from a file, from a few points, or by a power law."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from stochlin.applications.cases.reading.kinds import (
    TEXT,
    Key,
    ListOf,
    Quantity,
    Word,
    integer,
    key,
    keys_of,
)
from stochlin.applications.cases.reading.records import FACTOR, TIME
from stochlin.applications.cases.reading.tables import Form, Table
from stochlin.applications.risk.risk import simulated_at
from stochlin.applications.sites.hazard_files import read_hazard
from stochlin.models.hazards import MEASURES, Hazard, HazardCurve, PowerLawHazard
from stochlin.models.parameters import POSITIVE, Range

YEARS = Quantity("yr", POSITIVE)
DEGREES = Quantity("1", Range(-360.0, 360.0, True, True))
INTENSITIES = {
    measure: Quantity("m^2/s^3" if measure == "intensity" else "m/s^2", POSITIVE) for measure in MEASURES
}
EXAMPLE = (
    'write [site.hazard], and below it measure = "pga" and one of file = "hazard.csv"; intensities = '
    '["0.1 g", "0.3 g"] with frequencies = [0.01, 0.001] or return_periods = ["100 yr", "1000 yr"]; k0, '
    "k and units"
)


@dataclass(frozen=True, kw_only=True)
class OfSite(Form):
    """Keys of every hazard."""

    measure: str = key(Word(MEASURES), "Measure of the shaking; intensity is S0")
    sa_period: float | None = key(TIME, "Period of the spectral acceleration", None)

    def hazard(self) -> Hazard:
        """The hazard."""
        raise NotImplementedError

    @property
    def of(self) -> dict[str, Any]:
        """The measure and its period."""
        return {"measure": self.measure, "period": self.sa_period}


@dataclass(frozen=True, kw_only=True)
class OfFile(OfSite):
    """A file of intensities and annual frequencies, or several of them."""

    at_most = (("site", "coordinates"),)

    file: list[str] = key(ListOf(TEXT, "listed"), "File of this site, of OpenQuake or of the USGS")
    units: str | None = key(Word(tuple(INTENSITIES["pga"].spellings)), "Unit in the file", None)
    site: int | None = key(integer(1), "Number of the site in a file of OpenQuake", None)
    coordinates: list[float] | None = key(
        ListOf(DEGREES, length=2), "Its longitude and latitude, in place of the number", None
    )
    investigation_time: float | None = key(YEARS, "Time in which probabilities of the file hold", None)

    def hazard(self) -> Hazard:
        """The curve of the file."""
        paths = self.table.paths("file", self.file)
        options = self.given("units", "site", "investigation_time")
        if self.coordinates is not None:
            options["site"] = self.coordinates
        with self.table.naming("file"):
            return read_hazard(paths, **self.of, **options)


@dataclass(frozen=True, kw_only=True)
class OfPoints(OfSite):
    """A few points of a curve."""

    one_of = ("frequencies", "return_periods")
    one_called = "annual frequencies"

    intensities: list[float] = key(ListOf(INTENSITIES["pga"]), "Intensities of a few points")
    frequencies: list[float] | None = key(ListOf(FACTOR), "Their annual frequencies", None)
    return_periods: list[float] | None = key(ListOf(YEARS), "Their return periods", None)

    @classmethod
    def keys(cls, table: Table) -> dict[str, Key]:
        """The intensities have the unit of their measure."""
        keys = keys_of(cls)
        quantity = INTENSITIES.get(str(table.values.get("measure")), INTENSITIES["pga"])
        return keys | {"intensities": keys["intensities"]._replace(kind=ListOf(quantity))}

    def hazard(self) -> Hazard:
        """The curve through the points."""
        rates = self.frequencies or [1 / years for years in self.return_periods or ()]
        with self.table.naming("intensities", "does not fit the others"):
            return HazardCurve(tuple(self.intensities), tuple(rates), **self.of)


@dataclass(frozen=True, kw_only=True)
class OfPowerLaw(OfSite):
    """A power law; ``k0`` is the annual frequency of exceedance of 1 in the unit of the file."""

    k0: float = key(FACTOR, "Annual frequency of exceedance of one unit, of a power law")
    k: float = key(FACTOR, "Exponent of the power law")
    units: str = key(TEXT, "Unit of k0")

    def hazard(self) -> Hazard:
        """The law in SI units."""
        sizes = INTENSITIES[self.measure].spellings
        unit = sizes[self.table.value("units", Word(tuple(sizes)))]
        with self.table.naming("k"), np.errstate(over="ignore"):
            law = PowerLawHazard(float(self.k0 * np.float64(unit) ** self.k), self.k, **self.of)
            simulated_at(law)
            return law


def read_hazard_of(table: Table) -> Hazard | None:
    """The hazard of a table, or None for an empty one."""
    if not table.values:
        return None
    if not {"file", "intensities", "k0", "k"} & table.values.keys():
        raise table.error("", f"has no numbers; {EXAMPLE}")
    return table.read(OfFile, OfPoints, OfPowerLaw).hazard()
