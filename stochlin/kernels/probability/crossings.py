"""Crossings of a level by a Gaussian process that changes with time, and the time to the first.

``d`` has zero mean, variance ``s^2``, a rate ``d'`` of variance ``sv^2``, and ``kappa = corr(d, d')``;
``h = g/s``. Both rates below are Rice's, ``p(level) E[rate^+]``, with a Gaussian rate at the level:

* of ``d`` through ``g``: density ``phi(h)/s``; the rate has mean ``kappa sv h`` and standard deviation
  ``sqrt(1 - kappa^2) sv``;
* of the envelope ``R`` of ``d`` and its companion ``c`` in quadrature: density ``(h/s) e^(-h^2/2)``;
  since ``R' = (d d' + c c')/R``, its rate has the same mean, and standard deviation
  ``sqrt(1 - kappa^2) delta sv``, with the bandwidth ``delta^2 = 1 - l1^2/[(1 - kappa^2) l0 l2]``.

At ``kappa = 0`` their ratio is ``sqrt(2 pi) delta h``, Vanmarcke's (1975, J. Appl. Mech. 42). His
empirical ``delta^1.2`` was fitted to single oscillators; for the difference of two it is unsafe by up
to 0.19 in the probability, ``delta`` itself by 0.05: so that is what stands here.
"""

from __future__ import annotations

import numpy as np
from scipy.special import erfcx, ndtr

from stochlin.kernels.basics.arrays import Array

SQRT_2PI = np.sqrt(2 * np.pi)


def positive_part(mean: Array, deviation: Array) -> Array:
    """``E[x^+]`` of a Gaussian ``x``; a deviation of 0 is exact, a negative mean does not cancel."""
    still = deviation <= 0
    t = mean / np.where(still, 1.0, deviation)
    with np.errstate(under="ignore", over="ignore"):
        tail = np.exp(-0.5 * t * t) * np.maximum(
            1 / SQRT_2PI + 0.5 * t * erfcx(np.maximum(-t, -25.0) / np.sqrt(2)), 0
        )
        body = np.exp(-0.5 * t * t) / SQRT_2PI + t * ndtr(t)
    return np.where(still, np.maximum(mean, 0), deviation * np.where(t > 0, body, tail))


def exceeding(gap: Array, variance: Array) -> Array:
    """``P(d > g) = 1 - Phi(h)``; 0 where nothing moves."""
    with np.errstate(divide="ignore"):
        return ndtr(-gap / np.sqrt(np.maximum(variance, 0)))


def hazards(gap: Array, d_d: Array, d_v: Array, v_v: Array, bandwidth: Array) -> tuple[Array, Array]:
    """Rates [1/s] at which no pounding ends: by Poisson, and corrected for clumps as by Vanmarcke.

    That is ``nu``, the up-crossing rate, and ``nu [1 - exp(-nu_R/nu)]/(1 - e^(-h^2/2))``: of the clumps
    that the envelope's crossings start, those that hold a crossing of ``d``, a rate while below. The
    second moments of ``d`` and ``d'`` broadcast with the gap [m].
    """
    moving = (d_d > 0) & (v_v > 0)
    s, sv = np.sqrt(np.where(moving, d_d, 1.0)), np.sqrt(np.where(moving, v_v, 1.0))
    kappa = np.clip(np.where(moving, d_v, 0.0) / (s * sv), -1, 1)
    h = np.where(moving, gap / s, np.inf)
    finite = np.where(moving, h, 0.0)
    spread = np.sqrt((1 - kappa) * (1 + kappa))
    with np.errstate(all="ignore"):
        below = np.exp(-0.5 * h * h)
        rate = positive_part(kappa * finite, spread)
        envelope = SQRT_2PI * finite * positive_part(kappa * finite, spread * bandwidth)
        poisson = np.where(moving, sv / s * below / SQRT_2PI * rate, 0.0)
        clumps = np.where(rate > 0, -np.expm1(-envelope / np.where(rate > 0, rate, 1.0)), 0.0)
        first = poisson * clumps / -np.expm1(-0.5 * h * h)
    return poisson, np.where(moving, first, 0.0)


def accumulated(rate: Array, times: Array) -> Array:
    """Integral of a rate (times, n) from the first time on, by the trapezoidal rule, (times, n)."""
    steps = 0.5 * np.diff(times)[:, None] * (rate[1:] + rate[:-1])
    return np.concatenate([np.zeros_like(rate[:1]), np.cumsum(steps, axis=0)])
