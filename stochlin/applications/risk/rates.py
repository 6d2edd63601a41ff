"""Annual pounding frequencies and fragilities from separations in the same motions, over intensity.

Between two intensities, the logarithm of the separation in a motion is interpolated linearly in the
logarithm of the intensity, which is exact for linear structures. Below the lowest intensity it is
extrapolated with the slope of linear structures.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np
import scipy.optimize
import xarray as xr
from scipy.special import log_ndtr

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress, part_of
from stochlin.models.uncertain import applied
from stochlin.solver.simulation.prepared import PreparedStructures
from stochlin.solver.simulation.statistics import pair_separation

SMALLEST_SEPARATION = 1e-12  # smallest separation [m], in place of zero in logarithms
FRAGILITY_FITTED, TOO_FEW_POUND, ALL_POUND, TOO_FEW_INTENSITIES, NOT_SIMULATED = range(5)


class Fragility(NamedTuple):
    """A lognormal distribution of the intensity of pounding, or why there is none."""

    median: float = np.nan
    dispersion: float = np.nan  # standard deviation of the logarithm
    median_standard_error: float = np.nan
    dispersion_standard_error: float = np.nan
    status: int = FRAGILITY_FITTED


class SeparationsByIntensity(NamedTuple):
    """Separations of the structures in the same motions at increasing intensities."""

    intensity: Array  # (n,)
    separation: Array  # (paths, n) [m]
    # exponent of the intensity in the separation of linear structures; 0.5 for S0
    power: float = 1.0

    def every_other(self) -> SeparationsByIntensity:
        """Those at every other intensity, with both ends of an odd number."""
        return self._replace(intensity=self.intensity[::2], separation=self.separation[:, ::2])

    def joined(self, other: SeparationsByIntensity) -> SeparationsByIntensity:
        """These and those of the same motions at other intensities, in increasing order."""
        intensity = np.append(self.intensity, other.intensity)
        order = np.argsort(intensity)
        separation = np.hstack([self.separation, other.separation])[:, order]
        return self._replace(intensity=intensity[order], separation=separation)

    def crossings(self, gap: float) -> tuple[Array, Array]:
        """Lower and upper intensity of pounding for each motion and interval (paths, n + 1).

        The first interval is below the lowest simulated intensity, the last one above the highest.
        Without pounding in an interval, both intensities are equal.
        """
        x = np.broadcast_to(np.log(self.intensity), self.separation.shape)
        beyond = np.log(np.maximum(self.separation, SMALLEST_SEPARATION)) - np.log(gap)
        first = beyond[:, :1]  # from where the gap is reached, below the lowest intensity
        lowest = x[:, :1] - np.maximum(first, 0) / self.power
        x = np.hstack([lowest, x, np.full_like(first, np.inf)])
        beyond = np.hstack([np.minimum(first, 0), beyond, beyond[:, -1:]])
        left = beyond[:, :-1]
        right = beyond[:, 1:]
        low = x[:, :-1]
        high = x[:, 1:]
        with np.errstate(divide="ignore", invalid="ignore"):
            crossing = low + (high - low) * np.clip(left / (left - right), 0, 1)
        begin = np.where(left > 0, low, np.where(right > 0, crossing, high))
        end = np.where(right > 0, high, np.where(left > 0, crossing, high))
        return np.exp(begin), np.exp(end)


def simulated_separations(
    prepared: PreparedStructures,
    intensity: Array,
    factors: Array,
    power: float,
    paths: int,
    progress: Progress | None,
) -> SeparationsByIntensity:
    """Separations in the same motions at several intensities.

    At each ``intensity`` the ``S0`` of the ground is multiplied by one of the ``factors``.
    """
    count = intensity.size
    columns = []
    for n, factor in enumerate(factors):
        stronger = applied(partial(times_intensity, factor=factor), prepared.ground)
        part = part_of(progress, n / count, (n + 1) / count)
        columns.append(pair_separation(prepared.simulated(paths, progress=part, ground=stronger)))
    return SeparationsByIntensity(intensity, np.stack(columns, axis=1), power)


def times_intensity(ground: Any, factor: float) -> Any:
    """The ground with its intensity multiplied by a factor."""
    return replace(ground, intensity=ground.intensity * factor)


def lognormal_fragility(motions: SeparationsByIntensity, gap: float) -> Fragility:
    """The fragility by maximum likelihood from the lowest intensity of pounding in each motion.

    For a motion without pounding, this intensity is known to be above the highest one. The numbers
    are NaN, with the reason as their status, if fewer than two motions have pounding, all of them
    already at the lowest intensity, or a structure falls.
    """
    if not np.isfinite(motions.separation).all() or not 0 < gap < np.inf:
        return Fragility(status=NOT_SIMULATED)
    if motions.intensity.size < 2:
        return Fragility(status=TOO_FEW_INTENSITIES)
    if (motions.separation[:, 0] > gap).all():
        return Fragility(status=ALL_POUND)
    begin, end = motions.crossings(gap)
    lowest = np.where(end > begin, begin, np.inf).min(axis=1)
    observed = np.isfinite(lowest)
    logs = np.log(lowest[observed])
    if logs.size < 2 or np.ptp(logs) == 0:
        return Fragility(status=TOO_FEW_POUND)
    top = np.log(motions.intensity[-1])
    unobserved = int((~observed).sum())

    def cost(parameters: Array) -> float:
        """Negative logarithm of the likelihood, without its constant term."""
        mean, log_b = parameters
        z = (logs - mean) / np.exp(log_b)
        z_of_top = (mean - top) / np.exp(log_b)
        return float(0.5 * z @ z + logs.size * log_b - unobserved * log_ndtr(z_of_top))

    mean = logs.mean()
    log_b = np.log(logs.std())
    if unobserved:  # else these are the maximum
        guess = [mean, log_b]
        options = {"gtol": 1e-6}
        solution = scipy.optimize.minimize(cost, guess, method="BFGS", options=options)
        mean, log_b = solution.x
    median = float(np.exp(mean))
    b = float(np.exp(log_b))
    z = (logs - mean) / b
    z_of_top = (mean - top) / b
    hazard = np.exp(-0.5 * z_of_top**2 - log_ndtr(z_of_top)) / np.sqrt(2 * np.pi)
    tail = unobserved * hazard
    slope_of_tail = unobserved * hazard * (z_of_top + hazard)
    mixed = (2 * z.sum() + tail - z_of_top * slope_of_tail) / b
    curvature = [
        [(logs.size + slope_of_tail) / b**2, mixed],
        [mixed, 2 * z @ z + z_of_top * (z_of_top * slope_of_tail - tail)],
    ]
    error_of_mean, error_of_log_b = np.sqrt(np.diag(np.linalg.inv(curvature)))
    return Fragility(median, b, float(median * error_of_mean), float(b * error_of_log_b))


def range_of_rate(risk: xr.Dataset, left_out: float) -> tuple[float, float]:
    """The intensities between which the rate arises, but for a share ``left_out`` at either end."""
    edges = np.append(risk.risk_from_intensity.values, np.inf)
    shares = np.cumsum(risk.risk_annual_rate_by_intensity / risk.risk_annual_rate)
    above = 1 - np.append(0.0, shares)
    low = edges[np.flatnonzero(above >= 1 - left_out)[-1]]
    return float(low), float(edges[np.flatnonzero(above <= left_out)[0]])
