"""The closure that keeps the plastic drift: its parts by other ways, its limits, simulations."""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import dblquad, quad
from scipy.linalg import expm, solve_continuous_lyapunov
from scipy.special import erf

import stochlin as sl
from stochlin.kernels.linearization import drift
from stochlin.kernels.linearization.covariance import EquivalentSystem
from stochlin.kernels.linearization.filters import Filter
from stochlin.kernels.linearization.gaussian import slip_quadrant
from stochlin.models.laws import bilinear
from stochlin.solver.linearization.equivalent_systems import solved_together

pytestmark = [pytest.mark.oracle, pytest.mark.extreme]

TAU = 2 * np.pi
LAKEBED = sl.KanaiTajimi(period=1.0, damping=0.05)
NONE = np.empty((0, 1))


def building(period=1.0, reduction_factor=4.0, hardening=0.05, damping=0.05):
    return sl.Bilinear(period, damping, hardening, reduction_factor=reduction_factor)


def log_uniform(low, high):
    return st.floats(np.log(low), np.log(high)).map(lambda x: float(np.exp(x)))


buildings = st.builds(
    sl.Bilinear,
    period=log_uniform(0.02, 50),
    damping=log_uniform(0.002, 0.5),
    hardening=log_uniform(0.002, 1),
    reduction_factor=log_uniform(1e-3, 50),
)
grounds = st.one_of(
    st.just(sl.WhiteNoise()),
    st.builds(sl.KanaiTajimi, period=st.just(1.0), damping=log_uniform(0.02, 2)),
    st.builds(
        sl.CloughPenzien,
        period=st.just(1.0),
        damping=log_uniform(0.02, 2),
        high_pass_period=log_uniform(2, 50),
        high_pass_damping=log_uniform(0.2, 1),
    ),
)


def random_systems(rng, count):
    """Equivalent systems with k_e of the order of w, and the soils under them."""
    w, xi = rng.uniform(1, 10, count), rng.uniform(0.01, 0.3, count)
    system = EquivalentSystem(
        w**2,
        2 * xi * w,
        (1 - rng.uniform(0.02, 0.9, count)) * w**2,
        rng.random(count),
        w * rng.random(count),
    )
    wg, xig = rng.uniform(1, 10, count), rng.uniform(0.03, 1, count)
    return system, np.stack([np.ones(count), wg, xig])


# --- its parts, by other ways
# -----------------------------------------------------------------------


@pytest.mark.parametrize("sz", [0.25, 0.5, 1.0, 4.0])
def test_orders_add_up_to_the_variance_of_the_kick_sizes(sz):
    def moment(power):
        density = lambda a: a / sz**2 * np.exp(-0.5 * (a / sz) ** 2)  # noqa: E731
        return quad(
            lambda a: (a - 1) ** power * density(a), 1, 1 + 12 * sz, epsabs=0, epsrel=1e-11
        )[0]

    orders = drift._orders(np.array([sz]))[:, 0]
    assert (orders >= 0).all()
    assert orders.sum() == pytest.approx(moment(2) / moment(1) ** 2 - 1, rel=1e-3)


def test_orders_are_those_of_the_joint_density_of_two_amplitudes():
    """Sizes in two half-cycles: their covariance by orders, and by sampling Gaussian envelopes."""
    rng, size, sz, memory = np.random.default_rng(1), 400_000, 0.9, 0.7
    one, fresh = rng.standard_normal((2, 2, size)) * sz
    other = memory * one + np.sqrt(1 - memory**2) * fresh
    kicks = [np.maximum(np.hypot(*envelope) - 1, 0) for envelope in (one, other)]
    mean = np.mean(kicks)
    products = (kicks[0] - mean) * (kicks[1] - mean) / mean**2
    orders = drift._orders(np.array([sz]))[:-1, 0]
    expected = (orders * memory ** (2 * np.arange(1, orders.size + 1))).sum()
    error = products.std() / np.sqrt(size)
    # The mean of the sizes is sampled too; orders beyond the last hold less than .7^26 of the sum.
    assert abs(products.mean() - expected) < 4 * error + 1e-4 * orders.sum()


@pytest.mark.parametrize("latent", [(1.0, 0.4, 0.1), (2.0, 1.0, 0.3), (0.7, 3.0, -0.2)])
def test_relaxation_is_the_flow_when_the_mean_of_z_is_shifted(latent):
    sv, sz, r = latent
    shift = 1e-4

    def density(v, z):
        q = (v / sv) ** 2 - 2 * r * v * z / (sv * sz) + (z / sz) ** 2
        return np.exp(-0.5 * q / (1 - r * r)) / (TAU * sv * sz * np.sqrt(1 - r * r))

    def flow(by):  # E[y'] with z~ shifted: slip upwards beyond 1, downwards below -1
        up = dblquad(lambda v, z: v * density(v, z - by), 1, 12 * sz, 0, 9 * sv, epsabs=1e-12)[0]
        return (
            up
            - dblquad(lambda v, z: v * density(v, z + by), 1, 12 * sz, 0, 9 * sv, epsabs=1e-12)[0]
        )

    gradient = (flow(shift) - flow(-shift)) / (2 * shift)
    column = np.array(latent)[:, None]
    probability, by_z = bilinear.gaussian(column, NONE).coefficients[:, 0]
    assert gradient == pytest.approx(by_z, rel=1e-4)
    w, d, alpha = 3.0, 0.3, 0.1
    system = EquivalentSystem(*(np.array([x]) for x in (w * w, d, (1 - alpha) * w * w, 0.1, 1.0)))
    # Slowly: z = -alpha y - d y'/w^2, v = (1 - alpha) y', and y' = P v + (gradient / P(|z~| < 1))
    # z.
    per_z = gradient / erf(1 / sz / np.sqrt(2))
    expected = alpha * per_z / (1 - (1 - alpha) * probability + d * per_z / w**2)
    rate = drift._relaxation(system, column, slip_quadrant(column[1], column[2]))
    assert rate[0] == pytest.approx(expected, rel=1e-4)


@pytest.mark.parametrize("soil", [True, False])
def test_half_cycles_are_those_of_the_matrix_exponential(soil):
    rng = np.random.default_rng(5)
    system, ground = random_systems(rng, 40)
    cycles = drift.half_cycles(system, Filter.kanai_tajimi(*ground) if soil else Filter(ground[0]))
    for n in range(40):
        w2, d, h, p, k = (row[n] for row in system)
        wg, xig = ground[1:, n]
        size = 5 if soil else 3
        a, noise = np.zeros((size, size)), np.zeros((size, size))
        a[0, 1], a[1, :3], a[2, :3] = 1, (-w2, -d, h), (k, p, -k)
        if soil:
            a[1, 3:], a[3, 4], a[4, 3:] = (wg**2, 2 * xig * wg), 1, (-(wg**2), -2 * xig * wg)
        noise[-1 if soil else 1, -1 if soil else 1] = 1
        covariance = solve_continuous_lyapunov(a, -noise)
        half = expm(a * cycles.time[n])
        z = np.array([1.0, 0, -1] + [0, 0] * soil)
        remembered, state = [], covariance @ z
        for _ in range(drift.HALF_CYCLES):
            state = half @ state
            remembered.append(z @ state / (z @ covariance @ z))
        np.testing.assert_allclose(cycles.memory[:, n], remembered, rtol=0, atol=1e-8)
        rate = a[0, :] - a[2, :]  # of z
        expected = np.pi * np.sqrt((z @ covariance @ z) / (rate @ covariance @ rate))
        assert cycles.time[n] == pytest.approx(expected, rel=1e-9)


def test_what_merely_alternates_leaves_nothing():
    alternating = (-1.0) ** np.arange(1, drift.HALF_CYCLES + 1)[:, None]
    np.testing.assert_allclose(drift._sums_of_powers(alternating), 0, atol=1e-12)
    np.testing.assert_allclose(drift._sums_of_powers(0 * alternating), 1)
    decay = 0.5
    geometric = drift._sums_of_powers(alternating * decay ** np.arange(1, 41)[:, None])[:, 0]
    power = decay ** (2 * np.arange(1, drift.ORDERS + 1) + 1)
    # Bartlett's window takes off 1/40 of the first term at most.
    np.testing.assert_allclose(geometric, (1 - power) / (1 + power), atol=0.05 * decay**3)


@settings(deadline=None, max_examples=200)
@given(
    st.floats(-1, 1),
    st.lists(st.floats(0, 1), min_size=drift.ORDERS + 1, max_size=drift.ORDERS + 1),
    st.lists(st.floats(0, 1), min_size=drift.ORDERS + 1, max_size=drift.ORDERS + 1),
    log_uniform(1e-6, 1e6),
)
def test_correlation_of_drifts_is_one(coherence, shares_1, shares_2, ratio):
    both = [np.array(s)[:, None] / max(sum(s), 1e-300) for s in (shares_1, shares_2)]

    def side(shares, rate):
        return drift.DriftingSide(None, rate, np.sqrt(2 * rate * shares))

    first, second = side(both[0], 1.0), side(both[1], ratio)
    found = drift.drift_covariance(np.array([coherence]), first, second)
    assert abs(found[0]) <= 1 + 1e-12
    back = drift.drift_covariance(np.array([coherence]), second, first)
    assert found[0] == pytest.approx(back[0], rel=1e-12, abs=1e-300)
    if sum(shares_1) > 0:
        other = side(both[0], ratio)
        assert drift.drift_covariance(np.ones(1), other, other)[0] == pytest.approx(1, rel=1e-12)


# --- limits and symmetries
# --------------------------------------------------------------------------


@settings(deadline=None, max_examples=25)
@given(buildings, buildings, grounds)
def test_rho_and_sigma_are_possible_over_the_whole_domain(first, second, ground):
    def cells(structure):
        return replace(structure, period=np.array([structure.period]))

    table = sl.correlate(cells(first), cells(second), ground, closure="drift")
    derived = solved_together((first,), ground, "drift").values
    if int(table.status[0]) >= 2:
        assert np.isnan(table.rho[0])
        return
    assert abs(table.rho[0]) <= 1
    assert table.displacement_std_1[0] > 0
    total = 1 if derived["drift_std"] > 0 else 0
    assert derived["drift_shares"].sum() == pytest.approx(total, abs=1e-12)


@pytest.mark.parametrize("ground", [sl.WhiteNoise(), LAKEBED], ids=["white noise", "lake bed"])
def test_elastic_limit_is_exact(ground):
    elastic = sl.correlate(sl.Bilinear(0.8, 0.05), sl.Bilinear(1.1, 0.05), ground)
    strong = [building(period, reduction_factor=0.1) for period in (0.8, 1.1)]
    linear = [building(period, hardening=1.0) for period in (0.8, 1.1)]
    for pair in (strong, linear, [sl.Bilinear(0.8, 0.05), sl.Bilinear(1.1, 0.05)]):
        table = sl.correlate(*pair, ground, closure="drift")
        assert float(table.rho) == pytest.approx(float(elastic.rho), abs=1e-9)
        for name in ("displacement_std_1", "displacement_std_2"):
            assert float(table[name]) == pytest.approx(float(elastic[name]), rel=1e-9)


def test_drift_fades_with_hardening_and_strength():
    hardening = xr.DataArray([0.02, 0.1, 0.3, 0.7, 0.95, 1.0], dims="hardening")
    weaker = building(hardening=hardening)
    clipped, derived = (
        solved_together((weaker,), LAKEBED, each).values for each in ("clipped", "drift")
    )
    share = derived["drift_std"] / clipped["displacement_std"]
    assert (np.diff(share) < 0).all()
    assert share[-1] == 0
    factor = xr.DataArray(np.linspace(0.2, 0.6, 81), dims="R")
    table = sl.linearize(building(reduction_factor=factor, hardening=0.02), LAKEBED, "drift")
    excess = table.ductility_std / (factor / 3) - 1
    assert (np.abs(excess[factor < 0.45]) < 1e-4).all()
    assert float(np.abs(excess.diff("R")).max()) < 0.03  # no step where yielding ends


def test_drift_grows_from_rest_for_a_million_periods():
    """Its variance is that of a first-order process, also where that is not stationary by then."""
    hardening = xr.DataArray([1e-8, 1e-7, 1e-6, 1e-5], dims="hardening")
    values = solved_together((building(hardening=hardening),), LAKEBED, "drift").values
    twice = 2 * values["drift_rate"]
    intensity = values["drift_std"] ** 2 * twice / -np.expm1(-twice * 1e6)
    assert 0.1 < twice[2] * 1e6 < 10
    np.testing.assert_allclose(intensity, intensity[0], rtol=1e-4)


def test_fast_response_is_that_of_the_clipped_closure():
    kept, lost = (sl.linearize(building(), LAKEBED, closure) for closure in ("drift", "clipped"))
    for name in ("velocity_std", "z_std", "velocity_z_corr", "c_eq", "k_eq", "yield_displacement"):
        assert float(kept[name]) == float(lost[name])


# --- against simulation
# -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("ground", "pair", "tolerance"),
    [
        (sl.WhiteNoise(), (building(0.5, 4.0, 0.04), building(0.9, 7.0, 0.15, 0.03)), (0.03, 0.06)),
        (
            sl.KanaiTajimi(1.0, 0.5),
            (building(1.6, 5.0, 0.07), building(2.3, 3.0, 0.03)),
            (0.04, 0.06),
        ),
        (
            sl.KanaiTajimi(1.0, 0.06),
            (building(1.1, 6.0, 0.12), building(1.5, 4.0, 0.3)),
            (0.04, 0.08),
        ),
    ],
    ids=["white noise", "broad band", "lake bed"],
)
def test_unequal_pairs_meet_fresh_simulations(ground, pair, tolerance):
    """Off the map's nodes; tolerances: about three times the mean error of 500 such pairs."""
    table = sl.correlate(*pair, ground, closure="drift")
    exact = sl.simulate(list(pair), ground, paths=128, seed=11, steps_per_period=16)
    for n in (0, 1):
        sigma, error = exact.displacement_std[n], exact.displacement_std_standard_error[n]
        assert abs(table[f"displacement_std_{n + 1}"] - sigma) < tolerance[0] * sigma + 4 * error
    assert abs(table.rho - exact.rho[0, 1]) < tolerance[1] + 4 * exact.rho_standard_error[0, 1]


def test_clough_penzien_ground_meets_fresh_simulations():
    """Mean errors of twelve structures and their pairs; by the soil's memory alone .23 and .24."""
    random = np.random.default_rng(8)
    columns = [
        np.exp(random.uniform(*np.log(ends), 12)) for ends in ((0.3, 3), (0.02, 0.1), (2, 10))
    ]
    periods, hardenings, factors = columns
    ground = sl.named_ground("ec8_b", 1.0)
    structures = [
        building(period * ground.period, factor, hardening)
        for period, hardening, factor in zip(periods, hardenings, factors, strict=True)
    ]
    exact = sl.simulate(
        structures, ground, paths=64, seed=3, relaxation_times=10, steps_per_period=16
    )
    sigma, rho = exact.displacement_std.values, exact.rho.values
    axes = [[xr.DataArray(column, dims=f"structure_{n}") for column in columns] for n in (1, 2)]
    pair = [building(p * ground.period, r, a) for p, a, r in axes]
    table = sl.correlate(*pair, ground, closure="drift")
    found = table.displacement_std_1.values.ravel()[:12], table.rho.values
    i, j = np.triu_indices(12, 1)

    def apart(std, rho):
        return np.sqrt(std[i] ** 2 + std[j] ** 2 - 2 * rho[i, j] * std[i] * std[j])

    assert np.abs(found[0] / sigma - 1).mean() < 0.06
    assert np.abs(apart(*found) / apart(sigma, rho) - 1).mean() < 0.06


def test_caution_outside_of_what_was_simulated():
    inside = sl.linearize(building(), LAKEBED, "drift")
    assert int(inside.caution) == 0
    beyond = sl.linearize(building(damping=0.005), LAKEBED, "drift")  # of the map, but checked
    assert int(beyond.caution) == 0
    assert float(beyond.displacement_error) >= 0.03 > float(inside.displacement_error)
    assert int(sl.linearize(building(damping=0.29), LAKEBED, "drift").caution) == 0
    outside = [building(damping=0.004), building(damping=0.31), building(reduction_factor=13)]
    outside.append(building(hardening=0.009))
    for structure in outside:
        table = sl.linearize(structure, LAKEBED, "drift")
        assert np.isnan(table.bias)
        assert int(table.caution) == 2
    for high_pass_period, damping, caution in ((10.0, 0.6, 0), (40.0, 0.6, 2), (10.0, 0.1, 2)):
        ground = sl.CloughPenzien(
            1.0, 0.3, high_pass_period=high_pass_period, high_pass_damping=damping
        )
        assert int(sl.linearize(building(), ground, "drift").caution) == caution
    soft = building(
        period=8.0
    )  # its period after yield is beyond what the high-pass oscillator passes
    ground = sl.CloughPenzien(1.0, 0.3, high_pass_period=3.0, high_pass_damping=0.6)
    assert int(sl.linearize(soft, ground, "drift").caution) == 2


@pytest.mark.parametrize(("period", "factor"), [(0.3, 3.0), (1.0, 6.0), (4.0, 1.0)])
def test_the_least_error_is_0_03_in_place_of_0_01_on_clough_penzien_ground(period, factor):
    structure = building(period=period, reduction_factor=factor)
    grounds = sl.KanaiTajimi(1.0, 0.3), sl.CloughPenzien(1.0, 0.3, 10.0, 0.6)
    mapped, beyond = (
        float(sl.linearize(structure, g, "drift").displacement_error) for g in grounds
    )
    assert mapped > 0.01
    assert beyond**2 - mapped**2 == pytest.approx(0.03**2 - 0.01**2, rel=1e-9)


@pytest.mark.parametrize(
    ("structure", "damping", "simulated"),
    [
        (sl.Bilinear(0.36, 0.033, 0.137, reduction_factor=1.845), 0.034, 0.225),
        (sl.Bilinear(0.3014, 0.0989, 0.0925, reduction_factor=2.70), 0.0515, None),
        (sl.Bilinear(0.525, 0.030, 0.339, reduction_factor=6.43), 0.0332, None),
    ],
)
def test_resonance_after_yield_is_refined_or_cautioned(structure, damping, simulated):
    """Near T = sqrt(alpha) Tg the map is steep: off by 15 to 28 % between its coarse points."""
    ground = sl.KanaiTajimi(1.0, damping)
    table = sl.linearize(structure, ground, "drift")
    exact = sl.simulate([structure], ground, paths=128, seed=5, steps_per_period=16)
    sigma = float(exact.displacement_std[0])
    if simulated is not None:
        assert sigma == pytest.approx(simulated, rel=0.05)
    off = float(table.displacement_std) / sigma - 1
    assert abs(off) < 0.1 or int(table.caution) == 1
    assert abs(off) < 4 * float(table.displacement_error)
    assert float(table.bias) == 0  # what is known of it is in displacement_std


def test_correction_has_no_steps_at_the_ends_of_the_map():
    for name, edge in (
        ("damping", 0.1),
        ("reduction_factor", 3.2 * 3),
        ("period", 10.0),
        ("hardening", 0.02),
    ):
        sides = [replace(building(), **{name: edge * f}) for f in (1 - 1e-7, 1 + 1e-7)]
        low, high = (float(sl.linearize(side, LAKEBED, "drift").ductility_std) for side in sides)
        assert low == pytest.approx(high, rel=1e-5)


@pytest.mark.parametrize("factor", [1e-3, 7.0])
def test_time_intensity_and_strength_are_only_scales(factor):
    table = sl.correlate(building(0.7), building(1.2), LAKEBED, closure="drift")
    slow_ground = sl.KanaiTajimi(factor, 0.05)
    slow = sl.correlate(
        building(0.7 * factor), building(1.2 * factor), slow_ground, closure="drift"
    )
    louder = replace(LAKEBED, intensity=factor)
    strong = sl.correlate(building(0.7), building(1.2), louder, closure="drift")
    for other in (slow, strong):
        assert float(other.rho) == pytest.approx(float(table.rho), abs=1e-9)
        assert float(other.ductility_std_1) == pytest.approx(float(table.ductility_std_1), rel=1e-8)
    std = float(table.displacement_std_1) * np.sqrt(factor)
    assert float(strong.displacement_std_1) == pytest.approx(std, rel=1e-8)


def test_order_of_the_structures_does_not_matter():
    first, second = building(0.4, 6.0, 0.02), building(1.3, 2.0, 0.3)
    there, back = (
        float(sl.correlate(*pair, LAKEBED, closure="drift").rho)
        for pair in ((first, second), (second, first))
    )
    assert there == pytest.approx(back, abs=1e-12)
