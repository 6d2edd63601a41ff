"""From separations at several intensities to annual frequencies: sums over motions.

The motions are the same at all intensities. Between two of them the logarithm of a motion's separation
is linear in the logarithm of the intensity, which is exact for linear structures; below the lowest it
goes on as that of linear structures.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import scipy.optimize
from scipy.special import log_ndtr

from stochlin.kernels.basics.arrays import Array

TINY = 1e-12  # [m]: less than this is no separation
FITTED, TOO_FEW_POUND, ALL_POUND, TOO_FEW_INTENSITIES, NOT_SIMULATED = range(5)
REACH, POINTS = 24.0, 6001  # of the integral over a lognormal fragility, in standard deviations


class Motions(NamedTuple):
    """What the structures do in the same motions at rising intensities."""

    intensity: Array  # (n,)
    separation: Array  # (paths, n) [m]
    power: float = 1.0  # of the intensity, with which linear structures go: 0.5 of S0

    def crossings(self, gap: float) -> tuple[Array, Array]:
        """Between which intensities each motion makes them pound, interval by interval (paths, n + 1).

        The first interval ends at the lowest intensity, the last one begins at the highest and has no
        end. Where nothing pounds both ends are the same.
        """
        x = np.log(self.intensity)
        beyond = np.log(np.maximum(self.separation, TINY)) - np.log(gap)
        left, right = beyond[:, :-1], beyond[:, 1:]
        with np.errstate(divide="ignore", invalid="ignore"):
            at = x[:-1] + (x[1:] - x[:-1]) * np.clip(left / (left - right), 0, 1)
        begin = np.where(left > 0, x[:-1], np.where(right > 0, at, x[1:]))
        end = np.where(right > 0, x[1:], np.where(left > 0, at, x[1:]))
        first, last = beyond[:, :1], beyond[:, -1:]
        low = np.where(first > 0, x[0] - first / self.power, x[0]), np.full_like(first, x[0])
        high = np.full_like(last, x[-1]), np.where(last > 0, np.inf, x[-1])
        whole = (np.hstack(parts) for parts in zip(low, (begin, end), high, strict=True))
        begin, end = whole
        return np.exp(begin), np.exp(end)


def rates(motions: Motions, gap: float, frequency: Callable[[Array], Array]) -> Array:
    """Annual frequency of pounding (paths, n + 1) if all shaking had the form of this motion.

    Its mean over the motions is the mean annual frequency, by interval; ``frequency`` is how often an
    intensity is exceeded.
    """
    begin, end = motions.crossings(gap)
    exceeded = [np.where(np.isfinite(at), frequency(np.where(np.isfinite(at), at, 1.0)), 0.0)
                for at in (begin, end)]  # fmt: skip
    return np.maximum(exceeded[0] - exceeded[1], 0.0)


class Fragility(NamedTuple):
    """Lognormal: median intensity at which they pound, and standard deviation of its logarithm."""

    median: float
    dispersion: float
    median_error: float
    dispersion_error: float
    status: int = FITTED

    @classmethod
    def none(cls, status: int) -> Fragility:
        """One that cannot be fitted, and why."""
        return cls(np.nan, np.nan, np.nan, np.nan, status)

    def named(self) -> dict[str, Any]:
        """As the variables of a dataset are called."""
        told = {
            name.replace("_error", "_standard_error"): value for name, value in self._asdict().items()
        }
        return {f"fragility_{name}": value for name, value in told.items()}


def lognormal_fragility(motions: Motions, gap: float) -> Fragility:
    """By maximum likelihood from the intensity at which each motion first makes them pound.

    Of a motion that never does it is known that it takes more than the highest. NaN, with the reason in
    ``status``, where fewer than two motions do, or all of them at the lowest intensity already.
    """
    if motions.intensity.size < 2:
        return Fragility.none(TOO_FEW_INTENSITIES)
    if (motions.separation[:, 0] > gap).all():
        return Fragility.none(ALL_POUND)
    begin, end = motions.crossings(gap)
    first = np.where(end > begin, begin, np.inf).min(axis=1)
    seen = np.isfinite(first)
    known = np.log(first[seen])
    if known.size < 2 or np.ptp(known) == 0:
        return Fragility.none(TOO_FEW_POUND)
    top, never = np.log(motions.intensity[-1]), int((~seen).sum())

    def surprise(parameters: Array) -> float:
        mean, log_b = parameters
        z, most = (known - mean) / np.exp(log_b), (mean - top) / np.exp(log_b)
        return float(0.5 * z @ z + known.size * log_b - never * log_ndtr(most))

    start = np.array([known.mean(), np.log(known.std())])
    if not never:  # the closed form
        mean, log_b = start
        b = float(np.exp(log_b))
        errors = b / np.sqrt(known.size), b / np.sqrt(2 * known.size)
    else:
        found = scipy.optimize.minimize(surprise, start, method="BFGS", options={"gtol": 1e-6})
        mean, log_b = found.x
        b = float(np.exp(log_b))
        spread = np.sqrt(np.diag(_inverse_curvature(surprise, found.x)))
        errors = float(spread[0]), float(b * spread[1])
    median = float(np.exp(mean))
    return Fragility(median, b, median * float(errors[0]), float(errors[1]))


def _inverse_curvature(function: Callable[[Array], float], at: Array, step: float = 1e-3) -> Array:
    """Covariance of estimates: the inverse of the second derivatives of the negative log likelihood."""
    n = at.size
    second = np.empty((n, n))
    for i in range(n):
        for j in range(n):
            both = [
                function(at + step * (si * np.eye(n)[i] + sj * np.eye(n)[j]))
                for si, sj in ((1, 1), (1, -1), (-1, 1), (-1, -1))
            ]
            second[i, j] = (both[0] - both[1] - both[2] + both[3]) / (4 * step**2)
    inverse: Array = np.linalg.inv(second)
    return inverse


def lognormal_rate(fragility: Fragility, frequency: Callable[[Array], Array]) -> float:
    """Mean annual frequency: the frequency in the mean over a lognormal intensity at which they pound.

    By the trapezoidal rule, which for such integrands converges faster than any power of its step.
    """
    z = np.linspace(-REACH, REACH, POINTS)
    weight = np.exp(-0.5 * z**2) / np.sqrt(2 * np.pi) * (z[1] - z[0])
    return float(weight @ frequency(fragility.median * np.exp(fragility.dispersion * z)))
