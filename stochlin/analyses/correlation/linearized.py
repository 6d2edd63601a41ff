"""Table of pairs by statistical linearization, with the errors of its correlations.

Each structure is solved over its own dimensions. The covariance of a pair then follows from one linear
equation.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stochlin.analyses.correlation.drift.pairs import SHOWN, checked_rho, drifting_rho
from stochlin.analyses.linearization.bias import bilinear_like, caution_of, relative_bias
from stochlin.analyses.linearization.equivalent_systems import (
    INTERNAL,
    solved_together,
    system_and_forcing,
)
from stochlin.analyses.linearization.tolerance import Tolerance
from stochlin.analyses.tables.cellwise import Cells, Solved, cellwise
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.slabs import by_slabs
from stochlin.kernels.linearization.covariance import pair_covariance
from stochlin.models.grounds import Ground
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.structures import DRIFT, Structure

SYSTEM = ("displacement_std", *INTERNAL, "status")
EQUAL = 1e-12  # difference of two correlations that is a rounding error
Pair = tuple[Structure, Structure]


def linearized_pairs(pair: Pair, ground: Ground, closure: str, tolerance: Tolerance) -> dict[str, Cells]:
    """Variables of `correlate` by linearization, except those of ``u_1 - u_2``."""
    sides = solved_together(pair, ground, closure, tolerance)
    arrays = [side[name] for side in sides for name in SYSTEM]
    rho, status = cellwise(_rho, *arrays, kinds=(float, np.int8))
    shown = {f"{name}_{n}": side[name] for name in SHOWN for n, side in enumerate(sides, start=1)}
    return {"rho": rho, **shown, "status": status}


@by_slabs(float, np.int8)
@np.errstate(all="ignore")  # cells with extreme parameters get a status
def _rho(*arrays: Array) -> tuple[Array, Array]:
    half = len(arrays) // 2
    (std_1, *system_1, status_1), (std_2, *system_2, status_2) = arrays[:half], arrays[half:]
    joint = pair_covariance(*system_and_forcing(system_1), *system_and_forcing(system_2))
    return checked_rho(joint / (std_1 * std_2), status_1, status_2)


def biases(pair: Pair, linearized: Solved, ground: Ground, tolerance: Tolerance) -> dict[str, Cells]:
    """Biases of ``rho`` and of both standard deviations, their expected errors, and the caution."""
    rho = linearized["rho"]
    truths: Sequence[Solved | None] = (None, None)
    true: Cells = np.nan
    error: Cells = np.nan
    if not any(structure.yields for structure in pair):
        true, error = rho, 0.0
    elif all(isinstance(structure, Bilinear) or not structure.yields for structure in pair):
        first, second = (like for structure in pair if (like := bilinear_like(structure)))
        truths = solved = solved_together((first, second), ground, DRIFT, tolerance)
        true, _, error, _, _ = drifting_rho((first, second), solved, ground, tolerance)
    bias, error = cellwise(_bias, rho, true, error, kinds=(float, float))
    table, cautions = {"bias": bias, "bias_error": error}, [caution_of(bias)]
    for n, (structure, truth) in enumerate(zip(pair, truths, strict=True), start=1):
        own = relative_bias(structure, linearized[f"displacement_std_{n}"], ground, tolerance, truth)
        cautions.append(own["caution"])
        table |= {f"{name}_{n}": own[name] for name in ("bias", "bias_error")}
    return table | {"caution": cellwise(_largest, *cautions, kinds=(np.int8,))[0]}


def _bias(rho: Array, true: Array, error: Array) -> tuple[Array, Array]:
    """Bias of ``rho`` and the error of the truth; both unknown where the latter is."""
    bias = np.where(np.abs(rho - true) < EQUAL, 0.0, rho - true) + 0 * error
    return bias, error + 0 * bias


def _largest(*arrays: Array) -> Array:
    return np.maximum.reduce(np.broadcast_arrays(*arrays))
