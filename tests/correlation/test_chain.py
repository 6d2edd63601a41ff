"""Tables by the chain of state matrix, Lyapunov equation and coefficients, all cells at once."""

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
    """The same table in every variable, its missing values and its flags included."""
    pair, ground = random_pairs(200, kind, 1)
    usual = sl.correlate(*pair, ground)
    chain = sl.correlate(*pair, ground, solver="lyapunov")
    assert list(chain) == list(usual)
    for name, array in usual.items():
        assert (chain[name].dims, chain[name].dtype) == (array.dims, array.dtype)
        assert str(chain[name].attrs) == str(array.attrs)
        np.testing.assert_allclose(chain[name], array, rtol=1e-9, atol=1e-9, err_msg=name)


TABLE = [
    sl.Bilinear(axis("one", [0.5, 1.0]), 0.05, 0.05, reduction_factor=axis("R", [1.5, 4.0])),
    sl.Bilinear(axis("two", [0.7, 2.0, 3.0]), 0.05, 0.05, reduction_factor=axis("R", [1.5, 4.0])),
]
LAKE_BED = sl.KanaiTajimi(2.0, 0.05)


@pytest.mark.invariant
def test_a_table_without_a_valid_cell_is_blank():
    wrong = sl.Bilinear([-1.0, np.nan], 0.05)
    table = sl.correlate(wrong, TABLE[1], LAKE_BED, solver="lyapunov")
    usual = sl.correlate(wrong, TABLE[1], LAKE_BED)
    assert (table.status == 3).all()
    for name, array in usual.items():
        np.testing.assert_allclose(table[name], array, rtol=1e-10, err_msg=name)


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
    table = sl.linearize_system(structures, LAKE_BED, iteration="substitution")
    assert set(np.unique(table.status)) <= {0, 2}
    failed = table.status == 2
    assert failed.any()
    assert (table.rho.isel(floor=0, floor_2=1).isnull() == failed).all()
    assert (sl.linearize_system(structures, LAKE_BED).status == 0).all()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"solver": "schur"}, "solver = 'schur' is not known; allowed: closed_form, lyapunov"),
        ({"closure": "drift"}, "closure = 'drift'; allowed: .*closure gaussian"),
        ({"closure": "clipped"}, "closure = 'clipped'; allowed: .*closure gaussian"),
        ({"method": "simulation"}, "method = 'simulation'.*allowed: method linearization"),
        ({"second": sl.Bilinear(axis("one", [1.0, 2.0, 3.0]), 0.05)}, "different dimension names"),
        ({"second": sl.Bilinear(np.geomspace(0.1, 4, 20_000_000), 0.05)}, "allowed: .*fewer cells"),
    ],
)
def test_what_the_chain_refuses(options, message):
    given = {"first": TABLE[0], "second": TABLE[1], "ground": LAKE_BED, "solver": "lyapunov"}
    with pytest.raises(ValueError, match=message):
        sl.correlate(**(given | options))


@pytest.mark.invariant
def test_a_pair_of_which_one_side_alone_is_not_solved_has_the_status_of_that_side():
    first = [0.16855826, 121.453976], [0.05309277, 1.29105513e-05], [0.03856317, 0.00109873]
    second = [91.5965664, 0.0256056318], [0.00789215, 0.00135481778], [0.1433108, 0.00094028]
    factors = [9.54305696, 0.40112425], [0.41843452, 0.42553587]
    pair = [sl.Bilinear(*s, reduction_factor=r) for s, r in zip((first, second), factors, strict=True)]
    ground = sl.KanaiTajimi([0.01751373, 0.02547676], [0.01105218, 0.22458688], 0.01)
    table = sl.correlate(*pair, ground, solver="lyapunov")
    lost = np.isnan(table.displacement_std_1) | np.isnan(table.displacement_std_2)
    assert lost.any()
    assert (table.status[lost] == 2).all()
    assert (np.isnan(table.rho) == lost).all()
