"""Peak factors by independent crossings, by an equivalent number of them, and by crossings in clumps."""

from __future__ import annotations

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization.quadrature import on_panels
from stochlin.models.rules.peak_factors import PEAK_FACTORS, PeakFactor
from stochlin.models.rules.published import publish

EULER = float(np.euler_gamma)
RISING = float(np.exp(EULER / 2))  # smallest N from which L + 0.5772/L grows with N
PANELS, ORDER = 28, 12  # mean and std are exact to 1e-10 up to N = 1e8, compared with mpmath
# Panels shrink towards 0, since F rises from 0 within x ~ N delta^1.2 where this is small.
_NODES, _WEIGHTS = on_panels(np.union1d(0.25 ** np.arange(2, 9), np.linspace(0, 1, PANELS)), ORDER)
CELLS = 256  # cells evaluated at a time, so that nodes times cells fit into the processor cache


def davenport(n: Array, delta: Array) -> tuple[Array, Array]:
    """Independent crossings: ``p = L + 0.5772/L``, ``q = (pi/sqrt 6)/L``, ``L = sqrt(2 ln N)``.

    The formula is asymptotic for many crossings of a broad-band response. For a narrow band, in which
    crossings occur in clumps, it is too large. Below ``N = exp(0.5772/2) = 1.33`` the formula for p
    would decrease with N, and p is NaN. Below ``N = 6.8`` the formula for q exceeds 0.655, the standard
    deviation of the Rayleigh distribution, which it should not. One-sided peaks have ``N/2`` crossings.
    """
    mean = _extreme_value(n)
    with np.errstate(divide="ignore"):
        std = np.pi / np.sqrt(12 * np.log(n))
    return mean, np.where(np.isnan(mean), np.nan, std)


def der_kiureghian(n: Array, delta: Array) -> tuple[Array, Array]:
    """Davenport's mean with a fitted equivalent number ``Ne`` of independent crossings.

    ``Ne`` is ``max(2.1, 2 delta N)`` for ``delta <= 0.1``, ``(1.63 delta^0.45 - 0.38) N`` for ``delta``
    up to 0.69, and ``N`` above; ``q = 1.2/L - 5.4/(13 + L^6.4)``, and 0.65 for ``Ne <= 2.1``. Only the
    first of the three pieces has a lower bound; where the others give ``Ne < 1.33``, p is NaN. The
    pieces do not quite meet at ``delta = 0.1``, where ``Ne`` falls by 0.8 %.

    One-sided peaks have ``N/2`` crossings and ``2 delta``. In a narrow band ``Ne`` then has its value
    for two-sided peaks, since the envelope has the same peak in both directions.
    """
    middle = (1.63 * delta**0.45 - 0.38) * n
    effective = np.where(delta <= 0.1, np.maximum(2.1, 2 * delta * n), middle)
    effective = np.where(delta > 0.69, n, effective)
    level = np.sqrt(2 * np.log(np.maximum(effective, 2.1)))
    std = np.where(effective > 2.1, 1.2 / level - 5.4 / (13 + level**6.4), 0.65)
    mean = _extreme_value(effective)
    return mean, np.where(np.isnan(mean), np.nan, std)


def vanmarcke(n: Array, delta: Array) -> tuple[Array, Array]:
    """First passage of the envelope, with crossings in clumps, from its stationary state.

    ``P(peak < x) = [1 - e^(-x^2/2)] exp{-N [1 - e^(-sqrt(pi/2) delta^1.2 x)] / (e^(x^2/2) - 1)}``, from
    which mean and standard deviation follow by quadrature.

    For one-sided peaks the up-crossings occur at half the rate, ``N/2``, and each clump has half as many
    of them, so that ``sqrt(2 pi)`` replaces ``sqrt(pi/2)``. The factor ``1 - e^(-x^2/2)``, for the start
    of the envelope, does not change. The narrow-band limits of one- and two-sided peaks are equal.
    """
    moments = np.empty((2, n.size))
    for begin in range(0, n.size, CELLS):
        cells = slice(begin, begin + CELLS)
        moments[:, cells] = _survival_moments(n[cells, None], delta[cells, None])
    mean, square = moments
    return mean, np.sqrt(np.maximum(square - mean**2, 0))


def _extreme_value(n: Array) -> Array:
    """Mean peak factor ``L + 0.5772/L``, ``L = sqrt(2 ln N)``; NaN where it would decrease with N."""
    level = np.sqrt(2 * np.log(np.maximum(n, RISING)))
    return np.where(n >= RISING, level + EULER / level, np.nan)


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


OF_BAND = ", 0 <= bandwidth <= 1"
MODELS = (
    PeakFactor(
        name="Davenport1964",
        reference="Davenport, A. G. (1964), Proc. Inst. Civil Eng. 28, 187-196",
        formula=davenport,
        fewest=RISING,
    ),
    PeakFactor(
        name="DerKiureghian1980",
        reference="Der Kiureghian, A. (1980), J. Eng. Mech. Div. ASCE 106, 1195-1213",
        formula=der_kiureghian,
        spread=2.0,
        needs=f"{OF_BAND}, and Ne >= {RISING:.3g} independent ones",
    ),
    PeakFactor(
        name="Vanmarcke1975",
        reference="Vanmarcke, E. H. (1975), J. Appl. Mech. 42, 215-220",
        formula=vanmarcke,
        spread=2 ** (1 / 1.2),
        needs=OF_BAND,
    ),
)
for place, model in enumerate(MODELS):
    publish(PEAK_FACTORS, model, place)
