"""Pairs under the drift closure: the derived correlation, and what simulated references tell of it."""

from __future__ import annotations

import numpy as np
import xarray as xr

from stochlin.analyses.correlation.derived_pairs import OF_A_SIDE, pieces_of_rho
from stochlin.analyses.correlation.drifting_signatures import insight_of, insights
from stochlin.analyses.correlation.errors import (
    DIFFERENCE,
    corrected,
    doubt_of,
    expected_rho_error,
    relative_error,
)
from stochlin.analyses.correlation.linearized import SHOWN, linearized_pairs
from stochlin.analyses.linearization.bias_map import caution_of, caution_of_error
from stochlin.analyses.linearization.equivalent_systems import solve_structure
from stochlin.analyses.linearization.tolerance import Tolerance
from stochlin.analyses.tables import labels
from stochlin.analyses.tables.cellwise import cellwise
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.slabs import in_slabs
from stochlin.kernels.correlation.nearness import with_nearness
from stochlin.kernels.correlation.signatures import informed_correlation
from stochlin.models.grounds import Ground
from stochlin.models.structures import DRIFT, Structure


def drifting_pairs(
    first: Structure, second: Structure, ground: Ground, tolerance: Tolerance
) -> xr.Dataset:
    """As `linearized_pairs`; the bias is judged by the truth that the Gaussian closure's bias tells.

    Where that is not known the expected error takes its place in the caution. The difference of the
    displacements has an expected error of its own.
    """
    gaussian = table = linearized_pairs(first, second, ground, "gaussian", tolerance)
    truth = gaussian.rho - gaussian.bias
    sides = [solve_structure(s, ground, DRIFT, tolerance) for s in (first, second)]
    rho, doubt, share = _rho_and_doubt((first, second), sides, ground, tolerance)
    (status,) = cellwise(np.maximum, *(side.status for side in sides), kinds=(np.int8,))
    table = table.assign(rho=rho.where(status < labels.NOT_CONVERGED).clip(-1, 1), status=status)
    table["bias"] = table.rho - truth
    error = expected_rho_error(first, second, ground, sides)
    table["rho_error"] = error.where(table.rho.notnull())
    worst = caution_of(table.bias.fillna(table.rho_error))
    attrs = worst.attrs
    for number, side in enumerate(sides, start=1):
        table = table.assign({f"{name}_{number}": side[name] for name in SHOWN})
        own = side.displacement_error.where(side.displacement_std.notnull())
        table[f"bias_{number}"] = 0 * own
        (worst,) = cellwise(np.maximum, worst, caution_of_error(own), kinds=(np.int8,))
    of_sides = [side[name] for side in sides for name in ("displacement_std", "displacement_error")]
    apart, lean = cellwise(relative_error, *of_sides, table.rho, doubt, share, kinds=(float, float))
    apart = apart.where(table.rho_error.notnull()).where(table.rho_error != 0, 0.0)  # both elastic: 0
    table[f"{DIFFERENCE}_error"] = apart
    table[f"{DIFFERENCE}_bias"] = lean.where(apart.notnull())
    table[f"{DIFFERENCE}_caution"] = caution_of_error(apart)
    return table.assign(caution=worst.astype(np.int8).assign_attrs(attrs))


def correlation_with_drift(
    structures: tuple[Structure, Structure],
    sides: list[xr.Dataset],
    ground: Ground,
    tolerance: Tolerance,
) -> xr.DataArray:
    """``rho`` of structures solved with the drift closure, eqs. (11) and (13) of ``docs/drift.md``."""
    return _rho_and_doubt(structures, sides, ground, tolerance)[0]


def _rho_and_doubt(
    structures: tuple[Structure, Structure],
    sides: list[xr.Dataset],
    ground: Ground,
    tolerance: Tolerance,
) -> tuple[xr.DataArray, ...]:
    """``rho``, the expected relative error of ``1 - rho``, and the share of nearness in it."""
    inputs = [[side[name] for name in OF_A_SIDE] for side in sides]
    known = insights(structures, sides, ground, tolerance)
    arrays = (*inputs[0], *known[0], *inputs[1], *known[1])
    return cellwise(_cells, *arrays, kinds=(float,) * 3)


@np.errstate(all="ignore")  # what comes of extreme input is judged by its status
def _cells(*inputs: Array) -> tuple[Array, ...]:
    def piece(*parts: Array) -> Array:
        half, own = len(parts) // 2, len(OF_A_SIDE)
        one, other = parts[:half], parts[half:]
        derived = pieces_of_rho(*one[:own], *other[:own])
        if half == own:
            return np.stack([derived, doubt_of(derived), 0 * derived])
        (seen_1, like_1), (seen_2, like_2) = insight_of(one[own:]), insight_of(other[own:])
        informed, unseen = derived, np.ones_like(derived)
        if seen_1 is not None and seen_2 is not None:
            informed, unseen = informed_correlation(derived, seen_1, seen_2), seen_1.left * seen_2.left
        rho, share, apart = with_nearness(informed, like_1, like_2, unseen)
        mean = (like_1.place + like_2.place)[1:] / 2
        doubt = doubt_of(rho, corrected(derived, informed), share, apart, *mean)
        return np.stack(np.broadcast_arrays(rho, doubt, share))

    return tuple(in_slabs(piece, *inputs, results=3))
