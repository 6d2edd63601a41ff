"""The tables of a case file with their keys.

Parameters of grounds, envelopes, laws, contacts and links that need no words of their own are keys as
well, by the names, units and ranges of these models. The example of a case explains each key.
"""

from __future__ import annotations

from collections.abc import Mapping

from stochlin.analyses.cases.files.keys import Column, Key, Place, Slider, declared, table
from stochlin.analyses.cases.files.quantities import Quantity
from stochlin.models.arguments import Whole
from stochlin.models.buildings import RegularBuilding, ShearBuilding
from stochlin.models.grounds import MOST_FILTERS, CloughPenzien
from stochlin.models.hazards import MEASURES
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.parameters import NOT_NEGATIVE, POSITIVE, Range
from stochlin.models.plausible import PLAUSIBLE
from stochlin.models.rules.codes import ZONES

FEWEST_PATHS = 100  # smallest number of motions for a quantile with an interval
TIME, YEARS, NUMBER = Quantity("s", POSITIVE), Quantity("yr", POSITIVE), Quantity("1", POSITIVE)
ACCELERATION, SPECTRAL_DENSITY = Quantity("m/s^2", POSITIVE), Quantity("m^2/s^3", POSITIVE)
PEAK, RESPONSE = (ACCELERATION._replace(plausible=PLAUSIBLE[name]) for name in ("pga", "sa"))
HEIGHT = Quantity("m", POSITIVE, PLAUSIBLE["height"])
GAP = Quantity("m", NOT_NEGATIVE, PLAUSIBLE["existing"])
SHARE = Quantity("1", Range(upper=1.0, reason="a probability"))
STOREY_HEIGHT = Quantity.declared(ShearBuilding, "heights")
# Limits of the explorer's entries, which keep its computing time below hours.
PERIODS, DURATIONS = Range(0.02, 20.0, True, True), Range(1.0, 300.0, True, True)
HEIGHTS, FACTORS = Range(1.0, 20.0, True, True), Range(upper=100.0, include_upper=True)
MOST_WEIGHT = PLAUSIBLE["base_shear_coefficient"].high
SHEARS = Range(upper=MOST_WEIGHT, include_upper=True, reason="a share of the weight")
SHOWN_STOREYS, SHOWN_PATHS = Whole(1, 60), Whole(FEWEST_PATHS, 20_000)
OF_FACTOR = (
    "R is relative to the elastic response, so that a stronger ground motion makes the building "
    "stronger as well; choose the yield displacement above to keep the strength as it is."
)
OF_SCALE = (
    "The spectrum of the file has this one slider: a factor on all of its accelerations, at every "
    "period alike."
)

ALL = table(Key("title", str, default=None))
SITE = table(
    Key("ag", PEAK, "Acceleration ag", slider=Slider(0.02, 0.8, 0.01, "g")),
    Key("soil", tuple("ABCDE"), "Ground type"),
    Key("type", Whole(1, 2), "Type of spectrum", 1),
    Key("sds", RESPONSE, "SDS", slider=Slider(0.05, 2.5, 0.01, "g")),
    Key("sd1", RESPONSE, "SD1", slider=Slider(0.02, 1.5, 0.01, "g")),
    Key("tl", TIME, "TL", slider=Slider(4.0, 16.0, 1.0, "s")),
    Key("pga", PEAK, "Peak acceleration, mean", slider=Slider(0.01, 1.0, 0.01, "g")),
    Key("sa", RESPONSE, "Spectral acceleration, mean", slider=Slider(0.01, 2.0, 0.01, "g")),
    Key("sa_period", TIME, "Its period", slider=Slider(0.1, 4.0, 0.01, "s", PERIODS)),
    Key("scale", NUMBER, "Scale of the spectrum", slider=Slider(0.1, 4.0, 0.05, about=OF_SCALE)),
    declared(CloughPenzien, "intensity", "Intensity S0", Slider(0.0005, 0.05, 0.0005, "m^2/s^3")),
    declared(CloughPenzien, "period", "Ground period", Slider(0.1, 4.0, 0.01, "s", PERIODS)),
    declared(CloughPenzien, "damping", "Ground damping ratio", Slider(0.02, 1.0, 0.01)),
    declared(CloughPenzien, "high_pass_period", "High-pass period", Slider(1.0, 20.0, 0.1, "s")),
    declared(CloughPenzien, "high_pass_damping", "High-pass damping ratio", Slider(0.05, 1.5, 0.05)),
    Key("return_period", YEARS),
    Key("filters", Whole(1, MOST_FILTERS), default=None),
    Key("units", str, default=None),
    Key("column", Column, default=None),
    Key("period_column", Column, default=None),
)
READING = (
    Key("units", str, default=None),
    Key("dt", TIME, "Time step", None),
    Key("column", Column, default=None),
    Key("time_column", Column, default=None),
)
RECORD = table(
    Key("path", str), Key("name", str, default=None), *READING, Key("scale", NUMBER, default=None)
)
SUITE = table(
    Key("path", str),
    *READING,
    Key("skip_unreadable", bool, default=False),
    Key("pga", PEAK),
    Key("sa", RESPONSE),
    Key("sa_period", TIME),
    Key("scale_to", ("spectrum",)),
    Key("band", TIME),
)
HAZARD = table(
    Key("measure", MEASURES),
    Key("sa_period", TIME),
    Key("file", str),
    Key("k0", NUMBER),
    Key("k", NUMBER),
    Key("return_periods", YEARS),
    Key("frequencies", NUMBER),
)
MOTION = table(Key("duration", TIME, slider=Slider(5.0, 120.0, 1.0, "s", DURATIONS)))
BUILDING = table(
    Key("name", str, default=None),
    declared(Bilinear, "period", "Period", Slider(0.1, 4.0, 0.01, "s", PERIODS)),
    Key("storeys", Whole(1), default=None, slider=Slider(1, 30, 1, "", SHOWN_STOREYS)),
    Key("storey_height", STOREY_HEIGHT, slider=Slider(2.5, 6.0, 0.05, "m", HEIGHTS)),
    declared(Bilinear, "damping", "Damping ratio", Slider(0.005, 0.3, 0.005)),
    declared(
        *(Bilinear, "reduction_factor", "Reduction factor R"),
        Slider(0.5, 10.0, 0.1, "", FACTORS, OF_FACTOR),
    ),
    declared(Bilinear, "yield_displacement", "Yield displacement", Slider(0.2, 30.0, 0.1, "cm")),
    declared(RegularBuilding, "base_shear_coefficient", "", Slider(0.02, 0.6, 0.01, "", SHEARS)),
    Key("strength_factor", Quantity("1", FACTORS), default=1.0, slider=Slider(0.1, 4.0, 0.05)),
    declared(Bilinear, "hardening", "Hardening ratio", Slider(0.01, 1.0, 0.01)),
    Key("height", HEIGHT, default=None),
    Key("elastic", bool, default=False),
    Key("p_delta", bool, "Weight softens storeys (P-delta)", False),
)
SEPARATION = table(
    Key("existing", GAP, "Existing gap", None, Slider(0.5, 60.0, 0.5, "cm", POSITIVE)),
    Key("confidence", SHARE, "Confidence of no pounding", slider=Slider(0.5, 0.99, 0.01)),
    Key("floors_align", bool, default=False),
    Key("same_property", bool, "On one property", False),
    Key("same_system", bool, "Same structural system", False),
    Key("zone", tuple(ZONES), "Zone of Mexico City", None),
    Key("unverified", bool, "Rules that are not compared with their source", False),
)
SIMULATION = table(
    Key(
        "paths", Whole(FEWEST_PATHS), "Simulated motions", 2048, Slider(256, 8192, 256, "", SHOWN_PATHS)
    ),
    Key("seed", Whole(0), default=0),
)
MITIGATION = table(Key("amplification_limit", NUMBER))

TABLES: Mapping[str, Mapping[str, Key]] = {
    "": ALL,
    "site": SITE,
    "site.records": RECORD,
    "site.suite": SUITE,
    "site.hazard": HAZARD,
    "motion": MOTION,
    "building": BUILDING,
    "separation": SEPARATION,
    "simulation": SIMULATION,
    "mitigation": MITIGATION,
}


def keys_at(place: Place) -> Mapping[str, Key]:
    """The keys of the table at a place of a file; none where all are those of models."""
    name = ".".join(name for name in place if isinstance(name, str))
    return TABLES.get("building" if name.startswith("building_") else name, {})
