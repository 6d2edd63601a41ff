"""Probability of pounding: crossings of a level, and oscillations of random phase.

**Crossings.** The process ``d`` (the relative displacement) is Gaussian and nonstationary, with
mean zero. It has the variance ``s^2``, a derivative ``d'`` of variance ``sv^2``, and ``kappa =
corr(d, d')``; ``h = g/s`` for the level ``g`` (the gap). Two crossing rates follow from Rice's
formula, the density at the level times the mean positive part of the derivative there, which is
Gaussian:

* for ``d`` through ``g``: the density is ``phi(h)/s``, and the derivative has the mean
  ``kappa sv h`` and the standard deviation ``sqrt(1 - kappa^2) sv``;
* for the envelope ``R`` of ``d`` and its Hilbert transform ``c``: the density is
  ``(h/s) e^(-h^2/2)``. Since ``R' = (d d' + c c')/R``, the derivative has the same mean, and the
  standard deviation ``sqrt(1 - kappa^2) delta sv`` with the bandwidth
  ``delta^2 = 1 - l1^2/[(1 - kappa^2) l0 l2]``.

For ``kappa = 0`` their ratio is ``sqrt(2 pi) delta h``, as in Vanmarcke (1975, J. Appl. Mech. 42).
His empirical exponent, ``delta^1.2``, was fitted to single oscillators. For the difference of two
oscillators it is unsafe by up to 0.19 in the probability, while ``delta`` itself is unsafe by up to
0.05; ``delta`` is therefore used here.

**Phases.** Two oscillations have known radii: the displacements are ``u_i = r_i cos a_i``. The
phase ``a_1`` is uniform, and ``a_2 = a_1 + D`` with a phase difference ``D`` that is independent of
it and symmetric about 0. Then ``corr(u_1, u_2) = E cos D``. Of all densities of ``D`` with this
mean the one of largest entropy is von Mises', ``e^(k cos D)/(2 pi I0(k))`` with ``I1(k)/I0(k) =
rho``. It is uniform for ``rho = 0``; for 1 and -1, ``D`` is 0 and ``pi`` with certainty. For given
``D`` the difference ``u_1 - u_2`` is an oscillation of radius ``A = sqrt(r_1^2 + r_2^2 - 2 r_1 r_2
cos D)``.
"""

from __future__ import annotations

import numpy as np
import scipy.optimize
from scipy.special import erfcx, i0e, i1e, ndtr
from scipy.stats import vonmises

from stochlin.kernels.basics.arrays import SQRT_2PI, Array

CERTAIN = 1e-9  # 1 - |rho| below which the phase difference counts as certain


def positive_part(mean: Array, deviation: Array) -> Array:
    """Mean positive part ``E[max(x, 0)]`` of Gaussian ``x`` with this mean and standard deviation.

    It is exact for a deviation of 0, and computed without cancellation for a negative mean.
    """
    constant = deviation <= 0
    t = mean / np.where(constant, 1.0, deviation)
    with np.errstate(under="ignore", over="ignore"):
        tail = np.exp(-0.5 * t * t) * np.maximum(
            1 / SQRT_2PI + 0.5 * t * erfcx(np.maximum(-t, -25.0) / np.sqrt(2)), 0
        )
        body = np.exp(-0.5 * t * t) / SQRT_2PI + t * ndtr(t)
    return np.where(constant, np.maximum(mean, 0), deviation * np.where(t > 0, body, tail))


def exceeding(gap: Array, variance: Array) -> Array:
    """Probability ``P(d > g) = 1 - Phi(h)`` that the gap is exceeded at a time; 0 at rest."""
    with np.errstate(divide="ignore"):
        return ndtr(-gap / np.sqrt(np.maximum(variance, 0)))


def hazards(
    gap: Array, d_d: Array, d_v: Array, v_v: Array, bandwidth: Array
) -> tuple[Array, Array]:
    """Rates of first crossings of the gap [1/s]: by Poisson's assumption, and as by Vanmarcke.

    By Poisson's assumption the rate is that of up-crossings, ``nu``. The corrected rate is ``nu [1
    - exp(-nu_R/nu)]/(1 - e^(-h^2/2))``, with the crossing rate ``nu_R`` of the envelope. It counts
    clumps of crossings, which an up-crossing of the envelope starts, if they contain a crossing of
    ``d``; and it is conditional on an envelope below the gap. The second moments ``E[d^2]``, ``E[d
    d']``, ``E[d'^2]`` of ``d`` and ``d'`` broadcast with the gap [m].
    """
    moving = (d_d > 0) & (v_v > 0)
    s = np.sqrt(np.where(moving, d_d, 1.0))
    sv = np.sqrt(np.where(moving, v_v, 1.0))
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


def concentration(rho: float) -> float:
    """Concentration ``k`` of a von Mises density with ``E cos D = rho``; infinite at rho = +-1."""
    if 1 - abs(rho) < CERTAIN:
        return float(np.copysign(np.inf, rho))
    if rho == 0:
        return 0.0
    size = abs(rho)
    largest = 2 / (1 - size)  # I1/I0 is about 1 - 1/(2 k)
    k = scipy.optimize.brentq(lambda k: i1e(k) / i0e(k) - size, 0, largest, xtol=1e-14, rtol=1e-13)
    return float(np.copysign(k, rho))


def least_phase(radius_1: Array, radius_2: Array, gap: Array) -> Array:
    """Phase difference in [0, pi] beyond which ``A > g``; infinite if ``A`` never exceeds ``g``."""
    with np.errstate(divide="ignore", invalid="ignore"):
        cosine = (radius_1**2 + radius_2**2 - gap**2) / (2 * radius_1 * radius_2)
    phase = np.arccos(np.clip(np.nan_to_num(cosine, nan=-2.0), -1, 1))
    return np.where(
        radius_1 + radius_2 <= gap, np.inf, np.where(np.abs(radius_1 - radius_2) > gap, 0.0, phase)
    )


def beyond_phase(phase: Array, k: float) -> Array:
    """Probability ``P(|D| > phase)`` for the concentration ``k``, within 6e-6."""
    if np.isinf(k):
        return ((phase < np.pi) if k < 0 else (phase <= 0)).astype(float) * np.isfinite(phase)
    within = np.minimum(phase, np.pi)
    if k == 0:
        return 1 - within / np.pi
    if k < 0:  # D is pi and a phase of the concentration -k
        return 1 - 2 * vonmises.sf(np.pi - within, -k)
    beyond: Array = 2 * vonmises.sf(within, k)
    return beyond
