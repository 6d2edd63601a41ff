"""Amplitude averaging of the bilinear oscillator (Caughey 1960, J. Appl. Mech. 27).

The response is assumed to be narrow-band, with Rayleigh distributed amplitudes. The equivalent linear
oscillator has two states, and a stiffness and a damping that depend on ``sigma_mu``.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from scipy.optimize import elementwise
from scipy.special import erfc

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import in_ranges
from stochlin.kernels.linearization.cells.series import evaluate
from stochlin.kernels.linearization.covariance import EquivalentSystem, own_covariance
from stochlin.kernels.linearization.filters import Filter

ORDER = 48  # Gauss-Legendre nodes of a panel
CUTOFF = 45.0  # z^2/lam at which the integral is cut off
FIRST_PANEL, WIDER = 2.0, 8.0  # length of the first panel in s, and ratio of the edges of the others
CROSSING_STEPS = 64  # steps between the bounds of log(sigma) in the search for the first root
SERIES = -7, 45  # range of log(lam) of the series; outside it the integral is that of its ends
TERMS = 17  # of a Chebyshev series for each unit of log(lam), exact to rounding
CHUNK = 2048  # cells solved together


class AmplitudeAverage(NamedTuple):
    """The equivalent two-state system of each cell, and how it was found."""

    system: EquivalentSystem
    iterations: Array  # (n,)
    residual: Array  # (n,): mismatch of log(sigma)
    converged: Array  # (n,)


def equivalent_system(
    sigma: Array, frequency: Array, damping_ratio: Array, hardening: Array
) -> EquivalentSystem:
    """Equivalent two-state system for a ductility with the standard deviation ``sigma``.

    Caughey's stiffness and damping are, with ``lam = 2 sigma^2``,
    ``(weq/w)^2 = 1 - (8 (1 - alpha)/pi) Int_1^inf (z^-3 + 1/(lam z)) sqrt(z - 1) exp(-z^2/lam) dz``,
    ``2 xieq weq/w = 2 xi + (2 (1 - alpha)/sqrt(pi lam)) erfc(1/sqrt(lam)) w/weq``.
    """
    lam = 2 * sigma**2
    loss = 1 - hardening
    integral = np.empty_like(lam)
    evaluate(np.log(lam), SERIES[0], _series(), integral)
    ratio = 1 - 8 * loss / np.pi * integral
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


@cache
def _series() -> Array:
    """Chebyshev coefficients (TERMS, panels) of the stiffness integral as a function of log(lam)."""
    angles = np.pi * (np.arange(TERMS) + 0.5) / TERMS
    points = np.arange(*SERIES)[:, None] + 0.5 * (1 + np.cos(angles))
    values = _stiffness_integral(np.exp(points.ravel())).reshape(points.shape)
    coefficients = 2 / TERMS * np.cos(np.outer(np.arange(TERMS), angles)) @ values.T
    coefficients[0] /= 2
    return coefficients


def _stiffness_integral(lam: Array) -> Array:
    """The integral of `equivalent_system`, by quadrature over ``s`` with ``z = 1 + s^2``: smooth."""
    nodes, weights = np.polynomial.legendre.leggauss(ORDER)
    end = np.sqrt(np.sqrt(1 + CUTOFF * lam) - 1)
    furthest = np.max(end, where=np.isfinite(end), initial=FIRST_PANEL)
    # For large s the integrand falls as a power of s, for which growing panels suffice.
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
    ground: Filter,
    rtol: float,
    max_iterations: int,
) -> AmplitudeAverage:
    """Find the ``sigma`` with which the system equivalent to it responds; in chunks, on all cores.

    The ground acceleration is over the yield displacement. On a ground of very narrow band there may be
    three solutions; the smallest is taken, which continues the elastic response.
    """

    @np.errstate(all="ignore")
    def part(cells: slice) -> tuple[Array, ...]:
        rows = frequency[cells], damping_ratio[cells], hardening[cells], elastic_sigma[cells]
        return _solve(*rows, ground.at(cells), rtol, max_iterations)

    parts = in_ranges(part, frequency.size, CHUNK)
    sigma, *judged = (np.concatenate(field) for field in zip(*parts, strict=True))
    return AmplitudeAverage(equivalent_system(sigma, frequency, damping_ratio, hardening), *judged)


def _solve(
    frequency: Array,
    damping_ratio: Array,
    hardening: Array,
    elastic_sigma: Array,
    ground: Filter,
    rtol: float,
    max_iterations: int,
) -> tuple[Array, ...]:
    """``sigma``, iterations, residual and convergence of a range of cells."""

    def mismatch(x: Array, w: Array, xi: Array, alpha: Array, which: Array) -> Array:
        """Logarithm of the response's standard deviation less ``x``, that of the assumed one."""
        system = equivalent_system(np.exp(x), w, xi, alpha)
        forcing = ground.at(which.astype(int)).forcing(system)
        return 0.5 * np.log(own_covariance(system, forcing).mu_mu) - x

    # Far below yield the response is elastic, and far above it that of a linear oscillator with the
    # post-yield stiffness; the mismatch changes sign in between.
    low = np.log(np.minimum(0.5 * elastic_sigma, 0.02))
    high = np.log(10 * np.maximum(elastic_sigma, 1) / hardening**2)
    cells = (frequency, damping_ratio, hardening, np.arange(frequency.size))
    root = elementwise.find_root(
        mismatch,
        _first_crossing(mismatch, low, high, cells),
        args=cells,
        tolerances={"xrtol": 0, "xatol": rtol},
        maxiter=max_iterations,
    )
    return np.exp(root.x), root.nit.astype(np.int32), np.abs(root.f_x), root.success


def _first_crossing(
    mismatch: Callable[..., Array], low: Array, high: Array, cells: tuple[Array, ...]
) -> tuple[Array, Array]:
    """The first of equal intervals from ``low`` to ``high`` in which the mismatch changes sign."""
    first, last = low.copy(), high.copy()
    below = np.arange(low.size)
    for share in np.linspace(0, 1, CROSSING_STEPS + 1)[1:-1]:
        x = (low + share * (high - low))[below]
        above = mismatch(x, *(row[below] for row in cells)) > 0
        last[below[~above]], first[below[above]] = x[~above], x[above]
        below = below[above]
        if not below.size:
            break
    return first, last
