"""Limits of what buildings, ground motions and gaps really have; a value beyond them gives a warning."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any, NamedTuple, TypeGuard

import numpy as np
from scipy.constants import g

from stochlin.messages import ImplausibleInput


class Plausible(NamedTuple):
    """Lowest and highest plausible value in SI units, their source, the usual ones, and questions."""

    low: float
    high: float
    source: str
    usual: str
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


OF_A_ROW = "gaps"  # of which a list is no scan either
FAR = sys.float_info.max  # beyond it numbers are refused
UNQUESTIONED: ContextVar[bool] = ContextVar("UNQUESTIONED", default=False)
ANY = Plausible(float("-inf"), float("inf"), "", "")
STOREY = 3.0  # m, height of a storey if that of the building is not known; ASCE 7-16, 12.8.2.1
_PERIODS = Plausible(
    0.01,
    60.0,
    "ASCE 7-16, 12.8.2.1: 0.11 s for 3 m, 18 s for 1000 m of steel",
    "0.05 to 20 s",
    above="is it in ms?",
)
_MASSES = Plausible(
    5e3,
    2e9,
    "EN 1991-1-1: about 1 t/m^2 of a concrete floor with its loads, on 20 to 1e6 m^2",
    "2e4 to 1e9 kg",
    below="is it in t?",
    above="is it in g?",
)
_HEIGHTS = Plausible(
    0.5,
    50.0,
    "ASCE 7-16, 12.8.2.1: storeys of 3 m and more; halls without floors reach 50 m",
    "2 to 6 m",
    above="is it in mm?",
)
_GAPS = Plausible(
    1e-3,
    1.0,
    "1 % of a height of 100 m, a share that rules of codes ask for",
    "0.01 to 1 m",
    above="is it in cm?",
)
_FACTORS = Plausible(
    0.0, 12.0, "ASCE 7-16, table 12.2-1, R and Cd, and EN 1998-1, table 6.2, q: up to 8", "1.5 to 8"
)
_DISPLACEMENTS = Plausible(
    0.0,
    1.0,
    "ASCE 7-16, table 12.12-1: a drift of 2 %, of a height of 50 m",
    "0.001 to 0.5 m",
    above="is it in cm?",
)
_YIELDING = Plausible(
    0.0,
    2.0,
    "Priestley et al. (2007): a yield drift of 1 %, of a height of 200 m",
    "0.005 to 1 m",
    above="is it in cm?",
)
_ACCELERATIONS = Plausible(
    0.04 * g,
    1.5 * g,
    "EN 1998-1, 3.2.1(5), very low seismicity; few records exceed 1.5 g: Tarzana 1994, MYG004 2011",
    "0.05 to 1 g, with 1 g = 9.81 m/s^2",
    below="is it in g?",
    above="is it in cm/s^2?",
)
_RESPONSES = Plausible(
    1e-4 * g,
    3.75 * g,
    "EN 1998-1, 3.2.2.2: 2.5 times the ground acceleration",
    "0.01 to 2.5 g, with 1 g = 9.81 m/s^2",
    below="is it in g?",
    above="is it in cm/s^2?",
)
# By the names of parameters, arguments and keys of case files; then what follows from several of them,
# and what is read from files.
PLAUSIBLE: Mapping[str, Plausible] = {
    "period": _PERIODS,
    "damping": Plausible(
        0.005,
        0.2,
        "EN 1991-1-4, table F.2: 0.008 for steel; Newmark and Hall (1982): 0.2 for nailed wood",
        "0.005 to 0.2, 0.05 for 5 %",
        above="is that of devices added to it?",
    ),
    "ground_damping": Plausible(
        1e-3,
        1.5,
        "grounds with 0.03 to 1, and high-pass filters with 0.2 to 1.3, are simulated here",
        "0.03 to 1.3",
    ),
    **dict.fromkeys(("mass", "masses"), _MASSES),
    **dict.fromkeys(("heights", "storey_height"), _HEIGHTS),
    **dict.fromkeys(("gap", "gaps"), _GAPS),
    **dict.fromkeys(("behaviour", "deflection", "divided_by"), _FACTORS),
    "height": Plausible(1.0, 1000.0, "the highest building, in Dubai, has 828 m", "3 to 500 m"),
    **dict.fromkeys(("displacements", "peak"), _DISPLACEMENTS),
    **dict.fromkeys(("yield_displacement", "yield_displacements"), _YIELDING),
    "reduction_factor": Plausible(
        0.6, 20.0, "0.6 leaves the strength at five standard deviations of the response", "1 to 8"
    ),
    "base_shear_coefficient": Plausible(
        0.0,
        1.0,
        "ASCE 7-16, 12.8.1.1: SDS/R, with R of 1.5 and more",
        "0.02 to 0.5 of the weight",
        above="is it in %?",
    ),
    "intensity": Plausible(
        2e-6,
        0.5,
        "measured here: peaks of 0.005 g and of 2 g on firm ground",
        "1e-4 to 0.1 m^2/s^3, 0.01 for 0.3 g",
        above="is it the default?",
    ),
    "duration": Plausible(
        0.0,
        600.0,
        "K-NET: records of the earthquake of 2011 off Tohoku last 300 s",
        "10 to 120 s",
        above="is it in ms?",
    ),
    **dict.fromkeys(("pga", "design_pga"), _ACCELERATIONS),
    "ag": _ACCELERATIONS._replace(low=0.05 * g, usual="0.05 to 0.5 g, with 1 g = 9.81 m/s^2"),
    "sds": _RESPONSES._replace(
        low=0.167 * g,
        source="ASCE 7-16, table 11.6-1, category A; 2.5 times the ground acceleration",
        usual="0.2 to 2.5 g, with 1 g = 9.81 m/s^2",
    ),
    **dict.fromkeys(("sa", "sd1"), _RESPONSES),
    "confidence": Plausible(
        0.5,
        float("inf"),
        "with less than 0.5 pounding is likelier than none",
        "0.5 to 0.99, 0.9 for 90 %",
        below="is it the probability of pounding that is meant?",
    ),
    "risk": Plausible(
        0.0,
        0.01,
        "ASCE 7-16, 21.2.1: 1 % in 50 years, 2e-4 a year, of collapse",
        "1e-4 to 2e-3 per year",
        above="is it in %?",
    ),
    "mean storey height": Plausible(
        2.0,
        50.0,
        "International Residential Code, R305: rooms of 2.13 m and more",
        "2.5 to 6 m",
        below="are height and number of storeys right?",
        above="are height and number of storeys right?",
    ),
    "period over 0.05 h^0.75": Plausible(
        0.2,
        10.0,
        "EN 1998-1, 4.3.3.2.2(3): 1 to 1.7; ASCE 7-16, 12.8-8, 0.1 s a storey: 0.9 to 1.9",
        "0.5 to 4",
        below="are mass and stiffness right?",
        above="are mass and stiffness right, or is it isolated?",
    ),
    "stiffness upwards": Plausible(
        0.0,
        1.2,
        "EN 1998-1, 4.2.3.3(3): constant or less towards the top",
        "0.3 to 1",
        above="are the storeys in order, from the ground up?",
    ),
    "mass upwards": Plausible(
        0.0,
        1.5,
        "EN 1998-1, 4.2.3.3(3): constant or less towards the top; ASCE 7-16, table 12.3-2: 1.5",
        "0.5 to 1",
        above="are the floors in order, from the ground up?",
    ),
    "mode downwards": Plausible(
        0.0,
        1.0,
        "Chopra (2012), 8.3: the first mode of a building grows towards the roof",
        "0.05 to 0.7",
        above="are the floors in order?",
    ),
    "yield drift": Plausible(
        0.0,
        0.1,
        "Priestley et al. (2007): 0.5 to 1 % of frames",
        "0.002 to 0.02",
        above="are units and period right?",
    ),
    "pga of 475 years": _ACCELERATIONS._replace(
        low=0.08 * g,
        source="EN 1998-1, 3.2.1(4), low seismicity; as for pga",
        usual="0.08 to 1 g, with 1 g = 9.81 m/s^2",
        below="are intensities, or k0, for g, or is this a site of low seismicity?",
    ),
    "penetration": Plausible(
        0.0,
        0.02,
        "measured here: 1.2 cm with 1e9 N/m between 200 and 300 t in 64 motions",
        "0.1 mm to 1 cm",
        above="is the stiffness right, or is it that of a bumper?",
    ),
    "peak of a record": Plausible(
        0.0,
        3 * g,
        "K-NET, MYG004, 2011: 2.75 g, the largest of a horizontal component",
        "0.01 to 1 g",
        above="are the units right?",
    ),
    "time step of a record": Plausible(
        0.0,
        0.5,
        "K-NET: 0.01 s",
        "0.001 to 0.02 s",
        above="is time in seconds?",
    ),
    "largest ordinate": Plausible(
        0.0025 * g,
        7.5 * g,
        "EN 1998-1, 3.2.2.2: 2.5 times ground accelerations of 0.001 and 3 g",
        "0.05 to 4 g",
        below="are its units right?",
        above="are its units right?",
    ),
    "scale of a record": Plausible(
        0.1,
        10.0,
        "Luco and Bazzurro (2007), Earthquake Eng. Struct. Dyn. 36: bias by factors up to 10",
        "0.1 to 10, which leave a record one of its kind",
    ),
}


def limits_of(name: str) -> Plausible:
    """The limits of a parameter, argument or key; those of both buildings have one entry."""
    return PLAUSIBLE.get(name.removesuffix("_1").removesuffix("_2"), ANY)


def implausible(
    values: Mapping[str, Any],
    limits: Mapping[str, Plausible] | None = None,
    *,
    of_one: bool = False,
) -> Iterator[str]:
    """Texts on implausible numbers among the arguments of a call.

    ``limits`` are those of a model, in place of those of the names. Arrays and numbers of numpy are
    scans, or computed, and not judged, unless they are ``of_one`` building.
    """
    for name, number in values.items():
        known = limits_of(name) if limits is None else limits.get(name, ANY)
        value = getattr(number, "median", number)  # of an uncertain parameter
        judged = of_one or name == OF_A_ROW
        each = np.array(value, object).ravel() if judged and np.ndim(value) else [value]
        if odd := [n for n in each if _is_number(n) and not known.holds(n) and n < FAR]:
            yield f"{name} = {odd[0]:g}: {known.doubt(odd[0])}"
    for end in ("", "_1", "_2"):
        height, storeys = (values.get(f"{of}{end}") for of in ("height", "storeys"))
        if _is_number(height) and _is_number(storeys) and (text := doubt_of_storeys(height, storeys)):
            yield f"height{end} = {height:g}: {text}"


def doubt_of_storeys(height: float, storeys: float) -> str:
    """Text on the mean height [m] of the storeys of a building; empty if it is plausible."""
    mean = height / storeys if storeys > 0 else 0.0
    text = PLAUSIBLE["mean storey height"].doubt(mean)
    return text and f"its height over the number of storeys, {storeys:g}, is {mean:.3g} m; {text}"


def doubts_of_size(period: float, height: float | None, storeys: float | None) -> Iterator[str]:
    """Texts on first period [s], height [m] and number of storeys of a building, as far as known."""
    if height and storeys and (text := doubt_of_storeys(height, storeys)):
        yield text
    if known := height or STOREY * (storeys or 0.0):
        ratio = period / (0.05 * known**0.75)  # EN 1998-1, 4.3.3.2.2(3)
        if text := PLAUSIBLE["period over 0.05 h^0.75"].doubt(ratio):
            times = f"{ratio:.2g} times 0.05 h^0.75 of a height of {known:.3g} m"
            yield f"a first period of {period:.3g} s is {times}; {text}"


def _is_number(value: object) -> TypeGuard[float]:
    return type(value) in (int, float)


@contextmanager
def unquestioned() -> Iterator[None]:
    """Give no warnings of numbers inside: the library has them from its caller, or computed them."""
    token = UNQUESTIONED.set(True)
    try:
        yield
    finally:
        UNQUESTIONED.reset(token)


def warn_caller(of: str, doubts: Callable[[], Iterable[str]]) -> None:
    """Warn where the function was called that calls this one, unless inside of `unquestioned`."""
    if UNQUESTIONED.get():
        return
    with unquestioned():
        texts = [*doubts()]
    for text in texts:
        warnings.warn(f"{of}: {text}", ImplausibleInput, stacklevel=3)
