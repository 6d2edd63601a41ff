"""The table of pairs: against 60 digits, and cell by cell."""

import mpmath
import numpy as np
import pytest
import sixty_digits as oracle
import xarray as xr

import stochlin as sl
from stochlin.kernels.correlation.errors import bias_of_difference, std_of_difference
from stochlin.kernels.linearization.covariance import EquivalentSystem, own_covariance, pair_covariance
from stochlin.kernels.linearization.filters import Filter

pytestmark = pytest.mark.oracle

WORST = 2e-11  # of rho; reached: 4e-12, over 1000 such pairs


def draw(rng, period, slip=None):
    """An equivalent system; slip and relaxation down to where yielding has died out."""
    slip = 10 ** rng.uniform(-18, -0.3) if slip is None else slip
    relaxation = min(slip * 10 ** rng.uniform(-2, 2), 0.5)
    w, xi, alpha = 2 * np.pi / period, rng.uniform(0.005, 0.2), 10 ** rng.uniform(-3, 0)
    return EquivalentSystem(
        *map(np.float64, (w * w, 2 * xi * w, (1 - alpha) * w * w, slip, relaxation * w))
    )


def rho_of(one, other, soil):
    """The correlation as tables have it, of arrays of one cell."""
    ground = Filter.kanai_tajimi(np.float64(1), *(np.asarray(x, float) for x in soil))
    both, total = [], 1.0
    for system in (one, other):
        cells = EquivalentSystem(*(np.array([value]) for value in system))
        forcing = ground.forcing(cells)
        both += [cells, forcing]
        total = total * np.sqrt(own_covariance(cells, forcing).mu_mu)
    return float((pair_covariance(*both) / total)[0])


def exact(one, other, soil):
    with mpmath.workdps(oracle.DIGITS):
        x = oracle.exact_covariance([oracle.with_law(s) for s in (one, other)], soil)
        return float(x(0, 3) / mpmath.sqrt(x(0, 0) * x(3, 3)))


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


def check(one, other, soil):
    truth = exact(one, other, soil)
    for pair in ((one, other), (other, one)):
        assert rho_of(*pair, soil) == pytest.approx(truth, abs=WORST)


@pytest.mark.parametrize("seed", range(12))
def test_random_pairs_a_million_to_one_in_period(seed):
    rng = np.random.default_rng([40, seed])
    periods = 10 ** rng.uniform(-1.5, 1.5, 2)
    soil = 2 * np.pi / 10 ** rng.uniform(-1, 1), 10 ** rng.uniform(-2, 0)
    check(draw(rng, periods[0]), draw(rng, periods[1]), soil)


@pytest.mark.parametrize("ratio", [1e-3, 1e-2, 1e2, 1e3])
@pytest.mark.parametrize("slip", [1e-16, 1e-6, 0.2])
def test_periods_far_apart_keep_their_digits(ratio, slip):
    rng = np.random.default_rng(41)
    check(draw(rng, 1.0, slip), draw(rng, ratio, slip), (2 * np.pi, 0.3))


@pytest.mark.parametrize("fast", [20.0, 1e2, 1e3, 1e4])
def test_fast_relaxation_keeps_its_digits(fast):
    """Far beyond yield, of one or of both."""
    rng = np.random.default_rng(45)
    for other in (0.2, 0.5 * fast):
        one, two = draw(rng, 10 ** rng.uniform(-1, 1), 0.2), draw(rng, 10 ** rng.uniform(-1, 1), 0.8)
        paces = fast * np.sqrt(one.stiffness), other * np.sqrt(two.stiffness)
        check(one._replace(relaxation=paces[0]), two._replace(relaxation=paces[1]), (4.0, 0.2))


@pytest.mark.parametrize("slip", [1e-18, 1e-12, 1e-6, 1e-2])
def test_tuned_to_the_ground_and_to_each_other(slip):
    """Near-defective: the soil's own period and damping, and twins that differ in the ninth digit."""
    rng = np.random.default_rng(42)
    one = draw(rng, 1.3, slip)
    soil = float(np.sqrt(one.stiffness)), float(one.damping / (2 * np.sqrt(one.stiffness)))
    check(one, one._replace(stiffness=one.stiffness * (1 + 1e-9)), soil)
    check(one, draw(rng, 1.3 * (1 + 1e-7), slip), soil)


@pytest.mark.parametrize("options", [{}, {"bias": False}, {"closure": "drift"}])
@pytest.mark.parametrize("period", [1.1, -1.0], ids=["all valid", "one invalid"])
def test_a_table_has_the_numbers_of_its_pairs_side_by_side(options, period):
    """A table of all combinations is computed by its rows and columns, or pair by pair."""
    axes = np.array([0.2, 0.9, 2.0]), np.array([0.3, period, 4.0, 0.9])

    def correlation(*periods):
        pair = [sl.Bilinear(each, 0.05, 0.05, reduction_factor=4) for each in periods]
        return sl.correlate(*pair, sl.KanaiTajimi(1.0, 0.1), **options)

    table = correlation(*(xr.DataArray(axis, dims=dim) for axis, dim in zip(axes, "ab", strict=True)))
    sides = np.meshgrid(*axes, indexing="ij")
    pairs = correlation(*(xr.DataArray(side.ravel(), dims="c") for side in sides))
    for name, values in pairs.items():
        whole = table[name].broadcast_like(table.rho).transpose("a", "b").values.ravel()
        np.testing.assert_allclose(whole, values, rtol=1e-12, err_msg=name)
