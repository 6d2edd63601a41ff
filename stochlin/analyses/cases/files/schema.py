"""The tables of a case file with their keys.

Parameters of grounds, envelopes, laws, contacts and links that need no words of their own are keys as
well, by the names, units and ranges of these models. The example of a case explains each key.
"""

from __future__ import annotations

import re
from collections.abc import Mapping

from stochlin.analyses.buildings.modes import DIRECTIONS
from stochlin.analyses.cases.files.keys import NEEDED, Column, Key, Place, Slider, declared, table
from stochlin.analyses.cases.files.quantities import Quantity
from stochlin.analyses.sites.spectra import BETWEEN
from stochlin.models.arguments import Whole
from stochlin.models.buildings import (
    STOREYS,
    ModalBuilding,
    RegularBuilding,
    ShearBuilding,
)
from stochlin.models.envelopes import AminAng, GammaEnvelope, ShinozukaSato
from stochlin.models.grounds import MOST_FILTERS, CloughPenzien
from stochlin.models.hazards import MEASURES
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.parameters import NOT_NEGATIVE, POSITIVE, Range
from stochlin.models.plausible import PLAUSIBLE, Plausible
from stochlin.models.rules.codes import AT_LEAST_1, OF_IMPORTANCE, ZONES

FEWEST_PATHS = 100  # smallest number of motions for a quantile with an interval
TIME, YEARS, NUMBER = Quantity("s", POSITIVE), Quantity("yr", POSITIVE), Quantity("1", POSITIVE)
DEGREES = Quantity("1", Range(-360.0, 360.0, True, True), Plausible(-360.0, 360.0, "", ""))
ACCELERATION, SPECTRAL_DENSITY = Quantity("m/s^2", POSITIVE), Quantity("m^2/s^3", POSITIVE)
PEAK, RESPONSE, AG, SDS = (
    ACCELERATION._replace(plausible=PLAUSIBLE[name]) for name in ("pga", "sa", "ag", "sds")
)
HEIGHT = Quantity("m", POSITIVE, PLAUSIBLE["height"])
GAP = Quantity("m", NOT_NEGATIVE, PLAUSIBLE["gap"])
DISPLACEMENT = Quantity("m", NOT_NEGATIVE, PLAUSIBLE["displacements"])
CODE_FACTOR = Quantity("1", AT_LEAST_1, PLAUSIBLE["behaviour"])
FACTOR = Quantity("1", Range(upper=100.0, include_upper=True))
SHARE = Quantity("1", Range(upper=1.0, reason="a probability"), PLAUSIBLE["confidence"])
STOREY_HEIGHT = Quantity.declared(ShearBuilding, "heights")

# Ways to describe a building: as an oscillator, by a few numbers of all storeys, storey by storey, or by
# its modes.
OSCILLATOR, REGULAR, SINGLY = "oscillator", "regular", "storey by storey"
BY_MODES = "by its modes"
FRAME, WALL = "frame", "wall"  # structural systems
OF_OSCILLATORS, OF_REGULAR, OF_STOREYS = (OSCILLATOR,), (REGULAR,), (REGULAR, SINGLY)
PUSHOVER, OF_PUSHOVER = "pushover", ("pushover_method", "pushover_units", "participation")
PARTICIPATION = Quantity("1", Range(1.0, 3.0, True, True, "1 for one storey, about 1.3 to 1.6 for more"))
OF_MODES, OF_FLOORS = (BY_MODES,), (*OF_STOREYS, BY_MODES)
EUROCODE_8, ASCE_7, FILE = "eurocode_8", "asce_7", "spectrum of the file"

ALL = table(Key("title", str, "Title of all results", None))
SITE = table(
    Key("ground", str, "Name or kind of the ground"),
    Key("spectrum", str, "Code or file of a design spectrum, in place of a ground"),
    Key("ag", AG, "Acceleration ag", slider=Slider(0.02, 0.8, 0.01, 0.25, "g"), ways=(EUROCODE_8,)),
    Key("soil", tuple("ABCDE"), "Ground type", ways=(EUROCODE_8,)),
    Key("type", Whole(1, 2), "Type of spectrum", 1, ways=(EUROCODE_8,)),
    Key("sds", SDS, "SDS", slider=Slider(0.05, 2.5, 0.01, 1.0, "g"), ways=(ASCE_7,)),
    Key("sd1", RESPONSE, "SD1", slider=Slider(0.02, 1.5, 0.01, 0.6, "g"), ways=(ASCE_7,)),
    Key("tl", TIME, "TL", slider=Slider(4.0, 16.0, 1.0, 8.0, "s"), ways=(ASCE_7,)),
    Key("pga", PEAK, "Peak acceleration, mean", slider=Slider(0.01, 1.0, 0.01, 0.3, "g")),
    Key("sa", RESPONSE, "Spectral acceleration, mean", slider=Slider(0.01, 2.0, 0.01, 0.6, "g")),
    Key("sa_period", TIME, "Its period", slider=Slider(0.1, 4.0, 0.01, 1.0, "s")),
    Key("scale", NUMBER, "Scale of the spectrum", 1.0, Slider(0.1, 4.0, 0.05, 1.0), (FILE,)),
    declared(CloughPenzien, "intensity", "Intensity S0", Slider(5e-4, 0.05, 5e-4, 0.01, "m^2/s^3")),
    declared(CloughPenzien, "period", "Ground period", Slider(0.1, 4.0, 0.01, 1.0, "s")),
    declared(CloughPenzien, "damping", "Ground damping ratio", Slider(0.02, 1.0, 0.01, 0.3)),
    declared(CloughPenzien, "high_pass_period", "High-pass period", Slider(1.0, 20.0, 0.1, 4.0, "s")),
    declared(
        CloughPenzien, "high_pass_damping", "High-pass damping ratio", Slider(0.05, 1.5, 0.05, 0.6)
    ),
    Key("return_period", YEARS, "Return period of the shaking, from the hazard"),
    Key("model", str, "Kind of a ground that is fitted to the first record", "kanai_tajimi"),
    Key("estimator", str, "What a fit to a record minimizes", "psd"),
    Key("filters", Whole(1, MOST_FILTERS), "Number of filters of a fitted ground", None),
    Key("units", str, "Unit of the accelerations in the file", None),
    Key("column", Column, "Column of the accelerations", None),
    Key("period_column", Column, "Column of the periods", None),
    Key("between", BETWEEN, "What the spectrum of a file is between its points", BETWEEN[0]),
)
READING = (
    Key("units", str, "Unit of the accelerations", None),
    Key("dt", TIME, "Time step", None),
    Key("column", Column, "Column of the accelerations", None),
    Key("time_column", Column, "Column of the times, in place of the time step", None),
    Key("component", Column, "Component of a file with several, by its name or number from 1", None),
    Key("wrapped", bool, "Read all numbers as one series, written in rows", False),
    Key("skip", Whole(0), "Number of lines at the beginning that are left out", 0),
)
RECORD = table(
    Key("path", str, "File, beside the case file"),
    Key("name", str, "Name in results", None),
    *READING,
    Key("scale", NUMBER, "Factor on the accelerations", None),
)
SUITE = table(
    Key("path", str, "Folder, or table of files"),
    *READING,
    Key("vertical", bool, "Read vertical components as well", False),
    Key("skip_unreadable", bool, "Leave out what cannot be read, with a warning", False),
    Key("pga", PEAK, "Peak acceleration to which each record is scaled"),
    Key("sa", RESPONSE, "Spectral acceleration to which each record is scaled"),
    Key("sa_period", TIME, "Its period"),
    Key("scale_to", ("spectrum",), "Scale each record to the spectrum of the site"),
    Key("band", TIME, "The two periods between which it is scaled to the spectrum"),
)
HAZARD = table(
    Key("measure", MEASURES, "Measure of the shaking; intensity is S0"),
    Key("sa_period", TIME, "Period of the spectral acceleration"),
    Key("file", str, "File of intensities and annual frequencies, or of OpenQuake, or the USGS"),
    Key("site", Whole(1), "Number of the site in a file of OpenQuake", None),
    Key("coordinates", DEGREES, "Its longitude and latitude, in place of the number"),
    Key("investigation_time", YEARS, "Time in which probabilities of the file hold", None),
    Key("intensities", ACCELERATION, "Intensities of a few points, in place of a file"),
    Key("frequencies", NUMBER, "Annual frequencies of exceedance of these points"),
    Key("return_periods", YEARS, "Return periods of these points, in place of frequencies"),
    Key("k0", NUMBER, "Annual frequency of exceedance of one unit, of a power law"),
    Key("k", NUMBER, "Exponent of the power law"),
    Key("units", str, "Unit of k0, or of the intensities in the file"),
)
MOTION = table(
    Key("envelope", str, "Envelope", "none"),
    Key("components", Whole(1, 2), "Number of components to which ground and envelope are fitted", 1),
    Key(
        "scatter", NUMBER, "Scatter of the strength between earthquakes (standard deviation of ln)", None
    ),
    Key("duration", TIME, slider=Slider(5.0, 120.0, 1.0, 20.0, "s")),
    declared(AminAng, "rise_end", "", Slider(0.5, 30.0, 0.5, 4.0, "s")),
    declared(AminAng, "strong_end", "", Slider(1.0, 90.0, 0.5, 15.0, "s")),
    declared(GammaEnvelope, "power", "", Slider(0.5, 8.0, 0.1, 2.0)),
    declared(ShinozukaSato, "slow", "Slow rate", Slider(0.01, 1.0, 0.01, 0.1, "1/s")),
    declared(ShinozukaSato, "fast", "Fast rate", Slider(0.1, 5.0, 0.05, 1.0, "1/s")),
    declared(AminAng, "decay", "Rate of decay", Slider(0.05, 2.0, 0.05, 0.35, "1/s")),
)
BUILDING = table(
    declared(Bilinear, "period", "Period", Slider(0.1, 4.0, 0.01, 1.0, "s")),
    Key("storeys", Whole(1), default=None, slider=Slider(1, 30, 1, 8)),
    Key("storey_height", STOREY_HEIGHT, "", NEEDED, Slider(2.5, 6.0, 0.05, 3.0, "m"), OF_STOREYS),
    Key("heights", STOREY_HEIGHT, "Heights of all storeys, from the ground up", ways=OF_FLOORS),
    Key("floor_mass", Quantity.declared(RegularBuilding, "mass"), ways=OF_REGULAR),
    declared(Bilinear, "damping", "Damping ratio", Slider(0.005, 0.3, 0.005, 0.05)),
    declared(
        *(Bilinear, "reduction_factor", "Reduction factor R"),
        *(Slider(0.5, 10.0, 0.1, 4.0), OF_OSCILLATORS),
    ),
    declared(
        *(Bilinear, "yield_displacement", "Yield displacement"),
        *(Slider(0.2, 30.0, 0.1, 3.0, "cm"), OF_OSCILLATORS),
    ),
    Key(
        "ductility", NUMBER, "Mean peak ductility, for which the strength is sought", ways=OF_OSCILLATORS
    ),
    declared(
        *(RegularBuilding, "base_shear_coefficient", "Base shear coefficient"),
        *(Slider(0.02, 0.6, 0.01, 0.15), OF_REGULAR),
    ),
    Key("strength_factor", FACTOR, "", 1.0, Slider(0.1, 4.0, 0.05, 1.0), OF_FLOORS),
    declared(Bilinear, "hardening", "Hardening ratio", Slider(0.01, 1.0, 0.01, 0.05)),
    declared(Bilinear, "mass", ways=OF_OSCILLATORS),
    Key("height", HEIGHT, default=None, ways=OF_OSCILLATORS),
    declared(ShearBuilding, "masses", ways=(SINGLY, BY_MODES)),
    declared(ShearBuilding, "stiffnesses", ways=(SINGLY,)),
    declared(ShearBuilding, "yield_drifts", ways=(SINGLY,)),
    declared(ShearBuilding, "dampers", ways=OF_STOREYS),
    Key(PUSHOVER, str, "File of its pushover curve, from which it has strength and hardening"),
    Key("pushover_method", ("asce_41", "eurocode_8"), "Idealization of the curve", "asce_41"),
    Key("pushover_units", str, "Units of displacement and base shear in the file, a list of both"),
    Key("participation", PARTICIPATION, "Displacement of the roof over its own", ways=OF_OSCILLATORS),
    Key("modes", str, "File of its modes, or a table for each mode", ways=OF_MODES),
    Key("direction", DIRECTIONS, "Direction of the gap in the file of modes", None, ways=OF_MODES),
    Key("points", str, "Points with the shapes, one on each floor, a list", None, ways=OF_MODES),
    Key("tower", str, "Tower or diaphragm in the file of modes", None, ways=OF_MODES),
    Key("mass_units", str, "Unit of the masses in the file of modes", None, ways=OF_MODES),
    Key("length_units", str, "Unit of the levels in the file of modes", None, ways=OF_MODES),
    declared(ModalBuilding, "yield_displacements", "Yield displacements of modes", ways=OF_MODES),
    Key("elastic", bool, "It does not yield", False),
    Key("p_delta", bool, "Weight softens storeys (P-delta)", False, ways=OF_STOREYS),
    Key("damping_modes", STOREYS, "Two modes with the damping ratio, a list", None, ways=OF_STOREYS),
    Key("law", str, "Hysteresis law", "bilinear"),
    Key("system", (FRAME, WALL), "Structural system", FRAME, noted=True),
    Key("name", str, "Name in results", None),
    Key(
        "displacements",
        DISPLACEMENT,
        "Displacements of all floors under design forces, from the ground up",
        None,
    ),
    Key(
        "behaviour_factor", CODE_FACTOR, "Behaviour factor of the code, by which it reduces forces", None
    ),
    Key(
        "displacement_factor", CODE_FACTOR, "Displacement factor of the code, if it is another one", None
    ),
    Key(
        "importance_factor",
        Quantity("1", OF_IMPORTANCE),
        "Importance factor of the code, by which it divides displacements",
        None,
    ),
)
SHAPE_OF_MODE = table(
    Key("period", Quantity.declared(ModalBuilding, "periods"), "Period of the mode"),
    Key("shape", Quantity.declared(ModalBuilding, "shapes"), "Displacement of each floor"),
    Key("participation", Quantity.declared(ModalBuilding, "participation"), default=None),
    Key("modal_mass", Quantity.declared(ModalBuilding, "modal_masses"), "Effective modal mass", None),
)
SEPARATION = table(
    Key("existing", GAP, "Existing gap", None, Slider(0.5, 60.0, 0.5, 5.0, "cm")),
    Key("confidence", SHARE, "Confidence of no pounding", slider=Slider(0.5, 0.99, 0.01, 0.9)),
    Key("floors_align", bool, "Floors at the same levels", False),
    Key("risk", str, "Allowed risk of pounding, per year or in a time", None),
    Key("same_property", bool, "On one property", False),
    Key("same_system", bool, "Same structural system", False),
    Key("codes", str, "Building codes that you apply, a list of names or of countries", None),
    Key("zone", tuple(ZONES), "Zone of Mexico City", None),
    Key("design_pga", PEAK, "Peak ground acceleration of the design, for codes that ask for it", None),
    Key("unverified", bool, "Rules that are not compared with their source", False),
)
SIMULATION = table(
    Key("paths", Whole(FEWEST_PATHS), "Simulated motions", 2048),
    Key("seed", Whole(0), "Seed of the motions", 0),
)
MITIGATION = table(
    Key(
        "amplification_limit",
        NUMBER,
        "Accepted ratio of largest displacements with and without pounding",
    )
)

TABLES: Mapping[str, Mapping[str, Key]] = {
    "": ALL,
    "site": SITE,
    "site.records": RECORD,
    "site.suite": SUITE,
    "site.hazard": HAZARD,
    "motion": MOTION,
    "building": BUILDING,
    "building.modes": SHAPE_OF_MODE,
    "separation": SEPARATION,
    "simulation": SIMULATION,
    "mitigation": MITIGATION,
}


def keys_of_way(way: str) -> list[str]:
    """Names of the keys that a building may have that is described in this way."""
    return [key.name for key in BUILDING.values() if not key.ways or way in key.ways]


def keys_at(place: Place) -> Mapping[str, Key]:
    """The keys of the table at a place of a file; none where all are those of models."""
    name = ".".join(name for name in place if isinstance(name, str))
    return TABLES.get(re.sub(r"^building_\d+", "building", name), {})
