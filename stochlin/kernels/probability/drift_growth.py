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

SPEED = 3.0  # relaxation rate of the drift over alpha k_e of linearization, fitted to simulations


def drift_variances(
    variances: Array, product: Array, pace: Array, times: Array, bias: Array, rho_bias: Array
) -> tuple[Array, Array]:
    """Variances of the drifts of displacements (2, times, p) and of their differences (times, p) [m^2].

    ``variances`` (2, times, p) and ``product`` (times, p) are the linearized second moments of both
    displacements of p pairs, and ``pace`` (2, times, p) is ``alpha k_e``. ``bias`` (2, p) is the
    relative error of the linearized standard deviation, and ``rho_bias`` (p,) is the linearized less the
    true correlation; NaN if unknown.
    """
    pace = 2 * SPEED * pace
    full = variances / (1 + bias[:, None]) ** 2
    first, second = map(_relaxing, full - variances, pace, [times] * 2)
    # Near rest a variance may be negative by rounding.
    root = np.sqrt(np.maximum(variances.prod(axis=0), 0))
    rho = product / np.where(root > 0, root, 1.0) - rho_bias
    shared = np.clip(rho, -1, 1) * np.sqrt(np.maximum(full.prod(axis=0), 0)) - product
    apart = first + second - 2 * _relaxing(shared, pace.mean(axis=0), times)
    # A negative variance, if the correction of rho outweighs that of the variances, is set to zero.
    return np.stack([first, second]), np.where(np.isnan(apart), np.nan, np.maximum(apart, 0))


def _relaxing(target: Array, pace: Array, times: Array) -> Array:
    """Solution of ``x' = pace (target - x)`` from 0, with mean target and pace in each step."""
    x = np.zeros_like(target)
    for step, length in enumerate(np.diff(times)):
        middle = 0.5 * (target[step] + target[step + 1])
        kept = np.exp(-0.5 * (pace[step] + pace[step + 1]) * length)
        x[step + 1] = middle + (x[step] - middle) * kept
    return x
