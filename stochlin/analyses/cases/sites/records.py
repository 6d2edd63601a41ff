"""The records of a case file: single records, and a suite of records."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import xarray as xr

from stochlin.analyses.cases.sites.strength import PEAK, RESPONSE, TIME, chosen_key
from stochlin.analyses.cases.values import Quantity, Section
from stochlin.analyses.records.records import read_record
from stochlin.analyses.sites.suites import (
    Suite,
    doubtful_factor,
    read_records,
    scale_records,
    scaled_record,
)
from stochlin.messages import brief
from stochlin.models.parameters import POSITIVE

SUITE, SCALE_TO = "suite", "scale_to"
SCALE = Quantity("1", POSITIVE)
_GOALS = ("pga", "sa", SCALE_TO)
_READING = ("units", "dt", "column", "time_column")


def recorded_motions(site: Section, folder: Path) -> dict[str, xr.DataArray]:
    """The records by name, in the order of the file."""
    records: dict[str, xr.DataArray] = {}
    for one in site.sections("records"):
        one.only("path", "name", *_READING, "scale")
        path = one.text("path")
        name = one.text("name", default=Path(path).name)
        if name in records:
            raise one.error("name" if "name" in one else "path", "is used twice; give it another name")
        with one.naming("path", "cannot be read"):
            records[name] = read_record(folder / path, **_reading(one))
        if "scale" in one:
            factor = one.number("scale", SCALE)
            if doubt := doubtful_factor(factor):
                one.doubt("scale", f"is doubtful: {doubt}")
            records[name] = scaled_record(records[name], factor)
    return records


def read_suite(
    site: Section, folder: Path, records: Suite, spectrum: xr.DataArray | None
) -> tuple[Suite, list[Path]]:
    """The single records followed by those of the suite, and the paths of the suite."""
    if SUITE not in site:
        return records, []
    one = site.section(SUITE)
    one.only("path", *_READING, "skip_unreadable", *_GOALS, "sa_period", "band")
    path = folder / one.text("path")
    goal, skip = _goal(one, spectrum), one.truth("skip_unreadable")
    with one.naming("path"):
        suite = read_records(path, **_reading(one), skip_unreadable=skip)
        if goal:
            suite = scale_records(suite, **goal)
    for name in suite:
        if name in records:
            raise one.error(
                "path", f"has {brief(name)}, which site.records also has; give that another name"
            )
    files = [(path if path.is_dir() else path.parent) / name for name in suite]
    return {**records, **suite}, [path, *files]


def _goal(one: Section, spectrum: xr.DataArray | None) -> dict[str, Any]:
    """Arguments of `scale_records` for the suite; empty if it is not scaled."""
    key = chosen_key(one, _GOALS, {"sa_period": "sa", "band": SCALE_TO})
    if key == "pga":
        return {key: one.number(key, PEAK)}
    if key == "sa":
        return {key: one.number(key, RESPONSE), "period": one.number("sa_period", TIME)}
    if key == SCALE_TO:
        one.text(key, ("spectrum",))
        if spectrum is None:
            raise one.error(
                key, "is not there: the site has a ground; allowed: pga, sa, or a site by its spectrum"
            )
        goal: dict[str, Any] = {"spectrum": spectrum}
        if "band" in one:
            goal["band"] = _band(one)
        return goal
    return {}


def _band(one: Section) -> tuple[float, ...]:
    band = tuple(one.numbers("band", TIME))
    if len(band) != 2 or not band[0] < band[1]:
        raise one.error("band", 'is no band; allowed: two periods, as ["0.2 s", "2 s"]')
    return band


def _reading(one: Section) -> dict[str, Any]:
    """Arguments of `read_record` for a record, or for each of a suite."""
    options: dict[str, Any] = {"units": one.text("units")} if "units" in one else {}
    if "dt" in one:
        options["dt"] = one.number("dt", TIME)
    for key in ("column", "time_column"):
        if key in one:
            options[key] = one.column(key)
    return options
