"""Bad input to pounding: refused with the parameter, its value, what is allowed, and the cure."""

import numpy as np
import pytest
import xarray as xr

import stochlin as sl

pytestmark = pytest.mark.invariant

CONTACT = sl.Kelvin(1e8, restitution=0.65)
ONE = sl.Bilinear(1.0, 0.05, mass=2e5)
TWO = sl.Bilinear(0.5, 0.05, mass=3e5)
TIME = 0.02 * np.arange(100)
MOTION = xr.DataArray(
    np.sin(6 * TIME), dims="time", coords={"time": TIME}, attrs={"units": "m/s^2"}
)


def tower(heights, **other):
    return sl.ShearBuilding([2e5] * len(heights), [4e8] * len(heights), heights, 0.05, **other)


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        (
            {"structures": ONE},
            ValueError,
            "structures = Bilinear.*; allowed: a list, from left to right",
        ),
        ({"structures": [ONE]}, ValueError, "gaps = 0.01; allowed: none for one building alone"),
        ({"structures": [ONE], "gaps": (), "contact": 0.65}, TypeError, "contact = 0.65"),
        ({"contact": None}, ValueError, "contact is not given; structures .* need.*Kelvin"),
        (
            {"contact": sl.Kelvin(1e26, restitution=0.65)},
            ValueError,
            r"near contact of 6.* s, would take about .* hours; .*softer contact",
        ),
        ({"structures": [ONE, sl.Bilinear(1.0, 0.05)]}, ValueError, "number 2: mass is not given"),
        (
            {"structures": [ONE, sl.Bilinear([1.0, 2.0], 0.05, mass=1e5)]},
            ValueError,
            "period is an array",
        ),
        (
            {"structures": [ONE, sl.Bilinear(1.0, 0.05, 0.1, reduction_factor=2, mass=1e5)]},
            ValueError,
            "reduction_factor.*yield_displacement",
        ),
        (
            {
                "structures": [tower([3.0, 3.0]), tower([3.0, 4.0])],
                "contact": sl.Stereomechanical(0.5),
            },
            ValueError,
            "structures 1 and 2 a floor meets a column at 6 m; allowed: a contact with a force",
        ),
        ({"gaps": -0.01}, ValueError, r"-0.01 between structures 1 and 2.*0 <= gap"),
        ({"gaps": [0.01, 0.02]}, ValueError, "1 in all"),
    ],
)
def test_what_cannot_pound_is_refused(arguments, error, message):
    usual = {"structures": [ONE, TWO], "gaps": 0.01, "contact": CONTACT, "motion": MOTION}
    with pytest.raises(error, match=message):
        sl.pound(**(usual | arguments))


def test_cells_out_of_range_are_left_out_of_an_estimate():
    hit = sl.pounding_estimate(ONE, TWO, [0.01, -0.01, 0.02], CONTACT, 0.1, 0.1)
    assert hit.status.values.tolist() == [0, 3, 0]
    assert np.isnan(hit.largest_radius_amplification_1.values).tolist() == [False, True, False]
    alone = sl.pounding_estimate(ONE, TWO, 0.02, CONTACT, 0.1, 0.1)
    found = float(hit.largest_radius_amplification_2[2])
    assert found == float(alone.largest_radius_amplification_2)
