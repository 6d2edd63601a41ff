"""The limits of the flags of the confidence by formula, as `docs/probability.md` states them."""

import numpy as np
import pytest
import xarray as xr

import stochlin as sl
from stochlin.analyses.probability.confidence_errors import cautions, measured_cautions

pytestmark = pytest.mark.invariant
# By formula and corrected: alike and large, unlike and large, alike and small, without a correction.
PLAIN = np.array([[0.95, 0.95, 0.6, 0.95]])
CORRECTED = np.array([[0.93, 0.87, 0.58, np.nan]])
# The flags of these confidences: where both formulas hold, where only a large corrected confidence or a
# small correction does, where none does, and outside of what was checked.
ALL = [0, 0, 0, 0], [0, 0, 0, 2]
ONLY_CORRECTED = [0, 1, 1, 1], [0, 0, 0, 2]
ONLY_LARGE = [0, 1, 1, 1], [0, 0, 1, 2]
NONE = [1, 1, 1, 1], [1, 1, 1, 2]
UNCHECKED = [2, 2, 2, 2], [2, 2, 2, 2]


def structure(ground_period, period=1.0, R=4, **changes):
    parameters = {"damping": 0.05, "hardening": 0.05} | changes
    return sl.Bilinear(period * ground_period, reduction_factor=R, **parameters)


def flags(first, second, ground_period):
    """Flags over four gaps, of two structures; a period is relative to that of the ground."""
    ground = sl.KanaiTajimi(period=ground_period, damping=0.6)
    over = ("time", "gap")
    table = xr.Dataset(
        {
            "confidence_of_no_pounding": (over, PLAIN),
            "confidence_of_no_pounding_corrected": (over, CORRECTED),
        }
    )
    sides = [structure(ground_period, **side) for side in (first, second)]
    found = cautions(*sides, ground, table, 0.0)
    return found["caution"].values.tolist(), found["caution_corrected"].values.tolist()


@pytest.mark.parametrize(
    ("first", "second", "expected"),
    [
        ({}, {"period": 1.45, "R": 3.9}, ONLY_LARGE),
        ({"R": 3.9}, {"period": 1.55, "R": 2}, ONLY_CORRECTED),
        ({"R": 4.1}, {"period": 1.55, "R": 2}, ONLY_LARGE),
        ({"R": 8.9}, {"period": 2.9}, ONLY_LARGE),
        ({"R": 9.1}, {"period": 2.9}, UNCHECKED),
        ({}, {"period": 3.1}, UNCHECKED),
        ({"R": 1.4}, {"period": 1.6, "R": 1.4}, ALL),
        ({"R": 1.4}, {"period": 1.6, "R": 1.6}, ONLY_CORRECTED),
        ({"period": 0.51}, {"period": 0.6}, ONLY_LARGE),
        ({"period": 0.49}, {"period": 0.6}, NONE),
        ({}, {"period": 1.2, "hardening": 0.3, "damping": 0.1}, ONLY_LARGE),
        ({}, {"period": 1.2, "hardening": 0.02, "damping": 0.02}, ONLY_LARGE),
        ({}, {"period": 1.2, "hardening": 0.31}, UNCHECKED),
        ({}, {"period": 1.2, "hardening": 0.019}, UNCHECKED),
        ({}, {"period": 1.2, "damping": 0.11}, UNCHECKED),
        ({}, {"period": 1.2, "damping": 0.019}, UNCHECKED),
    ],
)  # fmt: skip
@pytest.mark.parametrize("ground_period", [0.25, 1.0, 4.0])
def test_the_flags_change_at_the_limits_in_either_order_and_any_unit_of_time(
    first, second, expected, ground_period
):
    assert flags(first, second, ground_period) == expected
    assert flags(second, first, ground_period) == expected


def test_a_simulation_beside_the_formulas_sets_their_flags():
    """0 up to 0.1 above the lower end of the interval, 1 beyond, and 2 without a confidence."""
    over = ("time", "gap")
    table = xr.Dataset(
        {
            "confidence_of_no_pounding": (over, PLAIN),
            "confidence_of_no_pounding_corrected": (over, CORRECTED),
            "confidence_of_no_pounding_simulated_lower": (over, [[0.86, 0.84, 0.1, 0.9]]),
        },
        attrs={"paths": 64, "seed": 3},
    )
    found = measured_cautions(table)
    assert found["caution"].values.tolist() == [0, 1, 1, 0]
    assert found["caution_corrected"].values.tolist() == [0, 0, 1, 2]
    assert "64 motions, seed 3" in found["caution"].comment
