"""Fit of a ground to a strong-motion record, by its periodogram; the estimators of the fit."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any, Literal, NamedTuple

import numpy as np
import xarray as xr
from scipy import fft, optimize

from stochlin.applications.records.records import checked_record, strong_part
from stochlin.kernels.basics.arrays import Array
from stochlin.models.arguments import OneOf, TwoNumbers
from stochlin.models.grounds import GROUNDS, OTHER_COMPONENT, Ground

STRONG_PART: TwoNumbers = (0.05, 0.95)

# Shares of the cumulative energy over frequency between which a fit is made by default. Outside,
# leakage, noise and filters of the record outweigh the ground motion.
_ENERGY = (1e-4, 0.99)
# Share of the part under a cosine taper, for estimators that weight low ordinates fully.
_TAPER = 0.1
_INSIDE = 1e-6  # smallest distance of a start of a fit from the bounds
# Ordinates of the padded periodogram per independent one, so that sums approximate integrals.
_PADDING = 4
_MINIMUM_ORDINATES = 8
# Half width at half height [rad/s] of the spectral line of a sinusoid of 1 s in a periodogram.
_LINE_WIDTH = 2.78
_START_PERIODS = 16
# in the logarithm of a parameter
_PARAMETER_STEP = 1e-4
_ON_BOUND = 1e-3


class Estimator(NamedTuple):
    """Residuals of a fit, with the weight and variance from which standard errors follow.

    The estimating equations are ``sum weight e dlog(model)/dp = 0``. The error ``e`` has the
    variance ``variance``, since ordinates of a record over the true PSD are exponentially
    distributed.
    """

    text: str
    residual: Callable[[Array, Array], Array]
    weight: Callable[[Array], Array]
    variance: float
    taper: float


def _difference(record: Array, model: Array) -> Array:
    return (model - record) / record.max()


def _log_difference(record: Array, model: Array) -> Array:
    return np.log(model / record) - np.euler_gamma  # the mean log of an exponential variable


def _deviance(record: Array, model: Array) -> Array:
    ratio = record / model
    return np.sign(ratio - 1) * np.sqrt(2 * np.maximum(ratio - 1 - np.log(ratio), 0))


VARIANCE_OF_LOG = np.pi**2 / 6  # variance of the logarithm of an exponential variable
Estimated = Literal["psd", "log_psd", "whittle"]
ESTIMATORS: Mapping[Estimated, Estimator] = {
    "psd": Estimator("least squares on the linear PSD", _difference, np.square, 1.0, 0.0),
    "log_psd": Estimator(
        "least squares on the log PSD", _log_difference, np.ones_like, VARIANCE_OF_LOG, _TAPER
    ),
    "whittle": Estimator("Whittle likelihood", _deviance, np.ones_like, 1.0, _TAPER),
}


def best_fit(
    residual: Callable[[Array], Array],
    starts: Iterable[Array],
    bounds: tuple[Any, Any],
    **options: float,
) -> Any:
    """The fit with the least sum of squares, as `scipy.optimize.least_squares` returns it.

    ``residual`` is a function of the unknowns, ``options`` are tolerances of the search.
    """
    lower, upper = bounds
    inside = (np.clip(start, lower + _INSIDE, upper - _INSIDE) for start in starts)
    fits = [
        optimize.least_squares(residual, start, "3-point", bounds, **options) for start in inside
    ]
    return min(fits, key=lambda fit: float(fit.cost))


class _Problem(NamedTuple):
    """A kind of ground; its parameters are fitted by logarithms, times over the ground period."""

    kind: type[Ground]
    # bounds of the period, of the parameters of `Fit`, and of the intensity
    bounds: Mapping[str, tuple[float, float]]
    starts: Sequence[tuple[float, ...]]  # of the parameters of `Fit`

    def over_period(self, name: str) -> bool:
        """Whether a parameter is fitted as a multiple of the ground period."""
        return name != "period" and self.kind.units(name) == "s"

    def parameters(self, values: Sequence[Any] | Array) -> dict[str, Any]:
        """Those of the ground, by name: numbers, or arrays of cells."""
        return {
            name: value * values[0] if self.over_period(name) else value
            for name, value in zip(self.bounds, values, strict=True)
        }

    def psd(self, logs: Array, frequency: Array) -> Array:
        """PSD for each row of parameters (trials, frequencies), from one call."""
        ground_filter = self.kind.filter(self.parameters(np.exp(logs).T[..., None]))
        density: Array = ground_filter.intensity * ground_filter.transmission(frequency)
        return density


def fitted_grounds() -> dict[str, type[Ground]]:
    """The kinds of ground that can be fitted to records, by name."""
    return {name: kind for name, kind in GROUNDS.items() if kind.fit is not None}


def ground_of_record(
    record: xr.DataArray,
    model: str | None = None,
    estimator: Estimated | None = None,
    part: TwoNumbers = STRONG_PART,
    frequency_range: TwoNumbers | None = None,
) -> Any:
    """The ground that `fit_ground` fits to a record."""
    kinds = fitted_grounds()
    model = "kanai_tajimi" if model is None else model
    estimator = "psd" if estimator is None else estimator
    OneOf(kinds)("model", model)
    chosen = ESTIMATORS[estimator]
    strong = strong_part(record, *part)
    frequency, density, duration = _periodogram(strong, chosen.taper)
    low, high = _band(frequency, density, duration) if frequency_range is None else frequency_range
    narrowest = 2 * np.pi * _MINIMUM_ORDINATES / duration
    if not (low >= 0 and high <= frequency[-1] and high - low >= narrowest):
        allowed = f"0 to {frequency[-1]:g} rad/s, {narrowest:.3g} rad/s or more apart in this part"
        raise ValueError(
            f"frequency_range = ({low:g}, {high:g}) is out of range; allowed: {allowed}"
        )
    used = (frequency >= low) & (frequency <= high) & (frequency > 0) & (density > 0)
    frequency = frequency[used]
    density = density[used]
    scale = density.mean()
    fit = kinds[model].fit
    periods = (2 * np.pi / high, 2 * np.pi / frequency[0])
    assert fit is not None
    bounds = {"period": periods, **fit.bounds, "intensity": (0.0, np.inf)}
    problem = _Problem(kinds[model], bounds, fit.starts)
    logs = _minimize(frequency, density / scale, problem, chosen)
    errors = _standard_errors(frequency, logs, problem, chosen)
    values = np.exp(logs) * [*np.ones(logs.size - 1), scale]
    resolved = _LINE_WIDTH * values[0] / (2 * np.pi * duration)
    source = (
        f"{chosen.text} of {record.attrs.get('source', 'a record')}, {strong.attrs['energy_part']} "
        f"part ({duration:.4g} s), {low:.3g} to {high:.3g} rad/s; "
        f"standard errors: period {100 * errors[0]:.1f} %, damping {100 * errors[1]:.1f} %, "
        f"intensity {100 * errors[-1]:.1f} %"
    )
    if values[1] < 2 * resolved:
        source += f"; damping not well resolved (a sinusoid of this duration gives {resolved:.2g})"
    ground = problem.kind(**problem.parameters(values.tolist()))
    return replace(ground, source=f"{source}; {OTHER_COMPONENT}", scatter=OTHER_COMPONENT.scatter)


def _minimize(frequency: Array, density: Array, problem: _Problem, estimator: Estimator) -> Array:
    def residual(logs: Array) -> Array:
        return estimator.residual(density, problem.psd(np.atleast_2d(logs), frequency))

    with np.errstate(divide="ignore"):
        bounds = np.log(np.transpose([*problem.bounds.values()]))
    starts = _starts(frequency, density, problem, residual)
    best = best_fit(lambda logs: residual(logs)[0], starts, tuple(bounds))
    if not best.success:
        raise ValueError(
            f"the fit failed ({best.message}); try another estimator or frequency_range"
        )
    for name, value, lower, upper in zip(problem.bounds, best.x, *bounds, strict=True):
        if min(value - lower, upper - value) < _ON_BOUND:
            which = f"the fit ends on a bound of {name}, which the record does not define"
            raise ValueError(f"{which}; try another estimator, part or WhiteNoise")
    logs: Array = best.x
    return logs


def _starts(
    frequency: Array,
    density: Array,
    problem: _Problem,
    residual: Callable[[Array], Array],
) -> list[Array]:
    """Starting values: for each start of the other unknowns, the best period of a grid.

    The intensity is that with the energy of the record.
    """
    periods = np.geomspace(*problem.bounds["period"], _START_PERIODS + 2)[1:-1]
    peak = 2 * np.pi / frequency[np.argmax(density)]
    periods = np.append(periods, np.clip(peak, periods[0], periods[-1]))
    starts = []
    for others in problem.starts:
        logs = np.log([[period, *others, 1.0] for period in periods])
        logs[:, -1] = np.log(density.sum() / problem.psd(logs, frequency).sum(axis=1))
        starts.append(logs[np.argmin(np.sum(residual(logs) ** 2, axis=1))])
    return starts


def _standard_errors(
    frequency: Array, logs: Array, problem: _Problem, estimator: Estimator
) -> Array:
    """Relative standard errors of parameters [-], by the sandwich estimator of their covariance."""
    shifts = _PARAMETER_STEP * np.eye(logs.size)
    up = problem.psd(logs + shifts, frequency)
    down = problem.psd(logs - shifts, frequency)
    slopes = np.log(up / down) / (2 * _PARAMETER_STEP)
    weight = estimator.weight(problem.psd(logs[None], frequency)[0])
    bread = np.linalg.pinv((weight * slopes) @ slopes.T)
    filling = _PADDING * estimator.variance * (weight**2 * slopes) @ slopes.T
    errors: Array = np.sqrt(np.diag(bread @ filling @ bread))
    return errors


def _periodogram(part: xr.DataArray, taper: float) -> tuple[Array, Array, float]:
    """Frequencies [rad/s] from 0 to Nyquist, two-sided PSD per rad/s, and the duration [s]."""
    from scipy import signal  # which takes long to load, with all of scipy.stats

    values, dt = checked_record(part)
    if not np.ptp(values):
        raise ValueError(f"record is {values[0]:g} throughout the part used; allowed: some motion")
    length = fft.next_fast_len(_PADDING * values.size, real=True)
    window = ("tukey", taper)
    hertz, density = signal.periodogram(values, 1 / dt, window, length, return_onesided=False)
    half = length // 2 + 1
    return 2 * np.pi * np.abs(hertz[:half]), density[:half] / (2 * np.pi), values.size * dt


def _band(frequency: Array, density: Array, duration: float) -> tuple[float, float]:
    """Default frequency range of a fit [rad/s], lowest and highest."""
    energy = np.cumsum(density)
    low, high = frequency[np.searchsorted(energy, np.multiply(_ENERGY, energy[-1]))]
    return max(2 * np.pi / duration, float(low)), float(high)
