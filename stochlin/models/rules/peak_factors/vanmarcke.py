"""Peak factor by first passage of the envelope, with crossings in clumps (Vanmarcke)."""

from __future__ import annotations

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization.quadrature import on_panels
from stochlin.models.rules.peak_factors import PEAK_FACTORS, PeakFactor
from stochlin.models.rules.published import published

PANELS, ORDER = 28, 12  # mean and std are exact to 1e-10 up to N = 1e8, compared with mpmath
# Panels shrink towards 0, since F rises from 0 within x ~ N delta^1.2 where this is small.
_NODES, _WEIGHTS = on_panels(np.union1d(0.25 ** np.arange(2, 9), np.linspace(0, 1, PANELS)), ORDER)
CELLS = 256  # cells evaluated at a time, so that nodes times cells fit into the processor cache


@published(
    PEAK_FACTORS, "vanmarcke_1975", "Vanmarcke, E. H. (1975), J. Appl. Mech. 42, 215-220", place=3
)
class Vanmarcke1975(PeakFactor):
    """First passage of the envelope, with crossings in clumps, from its stationary state.

    ``P(peak < x) = [1 - e^(-x^2/2)] exp{-N [1 - e^(-sqrt(pi/2) delta^1.2 x)] / (e^(x^2/2) - 1)}``, from
    which mean and standard deviation follow by quadrature.

    For one-sided peaks the up-crossings occur at half the rate, ``N/2``, and each clump has half as many
    of them, so that ``sqrt(2 pi)`` replaces ``sqrt(pi/2)``. The factor ``1 - e^(-x^2/2)``, for the start
    of the envelope, does not change. The narrow-band limits of one- and two-sided peaks are equal.
    """

    abbreviation = "V75"
    spread = 2 ** (1 / 1.2)

    def formula(self, n: Array, delta: Array) -> tuple[Array, Array]:
        moments = np.empty((2, n.size))
        for begin in range(0, n.size, CELLS):
            cells = slice(begin, begin + CELLS)
            moments[:, cells] = _survival_moments(n[cells, None], delta[cells, None])
        mean, square = moments
        return mean, np.sqrt(np.maximum(square - mean**2, 0))


@np.errstate(over="ignore")  # of the rate, where the exceedance is 0 or 1
def _survival_moments(n: Array, delta: Array) -> tuple[Array, Array]:
    """First two moments ``Int (1 - F) dx`` and ``Int 2 x (1 - F) dx`` of Vanmarcke's distribution F."""
    reach = np.sqrt(2 * (np.log1p(n) + 37))  # for larger x, 1 - F is below 1e-16
    x, weight = reach * _NODES, reach * _WEIGHTS
    rate = -n * np.expm1(-np.sqrt(np.pi / 2) * delta**1.2 * x) / np.expm1(0.5 * x * x)
    # 1 - F = 1 - (1 - a) e^-r with a the start and r the rate, without cancellation for small a and r
    start = np.exp(-0.5 * x * x)
    exceeding = start * np.exp(-rate) - np.expm1(-rate)
    return (weight * exceeding).sum(axis=1), (weight * 2 * x * exceeding).sum(axis=1)
