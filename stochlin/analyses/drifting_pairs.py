"""Pairs under the drift closure: the linear step of a pair, and the correlation of both drifts.

Eq. (8) of ``docs/drift.md``. Not compiled: temporaries are kept small by working in slabs.
"""

from __future__ import annotations

import numpy as np
import xarray as xr

from stochlin.analyses import labels
from stochlin.analyses.bias import caution_of
from stochlin.analyses.cellwise import cellwise
from stochlin.analyses.equivalent_systems import INTERNAL, SHARES, solve_structure
from stochlin.analyses.linearized_pairs import SHOWN, linearized_pairs
from stochlin.analyses.slabs import in_slabs
from stochlin.analyses.tolerance import Tolerance
from stochlin.kernels.arrays import Array
from stochlin.kernels.covariance import EquivalentSystem, Forcing, own_covariance, pair_covariance
from stochlin.kernels.drift import drift_correlation, innovation_coherence
from stochlin.models.grounds import Ground
from stochlin.models.structures import DRIFT, Structure

OF_A_SIDE = ("drift_std", "drift_rate", *INTERNAL, *SHARES)


def drifting_pairs(
    first: Structure, second: Structure, ground: Ground, tolerance: Tolerance
) -> xr.Dataset:
    """As `linearized_pairs`; the bias is judged by the truth that the Gaussian closure's bias tells."""
    gaussian = table = linearized_pairs(first, second, ground, "gaussian", tolerance)
    truth = gaussian.rho - gaussian.bias
    sides = [solve_structure(s, ground, DRIFT, tolerance) for s in (first, second)]
    rho = pair_correlation(sides)
    (status,) = cellwise(np.maximum, *(side.status for side in sides), kinds=(np.int8,))
    table = table.assign(rho=rho.where(status < labels.NOT_CONVERGED).clip(-1, 1), status=status)
    table["bias"] = table.rho - truth
    worst = caution_of(table.bias)
    attrs = worst.attrs
    for number, side in enumerate(sides, start=1):
        table = table.assign({f"{name}_{number}": side[name] for name in SHOWN})
        known = 1 + gaussian[f"bias_{number}"]
        bias = known * side.displacement_std / gaussian[f"displacement_std_{number}"] - 1
        table[f"bias_{number}"] = bias
        (worst,) = cellwise(np.maximum, worst, caution_of(bias), kinds=(np.int8,))
    return table.assign(caution=worst.astype(np.int8).assign_attrs(attrs))


def pair_correlation(sides: list[xr.Dataset]) -> xr.DataArray:
    """``rho`` of two structures that `solve_structure` or `solve_derived` has found drifts for."""
    (rho,) = cellwise(_correlation, *(side[name] for side in sides for name in OF_A_SIDE))
    return rho


@np.errstate(all="ignore")  # what comes of extreme input is judged by its status
def _correlation(*inputs: Array) -> Array:
    def piece(*parts: Array) -> Array:
        half, end = len(parts) // 2, len(INTERNAL)
        (slow_1, rate_1, *one), (slow_2, rate_2, *other) = parts[:half], parts[half:]
        first, second = _system(one[:end]), _system(other[:end])
        shares = [np.stack(np.broadcast_arrays(*side[end:])) for side in (one, other)]
        coherence = innovation_coherence(first[0], second[0])
        drifts = drift_correlation(coherence, shares[0], shares[1], rate_1, rate_2)
        total_1 = own_covariance(*first).mu_mu + slow_1**2
        total_2 = own_covariance(*second).mu_mu + slow_2**2
        joint = pair_covariance(*first, *second) + drifts * slow_1 * slow_2
        rho: Array = joint / np.sqrt(total_1 * total_2)
        return rho

    return in_slabs(piece, *inputs)


def _system(parts: list[Array]) -> tuple[EquivalentSystem, Forcing]:
    size = len(EquivalentSystem._fields)
    return EquivalentSystem(*parts[:size]), Forcing(*parts[size:])
