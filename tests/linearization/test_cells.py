"""Fixed points cell by cell: elementary functions, closures, plain Python beside compiled code."""

import numpy as np
import pytest
import xarray as xr
from scipy import special

import stochlin as sl
from stochlin.kernels.correlation.bilinear_pair import linearized_pair
from stochlin.kernels.linearization import gaussian, iteration
from stochlin.kernels.linearization.cells import elementary, fixed_points, grounds, slip

GROUNDS = (
    (sl.WhiteNoise(0.01), (0.01,)),
    (sl.KanaiTajimi(2.0, 0.3, 0.01), (0.01, 2.0, 0.3)),
    (sl.CloughPenzien(2.0, 0.3, 20.0, 0.6, 0.01), (0.01, 2.0, 0.3, 20.0, 0.6)),
)


@pytest.mark.invariant
def test_elementary_functions_raise_no_errors():
    assert [elementary.exp(x) for x in (-1e9, 0.0, 709.5, np.nan)] == pytest.approx(
        [0.0, 1.0, np.inf, np.nan], nan_ok=True
    )
    for function in (elementary.log, elementary.atanh):
        assert np.isnan([function(x) for x in (-1.0, -2.0, np.inf, np.nan)]).all()


@pytest.mark.oracle
def test_moments_over_the_quadrant_of_slip_follow_from_functions_of_scipy():
    """Owen's function there is a quadrature here, and that of scipy is another algorithm."""
    rng = np.random.default_rng(7)
    sz, r = np.exp(rng.uniform(np.log(0.15), np.log(100), 500)), np.tanh(rng.uniform(-1, 4, 500))
    h, q = 1 / sz, np.sqrt((1 - r) * (1 + r))
    edge = np.exp(-0.5 * h * h) / np.sqrt(2 * np.pi) * special.ndtr(r / q * h)
    corner = np.exp(-0.5 * (h / q) ** 2) / (2 * np.pi)
    probability = 0.5 * special.ndtr(-h) + special.owens_t(h, r / q)
    first = special.ndtr(-h / q) / np.sqrt(2 * np.pi) + r * edge
    second = probability + r * (r * h * edge + q * corner)
    expected = np.array([probability, first, second, h, q, edge, corner])
    # With r < 0 the terms of the moments cancel.
    np.testing.assert_allclose(slip.quadrants(sz, r), expected, rtol=1e-10, atol=1e-15)


@pytest.mark.invariant
@pytest.mark.parametrize("closure", [gaussian.gaussian, gaussian.clipped])
def test_a_closure_has_the_same_bits_in_plain_python_and_in_any_table(closure):
    rng = np.random.default_rng(8)
    latent = np.array([rng.uniform(0.5, 5, 500), rng.uniform(0.1, 9, 500), rng.uniform(-0.9, 1, 500)])
    latent[:, 3] = 1.0, 0.0, 0.5  # without yielding: compiled code has no exceptions
    whole = closure(latent, np.empty((0, 500)))
    for n in (0, 4, 499):
        *rows, matrix = slip.closure_of(closure is gaussian.clipped, latent[:, n].tolist())
        found = [number for row in (*rows, *matrix) for number in row]
        assert np.array_equal(found, np.concatenate([field[..., n].ravel() for field in whole]))
    alone = closure(latent[:, 3:4], np.empty((0, 1)))
    for one, many in zip(alone, whole, strict=True):
        np.testing.assert_array_equal(one[..., 0], many[..., 3])


@pytest.mark.invariant
@pytest.mark.parametrize("clipped", [False, True])
@pytest.mark.parametrize("oscillators", [0, 1, 2])
def test_a_cell_has_the_same_bits_in_plain_python_and_in_any_table(clipped, oscillators):
    count, rng = 150, np.random.default_rng(3)
    w = rng.uniform(2, 20, count)
    cells = np.array([w**2, 0.1 * w, 0.95 * w**2, 0 * w])
    ground = np.array([rng.uniform(0.1, 3, count), *np.ones((4, count)) * [[10.0], [1.0], [0.1], [0.4]]])
    start = np.array([np.log(w), 0 * w, 0 * w + 0.1])
    rule = iteration.BOLD, 1e-10, 1e-12, 30
    found, iterations = np.empty((fixed_points.FOUND, count)), np.zeros(count, np.int32)
    ground[0, 77] = np.nan  # fails alone
    kind = clipped, oscillators
    fixed_points.settle_cells(cells, ground, start, *kind, *rule, found, iterations)
    assert found[-1].sum() == count - 1
    assert found[-1, 77] == 0
    for n in {*range(0, count, 10), 76, 78}:
        given = [rows[:, n].tolist() for rows in (cells, ground, start)]
        alone, steps = fixed_points.settle(*kind, *given, *rule)
        assert steps == iterations[n]
        assert np.array_equal(alone, found[:, n])


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


@pytest.mark.invariant
@pytest.mark.parametrize("oscillators", [1, 2])
def test_grounds_have_the_same_bits_in_plain_python(oscillators):
    rows = np.random.default_rng(5).uniform(0.1, 2, (6 + 2 * oscillators, 20))
    found = np.empty((2, 9 + 6 * oscillators, 20))
    grounds.solve(rows, found[0])
    grounds.solve.py_func(rows.tolist(), found[1])
    assert np.array_equal(*found)


@pytest.mark.filterwarnings("ignore::stochlin.messages.DoubtfulInput")  # hardly yields
@pytest.mark.invariant
@pytest.mark.parametrize("closure", ["gaussian", "clipped"])
@pytest.mark.parametrize(("ground", "numbers"), GROUNDS)
def test_a_pair_of_numbers_is_that_of_correlate(ground, numbers, closure):
    pairs = [
        ((1.0, 0.05, 0.05, 0.02), (0.7, 0.05, 0.1, 0.01)),
        ((0.2, 0.02, 0.5, 1e3), (3.0, 0.1, 0.02, 1e-3)),
    ]
    for one, two in pairs:
        table = sl.correlate(sl.Bilinear(*one), sl.Bilinear(*two), ground, closure=closure)
        found = linearized_pair(one, two, numbers, clipped=closure == "clipped")
        expected = [float(table[name]) for name in found._fields]
        assert found == pytest.approx(expected, rel=1e-12)


@pytest.mark.invariant
def test_a_pair_of_numbers_that_does_not_converge_is_nan():
    found = linearized_pair((1.0, 0.05, 0.05, 1e-30), (0.7, 0.05, 0.05, 0.01), (0.01,))
    assert np.isnan(found.rho)
    assert np.isnan(found.displacement_std_1)
    assert found.displacement_std_2 > 0
