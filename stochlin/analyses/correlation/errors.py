"""Expected errors of pairs: of ``rho`` by the drift closure, and of the deviation of ``u_1 - u_2``.

The expected errors of ``rho`` are mean absolute errors over 2750 random pairs of unequal bilinear
structures, drawn and simulated; rounded to 0.01. The
expected error of the standard deviation of ``u_1 - u_2`` follows from the errors of both structures and
of ``1 - rho``; the latter is larger where the map of simulations corrects ``1 - rho`` more.
``docs/drift.md`` has the calibration.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stochlin.analyses.linearization.bias_map import caution_of_error, point_of
from stochlin.analyses.linearization.drift_map import CORRECTED_GROUNDS, checked
from stochlin.analyses.tables.cellwise import Cells, Solved, cellwise
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.slabs import by_slabs
from stochlin.kernels.correlation.differences import NONE_LEFT, differences
from stochlin.models.grounds import CloughPenzien, Ground, KanaiTajimi, WhiteNoise
from stochlin.models.structures import Structure

# Bounds of the regions: the shorter T/Tg of the pair, and the damping ratio of the ground.
PERIODS, GROUND_DAMPINGS = (0.1, 0.2, 0.5, 0.9, 10.0), (0.03, 0.1, 0.3, 1.0)
# Mean errors of rho by PERIODS, and within each by GROUND_DAMPINGS; Clough-Penzien from 9115 pairs, and
# the shortest periods from 69 pairs.
ERRORS = {
    KanaiTajimi: np.array([0.05, 0.07, 0.04, 0.04, 0.03, 0.02, 0.03, 0.02, 0.02, 0.02, 0.02, 0.02]),
    CloughPenzien: np.array([0.05, 0.07, 0.04, 0.05, 0.04, 0.03, 0.04, 0.02, 0.02, 0.04, 0.03, 0.03]),
}
NOWHERE = np.full(12, np.nan)
ON_WHITE_NOISE = np.full(1, 0.03)
DIFFERENCE = "relative_displacement"  # start of the names of variables
# Expected relative error of 1 - rho, in general: it is proportional to rho, and to the correction of
# log(1 - rho) by the signatures.
BY_RHO, BY_SIGNATURES = 0.14, 0.25
# The same for nearly equal structures, corrected by eq. (13) of docs/drift.md: its value at R/p = 1, the
# exponent with which it grows for smaller R/p, and its ratio to the correction of log(1 - rho).
OF_NEAR, BY_WEAKNESS, BY_NEARNESS = 0.06, 0.75, 0.15
SAFE_SIDE = 0.06  # relative bias, on the safe side, of u_1 - u_2 of nearly equal structures by eq. (13)
# Ranges of R/p and of hardening over which the error of nearly equal structures doubles: the map has no
# values there and uses those of the next larger hardening.
WEAK, SOFT = (0.8, 0.5), (0.05, 0.02)
BY_DAMPING, USUAL_DAMPING = 0.35, np.log(0.03)  # exponent with which the error grows for less damping


def expected_rho_error(
    first: Structure, second: Structure, ground: Ground, sides: Sequence[Solved]
) -> Cells:
    """Mean absolute error of ``rho`` in the region of each pair.

    It is 0 if both structures are elastic, and NaN where no pairs were simulated.
    """
    white = isinstance(ground, WhiteNoise)
    values = ON_WHITE_NOISE if white else ERRORS.get(type(ground), NOWHERE)
    arrays: list[Cells] = []
    for structure, side in zip((first, second), sides, strict=True):
        region: tuple[Cells, ...] = (-1,)
        if type(ground) in CORRECTED_GROUNDS:
            place = point_of(structure, ground, side)
            inside = checked(ground, place)
            region = cellwise(_region, inside, *place[3:], kinds=(np.int8,))
        arrays += [*region, np.isinf(side["yield_displacement"])]
    (error,) = cellwise(_error, *arrays, values=values)
    return error


@np.errstate(invalid="ignore")  # invalid cells have no region
def _region(inside: Array, *soil: Array) -> Array:
    """Number of a structure's region by damping and period of the ground, -1 outside."""
    if not soil:
        return np.where(inside, 0, -1).astype(np.int8)
    ground_damping, ratio = soil
    band = (len(GROUND_DAMPINGS) - 1) * _band(ratio, PERIODS) + _band(ground_damping, GROUND_DAMPINGS)
    return np.where(inside, band, -1).astype(np.int8)


@by_slabs(float)
def _error(
    region_1: Array, elastic_1: Array, region_2: Array, elastic_2: Array, *, values: Array
) -> Array:
    # Both structures share the damping of the ground, so that the smaller number is that of the shorter
    # period, or -1 if one of them is outside.
    error = np.append(values, np.nan)[np.minimum(region_1, region_2)]
    return np.asarray(np.where(elastic_1 & elastic_2, 0.0, error))


def _band(value: Array, edges: tuple[float, ...]) -> Array:
    return np.searchsorted(edges[1:-1], value, side="right")


def corrected(derived: Array, informed: Array) -> Array:
    """Correction of ``log(1 - rho)`` by the signatures, from the derived and the corrected ``rho``."""
    moved = np.log((1 - derived) / (1 - informed))
    return np.asarray(np.where(np.isfinite(moved), moved, 0.0))


def doubt_of(
    rho: Array,
    moved: Array | float = 0.0,
    share: Array | float = 0.0,
    apart: Array | float = 0.0,
    strength: Array | float = 0.0,
    hardening: Array | float = 0.0,
    damping: Array | float = USUAL_DAMPING,
) -> Array:
    """Expected relative error of ``1 - rho``.

    ``moved`` and ``apart`` are the corrections of ``log(1 - rho)`` by the signatures, eq. (11), and by
    eq. (13) for nearly equal structures, and ``share`` is the weight of the latter. ``strength``,
    ``hardening`` and ``damping`` are means over both structures of the logarithms of R/p, of the
    hardening ratio and of the damping ratio.
    """
    near = np.where(share > 0, share * OF_NEAR * np.exp(-BY_WEAKNESS * strength), 0.0)
    left_out = _towards(strength, WEAK) * _towards(hardening, SOFT)
    near = near * (1 + left_out)
    of_any = (1 - share) * BY_RHO * np.maximum(rho, 0) + near
    of_any = of_any * np.exp(BY_DAMPING * (USUAL_DAMPING - damping))
    return np.sqrt(of_any**2 + (BY_SIGNATURES * moved) ** 2 + (BY_NEARNESS * apart) ** 2)


def _towards(logarithm: Array | float, ends: tuple[float, float]) -> Array:
    """Position between two values on a logarithmic scale, 0 at the first and 1 at the second."""
    begin, end = np.log(ends)
    return np.clip((logarithm - begin) / (end - begin), 0, 1)


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


def difference(table: Solved) -> dict[str, Cells]:
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
        std, flag = *cellwise(_difference, *values), caution_of_error(error)
    else:
        biases = [table.get(name, np.nan) for name in ("bias_1", "bias_2", "bias")]
        kinds = (float, float, np.int8)
        std, bias, flag = cellwise(_differences, *values, *biases, kinds=kinds)
        std = table.get(f"{DIFFERENCE}_std", std)  # a building with storeys has it already
    return {f"{DIFFERENCE}_std": std, f"{DIFFERENCE}_bias": bias, f"{DIFFERENCE}_caution": flag}


@by_slabs(float)
def _difference(std_1: Array, std_2: Array, rho: Array) -> Array:
    return np.hypot(std_1 - std_2, np.sqrt(2 * _left(rho)) * np.sqrt(std_1) * np.sqrt(std_2))


def _left(rho: Array) -> Array:
    """``1 - rho``, and 0 where it is as small as rounding errors."""
    return np.where(1 - rho < NONE_LEFT, 0.0, 1 - rho)


@np.errstate(all="ignore")  # failed cells are NaN
def _differences(*inputs: Array) -> tuple[Array, ...]:
    return differences(*inputs)
