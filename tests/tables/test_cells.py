"""A table is its cells: labels, order and neighbours have no say in the numbers."""

import io

import cases
import numpy as np
import pytest
import xarray as xr
from cases import axis

import stochlin as sl

pytestmark = [pytest.mark.invariant, pytest.mark.extreme]

GROUND = sl.KanaiTajimi(period=1.0, damping=0.2)


def pair_of_axes():
    first = sl.Bilinear(axis("period_1", [0.4, 0.9, 2.0]), 0.05, 0.05, reduction_factor=4)
    second = sl.Bilinear(
        1.1,
        0.03,
        hardening=axis("hardening_2", [0.02, 0.3]),
        reduction_factor=axis("R", [0.1, 1.5, 5]),
    )
    return first, second


def test_each_variable_has_the_dimensions_that_matter_to_it():
    first, second = pair_of_axes()
    table = sl.correlate(first, second, GROUND)
    assert set(table.displacement_std_1.dims) == {"period_1"}
    assert set(table.displacement_std_2.dims) == {"hardening_2", "R"}
    assert set(table.rho.dims) == set(table.status.dims) == {"period_1", "hardening_2", "R"}
    np.testing.assert_array_equal(table.period_1, [0.4, 0.9, 2.0])


def test_order_of_dimensions_does_not_matter():
    rng = np.random.default_rng(70)
    values = {
        key: xr.DataArray(value.reshape(4, 5), dims=("a", "b"))
        for key, value in cases.draw_structure(rng, cases.PRACTICE, 20).items()
    }
    other = sl.Bilinear(axis("T2", [0.3, 1.0]), 0.05)
    straight = sl.correlate(sl.Bilinear(**values), other, GROUND)
    turned = {key: value.transpose("b", "a") for key, value in values.items()}
    mixed = turned | {"period": values["period"]}
    for variant in (turned, mixed):
        table = sl.correlate(sl.Bilinear(**variant), other, GROUND)
        xr.testing.assert_allclose(table.transpose(*straight.rho.dims), straight, rtol=1e-13)


def test_inputs_are_left_as_they_were():
    period = xr.DataArray([0.5, 1.0], dims="T", coords={"T": [0.5, 1.0]}, attrs={"note": "mine"})
    before = period.copy(deep=True)
    sl.correlate(sl.Bilinear(period, 0.05), sl.Bilinear(1.0, 0.05), GROUND)
    xr.testing.assert_identical(period, before)


def test_large_table_is_cut_into_pieces_without_a_seam():
    """More cells than one slab holds, against the same cells in another shape."""
    periods = np.geomspace(0.2, 4, 160)
    first = sl.Bilinear(axis("a", periods), 0.05, 0.1, reduction_factor=3)
    second = sl.Bilinear(axis("b", periods), 0.05, 0.1, reduction_factor=3)
    table = sl.correlate(first, second, GROUND).rho.transpose("a", "b").values
    np.testing.assert_allclose(table, table.T, rtol=0, atol=1e-11)
    np.testing.assert_allclose(np.diag(table), 1, rtol=0, atol=1e-12)
    rows = [0, 77, 159]
    part = sl.correlate(
        sl.Bilinear(axis("a", periods[rows]), 0.05, 0.1, reduction_factor=3), second, GROUND
    )
    np.testing.assert_array_equal(part.rho.transpose("a", "b"), table[rows])


YIELDING = {"damping": 0.05, "hardening": 0.05, "reduction_factor": 3.0}
WEAK = sl.Bilinear(
    axis("period_1", [0.5, -1.0, 1.0]), **YIELDING
)  # its second cell is out of range
OTHER = sl.Bilinear(0.8, **YIELDING)
OF_MODELS = {
    "linearize": lambda: sl.linearize(pair_of_axes()[0], GROUND),
    "correlate": lambda: sl.correlate(*pair_of_axes(), GROUND),
    "white noise": lambda: sl.correlate(*pair_of_axes(), GROUND, method="white_noise"),
    "eq. (4)": lambda: sl.rho_white_noise(pair_of_axes()[0].period, 1.0, 0.05, 0.05),
    "amplification": lambda: sl.amplification(pair_of_axes()[0], GROUND),
}
WITH_A_BAD_CELL = {
    "peak_response": lambda: sl.peak_response(WEAK, GROUND, axis("duration", [10.0, 30.0])),
    "rho_effective": lambda: sl.rules.rho_effective(
        *(WEAK.period, 1.0, 0.05, 0.03, 0.05, 0.1), ductility_1=4.0, ductility_2=2.0
    ),
    "effective": lambda: sl.correlate(WEAK, OTHER, GROUND, "effective", rule="fema_440"),
    "critical_gap": lambda: sl.critical_gap(0.3, 0.2, axis("rho", [-0.5, 2.0, 1.0])),
    "code_gaps": lambda: sl.code_gaps(axis("peak_1", [0.1, -1.0, 0.2]), 0.04, zone="I"),
    "strength_for_ductility": lambda: sl.strength_for_ductility(WEAK, GROUND, 4.0),
    "reduction_factor": lambda: sl.reduction_factor(WEAK, GROUND),
}
RESULTS = OF_MODELS | WITH_A_BAD_CELL
every_result = pytest.mark.parametrize("result", RESULTS.values(), ids=list(RESULTS))


@every_result
def test_every_variable_says_what_it_is(result):
    cases.check_labels(result())


@every_result
def test_file_gives_back_what_was_written(result):
    table = result()
    stored = bytes(table.to_netcdf(engine="scipy"))
    with xr.open_dataset(io.BytesIO(stored), engine="scipy") as back:
        xr.testing.assert_equal(back.load(), table)
        assert back.attrs == table.attrs
        for name in table.data_vars:
            for key, value in table[name].attrs.items():
                np.testing.assert_array_equal(back[name].attrs[key], value)
