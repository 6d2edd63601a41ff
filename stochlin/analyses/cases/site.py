"""The site and the motion of a case file: its ground, its envelope."""

from __future__ import annotations

from collections.abc import Mapping

import xarray as xr

from stochlin.analyses.cases.sites.records import SUITE
from stochlin.analyses.cases.sites.strength import EXAMPLE, GOALS, INTENSITY
from stochlin.analyses.cases.values import Quantity, Section
from stochlin.analyses.records.ground_fit import fitted_grounds
from stochlin.analyses.records.spectra import ESTIMATORS
from stochlin.analyses.sites.ground_fit import fit_ground
from stochlin.models.envelopes import ENVELOPES, Envelope
from stochlin.models.grounds import GROUNDS, Ground, WhiteNoise
from stochlin.models.grounds.named import ground_names, named_ground
from stochlin.models.parameters import POSITIVE

FITTED, NONE = "fitted", "none"
RECORDS = ("records", SUITE)
TIME = Quantity("s", POSITIVE)


def read_ground(site: Section, records: Mapping[str, xr.DataArray]) -> Ground:
    """The ground, by name, by parameters, or fitted to the first record."""
    kinds = (*ground_names(), *GROUNDS, FITTED)
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
    names = GROUNDS[name].parameter_names() if name in GROUNDS else (INTENSITY,)
    site.only("ground", *RECORDS, *names, *GOALS)
    if INTENSITY not in site and not any(key in site for key in GOALS):
        raise site.error(INTENSITY, f"is missing; write, for instance, intensity = {EXAMPLE}")
    kind = GROUNDS.get(name, WhiteNoise)
    given = [own for own in names if own in site or own != INTENSITY]
    values = {INTENSITY: 1.0} | {own: site.number(own, Quantity.declared(kind, own)) for own in given}
    return site.made(kind, values) if name in GROUNDS else named_ground(name, **values)


def read_envelope(motion: Section) -> Envelope | None:
    """How the shaking rises and falls, if it is said."""
    name = motion.text("envelope", (*ENVELOPES, NONE), NONE)
    names = () if name == NONE else ENVELOPES[name].parameter_names()
    motion.only("duration", "envelope", *names)
    return None if name == NONE else motion.model(ENVELOPES[name], names)
