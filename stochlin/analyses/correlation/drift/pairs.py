"""Correlation of pairs by the drift closure: derived, then corrected by a map of simulations."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stochlin.analyses.correlation.drift.derived import LENGTH, side_from, side_of
from stochlin.analyses.correlation.drift.signatures import insight_of, insights
from stochlin.analyses.correlation.errors import (
    DIFFERENCE,
    doubt_of,
    expected_rho_error,
    relative_error,
)
from stochlin.analyses.linearization.bias import caution_of, caution_of_error
from stochlin.analyses.linearization.equivalent_systems import solved_together
from stochlin.analyses.linearization.linearization import known_error
from stochlin.analyses.linearization.tolerance import Tolerance
from stochlin.analyses.tables import labels
from stochlin.analyses.tables.cellwise import Cells, Solved, cellwise
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.slabs import by_slabs
from stochlin.kernels.correlation.nearness import with_nearness
from stochlin.kernels.correlation.signatures import informed_correlation
from stochlin.kernels.linearization.drift import drifting_correlation
from stochlin.models.grounds import Ground
from stochlin.models.structures import DRIFT, Structure


def drifting_pairs(
    first: Structure, second: Structure, ground: Ground, tolerance: Tolerance
) -> dict[str, Cells]:
    """Table of pairs by the drift closure, with the expected errors that remain after the correction."""
    sides = solved_together((first, second), ground, DRIFT, tolerance)
    rho, status, error, doubt, share = drifting_rho((first, second), sides, ground, tolerance)
    table = {"rho": rho, "status": status, "rho_error": error}
    table["bias"], worst = 0 * error, caution_of(error)
    for number, side in enumerate(sides, start=1):
        table |= {f"{name}_{number}": side[name] for name in SHOWN}
        own = known_error(side)
        table[f"bias_{number}"] = 0 * own
        (worst,) = cellwise(np.maximum, worst, caution_of_error(own), kinds=(np.int8,))
    of_sides = [side[name] for side in sides for name in ("displacement_std", "displacement_error")]
    periods = [structure.cells()["period"] for structure in (first, second)]
    of_pair = *of_sides, rho, doubt, share, error
    apart, lean, unsafe = cellwise(_difference_error, *periods, *of_pair, kinds=(float,) * 3)
    table |= {f"{DIFFERENCE}_error": apart, f"{DIFFERENCE}_bias": lean}
    return table | {f"{DIFFERENCE}_caution": caution_of_error(unsafe), "caution": worst}


def drifting_rho(
    structures: tuple[Structure, Structure],
    sides: Sequence[Solved],
    ground: Ground,
    tolerance: Tolerance,
) -> tuple[Cells, ...]:
    """``rho``, status and expected error of pairs that were solved with the drift closure.

    Then follow the expected relative error of ``1 - rho``, and the weight of eq. (13) for nearly equal
    pairs.
    """
    own = [side_of(side) for side in sides]
    known = insights(structures, sides, own, ground, tolerance)
    arrays = *own[0], *known[0], *own[1], *known[1]
    raw, doubt, share = cellwise(_rho, *arrays, kinds=(float,) * 3)
    expected = expected_rho_error(*structures, ground, sides)
    statuses = (side["status"] for side in sides)
    rho, status, error = cellwise(_checked, raw, *statuses, expected, kinds=(float, np.int8, float))
    return rho, status, error, doubt, share


SHOWN = ("displacement_std", "ductility_std", "yield_displacement")
ROUNDING = 1e-9  # by which |rho| may exceed 1 by rounding; beyond it the covariance is invalid
# Logarithm of the ratio of the periods from which the margin of eq. (13) counts in the caution. Of pairs
# with more similar periods, the difference comes from strength, hardening and damping alone, and its
# estimate is less certain.
ALIKE = 0.015


def checked_rho(rho: Array, status_1: Array, status_2: Array) -> tuple[Array, Array]:
    """``rho`` of pairs, NaN where one side failed or its size exceeds 1, and the status."""
    status = np.maximum(status_1, status_2)
    wrong = (status < labels.NOT_CONVERGED) & ~(np.abs(rho) <= 1 + ROUNDING)
    status = np.where(wrong, labels.NOT_PHYSICAL, status)
    return np.where(status < labels.NOT_CONVERGED, np.clip(rho, -1, 1), np.nan), status


@by_slabs(float, np.int8, float)
def _checked(raw: Array, status_1: Array, status_2: Array, expected: Array) -> tuple[Array, ...]:
    rho, status = checked_rho(raw, status_1, status_2)
    return rho, status, np.where(np.isnan(rho), np.nan, expected)


@by_slabs(float, float, float)
@np.errstate(all="ignore")  # failed cells are NaN
def _difference_error(period_1: Array, period_2: Array, *arrays: Array) -> tuple[Array, ...]:
    """`relative_error` of pairs, and the part of the error that counts in the caution.

    That part is the error less half of the bias to the safe side, if the periods differ. They are NaN
    where ``rho_error``, the last array, is NaN, and 0 if both structures are elastic.
    """
    *of_pair, rho_error = arrays
    error, bias = relative_error(*of_pair)
    error = np.where(np.isnan(rho_error), np.nan, error)
    error = np.where(rho_error == 0, 0.0, error)
    bias = np.where(np.isnan(error), np.nan, bias)
    unlike = np.abs(np.log(period_1 / period_2)) >= ALIKE
    return error, bias, error - np.where(unlike, bias / 2, 0.0)


@by_slabs(float, float, float)
@np.errstate(all="ignore")  # cells with extreme parameters become NaN, with a status
def _rho(*inputs: Array) -> tuple[Array, ...]:
    """``rho`` of pairs, expected relative error of ``1 - rho``, and weight of eq. (13)."""
    half = len(inputs) // 2
    of_first, of_second = inputs[:half], inputs[half:]
    derived = drifting_correlation(*(side_from(part[:LENGTH]) for part in (of_first, of_second)))
    if half == LENGTH:
        none = np.zeros_like(derived)
        return derived, doubt_of(derived, none, none, none), none
    (seen_1, like_1), (seen_2, like_2) = insight_of(of_first[LENGTH:]), insight_of(of_second[LENGTH:])
    informed, unseen = derived, np.ones_like(derived)
    if seen_1 is not None and seen_2 is not None:
        informed, unseen = informed_correlation(derived, seen_1, seen_2), seen_1.left * seen_2.left
    rho, share = with_nearness(informed, like_1, like_2, unseen)
    return rho, doubt_of(rho, share, *(np.exp(like.place[1]) for like in (like_1, like_2))), share
