"""Correlation of two structures with plastic drift, eq. (8) of ``docs/drift.md``, without a map.

The formulas are evaluated in slabs of cells, so that intermediate arrays stay small.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from stochlin.analyses.linearization.equivalent_systems import INTERNAL, SHARES, system_and_forcing
from stochlin.analyses.tables.cellwise import Solved, cellwise
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.slabs import by_slabs
from stochlin.kernels.linearization.covariance import own_covariance, pair_covariance
from stochlin.kernels.linearization.drift import drift_correlation, innovation_coherence

OF_A_SIDE = ("drift_std", "drift_rate", *INTERNAL, *SHARES)


def derived_correlation(first: Solved, second: Solved) -> Any:
    """``rho`` of two structures that were solved with the drift closure."""
    (rho,) = cellwise(rho_of_drifts, *(side[name] for side in (first, second) for name in OF_A_SIDE))
    return rho


@by_slabs(float)
@np.errstate(all="ignore")  # cells with extreme parameters become NaN, with a status
def rho_of_drifts(*parts: Array) -> Array:
    """``rho`` of pairs; ``parts`` are the arrays `OF_A_SIDE` of the first, then of the second."""
    half, end = len(parts) // 2, len(INTERNAL)
    (slow_1, rate_1, *own_1), (slow_2, rate_2, *own_2) = parts[:half], parts[half:]
    first, second = (system_and_forcing(side[:end]) for side in (own_1, own_2))
    shares = [np.stack(np.broadcast_arrays(*side[end:])) for side in (own_1, own_2)]
    coherence = innovation_coherence(first[0], second[0])
    drifts = drift_correlation(coherence, shares[0], shares[1], rate_1, rate_2)
    total_1 = own_covariance(*first).mu_mu + slow_1**2
    total_2 = own_covariance(*second).mu_mu + slow_2**2
    joint = pair_covariance(*first, *second) + drifts * slow_1 * slow_2
    rho: Array = joint / np.sqrt(total_1 * total_2)
    return rho
