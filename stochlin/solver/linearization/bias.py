"""Bias of statistical linearization: its results against those of the drift closure.

The drift closure is corrected by a map of nonlinear simulations, and has an expected error of its own.
It is known for bilinear structures on the kinds of ground and in the ranges that were simulated.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.models.grounds import Ground
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.structures import DRIFT, Structure
from stochlin.solver.linearization.equivalent_systems import Law, Solved, solved_together
from stochlin.solver.linearization.tolerance import USUAL, Tolerance

STD = "displacement_std"
OFF = 0.1  # bias from which the caution of a cell is 1
EXPECTED = 0.05  # expected error above which an error of more than OFF is not rare


def judged(
    structures: Sequence[Structure], ground: Ground, closure: str, tolerance: Tolerance = USUAL
) -> Solved:
    """The responses by a closure with ``bias``, its expected error ``bias_error``, and ``caution``.

    The bias of ``displacement_std`` is 0 if a structure is elastic, and NaN if it is unknown.
    """
    solved = by_drift = solved_together(structures, ground, closure, tolerance)
    if closure == DRIFT:
        error = solved.values["displacement_error"]
        more = {"bias": 0 * error, "bias_error": error, "caution": caution_of(error, EXPECTED)}
    else:
        by_drift = _by_drift(solved, tolerance)
        more = _relative_bias(solved, by_drift)
    return solved._replace(values={**solved.values, **more}, by_drift=by_drift)


def _by_drift(solved: Solved, tolerance: Tolerance) -> Solved:
    """The bilinear structures by the drift closure; others stay elastic."""
    laws = [
        Law.of(table, DRIFT) if structure.yields and isinstance(structure, Bilinear) else None
        for structure, table in zip(solved.structures, solved.tables, strict=True)
    ]
    return solved.by_laws(laws, DRIFT, tolerance)


@np.errstate(all="ignore")  # failed cells are NaN
def _relative_bias(solved: Solved, by_drift: Solved) -> dict[str, Array]:
    """Relative error of the displacements; unknown where that of the drift closure is, 0 if elastic."""
    std, truth = (each.values[STD] for each in (solved, by_drift))
    error = by_drift.values["displacement_error"]
    bias = np.where(error == 0, 0.0, std / truth - 1) + 0 * (error + std)
    for structure, part in zip(solved.structures, solved.parts, strict=True):
        if structure.yields and not isinstance(structure, Bilinear):
            bias[part] = np.nan
    return {"bias": bias, "bias_error": error + 0 * bias, "caution": caution_of(bias)}


def caution_of(off: Array, most: float = OFF) -> Array:
    """Flag (int8) of a bias or of an expected error: 0 up to ``most``, 1 above, 2 unknown."""
    return np.asarray(np.int8(2) * np.isnan(off) + (np.abs(off) > most), np.int8)
