"""Growth of the plastic drift of yielding structures over time, where its stationary size is known.

Linearization does not contain the drift. In a stationary motion the true variance of the displacement is
known from the bias of linearization against simulation: it is ``V (1 + bias)^-2`` for the linearized
variance ``V``, and the true ``rho`` is known likewise. The difference ``V [(1 + bias)^-2 - 1]`` is the
variance of the drift. Over time it approaches this value at the rate ``2 alpha k_e SPEED``, which is
zero without yielding: after the motion the drift remains as permanent set.
"""

from __future__ import annotations

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization.transient import Difference, Own

SPEED = 3.0  # relaxation rate of the drift over alpha k_e of linearization, fitted to simulations


def drift_variances(
    own: Own,
    both: Difference,
    pairs: Array,
    times: Array,
    hardening: Array,
    bias: Array,
    rho_bias: Array,
) -> tuple[Array, Array]:
    """Variances of the drifts of displacements (times, n) and of their differences (times, p) [m^2].

    ``pairs`` (2, p) are the numbers of the two structures of each pair. ``bias`` (n,) is the relative
    error of the linearized standard deviation, and ``rho_bias`` (p,) is the linearized less the true
    correlation; NaN if unknown.
    """
    i, j = pairs
    pace = 2 * SPEED * hardening * own.relaxation
    full = own.displacement / (1 + bias) ** 2
    drift = _relaxing(full - own.displacement, pace, times)
    # Near rest a variance may be negative by rounding.
    root = np.sqrt(np.maximum(own.displacement[:, i] * own.displacement[:, j], 0))
    rho = both.product / np.where(root > 0, root, 1.0) - rho_bias
    shared = np.clip(rho, -1, 1) * np.sqrt(np.maximum(full[:, i] * full[:, j], 0)) - both.product
    shared = _relaxing(shared, 0.5 * (pace[:, i] + pace[:, j]), times)
    apart = drift[:, i] + drift[:, j] - 2 * shared
    # A negative variance, if the correction of rho outweighs that of the variances, is set to zero.
    return drift, np.where(np.isnan(apart), np.nan, np.maximum(apart, 0))


def _relaxing(target: Array, pace: Array, times: Array) -> Array:
    """Solution of ``x' = pace (target - x)`` from 0, with mean target and pace in each step."""
    x = np.zeros_like(target)
    for step, length in enumerate(np.diff(times)):
        middle = 0.5 * (target[step] + target[step + 1])
        kept = np.exp(-0.5 * (pace[step] + pace[step + 1]) * length)
        x[step + 1] = middle + (x[step] - middle) * kept
    return x
