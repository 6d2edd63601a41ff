"""Pairs under the drift closure: the derived correlation, and what simulated references tell of it."""

from __future__ import annotations

import numpy as np
import xarray as xr

from stochlin.analyses.correlation.derived_pairs import OF_A_SIDE, pieces_of_rho
from stochlin.analyses.correlation.drift_errors import expected_rho_error
from stochlin.analyses.correlation.drifting_signatures import insight_of, insights
from stochlin.analyses.correlation.linearized import SHOWN, linearized_pairs
from stochlin.analyses.linearization.bias_map import caution_of
from stochlin.analyses.linearization.equivalent_systems import solve_structure
from stochlin.analyses.linearization.tolerance import Tolerance
from stochlin.analyses.tables import labels
from stochlin.analyses.tables.cellwise import cellwise
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.slabs import in_slabs
from stochlin.kernels.correlation.signatures import informed_correlation
from stochlin.models.grounds import Ground
from stochlin.models.structures import DRIFT, Structure


def drifting_pairs(
    first: Structure, second: Structure, ground: Ground, tolerance: Tolerance
) -> xr.Dataset:
    """As `linearized_pairs`; the bias is judged by the truth that the Gaussian closure's bias tells.

    Where that is not known the expected error takes its place in the caution.
    """
    gaussian = table = linearized_pairs(first, second, ground, "gaussian", tolerance)
    truth = gaussian.rho - gaussian.bias
    sides = [solve_structure(s, ground, DRIFT, tolerance) for s in (first, second)]
    rho = correlation_with_drift((first, second), sides, ground, tolerance)
    (status,) = cellwise(np.maximum, *(side.status for side in sides), kinds=(np.int8,))
    table = table.assign(rho=rho.where(status < labels.NOT_CONVERGED).clip(-1, 1), status=status)
    table["bias"] = table.rho - truth
    error = expected_rho_error(first, second, ground, sides)
    table["rho_error"] = error.where(table.rho.notnull())
    worst = caution_of(table.bias.fillna(table.rho_error))
    attrs = worst.attrs
    for number, side in enumerate(sides, start=1):
        table = table.assign({f"{name}_{number}": side[name] for name in SHOWN})
        known = 1 + gaussian[f"bias_{number}"]
        bias = known * side.displacement_std / gaussian[f"displacement_std_{number}"] - 1
        table[f"bias_{number}"] = bias
        (worst,) = cellwise(np.maximum, worst, caution_of(bias), kinds=(np.int8,))
    return table.assign(caution=worst.astype(np.int8).assign_attrs(attrs))


def correlation_with_drift(
    structures: tuple[Structure, Structure],
    sides: list[xr.Dataset],
    ground: Ground,
    tolerance: Tolerance,
) -> xr.DataArray:
    """``rho`` of structures solved with the drift closure, eq. (11) of ``docs/drift.md``."""
    inputs = [[side[name] for name in OF_A_SIDE] for side in sides]
    known = insights(structures, sides, ground, tolerance)
    (rho,) = cellwise(_cells, *inputs[0], *known[0], *inputs[1], *known[1])
    return rho


@np.errstate(all="ignore")  # what comes of extreme input is judged by its status
def _cells(*inputs: Array) -> Array:
    def piece(*parts: Array) -> Array:
        half, own = len(parts) // 2, len(OF_A_SIDE)
        one, other = parts[:half], parts[half:]
        rho = pieces_of_rho(*one[:own], *other[:own])
        if half == own:
            return rho
        return informed_correlation(rho, insight_of(one[own:]), insight_of(other[own:]))

    return in_slabs(piece, *inputs)
