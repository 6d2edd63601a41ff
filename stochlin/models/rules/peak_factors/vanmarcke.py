"""The peak by first passage of an envelope that clumps."""

from __future__ import annotations

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization.quadrature import on_panels
from stochlin.models.rules.peak_factors import PEAK_FACTORS, PeakFactor
from stochlin.models.rules.published import published

PANELS, ORDER = 28, 12  # mean and std to 1e-10 up to N = 1e8, by comparison with mpmath
# Panels that shrink towards 0, where F turns on within x ~ N delta^1.2 if that is small.
_NODES, _WEIGHTS = on_panels(np.union1d(0.25 ** np.arange(2, 9), np.linspace(0, 1, PANELS)), ORDER)
CELLS = 256  # at a time: nodes times cells stay in the cache


@published(
    PEAK_FACTORS, "vanmarcke_1975", "Vanmarcke, E. H. (1975), J. Appl. Mech. 42, 215-220", place=3
)
class Vanmarcke1975(PeakFactor):
    """First passage of an envelope that clumps, started in its stationary state.

    ``P(peak < x) = [1 - e^(-x^2/2)] exp{-N [1 - e^(-sqrt(pi/2) delta^1.2 x)] / (e^(x^2/2) - 1)}``; mean
    and standard deviation by quadrature.

    One-sided peaks: up-crossings of one level come at half the rate, ``N/2``, and each clump of the
    envelope holds half as many, so that ``sqrt(pi/2)`` turns to ``sqrt(2 pi)``; the factor for the start
    stays, for the envelope starts as before. The narrow-band limit is the same for both.
    """

    abbreviation = "V75"
    spread = 2 ** (1 / 1.2)

    def formula(self, n: Array, delta: Array) -> tuple[Array, Array]:
        moments = np.empty((2, n.size))
        for begin in range(0, n.size, CELLS):
            cells = slice(begin, begin + CELLS)
            moments[:, cells] = _survival_moments(n[cells, None], delta[cells, None])
        mean, square = moments
        return mean, np.sqrt(square - mean**2)


def _survival_moments(n: Array, delta: Array) -> tuple[Array, Array]:
    """``Int (1 - F) dx`` and ``Int 2 x (1 - F) dx`` of Vanmarcke's distribution."""
    reach = np.sqrt(2 * (np.log1p(n) + 37))  # 1 - F is below 1e-16 beyond
    x, weight = reach * _NODES, reach * _WEIGHTS
    rate = -n * np.expm1(-np.sqrt(np.pi / 2) * delta**1.2 * x) / np.expm1(0.5 * x * x)
    # 1 - (1 - a) e^-r without cancellation where both are small
    start = np.exp(-0.5 * x * x)
    exceeding = start * np.exp(-rate) - np.expm1(-rate)
    return (weight * exceeding).sum(axis=1), (weight * 2 * x * exceeding).sum(axis=1)
