"""Expected errors of a pair in ``rho`` by the drift closure and in the deviation of ``u_1 - u_2``.

Those of ``rho`` were measured on simulated pairs of unequal bilinear structures, by kind of ground
and by strength. The expected error of the standard deviation of ``u_1 - u_2`` follows from the
errors of both structures and of ``1 - rho``; the latter are so large that cautions protect the
simulated pairs of ``docs/drift.md``.
"""

from __future__ import annotations

import numpy as np

from stochlin.kernels.basics.arrays import Array

# Value of 1 - rho, and relative difference of two deviations, below which it is a rounding error
ROUNDING_OF_DIFFERENCES = 1e-13
# Errors by the smaller R/p of both structures: below the first bound, between them, above the last
# one.
BOUNDS = np.array([0.5, 1.0, 2.0])
# Expected relative errors of 1 - rho: of nearly equal structures, and of all others, as a share of
# rho.
ERRORS_OF_NEARLY_EQUAL = np.array([0.14, 0.10, 0.06, 0.05])
ERROR_OF_OTHERS = 0.18
# relative bias, on the safe side, of u_1 - u_2 of nearly equal structures by eq. (13)
SAFE_SIDE = 0.06


def std_of_difference(std_1: Array, std_2: Array, rho: Array) -> Array:
    """Standard deviation of ``u_1 - u_2``."""
    return np.sqrt(_apart(std_1, std_2) ** 2 + 2 * std_1 * std_2 * _left(rho))


def error_of_difference(
    std_1: Array,
    error_1: Array,
    std_2: Array,
    error_2: Array,
    rho: Array,
    error: Array,
    share: Array,
) -> tuple[Array, Array]:
    """Expected relative error of the standard deviation of ``u_1 - u_2``, and its relative bias.

    It combines the relative errors of both standard deviations and of ``1 - rho`` (``error``) as if
    they were independent. ``share`` is the weight of eq. (13) for nearly equal structures, which is
    biased to the safe side.
    """
    joint = std_1 * std_2 * _left(rho)
    apart = _apart(std_1, std_2)
    square = apart**2 + 2 * joint
    part_1 = (joint + std_1 * apart) / square * error_1
    part_2 = (joint - std_2 * apart) / square * error_2
    part_3 = joint / square * error
    total = np.sqrt(part_1**2 + part_2**2 + part_3**2)
    bias = SAFE_SIDE * share * 2 * joint / square
    equal = np.isfinite(error_1) & np.isfinite(error_2) & (square == 0)
    return np.where(equal, 0.0, total), np.where(equal, 0.0, bias)


def bias_of_difference(
    std: Array, std_1: Array, std_2: Array, bias_1: Array, bias_2: Array, rho: Array, bias: Array
) -> Array:
    """Relative bias of ``std``, that of ``u_1 - u_2``, from those of both and that of ``rho``."""
    true_rho = np.clip(rho - bias, -1.0, 1.0)
    truth = std_of_difference(std_1 / (1 + bias_1), std_2 / (1 + bias_2), true_rho)
    rounding = np.sqrt(2 * ROUNDING_OF_DIFFERENCES) * std_1
    equal = (std == 0) & (truth <= rounding)
    return np.where(equal, 0.0, std / truth - 1)


def _apart(std_1: Array, std_2: Array) -> Array:
    """``std_1 - std_2``, and 0 where it is as small as rounding errors."""
    apart = std_1 - std_2
    return np.where(np.abs(apart) < ROUNDING_OF_DIFFERENCES * std_1, 0.0, apart)


def _left(rho: Array) -> Array:
    """``1 - rho``, and 0 where it is as small as rounding errors."""
    return np.where(1 - rho < ROUNDING_OF_DIFFERENCES, 0.0, 1 - rho)
