"""Response spectra as labelled arrays, pseudo-acceleration over period, and their checks."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypeGuard

import numpy as np
import xarray as xr

from stochlin.analyses.records.files import spelled
from stochlin.kernels.basics.arrays import Array
from stochlin.messages import brief
from stochlin.models.arguments import is_number

USUAL_DAMPING = 0.05
SHORTEST = 0.05  # shortest period for which a spectrum is fitted or compared [s]
BAND, BAND_POINTS = (0.2, 2.0), 40  # [s] of usual buildings, in which spectra are compared; periods
FEWEST = 4  # smallest number of points
WIDEST = 2.0  # largest ratio of two consecutive periods
# Elastic spectra with damping 0.05 rise to 2 to 3 times the peak ground acceleration; spectra divided by
# a behaviour factor q or R do not.
_LEAST_RISE, _STIFF = 1.5, 0.02  # smallest rise; longest period of a rigid structure [s]
_FLAT = 3  # last points that are equal if a design spectrum has a lower bound at long periods


def labelled(period: Array, values: Array, damping: float, source: str) -> xr.DataArray:
    """A spectrum as a labelled array, with its units, damping ratio and source."""
    return xr.DataArray(
        values,
        dims="period",
        coords={"period": ("period", period, {"units": "s", "long_name": "period"})},
        name="pseudo_acceleration",
        attrs={
            "units": "m/s^2",
            "long_name": f"elastic response spectrum, damping {damping:g}",
            "damping": float(damping),
            "source": source,
        },
    )


def check_band(band: tuple[float, float]) -> None:
    """Raise a ValueError unless ``band`` is a range of periods [s]."""
    if not 0 < band[0] < band[1] < np.inf:
        raise ValueError(f"band = {brief(band)}; allowed: 0 < lower < upper, in seconds")


def is_spectrum(target: object) -> TypeGuard[xr.DataArray]:
    """Whether ``target`` is a spectrum, an array with the dimension ``period``."""
    return isinstance(target, xr.DataArray) and "period" in target.dims


def checked_spectrum(spectrum: xr.DataArray) -> tuple[Array, Array, float]:
    """Periods [s], pseudo-accelerations [m/s^2] and damping ratio of a spectrum, checked.

    A ValueError or TypeError is raised for other dimensions or units, for periods that do not increase
    or have a gap, and for ordinates that are not positive. The ordinate at a period of 0 is the peak
    ground acceleration.
    """
    if not isinstance(spectrum, xr.DataArray):
        raise TypeError(
            f"spectrum is a {type(spectrum).__name__}; allowed: an xarray.DataArray over period, as "
            "eurocode_8, asce_7 and read_spectrum give it"
        )
    if spectrum.dims != ("period",) or "period" not in spectrum.coords:
        raise ValueError(
            f"spectrum has the dimensions {spectrum.dims}; allowed: period alone, with its values [s]"
        )
    units = spectrum.attrs.get("units")
    if units is None or spelled(units) != "m/s^2":
        said = "no units" if units is None else f"units {brief(units)}"
        raise ValueError(
            f"spectrum has {said}; allowed: m/s^2, so convert it and say so in its attributes"
        )
    damping = spectrum.attrs.get("damping", USUAL_DAMPING)
    if not (is_number(damping) and 0 < damping < 1):
        raise ValueError(f"spectrum is of the damping {brief(damping)}; allowed: 0 < damping < 1")
    kinds = {spectrum.dtype.kind, spectrum.period.dtype.kind}
    if not kinds <= set("iuf"):
        raise TypeError(f"spectrum is {spectrum.dtype} over {spectrum.period.dtype}; allowed: numbers")
    period, values = (array.to_numpy().astype(float) for array in (spectrum.period, spectrum))
    places = [f"spectrum, number {n}" for n in range(1, period.size + 1)]
    check_ordinates(period, values, float(damping), places)
    return period, values, float(damping)


def check_goal(goals: Mapping[str, object], period: object) -> None:
    """Raise a ValueError unless exactly one goal is given, and a period with ``sa`` only."""
    stated = [name for name, value in goals.items() if value is not None]
    if len(stated) != 1:
        named = ["sa with a period" if name == "sa" else name for name in goals]
        raise ValueError(
            f"{' and '.join(stated) or 'nothing'} is given; allowed: one of {', '.join(named)}"
        )
    if (goals.get("sa") is None) != (period is None):
        raise ValueError("sa and period go together; allowed: both, or neither")


def interpolated(period: Array, values: Array, at: Array) -> Array:
    """Ordinates at other periods above 0, by linear interpolation of logarithms."""
    above = period > 0
    ordinates: Array = np.exp(np.interp(np.log(at), np.log(period[above]), np.log(values[above])))
    return ordinates


def check_ordinates(period: Array, values: Array, damping: float, places: list[str]) -> None:
    """Raise a ValueError unless these are an elastic spectrum; ``places`` name the points."""
    if period.size < FEWEST:
        raise ValueError(f"spectrum has {period.size} points; allowed: {FEWEST} or more")
    for place, t, sa in zip(places, period, values, strict=True):
        if not (np.isfinite(t) and t >= 0):
            raise ValueError(f"{place}: the period is {t:g} s; allowed: 0 or more, finite")
        if not (np.isfinite(sa) and sa > 0):
            raise ValueError(
                f"{place}: the acceleration at {t:g} s is {sa:g}; allowed: positive, finite, so mend it "
                "or leave it out"
            )
    for place, before, t in zip(places[1:], period[:-1], period[1:], strict=True):
        if t <= before:
            raise ValueError(
                f"{place}: {t:g} s follows {before:g} s; allowed: increasing periods, so sort them"
            )
        if before > 0 and t > WIDEST * before:
            raise ValueError(
                f"{place}: nothing stands between {before:g} and {t:g} s; allowed: periods of which "
                f"each is at most {WIDEST:g} times the last, so fill the gap or cut the spectrum there"
            )
    _check_elastic(period, values, damping, places)


def _check_elastic(period: Array, values: Array, damping: float, places: list[str]) -> None:
    cure = "allowed: an elastic spectrum, so multiply by the behaviour factor q (or R)"
    least = 1 + (_LEAST_RISE - 1) * np.sqrt(USUAL_DAMPING / damping)
    rise = float(values.max() / values[0])
    if period[0] <= _STIFF and rise < least:
        raise ValueError(
            f"{places[0]}: the spectrum rises to {rise:.3g} times its value at {period[0]:g} s only, as "
            f"one divided by a behaviour factor; {cure}, or leave out what is below {_STIFF:g} s"
        )
    flat = np.ptp(values[-_FLAT:]) <= 1e-6 * values[-1]
    if flat and values[-1] < 0.9 * values.max():
        raise ValueError(
            f"{places[-_FLAT]}: the spectrum is level from {period[-_FLAT]:g} s on, as a design "
            f"spectrum at its lower bound; {cure}, without that bound"
        )
