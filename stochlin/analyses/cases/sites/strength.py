"""How strong the shaking of a case file is: by S0, PGA, Sa at a period, or a return period."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from stochlin.analyses.cases.values import Quantity, Section
from stochlin.analyses.records.files import METRES, read_series, rows_in_words, stated_units
from stochlin.analyses.sites.intensity import paths_for, scale_ground
from stochlin.messages import plain
from stochlin.models.envelopes import Envelope
from stochlin.models.grounds import Ground
from stochlin.models.hazards import Hazard, HazardCurve, PowerLawHazard, check_curve
from stochlin.models.parameters import POSITIVE

INTENSITY, RETURN_PERIOD, HAZARD = "intensity", "return_period", "hazard"
GOALS = ("pga", "sa", "sa_period", RETURN_PERIOD, HAZARD)  # keys beside or in place of an intensity
ACCELERATION, TIME = Quantity("m/s^2", POSITIVE), Quantity("s", POSITIVE)
YEARS, NUMBER = Quantity("yr", POSITIVE), Quantity("1", POSITIVE)
MEASURES = ("pga", "sa")
STRONGEST, WEAKEST = 3.0, 1e-3  # peak ground accelerations in g: beyond, units are likely to be mixed up
EXAMPLE = '"0.01 m^2/s^3", or pga = "0.3 g", or sa = "0.8 g" with sa_period = "1 s"'


class Goal(NamedTuple):
    """How strong the motions are to be: arguments of `scale_ground`, and the key that says so."""

    key: str
    asked: dict[str, Any]


def read_goal(site: Section, folder: Path) -> Goal | None:
    """What the site says in place of an intensity; None if nothing."""
    of = {"sa_period": "sa", HAZARD: RETURN_PERIOD}
    key = chosen_key(site, (INTENSITY, "pga", "sa", RETURN_PERIOD), of)
    if key == "pga":
        pga = site.number(key, ACCELERATION)
        if doubt := doubtful_peak(pga):
            site.doubt(key, f"is doubtful: {doubt}")
        return Goal(key, {"pga": pga})
    if key == "sa":
        return Goal(key, _sa(site.number(key, ACCELERATION), site.number("sa_period", TIME)))
    if key != RETURN_PERIOD:
        return None
    years = site.number(key, YEARS)
    if HAZARD not in site:
        raise site.error(
            key,
            'needs a hazard; write [site.hazard], and below it measure = "pga", and file = "hazard.csv" '
            "or k0, k and units",
        )
    hazard = read_hazard(site.section(HAZARD), folder)
    with site.naming(key, "is not in the hazard"):
        found = hazard.intensity(years)
    return Goal(key, {"pga": found} if hazard.period is None else _sa(found, hazard.period))


def chosen_key(one: Section, keys: Sequence[str], companions: Mapping[str, str]) -> str:
    """The one of these keys that is there, if any; an error for two, or for what goes with another."""
    given = [key for key in keys if key in one]
    if len(given) > 1:
        raise one.error(
            given[1],
            f"is given beside {given[0]}; allowed: one of {', '.join(keys)}, so leave the others out",
        )
    key = given[0] if given else ""
    for other, of in companions.items():
        if other in one and key != of:
            raise one.error(other, f"goes with {of}, which is not there; give both, or leave it out")
    return key


def doubtful_peak(pga: float) -> str:
    """What is doubtful about a peak ground acceleration [m/s^2]; empty if nothing is."""
    shown = f"{pga / METRES['g']:.3g} g"
    if pga > STRONGEST * METRES["g"]:
        return (
            f"{shown}, and more than 3 g has hardly been recorded: an acceleration in gal may be taken "
            "for one in m/s^2 or g"
        )
    if pga < WEAKEST * METRES["g"]:
        return f"{shown} is hardly felt: an acceleration in g or m/s^2 may be taken for one in gal"
    return ""


def as_strong_as_asked(
    site: Section,
    folder: Path,
    ground: Ground,
    spectrum: xr.DataArray | None,
    duration: float,
    envelope: Envelope | None,
) -> tuple[Ground, xr.DataArray | None]:
    """Ground and spectrum of the site, as strong as it asks for; as they are where it does not."""
    goal = read_goal(site, folder)
    if goal is None:
        return ground, spectrum
    with site.naming(goal.key, "cannot be met"):
        found: Ground = scale_ground(ground, duration, envelope, **goal.asked, paths=paths_for(duration))
    if spectrum is not None:
        times = found.arrays()["intensity"].item() / ground.arrays()["intensity"].item()
        spectrum = (np.sqrt(times) * spectrum).assign_attrs(spectrum.attrs)
    return found, spectrum


def read_hazard(one: Section, folder: Path) -> Hazard:
    """A table of a file, or a power law; both say of what, and in which units."""
    by_file = "file" in one
    keys = ("file", "units") if by_file else ("k0", "k", "units")
    one.only("measure", "sa_period", *keys, elsewhere=("file", "k0", "k"))
    measure = one.text("measure", MEASURES)
    if "sa_period" in one and measure != "sa":
        raise one.error("sa_period", f"goes with measure = 'sa', not with {measure!r}; leave it out")
    of: dict[str, Any] = {"measure": measure}
    if measure == "sa":
        of["period"] = one.number("sa_period", TIME)
    if by_file:
        return _curve(one, folder, of)
    k0, k = (one.number(key, NUMBER) for key in ("k0", "k"))
    # k0 is how often 1 g, or whatever the unit is, is exceeded.
    unit = METRES[one.text("units", tuple(METRES))]
    return PowerLawHazard(k0 * unit**k, k, **of)


def hazard_file(site: Section, folder: Path) -> list[Path]:
    """The file that the hazard is read from, if there is one."""
    hazard = site.section(HAZARD, needed=False)
    return [folder / hazard.text("file")] if "file" in hazard else []


def _curve(one: Section, folder: Path, of: dict[str, Any]) -> Hazard:
    path = folder / one.text("file")
    units = one.text("units", tuple(METRES)) if "units" in one else None
    with one.naming("file"):
        intensities, frequencies = (read_series(path, column, None) for column in (0, 1))
        values = intensities.values * METRES[stated_units(intensities, plain(path.name), units)]
        check_curve(intensities.values, frequencies.values, rows_in_words(path))
    return HazardCurve(tuple(values), tuple(frequencies.values), **of)


def _sa(sa: float, period: float) -> dict[str, Any]:
    return {"sa": sa, "period": period}
