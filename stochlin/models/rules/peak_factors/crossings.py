"""The peak of independent crossings, or of as many of them as there are clumps."""

from __future__ import annotations

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.models.rules.peak_factors import PEAK_FACTORS, PeakFactor
from stochlin.models.rules.published import published

EULER = float(np.euler_gamma)
RISING = float(np.exp(EULER / 2))  # below, L + 0.5772/L falls as the number of crossings grows


def _extreme_value(n: Array) -> Array:
    """Mean ``L + 0.5772/L``, ``L = sqrt(2 ln N)``; NaN where it would fall as N grows."""
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

    Asymptotic for many crossings and a broad band; too large for a narrow one, where crossings come
    in clumps. Below ``N = exp(0.5772/2) = 1.33`` p would fall as N grows: NaN; and below 6.8 q is
    above 0.655, the scatter of Rayleigh's law, where it cannot be. One-sided
    peaks: the same with ``N/2``, the up-crossings of one level.
    """

    abbreviation = "D64"

    def formula(self, n: Array, delta: Array) -> tuple[Array, Array]:
        mean = _extreme_value(n)
        with np.errstate(divide="ignore"):
            std = np.pi / np.sqrt(12 * np.log(n))
        return mean, np.where(np.isnan(mean), np.nan, std)

    @staticmethod
    def domain(sides: int = 2) -> str:
        """Where the model is defined, in words."""
        return f"at least {RISING * (3 - sides):.3g} zero crossings (both ways) in the duration"


@published(
    PEAK_FACTORS,
    "der_kiureghian_1980",
    "Der Kiureghian, A. (1980), J. Eng. Mech. Div. ASCE 106, 1195-1213",
    place=2,
)
class DerKiureghian1980(PeakFactor):
    """Davenport's mean with an equivalent number ``Ne`` of independent crossings, fitted.

    ``Ne = max(2.1, 2 delta N)`` for ``delta <= 0.1``, ``(1.63 delta^0.45 - 0.38) N`` to 0.69, ``N``
    above; ``q = 1.2/L - 5.4/(13 + L^6.4)``, and 0.65 for ``Ne <= 2.1``. Of the fit's three pieces only
    the first has a floor: where the others give ``Ne < 1.33``, p is NaN. At ``delta = 0.1`` the pieces
    do not quite meet: ``Ne`` falls by 0.8 %.

    One-sided peaks: ``N/2`` crossings and ``2 delta``. In the narrow band ``Ne`` then stays what it
    was, as it must: up and down the envelope has the same peak.
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
        """Where the model is defined, in words."""
        return f"{PeakFactor.domain(sides)}, and Ne >= {RISING:.3g} independent ones"
