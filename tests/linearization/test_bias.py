"""Bias of linearization: fresh simulations, symmetries, and where it is unknown."""

import numpy as np
import pytest
import xarray as xr

import stochlin as sl

pytestmark = pytest.mark.oracle

LAKEBED = sl.KanaiTajimi(period=2.0, damping=0.05)
UNKNOWN = 2


def building(
    period=1.0, hardening=0.05, reduction_factor=4.0, damping=0.05, law=sl.Bilinear, **options
):
    return law(period, damping, hardening, reduction_factor=reduction_factor, **options)


@pytest.mark.extreme
def test_linear_structures_have_no_bias():
    elastic = sl.correlate(sl.Bilinear(1.0, 0.05), sl.Bilinear(1.5, 0.05), LAKEBED)
    stiff = sl.correlate(building(1.0, hardening=1.0), building(1.5, hardening=1.0), LAKEBED)
    for table in (elastic, stiff):
        for name in ("bias", "bias_1", "bias_2"):
            assert abs(float(table[name])) < 1e-12
        assert int(table.caution) == 0


OUTSIDE = [
    ({"hardening": 0.008}, LAKEBED),
    ({"reduction_factor": 20.0}, LAKEBED),
    ({"damping": 0.35}, LAKEBED),
    ({"period": 0.1}, LAKEBED),
    ({}, sl.KanaiTajimi(2.0, 0.01)),
    ({}, sl.CloughPenzien(2.0, 0.5, 55.0, 0.6)),
    ({"law": sl.BoucWen}, LAKEBED),
]


def test_pairs_have_the_biases_of_their_structures_but_rho_is_unknown():
    pair = sl.BoucWen(1.2, 0.05, 0.05, reduction_factor=4), building(2.0)
    table = sl.correlate(*pair, LAKEBED)
    alone = float(sl.linearize(pair[1], LAKEBED).bias)
    assert float(table.bias_2) == pytest.approx(alone, rel=1e-6)
    assert np.isnan([table.bias, table.bias_1]).all()
    assert int(table.caution) == UNKNOWN


@pytest.mark.extreme
@pytest.mark.parametrize("case", OUTSIDE, ids=range(len(OUTSIDE)))
def test_where_nothing_was_simulated_the_bias_is_unknown(case):
    options, ground = case
    table = sl.linearize(building(**options), ground)
    assert np.isnan([table.bias, table.bias_error]).all()
    assert int(table.caution) == UNKNOWN
    assert "outside_of_the_map" in table.caution.attrs["flag_meanings"].split()[UNKNOWN]
    assert float(table.displacement_std) > 0


def test_caution_marks_the_cells_of_a_table():
    period = xr.DataArray([0.05, 1.0, -1.0], dims="period")
    table = sl.linearize(building(period), LAKEBED)
    np.testing.assert_array_equal(table.caution, [UNKNOWN, 1, UNKNOWN])
    assert np.isnan(table.bias[2])
