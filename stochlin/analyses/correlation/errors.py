"""Expected errors of pairs: of ``rho`` by the drift closure, and of the deviation of ``u_1 - u_2``.

Those of ``rho`` were measured on simulated pairs of unequal bilinear structures, by kind of ground and
by strength. The expected error of the standard deviation of ``u_1 - u_2`` follows from the errors of
both structures and of ``1 - rho``; the latter are so large that cautions protect the simulated pairs
of ``docs/drift.md``.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from stochlin.analyses.linearization.bias import EXPECTED, OFF, caution_of
from stochlin.analyses.tables.cellwise import Cells, cellwise
from stochlin.kernels.basics.arrays import Array
from stochlin.models.grounds import CloughPenzien, Ground, KanaiTajimi, WhiteNoise

NONE_LEFT = 1e-13  # value of 1 - rho below which it is rounding error, and taken as 0
# Errors by the smaller R/p of both structures: below the first bound, between them, above the last one.
BOUNDS = (0.5, 1.0, 2.0)
# Mean errors of rho: 89 pairs on white noise, 555 on Kanai-Tajimi and 556 on Clough-Penzien ground.
ERRORS = {
    WhiteNoise: np.array([0.02, 0.02, 0.04, 0.06]),
    KanaiTajimi: np.array([0.02, 0.03, 0.02, 0.03]),
    CloughPenzien: np.array([0.02, 0.03, 0.03, 0.04]),
}
# Expected relative errors of 1 - rho: of nearly equal structures, and of all others, as a share of rho.
OF_NEARLY_EQUAL, OF_OTHERS = np.array([0.14, 0.10, 0.06, 0.05]), 0.18
DIFFERENCE = "relative_displacement"  # start of the names of variables
SAFE_SIDE = 0.06  # relative bias, on the safe side, of u_1 - u_2 of nearly equal structures by eq. (13)


def errors_on(ground: Ground) -> Array:
    """Mean errors of ``rho`` on this kind of ground; NaN where no pairs were simulated."""
    return ERRORS.get(type(ground), np.full(len(BOUNDS) + 1, np.nan))


def mean_error(errors: Array, strength_1: Array, strength_2: Array) -> Array:
    """The entry of `errors_on` for the smaller R/p of both structures."""
    return np.asarray(errors[np.searchsorted(BOUNDS, np.minimum(strength_1, strength_2), side="right")])


def doubt_of(rho: Array, share: Array, strength_1: Array, strength_2: Array) -> Array:
    """Expected relative error of ``1 - rho``; ``share`` is the weight of eq. (13)."""
    near = mean_error(OF_NEARLY_EQUAL, strength_1, strength_2)
    return np.asarray(share * near + (1 - share) * OF_OTHERS * np.maximum(rho, 0))


@np.errstate(all="ignore")  # equal structures give 0/0, invalid cells are NaN
def relative_error(
    std_1: Array,
    error_1: Array,
    std_2: Array,
    error_2: Array,
    rho: Array,
    doubt: Array,
    share: Array | float = 0.0,
) -> tuple[Array, Array]:
    """Expected relative error of the standard deviation of ``u_1 - u_2``, and its relative bias.

    It combines the relative errors of both standard deviations and of ``1 - rho`` (``doubt``) as if they
    were independent. ``share`` is the weight of eq. (13) for nearly equal structures, which is biased to
    the safe side.
    """
    joint = std_1 * std_2 * _left(rho)
    square = (std_1 - std_2) ** 2 + 2 * joint
    shares = (std_1 * (std_1 - std_2) + joint, std_2 * (std_2 - std_1) + joint, joint)
    parts = [slope / square * off for slope, off in zip(shares, (error_1, error_2, doubt), strict=True)]
    error, bias = np.sqrt(sum(part**2 for part in parts)), SAFE_SIDE * share * 2 * joint / square
    equal = np.isfinite(error_1) & np.isfinite(error_2) & (square == 0)
    return np.where(equal, 0.0, error), np.where(equal, 0.0, bias)


def difference(table: Mapping[Any, Cells]) -> dict[str, Cells]:
    """Standard deviation of ``u_1 - u_2`` of a table of pairs, with its bias and its caution.

    Bias and caution follow from the standard errors in the table, or else from its biases; without
    either they are unknown. A table of the drift closure already has them.
    """
    names = ("displacement_std_1", "displacement_std_2", "rho")
    values = [table[name] for name in names]
    if f"{DIFFERENCE}_bias" in table:
        return {f"{DIFFERENCE}_std": cellwise(_difference, *values)[0]}
    if "rho_standard_error" in table:
        shares = [table[f"displacement_std_standard_error_{n}"] / values[n - 1] for n in (1, 2)]
        doubt = table["rho_standard_error"] / (1 - table["rho"])
        of_sides = (values[0], shares[0], values[1], shares[1])
        error, bias = cellwise(relative_error, *of_sides, values[2], doubt, kinds=(float, float))
        std, off, most = cellwise(_difference, *values)[0], error, EXPECTED
    else:
        biases = [table.get(name, np.nan) for name in ("bias_1", "bias_2", "bias")]
        std, bias = cellwise(_with_bias, *values, *biases, kinds=(float, float))
        off, most = bias, OFF
        std = table.get(f"{DIFFERENCE}_std", std)  # a building with storeys has it already
    (flag,) = cellwise(caution_of, off, kinds=(np.int8,), most=most)
    return {f"{DIFFERENCE}_std": std, f"{DIFFERENCE}_bias": bias, f"{DIFFERENCE}_caution": flag}


def _difference(std_1: Array, std_2: Array, rho: Array) -> Array:
    return np.hypot(std_1 - std_2, np.sqrt(2 * _left(rho)) * np.sqrt(std_1) * np.sqrt(std_2))


@np.errstate(all="ignore")  # failed cells are NaN
def _with_bias(
    std_1: Array, std_2: Array, rho: Array, bias_1: Array, bias_2: Array, bias: Array
) -> tuple[Array, Array]:
    """Standard deviation of ``u_1 - u_2``, and its relative bias from those of both and of ``rho``."""
    std = _difference(std_1, std_2, rho)
    truth = _difference(std_1 / (1 + bias_1), std_2 / (1 + bias_2), np.clip(rho - bias, -1, 1))
    equal = (std == 0) & (truth <= np.sqrt(2 * NONE_LEFT) * std_1)  # but for rounding errors
    return std, np.where(equal, 0.0, std / truth - 1)


def _left(rho: Array) -> Array:
    """``1 - rho``, and 0 where it is as small as rounding errors."""
    return np.where(1 - rho < NONE_LEFT, 0.0, 1 - rho)
