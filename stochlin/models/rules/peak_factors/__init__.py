"""Peak factors: the largest value of a stationary Gaussian response over its standard deviation.

``N`` is the mean number of zero crossings during the motion, up and down. ``delta = sqrt(1 -
l1^2/(l0 l2))`` is the spectral bandwidth, with the spectral moments ``l0``, ``l1`` and ``l2``; it
is 0 for a sine wave. A two-sided peak is the largest ``|u|``, a one-sided peak the largest ``u``.
For one-sided peaks only the up-crossings count, which are half of all.

The models are defined for at least one counted crossing, ``N >= 1`` (``N >= 2`` for one-sided
peaks). A shorter motion may have no peak at all, and the formulas are for peaks.
"""

from stochlin.models.rules.peak_factors.peak_factor import (
    PEAK_FACTORS,
    PeakFactor,
    StationaryMotion,
    davenport,
    der_kiureghian,
    peak_factor_model,
    peak_factor_names,
    vanmarcke,
)

__all__ = [
    "PEAK_FACTORS",
    "PeakFactor",
    "StationaryMotion",
    "davenport",
    "der_kiureghian",
    "peak_factor_model",
    "peak_factor_names",
    "vanmarcke",
]
