"""Crossings of a level by a nonstationary Gaussian process, and the rate of first crossings.

The process ``d`` (the relative displacement) has zero mean, variance ``s^2``, a derivative ``d'`` of
variance ``sv^2``, and ``kappa = corr(d, d')``; ``h = g/s`` for the level ``g`` (the gap). Two crossing
rates follow from Rice's formula, the density at the level times the mean positive part of the derivative
there, which is Gaussian:

* for ``d`` through ``g``: the density is ``phi(h)/s``, and the derivative has the mean ``kappa sv h``
and
  the standard deviation ``sqrt(1 - kappa^2) sv``;
* for the envelope ``R`` of ``d`` and its Hilbert transform ``c``: the density is ``(h/s) e^(-h^2/2)``.
  Since ``R' = (d d' + c c')/R``, the derivative has the same mean, and the standard deviation
  ``sqrt(1 - kappa^2) delta sv`` with the bandwidth ``delta^2 = 1 - l1^2/[(1 - kappa^2) l0 l2]``.

For ``kappa = 0`` their ratio is ``sqrt(2 pi) delta h``, as in Vanmarcke (1975, J. Appl. Mech. 42). His
empirical exponent, ``delta^1.2``, was fitted to single oscillators. For the difference of two
oscillators it is unsafe by up to 0.19 in the probability, while ``delta`` itself is unsafe by up to
0.05; ``delta`` is therefore used here.
"""

from __future__ import annotations

import numpy as np
from scipy.special import erfcx, ndtr

from stochlin.kernels.basics.arrays import Array

SQRT_2PI = np.sqrt(2 * np.pi)


def positive_part(mean: Array, deviation: Array) -> Array:
    """Mean positive part ``E[max(x, 0)]`` of a Gaussian ``x`` with this mean and standard deviation.

    It is exact for a deviation of 0, and computed without cancellation for a negative mean.
    """
    still = deviation <= 0
    t = mean / np.where(still, 1.0, deviation)
    with np.errstate(under="ignore", over="ignore"):
        tail = np.exp(-0.5 * t * t) * np.maximum(
            1 / SQRT_2PI + 0.5 * t * erfcx(np.maximum(-t, -25.0) / np.sqrt(2)), 0
        )
        body = np.exp(-0.5 * t * t) / SQRT_2PI + t * ndtr(t)
    return np.where(still, np.maximum(mean, 0), deviation * np.where(t > 0, body, tail))


def exceeding(gap: Array, variance: Array) -> Array:
    """Probability ``P(d > g) = 1 - Phi(h)`` that the gap is exceeded at a time; 0 at rest."""
    with np.errstate(divide="ignore"):
        return ndtr(-gap / np.sqrt(np.maximum(variance, 0)))


def hazards(gap: Array, d_d: Array, d_v: Array, v_v: Array, bandwidth: Array) -> tuple[Array, Array]:
    """Rates of first crossings of the gap [1/s]: by Poisson's assumption, and as by Vanmarcke.

    By Poisson's assumption the rate is that of up-crossings, ``nu``. The corrected rate is
    ``nu [1 - exp(-nu_R/nu)]/(1 - e^(-h^2/2))``, with the crossing rate ``nu_R`` of the envelope. It
    counts clumps of crossings, which an up-crossing of the envelope starts, if they contain a crossing
    of ``d``; and it is conditional on an envelope below the gap. The second moments ``E[d^2]``,
    ``E[d d']``, ``E[d'^2]`` of ``d`` and ``d'`` broadcast with the gap [m].
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
    """Integral (times, n) of a rate (times, n) from the first time on, by the trapezoidal rule."""
    steps = 0.5 * np.diff(times)[:, None] * (rate[1:] + rate[:-1])
    return np.concatenate([np.zeros_like(rate[:1]), np.cumsum(steps, axis=0)])
