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
from stochlin.models.laws.bouc_wen import BoucWen
from stochlin.models.structures import DRIFT, GAUSSIAN, Structure
from stochlin.solver.linearization.equivalent_systems import Law, Solved, solved_together
from stochlin.solver.linearization.tolerance import USUAL, Tolerance

STD = "displacement_std"
OFF = 0.1  # bias from which the caution of a cell is 1
EXPECTED = 0.05  # expected error above which an error of more than OFF is not rare
# Of Bouc-Wen structures: beta and exponents n that were simulated, and the fitted share of the bias of
# bilinear structures, n/(n + ROUNDED beta).
BETA, SHARPEST, ROUNDED = (0.3, 0.9), 5.0, 1.5
OF_LAW = ("beta", "gamma", "exponent")


def judged(
    structures: Sequence[Structure], ground: Ground, closure: str, tolerance: Tolerance = USUAL
) -> Solved:
    """The responses by a closure with ``bias``, its expected error ``bias_error``, and ``caution``.

    The bias of ``displacement_std`` is 0 if a structure is elastic, and NaN if it is unknown.
    """
    solved = solved_together(structures, ground, closure, tolerance)
    if closure == DRIFT:
        error = solved.values["displacement_error"]
        more = {"bias": 0 * error, "bias_error": error, "caution": caution_of(error, EXPECTED)}
        return solved._replace(values={**solved.values, **more}, by_drift=solved)
    by_drift = _like_bilinear(solved, DRIFT, tolerance)
    more = _relative_bias(solved, by_drift, tolerance)
    return solved._replace(values={**solved.values, **more}, by_drift=by_drift)


def _like_bilinear(solved: Solved, closure: str, tolerance: Tolerance) -> Solved:
    """Bilinear structures, and those of the same strength as Bouc-Wen structures; others are elastic."""
    laws = [
        Law.bilinear(table.where.size, closure)
        if structure.yields and isinstance(structure, Bilinear | BoucWen)
        else None
        for structure, table in zip(solved.structures, solved.tables, strict=True)
    ]
    return solved.by_laws(laws, closure, tolerance)


def _relative_bias(solved: Solved, by_drift: Solved, tolerance: Tolerance) -> dict[str, Array]:
    true = [by_drift.values[name] for name in (STD, "displacement_error")]
    bias, error = _relative(solved.values[STD], *true)
    counted = bias.copy()
    for structure, table, part in zip(solved.structures, solved.tables, solved.parts, strict=True):
        if isinstance(structure, BoucWen) and structure.yields:
            near = _like_bilinear(solved, GAUSSIAN, tolerance).values[STD][part]
            of_near, _ = _relative(near, *(row[part] for row in true))
            law = (np.asarray(table.models["structure"].cells()[name]) for name in OF_LAW)
            bias[part], counted[part] = _of_bouc_wen(of_near, bias[part], *law)
            error[part] = np.nan
        elif structure.yields and not isinstance(structure, Bilinear):
            bias[part] = error[part] = counted[part] = np.nan
    return {"bias": bias, "bias_error": error, "caution": caution_of(counted)}


def caution_of(off: Array, most: float = OFF) -> Array:
    """Flag (int8) of a bias or of an expected error: 0 up to ``most``, 1 above, 2 unknown."""
    return np.asarray(np.int8(2) * np.isnan(off) + (np.abs(off) > most), np.int8)


@np.errstate(all="ignore")  # failed cells are NaN
def _relative(std: Array, truth: Array, error: Array) -> tuple[Array, Array]:
    """Relative error of ``std``, and that of the truth; unknown where the latter is, 0 if elastic."""
    bias = np.where(error == 0, 0.0, std / truth - 1) + 0 * (error + std)
    return bias, error + 0 * bias


@np.errstate(invalid="ignore")
def _of_bouc_wen(
    of_near: Array, equal: Array, beta: Array, gamma: Array, n: Array
) -> tuple[Array, Array]:
    """Bias of Bouc-Wen structures, and what counts in the caution.

    They follow from two estimates: the bias ``of_near``, and the error if the true standard deviations
    of both are ``equal``. The bias is a share of the smaller one; the caution is that of the same share
    of the larger one.
    """
    smaller = np.where(np.abs(of_near) < np.abs(equal), of_near, equal)
    larger = np.maximum(np.abs(of_near), np.abs(equal))
    known = (beta >= BETA[0]) & (beta <= BETA[1]) & (n <= SHARPEST) & (np.abs(beta + gamma - 1) < 1e-9)
    share = np.where(known, n / (n + ROUNDED * beta), np.nan)
    return share * smaller, share * larger
