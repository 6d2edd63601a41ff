"""Responses to records that begin in motion, or go on from the end of another record."""

import numpy as np
import pytest
from motions import motion, shaking
from pounding.test_start_values import TOWER

import stochlin as sl

pytestmark = pytest.mark.invariant

STRUCTURES = [
    sl.Bilinear(1.2, 0.05, 0.05, yield_displacement=0.02),
    sl.Bilinear(0.6, 0.05),
    TOWER,
]


@pytest.mark.parametrize("structure", STRUCTURES, ids=["bilinear", "elastic", "tower"])
@pytest.mark.parametrize("cut", [100, 137, 201])
def test_a_record_in_two_parts_has_the_bits_of_one(structure, cut):
    record = shaking(300)
    whole = sl.respond(structure, record)
    first = sl.respond(structure, record[: cut + 1])
    second = sl.respond(structure, record[cut:], start=first.end_state)
    for name, values in whole.data_vars.items():
        if "time" in values.dims:
            joined = np.concatenate([first[name], second[name][1:]])
            np.testing.assert_array_equal(joined, values, err_msg=name)


@pytest.mark.parametrize("of_law", [sl.Bilinear, sl.BoucWen])
def test_free_vibration_has_its_closed_form(of_law):
    table = sl.respond(of_law(1.0, 0.05), motion(np.zeros(501), 0.01), start=sl.Start(0.01, 0.2))
    w, t = 2 * np.pi, table.time.values
    wd = w * np.sqrt(1 - 0.05**2)
    course = 0.01 * np.cos(wd * t) + (0.2 + 0.05 * w * 0.01) / wd * np.sin(wd * t)
    exact = np.exp(-0.05 * w * t) * course
    np.testing.assert_allclose(
        table.displacement, exact, atol=1e-15 if of_law is sl.Bilinear else 1e-5
    )
    put_in = 0.5 * (0.2**2 + (w * 0.01) ** 2)
    np.testing.assert_allclose(table.input_energy_per_mass, put_in, rtol=1e-12)


def test_a_start_that_yields_is_refused():
    with pytest.raises(ValueError, match=r"drift of 1 is 0.03 m; allowed: up to 0.02 m, at which"):
        sl.respond(STRUCTURES[0], shaking(), start=sl.Start(0.03))
