"""Intensity of the shaking in a case file: by S0, PGA, Sa at a period, or a return period."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from scipy import constants

from stochlin.analyses.cases.files.schema import (
    ACCELERATION,
    DEGREES,
    NUMBER,
    SPECTRAL_DENSITY,
    YEARS,
)
from stochlin.analyses.cases.files.sections import Section
from stochlin.analyses.risk.risk import simulated_at
from stochlin.analyses.sites.hazard_files import read_hazard
from stochlin.analyses.sites.intensity import paths_for, scale_ground
from stochlin.kernels.basics.parallel import Progress
from stochlin.models.envelopes import Envelope
from stochlin.models.grounds import Ground
from stochlin.models.hazards import Hazard, HazardCurve, PowerLawHazard, check_curve
from stochlin.models.plausible import OFTEN, PLAUSIBLE, STRONG

INTENSITY, RETURN_PERIOD, HAZARD = "intensity", "return_period", "hazard"
GOALS = ("pga", "sa", "sa_period", RETURN_PERIOD, HAZARD)  # keys besides or in place of an intensity
WAYS = {  # kinds of hazard, by the key that distinguishes them, with all keys of each kind
    "file": ("file", "units", "site", "coordinates", "investigation_time"),
    "intensities": ("intensities", "frequencies", "return_periods"),
    "k0": ("k0", "k", "units"),
}
HAZARD_EXAMPLES = (
    'file = "hazard.csv"; intensities = ["0.1 g", "0.3 g"] with frequencies = [0.01, 0.001] or '
    'return_periods = ["100 yr", "1000 yr"]; k0, k and units'
)
HAZARD_EXAMPLE = f'write [site.hazard], and below it measure = "pga" and one of {HAZARD_EXAMPLES}'
EXAMPLE = '"0.01 m^2/s^3", or pga = "0.3 g", or sa = "0.8 g" with sa_period = "1 s"'


class Goal(NamedTuple):
    """Wanted intensity of the motions: arguments of `scale_ground`, and the key that gives them."""

    key: str
    asked: dict[str, Any]


def read_goal(site: Section, hazard: Hazard | None) -> Goal | None:
    """The wanted intensity by PGA, Sa or a return period; None if the site has none of these."""
    key = chosen_key(site, (INTENSITY, "pga", "sa", RETURN_PERIOD), {"sa_period": "sa"})
    if key == "pga":
        return Goal(key, {key: site.read(key)})
    if key == "sa":
        return Goal(key, _sa(site.read(key), site.read("sa_period")))
    if key != RETURN_PERIOD:
        return None
    years = site.read(key)
    if hazard is None:
        raise site.error(key, f"needs a hazard; {HAZARD_EXAMPLE}")
    with site.naming(key, "is not in the hazard"):
        intensity = hazard.intensity(years)
    return Goal(
        key, {hazard.measure: intensity} if hazard.period is None else _sa(intensity, hazard.period)
    )


def read_hazard_of(site: Section, folder: Path) -> Hazard | None:
    """The hazard of the site, if it is given."""
    return described_hazard(site.section(HAZARD), folder) if HAZARD in site else None


def chosen_key(section: Section, keys: Sequence[str], companions: Mapping[str, str]) -> str:
    """The one of these keys that is given, or an empty text.

    A ValueError is raised for two of them, or for a companion key without the key that it belongs to.
    """
    present = [key for key in keys if key in section]
    if len(present) > 1:
        raise section.error(
            present[1],
            f"is given beside {present[0]}; allowed: one of {', '.join(keys)}, so leave the others out",
        )
    key = present[0] if present else ""
    for other, of in companions.items():
        if other in section and key != of:
            raise section.error(other, f"goes with {of}, which is missing; give both, or leave it out")
    return key


def doubtful_peak(pga: float) -> str:
    """Text of a warning on an implausible peak ground acceleration [m/s^2]; empty if plausible."""
    known = PLAUSIBLE["pga"]
    return "" if known.holds(pga) else f"{pga / constants.g:.3g} g, and {known.usually}"


def doubtful_hazard(hazard: Hazard) -> str:
    """Text of a warning on a hazard of a strength that no site has; empty if it is plausible."""
    strong = STRONG[hazard.measure]
    if isinstance(hazard, HazardCurve):  # not beyond its ends
        strong = max(strong, hazard.intensities[0])
    if isinstance(hazard, HazardCurve) and strong > hazard.intensities[-1]:
        return ""
    rate = float(hazard.frequency(strong))
    if rate * OFTEN < 1:
        return ""
    unit, size = ("m^2/s^3", 1.0) if hazard.measure == INTENSITY else ("g", constants.g)
    units = "is it in m/s^2 where it says g?" if unit == "g" else "are its units right?"
    return (
        f"it exceeds {hazard.measure} = {strong / size:.3g} {unit} once in {1 / rate:.3g} years, and no "
        f"site does so in less than {OFTEN:g}; {units}"
    )


def as_strong_as_asked(
    site: Section,
    goal: Goal | None,
    ground: Ground,
    spectrum: xr.DataArray | None,
    duration: float,
    envelope: Envelope | None,
    progress: Progress | None,
) -> tuple[Ground, xr.DataArray | None]:
    """Ground and spectrum of the site, scaled to the wanted intensity if the site has one."""
    if goal is None:
        return ground, spectrum
    scaled: Ground
    if INTENSITY in goal.asked:  # from a hazard of S0
        scaled = replace(ground, **goal.asked)
    else:
        with site.naming(goal.key, "cannot be met"):
            options: Any = {**goal.asked, "paths": paths_for(duration), "progress": progress}
            scaled = scale_ground(ground, duration, envelope, **options)
    if spectrum is not None:
        times = scaled.arrays()["intensity"].item() / ground.arrays()["intensity"].item()
        spectrum = (np.sqrt(times) * spectrum).assign_attrs(spectrum.attrs)
    return scaled, spectrum


def described_hazard(section: Section, folder: Path) -> Hazard:
    """The hazard from a file, from points in the case file, or by a power law."""
    way = next((key for key in ("file", "intensities") if key in section), "k0")
    section.only(
        "measure", "sa_period", *WAYS[way], elsewhere=[key for keys in WAYS.values() for key in keys]
    )
    measure = section.read("measure")
    if "sa_period" in section and measure != "sa":
        raise section.error("sa_period", f"goes with measure = 'sa', not with {measure!r}; leave it out")
    of: dict[str, Any] = {"measure": measure}
    if measure == "sa":
        of["period"] = section.read("sa_period")
    if way == "file":
        units = section.text("units", tuple(ACCELERATION.spellings)) if "units" in section else None
        place = chosen_key(section, ("site", "coordinates"), {})
        if place:
            of["site"] = section.read(place) if place == "site" else section.numbers(place, DEGREES)
        if "investigation_time" in section:
            of["investigation_time"] = section.read("investigation_time")
        with section.naming("file"):
            return read_hazard(_files(section, folder), **of, units=units)
    if way == "intensities":
        return _of_points(section, of)
    if "k0" not in section and "k" not in section:
        raise section.error("", f"has no numbers; allowed: one of {HAZARD_EXAMPLES}")
    k0, k = (section.read(key) for key in ("k0", "k"))
    # k0 is the annual frequency of exceedance of 1 in the unit of the file, for instance 1 g.
    units_of = (SPECTRAL_DENSITY if measure == INTENSITY else ACCELERATION).spellings
    unit = units_of[section.text("units", tuple(units_of))]
    try:
        k0 *= unit**k
    except OverflowError:
        k0 = np.inf
    if not 0 < k0 < np.inf:
        raise section.error(
            "k",
            f"is too large: with units = {section.values['units']!r}, k0 in SI units is beyond the "
            "range of numbers; allowed: an exponent that keeps it within; usual are 2 to 4, so "
            "correct k",
        )
    hazard = PowerLawHazard(k0, k, **of)
    with section.naming("k"):
        simulated_at(hazard)
    return hazard


def _of_points(section: Section, of: Mapping[str, Any]) -> HazardCurve:
    """Hazard curve from intensities, each with its annual frequency or return period."""
    intensities = section.numbers(
        "intensities", SPECTRAL_DENSITY if of["measure"] == INTENSITY else ACCELERATION
    )
    key = chosen_key(section, ("frequencies", "return_periods"), {})
    if not key:
        raise section.error(
            "intensities",
            "has neither frequencies nor return_periods; write, for instance, "
            'return_periods = ["95 yr", "475 yr"], as many as there are intensities',
        )
    values = section.numbers(key, NUMBER if key == "frequencies" else YEARS)
    if len(values) != len(intensities):
        raise section.error(
            key, f"has {len(values)} values for {len(intensities)} intensities; allowed: one for each"
        )
    frequencies = values if key == "frequencies" else [1 / years for years in values]
    places = [f"point {n}, {value}" for n, value in enumerate(section.values[key], start=1)]
    with section.naming("intensities", "does not fit the others"):
        check_curve(np.array(intensities), np.array(frequencies), places)
    return HazardCurve(tuple(intensities), tuple(frequencies), **of)


def hazard_file(site: Section, folder: Path) -> list[Path]:
    """Paths of the files of the hazard, if there are any."""
    hazard = site.section(HAZARD, needed=False)
    return _files(hazard, folder) if "file" in hazard else []


def _files(section: Section, folder: Path) -> list[Path]:
    """The file of the hazard, or several in a list."""
    given = section.values["file"]
    names = given if isinstance(given, list) and given else [given]
    return [folder / replace(section, values={"file": name}).read("file") for name in names]


def _sa(sa: float, period: float) -> dict[str, Any]:
    return {"sa": sa, "period": period}
