"""Correlation of pairs by the drift closure: derived, then corrected by a map of simulations."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stochlin.analyses.correlation.drift.derived import OF_A_SIDE, rho_of_drifts
from stochlin.analyses.correlation.drift.signatures import insight_of, insights
from stochlin.analyses.correlation.errors import (
    DIFFERENCE,
    doubt_of,
    expected_rho_error,
    relative_error,
)
from stochlin.analyses.correlation.linearized import SHOWN, linearized_pairs
from stochlin.analyses.linearization.bias_map import caution_of, caution_of_error
from stochlin.analyses.linearization.equivalent_systems import solved_together
from stochlin.analyses.linearization.linearization import known_error
from stochlin.analyses.linearization.tolerance import Tolerance
from stochlin.analyses.tables import labels
from stochlin.analyses.tables.cellwise import Cells, Solved, cellwise
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.slabs import by_slabs
from stochlin.kernels.correlation.nearness import with_nearness
from stochlin.kernels.correlation.signatures import informed_correlation
from stochlin.models.grounds import Ground
from stochlin.models.structures import DRIFT, Structure


def drifting_pairs(
    first: Structure, second: Structure, ground: Ground, tolerance: Tolerance
) -> dict[str, Cells]:
    """Table of pairs by the drift closure, with the variables of `linearized_pairs` and their errors.

    The simulated ``rho`` that the bias refers to is the Gaussian ``rho`` less its bias in the map. If it
    is not in the map, the caution follows from the expected error of ``rho`` instead.
    """
    table = linearized_pairs(first, second, ground, "gaussian", tolerance)
    truth = table["rho"] - table["bias"]
    sides = solved_together((first, second), ground, DRIFT, tolerance)
    raw, doubt, share = _rho_and_doubt((first, second), sides, ground, tolerance)
    expected = expected_rho_error(first, second, ground, sides)
    of_rho = (raw, *(side["status"] for side in sides), truth, expected)
    *judged, unsure = cellwise(_judged_rho, *of_rho, kinds=JUDGED)
    del raw, truth, expected, of_rho  # each is as large as the whole table
    table |= zip(("rho", "status", "bias", "rho_error"), judged, strict=True)
    worst = caution_of(unsure)
    for number, side in enumerate(sides, start=1):
        table |= {f"{name}_{number}": side[name] for name in SHOWN}
        own = known_error(side)
        table[f"bias_{number}"] = 0 * own
        (worst,) = cellwise(np.maximum, worst, caution_of_error(own), kinds=(np.int8,))
    of_sides = [side[name] for side in sides for name in ("displacement_std", "displacement_error")]
    of_pair = (table["rho"], doubt, share, table["rho_error"])
    periods = [structure.cells()["period"] for structure in (first, second)]
    apart, lean, unsafe = cellwise(_difference_error, *periods, *of_sides, *of_pair, kinds=(float,) * 3)
    table |= {f"{DIFFERENCE}_error": apart, f"{DIFFERENCE}_bias": lean}
    return table | {f"{DIFFERENCE}_caution": caution_of_error(unsafe), "caution": worst}


# Logarithm of the ratio of the periods from which the margin of eq. (13) counts in the caution. Of pairs
# with more similar periods, the difference comes from strength, hardening and damping alone, and its
# estimate is less certain.
ALIKE = 0.015
JUDGED = (float, np.int8, float, float, float)


@by_slabs(*JUDGED)
def _judged_rho(
    raw: Array, status_1: Array, status_2: Array, truth: Array, expected: Array
) -> tuple[Array, ...]:
    """``rho``, status, bias, expected error, and the bias or else the error, for the caution."""
    status = np.maximum(status_1, status_2)
    status = np.where((status < labels.NOT_CONVERGED) & np.isnan(raw), labels.NOT_PHYSICAL, status)
    rho = np.where(status < labels.NOT_CONVERGED, np.clip(raw, -1, 1), np.nan)
    bias, error = rho - truth, np.where(np.isnan(rho), np.nan, expected)
    return rho, status, bias, error, np.where(np.isnan(bias), error, bias)


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


def _rho_and_doubt(
    structures: tuple[Structure, Structure],
    sides: Sequence[Solved],
    ground: Ground,
    tolerance: Tolerance,
) -> tuple[Cells, ...]:
    """``rho``, expected relative error of ``1 - rho``, and weight of eq. (13) for nearly equal pairs."""
    inputs = [[side[name] for name in OF_A_SIDE] for side in sides]
    known = insights(structures, sides, ground, tolerance)
    arrays = (*inputs[0], *known[0], *inputs[1], *known[1])
    return cellwise(_cells, *arrays, kinds=(float,) * 3)


@by_slabs(float, float, float)
@np.errstate(all="ignore")  # cells with extreme parameters become NaN, with a status
def _cells(*inputs: Array) -> tuple[Array, ...]:
    half, own = len(inputs) // 2, len(OF_A_SIDE)
    of_first, of_second = inputs[:half], inputs[half:]
    derived = rho_of_drifts(*of_first[:own], *of_second[:own])
    if half == own:
        none = np.zeros_like(derived)
        return derived, doubt_of(derived, none, none, none), 0 * derived
    (seen_1, like_1), (seen_2, like_2) = insight_of(of_first[own:]), insight_of(of_second[own:])
    informed, unseen = derived, np.ones_like(derived)
    if seen_1 is not None and seen_2 is not None:
        informed, unseen = informed_correlation(derived, seen_1, seen_2), seen_1.left * seen_2.left
    rho, share = with_nearness(informed, like_1, like_2, unseen)
    return rho, doubt_of(rho, share, *(np.exp(like.place[1]) for like in (like_1, like_2))), share
