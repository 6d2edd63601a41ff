"""Pairs by iteration of the full Lyapunov equation are those of the closed forms of `correlate`."""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from cases import axis

import stochlin as sl

TABLE = [
    sl.Bilinear(axis("one", [0.5, 1.0]), 0.05, 0.05, reduction_factor=axis("R", [1.5, 4.0])),
    sl.Bilinear(axis("two", [0.7, 2.0, 3.0]), 0.05, 0.05, reduction_factor=axis("R", [1.5, 4.0])),
]


@pytest.mark.oracle
def test_substitution_ends_where_mixing_does():
    """It takes more iterations; relaxed or not, it ends at the same coefficients."""
    ground = sl.KanaiTajimi(2.0, 0.6)
    mixed = sl.linearize_system(TABLE, ground)
    for relaxation in (1.0, 0.7):
        table = sl.linearize_system(TABLE, ground, iteration="substitution", relaxation=relaxation)
        assert (table.status == 0).all()
        assert float(table.iterations.mean()) > 1.5 * float(mixed.iterations.mean())
        np.testing.assert_allclose(table.c_eq, mixed.c_eq, atol=1e-8)
        np.testing.assert_allclose(table.rho, mixed.rho, atol=1e-8)


@pytest.mark.invariant
def test_a_substitution_that_ends_nowhere_says_so():
    """Far beyond yield on a lake bed it cycles."""
    structures = [replace(s, reduction_factor=xr.DataArray([2.0, 12.0], dims="R")) for s in TABLE]
    ground = sl.KanaiTajimi(2.0, 0.05)
    table = sl.linearize_system(structures, ground, iteration="substitution")
    assert set(np.unique(table.status)) <= {0, 2}
    failed = table.status == 2
    assert failed.any()
    assert (table.rho.isel(floor=0, floor_2=1).isnull() == failed).all()
    assert (sl.linearize_system(structures, ground).status == 0).all()
