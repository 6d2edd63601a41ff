"""Two oscillations with known radii and random phases: probability that their difference exceeds a gap.

The displacements are ``u_i = r_i cos a_i``. The phase ``a_1`` is uniform, and ``a_2 = a_1 + D`` with a
phase difference ``D`` that is independent of it and symmetric about 0. Then
``corr(u_1, u_2) = E cos D``. Of all densities of ``D`` with this mean the one of largest entropy is von
Mises', ``e^(k cos D)/(2 pi I0(k))`` with ``I1(k)/I0(k) = rho``. It is uniform for ``rho = 0``; for 1
and -1, ``D`` is 0 and ``pi`` with certainty. For given ``D`` the difference ``u_1 - u_2`` is an
oscillation of radius ``A = sqrt(r_1^2 + r_2^2 - 2 r_1 r_2 cos D)``.
"""

from __future__ import annotations

import numpy as np
import scipy.optimize
from scipy.special import i0e, i1e
from scipy.stats import vonmises

from stochlin.kernels.basics.arrays import Array

CERTAIN = 1e-9  # 1 - |rho| below which the phase difference counts as certain


def concentration(rho: float) -> float:
    """Concentration ``k`` of the von Mises density with ``E cos D = rho``; infinite for rho of 1, -1."""
    if 1 - abs(rho) < CERTAIN:
        return float(np.copysign(np.inf, rho))
    if rho == 0:
        return 0.0
    size = abs(rho)
    largest = 2 / (1 - size)  # I1/I0 is about 1 - 1/(2 k)
    k = scipy.optimize.brentq(lambda k: i1e(k) / i0e(k) - size, 0, largest, xtol=1e-14, rtol=1e-13)
    return float(np.copysign(k, rho))


def least_phase(radius_1: Array, radius_2: Array, gap: Array) -> Array:
    """Phase difference in [0, pi] beyond which ``A > g``; infinite if ``A`` never exceeds the gap."""
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
