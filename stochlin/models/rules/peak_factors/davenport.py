"""The peak of independent crossings."""

from __future__ import annotations

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.models.rules.peak_factors import PEAK_FACTORS, RISING, PeakFactor, extreme_value
from stochlin.models.rules.published import published


@published(
    PEAK_FACTORS,
    "davenport_1964",
    "Davenport, A. G. (1964), Proc. Inst. Civil Eng. 28, 187-196",
    place=1,
)
class Davenport1964(PeakFactor):
    """Independent crossings: ``p = L + .5772/L``, ``q = (pi/sqrt 6)/L``, ``L = sqrt(2 ln N)``.

    Asymptotic for many crossings and a broad band; too large for a narrow one, where crossings come
    in clumps. Below ``N = exp(.5772/2) = 1.33`` p would fall as N grows: NaN; and below 6.8 q is
    above .655, the scatter of Rayleigh's law, where it cannot be. One-sided
    peaks: the same with ``N/2``, the up-crossings of one level.
    """

    abbreviation = "D64"

    def formula(self, n: Array, delta: Array) -> tuple[Array, Array]:
        mean = extreme_value(n)
        with np.errstate(divide="ignore"):
            std = np.pi / np.sqrt(12 * np.log(n))
        return mean, np.where(np.isnan(mean), np.nan, std)

    @staticmethod
    def domain(sides: int = 2) -> str:
        """Where the model is defined, in words."""
        return f"at least {RISING * (3 - sides):.3g} zero crossings (both ways) in the duration"
