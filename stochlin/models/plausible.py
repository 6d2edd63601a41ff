"""Limits of real buildings, ground motions and gaps; a value beyond them gives a warning."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from math import inf
from typing import Any, NamedTuple, TypeGuard

import numpy as np
import xarray as xr
from scipy.constants import g

from stochlin.files.package_data import data_of
from stochlin.messages import ImplausibleInput


class Plausible(NamedTuple):
    """Lowest and highest plausible value in SI units, their source, usual ones, and questions."""

    low: float
    high: float
    source: str
    usual: str
    below: str = ""
    above: str = ""

    def holds(self, value: float) -> bool:
        """Whether a value is plausible; 0 is none, less is refused elsewhere, NaN is not known."""
        return value <= 0 or not (value < self.low or value > self.high)

    def doubt(self, value: float) -> str:
        """What is usual instead of a value that is not plausible; empty for one that is."""
        if self.holds(value):
            return ""
        question = self.below if value < self.low else self.above
        return f"usual are {self.usual}{question and f'; {question}'}"


NUMBERS_OF_A_ROW = "gaps"  # of which a list is no scan either
LARGEST_NUMBER = sys.float_info.max  # beyond it numbers are refused
UNQUESTIONED: ContextVar[bool] = ContextVar("UNQUESTIONED", default=False)
ANY = Plausible(-inf, inf, "", "")
SEVERAL = 3  # storeys of a building that is no hall with a gallery
# m, height of a storey if that of the building is not known; ASCE 7-16, 12.8.2.1
USUAL_STOREY_HEIGHT = 3.0


def _read_limits() -> Mapping[str, Plausible]:
    """The limits of `plausible.toml` by their names."""
    limits: dict[str, Plausible] = {}
    for name, entry in data_of(__package__, "plausible.toml").items():
        size = g if entry.pop("unit", "") == "g" else 1.0
        low = size * entry.pop("low", 0.0)
        high = size * entry.pop("high", inf)
        names = [name, *entry.pop("names", ())]
        limits |= dict.fromkeys(names, Plausible(low, high, **entry))
    return limits


PLAUSIBLE = _read_limits()


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

    ``limits`` are those of a model, in place of those of the names. Arrays are scans, of which all
    numbers must be implausible, unless they are ``of_one`` building; numbers of numpy are computed.
    """
    for name, number in values.items():
        limit = limits_of(name) if limits is None else limits.get(name, ANY)
        median = getattr(number, "median", number)  # of an uncertain parameter
        value = number if callable(median) else median  # which arrays have as a method
        judged = (of_one or name == NUMBERS_OF_A_ROW) and not isinstance(value, Mapping)
        numbers = np.array(value, object).ravel() if judged else [_nearest(value, limit)]
        if odd := [
            n for n in numbers if _is_number(n) and not limit.holds(n) and n < LARGEST_NUMBER
        ]:
            yield f"{name} = {odd[0]:g}: {limit.doubt(odd[0])}"
    for end in ("", "_1", "_2"):
        height = values.get(f"height{end}")
        storeys = values.get(f"storeys{end}")
        if (
            _is_number(height)
            and _is_number(storeys)
            and (text := doubt_of_storeys(height, storeys))
        ):
            yield f"height{end} = {height:g}: {text}"
        behaviour = values.get(f"behaviour{end}")
        deflection = values.get(f"deflection{end}")
        if _is_number(behaviour) and _is_number(deflection):
            yield from doubts_of_factors(behaviour, deflection)


def _nearest(value: object, limit: Plausible) -> object:
    """A number as it is; of an array in memory the number, or limit, nearest to usual ones."""
    data = value.data if isinstance(value, xr.DataArray) else value
    if (
        limit is ANY
        or not isinstance(data, np.ndarray)
        or not data.size
        or data.dtype.kind not in "iuf"
    ):
        return value
    least = float(data.min())  # NaN if any is
    most = float(data.max())  # likewise
    return least if least > limit.high else min(most, limit.low)


def doubt_of_storeys(height: float, storeys: float) -> str:
    """Text on the mean height [m] of the storeys of a building; empty if it is plausible."""
    mean = height / storeys if storeys > 0 else 0.0
    several = storeys >= SEVERAL  # where halls are rare
    text = PLAUSIBLE["mean height of three storeys" if several else "mean storey height"].doubt(
        mean
    )
    return text and f"its height over the number of storeys, {storeys:g}, is {mean:.3g} m; {text}"


def doubts_of_factors(behaviour: float, deflection: float) -> Iterator[str]:
    """Texts on the factors of a code by which forces are divided, and displacements multiplied."""
    ratio = deflection / behaviour if behaviour > 0 else 0.0
    if text := PLAUSIBLE["deflection over behaviour"].doubt(ratio):
        factors = f"the deflection factor {deflection:g} is {ratio:.3g} times the behaviour factor"
        yield f"{factors} {behaviour:g}; {text}"


def doubts_of_size(period: float, height: float | None, storeys: float | None) -> Iterator[str]:
    """Texts on first period [s], height [m] and number of storeys of a building, where known."""
    if height and storeys and (text := doubt_of_storeys(height, storeys)):
        yield text
    if assumed_height := height or USUAL_STOREY_HEIGHT * (storeys or 0.0):
        ratio = period / (0.05 * assumed_height**0.75)  # EN 1998-1, 4.3.3.2.2(3)
        if text := PLAUSIBLE["period over 0.05 h^0.75"].doubt(ratio):
            times = f"{ratio:.2g} times 0.05 h^0.75 of a height of {assumed_height:.3g} m"
            yield f"a first period of {period:.3g} s is {times}; {text}"


def _is_number(value: object) -> TypeGuard[float]:
    return type(value) in (int, float)


@contextmanager
def unquestioned() -> Iterator[None]:
    """Give no warnings of numbers inside: the library has them from its caller or computed them."""
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
