"""Coefficients of the moments of a table."""

import numpy as np
import pytest
import xarray as xr

import stochlin as sl


@pytest.mark.invariant
def test_coefficients_of_a_table_are_those_of_its_moments():
    """To rounding error, though the closure was evaluated before the last step."""
    period, factor = (
        xr.DataArray(np.geomspace(*ends, 24), dims=name)
        for name, ends in (("period", (0.1, 4.0)), ("factor", (0.5, 8.0)))
    )
    structure = sl.Bilinear(period, 0.05, 0.05, reduction_factor=factor)
    table = sl.linearize(structure, sl.KanaiTajimi(1.0, 0.3))
    velocity = table.velocity_std / table.yield_displacement
    found = sl.equivalent_coefficients(velocity, table.z_std, table.velocity_z_corr)
    for name in ("c_eq", "k_eq"):
        np.testing.assert_allclose(table[name], found[name], rtol=1e-12)
