"""Whether a spectrum is elastic or by what it was divided, and what its shape says about that.

It is said once, where the spectrum is read or first used, and stands in the attributes of the
array.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterator
from typing import Annotated

import numpy as np
import xarray as xr
from scipy import constants

from stochlin.kernels.basics.arrays import Array
from stochlin.messages import DoubtfulInput, plain
from stochlin.models.arguments import Number, as_numbers
from stochlin.models.parameters import Range
from stochlin.models.plausible import PLAUSIBLE

TAKEN_AS = "elastic"  # attribute that says how a spectrum was taken
ELASTIC_AT = "elastic_at"  # attribute: period [s] and ordinate [m/s^2] for which that was said
BY_CODE = "elastic by its code"
STATED = "elastic as stated"
NOT_STATED = "taken as elastic, which is not stated"
# The least behaviour factor q of Eurocode 8 is 1.5 (EN 1998-1, 3.2.2.5): a spectrum with less than
# 0.7 of the ordinate for which it was said to be elastic has been divided since.
LEAST_ELASTIC_SHARE = 0.7
USUAL_DAMPING = 0.05
# longest period of a rigid structure, whose ordinate is the peak ground acceleration [s]
LONGEST_RIGID_PERIOD = 0.02
SAME_ORDINATES = 1e-3  # relative difference of ordinates that are equal, as rounded in files
# Elastic spectra rise to 3.21 - 0.68 ln(damping in %) times the peak ground acceleration in the
# median (Newmark and Hall 1982, Earthquake spectra and design), which is 2.12 for 5 %; those of
# Eurocode 8 and ASCE 7 rise to 2.5 times. Below this share of the median a spectrum is in doubt:
# 1.48 for 5 %.
LEAST_OF_MEDIAN = 0.7
LARGEST_RISE = 3.5  # of ordinates over the ground acceleration
LEVEL_POINTS = 3  # last points that are equal at a lower bound
LEVEL_FROM = 4.0  # [s], of elastic code spectra

_DIVISOR = Number(Range(1, include_lower=True), "a number of at least 1")


def check_divided_by(name: str, value: object) -> None:
    """Raise an error unless ``value`` is a factor of at least 1 or an array of them over period."""
    if not isinstance(value, xr.DataArray):
        _DIVISOR(name, value)
        return
    allowed = "numbers of at least 1 over period, which increases"
    factors = as_numbers(name, value, allowed)
    period = as_numbers(name, value.coords.get("period", ()), allowed)
    if value.dims != ("period",) or period.size != factors.size or not factors.size:
        raise ValueError(f"{name} has the dimensions {value.dims}; allowed: {allowed}")
    if not (period[0] >= 0 and (np.diff(period) > 0).all() and (factors >= 1).all()):
        raise ValueError(f"{name} is not such a table; allowed: {allowed}")
    if not np.isfinite([*period, *factors]).all():
        raise ValueError(f"{name} has numbers that are not finite; allowed: {allowed}")


DividedBy = Annotated[float | xr.DataArray, check_divided_by]


def as_elastic(
    spectrum: xr.DataArray, elastic: bool | None, divided_by: float | xr.DataArray | None
) -> xr.DataArray:
    """A valid spectrum as an elastic one, times what it was divided by, with how it was taken.

    A ValueError is raised for contradictions. A warning is given, where a public function was
    called that calls this one, if nothing says what the spectrum is, or if its shape speaks against
    it.
    """
    how = spectrum.attrs.get(TAKEN_AS)
    share = _share_left(spectrum)
    said = how not in (None, NOT_STATED) and share >= LEAST_ELASTIC_SHARE
    if divided_by is not None:
        if elastic:
            raise ValueError("elastic = True is given beside divided_by; allowed: one of them")
        if said:
            what = f"divided_by is given, and spectrum says that it is {plain(how)}"
            raise ValueError(f"{what}; allowed: divided_by for a spectrum that says nothing itself")
        spectrum, how = _multiplied(spectrum, divided_by)
    elif elastic is not None and not elastic:
        raise ValueError("elastic = False is given alone; allowed: divided_by= as well, the factor")
    elif elastic and not said:
        how = STATED
    elif how is None or share < LEAST_ELASTIC_SHARE:
        how = NOT_STATED
    else:
        return spectrum
    taken = marked(spectrum, how)
    contradicted = bool(elastic) and share < LEAST_ELASTIC_SHARE
    missing = [_not_stated(taken, share)] if how == NOT_STATED or contradicted else []
    source = plain(spectrum.attrs.get("source", "spectrum"))
    for text in (*missing, *_doubts(taken)):
        warnings.warn(f"{source}: {text}", DoubtfulInput, stacklevel=4)
    return taken


def marked(spectrum: xr.DataArray, how: str) -> xr.DataArray:
    """The spectrum with what it was taken for, and the middle of its plateau, where that holds."""
    period = spectrum.period.values
    values = spectrum.values
    above = period > 0
    on_plateau = np.flatnonzero(above & (values >= (1 - SAME_ORDINATES) * values[above].max()))
    middle = on_plateau[on_plateau.size // 2]
    at = [float(period[middle]), float(values[middle])]
    return spectrum.assign_attrs({TAKEN_AS: how, ELASTIC_AT: at})


def _share_left(spectrum: xr.DataArray) -> float:
    """The ordinate over that for which the spectrum was said to be elastic; 1 where unknown."""
    period, ordinate = spectrum.attrs.get(ELASTIC_AT, (np.nan, np.nan))
    periods = spectrum.period.values
    if not periods[0] <= period <= periods[-1]:
        return 1.0
    return float(np.interp(period, periods, spectrum.values) / ordinate)


def _multiplied(
    spectrum: xr.DataArray, divided_by: float | xr.DataArray
) -> tuple[xr.DataArray, str]:
    """The spectrum times what it was divided by, and that in words."""
    period = spectrum.period.values
    if not isinstance(divided_by, xr.DataArray):
        factors = np.full(period.size, float(divided_by))
        words = f"{divided_by:g}"
    else:
        table = divided_by.period.values
        if not table[0] <= period[0] < period[-1] <= table[-1]:
            what = f"divided_by has {table[0]:g} to {table[-1]:g} s"
            whole = f"{period[0]:g} to {period[-1]:g} s"
            raise ValueError(f"{what}; allowed: a table for all periods of the spectrum, {whole}")
        factors = np.interp(period, table, divided_by.values)
        words = f"{factors.min():.4g} to {factors.max():.4g} over the period"
    elastic = spectrum.copy(data=spectrum.values * factors)
    return elastic, f"divided by {words}, multiplied back"


def _not_stated(spectrum: xr.DataArray, share: float) -> str:
    """That nothing says what a spectrum is, with the cure."""
    cure = "state elastic=True, or divided_by=4 if its ordinates are divided by R or q = 4"
    if share < LEAST_ELASTIC_SHARE:
        stated = f"is it divided by {1 / share:.3g}, and not elastic?"
        shown = stated if spectrum.attrs[TAKEN_AS] == STATED else cure
        return f"its ordinates are {share:.3g} of those that were elastic; {shown}"
    return (
        f"nothing says that it is elastic ({plateau_in_words(spectrum)}), and it is taken so; "
        f"{cure}"
    )


def _doubts(spectrum: xr.DataArray) -> Iterator[str]:
    """What in the ordinates of a spectrum is implausible, or speaks against an elastic one."""
    period = spectrum.period.values
    values = spectrum.values
    if text := PLAUSIBLE["largest ordinate"].doubt(values.max()):
        yield f"its largest ordinate is {_in_g(values.max())}; {text}"
    farthest = int(np.argmax(values * period**2))
    displacement = values[farthest] * (period[farthest] / math.tau) ** 2
    if text := PLAUSIBLE["spectral displacement"].doubt(displacement):
        yield f"its displacement at {period[farthest]:g} s is {displacement:.3g} m; {text}"
    yield from _doubt_of_rows(period, values)
    top = period[values >= (1 - SAME_ORDINATES) * values.max()]
    end = PLAUSIBLE["end of the plateau"].doubt(top[-1]) if top.size > 1 else ""
    if end:
        yield f"its plateau of {_in_g(values.max())} ends at {top[-1]:g} s; {end}"
    units = [unit for unit in (1.0, constants.g) if abs(values[0] / unit - 1) < SAME_ORDINATES]
    if period[0] == 0 and units and values.max() < LARGEST_RISE * values[0]:
        what = f"its ordinate at 0 s is exactly {_in_g(values[0])}"
        yield f"{what}; are ordinates divided by the ground acceleration?"
    percent = 100 * float(spectrum.attrs.get("damping", USUAL_DAMPING))
    usual = 3.21 - 0.68 * np.log(percent)
    rise = values.max() / values[0]
    begins_rigid = period[0] <= LONGEST_RIGID_PERIOD and not _begins_on_plateau(values)
    if begins_rigid and rise < LEAST_OF_MEDIAN * usual:
        yield (
            f"its plateau of {_in_g(values.max())} is {rise:.3g} times its ordinate of "
            f"{_in_g(values[0])} at {period[0]:g} s, and elastic spectra rise to {usual:.3g} times "
            "(Newmark and Hall 1982, median); is it divided by R or q?"
        )
    level = np.flatnonzero(np.abs(values / values[-1] - 1) > SAME_ORDINATES)
    first = level[-1] + 1 if level.size else 0
    low = first <= values.size - LEVEL_POINTS and (not first or values[-1] < 0.9 * values.max())
    if low and period[first] < LEVEL_FROM * (1 - SAME_ORDINATES):
        yield (
            f"it is level at {_in_g(values[-1])} from {period[first]:g} s on, as at the lower "
            f"bound of divided spectra, and elastic ones of codes are so from {LEVEL_FROM:g} s on "
            "(IS 1893, NBC 2010); is it divided by R or q?"
        )


def _doubt_of_rows(period: Array, values: Array) -> Iterator[str]:
    """Text on ordinates that jump from a period to the next, as if rows had different units.

    An ordinate may be more than that before by the ratio of the periods, and less by its square, as
    where velocity and displacement are constant.
    """
    above = np.flatnonzero(period[:-1] > 0)
    ratio = period[above + 1] / period[above]
    growth = values[above + 1] / values[above]
    jump = np.maximum(growth / ratio, 1 / (growth * ratio**2))
    too_far = jump > PLAUSIBLE["next ordinate"].high
    if too_far.any():
        n = above[np.argmax(too_far)]
        ends = f"from {values[n]:.3g} to {values[n + 1]:.3g} m/s^2"
        what = f"its ordinate goes {ends} between {period[n]:g} and {period[n + 1]:g} s"
        yield f"{what}; {PLAUSIBLE['next ordinate'].doubt(jump.max())}"


def doubt_of_pga(spectrum: xr.DataArray, pga: float) -> str:
    """What contradicts an elastic spectrum at a site with this peak ground acceleration [m/s^2]."""
    top = float(spectrum.max())
    below = f"is above the plateau of the spectrum, {_in_g(top)}; is that divided by R or q?"
    return below if top < pga * (1 - SAME_ORDINATES) else ""


def _begins_on_plateau(values: Array) -> bool:
    """Whether a code omits the rise from the peak ground acceleration, as that of Peru does."""
    first = values[:2] / values.max()
    return bool((first >= 1 - SAME_ORDINATES).all())


def pga_of(spectrum: xr.DataArray) -> float | None:
    """Peak ground acceleration of a spectrum [m/s^2]; None if it does not begin with that."""
    begins = spectrum.period.values[0] == 0 and not _begins_on_plateau(spectrum.values)
    return float(spectrum.values[0]) if begins else None


def plateau_in_words(spectrum: xr.DataArray) -> str:
    """Peak ground acceleration and largest ordinate."""
    pga = pga_of(spectrum)
    plateau = f"plateau {_in_g(spectrum.values.max())}"
    return plateau if pga is None else f"PGA {_in_g(pga)}, {plateau}"


def taken_in_words(spectrum: xr.DataArray) -> str:
    """Peak ground acceleration and plateau of a spectrum, and how it was taken."""
    damping = float(spectrum.attrs.get("damping", USUAL_DAMPING))
    other = "" if damping == USUAL_DAMPING else f", damping {100 * damping:.3g} %"
    return f"{plateau_in_words(spectrum)}{other}, {plain(spectrum.attrs.get(TAKEN_AS, NOT_STATED))}"


def _in_g(acceleration: float) -> str:
    return f"{acceleration / constants.g:.3g} g"
