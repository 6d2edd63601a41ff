"""Hazard curves in tables: columns of one curve, or sites as OpenQuake and nshmp-haz write them.

GEM, OpenQuake Engine manual, Outputs from classical PSHA, ``hazard_curve-mean-PGA_17.csv``: a
comment with ``investigation_time=50.0, imt='PGA'``, the columns ``lon,lat,depth,poe-0.005,...``,
whose names have the intensities, in g for ``PGA`` and ``SA``, and a row for each site with the
probabilities that they are exceeded in the investigation time [yr]. U.S. Geological Survey,
nshmp-haz, ``PGA/total.csv``: the columns ``name,lon,lat,0.0025,...``, whose names have the
intensities [g], and annual frequencies of exceedance, in a folder named by the measure.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from stochlin.applications.sheets.columns import Need, chosen, noted
from stochlin.applications.sheets.quantities import (
    ACCELERATION_COLUMN,
    LEVEL_COLUMN,
    PEAK_COLUMN,
    PROBABILITY_COLUMN,
    RATE_COLUMN,
    RETURN_PERIOD_COLUMN,
    SPECTRAL_COLUMN,
    Quantity,
)
from stochlin.applications.sheets.sheets import Sheet, Table, number_in, sheets_of, table_in
from stochlin.applications.sites.hazard_formats import (
    S0,
    AskedHazard,
    Ordinate,
    Site,
    annual_frequencies,
    period_of,
)
from stochlin.kernels.basics.arrays import Array
from stochlin.messages import brief, listed, refuse
from stochlin.models.arguments import is_number, is_whole
from stochlin.models.hazards import Hazard
from stochlin.models.parameters import Range
from stochlin.models.units import size_of

_ALONG = ("lon", "longitude", "lat", "latitude")
_LEVELS: dict[str, tuple[Quantity, ...]] = {
    "pga": (PEAK_COLUMN, ACCELERATION_COLUMN, LEVEL_COLUMN),
    "sa": (SPECTRAL_COLUMN, ACCELERATION_COLUMN, LEVEL_COLUMN),
    "intensity": (LEVEL_COLUMN,),
}
_SITES = re.compile(rf"({'|'.join(_ALONG)}|custom_site_id|imt)\b", re.IGNORECASE)
_YEARS = re.compile(r"investigation_time\s*=\s*([\d.eE+-]+)")
_MEASURE = re.compile(r"\bimt\s*=\s*[\"']*([A-Za-z]\w*(?:\([^)]*\))?)")
_PER_YEARS = re.compile(
    r"(?:\bper|1\s*/|\bin)\s*(\d+)\s*-?\s*(?:y|a\b|a[nñ]|j|sene)", re.IGNORECASE
)
PROBABILITIES = Range(upper=1.0, include_lower=True, include_upper=True)
_LEVEL = "poe-"
_NEAR = 0.01  # degrees, about 1 km: largest distance of a site that is named by its coordinates


def read(path: Path, of: Hazard, choice: AskedHazard) -> Ordinate:
    """The curve at the site that is asked for, or the one in columns."""
    sheets = sheets_of(path)
    if (table := table_of_sites(sheets)) is not None:
        columns = {"column": choice.column, "frequency_column": choice.frequency_column}
        refuse(table.sheet.name, "a table of sites", columns)
        return _of_sites(table, path, choice)
    return _of_columns(sheets, of, choice)


def table_of_sites(sheets: Sequence[Sheet]) -> Table | None:
    """The table with a row for each site, whose titles are those of OpenQuake or nshmp-haz."""
    content = sheets[0].without_comments().cells
    if len(sheets) > 1 or not len(content) or not content.iloc[0].map(_SITES.match).any():
        return None
    return Table("the table", sheets[0], content.index[0], 0, content.iloc[1:])


def _of_columns(sheets: Sequence[Sheet], of: Hazard, choice: AskedHazard) -> Ordinate:
    """The curve in columns of intensities and of annual frequencies, or of probabilities."""
    table = table_in(sheets, "intensities and annual frequencies")
    refuse(table.sheet.name, "a file of one site", {"site": choice.site})
    wanted = (
        (RATE_COLUMN, PROBABILITY_COLUMN, RETURN_PERIOD_COLUMN)
        if choice.years is None
        else (PROBABILITY_COLUMN,)
    )
    needs = [
        Need("column", choice.column, _LEVELS[of.measure], True, logarithms=True, period=of.period),
        Need("frequency_column", choice.frequency_column, wanted, logarithms=True),
    ]
    choices = [choice for choice in chosen(table, needs) if choice]
    level, other = choices
    values = other.in_si()
    if other.quantity is RATE_COLUMN and not is_whole(other.by_caller):
        _check_per_year(table, other.column.title)
    if other.quantity is RETURN_PERIOD_COLUMN:
        with np.errstate(divide="ignore"):
            values = 1 / values
    if other.quantity is PROBABILITY_COLUMN:
        if choice.years is None:
            title = brief(other.column.title)
            raise table.error(f"has {title}, a probability; give investigation_time=")
        allowed = PROBABILITIES.contains(values)
        if not allowed.all():
            n = int(np.argmin(allowed))
            what = f"the probability is {values[n]:g}; allowed: {PROBABILITIES}"
            raise table.sheet.error(table.rows.index[n], other.column.number - 1, what)
        _check_years(table, other.column.title, choice.years)
        values = annual_frequencies(values, choice.years)
    intensities = level.numbers()
    unit = level.column.said.unit
    if of.measure == "intensity":
        intensities = (size_of(unit, S0) or 1.0) * intensities
        unit = S0
    about = noted(choices, [PROBABILITY_COLUMN, RETURN_PERIOD_COLUMN]).get("columns", "")
    return Ordinate(of.period or 0.0, intensities, values, table.places(), unit, about)


def _check_years(table: Table, title: str, years: float) -> None:
    """Raise a ValueError if the title of probabilities states another time in which they hold."""
    for stated in _PER_YEARS.findall(title):
        if not np.isclose(float(stated), years, rtol=1e-6):
            raise table.error(
                f"has {brief(title)}, which investigation_time = {years:g} contradicts"
            )


def _check_per_year(table: Table, title: str) -> None:
    """Raise a ValueError if the title of frequencies states several years for which they hold."""
    for years in _PER_YEARS.findall(title):
        if int(years) != 1:
            what = f"has {brief(title)}; allowed: annual frequencies, so divide them by {years}"
            raise table.error(f"{what}, or frequency_column= by number, if they are annual")


def _of_sites(table: Table, path: Path, choice: AskedHazard) -> Ordinate:
    """The curve at a site, whose levels are in the titles."""
    titles = [head.lower() for head in table.title_cells]
    sheet = table.sheet
    if table.rows.empty or len({*titles}) < len(titles):
        raise table.error("has no site, or a name twice; allowed: a row for each site")
    sheet.check_width(table.rows.index, len(titles))
    comments = " ".join(sheet.cells.loc[: table.titles - 1].to_numpy().ravel())
    measure = stated[1] if (stated := _MEASURE.search(comments)) else ""
    columns = [n for n, title in enumerate(titles) if title.startswith(_LEVEL)]
    years = _years(table, comments, choice.years) if columns else None
    if not columns:  # of nshmp-haz, with frequencies
        columns = [n for n, title in enumerate(titles) if number_in(title) is not None]
        measure = path.parent.name
    levels = [number_in(titles[n].removeprefix(_LEVEL)) for n in columns]
    if not columns or None in levels:
        raise table.error(f"has {listed(titles, 6)}; allowed: a hazard curve, as poe-0.005")
    if (period := period_of(measure)) is None:
        shown = brief(measure) if measure else "no imt"
        raise table.error(f"has {shown}; allowed: imt='PGA' or imt='SA(0.5)', or a folder SA0P5")
    line = line_of_site(table, choice.site)
    what = "probability" if years else "annual frequency"
    allowed = PROBABILITIES if years else None
    values = sheet.numbers(table.rows.loc[[line], columns], what, allowed)[0]
    frequencies = annual_frequencies(values, years) if years else values
    where = [sheet.where(line, column) for column in columns]
    return Ordinate(period, np.array(levels, float), frequencies, where, "g")


def _years(table: Table, comments: str, investigation_time: float | None) -> float:
    stated = _YEARS.search(comments)
    years = number_in(stated[1]) if stated else investigation_time
    if not years:
        raise table.error("does not state the time of its probabilities; give investigation_time=")
    if investigation_time is not None and not np.isclose(years, investigation_time, rtol=1e-9):
        raise table.error(
            f"states {years:g} years, which investigation_time = {investigation_time:g} contradicts"
        )
    return years


def line_of_site(table: Table, site: Site | None) -> int:
    """The line of the site that is asked for, or of the only one."""
    along = [n for n, title in enumerate(table.title_cells) if title.lower() in _ALONG]
    coordinates = table.sheet.numbers(table.rows[along], "coordinate").tolist()
    return int(table.rows.index[_chosen(table.sheet.name, coordinates, site)])


def _chosen(name: str, coordinates: Sequence[Sequence[float]], site: Site | None) -> int:
    """Number, from 0, of the site that is asked for, or of the only one."""
    places = (", ".join(f"{degrees:g}" for degrees in place) for place in coordinates)
    sites = [f"{n} ({place})" for n, place in enumerate(places, 1)]
    if site is None and len(sites) == 1:
        return 0
    if is_whole(site) and 1 <= site <= len(sites):
        return site - 1
    choices = f"{name} has {listed(sites, 6)}"
    if site is None:
        raise ValueError(f"site is missing: {choices}; give its number")
    if not isinstance(site, (list, tuple)) or len(site) != 2 or not all(map(is_number, site)):
        raise ValueError(
            f"site = {brief(site)} is unknown: {choices}; give its number or coordinates"
        )
    away: Array = np.abs(np.array(coordinates, float) - np.array(site, float)).max(axis=1)
    nearest = int(np.argmin(away))
    if not away[nearest] <= _NEAR:
        raise ValueError(
            f"site = {brief(site)} is not in {name}, where the nearest is {sites[nearest]}"
        )
    return nearest
