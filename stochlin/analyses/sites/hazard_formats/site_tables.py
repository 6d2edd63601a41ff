"""Tables of hazard curves at sites, as OpenQuake and nshmp-haz write them.

GEM, OpenQuake Engine manual, Outputs from classical PSHA, ``hazard_curve-mean-PGA_17.csv``: a comment
with ``investigation_time=50.0, imt='PGA'``, the columns ``lon,lat,depth,poe-0.005,...``, whose names
have the intensities, in g for ``PGA`` and ``SA``, and a row for each site with the probabilities that
they are exceeded in the investigation time [yr]; or a row for each level, with ``imt,iml,poe``. U.S.
Geological Survey, nshmp-haz, ``PGA/total.csv``: the columns ``name,lon,lat,0.0025,...``, whose names
have the intensities [g], and annual frequencies of exceedance, in a folder named by the measure.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from itertools import takewhile
from pathlib import Path

import numpy as np
import pandas as pd

from stochlin.analyses.sheets.sheets import number_in
from stochlin.analyses.sites.hazard_formats import (
    AskedHazard,
    Ordinate,
    Site,
    annual_frequencies,
    period_of,
)
from stochlin.kernels.basics.arrays import Array
from stochlin.messages import brief, listed, plain
from stochlin.models.arguments import is_number, is_whole

_OF_SITES = r"lon|lat|longitude|latitude|custom_site_id|imt"
START = re.compile(rf"(?:[\"']?#[^\n]*\n)*(?:[^\n]*[,;])?[ \"]*(?:{_OF_SITES})[ \"]*[,;]", re.IGNORECASE)
_YEARS = re.compile(r"investigation_time\s*=\s*([\d.eE+-]+)")
_MEASURE = re.compile(r"\bimt\s*=\s*[\"']*([A-Za-z]\w*(?:\([^)]*\))?)")
_LEVEL = "poe-"
_NEAR = 0.01  # degrees, about 1 km: largest distance of a site that is named by its coordinates


def read(path: Path, text: str, asked: AskedHazard) -> list[Ordinate]:
    """The curves at the site that is asked for."""
    name, lines = plain(path.name), text.split("\n")
    above = [*takewhile(lambda line: line.lstrip("\"'").startswith("#"), lines)]
    table = _table(name, lines, len(above))
    comments, names = "\n".join(above), [*table.columns]
    along = [column for column in ("lon", "longitude", "lat", "latitude") if column in names]
    places = [*map(tuple, _numbers(name, table, along).tolist())]
    stated = _MEASURE.search(comments)
    measure = stated[1] if stated else ""
    if {"iml", "poe"} <= {*names}:
        sites = [*dict.fromkeys(places)]
        wanted = sites[_chosen(name, sites, asked.site)]
        table = table[[place == wanted for place in places]]
        each = table["imt"] if "imt" in names else pd.Series(measure, table.index)
        years = _years(name, comments, asked.years)
        curves = []
        for imt, part in table.groupby(each, sort=False):
            levels, values = _numbers(name, part, ["iml", "poe"]).T
            curves.append(_ordinate(name, str(imt), levels, values, [*part.index], years))
        return curves
    columns = [column for column in names if column.startswith(_LEVEL)]
    known = [number_in(column.removeprefix(_LEVEL)) for column in columns]
    of_poe = bool(columns)
    if not of_poe:  # of nshmp-haz, with frequencies
        columns = [column for column in names if number_in(column) is not None]
        known, measure = [number_in(column) for column in columns], path.parent.name
    if not columns or None in known:
        raise ValueError(f"{name}: {listed(names, 6)}; allowed: a hazard curve, as poe-0.005")
    line = table.index[_chosen(name, places, asked.site)]
    values = _numbers(name, table.loc[[line]], columns)[0]
    given = _years(name, comments, asked.years) if of_poe else None
    where = [f"{line}, column {column}" for column in columns]
    return [_ordinate(name, measure, np.array(known, float), values, where, given)]


def _table(name: str, lines: Sequence[str], head: int) -> pd.DataFrame:
    """The cells as texts, by the numbers of lines and the names of columns below ``head`` lines."""
    cells: dict[int, list[str]] = {}
    for n, line in enumerate(lines[head:], head + 1):
        try:
            row = next(csv.reader([line]), [])
        except csv.Error as error:
            raise ValueError(f"{name}, line {n}: {error}; allowed: cells of less text") from error
        if any(row):
            cells[n] = [cell.strip() for cell in row]
    names = [cell.lower() for cell in cells.pop(head + 1)]
    for number, row in cells.items():
        if len(row) != len(names):
            raise ValueError(f"{name}, line {number}: {len(row)} cells; allowed: {len(names)} cells")
    if not cells or len({*names}) < len(names):
        raise ValueError(f"{name} has no site, or a name twice; allowed: a row for each site")
    return pd.DataFrame.from_dict(cells, orient="index", columns=names)


def _numbers(name: str, table: pd.DataFrame, columns: Sequence[str]) -> Array:
    """Some columns as numbers (rows, columns)."""
    values = table[[*columns]].apply(pd.to_numeric, errors="coerce")
    for line in values.index[values.isna().any(axis=1)]:
        row = brief(",".join(table.loc[line]))
        raise ValueError(f"{name}, line {line}: {row}; allowed: numbers below {listed(columns, 4)}")
    numbers: Array = values.to_numpy(float)
    return numbers


def _ordinate(
    name: str, measure: str, levels: Array, values: Array, places: Sequence[object], years: float | None
) -> Ordinate:
    """The curve of a measure, from probabilities in some years, or from frequencies."""
    period = period_of(measure)
    if period is None:
        shown = brief(measure) if measure else "no imt"
        raise ValueError(f"{name}: {shown}; allowed: imt='PGA' or imt='SA(0.5)', or a folder SA0P5")
    where = [f"{name}, line {place}" for place in places]
    frequencies = values if years is None else annual_frequencies(values, years, where)
    return Ordinate(period, levels, frequencies, where, "g")


def _years(name: str, comments: str, given: float | None) -> float:
    stated = _YEARS.search(comments)
    years = (number_in(stated[1]) or 0.0) if stated else given
    if years is None:
        raise ValueError(f"investigation_time is missing and {name} does not state it; give it in years")
    if not 0 < years < np.inf:
        raise ValueError(f"{name}, line 1: investigation_time = {years:g}; allowed: a positive number")
    if given is not None and not np.isclose(years, given, rtol=1e-9):
        raise ValueError(f"investigation_time = {given:g} contradicts {name}, which states {years:g}")
    return years


def _chosen(name: str, coordinates: Sequence[Sequence[float]], site: Site | None) -> int:
    """Number, from 0, of the site that is asked for, or of the only one."""
    places = (", ".join(f"{degrees:g}" for degrees in place) for place in coordinates)
    sites = [f"{n} ({place})" for n, place in enumerate(places, 1)]
    if site is None:
        if len(sites) == 1:
            return 0
        raise ValueError(f"site is missing: {name} has {listed(sites, 6)}; give its number")
    if is_whole(site) and 1 <= site <= len(sites):
        return site - 1
    pair = isinstance(site, (list, tuple)) and len(site) == 2
    if not pair or not all(is_number(number) and np.isfinite(number) for number in site):  # type: ignore[union-attr]
        raise ValueError(f"site = {brief(site)} is not in {name}; allowed: {listed(sites, 6)}")
    away: Array = np.abs(np.array(coordinates, float) - np.array(site, float)).max(axis=1)
    nearest = int(np.argmin(away))
    if not away[nearest] <= _NEAR:
        raise ValueError(f"site = {brief(site)} is not in {name}, where the nearest is {sites[nearest]}")
    return nearest
