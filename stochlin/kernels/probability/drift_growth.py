"""The slow drift of yielding structures that linearization loses, put back where its size is known.

In a stationary motion of full strength the variances of the displacements are known from simulation:
``V (1 + bias)^-2``, and so is ``rho``. The rest, ``V [(1 + bias)^-2 - 1]``, is the drift of the plastic
displacement. It builds up, and is forgotten, at the pace of yielding, ``2 alpha k_e SPEED``: at rest it
stays, which is the permanent set.
"""

from __future__ import annotations

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization.transient import Difference, Own

SPEED = 3.0  # drift relaxes faster than linearization's alpha k_e; by trial against simulation


def drift_variances(
    own: Own,
    both: Difference,
    pairs: Array,
    times: Array,
    hardening: Array,
    bias: Array,
    rho_bias: Array,
) -> tuple[Array, Array]:
    """Variances of the drift of displacements (times, n) and of their differences (times, p) [m^2].

    ``bias`` (n,) is that of the linearized standard deviation, relative, and ``rho_bias`` (p,) the
    linearized less the true correlation; NaN if unknown.
    """
    one, two = pairs
    pace = 2 * SPEED * hardening * own.relaxation
    full = own.displacement / (1 + bias) ** 2
    drift = _relaxing(full - own.displacement, pace, times)
    # Near rest rounding may leave less than nothing of a variance.
    root = np.sqrt(np.maximum(own.displacement[:, one] * own.displacement[:, two], 0))
    rho = both.product / np.where(root > 0, root, 1.0) - rho_bias
    shared = np.clip(rho, -1, 1) * np.sqrt(np.maximum(full[:, one] * full[:, two], 0)) - both.product
    shared = _relaxing(shared, 0.5 * (pace[:, one] + pace[:, two]), times)
    apart = drift[:, one] + drift[:, two] - 2 * shared
    # Less than nothing, where rho is corrected upwards by more than the variances: no drift apart.
    return drift, np.where(np.isnan(apart), np.nan, np.maximum(apart, 0))


def _relaxing(target: Array, pace: Array, times: Array) -> Array:
    """``x' = pace (target - x)`` from 0, exact for values that are constant over a step."""
    x = np.zeros_like(target)
    for step, length in enumerate(np.diff(times)):
        middle = 0.5 * (target[step] + target[step + 1])
        kept = np.exp(-0.5 * (pace[step] + pace[step + 1]) * length)
        x[step + 1] = middle + (x[step] - middle) * kept
    return x
