"""Seismic hazard of a site: annual frequency of exceedance of an intensity of the motion."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, get_args

import numpy as np
import xarray as xr
from scipy.constants import g

from stochlin.kernels.basics.arrays import Array
from stochlin.messages import brief
from stochlin.models.arguments import Number, OneOf
from stochlin.models.parameters import POSITIVE, Model, Parameter, Range, check, parameter
from stochlin.models.plausible import PLAUSIBLE, implausible, warn_caller
from stochlin.models.uncertain import as_array

Exceeded = Literal["pga", "sa", "intensity"]
MEASURES: tuple[Exceeded, ...] = get_args(Exceeded)
FEWEST_INTENSITIES = 2  # smallest number of points of a curve
MOST_OFTEN = 1e4  # [1/yr], about once an hour, above which an annual frequency has another unit
DESIGN_RETURN_PERIOD = 475.0  # yr, return period of the shaking of a design, 10 % in 50 years
FREQUENT_RETURN_PERIODS = 2.0, 10.0  # yr, return periods of shaking that most sites have had
_ROUNDING = 1e-9  # relative rounding error allowed at the ends of a curve


@dataclass(frozen=True)
class Hazard(Model, base=True):
    """Base of hazards, for peak ground acceleration, ``Sa`` at a period, or intensity ``S0``."""

    measure: Exceeded = field(default="pga", kw_only=True)
    period: float | None = field(default=None, kw_only=True)

    def __post_init__(self) -> None:
        super().__post_init__()
        kind = type(self).__name__
        OneOf(MEASURES)(f"{kind}: measure", self.measure)
        if (self.measure == "sa") != (self.period is not None):
            what = f"{kind}: measure = {self.measure!r} with period = {brief(self.period)}"
            raise ValueError(f"{what}; allowed: a period in seconds with sa alone")
        if self.period is not None:
            Number(POSITIVE)(f"{kind}: period", self.period)

    def frequency(self, intensity: Parameter) -> Any:
        """Annual frequency at which an intensity is exceeded [1/yr]."""
        raise NotImplementedError

    def intensity(self, return_period: Parameter) -> Any:
        """Intensity, in the unit of the measure, that is exceeded with a return period [yr]."""
        raise NotImplementedError

    def of_design(self) -> float:
        """Intensity, in the measure's unit, with a return period of 475 years; NaN for a scan."""
        return float("nan")

    def often(self, years: float) -> float:
        """Intensity, in the unit of the measure, with a short return period; NaN if it has none."""
        return float("nan")

    def doubts(self) -> Iterator[str]:
        """Texts on the shaking of a design, and on what is frequent, if they are implausible.

        A spectral acceleration is compared with the lowest and the highest of the spectra of EN
        1998-1, 3.2.2.2, for the limits of the ground acceleration: that of type 2 on ground A, and
        the plateau.
        """
        design = self.of_design()
        limits = PLAUSIBLE["pga of 475 years"]
        units = "m/s^2"
        if self.measure == "intensity":
            limits = PLAUSIBLE["intensity"]
            units = "m^2/s^3"
        elif self.period is not None:
            low = 2.5 * min(1.0, 0.25 / self.period, 0.3 / self.period**2) * limits.low
            high = 2.5 * limits.high
            usual = f"{low / g:.2g} to {high / g:.2g} g"
            limits = limits._replace(low=low, high=high, usual=usual)
        if text := limits.doubt(design):
            of_period = f"{self.measure} with a return period of {DESIGN_RETURN_PERIOD:g} years"
            yield f"its {of_period} is {design:.3g} {units}; {text}"
        for years in FREQUENT_RETURN_PERIODS if self.measure == "pga" else ():
            often = self.often(years)
            if text := PLAUSIBLE[f"pga of {years:g} years"].doubt(often):
                yield (
                    f"its pga with a return period of {years:g} years is {often:.3g} m/s^2; {text}"
                )
                return


def _of(values: Any, name: str) -> float | xr.DataArray:
    return check("", name, values, {"allowed": POSITIVE, "units": "1", "long_name": name})


@dataclass(frozen=True)
class HazardCurve(Hazard):
    """Hazard curve from a table of annual frequencies of exceedance, interpolated log-log.

    The curve is not extrapolated: beyond the table a number raises an error, and cells of an array
    are NaN.

    Parameters
    ----------
    intensities : sequence of float
        Values of the ``measure``, positive and increasing, in m/s^2, or in m^2/s^3 for
        ``"intensity"``.
    frequencies : sequence of float
        Annual frequencies at which the intensities are exceeded [1/yr], positive and decreasing.
    measure : {"pga", "sa", "intensity"}
        Quantity that is exceeded: peak ground acceleration, pseudo-acceleration at a period
        (damping ratio 0.05), or intensity ``S0`` of the ground.
    period : float, optional
        Period [s] of ``"sa"``, required with it and not allowed otherwise.
    source : str
        The file, and what of it was asked for by number or converted. Equal curves may differ in
        it.

    Raises
    ------
    ValueError, TypeError
        If there are fewer than two points, or not as many frequencies as intensities; if a number
        is not positive, the intensities do not increase or the frequencies do not decrease; if the
        measure is unknown; or if a period is missing or not allowed.

    Warns
    -----
    ImplausibleInput
        If the shaking with a return period of 475 years is that of a site of low seismicity, as if
        intensities were in g, or more than any site has.

    References
    ----------
    Cornell, C. A. (1968), Engineering seismic risk analysis, Bull. Seismol. Soc. Am. 58.

    Examples
    --------
    >>> import stochlin as sl
    >>> hazard = sl.HazardCurve([1.0, 2.0, 4.0], [1e-2, 2e-3, 2e-4])
    >>> round(hazard.frequency(2.0), 9), round(hazard.intensity(return_period=475), 3)
    (0.002, 1.956)
    """

    intensities: tuple[float, ...]
    frequencies: tuple[float, ...]
    source: str = field(default="", kw_only=True, compare=False)

    def doubts(self) -> Iterator[str]:
        """Texts of ``Hazard``, on a curve that ends early, and a level part between steep ones."""
        doubts_of_shaking = [*super().doubts()]
        yield from doubts_of_shaking
        rarest = 1 / self.frequencies[-1]
        if not doubts_of_shaking and (text := PLAUSIBLE["rarest of a hazard"].doubt(rarest)):
            yield f"its rarest shaking has a return period of {rarest:.3g} years; {text}"
        slopes = -np.diff(np.log(self.frequencies)) / np.diff(np.log(self.intensities))
        kinks = slopes[1:-1] / np.minimum(slopes[:-2], slopes[2:])
        if text := PLAUSIBLE["kink of a hazard"].doubt(kinks.min(initial=1.0)):
            flat = int(np.argmin(kinks)) + 1
            ends = " to ".join(f"{value:.3g}" for value in self.intensities[flat : flat + 2])
            yield f"its slope from {ends} is {kinks.min():.2g} of those beside it; {text}"

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in ("intensities", "frequencies"):
            numbers = _numbers(f"HazardCurve: {name}", getattr(self, name))
            object.__setattr__(self, name, tuple(numbers.tolist()))
        points = len(self.intensities)
        if points != len(self.frequencies):
            what = f"HazardCurve: {points} intensities and {len(self.frequencies)} frequencies"
            raise ValueError(f"{what}; allowed: as many of one as of the other")
        places = [f"HazardCurve, number {n}" for n in range(1, points + 1)]
        check_curve(np.array(self.intensities), np.array(self.frequencies), places)

    def frequency(self, intensity: Parameter) -> Any:
        """Annual frequency at which an intensity is exceeded [1/yr]."""
        return self._between("intensity", intensity, self.intensities, self.frequencies)

    def intensity(self, return_period: Parameter) -> Any:
        """Intensity, in the unit of the measure, that is exceeded with a return period [yr]."""
        warn_caller("intensity", lambda: implausible({"return_period": return_period}))
        years = [1 / frequency for frequency in self.frequencies]
        return self._between("return_period", return_period, years, self.intensities)

    def of_design(self) -> float:
        """Intensity, in the unit of the measure, with a return period of 475 years.

        Beyond the curve it grows with the third root of the return period (EN 1998-1, 2.1(4)), and
        ``S0`` with the square of that.
        """
        shortest = 1 / self.frequencies[0]
        longest = 1 / self.frequencies[-1]
        years = float(np.clip(DESIGN_RETURN_PERIOD, shortest, longest))
        exponent = 2 / 3 if self.measure == "intensity" else 1 / 3
        return float(self.intensity(years) * (DESIGN_RETURN_PERIOD / years) ** exponent)

    def often(self, years: float) -> float:
        """Intensity, in the measure's unit, with a short return period; NaN beyond the curve."""
        within = self.frequencies[-1] <= 1 / years <= self.frequencies[0]
        return float(self.intensity(years)) if within else float("nan")

    def describe(self) -> str:
        """The curve with its points in one line; long tables are shortened."""
        both = (
            f"{name}={brief(list(getattr(self, name)))}" for name in ("intensities", "frequencies")
        )
        return f"HazardCurve({', '.join(both)})"

    def _between(
        self, name: str, at: Parameter, axis: Sequence[float], values: Sequence[float]
    ) -> Any:
        value = _of(at, name)
        ends = (axis[0] * (1 - _ROUNDING), axis[-1] * (1 + _ROUNDING))
        if isinstance(value, float) and not ends[0] <= value <= ends[1]:
            covered = f"{axis[0]:.4g} to {axis[-1]:.4g}"
            what = f"{name} = {value:g} is beyond the hazard curve; allowed: {covered}"
            early = name == "return_period" and axis[-1] < DESIGN_RETURN_PERIOD
            cure = ", or, if its frequencies are probabilities, annual ones" if early else ""
            raise ValueError(what + cure)

        def interpolated(at: Array) -> Array:
            result = np.exp(np.interp(np.log(at), np.log(axis), np.log(values)))
            return np.where((at >= ends[0]) & (at <= ends[1]), result, np.nan)

        return _applied(interpolated, value)


@dataclass(frozen=True)
class PowerLawHazard(Hazard):
    """Hazard curve by a power law: the annual frequency of exceedance of ``im`` is ``k0 im^-k``.

    Parameters
    ----------
    k0 : float or array
        Annual frequency [1/yr] at which an intensity ``im`` of 1 m/s^2, or of 1 m^2/s^3 for
        ``"intensity"``, is exceeded; between 1e-30 and 1e10.
    k : float or array
        Exponent [-], between 0.5 and 10; usually 2 to 4.
    measure : {"pga", "sa", "intensity"}
        As in `HazardCurve`.
    period : float, optional
        As in `HazardCurve`.

    Raises
    ------
    ValueError, TypeError
        If a number is out of range, the measure is unknown, or a period is missing or not allowed.

    Warns
    -----
    ImplausibleInput
        If the shaking with a return period of 475 years is that of a site of low seismicity, as if
        ``k0`` were the frequency at 1 g, or more than any site has.

    References
    ----------
    Cornell, C. A. (1968), Engineering seismic risk analysis, Bull. Seismol. Soc. Am. 58.

    Examples
    --------
    >>> import stochlin as sl
    >>> hazard = sl.PowerLawHazard(k0=0.02, k=3.0)
    >>> round(hazard.frequency(2.0), 6), round(hazard.intensity(return_period=400), 9)
    (0.0025, 2.0)
    """

    k0: Parameter = parameter("1/yr", "annual frequency at an intensity of 1", Range(1e-30, 1e10))
    k: Parameter = parameter("1", "exponent of the hazard", Range(0.5, 10))

    def frequency(self, intensity: Parameter) -> Any:
        """Annual frequency at which an intensity is exceeded [1/yr]."""
        law = self.arrays()
        value = _of(intensity, "intensity")
        return _applied(lambda im, k0, k: k0 * np.power(im, -k), value, *law.values())

    def intensity(self, return_period: Parameter) -> Any:
        """Intensity, in the unit of the measure, that is exceeded with a return period [yr]."""
        warn_caller("intensity", lambda: implausible({"return_period": return_period}))
        law = self.arrays()
        value = _of(return_period, "return_period")
        return _applied(lambda years, k0, k: np.power(k0 * years, 1 / k), value, *law.values())

    def of_design(self) -> float:
        """Intensity, in the measure's unit, with a return period of 475 years; NaN for a scan."""
        return self._of_law(DESIGN_RETURN_PERIOD)

    def often(self, years: float) -> float:
        """Intensity, in the unit of the measure, with a short return period; NaN for a scan."""
        return self._of_law(years)

    def _of_law(self, years: float) -> float:
        intensity = self.intensity(years)
        return intensity if isinstance(intensity, float) else float("nan")


def check_curve(intensities: Array, frequencies: Array, places: Sequence[str]) -> None:
    """Raise a ValueError unless these are a hazard curve; ``places`` name points in messages."""
    if intensities.size < FEWEST_INTENSITIES:
        where = places[0] if places else "hazard curve"
        raise ValueError(
            f"{where}: {intensities.size} points; allowed: {FEWEST_INTENSITIES} or more intensities"
        )
    rising = "increasing intensities, so sort them"
    falling = "falling frequencies, since what is stronger is rarer"
    if np.median(frequencies) > np.median(intensities):
        rising += ", or are they exchanged with the frequencies?"
    if (frequencies >= 1).all():
        falling += ", or are they return periods?"
    columns = ("intensity", intensities, 1, rising), ("annual frequency", frequencies, -1, falling)
    for n, place in enumerate(places):
        for name, values, sign, allowed in columns:
            if not 0 < values[n] < np.inf:
                raise ValueError(f"{place}: the {name} is {values[n]:g}; allowed: positive, finite")
            if values is frequencies and values[n] > MOST_OFTEN:
                what = f"{place}: the {name} is {values[n]:g}"
                raise ValueError(f"{what}; allowed: {MOST_OFTEN:g} a year or less")
            if n and sign * values[n] <= sign * values[n - 1]:
                what = f"{place}: the {name} {values[n]:g} follows {values[n - 1]:g}"
                raise ValueError(f"{what}; allowed: {allowed}")


def _numbers(name: str, values: object) -> Array:
    array = as_array(values)
    if array.ndim != 1 or array.dtype.kind not in "iuf":
        raise TypeError(f"{name} = {brief(values)}; allowed: a list of numbers")
    return array.astype(float)


def _applied(function: Any, *values: Any) -> Any:
    """Function of the values: a number if all are numbers, else an array with their dimensions."""
    with np.errstate(all="ignore"):
        result = xr.apply_ufunc(function, *values, join="exact", keep_attrs=False)
    return result if isinstance(result, xr.DataArray) and result.ndim else float(result)
