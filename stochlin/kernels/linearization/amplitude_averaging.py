"""Caughey's amplitude averaging of the bilinear oscillator (1960, J. Appl. Mech. 27).

For a narrow-band response the amplitude is Rayleigh distributed and the oscillator has two
states only: an equivalent stiffness and damping that depend on ``sigma_mu``.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from scipy.optimize import elementwise
from scipy.special import erfc

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization.covariance import EquivalentSystem

ORDER = 48
CUTOFF = 45.0  # exponent beyond which the integrand is dropped
FIRST_PANEL, WIDER = 2.0, 8.0
CROSSING_STEPS = 64  # between the least and the largest response there may be


class AmplitudeAverage(NamedTuple):
    """Solution per cell: the equivalent two-state system and how it was reached."""

    system: EquivalentSystem
    iterations: Array
    residual: Array
    converged: Array


def equivalent_system(
    sigma: Array, frequency: Array, damping_ratio: Array, hardening: Array
) -> EquivalentSystem:
    """Two-state system for a displacement of standard deviation ``sigma`` yield displacements.

    With ``lam = 2 sigma^2``:
    ``(weq/w)^2 = 1 - (8 (1 - alpha)/pi) Int_1^inf (z^-3 + 1/(lam z)) sqrt(z - 1) exp(-z^2/lam) dz``,
    ``2 xieq weq/w = 2 xi + (2 (1 - alpha)/sqrt(pi lam)) erfc(1/sqrt(lam)) w/weq``.
    """
    lam = 2 * sigma**2
    loss = 1 - hardening
    ratio = 1 - 8 * loss / np.pi * _stiffness_integral(lam)
    with np.errstate(under="ignore"):
        friction = 2 * loss / np.sqrt(np.pi * lam) * erfc(1 / np.sqrt(lam)) / np.sqrt(ratio)
    zero = np.zeros_like(ratio)
    return EquivalentSystem(
        frequency**2 * ratio,
        frequency * (2 * damping_ratio + friction),
        zero,
        zero,
        frequency * np.sqrt(ratio),
    )


def _stiffness_integral(lam: Array) -> Array:
    """The integral above; with ``z = 1 + s^2`` the integrand is smooth."""
    nodes, weights = np.polynomial.legendre.leggauss(ORDER)
    end = np.sqrt(np.sqrt(1 + CUTOFF * lam) - 1)
    furthest = np.max(end, where=np.isfinite(end), initial=FIRST_PANEL)
    # Far out the integrand falls as a power of s: panels that grow with it.
    panels = 1 + int(np.ceil(np.log(furthest / FIRST_PANEL) / np.log(WIDER)))
    edges = [0.0, *(FIRST_PANEL * WIDER**n for n in range(panels)), np.inf]
    total = np.zeros_like(lam)
    with np.errstate(under="ignore"):
        for low, high in pairwise(np.minimum(end, edge) for edge in edges):
            s = low[..., None] + 0.5 * (high - low)[..., None] * (1 + nodes)
            z = 1 + s * s
            density = np.exp(-z * z / lam[..., None]) * (z**-3 + 1 / (lam[..., None] * z))
            total = total + 0.5 * (high - low) * (weights * 2 * s * s * density).sum(axis=-1)
    return total


def solve_amplitude_average(
    frequency: Array,
    damping_ratio: Array,
    hardening: Array,
    elastic_sigma: Array,
    sigma_of: Callable[[EquivalentSystem, Array], Array],
    rtol: float,
    max_iterations: int,
) -> AmplitudeAverage:
    """Find ``sigma`` such that the system equivalent to it responds with it.

    ``sigma_of(system, cells)`` is the response in yield displacements. Under a very narrow band there
    may be three solutions: the least is the one that grows out of the elastic response.
    """

    def mismatch(x: Array, w: Array, xi: Array, alpha: Array, which: Array) -> Array:
        system = equivalent_system(np.exp(x), w, xi, alpha)
        return np.log(sigma_of(system, which.astype(int))) - x

    # Far below yield the response is the elastic one; far above it that of a linear
    # oscillator of stiffness alpha: the mismatch changes sign in between.
    low = np.log(np.minimum(0.5 * elastic_sigma, 0.02))
    high = np.log(10 * np.maximum(elastic_sigma, 1) / hardening**2)
    cells = (frequency, damping_ratio, hardening, np.arange(frequency.size))
    root = elementwise.find_root(
        mismatch,
        _first_crossing(lambda x: mismatch(x, *cells), low, high),
        args=cells,
        tolerances={"xrtol": 0, "xatol": rtol},
        maxiter=max_iterations,
    )
    system = equivalent_system(np.exp(root.x), frequency, damping_ratio, hardening)
    return AmplitudeAverage(system, root.nit.astype(np.int32), np.abs(root.f_x), root.success)


def _first_crossing(mismatch: Callable[[Array], Array], low: Array, high: Array) -> tuple[Array, Array]:
    """The first of even steps from ``low`` to ``high`` over which the mismatch is no longer positive."""
    first, last = low.copy(), high.copy()
    below = np.full(low.shape, True)
    for share in np.linspace(0, 1, CROSSING_STEPS + 1)[1:-1]:
        x = low + share * (high - low)
        above = mismatch(x) > 0
        last = np.where(below & ~above, x, last)
        first = np.where(below & above, x, first)
        below &= above
    return first, last
