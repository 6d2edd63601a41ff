"""Grounds: models of stationary random ground acceleration as filtered white noise."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from types import MappingProxyType
from typing import Any, ClassVar, NamedTuple

import numpy as np
import xarray as xr

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization.filters import Filter, stationary
from stochlin.kernels.linearization.parallel_filters import in_parallel
from stochlin.messages import brief
from stochlin.models.arguments import SCATTER, checked
from stochlin.models.parameters import (
    PERIODS,
    POSITIVE,
    Model,
    Parameter,
    Range,
    expect,
    parameter,
)
from stochlin.models.plausible import PLAUSIBLE, Plausible
from stochlin.models.uncertain import as_array, median_of
from stochlin.registry import Registry, expect_class

__all__ = ["Filter"]  # which grounds of other packages need


def _check_kind(kind: type[Ground]) -> None:
    """Raise a ValueError for a kind of ground that lacks a filter, a name, or a parameter."""
    expect_class(kind, Ground, "filter", "name")
    calibration = kind.calibration or Calibration((0.0,) * 4)
    declared = {
        "Ground": ("intensity",),
        "fit": ("period", *kind.fit.bounds) if kind.fit else (),
        "calibration.soil": calibration.soil or (),
        "calibration.ranges": calibration.ranges,
        "calibration.high_pass": (calibration.high_pass,) if calibration.high_pass else (),
    }
    names = kind.parameter_names()
    for by, needed in declared.items():
        for name in needed:
            if name not in names:
                what = f"{kind.__name__}: {name!r}, which {by} needs, is no parameter"
                raise ValueError(f"{what}; allowed: {', '.join(names)}")
    if not calibration.soil and (calibration.ranges or calibration.high_pass):
        raise ValueError(f"{kind.__name__}: calibration.soil is None; ranges and high_pass need a soil")


GROUNDS: Registry[type[Ground]] = Registry("ground", "stochlin.models.grounds", check=_check_kind)
OF_GROUND = PLAUSIBLE["ground_damping"]
POSITIVE_DAMPING = Range(reason="an undamped ground has no stationary motion")


class UsualScatter(NamedTuple):
    """The scatter for a use of motions, and where it is from."""

    scatter: float
    source: str

    def __str__(self) -> str:
        return f"scatter {self.scatter:.3g} by default ({self.source})"


# The scatter that recorded earthquakes show (docs/reality.md). Records scatter less about a spectrum in
# the mean, and about as much in what yielding structures need: its default is on the safe side.
OTHER_COMPONENT = UsualScatter(0.4, "the other component of a station in the far field")
OF_SPECTRUM = UsualScatter(0.3, "suites of records about a spectrum, on the safe side")
SAME_DURATION = 0.01  # relative difference of durations that are taken as equal
MOST_FILTERS = 3  # in parallel, of a ground that is fitted to a spectrum


class Fit(NamedTuple):
    """Bounds and starting values by which `fit_ground` seeks parameters other than period and intensity.

    Those of parameters in seconds are multiples of the ground's ``period``.
    """

    bounds: Mapping[str, tuple[float, float]]  # lower and upper bound, by name of the parameter
    starts: Sequence[tuple[float, ...]]  # starting values of all these parameters, one tuple a search


class Calibration(NamedTuple):
    """How the drift closure is corrected on a kind of ground, and where simulations have shown it.

    The corrections are those of a Kanai-Tajimi ground, or those of white noise.
    """

    # Mean errors of rho in simulated pairs, by strength as in `kernels.correlation.errors`.
    rho_errors: tuple[float, float, float, float]
    # Parameters with period [s] and damping ratio of that Kanai-Tajimi ground; None for white noise.
    soil: tuple[str, str] | None = None
    # Least and largest simulated value of other parameters; of those in seconds, over the soil's period.
    ranges: Mapping[str, tuple[float, float]] = MappingProxyType({})
    high_pass: str = ""  # parameter with the period [s] of a high-pass filter, if there is one
    error: float = 0.01  # least relative error of a corrected standard deviation


@dataclass(frozen=True)
class Ground(Model, base=True):
    """Base of the grounds; ``intensity`` is the two-sided PSD ``S0`` of the white noise [m^2/s^3].

    A ground may leave out `fit`; it can then not be fitted to records. One without a `calibration` has
    no bias of the linearization: it is NaN. A subclass with another filter has no calibration unless it
    states one.
    """

    name: ClassVar[str]
    other_limits: ClassVar[Mapping[str, Plausible]] = {
        "damping": OF_GROUND,
        "period": PLAUSIBLE["ground_period"],
    }
    fit: ClassVar[Fit | None] = None
    calibration: ClassVar[Calibration | None] = None
    source: str = field(default="", compare=False, kw_only=True)
    scatter: float = field(default=0.0, kw_only=True)  # of its motions between earthquakes, by default
    # Duration [s] and envelope of the motions for which it was fitted to a spectrum, and the longest
    # period [s] of that.
    fitted_for: tuple[float, Any, float] | None = field(default=None, compare=False, kw_only=True)

    def __post_init__(self) -> None:
        SCATTER(f"{type(self).__name__}: scatter", self.scatter)
        self._check_fitted_for()
        super().__post_init__()

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        if "filter" in vars(cls) and "calibration" not in vars(cls):
            cls.calibration = None

    def _check_fitted_for(self) -> None:
        """Raise a TypeError unless it is None, or what `fit_ground` states."""
        known = self.fitted_for
        if known is None:
            return
        numbers = (
            isinstance(known, tuple)
            and len(known) == 3
            and all(isinstance(each, float) for each in known[::2])
        )
        if not numbers:
            what = f"{type(self).__name__}: fitted_for = {brief(known)}"
            raise TypeError(f"{what}; allowed: duration [s], envelope and longest period [s]")

    def doubts_of_use(self, duration: float, envelope: object, period: float) -> Iterator[str]:
        """Texts on motions and a longest period [s] of structures for which it was not fitted."""
        if self.fitted_for is None:
            return
        seconds, shape, longest = self.fitted_for
        if not math.isclose(duration, seconds, rel_tol=SAME_DURATION) or envelope != shape:
            motions = f"motions of {seconds:g} s{'' if shape is None else f' under {shape!r}'}"
            yield f"ground was fitted to a spectrum for {motions}; are these others meant?"
        if period > longest:
            yield f"ground was fitted to a spectrum up to {longest:g} s, and a period is {period:.3g} s"

    @property
    def parts(self) -> tuple[Ground, ...]:
        """The grounds whose accelerations it adds: by default itself alone."""
        return (self,)

    @staticmethod
    def filter(values: Mapping[str, Any]) -> Filter:
        """The filter of the white noise for these parameter values, numbers or arrays over cells.

        State space, spectra, linearization and time steps are derived from this filter.
        """
        raise NotImplementedError

    def filter_of(self, rows: Iterable[Array]) -> Filter:
        """The filter for arrays over cells; ``rows`` are parameter values in the order of `cells`.

        A ValueError is raised for a filter that does not come to rest.
        """
        made = self.filter(dict(zip(self.cells(), rows, strict=True)))
        if made.growth >= 0:
            what = f"{type(self).__name__}: motions of its filter grow with exp({made.growth:.3g} t)"
            raise ValueError(f"{what}; allowed: a matrix whose eigenvalues have negative real parts")
        return made

    def lone_filter(self) -> Filter:
        """The filter of a ground whose parameters are all numbers."""
        return self.filter_of(value.item() for value in self.arrays().values())

    def psd(self, frequency: Parameter) -> xr.DataArray:
        """Two-sided power spectral density of the ground acceleration, per rad/s [m^2/s^3].

        ``frequency`` holds circular frequencies [rad/s] of any shape; a plain 1-D array gets the
        dimension ``frequency``.

        Examples
        --------
        >>> import stochlin as sl
        >>> float(sl.KanaiTajimi(period=2.0, damping=0.05).psd(0.0))
        1.0
        """
        if not isinstance(frequency, xr.DataArray):
            values = as_array(frequency).astype(float)
            dims = ["frequency"][: values.ndim]
            coords = {"frequency": ("frequency", values, {"units": "rad/s"})} if dims else None
            frequency = xr.DataArray(values, dims=dims, coords=coords)

        def transmission(frequency: Array, *rows: Array) -> Array:
            return self.filter_of(rows).transmission(frequency)

        arrays = self.arrays()
        over_s0 = xr.apply_ufunc(transmission, frequency, *arrays.values(), join="exact")
        density = arrays["intensity"] * over_s0
        density.attrs = {"units": "m^2/s^3", "long_name": "two-sided PSD of ground acceleration"}
        return density.rename("psd")


@GROUNDS.register("white_noise", 3)
@dataclass(frozen=True)
class WhiteNoise(Ground):
    """White noise ground acceleration, with the constant PSD ``S0``.

    Parameters
    ----------
    intensity, source, scatter, fitted_for
        As in `KanaiTajimi`.

    Raises
    ------
    ValueError, TypeError
        As in `KanaiTajimi`.

    Examples
    --------
    >>> import stochlin as sl
    >>> sl.WhiteNoise(intensity=0.01).describe()
    'white noise (intensity 0.01 m²/s³)'
    """

    name: ClassVar[str] = "white noise"
    calibration: ClassVar[Calibration] = Calibration((0.02, 0.02, 0.04, 0.06))  # of 89 pairs
    intensity: Parameter = parameter("m^2/s^3", "two-sided PSD of the white noise", POSITIVE, 1.0)

    @staticmethod
    def filter(values: Mapping[str, Any]) -> Filter:
        """A filter without states, whose output is the white noise itself."""
        return Filter(values["intensity"])


@GROUNDS.register("kanai_tajimi", 1)
@dataclass(frozen=True)
class KanaiTajimi(Ground):
    """Kanai-Tajimi ground: white noise filtered by one soil oscillator, eqs. (11) and (12).

    ``f = wg^2 xg + 2 xig wg xg'`` with ``xg'' + 2 xig wg xg' + wg^2 xg = n``, so that the PSD is
    ``S0 (1 + 4 xig^2 (w/wg)^2) / [(1 - (w/wg)^2)^2 + 4 xig^2 (w/wg)^2]``.

    Parameters
    ----------
    period : float or array
        Ground period ``2 pi / wg`` [s], positive.
    damping : float or array
        Damping ratio ``xig`` of the soil oscillator [-], positive, which sets the bandwidth of the
        motion: about 0.05 for a lake bed, 0.6 for firm ground.
    intensity : float or array
        Two-sided PSD ``S0`` of the white noise per rad/s [m^2/s^3], positive.
    source : str
        Reference for the parameter values.
    scatter : float
        Default of the argument ``scatter`` of functions that simulate motions of finite duration [-], as
        in `simulate`. That of a ground that is fitted to a spectrum or a record is not 0.
    fitted_for : tuple, optional
        Duration [s] and envelope of the motions for which `fit_ground` fitted the ground to a spectrum,
        and the longest period [s] of that; other motions are then asked about.

    Raises
    ------
    ValueError, TypeError
        If a parameter is out of range, is not a number or has a wrong shape.

    Notes
    -----
    The PSD at zero frequency is ``S0``, which makes the displacements of structures with long periods
    too large. `CloughPenzien` has no PSD at zero frequency.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), eqs. (11) and (12); Kanai, K. (1957), Bull. Earthquake Res. Inst.
    35; Tajimi, H. (1960), 2nd World Conference on Earthquake Engineering.

    Examples
    --------
    >>> import stochlin as sl
    >>> sl.KanaiTajimi(period=2.0, damping=0.05).describe()
    'Kanai-Tajimi (period 2 s, damping 0.05, intensity 1 m²/s³)'
    """

    name: ClassVar[str] = "Kanai-Tajimi"
    fit: ClassVar[Fit] = Fit({"damping": (2e-3, 3.0)}, ((0.02,), (0.06,), (0.2,), (0.6,)))
    calibration: ClassVar[Calibration] = Calibration(
        (0.02, 0.03, 0.02, 0.03), soil=("period", "damping")
    )  # of 555 pairs
    period: Parameter = parameter("s", "ground period", PERIODS)
    damping: Parameter = parameter("1", "ground damping ratio", POSITIVE_DAMPING)
    intensity: Parameter = parameter("m^2/s^3", "two-sided PSD of the white noise", POSITIVE, 1.0)

    @staticmethod
    def filter(values: Mapping[str, Any]) -> Filter:
        """The soil oscillator as a filter of the white noise."""
        frequency = 2 * np.pi / values["period"]
        return Filter.kanai_tajimi(values["intensity"], frequency, values["damping"])


@GROUNDS.register("clough_penzien", 2)
@dataclass(frozen=True)
class CloughPenzien(Ground):
    """Clough-Penzien ground: a Kanai-Tajimi ground with a high-pass filter.

    The high-pass filter is an oscillator. The PSD is that of `KanaiTajimi` times
    ``(w/wf)^4 / [(1 - (w/wf)^2)^2 + 4 xif^2 (w/wf)^2]``, so that it is zero at zero frequency.

    Parameters
    ----------
    period, damping : float or array
        Period ``2 pi / wg`` [s] and damping ratio ``xig`` [-] of the soil oscillator, positive.
    high_pass_period, high_pass_damping : float or array
        Period ``2 pi / wf`` [s] and damping ratio ``xif`` [-] of the high-pass oscillator, positive.
    intensity, source, scatter, fitted_for
        As in `KanaiTajimi`.

    Raises
    ------
    ValueError, TypeError
        As in `KanaiTajimi`.

    References
    ----------
    Clough, R. W. and Penzien, J. (1975), Dynamics of structures.

    Examples
    --------
    >>> import stochlin as sl
    >>> ground = sl.CloughPenzien(0.42, 0.6, high_pass_period=4.2, high_pass_damping=0.6)
    >>> float(ground.psd(0.0))
    0.0
    """

    name: ClassVar[str] = "Clough-Penzien"
    other_limits: ClassVar[Mapping[str, Plausible]] = {
        **Ground.other_limits,
        "high_pass_damping": OF_GROUND,
        "high_pass_period": PLAUSIBLE["period"],
    }
    fit: ClassVar[Fit] = Fit(
        {
            **KanaiTajimi.fit.bounds,
            "high_pass_period": (1.0, 100.0),
            "high_pass_damping": (0.1, 3.0),
        },
        [(*soil, *layer) for soil in KanaiTajimi.fit.starts for layer in ((1.5, 0.3), (6.0, 0.6))],
    )
    # Structures are corrected as on the ground without the high-pass filter.
    calibration: ClassVar[Calibration] = Calibration(
        (0.02, 0.03, 0.03, 0.04),  # of 556 pairs
        soil=("period", "damping"),
        ranges={"high_pass_period": (2.0, 25.0), "high_pass_damping": (0.2, 1.3)},
        high_pass="high_pass_period",
        error=0.03,
    )
    period: Parameter = parameter("s", "ground period", PERIODS)
    damping: Parameter = parameter("1", "ground damping ratio", POSITIVE_DAMPING)
    high_pass_period: Parameter = parameter("s", "high-pass period", PERIODS)
    high_pass_damping: Parameter = parameter("1", "high-pass damping ratio", POSITIVE)
    intensity: Parameter = parameter("m^2/s^3", "two-sided PSD of the white noise", POSITIVE, 1.0)

    def doubts(self) -> Iterator[str]:
        """Text on a high-pass filter that takes away the motion of the ground."""
        high_pass = self.high_pass_period
        period = self.period
        ratio = high_pass / period if isinstance(high_pass, float) and isinstance(period, float) else 0.0
        if text := PLAUSIBLE["high pass over ground"].doubt(ratio):
            times = f"{ratio:.2g} times the period of the ground"
            yield f"high_pass_period = {high_pass:g} is {times}; {text}"

    @staticmethod
    def filter(values: Mapping[str, Any]) -> Filter:
        """The soil oscillator, followed by the high-pass oscillator."""
        frequency = 2 * np.pi / values["high_pass_period"]
        return KanaiTajimi.filter(values).clough_penzien(frequency, values["high_pass_damping"])


@dataclass(frozen=True)
class ParallelGround(Ground):
    """Sum of the accelerations of several independent grounds; its PSD is the sum of their PSDs.

    The PSD of a single filter has one peak. Two grounds in parallel fit a design spectrum within a few
    per cent.

    Parameters
    ----------
    grounds : sequence of KanaiTajimi, CloughPenzien or an extension
        Two or more filtered grounds, whose parameters are all numbers. The ratios of their intensities
        are kept.
    intensity : float or array, optional
        Sum of the two-sided PSDs ``S0`` of their white noises [m^2/s^3], positive. If given, all grounds
        are scaled by one factor to this sum; by default the intensities are those of the grounds.
    source, scatter, fitted_for
        As in `KanaiTajimi`; the scatter of the grounds is not used.

    Raises
    ------
    ValueError, TypeError
        If fewer than two grounds are given, or if a ground is of another kind, has arrays or has no
        filter, as `WhiteNoise`.

    Notes
    -----
    The PSD defines a stationary Gaussian motion. The sum is therefore modelled by one white noise and
    one filter, the spectral factor of the sum of the PSDs, from which state space, linearization and
    time steps follow.

    References
    ----------
    Papoulis, A. (1991), Probability, random variables, and stochastic processes, for spectral
    factorization.

    Examples
    --------
    >>> import stochlin as sl
    >>> slow = sl.CloughPenzien(1.0, 0.4, 5.0, 0.6, intensity=0.01)
    >>> fast = sl.CloughPenzien(0.2, 0.5, 1.0, 0.6, intensity=0.02)
    >>> both = sl.ParallelGround([slow, fast])
    >>> both.intensity, round(float(both.psd(6.0) / (slow.psd(6.0) + fast.psd(6.0))), 9)
    (0.03, 1.0)
    """

    name: ClassVar[str] = "parallel-filter"
    grounds: Sequence[Ground]
    intensity: Parameter = parameter("m^2/s^3", "two-sided PSD of the white noises", POSITIVE, None)

    def __post_init__(self) -> None:
        if isinstance(self.grounds, Ground) or not isinstance(self.grounds, Sequence):
            raise TypeError(f"ParallelGround: grounds = {brief(self.grounds)}; allowed: a list of them")
        object.__setattr__(self, "grounds", tuple(self.grounds))
        if len(self.grounds) < 2:
            raise ValueError(f"ParallelGround: {len(self.grounds)} grounds; allowed: two or more")
        for number, ground in enumerate(self.grounds, 1):
            role = f"ParallelGround: grounds, number {number}"
            expect(ground, Ground, role)
            if any(array.ndim for array in ground.arrays().values()):
                raise ValueError(f"{role}: {ground.describe()} has an array; allowed: numbers")
        if self.intensity is None:
            object.__setattr__(self, "intensity", self._own_intensity)
        super().__post_init__()
        _ = self._filter  # raises for grounds that cannot be combined

    @cached_property
    def _own_intensity(self) -> float:
        return float(sum(ground.arrays()["intensity"] for ground in self.grounds))

    @cached_property
    def _filter(self) -> Filter:
        """The filter of the sum for a total intensity of 1."""
        filters = [ground.lone_filter() for ground in self.grounds]
        return in_parallel([replace(f, intensity=f.intensity / self._own_intensity) for f in filters])

    def filter(self, values: Mapping[str, Any]) -> Filter:  # type: ignore[override]
        """The filter of the sum at the total intensity in ``values``."""
        return replace(self._filter, intensity=values["intensity"])

    @property
    def parts(self) -> tuple[Ground, ...]:
        """The grounds."""
        return tuple(self.grounds)

    def further(self) -> list[str]:
        """The grounds."""
        return [" + ".join(ground.describe() for ground in self.grounds)]


def _ground(
    source: str, frequency: float, damping: float, *high_pass: float
) -> KanaiTajimi | CloughPenzien:
    """A ground from frequency [rad/s] and damping ratio of the soil and of any high-pass oscillator.

    The references print circular frequencies, not periods.
    """
    soil = 2 * np.pi / frequency, damping
    if not high_pass:
        return KanaiTajimi(*soil, source=source)
    high_pass_frequency, high_pass_damping = high_pass
    return CloughPenzien(*soil, 2 * np.pi / high_pass_frequency, high_pass_damping, source=source)


_DER_KIUREGHIAN = "Der Kiureghian & Neuenhofer 1992, Earthquake Eng. Struct. Dyn. 21, 713-740"
_GIARALIS = "Giaralis & Spanos, fitted to the Eurocode 8 spectrum of ground type"
_YEH_WEN = "Yeh & Wen 1990, Structural Safety 8, 281-298"
_FIT = "least squares on the linear PSD of the 5-95 % part of the record"

_GROUNDS = {
    "firm": _ground(f"{_DER_KIUREGHIAN}, firm", 15.0, 0.6, 1.5, 0.6),
    "medium": _ground(f"{_DER_KIUREGHIAN}, medium", 10.0, 0.4, 1.0, 0.6),
    "soft": _ground(f"{_DER_KIUREGHIAN}, soft", 5.0, 0.2, 0.5, 0.6),
    "ec8_a": _ground(f"{_GIARALIS} A", 17.57, 0.54, 2.22, 0.78),
    "ec8_b": _ground(f"{_GIARALIS} B", 10.73, 0.78, 2.33, 0.90),
    "ec8_c": _ground(f"{_GIARALIS} C", 7.49, 0.84, 2.14, 1.15),
    "ec8_d": _ground(f"{_GIARALIS} D", 5.34, 0.88, 2.12, 1.17),
    "ec8_e": _ground(f"{_GIARALIS} E", 10.76, 0.77, 2.03, 1.07),
    "taft_1952_yeh_wen": _ground(f"{_YEH_WEN}, Taft 1952", 20.0, 0.65, 1.0, 0.5),
    "mexico_city_1985_yeh_wen": _ground(f"{_YEH_WEN}, Mexico City 1985", 4.2, 0.10, 0.23, 0.1),
    "sct_1985_ns": _ground(f"{_FIT} Mexico City 1985-09-19, SCT, NS", 3.09, 0.054),
    "sct_1985_ew": _ground(f"{_FIT} Mexico City 1985-09-19, SCT, EW", 3.11, 0.033),
    "taft_1952": _ground(f"{_FIT} Kern County 1952, Taft 111", 17.8, 0.45),
}


def ground_names() -> tuple[str, ...]:
    """Names of the parameter sets that `named_ground` takes, in lower case."""
    return tuple(_GROUNDS)


@checked
def named_ground(name: str, intensity: Parameter = 1.0) -> KanaiTajimi | CloughPenzien:
    """Ground with a published or fitted parameter set.

    Parameters
    ----------
    name : str
        ``firm``, ``medium``, ``soft``, ``ec8_a`` to ``ec8_e``, ``taft_1952``, ``taft_1952_yeh_wen``,
        ``sct_1985_ns``, ``sct_1985_ew`` or ``mexico_city_1985_yeh_wen``, in upper or lower case.
    intensity : float or array
        Two-sided PSD ``S0`` of the white noise per rad/s [m^2/s^3], positive. The parameter sets give
        only the shape of the spectrum, not its intensity.

    Returns
    -------
    KanaiTajimi or CloughPenzien
        A `CloughPenzien` ground if the set has a high-pass oscillator. ``source`` names the reference.

    Raises
    ------
    ValueError
        If the name is unknown (the message lists all names) or the intensity is out of range.

    Notes
    -----
    The sets ``sct_1985_ns``, ``sct_1985_ew`` and ``taft_1952`` are least-squares fits as made by
    `stochlin.fit_ground`. The two sets of the lake bed (SCT) are each fitted to one narrow spectral peak
    of a strong part of 37 to 71 s, so that their damping is uncertain by a factor of two.

    Examples
    --------
    >>> import stochlin as sl
    >>> sl.named_ground("sct_1985_ns").describe()
    'Kanai-Tajimi (period 2.03339 s, damping 0.054, intensity 1 m²/s³)'
    >>> sl.named_ground("EC8_D", intensity=0.01).source
    'Giaralis & Spanos, fitted to the Eurocode 8 spectrum of ground type D'
    """
    if (chosen := _GROUNDS.get(str(name).strip().lower())) is None:
        raise ValueError(f"name = {brief(name)} is not a known ground; allowed: {', '.join(_GROUNDS)}")
    return replace(chosen, intensity=intensity)


def scatter_of(ground: Any, scatter: float | None) -> float:
    """The scatter of the motions of a ground between earthquakes [-], by default its own."""
    return float(median_of(ground).scatter if scatter is None else scatter)


def rms_acceleration(ground: Ground) -> float:
    """Standard deviation of the stationary ground acceleration [m/s^2]; infinite for white noise.

    For a Kanai-Tajimi ground this is ``sqrt(pi S0 wg (1 + 4 xig^2)/(2 xig))``.
    """
    expect(ground, Ground, "ground")
    soil = ground.lone_filter()
    if not soil.states:
        return np.inf
    matrix, noise, output = soil.arrays
    covariance = stationary(matrix[None], noise[None])[0]
    return float(np.sqrt(2 * np.pi * soil.intensity * output @ covariance @ output))
