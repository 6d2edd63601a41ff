"""Fit of a ground to a strong-motion record."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Annotated, Any, NamedTuple

import numpy as np
import numpy.typing as npt
import xarray as xr

from stochlin.applications.records.records import strong_part
from stochlin.applications.records.spectra import (
    ESTIMATORS,
    STRONG_PART,
    Estimator,
    Part,
    Vector,
    best_fit,
    described,
    energy_band,
    periodogram,
)
from stochlin.models.arguments import OneOf, TwoNumbers, checked
from stochlin.models.grounds import GROUNDS, Ground

Matrix = npt.NDArray[np.float64]
# Ordinates of the padded periodogram per independent one, so that sums approximate integrals.
_PADDING = 4
_MINIMUM_ORDINATES = 8
# Half width at half height [rad/s] of the spectral line of a sinusoid of 1 s in a periodogram.
_LINE_WIDTH = 2.78
_START_PERIODS = 16
_STEP, _ON_BOUND = 1e-4, 1e-3  # in the logarithm of a parameter


class _Problem(NamedTuple):
    """A kind of ground; its parameters are fitted by their logarithms, times over the ground period."""

    kind: type[Ground]
    bounds: Mapping[str, tuple[float, float]]  # of the period, the parameters of `Fit`, the intensity
    starts: Sequence[tuple[float, ...]]  # of the parameters of `Fit`

    def over_period(self, name: str) -> bool:
        """Whether a parameter is fitted as a multiple of the ground period."""
        return name != "period" and self.kind.units(name) == "s"

    def parameters(self, values: Sequence[Any] | Matrix) -> dict[str, Any]:
        """Those of the ground, by name: numbers, or arrays of cells."""
        return {
            name: value * values[0] if self.over_period(name) else value
            for name, value in zip(self.bounds, values, strict=True)
        }

    def psd(self, logs: Matrix, frequency: Vector) -> Matrix:
        """PSD for each row of parameters (trials, frequencies), from one call."""
        ground_filter = self.kind.filter(self.parameters(np.exp(logs).T[..., None]))
        density: Matrix = ground_filter.intensity * ground_filter.transmission(frequency)
        return density


def fitted_grounds() -> dict[str, type[Ground]]:
    """The kinds of ground that can be fitted to records, by name."""
    return {name: kind for name, kind in GROUNDS.items() if kind.fit is not None}


@checked
def ground_of_record(
    record: xr.DataArray,
    model: str = "kanai_tajimi",
    estimator: Annotated[str, OneOf(ESTIMATORS)] = "psd",
    *,
    part: Part = STRONG_PART,
    frequency_range: TwoNumbers | None = None,
) -> Any:
    """The ground that `fit_ground` fits to a record."""
    kinds = fitted_grounds()
    OneOf(kinds)("model", model)
    chosen = ESTIMATORS[estimator]
    strong = strong_part(record, *part)
    frequency, density, duration = periodogram(strong, _PADDING, chosen.taper)
    low, high = energy_band(frequency, density, duration) if frequency_range is None else frequency_range
    narrowest = 2 * np.pi * _MINIMUM_ORDINATES / duration
    if not (low >= 0 and high <= frequency[-1] and high - low >= narrowest):
        allowed = f"0 to {frequency[-1]:g} rad/s, {narrowest:.3g} rad/s or more apart in this part"
        raise ValueError(f"frequency_range = ({low:g}, {high:g}) is out of range; allowed: {allowed}")
    used = (frequency >= low) & (frequency <= high) & (frequency > 0) & (density > 0)
    frequency, density = frequency[used], density[used]
    scale = density.mean()
    fit, periods = kinds[model].fit, (2 * np.pi / high, 2 * np.pi / frequency[0])
    assert fit is not None
    bounds = {"period": periods, **fit.bounds, "intensity": (0.0, np.inf)}
    problem = _Problem(kinds[model], bounds, fit.starts)
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
    return problem.kind(**problem.parameters(values.tolist()), source=source)


def _minimize(frequency: Vector, density: Vector, problem: _Problem, estimator: Estimator) -> Vector:
    def residual(logs: Vector) -> Matrix:
        return estimator.residual(density, problem.psd(np.atleast_2d(logs), frequency))

    with np.errstate(divide="ignore"):
        bounds = np.log(np.transpose([*problem.bounds.values()]))
    starts = _starts(frequency, density, problem, residual)
    best = best_fit(lambda logs: residual(logs)[0], starts, tuple(bounds))
    if not best.success:
        raise ValueError(f"the fit failed ({best.message}); try another estimator or frequency_range")
    for name, value, lower, upper in zip(problem.bounds, best.x, *bounds, strict=True):
        if min(value - lower, upper - value) < _ON_BOUND:
            shown = f"{name} / period" if problem.over_period(name) else name
            which = f"{shown} = {np.exp(value):.3g}, which the record does not define"
            raise ValueError(
                f"the fit ends on a bound, {which}; try another estimator, part or WhiteNoise"
            )
    logs: Vector = best.x
    return logs


def _starts(
    frequency: Vector,
    density: Vector,
    problem: _Problem,
    residual: Callable[[Vector], Matrix],
) -> list[Vector]:
    """Starting values: for each start of the other unknowns, the best period of a grid.

    The intensity is that with the energy of the record.
    """
    periods = np.geomspace(*problem.bounds["period"], _START_PERIODS + 2)[1:-1]
    peak = 2 * np.pi / frequency[np.argmax(density)]
    periods = np.append(periods, np.clip(peak, periods[0], periods[-1]))
    starts = []
    for others in problem.starts:
        logs = np.log([[each, *others, 1.0] for each in periods])
        logs[:, -1] = np.log(density.sum() / problem.psd(logs, frequency).sum(axis=1))
        starts.append(logs[np.argmin(np.sum(residual(logs) ** 2, axis=1))])
    return starts


def _standard_errors(frequency: Vector, logs: Vector, problem: _Problem, estimator: Estimator) -> Vector:
    """Relative standard errors of the parameters [-], by the sandwich estimator of their covariance."""
    shifts = _STEP * np.eye(logs.size)
    up, down = (problem.psd(logs + sign * shifts, frequency) for sign in (1, -1))
    slopes = np.log(up / down) / (2 * _STEP)
    weight = estimator.weight(problem.psd(logs[None], frequency)[0])
    bread = np.linalg.pinv((weight * slopes) @ slopes.T)
    filling = _PADDING * estimator.variance * (weight**2 * slopes) @ slopes.T
    errors: Vector = np.sqrt(np.diag(bread @ filling @ bread))
    return errors
