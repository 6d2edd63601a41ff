"""Pairs by the iteration of the full Lyapunov equation are those of the closed forms of `correlate`."""

from dataclasses import replace

import cases
import numpy as np
import pytest
import xarray as xr
from cases import axis, with_slow

import stochlin as sl

GROUNDS = ("white_noise", "kanai_tajimi", "clough_penzien")


def random_pairs(count, kind, seed):
    """Two structures and a ground for each of ``count`` cells, as models with arrays."""
    rng = np.random.default_rng([seed, len(kind)])
    pair = [sl.Bilinear(**cases.draw_structure(rng, cases.PRACTICE, count)) for _ in range(2)]
    period, damping = (cases.log_uniform(rng, limits, count) for limits in ((0.15, 4.0), (0.03, 0.8)))
    ground = {
        "white_noise": sl.WhiteNoise(np.full(count, 0.01)),
        "kanai_tajimi": sl.KanaiTajimi(period, damping, 0.01),
        "clough_penzien": sl.CloughPenzien(period, damping, 4 * period, 0.6, 0.01),
    }[kind]
    return pair, ground


@pytest.mark.oracle
@pytest.mark.parametrize("kind", with_slow(GROUNDS, {"white_noise", "clough_penzien"}))
def test_random_pairs_are_those_of_the_closed_forms(kind):
    pair, ground = random_pairs(200, kind, 1)
    usual, chain = sl.correlate(*pair, ground), sl.linearize_system(pair, ground)
    np.testing.assert_array_equal(chain.status, usual.status)
    of_pair = chain.isel(floor=0, floor_2=1)
    for name in ("rho", "relative_displacement_std"):
        np.testing.assert_allclose(of_pair[name], usual[name], rtol=1e-9, atol=1e-9, err_msg=name)
    for n in range(2):
        for name, array in (
            ("displacement_std", chain.displacement_std.isel(floor=n)),
            ("ductility_std", chain.ductility_std.isel(element=n)),
        ):
            np.testing.assert_allclose(array, usual[f"{name}_{n + 1}"], rtol=1e-9, err_msg=name)


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
