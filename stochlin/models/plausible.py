"""Limits of what buildings, ground motions and gaps really have; a value beyond them gives a warning."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from scipy.constants import g


class Plausible(NamedTuple):
    """Lowest and highest plausible value in SI units, and what is said of values beyond either."""

    low: float
    high: float
    below: str
    above: str

    def holds(self, value: float) -> bool:
        """Whether a value is plausible; 0, where it is allowed, is none, and NaN is not known."""
        return value == 0 or not (value < self.low or value > self.high)

    def doubt(self, value: float, meant: str = "") -> str:
        """The text of a warning; empty if the value is plausible.

        It asks what ``meant`` asks, if there is that; what the text itself asks is then left out.
        """
        if self.holds(value):
            return ""
        text = self.below if value < self.low else self.above
        return text.partition("; is it ")[0] + meant if meant else text


ANY = Plausible(float("-inf"), float("inf"), "", "")
_MASS = Plausible(5e3, 2e9, "a floor has 20 t and more", "the heaviest buildings have about 1e6 t")
_STOREY = Plausible(0.5, 50.0, "storeys are 2 to 6 m high", "storeys are 2 to 6 m high")
_INTENSITY = "an S0 of 0.01 m^2/s^3 gives peaks of about 0.3 g"
# Limits of values in files and of numbers in Python, by the names of keys and parameters, well beyond
# what there is: the shortest and longest periods of buildings and of soils are 0.05 and 20 s, floors of
# houses weigh 20 t and more, towers yield at a drift of their roof of 2 m at most, a reduction factor of
# 0.6 leaves the strength at five standard deviations of the response, S0 of 2e-6 m^2/s^3 gives peaks of
# 0.005 g and 5 m^2/s^3 of 7 g on firm ground, and the largest response accelerations of records are
# about 7 g.
PLAUSIBLE: Mapping[str, Plausible] = {
    "period": Plausible(0.01, 60.0, "periods are 0.05 s and longer", "periods are 20 s at most"),
    "mass": _MASS,
    "masses": _MASS,
    "height": Plausible(1.0, 1000.0, "buildings are 2 m high or more", "none is as high as that"),
    "storey_height": _STOREY,
    "heights": _STOREY,
    "existing": Plausible(
        1e-3, 3.0, "0 stands for buildings that touch", "buildings this far apart hardly pound"
    ),
    "displacements": Plausible(0.0, 2.0, "", "buildings are designed to move by less than 2 m"),
    "yield_displacement": Plausible(0.0, 3.0, "", "buildings yield at less than 3 m"),
    "reduction_factor": Plausible(
        0.6, 100.0, "a building as strong as this does not yield; is it the inverse?", "usual are 2 to 8"
    ),
    "base_shear_coefficient": Plausible(
        0.0,
        1.0,
        "",
        "the building resists more than its weight; is it a percentage, or a force for a ratio?",
    ),
    "intensity": Plausible(
        2e-6, 5.0, f"{_INTENSITY}; this is not felt", f"{_INTENSITY}; this is beyond all"
    ),
    "pga": Plausible(
        1e-3 * g, 3 * g, "less than 0.001 g is hardly felt", "more than 3 g has hardly been recorded"
    ),
    "sa": Plausible(
        1e-4 * g, 7.5 * g, "less than 0.0001 g is not felt", "more than 7.5 g was not recorded"
    ),
    "risk": Plausible(0.0, 0.01, "", "pounding would be allowed more often than once in 100 years"),
}
# Of these, numbers are doubted in Python as well; the others are freely varied there.
IN_PYTHON = ("yield_displacement", "base_shear_coefficient")
# Intensity in SI units that no site exceeds as often as once in `OFTEN` years: the largest PGA of hazard
# maps is 0.6 g in 100 years and 1.5 g in 475, Sa is 2.5 times as large, and S0 = 1 m^2/s^3 gives 3 g.
OFTEN = 150.0
STRONG = {"pga": g, "sa": 2.5 * g, "intensity": 1.0}
