"""Two linear oscillators under one white noise: eq. (4), exact."""

from __future__ import annotations

import numpy as np

from stochlin.kernels.basics.arrays import Array


def white_noise_correlation(
    period_1: Array, period_2: Array, damping_1: Array, damping_2: Array
) -> Array:
    """Eq. (4), in frequencies scaled by their geometric mean, so that it stays symmetric.

    With ``w1 w2 = 1``:
    ``rho = 8 sqrt(x1 x2) (x1 w1 + x2 w2) / [(w1^2 - w2^2)^2 + 4 (x1 w1 + x2 w2)(x1 w2 + x2 w1)]``.

    Parameters
    ----------
    period_1, period_2 : float or array
        Periods [s], positive; all four broadcast by shape. Nothing is checked.
    damping_1, damping_2 : float or array
        Damping ratios [-], in (0, 1).

    Returns
    -------
    float or array
        Correlation coefficient of the displacements [-].

    Examples
    --------
    >>> from stochlin.kernels.correlation.white_noise import white_noise_correlation
    >>> round(float(white_noise_correlation(0.9, 1.0, 0.05, 0.05)), 6)
    0.473028
    """
    b = np.sqrt(period_2 / period_1)  # w1 over the mean
    w1, w2 = b, 1 / b
    mixed = damping_1 * w1 + damping_2 * w2
    crossed = damping_1 * w2 + damping_2 * w1
    detuning = (w1 - w2) * (w1 + w2)
    return 8 * np.sqrt(damping_1 * damping_2) * mixed / (detuning**2 + 4 * mixed * crossed)
