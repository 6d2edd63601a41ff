"""The tables [site] and [motion] of a case file: ground, fitted motion, envelope and scatter."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import xarray as xr

from stochlin.analyses.cases.sites.records import SUITE
from stochlin.analyses.cases.sites.strength import EXAMPLE, GOALS, HAZARD, INTENSITY
from stochlin.analyses.cases.values import Quantity, Section
from stochlin.analyses.records.ground_fit import fitted_grounds
from stochlin.analyses.records.spectra import ESTIMATORS
from stochlin.analyses.sites.ground_fit import fit_ground
from stochlin.analyses.sites.motion_fit import (
    FILTERS,
    RECORD_TO_RECORD,
    FittedMotion,
    energy_ratio,
    fit_motion,
)
from stochlin.analyses.sites.spectrum_fit import MOST_FILTERS
from stochlin.analyses.tables.checks import check_scatter
from stochlin.models.envelopes import ENVELOPES, Envelope
from stochlin.models.grounds import GROUNDS, Ground, ParallelGround, WhiteNoise
from stochlin.models.grounds.named import ground_names, named_ground
from stochlin.models.parameters import POSITIVE
from stochlin.models.uncertain import UncertainModel

FITTED, NONE, PARALLEL = "fitted", "none", "parallel"
RECORDS = ("records", SUITE)
TIME = Quantity("s", POSITIVE)
_LIKE = 0.8, 1.25  # range of the energy of motions over that of a record without a warning


def read_ground(site: Section, records: Mapping[str, xr.DataArray]) -> Any:
    """The ground by name or by parameters, fitted to the first record, or several in parallel.

    It is an uncertain model if parameters are uncertain.
    """
    kinds = (*ground_names(), *GROUNDS, FITTED, PARALLEL)
    name = site.text("ground", kinds)
    if name == FITTED:
        site.only("ground", *RECORDS, "model", "estimator", *GOALS)
        model = site.text("model", tuple(fitted_grounds()), "kanai_tajimi")
        estimator = site.text("estimator", tuple(ESTIMATORS), "psd")
        if "records" not in site:
            raise site.error("ground", "needs a record to be fitted to; allowed: a [[site.records]]")
        try:
            return fit_ground(next(iter(records.values())), model, estimator)
        except ValueError as error:
            raise site.error("ground", f"cannot be fitted to {next(iter(records))}: {error}") from error
    if name == PARALLEL:
        site.only("ground", *RECORDS, INTENSITY, "grounds", *GOALS)
        for part in site.sections("grounds"):
            part.text("ground", (*ground_names(), *GROUNDS))
        quantity = Quantity.declared(ParallelGround, INTENSITY)
        whole = {INTENSITY: site.parameter(INTENSITY, quantity)} if INTENSITY in site else {}
        parts = [_part(part) for part in site.sections("grounds")]
        return site.made(ParallelGround, {"grounds": parts, **whole})
    names = GROUNDS[name].parameter_names() if name in GROUNDS else (INTENSITY,)
    site.only("ground", *RECORDS, *names, *GOALS)
    if not any(key in site for key in (INTENSITY, *GOALS) if key != HAZARD):
        raise site.error(INTENSITY, f"is missing; write, for instance, intensity = {EXAMPLE}")
    kind = GROUNDS.get(name, WhiteNoise)
    own = [each for each in names if each in site or each != INTENSITY]
    values: dict[str, Any] = {INTENSITY: 1.0}
    values |= {each: site.parameter(each, Quantity.declared(kind, each)) for each in own}
    return site.made(kind, values) if name in GROUNDS else named_ground(name, **values)


def _part(site: Section) -> Ground:
    """One of several parallel grounds."""
    described = read_ground(site, {})
    if isinstance(described, UncertainModel):
        raise site.error(
            next(iter(described.uncertain)),
            "cannot be uncertain in one of several grounds; allowed: one number, or an uncertain "
            "intensity of all of them together in [site]",
        )
    ground: Ground = described
    return ground


def fitted_motion(
    site: Section, motion: Section, records: Mapping[str, xr.DataArray]
) -> FittedMotion | None:
    """Ground, envelope and duration fitted to the first record; None unless envelope is "fitted"."""
    if motion.values.get("envelope") != FITTED:
        return None
    if site.values.get("ground") != FITTED or not records:
        raise motion.error(
            "envelope",
            'goes with a ground that is fitted as well; allowed: ground = "fitted" in [site], and a '
            "[[site.records]]",
        )
    motion.only("envelope", "scatter")  # the duration is that of the record
    site.only("ground", "records", "filters", HAZARD)
    filters = site.whole("filters", 1, FILTERS, MOST_FILTERS)
    name, record = next(iter(records.items()))
    try:
        return fit_motion(record, filters=filters)
    except (ArithmeticError, ValueError) as error:
        raise motion.error("envelope", f"cannot be fitted to {name}: {error}") from error


def check_energy(
    motion: Section, record: xr.DataArray, ground: Ground, envelope: Envelope | None, duration: float
) -> None:
    """Warn if motions on a fitted ground have much less or more energy than its record."""
    ratio = energy_ratio(record, ground, envelope, duration)
    if not _LIKE[0] <= ratio <= _LIKE[1]:
        motion.doubt(
            "envelope",
            f"and the duration give motions with {ratio:.2g} times the energy of the record that the "
            f'ground is fitted to; for equal energy write envelope = "{FITTED}", without a duration',
        )


def read_envelope(motion: Section) -> Envelope | None:
    """The envelope of the motion, or None."""
    name = motion.text("envelope", (*ENVELOPES, NONE, FITTED), NONE)
    names = () if name == NONE else ENVELOPES[name].parameter_names()
    motion.only("duration", "envelope", "scatter", *names)
    return None if name == NONE else motion.model(ENVELOPES[name], names)


def usual_scatter(site: str) -> float:
    """Default scatter [-]: 0 for one ground by name or by parameters, else that between records."""
    return 0.0 if site in (*ground_names(), *GROUNDS) else RECORD_TO_RECORD


def read_scatter(motion: Section, usual: float) -> float:
    """Scatter of the ground acceleration between motions [-], or its default."""
    scatter = motion.values.get("scatter", usual)
    try:
        check_scatter(scatter)
    except ValueError as error:
        raise motion.error("scatter", f"cannot be used: {error}") from error
    return float(scatter)
