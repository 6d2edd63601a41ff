"""The table of pairs: its differences of displacements, and cell by cell."""

import numpy as np
import pytest
import xarray as xr

import stochlin as sl
from stochlin.kernels.correlation.errors import bias_of_difference, std_of_difference

pytestmark = pytest.mark.oracle


def test_differences_of_displacements_and_their_bias():
    """Of any dimensions; with cells that are not solved, and equal structures."""
    rng = np.random.default_rng(23)
    shapes = (600, 1, 3), (500, 1), (600, 500, 3), (600, 1, 1), (1,), (500, 3)
    one, other, rho, off_1, off_2, off = (rng.uniform(0.1, 0.9, shape) for shape in shapes)
    rho[::7, ::5], one[3], other[4], rho[3, 4], off_1[3], off_2[:] = np.nan, 0.5, 0.5, 1.0, 0.2, 0.2
    off[4], rho[5] = 0.0, -0.95  # with its bias below -1
    with np.errstate(invalid="ignore"):
        std = std_of_difference(one, other, rho)
        bias = bias_of_difference(std, one, other, off_1, off_2, rho, off)

    def apart(one, other, rho):
        return np.sqrt((one - other) ** 2 + 2 * one * other * (1 - rho))

    expected = apart(one, other, rho)
    with np.errstate(invalid="ignore"):
        truth = apart(one / (1 + off_1), other / (1 + off_2), np.clip(rho - off, -1, 1))
        relative = np.where((expected == 0) & (truth == 0), 0.0, expected / truth - 1)
    np.testing.assert_allclose(std, expected, rtol=1e-13)
    np.testing.assert_allclose(bias, relative, rtol=1e-12, atol=1e-15)
    assert std[3, 4, 0] == bias[3, 4, 0] == 0


@pytest.mark.parametrize("options", [{}, {"bias": False}, {"closure": "drift"}])
@pytest.mark.parametrize("period", [1.1, -1.0], ids=["all valid", "one invalid"])
def test_a_table_has_the_numbers_of_its_pairs_side_by_side(options, period):
    """A table of all combinations is computed by its rows and columns, or pair by pair."""
    axes = np.array([0.2, 0.9, 2.0]), np.array([0.3, period, 4.0, 0.9])

    def correlation(*periods):
        pair = [sl.Bilinear(each, 0.05, 0.05, reduction_factor=4) for each in periods]
        return sl.correlate(*pair, sl.KanaiTajimi(1.0, 0.1), **options)

    table = correlation(
        *(xr.DataArray(axis, dims=dim) for axis, dim in zip(axes, "ab", strict=True))
    )
    sides = np.meshgrid(*axes, indexing="ij")
    pairs = correlation(*(xr.DataArray(side.ravel(), dims="c") for side in sides))
    for name, values in pairs.items():
        whole = table[name].broadcast_like(table.rho).transpose("a", "b").values.ravel()
        np.testing.assert_allclose(whole, values, rtol=1e-12, err_msg=name)
