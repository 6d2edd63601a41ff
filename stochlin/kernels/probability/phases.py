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

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization.quadrature import on_panels

CERTAIN = 1e-9  # 1 - |rho| below which the phase difference counts as certain
PANELS, ORDER = 18, 10  # panels of half of the range, and Gauss-Legendre nodes of each
_GRADED = np.concatenate([[0.0], 0.3 ** np.arange(PANELS)[::-1]]) / 2  # edges from 0 to 1/2
_EDGES = np.concatenate([_GRADED, 1 - _GRADED[-2::-1]])
UNIT_NODES, UNIT_WEIGHTS = on_panels(_EDGES, ORDER)  # on (0, 1), dense at both ends
CELLS = 2048  # cells computed together


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
    """Probability ``P(|D| > phase)`` for the concentration ``k``."""
    if np.isinf(k):
        return ((phase < np.pi) if k < 0 else (phase <= 0)).astype(float) * np.isfinite(phase)
    start = np.minimum(phase, np.pi).ravel()
    probability = np.empty_like(start)
    for begin in range(0, start.size, CELLS):
        cells = slice(begin, begin + CELLS)
        _, weight = _nodes(start[cells], k)
        probability[cells] = weight.sum(axis=1)
    return np.clip(np.where(start <= 0, 1.0, probability), 0, 1).reshape(phase.shape)


def _nodes(start: Array, k: float) -> tuple[Array, Array]:
    """Nodes from ``start`` to pi, and weights, of integrals over the density of ``|D|``."""
    length = (np.pi - start)[:, None]
    d = start[:, None] + length * UNIT_NODES
    # e^(k (cos D - 1)) for k >= 0, otherwise e^(k (cos D + 1)), by the half angle and without overflow.
    exponent = -2 * k * np.sin(d / 2) ** 2 if k >= 0 else 2 * k * np.cos(d / 2) ** 2
    with np.errstate(under="ignore"):
        density = np.exp(exponent) / (np.pi * i0e(abs(k)))
    return d, length * UNIT_WEIGHTS * density
