"""The compiled table of pairs: against 60 digits, plain numpy, and itself cut otherwise."""

import cases
import mpmath
import numpy as np
import pytest
import sixty_digits as oracle
import xarray as xr

import stochlin as sl
from stochlin.analyses.linearization.bias_map import bias_map
from stochlin.kernels.basics import parallel
from stochlin.kernels.basics.interpolation import Grid, interpolate
from stochlin.kernels.correlation import tables as pair_tables
from stochlin.kernels.correlation.differences import differences
from stochlin.kernels.correlation.tables import OFF, Codes, PairSide, pair_parameters, pair_table
from stochlin.kernels.linearization.covariance import EquivalentSystem, own_covariance, pair_covariance
from stochlin.kernels.linearization.filters import KanaiTajimiFilter

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


def side(systems, soil, strides):
    """Structures of a table, with nothing known of their bias."""
    stacked = EquivalentSystem(*(np.array(column) for column in zip(*systems, strict=True)))
    ground = KanaiTajimiFilter.of(np.float64(1), *(np.asarray(x, float) for x in soil))
    forcing = ground.forcing(stacked)
    sigma = np.sqrt(own_covariance(stacked, forcing).mu_mu)
    parameters = pair_parameters(stacked, forcing, sigma)
    count = len(systems)
    place, flags = np.zeros((count, 6)), np.zeros((count, 3), np.int8)
    return stacked, forcing, PairSide(parameters, parameters, place, flags, np.array(strides, int))


def table(first, second, shape):
    return pair_table(first, second, shape, None, Codes(2, 4))


def exact(one, other, soil):
    with mpmath.workdps(oracle.DIGITS):
        x = oracle.exact_covariance([oracle.with_law(s) for s in (one, other)], soil)
        return float(x(0, 3) / mpmath.sqrt(x(0, 0) * x(3, 3)))


def test_differences_of_displacements_are_those_of_numpy():
    """Of any dimensions, in several parts; with cells that are not solved, and equal structures."""
    rng = np.random.default_rng(23)
    shapes = (600, 1, 3), (500, 1), (600, 500, 3), (600, 1, 1), (1,), (500, 3)
    one, other, rho, off_1, off_2, off = (rng.uniform(0.1, 0.9, shape) for shape in shapes)
    rho[::7, ::5], one[3], other[4], rho[3, 4], off_1[3], off_2[:] = np.nan, 0.5, 0.5, 1.0, 0.2, 0.2
    off[4], rho[5] = 0.0, -0.95  # with its bias below -1
    found = std, bias, flag = differences(one, other, rho, off_1, off_2, off)

    def apart(one, other, rho):
        return np.sqrt((one - other) ** 2 + 2 * one * other * (1 - rho))

    expected = apart(one, other, rho)
    with np.errstate(invalid="ignore"):
        truth = apart(one / (1 + off_1), other / (1 + off_2), np.clip(rho - off, -1, 1))
        relative = np.where((expected == 0) & (truth == 0), 0.0, expected / truth - 1)
    np.testing.assert_allclose(std, expected, rtol=1e-13)
    np.testing.assert_allclose(bias, relative, rtol=1e-12, atol=1e-15)
    np.testing.assert_array_equal(flag, np.where(np.isnan(bias), 2, np.abs(bias) > OFF))
    assert std[3, 4, 0] == bias[3, 4, 0] == flag[3, 4, 0] == 0
    given = np.broadcast_arrays(one, other, rho, off_1, off_2, off)
    for at in ((0, 0, 0), (3, 4, 0), (8, 9, 2)):  # not solved, equal, neither
        lone = differences(*(array[at] for array in given))
        for array, whole in zip(lone, found, strict=True):
            np.testing.assert_array_equal(array, whole[at])


def check(one, other, soil):
    truth = exact(one, other, soil)
    for pair in ((one, other), (other, one)):
        sides = [side([system], soil, [0])[2] for system in pair]
        for cells in (1, 2):  # a lone pair is not compiled
            assert table(*sides, (cells,)).rho[0] == pytest.approx(truth, abs=WORST)


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


def test_table_is_plain_numpys():
    rng = np.random.default_rng(43)
    soil = 2 * np.pi / 1.5, 0.1
    ones = [draw(rng, period) for period in 10 ** rng.uniform(-1, 1, 70)]
    others = [draw(rng, period) for period in 10 ** rng.uniform(-1, 1, 50)]
    systems, forcing, first = side(ones, soil, [1, 0])
    systems_2, forcing_2, second = side(others, soil, [0, 1])
    columns = EquivalentSystem(*(value[:, None] for value in systems))
    plain = pair_covariance(
        columns, type(forcing)(*(value[:, None] for value in forcing)), systems_2, forcing_2
    )
    plain /= first.parameters[-1][:, None] * second.parameters[-1]
    found = table(first, second, (70, 50)).rho.reshape(70, 50)
    np.testing.assert_allclose(found, np.clip(plain, -1, 1), rtol=0, atol=WORST)
    turned = table(
        first._replace(strides=np.array([0, 1])), second._replace(strides=np.array([1, 0])), (50, 70)
    )
    np.testing.assert_array_equal(turned.rho.reshape(50, 70).T, found)


def test_neither_threads_nor_parts_change_a_bit(monkeypatch):
    rng = np.random.default_rng(44)
    axis = [draw(rng, period) for period in np.geomspace(0.1, 10, 37)]
    _, _, first = side(axis, (5.0, 0.3), [37, 1, 0])
    first = first._replace(strides=np.array([0, 1, 0]))
    second = first._replace(strides=np.array([0, 0, 1]))
    shape = (3, 37, 37)
    whole = table(first, second, shape)
    for part in (1000, 129, 128, 77):
        monkeypatch.setattr(pair_tables, "PART", part)
        for cores in (1, 3):
            monkeypatch.setattr(parallel, "cores", lambda count=cores: count)
            for one, other in zip(whole, table(first, second, shape), strict=True):
                np.testing.assert_array_equal(one, other)


def test_failed_structures_blank_their_own_cells_only():
    rng = np.random.default_rng(45)
    axis = [draw(rng, period) for period in np.geomspace(0.1, 10, 200)]
    _, _, good = side(axis, (5.0, 0.3), [1, 0])
    bad = good._replace(flags=good.flags.copy(), parameters=good.parameters.copy())
    bad.flags[7, 0], bad.parameters[:, 7] = 3, np.nan
    one, two = (s._replace(gaussian=s.parameters) for s in (good, bad))
    other = good._replace(strides=np.array([0, 1]))
    clean, spoiled = (table(s, other, (200, 200)) for s in (one, two))
    rows = np.arange(200) != 7
    np.testing.assert_array_equal(spoiled.rho.reshape(200, 200)[rows], clean.rho.reshape(200, 200)[rows])
    assert np.isnan(spoiled.rho.reshape(200, 200)[7]).all()
    assert (spoiled.status.reshape(200, 200)[7] == 3).all()


@pytest.mark.parametrize("white_noise", [False, True])
def test_bias_is_the_map_interpolated_in_all_its_dimensions(white_noise):
    """Properties interpolated once and a plane of periods, against all corners at once."""
    rng = np.random.default_rng(46)
    n = 400
    own = {
        "damping": rng.uniform(0.02, 0.1, n),
        "hardening": rng.uniform(0.02, 1, n),
        "reduction_factor": 3 * rng.uniform(0.4, 3, n),
    }
    own = {name: np.where(np.arange(n) % 3, value, value[0]) for name, value in own.items()}
    period_1, ground_damping = rng.uniform(0.5, 4, n), cases.log_uniform(rng, (0.03, 1.0), n)
    period_2 = period_1 * rng.uniform(0.25, 1.0, n)
    ground = sl.WhiteNoise() if white_noise else sl.KanaiTajimi(1.5, ground_damping)
    found = sl.correlate(sl.Bilinear(period_1, **own), sl.Bilinear(period_2, **own), ground).bias
    map_ = bias_map()["rho_bias_white_noise" if white_noise else "rho_bias"]
    axes = [np.log(map_[dim].values.astype(float)) for dim in map_.dims]
    soil = [] if white_noise else [ground_damping, period_1 / 1.5]
    point = [own["reduction_factor"] / 3, own["hardening"], own["damping"], *soil, period_2 / period_1]
    expected = np.empty(n)
    interpolate(*Grid.of(axes, map_.values), np.log(np.stack(point)), expected)
    assert 100 < np.isfinite(expected).sum() < n
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-13)


def test_shared_dimension_and_broadcast_ones_together():
    """Every cell of a table with a shared, an own and a broadcast dimension, alone."""
    factor = xr.DataArray([2.0, 4.0], dims="R")
    first = sl.Bilinear(xr.DataArray([0.5, 1.0, 1.9], dims="a"), 0.05, 0.05, reduction_factor=factor)
    second = sl.Bilinear(xr.DataArray([0.8, 1.4], dims="b"), 0.05, 0.05, reduction_factor=factor)
    whole = sl.correlate(first, second, sl.KanaiTajimi(1.0, 0.1))
    for cell in np.ndindex(3, 2, 2):
        at = dict(zip(("a", "R", "b"), map(int, cell), strict=True))
        pair = (first.isel(at), second.isel(at))
        lone = sl.correlate(*pair, sl.KanaiTajimi(1.0, 0.1))
        for name in ("rho", "bias", "status", "caution"):
            np.testing.assert_array_equal(lone[name], whole[name].isel(at), err_msg=name)
