"""Peak factors by independent crossings (Davenport), and by an equivalent number of them."""

from __future__ import annotations

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.models.rules.peak_factors import PEAK_FACTORS, PeakFactor
from stochlin.models.rules.published import published

EULER = float(np.euler_gamma)
RISING = float(np.exp(EULER / 2))  # smallest N from which L + 0.5772/L grows with N


def _extreme_value(n: Array) -> Array:
    """Mean peak factor ``L + 0.5772/L``, ``L = sqrt(2 ln N)``; NaN where it would decrease with N."""
    level = np.sqrt(2 * np.log(np.maximum(n, RISING)))
    return np.where(n >= RISING, level + EULER / level, np.nan)


@published(
    PEAK_FACTORS,
    "davenport_1964",
    "Davenport, A. G. (1964), Proc. Inst. Civil Eng. 28, 187-196",
    place=1,
)
class Davenport1964(PeakFactor):
    """Independent crossings: ``p = L + 0.5772/L``, ``q = (pi/sqrt 6)/L``, ``L = sqrt(2 ln N)``.

    The formula is asymptotic for many crossings of a broad-band response. For a narrow band, in which
    crossings occur in clumps, it is too large. Below ``N = exp(0.5772/2) = 1.33`` the formula for p
    would decrease with N, and p is NaN. Below ``N = 6.8`` the formula for q exceeds 0.655, the standard
    deviation of the Rayleigh distribution, which it should not. One-sided peaks have ``N/2`` crossings.
    """

    abbreviation = "D64"

    def formula(self, n: Array, delta: Array) -> tuple[Array, Array]:
        mean = _extreme_value(n)
        with np.errstate(divide="ignore"):
            std = np.pi / np.sqrt(12 * np.log(n))
        return mean, np.where(np.isnan(mean), np.nan, std)

    @staticmethod
    def domain(sides: int = 2) -> str:
        """The domain of the model in words, for messages."""
        return f"at least {RISING * (3 - sides):.3g} zero crossings (both ways) in the duration"


@published(
    PEAK_FACTORS,
    "der_kiureghian_1980",
    "Der Kiureghian, A. (1980), J. Eng. Mech. Div. ASCE 106, 1195-1213",
    place=2,
)
class DerKiureghian1980(PeakFactor):
    """Davenport's mean with a fitted equivalent number ``Ne`` of independent crossings.

    ``Ne`` is ``max(2.1, 2 delta N)`` for ``delta <= 0.1``, ``(1.63 delta^0.45 - 0.38) N`` for ``delta``
    up to 0.69, and ``N`` above; ``q = 1.2/L - 5.4/(13 + L^6.4)``, and 0.65 for ``Ne <= 2.1``. Only the
    first of the three pieces has a lower bound; where the others give ``Ne < 1.33``, p is NaN. The
    pieces do not quite meet at ``delta = 0.1``, where ``Ne`` falls by 0.8 %.

    One-sided peaks have ``N/2`` crossings and ``2 delta``. In a narrow band ``Ne`` then has its value
    for two-sided peaks, since the envelope has the same peak in both directions.
    """

    abbreviation = "DK80"
    spread = 2.0

    def formula(self, n: Array, delta: Array) -> tuple[Array, Array]:
        middle = (1.63 * delta**0.45 - 0.38) * n
        effective = np.where(delta <= 0.1, np.maximum(2.1, 2 * delta * n), middle)
        effective = np.where(delta > 0.69, n, effective)
        level = np.sqrt(2 * np.log(np.maximum(effective, 2.1)))
        std = np.where(effective > 2.1, 1.2 / level - 5.4 / (13 + level**6.4), 0.65)
        mean = _extreme_value(effective)
        return mean, np.where(np.isnan(mean), np.nan, std)

    @staticmethod
    def domain(sides: int = 2) -> str:
        """The domain of the model in words, for messages."""
        return f"{PeakFactor.domain(sides)}, and Ne >= {RISING:.3g} independent ones"
