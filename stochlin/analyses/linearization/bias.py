"""Bias of statistical linearization: its results against those of the drift closure.

The drift closure is corrected by a map of nonlinear simulations, and has an expected error of its own.
It is known for bilinear structures on the kinds of ground and in the ranges that were simulated.
"""

from __future__ import annotations

from functools import cache

import numpy as np

from stochlin.analyses.linearization.drift_map import with_correction
from stochlin.analyses.linearization.equivalent_systems import Law, Solved, solve_oscillators
from stochlin.analyses.linearization.tolerance import Tolerance
from stochlin.kernels.basics.arrays import Array
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.laws.bouc_wen import BoucWen
from stochlin.models.structures import DRIFT, GAUSSIAN

STD = "displacement_std"
OFF = 0.1  # bias from which the caution of a cell is 1
EXPECTED = 0.05  # expected error above which an error of more than OFF is not rare
# Of Bouc-Wen structures: beta and exponents n that were simulated, and the fitted share of the bias of
# bilinear structures, n/(n + ROUNDED beta).
BETA, SHARPEST, ROUNDED = (0.3, 0.9), 5.0, 1.5
OF_LAW = ("beta", "gamma", "exponent")


def judged(solved: Solved, closure: str, tolerance: Tolerance) -> Solved:
    """The responses by a closure with ``bias``, its expected error ``bias_error``, and ``caution``."""
    if closure == DRIFT:
        error = solved.values["displacement_error"]
        more = {"bias": 0 * error, "bias_error": error, "caution": caution_of(error, EXPECTED)}
    else:
        more = relative_bias(solved, bilinear_like(solved, DRIFT, tolerance), tolerance)
    return solved._replace(values={**solved.values, **more})


def bilinear_like(solved: Solved, closure: str, tolerance: Tolerance) -> Solved:
    """The structures by another closure of the bilinear law, Bouc-Wen structures as bilinear ones.

    The bilinear structures have the same period, damping, hardening and strength. Structures of other
    laws stay elastic.
    """
    cells = np.arange(solved.oscillators.period.size)
    like = [
        cells[part]
        for structure, part in zip(solved.structures, solved.parts, strict=True)
        if structure.yields and isinstance(structure, Bilinear | BoucWen)
    ]
    at = np.concatenate([cells[:0], *like])
    law = Law(at, np.empty((0, at.size)), np.ones(at.size, bool), Bilinear.closures[closure])
    own = solved.oscillators, [law] if at.size else [], solved.ground, tolerance, closure == DRIFT
    other = solved._replace(values=solve_oscillators(*own, parts=solved.parts))
    if closure != DRIFT:
        return other
    corrected = with_correction(solved.ground, other.point, other.oscillators.soil, other.values)
    return other._replace(values=corrected)


def relative_bias(solved: Solved, truth: Solved, tolerance: Tolerance) -> dict[str, Array]:
    """``bias`` of ``displacement_std``, its expected error ``bias_error``, and its ``caution``.

    The bias is 0 if a structure is elastic, and NaN if it is unknown. ``truth`` is `bilinear_like`.
    """
    true = truth.values[STD], truth.values["displacement_error"]
    bias, error = _relative(solved.values[STD], *true)
    counted = bias.copy()
    of_bilinear = cache(lambda: bilinear_like(solved, GAUSSIAN, tolerance).values[STD])
    for structure, table, part in zip(solved.structures, solved.tables, solved.parts, strict=True):
        if isinstance(structure, BoucWen) and structure.yields:
            of_near, _ = _relative(of_bilinear()[part], *(row[part] for row in true))
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
