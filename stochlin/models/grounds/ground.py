"""What the grounds have in common."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any, ClassVar, NamedTuple

import numpy as np
import xarray as xr

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization.filters import Filter, stationary
from stochlin.messages import brief
from stochlin.models.arguments import SCATTER
from stochlin.models.parameters import (
    Model,
    Parameter,
    Range,
    expect,
)
from stochlin.models.plausible import PLAUSIBLE, Plausible
from stochlin.models.uncertain import as_array, median_of
from stochlin.registry import Registry, expect_class


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
        raise ValueError(
            f"{kind.__name__}: calibration.soil is None; ranges and high_pass need a soil"
        )


GROUNDS: Registry[type[Ground]] = Registry("ground", "stochlin.models.grounds", check=_check_kind)
DAMPING_OF_GROUND = PLAUSIBLE["ground_damping"]
POSITIVE_DAMPING = Range(reason="an undamped ground has no stationary motion")


class UsualScatter(NamedTuple):
    """The scatter for a use of motions, and where it is from."""

    scatter: float
    source: str

    def __str__(self) -> str:
        return f"scatter {self.scatter:.3g} by default ({self.source})"


# The scatter that recorded earthquakes show (docs/reality.md). Records scatter less about a
# spectrum in the mean, and about as much in what yielding structures need: its default is on the
# safe side.
OTHER_COMPONENT = UsualScatter(0.4, "the other component of a station in the far field")
SCATTER_OF_SPECTRUM = UsualScatter(0.3, "suites of records about a spectrum, on the safe side")
SAME_DURATION = 0.01  # relative difference of durations that are taken as equal
MOST_FILTERS = 3  # in parallel, of a ground that is fitted to a spectrum


class Fit(NamedTuple):
    """Bounds and starting values of parameters other than period and intensity in `fit_ground`.

    Those of parameters in seconds are multiples of the ground's ``period``.
    """

    bounds: Mapping[str, tuple[float, float]]  # lower and upper bound, by name of the parameter
    # starting values of all these parameters, one tuple a search
    starts: Sequence[tuple[float, ...]]


class Calibration(NamedTuple):
    """How the drift closure is corrected on a kind of ground, and where simulations have shown it.

    The corrections are those of a Kanai-Tajimi ground, or those of white noise.
    """

    # Mean errors of rho in simulated pairs, by strength as in `kernels.correlation.errors`.
    rho_errors: tuple[float, float, float, float]
    # Parameters with period [s] and damping ratio of that Kanai-Tajimi ground; None for white
    # noise.
    soil: tuple[str, str] | None = None
    # Least and largest simulated value of other parameters; of those in seconds, over the soil's
    # period.
    ranges: Mapping[str, tuple[float, float]] = MappingProxyType({})
    high_pass: str = ""  # parameter with the period [s] of a high-pass filter, if there is one
    error: float = 0.01  # least relative error of a corrected standard deviation


@dataclass(frozen=True)
class Ground(Model, base=True):
    """Base of the grounds; ``intensity`` is the two-sided PSD ``S0`` of the white noise [m^2/s^3].

    A ground may leave out `fit`; it can then not be fitted to records. One without a `calibration`
    has no bias of the linearization: it is NaN. A subclass with another filter has no calibration
    unless it states one.
    """

    name: ClassVar[str]
    other_limits: ClassVar[Mapping[str, Plausible]] = {
        "damping": DAMPING_OF_GROUND,
        "period": PLAUSIBLE["ground_period"],
    }
    fit: ClassVar[Fit | None] = None
    calibration: ClassVar[Calibration | None] = None
    source: str = field(default="", compare=False, kw_only=True)
    # scatter of its motions between earthquakes, by default
    scatter: float = field(default=0.0, kw_only=True)
    # Duration [s] and envelope of the motions for which it was fitted to a spectrum, and the
    # longest period [s] of that.
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
        limits = self.fitted_for
        if limits is None:
            return
        numbers = (
            isinstance(limits, tuple)
            and len(limits) == 3
            and all(isinstance(limit, float) for limit in limits[::2])
        )
        if not numbers:
            what = f"{type(self).__name__}: fitted_for = {brief(limits)}"
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
            yield (
                f"ground was fitted to a spectrum up to {longest:g} s, "
                f"and a period is {period:.3g} s"
            )

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
            what = (
                f"{type(self).__name__}: motions of its filter grow with exp({made.growth:.3g} t)"
            )
            raise ValueError(
                f"{what}; allowed: a matrix whose eigenvalues have negative real parts"
            )
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
