"""Limits of what buildings, ground motions and gaps really have; a value beyond them gives a warning."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Iterable, Iterator, Mapping
from typing import Any, NamedTuple

from scipy.constants import g

from stochlin.messages import ImplausibleInput


class Plausible(NamedTuple):
    """Lowest and highest plausible value in SI units, the usual ones, and questions beyond either."""

    low: float
    high: float
    usual: str = ""
    below: str = ""
    above: str = ""

    def holds(self, value: float) -> bool:
        """Whether a value is plausible; 0 is none, less is refused elsewhere, and NaN is not known."""
        return value <= 0 or not (value < self.low or value > self.high)

    def doubt(self, value: float) -> str:
        """What is usual instead of a value that is not plausible; empty for one that is."""
        if self.holds(value):
            return ""
        question = self.below if value < self.low else self.above
        return f"usual are {self.usual}{question and f'; {question}'}"


OF_STOREYS = "masses", "heights", "storey_height"  # of which a list is of one building
FAR = sys.float_info.max  # beyond it numbers are refused
# Modules in which no user writes numbers.
LIBRARY = "stochlin.models", "stochlin.solver", "stochlin.applications", "dataclasses"
ANY = Plausible(float("-inf"), float("inf"))
# Limits of values in files and of numbers in Python, by the names of keys and parameters, well beyond
# what there is: the shortest and longest periods of buildings and of soils are 0.05 and 20 s, floors of
# houses weigh 20 t and more, towers yield at a drift of their roof of 2 m at most, a reduction factor of
# 0.6 leaves the strength at five standard deviations of the response, S0 of 2e-6 m^2/s^3 gives peaks of
# 0.005 g and 0.5 m^2/s^3 of 2 g on firm ground, the largest response accelerations of records are about
# 7 g, and Eurocode 8 and ASCE 7 need not be applied below an ag of 0.05 g and an SDS of 0.167 g.
PLAUSIBLE: Mapping[str, Plausible] = {
    "period": Plausible(0.01, 60.0, "0.05 to 20 s", "", "is it in ms?"),
    "damping": Plausible(1e-3, 1.0, "0.005 to 0.9, 0.05 for 5 %"),
    **dict.fromkeys(("mass", "masses"), Plausible(5e3, 2e9, "2e4 to 1e9 kg", "is it in t?")),
    **dict.fromkeys(("heights", "storey_height"), Plausible(0.5, 50.0, "2 to 6 m", "", "is it in mm?")),
    "gap": Plausible(1e-3, 3.0, "0.01 to 1 m", "", "is it in cm?"),
    **dict.fromkeys(("behaviour", "deflection", "divided_by"), Plausible(0.0, 12.0, "1.5 to 8")),
    "height": Plausible(1.0, 1000.0, "3 to 500 m"),
    "displacements": Plausible(0.0, 1.0, "0.001 to 0.5 m", "", "is it in cm?"),
    "yield_displacement": Plausible(0.0, 2.0, "0.005 to 1 m", "", "is it in cm?"),
    "reduction_factor": Plausible(0.6, 20.0, "1 to 8"),
    "base_shear_coefficient": Plausible(0.0, 1.0, "0.02 to 0.5 of the weight", "", "is it in %?"),
    "intensity": Plausible(2e-6, 0.5, "1e-4 to 0.1 m^2/s^3, 0.01 for 0.3 g", "", "is it the default?"),
    **dict.fromkeys(("pga", "design_pga"), Plausible(0.04 * g, 3 * g, "0.05 to 1 g", "is it in g?")),
    "ag": Plausible(0.05 * g, 3 * g, "0.05 to 0.5 g, with 1 g = 9.81 m/s^2", "is it in g?"),
    "sds": Plausible(0.167 * g, 7.5 * g, "0.2 to 2.5 g, with 1 g = 9.81 m/s^2", "is it in g?"),
    "sa": Plausible(1e-4 * g, 7.5 * g, "0.01 to 2.5 g, with 1 g = 9.81 m/s^2", "is it in g?"),
    "confidence": Plausible(0.01, 1.0, "0.5 to 0.99, 0.9 for 90 %"),
    "risk": Plausible(0.0, 0.01, "1e-4 to 2e-3 per year", "", "is it in %?"),
}


def implausible(values: Mapping[str, Any]) -> Iterator[str]:
    """Texts on implausible numbers among the arguments of a call; arrays are scans, or computed."""
    for name, number in values.items():
        known = PLAUSIBLE.get(name.removesuffix("_1").removesuffix("_2"), ANY)
        value = getattr(number, "median", number)  # of an uncertain parameter
        each = value if name in OF_STOREYS and isinstance(value, (list, tuple)) else [value]
        if odd := [n for n in each if type(n) in (int, float) and not known.holds(n) and n < FAR]:
            yield f"{name} = {odd[0]:g}: {known.doubt(odd[0])}"


def warn_caller(of: str, doubts: Iterable[str]) -> None:
    """Warn where a model was made or a function was called, unless the library itself does so."""
    depth = 2
    while (module := sys._getframe(depth).f_globals.get("__name__", "")) == "stochlin.models.arguments":
        depth += 1
    for warning in () if module.startswith(LIBRARY) else doubts:
        warnings.warn(f"{of}: {warning}", ImplausibleInput, stacklevel=depth + 1)
