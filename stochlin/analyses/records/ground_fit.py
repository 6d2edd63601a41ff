"""Fit of a ground to a strong-motion record."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import xarray as xr
from scipy import optimize

from stochlin.analyses.records.records import strong_part
from stochlin.analyses.records.spectra import (
    ESTIMATORS,
    STRONG_PART,
    Estimator,
    Part,
    Vector,
    described,
    energy_band,
    periodogram,
)
from stochlin.analyses.tables.checks import check_two_numbers
from stochlin.messages import brief
from stochlin.models.grounds import GROUNDS, Ground
from stochlin.models.parameters import Parameter

Matrix = npt.NDArray[np.float64]
# Ordinates per independent one: sums over them are then integrals over frequency.
_PADDING = 4
_MINIMUM_ORDINATES = 8
# Half width at half height [rad/s] of the line that a sinusoid of 1 s makes in a periodogram.
_LINE_WIDTH = 2.78
_START_PERIODS = 16
_STEP, _ON_BOUND = 1e-4, 1e-3  # in the logarithm of a parameter


class _Unknown(NamedTuple):
    """A parameter that is sought by its logarithm, between bounds."""

    name: str
    lower: float
    upper: float

    over_period: bool = False  # a time, sought over the ground's period

    @property
    def shown(self) -> str:
        return f"{self.name} / period" if self.over_period else self.name


class _Problem(NamedTuple):
    """What is sought, of which kind of ground, from where."""

    kind: type[Ground]
    unknowns: tuple[_Unknown, ...]  # period, those of `Fit`, intensity
    starts: Sequence[tuple[float, ...]]

    @classmethod
    def of(cls, kind: type[Ground], shortest: float, longest: float) -> _Problem:
        assert kind.fit is not None
        own = (
            _Unknown(name, *bounds, kind.units(name) == "s") for name, bounds in kind.fit.bounds.items()
        )
        period, intensity = _Unknown("period", shortest, longest), _Unknown("intensity", 0.0, np.inf)
        return cls(kind, (period, *own, intensity), kind.fit.starts)

    def ground(self, values: Sequence[Parameter], source: str = "") -> Any:
        given = {
            unknown.name: np.multiply(value, values[0]) if unknown.over_period else value
            for unknown, value in zip(self.unknowns, values, strict=True)
        }
        return self.kind(**given, source=source)

    def psd(self, logs: Matrix, frequency: Vector) -> Matrix:
        """PSD of each row of parameters, by one call for all of them."""
        columns = [xr.DataArray(column, dims="trial") for column in np.exp(logs).T]
        axis = xr.DataArray(frequency, dims="frequency")
        density: Matrix = self.ground(columns).psd(axis).transpose("trial", "frequency").to_numpy()
        return density


def fitted_grounds() -> dict[str, type[Ground]]:
    """The kinds of ground that can be fitted, by name."""
    return {name: kind for name, kind in GROUNDS.items() if kind.fit is not None}


def fit_ground(
    record: xr.DataArray,
    model: str = "kanai_tajimi",
    estimator: str = "psd",
    *,
    part: Part = STRONG_PART,
    frequency_range: tuple[float, float] | None = None,
) -> Any:
    """Fit a ground to the power spectral density of a record.

    The model is compared with the raw periodogram of the part without its mean: there is no
    smoothing bandwidth to choose, and the peak of a narrow-band ground keeps its height. The part
    is padded with zeros to four times its length, so that the result does not depend on where the
    Fourier frequencies fall; with ``estimator="psd"`` this is the least-squares fit of the sample
    autocovariance at all lags (Parseval). The two other estimators also see the frequencies at
    which the ground is weak, where leakage from the peak counts: for them a tenth of the part is
    under a cosine taper. The search starts from a grid of periods and dampings.

    Parameters
    ----------
    record : xarray.DataArray
        Ground acceleration [m/s^2] with the dimension ``time`` [s], as `read_record` gives it.
    model : str
        The kind of ground: ``"kanai_tajimi"``, ``"clough_penzien"``, or an extension that can be fitted.
    estimator : {"psd", "log_psd", "whittle"}
        What the fit minimizes: the squared difference of the spectra, which follows the peak; the
        squared difference of their logarithms, in which each frequency of the range counts alike;
        or the Whittle likelihood, the most accurate one if the model is true. On a record that
        the model does not describe they differ widely: look at it with `fit_spectra`.
    part : tuple of two floats
        Fractions of the cumulative energy between which the record is used, see `strong_part`;
        (0, 1) is all of it.
    frequency_range : tuple of two floats, optional
        Lowest and highest circular frequency used [rad/s]. By default those below which the part
        has .01 % (and one cycle at least) and 99 % of its energy. They matter little to ``"psd"``
        and much to the other two.

    Returns
    -------
    KanaiTajimi, CloughPenzien or an extension
        With ``intensity`` [m^2/s^3], the two-sided PSD per rad/s of the white noise. ``source``
        names the estimator, the record, the part and the range, and gives relative standard errors.

    Raises
    ------
    TypeError, ValueError
        If the record is not one, an option is unknown, the range holds too few frequencies, or
        the fit fails or ends on a bound, as it does where the record does not define a parameter.

    Notes
    -----
    The standard errors are those of a stationary Gaussian process of the fitted spectrum [1]_,
    which a part of a record is only roughly. Short records of narrow-band ground say little: in 200
    simulated ones of 71 s with ``wg=3.09``, ``xig=.054`` the damping found over the true one was .21
    to 2.0 with ``"psd"`` (median .5) and .63 to 1.8 with ``"whittle"`` (median 1.1), in nine cases of
    ten. A periodogram of duration d cannot tell a damping ratio below about ``2.8/(wg d)`` from a
    sinusoid; ``source`` says so where the result is less than twice that.

    References
    ----------
    .. [1] P. Whittle, "Estimation and information in stationary time series", Arkiv foer
       Matematik 2, 423-434, 1953.

    Examples
    --------
    >>> import numpy as np, xarray as xr
    >>> import stochlin as sl
    >>> time, step = 0.02 * np.arange(20000), 2 * np.pi / 400
    >>> psd = sl.KanaiTajimi(period=1.0, damping=0.3, intensity=0.01).psd(step * np.arange(10001))
    >>> phase = np.random.default_rng(1).uniform(0, 2 * np.pi, psd.size)
    >>> spectrum = np.sqrt(psd.values * step) * np.exp(1j * phase)
    >>> history = np.fft.irfft(spectrum) * time.size
    >>> record = xr.DataArray(history, dims="time", coords={"time": time})
    >>> ground = sl.fit_ground(record, part=(0, 1))
    >>> round(ground.period, 2), round(ground.damping, 1), round(ground.intensity, 3)
    (1.0, 0.3, 0.01)
    """
    kinds = fitted_grounds()
    _check_name("model", model, kinds)
    _check_name("estimator", estimator, ESTIMATORS)
    chosen = ESTIMATORS[estimator]
    check_two_numbers("part", part)
    if frequency_range is not None:
        check_two_numbers("frequency_range", frequency_range)
    strong = strong_part(record, *part)
    frequency, density, duration = periodogram(strong, _PADDING, chosen.taper)
    low, high = energy_band(frequency, density, duration) if frequency_range is None else frequency_range
    narrowest = 2 * np.pi * _MINIMUM_ORDINATES / duration
    if not (low >= 0 and high <= frequency[-1] and high - low >= narrowest):
        raise ValueError(
            f"frequency_range = ({low:g}, {high:g}) is out of range; allowed: 0 <= low < high <= "
            f"{frequency[-1]:g} rad/s, {narrowest:.3g} rad/s or more apart in a part of {duration:.4g} s"
        )
    used = (frequency >= low) & (frequency <= high) & (frequency > 0) & (density > 0)
    frequency, density = frequency[used], density[used]
    scale = density.mean()
    problem = _Problem.of(kinds[model], 2 * np.pi / high, 2 * np.pi / frequency[0])
    logs = _minimize(frequency, density / scale, problem, chosen)
    errors = _standard_errors(frequency, logs, problem, chosen)
    values = np.exp(logs) * [*np.ones(logs.size - 1), scale]
    resolved = _LINE_WIDTH * values[0] / (2 * np.pi * duration)
    source = (
        f"{chosen.text} of {described(record, part, duration)}, {low:.3g} to {high:.3g} rad/s; "
        f"standard errors: period {100 * errors[0]:.1f} %, damping {100 * errors[1]:.1f} %, "
        f"intensity {100 * errors[-1]:.1f} %"
    )
    if values[1] < 2 * resolved:
        source += f"; damping not well resolved (a sinusoid of this duration gives {resolved:.2g})"
    return problem.ground(values.tolist(), source)


def _check_name(parameter: str, value: str, allowed: dict[str, Any]) -> None:
    if not isinstance(value, str) or value not in allowed:
        raise ValueError(f"{parameter} = {brief(value)} is unknown; allowed: {', '.join(allowed)}")


def _minimize(frequency: Vector, density: Vector, problem: _Problem, estimator: Estimator) -> Vector:
    def residual(logs: Vector) -> Matrix:
        return estimator.residual(density, problem.psd(np.atleast_2d(logs), frequency))

    def slope(logs: Vector) -> Matrix:
        shifts = _STEP * np.eye(logs.size)
        return (residual(logs + shifts) - residual(logs - shifts)).T / (2 * _STEP)

    with np.errstate(divide="ignore"):
        bounds = np.log([[u.lower for u in problem.unknowns], [u.upper for u in problem.unknowns]])
    found = [
        optimize.least_squares(lambda logs: residual(logs)[0], start, slope, bounds)
        for start in _starts(frequency, density, problem, residual)
    ]
    best = min(found, key=lambda fit: float(fit.cost))
    if not best.success:
        raise ValueError(f"the fit failed ({best.message}); try another estimator or frequency_range")
    for unknown, value, lower, upper in zip(problem.unknowns, best.x, *bounds, strict=True):
        if min(value - lower, upper - value) < _ON_BOUND:
            raise ValueError(
                f"the fit ends on a bound, {unknown.shown} = {np.exp(value):.3g}; allowed: between "
                f"{unknown.lower:.3g} and {unknown.upper:.3g}. The record does not define it: try "
                "another estimator, part or frequency_range, or a simpler model (WhiteNoise at last)"
            )
    logs: Vector = best.x
    return logs


def _starts(
    frequency: Vector,
    density: Vector,
    problem: _Problem,
    residual: Callable[[Vector], Matrix],
) -> list[Vector]:
    """The best period of a grid for each start of the others, at the record's energy."""
    period = problem.unknowns[0]
    periods = np.geomspace(period.lower, period.upper, _START_PERIODS + 2)[1:-1]
    peak = 2 * np.pi / frequency[np.argmax(density)]
    periods = np.append(periods, np.clip(peak, periods[0], periods[-1]))
    starts = []
    for others in problem.starts:
        logs = np.log([[each, *others, 1.0] for each in periods])
        logs[:, -1] = np.log(density.sum() / problem.psd(logs, frequency).sum(axis=1))
        starts.append(logs[np.argmin(np.sum(residual(logs) ** 2, axis=1))])
    return starts


def _standard_errors(frequency: Vector, logs: Vector, problem: _Problem, estimator: Estimator) -> Vector:
    """Relative standard errors of the parameters, by the sandwich of the estimating equations."""
    shifts = _STEP * np.eye(logs.size)
    up, down = (problem.psd(logs + sign * shifts, frequency) for sign in (1, -1))
    slopes = np.log(up / down) / (2 * _STEP)
    weight = estimator.weight(problem.psd(logs[None], frequency)[0])
    bread = np.linalg.pinv((weight * slopes) @ slopes.T)
    filling = _PADDING * estimator.variance * (weight**2 * slopes) @ slopes.T
    errors: Vector = np.sqrt(np.diag(bread @ filling @ bread))
    return errors
