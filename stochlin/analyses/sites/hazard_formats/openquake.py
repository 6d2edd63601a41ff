"""Hazard curves of OpenQuake: a row of probabilities for each site, one intensity measure a file.

GEM, OpenQuake Engine manual, Outputs from classical PSHA, ``hazard_curve-mean-PGA_17.csv``: a comment
with ``investigation_time=50.0, imt='PGA'``, the columns ``lon,lat,depth,poe-0.005,...``, whose names
have the intensities, in g for ``PGA`` and ``SA``, and a row for each site with the probabilities that
they are exceeded in the investigation time [yr].
"""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from stochlin.analyses.records.formats import as_float
from stochlin.analyses.sites.hazard_formats import (
    HAZARD_FORMATS,
    AskedHazard,
    HazardFormat,
    Ordinate,
    Site,
    annual_frequencies,
)
from stochlin.kernels.basics.arrays import Array
from stochlin.messages import brief, listed
from stochlin.models.arguments import is_number, is_whole

_START = re.compile(r"(?:[\"']?#[^\n]*\n)+\"?lon\"?,\"?lat\"?,[^\n]*poe-", re.IGNORECASE)
_YEARS = re.compile(r"investigation_time\s*=\s*([\d.eE+-]+)")
_MEASURE = re.compile(r"\bimt\s*=\s*[\"']*([A-Za-z]\w*)(?:\(([^)]*)\))?")
_LEVEL = "poe-"
_NEAR = 0.01  # degrees, about 1 km: largest distance of a site that is named by its coordinates


def _read(name: str, text: str, asked: AskedHazard) -> list[Ordinate]:
    lines = [(n, line) for n, line in enumerate(text.split("\n"), 1) if line.strip()]
    comments = [line for _, line in lines if line.lstrip("\"'").startswith("#")]
    (head, names), *rows = lines[len(comments) :]
    columns = [field.strip(' "') for field in names.split(",")]
    levels = [(k, as_float(c[len(_LEVEL) :])) for k, c in enumerate(columns) if c.startswith(_LEVEL)]
    if any(level is None for _, level in levels):
        raise ValueError(f"{name}, line {head}: {brief(names)}; allowed: names such as 'poe-0.005'")
    tables = {n: _row(name, n, line, len(columns)) for n, line in rows}
    if not tables:
        raise ValueError(f"{name} has no site; allowed: a row of probabilities for each site")
    number = list(tables)[_chosen(name, [row[:2] for row in tables.values()], asked.site)]
    intensities = np.array([level for _, level in levels], float)
    places = [f"{name}, line {number}, column {columns[k]}" for k, _ in levels]
    probabilities = np.array([tables[number][k] for k, _ in levels])
    frequencies = annual_frequencies(probabilities, _years(name, comments, asked.years), places)
    return [Ordinate(_period(name, comments), intensities, frequencies, places, "g")]


def _row(name: str, number: int, line: str, columns: int) -> list[float]:
    values = [as_float(field.strip(' "')) for field in line.split(",")]
    known = [value for value in values if value is not None]
    if len(known) != columns or len(values) != columns:
        raise ValueError(f"{name}, line {number}: {brief(line)}; allowed: {columns} numbers")
    return known


def _years(name: str, comments: Sequence[str], given: float | None) -> float:
    stated = _YEARS.search("\n".join(comments))
    years = (as_float(stated[1]) or 0.0) if stated else given
    if years is None:
        raise ValueError(f"investigation_time is missing and {name} does not state it; give it in years")
    if not 0 < years < np.inf:
        raise ValueError(f"{name}, line 1: investigation_time = {years:g}; allowed: a positive number")
    if given is not None and not np.isclose(years, given, rtol=1e-9):
        raise ValueError(
            f"investigation_time = {given:g} contradicts {name}, which states {years:g}; leave it out"
        )
    return years


def _period(name: str, comments: Sequence[str]) -> float:
    stated = _MEASURE.search("\n".join(comments))
    kind, period = (stated[1], as_float((stated[2] or "").split(",")[0])) if stated else ("", None)
    if kind == "PGA":
        return 0.0
    if kind != "SA" or period is None or not 0 < period < np.inf:
        shown = brief(stated[0]) if stated else "no imt"
        raise ValueError(f"{name}, line 1: {shown}; allowed: imt='PGA' or imt='SA(0.5)'")
    return period


def _chosen(name: str, coordinates: Sequence[Sequence[float]], site: Site | None) -> int:
    """Number, from 0, of the site that is asked for, or of the only one."""
    sites = [f"{n} ({lon:g}, {lat:g})" for n, (lon, lat) in enumerate(coordinates, 1)]
    if site is None:
        if len(sites) == 1:
            return 0
        raise ValueError(
            f"site is missing: {name} has {len(sites)} sites, {listed(sites, 6)}; give the number of "
            "one, or its longitude and latitude"
        )
    if is_whole(site):
        if 1 <= site <= len(sites):
            return site - 1
        raise ValueError(f"site = {brief(site)} is not in {name}; allowed: 1 to {len(sites)}")
    pair = isinstance(site, (list, tuple)) and len(site) == 2
    if not pair or not all(is_number(number) and np.isfinite(number) for number in site):  # type: ignore[union-attr]
        raise TypeError(
            f"site = {brief(site)}; allowed: a number from 1, or longitude and latitude in degrees"
        )
    away: Array = np.abs(np.array(coordinates, float) - np.array(site, float)).max(axis=1)
    nearest = int(np.argmin(away))
    if not away[nearest] <= _NEAR:
        raise ValueError(
            f"site = {brief(site)} is not in {name}, where the nearest one is {sites[nearest]}; "
            f"allowed: a site within {_NEAR:g} degrees"
        )
    return nearest


HAZARD_FORMATS.register("openquake")(HazardFormat("a file of OpenQuake", _START, _read))
