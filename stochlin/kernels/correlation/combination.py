"""Combination of two peak displacements by the double difference method, eq. (3)."""

from __future__ import annotations

import numpy as np

from stochlin.kernels.basics.arrays import Array


def double_difference(peak_1: Array, peak_2: Array, rho: Array) -> Array:
    """Eq. (3), ``g = sqrt(p1^2 + p2^2 - 2 rho p1 p2)``, without cancellation for any ``rho``.

    It is computed from its value at the correlation -1, 0 or 1, whichever is nearest.

    Parameters
    ----------
    peak_1, peak_2 : float or array
        Peak displacements [m], not negative. All three parameters broadcast by shape; they are not
        checked.
    rho : float or array
        Correlation coefficient of the displacements [-], from -1 to 1.

    Returns
    -------
    float or array
        The gap [m].

    Examples
    --------
    >>> from stochlin.kernels.correlation.combination import double_difference
    >>> float(double_difference(0.4, 0.3, 0.0))
    0.5
    """
    product = 2 * np.sqrt(peak_1) * np.sqrt(peak_2)  # its square is 4 p1 p2
    near_one = np.hypot(peak_1 - peak_2, product * np.sqrt((1 - rho) / 2))
    opposed = rho < -0.5
    whole = np.where(opposed, peak_1 + peak_2, np.hypot(peak_1, peak_2))  # the gap at rho of -1 and 0
    share = np.minimum(np.where(opposed, 1 + rho, rho), 0.5)  # difference of rho from these values
    ratio = product / np.where(whole > 0, whole, 1)
    gap = whole * np.sqrt(1 - 0.5 * share * ratio**2)
    return np.where(rho > 0.5, near_one, gap)
