"""Structures with no stiffness after yielding, or a negative one, in motions of finite length."""

import itertools

import numpy as np
import pytest
import xarray as xr
from scipy.integrate import solve_ivp

import stochlin as sl

pytestmark = [pytest.mark.oracle, pytest.mark.extreme]

GROUND = sl.KanaiTajimi(0.4, 0.6, 0.02)
W = 2 * np.pi / 0.5
GIVEN = {"period": 0.5, "damping": 0.05, "yield_displacement": 0.02}
LAWS = {
    "bilinear": sl.Bilinear,
    "bouc_wen": sl.BoucWen,
    "clough": sl.ModifiedClough,
    "flag": sl.Flag,
}


def record(values, dt=0.01):
    time = dt * np.arange(len(values))
    return xr.DataArray(values, dims="time", coords={"time": time}, attrs={"units": "m/s^2"})


def motion(seed=3, seconds=10.0, ground=GROUND):
    return sl.simulated_motions(ground, seconds, paths=2, seed=seed)[0]


def test_an_elastic_plastic_oscillator_under_a_step_is_known_by_hand():
    """Undamped: yield time from the elastic motion; then uniform deceleration up to the peak."""
    push, uy = 0.7 * W**2 * 0.02, 0.02  # 0.7 of the yield force: 1.4 uy if elastic
    begin = np.arccos(1 - uy * W**2 / push) / W
    rate = push / W * np.sin(W * begin)
    peak = uy + rate**2 / (2 * (W**2 * uy - push))
    almost = 1e-9
    structure = sl.Bilinear(0.5, almost, 0.0, uy)
    table = sl.respond(structure, record(np.full(101, -push)), refine=20)
    np.testing.assert_allclose(table.displacement.max(), peak, rtol=1e-5)
    after = table.displacement.values[np.argmax(table.displacement.values) :]
    swing = 2 * (uy - push / W**2)  # about the position that the push alone would give
    np.testing.assert_allclose(after.max() - after.min(), swing, rtol=1e-4)


def slopes(t, x, alpha, sample):
    u, v, z = x
    yields = (z >= 0.02 and v > 0) or (z <= -0.02 and v < 0)
    force = 2 * 0.05 * W * v + W**2 * (alpha * u + (1 - alpha) * z)
    return [v, -sample(t) - force, 0.0 if yields else v]


@pytest.mark.parametrize("alpha", [0.0, -0.05])
def test_both_ways_of_stepping_follow_an_independent_integrator(alpha):
    """Event-free eighth order in small steps against exact branches and trapezoidal steps."""
    ground = motion(seconds=3.0)
    time, values = ground.time.values, ground.values * 0.6
    fine = np.linspace(0, time[-1], 4 * (time.size - 1) + 1)
    x, states = np.zeros(3), [0.0]
    for a, b in itertools.pairwise(fine):
        span = solve_ivp(
            slopes, (a, b), x, "DOP853", rtol=1e-8, atol=1e-11, max_step=(b - a) / 2,
            args=(alpha, lambda t: np.interp(t, time, values)),
        )  # fmt: skip
        x = span.y[:, -1]
        x[2] = np.clip(x[2], -0.02, 0.02)
        states.append(x[0])
    exact = sl.respond(sl.Bilinear(hardening=alpha, **GIVEN), record(values, time[1]), refine=4)
    size = np.abs(states).max()
    assert size > 0.025
    assert "collapse_s" not in exact.attrs
    np.testing.assert_allclose(exact.displacement, states, atol=2e-3 * size)
    gap = sl.recorded_gap(
        sl.Bilinear(hardening=alpha, **GIVEN), sl.Flag(0.8, 0.05), record(values, time[1])
    )
    np.testing.assert_allclose(gap.peak_1, size, rtol=5e-3)


@pytest.mark.parametrize("kind", LAWS)
@pytest.mark.parametrize("alpha", [0.0, -0.03])
def test_energies_add_up(kind, alpha):
    table = sl.respond(LAWS[kind](hardening=alpha, **GIVEN), 0.5 * motion(), refine=4)
    parts = [
        table[f"{name}_energy_per_mass"] for name in ("viscous", "hysteretic", "kinetic", "elastic")
    ]
    most = float(table.input_energy_per_mass.max())
    np.testing.assert_allclose(sum(parts), table.input_energy_per_mass, atol=1e-4 * most)


def test_p_delta_is_a_softer_oscillator_with_less_hardening():
    """A weight taking the share theta of the stiffness: period, damping, hardening and uy move."""
    alpha, theta, mass, height = 0.05, 0.08, 1e5, 3.0
    k = sl.models.buildings.shear.GRAVITY * mass / (theta * height)
    leaning = sl.ShearBuilding([mass], [k], [height], 0.05, alpha, 0.02, p_delta=True)
    left = 1 - theta
    period = 2 * np.pi * np.sqrt(mass / (left * k))
    plain = sl.Bilinear(period, 0.05, (alpha - theta) / left, 0.02)
    ground = motion()
    one, other = sl.respond(leaning, ground, refine=4), sl.respond(plain, ground, refine=4)
    assert float(abs(other.displacement).max()) > 0.04
    np.testing.assert_allclose(one.displacement[:, 0], other.displacement, atol=2e-4)
    with pytest.raises(
        ValueError, match=r"hardening = -0\.0326.* leaves no stiffness after yielding"
    ):
        sl.linearize(plain, GROUND)


def test_a_structure_falls_where_its_force_is_gone():
    """The exact time at which the plastic branch, an exponential, passes the limit."""
    alpha, uy = -0.1, 0.02
    limit = (1 - alpha) / -alpha * uy
    structure = sl.Bilinear(0.5, 1e-9, alpha, uy)
    push = 1.2 * W**2 * uy  # more than it can carry
    ground = record(np.full(301, -push))
    table = sl.respond(structure, ground)
    begin = np.arccos(1 - uy * W**2 / push) / W
    rate, pace = push / W * np.sin(W * begin), W * np.sqrt(-alpha)
    # u = top + grows e^(pace t) + falls e^(-pace t) from the instant of yield on
    top = limit - push / pace**2
    grows, falls = 0.5 * (uy - top + rate / pace), 0.5 * (uy - top - rate / pace)
    roots = np.roots([grows, top - limit, falls])
    expected = begin + np.log(roots.max()) / pace
    assert expected <= table.collapse_s <= expected + 0.01
    assert np.isnan(table.displacement[table.time > table.collapse_s]).all()
    assert np.isfinite(table.displacement[table.time <= table.collapse_s]).all()
    gap = sl.recorded_gap(structure, sl.Bilinear(0.4, 0.05), ground)
    assert np.isposinf(gap.separation)
    assert np.isposinf(gap.peak_1)
    assert np.isfinite(gap.peak_2)
    stepped = sl.recorded_gap(structure, sl.Flag(0.4, 0.05), ground)
    assert np.isposinf(stepped.separation)
    assert np.isposinf(
        sl.response_spectrum(
            ground, 0.5, 0.01, hardening=alpha, yield_displacement=uy
        ).displacement_max
    )
    heavy = sl.Bilinear(0.5, 0.01, alpha, uy, mass=1e5)
    with pytest.raises(
        ArithmeticError,
        match=r"structure 1 falls over \d.* s after the beginning: it has drifted",
    ):
        sl.pound([heavy], motion=ground)


@pytest.mark.parametrize("kind", LAWS)
def test_motions_in_which_a_structure_falls_are_counted_and_exceed_any_gap(kind):
    uy = 0.05 if kind == "bouc_wen" else 0.02
    weak = GIVEN | {"yield_displacement": uy}
    falling, other = LAWS[kind](hardening=-0.15, **weak), sl.Bilinear(0.8, 0.05, mass=1e5)
    table = sl.simulate([falling, other], GROUND, paths=64, duration=10.0, quantiles=[0.05, 0.99])
    fallen = np.isposinf(table.peak[:, 0])
    share = float(fallen.mean())
    assert 0 < share < 1
    assert not np.isposinf(table.peak[:, 1]).any()
    np.testing.assert_allclose(table.collapse_probability, [share, 0])
    assert float(table.collapse_probability_upper[1]) == pytest.approx(1 - 0.025 ** (1 / 64))
    np.testing.assert_array_equal(np.isposinf(table.separation[:, 0, 1]), fallen)
    assert np.isposinf(table.separation_quantile.sel(quantile=0.99)[0, 1])
    assert np.isfinite(table.separation_quantile.sel(quantile=0.05)[0, 1]) or share > 0.9
    assert float(table.peak[:, 0].where(~fallen).max()) < 1.15 / 0.15 * uy + 1e-12
    beyond = sl.exceedance(table.separation[:, 0, 1], np.inf)
    assert float(beyond.probability) == share


QUAKE = {"duration": 10.0, "envelope": sl.AminAng(2.0, 8.0, 0.4)}
SHOP = sl.Bilinear(0.8, 0.05, mass=1e5)


def test_motions_in_which_a_structure_falls_pound():
    """Also of cells beside others: the probabilities of those motions of `simulate`."""
    falling = sl.Bilinear(0.5, 0.05, -0.15, 0.02)
    gaps = [0.05, 0.3]
    table = sl.pounding_probability(falling, SHOP, GROUND, gaps, paths=64, points=3, **QUAKE)
    motions = sl.simulate([falling, SHOP], GROUND, paths=64, **QUAKE)
    share = float(motions.collapse_probability[0])
    assert 0.1 < share <= 1
    apart = motions.separation[:, 0, 1]
    np.testing.assert_allclose(
        table.confidence_of_no_pounding_simulated, [float((apart <= gap).mean()) for gap in gaps]
    )
    assert np.isposinf(table.required_gap_simulated).all()
