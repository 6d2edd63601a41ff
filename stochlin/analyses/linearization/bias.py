"""Bias of statistical linearization: its results against those of the drift closure.

The drift closure is corrected by a map of nonlinear simulations, and has an expected error of its own.
It is known for bilinear structures on the kinds of ground and in the ranges that were simulated.
"""

from __future__ import annotations

import numpy as np

from stochlin.analyses.linearization.equivalent_systems import solved_together
from stochlin.analyses.linearization.tolerance import Tolerance
from stochlin.analyses.tables.cellwise import Cells, Solved, cellwise
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.slabs import by_slabs
from stochlin.models.grounds import Ground
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.laws.bouc_wen import BoucWen
from stochlin.models.structures import DRIFT, GAUSSIAN, Structure

STD = "displacement_std"
OFF = 0.1  # bias from which the caution of a cell is 1
EXPECTED = 0.05  # expected error above which an error of more than OFF is not rare
# Of Bouc-Wen structures: beta and exponents n that were simulated, and the fitted share of the bias of
# bilinear structures, n/(n + ROUNDED beta).
BETA, SHARPEST, ROUNDED = (0.3, 0.9), 5.0, 1.5


def bilinear_like(structure: Structure) -> Bilinear | None:
    """The bilinear structure whose drift closure is the truth for this one; None if there is none.

    That of a Bouc-Wen structure has the same period, damping, hardening and strength.
    """
    if isinstance(structure, Bilinear):
        return structure
    if structure.yields and not isinstance(structure, BoucWen):
        return None
    return Bilinear(**{name: getattr(structure, name) for name in Structure.parameter_names()})


def relative_bias(
    structure: Structure,
    std: Cells,
    ground: Ground,
    tolerance: Tolerance,
    truth: Solved | None = None,
) -> dict[str, Cells]:
    """``bias`` of a displacement's ``std``, its expected error ``bias_error``, and its ``caution``.

    The bias is 0 if the structure is elastic, and NaN if it is unknown. ``truth`` are the results of
    `bilinear_like` by the drift closure, if they are at hand.
    """
    near = bilinear_like(structure)
    if near is None or not structure.yields:
        (bias,) = cellwise(_where_solved, std, np.nan if structure.yields else 0.0)
        return {"bias": bias, "bias_error": bias, "caution": caution_of(bias)}
    if truth is None:
        (truth,) = solved_together((near,), ground, DRIFT, tolerance)
    true = truth[STD], truth["displacement_error"]
    bias, error = cellwise(_relative, std, *true, kinds=(float, float))
    if near is structure:
        return {"bias": bias, "bias_error": error, "caution": caution_of(bias)}
    (gaussian,) = solved_together((near,), ground, GAUSSIAN, tolerance)
    of_near, _ = cellwise(_relative, gaussian[STD], *true, kinds=(float, float))
    law = (structure.cells()[name] for name in ("beta", "gamma", "exponent"))
    bias, larger, error = cellwise(_of_bouc_wen, of_near, bias, *law, kinds=(float,) * 3)
    return {"bias": bias, "bias_error": error, "caution": caution_of(larger)}


def caution_of(bias: Cells) -> Cells:
    """Flag (int8) of a bias: 0 up to `OFF`, 1 above, 2 unknown."""
    return cellwise(_caution, bias, kinds=(np.int8,), most=OFF)[0]


def caution_of_error(error: Cells) -> Cells:
    """Flag (int8) of an expected error: 0 up to `EXPECTED`, 1 above, 2 unknown."""
    return cellwise(_caution, error, kinds=(np.int8,), most=EXPECTED)[0]


@by_slabs(np.int8)
def _caution(off: Array, *, most: float) -> Array:
    return np.asarray(np.int8(2) * np.isnan(off) + (np.abs(off) > most))


def _where_solved(std: Array, known: Array) -> Array:
    return np.where(np.isnan(std), np.nan, known)


def _relative(std: Array, truth: Array, error: Array) -> tuple[Array, Array]:
    """Relative error of ``std``, and that of the truth; unknown where the latter is, 0 if elastic."""
    bias = np.where(error == 0, 0.0, std / truth - 1) + 0 * error
    return bias, error + 0 * bias


@np.errstate(invalid="ignore")
def _of_bouc_wen(
    of_near: Array, equal: Array, beta: Array, gamma: Array, n: Array
) -> tuple[Array, Array, Array]:
    """Bias of Bouc-Wen structures, what counts in the caution, and its unknown error.

    They follow from two estimates: the bias ``of_near``, and the error if the true standard deviations
    of both are ``equal``. The bias is a share of the smaller one; the caution is that of the same share
    of the larger one.
    """
    smaller = np.where(np.abs(of_near) < np.abs(equal), of_near, equal)
    larger = np.maximum(np.abs(of_near), np.abs(equal))
    simulated = (
        (beta >= BETA[0]) & (beta <= BETA[1]) & (n <= SHARPEST) & (np.abs(beta + gamma - 1) < 1e-9)
    )
    share = np.where(simulated, n / (n + ROUNDED * beta), np.nan)
    return share * smaller, share * larger, np.nan * larger
