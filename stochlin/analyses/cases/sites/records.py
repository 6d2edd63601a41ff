"""The records of a case file: single records, and a suite of records."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import xarray as xr

from stochlin.analyses.cases.files.schema import READING, TIME
from stochlin.analyses.cases.files.sections import Section
from stochlin.analyses.cases.sites.strength import chosen_key
from stochlin.analyses.records.records import read_record
from stochlin.analyses.sites.suites import (
    Suite,
    doubtful_factor,
    read_records,
    scale_records,
    scaled_record,
)
from stochlin.messages import brief

SUITE, SCALE_TO = "suite", "scale_to"
_GOALS = ("pga", "sa", SCALE_TO)
_READING = tuple(key.name for key in READING)


def recorded_motions(site: Section, folder: Path) -> dict[str, xr.DataArray]:
    """The records by name, in the order of the file."""
    records: dict[str, xr.DataArray] = {}
    for record in site.sections("records"):
        record.only(*record.keys)
        path = record.read("path")
        name = record.read("name") or Path(path).name
        if name in records:
            raise record.error(
                "name" if "name" in record else "path", "is used twice; give it another name"
            )
        with record.naming("path", "cannot be read"):
            records[name] = read_record(folder / path, **_reading(record))
        if "scale" in record:
            factor = record.read("scale")
            if doubt := doubtful_factor(factor):
                record.doubt("scale", f"is doubtful: {doubt}")
            records[name] = scaled_record(records[name], factor)
    return records


def read_suite(
    site: Section, folder: Path, records: Suite, spectrum: xr.DataArray | None
) -> tuple[Suite, list[Path]]:
    """The records of the suite as they are in its files, and the paths of the suite.

    A ValueError is raised for a goal of `scaled_suite` that is not valid.
    """
    if SUITE not in site:
        return {}, []
    section = site.section(SUITE)
    section.only(*section.keys)
    path = folder / section.read("path")
    _goal(section, spectrum)
    kept = {key: section.read(key) for key in ("vertical", "skip_unreadable")}
    with section.naming("path"):
        suite = read_records(path, **_reading(section), **kept)
    for name in suite:
        if name in records:
            raise section.error(
                "path", f"has {brief(name)}, which site.records also has; give that another name"
            )
    beside = path if path.is_dir() else path.parent
    return suite, [path, *(beside / record.attrs["file"] for record in suite.values())]


def scaled_suite(site: Section, suite: Suite, spectrum: xr.DataArray | None) -> Suite:
    """The records of the suite, scaled to its goal if it has one."""
    if SUITE not in site:
        return suite
    section = site.section(SUITE)
    if goal := _goal(section, spectrum):
        with section.naming("path"):
            suite = scale_records(suite, **goal)
    return suite


def _goal(section: Section, spectrum: xr.DataArray | None) -> dict[str, Any]:
    """Arguments of `scale_records` for the suite; empty if it is not scaled."""
    key = chosen_key(section, _GOALS, {"sa_period": "sa", "band": SCALE_TO})
    if key == "pga":
        return {key: section.read(key)}
    if key == "sa":
        return {key: section.read(key), "period": section.read("sa_period")}
    if key == SCALE_TO:
        section.read(key)
        if spectrum is None:
            raise section.error(
                key, "is not there: the site has a ground; allowed: pga, sa, or a site by its spectrum"
            )
        goal: dict[str, Any] = {"spectrum": spectrum}
        if "band" in section:
            goal["band"] = _band(section)
        return goal
    return {}


def _band(section: Section) -> tuple[float, ...]:
    band = tuple(section.numbers("band", TIME))
    if len(band) != 2 or not band[0] < band[1]:
        raise section.error("band", 'is no band; allowed: two periods, as ["0.2 s", "2 s"]')
    return band


def _reading(section: Section) -> dict[str, Any]:
    """Arguments of `read_record` for a record, or for each of a suite."""
    return {key: section.read(key) for key in _READING if key in section}
