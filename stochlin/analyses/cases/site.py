"""The site and the motion of a case file: its records, its ground, its envelope."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import xarray as xr

from stochlin.analyses.cases.values import Quantity, Section
from stochlin.analyses.records.ground_fit import fitted_grounds
from stochlin.analyses.records.records import read_record
from stochlin.analyses.records.spectra import ESTIMATORS
from stochlin.analyses.sites.ground_fit import fit_ground
from stochlin.analyses.sites.motion_fit import RECORD_TO_RECORD
from stochlin.analyses.tables.checks import check_scatter
from stochlin.models.envelopes import ENVELOPES, Envelope
from stochlin.models.grounds import GROUNDS, Ground, WhiteNoise
from stochlin.models.grounds.named import ground_names, named_ground
from stochlin.models.parameters import POSITIVE

FITTED, NONE = "fitted", "none"
TIME = Quantity("s", POSITIVE)


def recorded_motions(site: Section, folder: Path) -> dict[str, xr.DataArray]:
    """The records by name, in the order of the file."""
    records: dict[str, xr.DataArray] = {}
    for one in site.sections("records"):
        one.only("path", "name", "units", "dt", "column", "time_column")
        path = one.text("path")
        name = one.text("name", default=Path(path).name)
        options: dict[str, Any] = {"units": one.text("units")} if "units" in one else {}
        if "dt" in one:
            options["dt"] = one.number("dt", TIME)
        for key in ("column", "time_column"):
            if key in one:
                options[key] = one.column(key)
        if name in records:
            raise one.error("name" if "name" in one else "path", "is there twice; give it another name")
        try:
            records[name] = read_record(folder / path, **options)
        except (OSError, ValueError) as error:
            raise one.error("path", f"cannot be read: {error}") from error
    return records


def read_ground(site: Section, records: Mapping[str, xr.DataArray]) -> Ground:
    """The ground, by name, by parameters, or fitted to the first record."""
    kinds = (*ground_names(), *GROUNDS, FITTED)
    name = site.text("ground", kinds)
    if name == FITTED:
        site.only("ground", "records", "model", "estimator")
        model = site.text("model", tuple(fitted_grounds()), "kanai_tajimi")
        estimator = site.text("estimator", tuple(ESTIMATORS), "psd")
        if not records:
            raise site.error("ground", "needs a record to be fitted to; allowed: a [[site.records]]")
        try:
            return fit_ground(next(iter(records.values())), model, estimator)
        except ValueError as error:
            raise site.error("ground", f"cannot be fitted to {next(iter(records))}: {error}") from error
    names = GROUNDS[name].parameter_names() if name in GROUNDS else ("intensity",)
    site.only("ground", "records", *names)
    if name not in GROUNDS:
        return named_ground(name, site.model(WhiteNoise, names).intensity)
    return site.model(GROUNDS[name], names)


def read_envelope(motion: Section) -> Envelope | None:
    """How the shaking rises and falls, if it is said."""
    name = motion.text("envelope", (*ENVELOPES, NONE), NONE)
    names = () if name == NONE else ENVELOPES[name].parameter_names()
    motion.only("duration", "envelope", "scatter", *names)
    return None if name == NONE else motion.model(ENVELOPES[name], names)


def usual_scatter(site: str) -> float:
    """That of a site by its spectrum or a record; 0 where the strength of the ground is given."""
    return 0.0 if site in (*ground_names(), *GROUNDS) else RECORD_TO_RECORD


def read_scatter(motion: Section, usual: float) -> float:
    """How motions differ in strength, as the verbs take it."""
    scatter = motion.values.get("scatter", usual)
    try:
        check_scatter(scatter)
    except ValueError as error:
        raise motion.error("scatter", f"cannot be used: {error}") from error
    return float(scatter)
