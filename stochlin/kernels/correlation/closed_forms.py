"""Eqs. (3) and (4): combined peaks, and the correlation of linear oscillators under white noise."""

from __future__ import annotations

import numpy as np

from stochlin.kernels.basics.arrays import Array

RATIOS_WITH_CORRELATION = 1e-150, 1e150  # beyond these the correlation is zero in floating point
SMALL_DAMPING = 1e-60  # damping ratio below which products of four may vanish


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
    >>> from stochlin.kernels.correlation.closed_forms import double_difference
    >>> float(double_difference(0.4, 0.3, 0.0))
    0.5
    """
    product = 2 * np.sqrt(peak_1) * np.sqrt(peak_2)  # its square is 4 p1 p2
    near_one = np.hypot(peak_1 - peak_2, product * np.sqrt((1 - rho) / 2))
    opposed = rho < -0.5
    # the gap at rho of -1 and 0
    whole = np.where(opposed, peak_1 + peak_2, np.hypot(peak_1, peak_2))
    share = np.minimum(np.where(opposed, 1 + rho, rho), 0.5)  # difference of rho from these values
    ratio = product / np.where(whole > 0, whole, 1)
    gap = whole * np.sqrt(1 - 0.5 * share * ratio**2)
    return np.where(rho > 0.5, near_one, gap)


def white_noise_correlation(
    period_1: Array, period_2: Array, damping_1: Array, damping_2: Array
) -> Array:
    """Eq. (4), exactly symmetric in both oscillators: frequencies are over their geometric mean.

    With these, ``w1 w2 = 1`` and
    ``rho = 8 sqrt(x1 x2) (x1 w1 + x2 w2) / [(w1^2 - w2^2)^2 + 4 (x1 w1 + x2 w2)(x1 w2 + x2 w1)]``.

    Parameters
    ----------
    period_1, period_2 : float or array
        Periods [s], positive. All four parameters broadcast by shape; they are not checked.
    damping_1, damping_2 : float or array
        Damping ratios [-], in (0, 1).

    Returns
    -------
    float or array
        Correlation coefficient of the displacements [-].

    Examples
    --------
    >>> from stochlin.kernels.correlation.closed_forms import white_noise_correlation
    >>> round(float(white_noise_correlation(0.9, 1.0, 0.05, 0.05)), 6)
    0.473028
    """
    with np.errstate(all="ignore"):
        b = np.sqrt(period_2 / period_1)  # w1 over the geometric mean of w1 and w2
        rho = _rho(b, damping_1, damping_2, 1.0)
        small_damping = np.minimum(damping_1, damping_2) < SMALL_DAMPING
        if np.all(np.isfinite(rho)) and not np.any(small_damping):
            return rho
        # Damping ratios in a power of two, which changes no digit, so that no product vanishes.
        unit = np.ldexp(1.0, np.frexp(np.maximum(damping_1, damping_2))[1])
        return _rho(np.clip(b, *RATIOS_WITH_CORRELATION), damping_1 / unit, damping_2 / unit, unit)


def _rho(b: Array, xi_1: Array, xi_2: Array, unit: Array | float) -> Array:
    """Eq. (4) with the damping ratios in a unit."""
    w1 = b
    w2 = 1 / b
    mixed = xi_1 * w1 + xi_2 * w2
    crossed = xi_1 * w2 + xi_2 * w1
    detuning = (w1 - w2) * (w1 + w2) / unit
    return 8 * np.sqrt(xi_1 * xi_2) * mixed / (detuning**2 + 4 * mixed * crossed)
