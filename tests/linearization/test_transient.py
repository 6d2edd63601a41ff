"""Transient linearization: against the Lyapunov differential equation, simulation and limits."""

import numpy as np
import pytest
import scipy.integrate
import scipy.linalg
from cases import covariances_in_time, with_slow

import stochlin as sl
from stochlin.applications.probability.formulas import moments_of_pair
from stochlin.solver.linearization.systems.state_space import models_of, problem_of
from stochlin.solver.linearization.transient_systems import course_of

pytestmark = pytest.mark.oracle

QUAKE = sl.AminAng(4.0, 12.0, 0.35)
DURATION = 18.0
BROAD = sl.KanaiTajimi(2 * np.pi / 15, 0.6, intensity=0.01)
GROUNDS = {
    "white": sl.WhiteNoise(0.01),
    "broad band": BROAD,
    "resonant": sl.KanaiTajimi(1.0, 0.05, intensity=1e-3),
    "high_pass": sl.CloughPenzien(0.42, 0.6, 4.2, 0.6, intensity=0.01),
}


@pytest.mark.parametrize("name", with_slow(GROUNDS, {"white", "high_pass", "resonant"}))
def test_linear_pair_follows_the_lyapunov_differential_equation(name):
    ground = GROUNDS[name]
    pair = sl.Bilinear(1.0, 0.05), sl.Bilinear(0.6, 0.02)
    course = course_of(QUAKE, DURATION, 0.6, 11)
    space = sl.statespace(pair, ground)
    whole = covariances_in_time(space, QUAKE, course.times, (4.0, 12.0, DURATION))
    own = space.get_index("state").get_indexer(["u_1", "v_1", "u_2", "v_2"])
    x = whole[:, own[:, None], own]
    problem = problem_of(models_of(pair, ground), in_time=True)
    moments = moments_of_pair(*problem, np.array([np.nan]), course, 0.6)
    d = np.array([1.0, 0.0, -1.0, 0.0])
    v = np.array([0.0, 1.0, 0.0, -1.0])
    d_d, v_v = d @ x @ d, v @ x @ v
    for found, expected, scale in (
        (moments.u_1[:, 0, 0], x[:, 0, 0], x[:, 0, 0]),
        (moments.u_2[:, 0, 0], x[:, 2, 2], x[:, 2, 2]),
        (moments.d_d[:, 0, 0], d_d, d_d),
        (moments.d_v[:, 0, 0], d @ x @ v, np.sqrt(d_d.max() * v_v.max())),
        (moments.v_v[:, 0, 0], v_v, v_v),
    ):
        np.testing.assert_allclose(found, expected, rtol=0, atol=2e-5 * np.max(scale))


@pytest.mark.parametrize(
    "structure",
    [
        sl.Bilinear(0.8, 0.05),
        sl.Bilinear(0.5, 0.05, 0.2, reduction_factor=4),
        sl.BoucWen(0.5, 0.05, 0.3, reduction_factor=3),
    ],
    ids=["elastic", "bilinear", "Bouc-Wen"],
)
@pytest.mark.parametrize("ground", with_slow([BROAD, GROUNDS["white"]], [GROUNDS["white"]]))
def test_meets_the_stationary_solution_when_the_envelope_stays_at_one(structure, ground):
    late = sl.transient_response(structure, ground, 25.0, points=3).isel(time=-1)
    stationary = sl.linearize(structure, ground)
    for name in ("displacement_std", "velocity_std", "c_eq", "k_eq"):
        assert float(late[name]) == pytest.approx(float(stationary[name]), rel=1e-4, abs=1e-12), (
            name
        )
    if structure.yields:
        assert float(late.z_std) == pytest.approx(float(stationary.z_std), rel=1e-4)


@pytest.mark.extreme
def test_starts_from_rest_and_scales_with_the_motion():
    one = sl.Bilinear(0.7, 0.05, 0.05, yield_displacement=0.02)
    two = sl.Bilinear(0.7, 0.05, 0.05, yield_displacement=0.04)
    strong = sl.KanaiTajimi(2 * np.pi / 15, 0.6, intensity=0.04)
    small, large = (
        sl.transient_response(s, g, 6.0, envelope=QUAKE) for s, g in ((one, BROAD), (two, strong))
    )
    assert float(small.displacement_std[0]) == 0
    assert float(small.velocity_std[0]) == 0
    np.testing.assert_allclose(
        large.displacement_std, 2 * small.displacement_std, rtol=1e-5, atol=1e-9
    )
    np.testing.assert_allclose(large.c_eq, small.c_eq, atol=1e-5)


def test_the_flag_of_the_permanent_set_left_out_rises_at_half_of_the_envelope():
    """Which decays as ``exp(-0.35 t)`` from 12 s on."""
    table = sl.transient_response(sl.Bilinear(0.5, 0.05), BROAD, 20.0, envelope=QUAKE, points=201)
    half = 12.0 + np.log(2) / 0.35
    assert table.attrs["strong_shaking_end_s"] == pytest.approx(half, abs=0.01)
    assert (
        table.permanent_set_left_out.values.astype(bool) == (table.time.values > half)
    ).mean() > 0.99
    steady = sl.transient_response(sl.Bilinear(0.5, 0.05), BROAD, 20.0)
    assert not steady.permanent_set_left_out.any()


def test_an_envelope_whose_slope_is_infinite_at_the_start_is_followed():
    """``t^0.4``: the first steps are as short as that takes."""
    quake, one = sl.GammaEnvelope(power=0.4, decay=0.2), sl.Bilinear(1.0, 0.05)
    found = sl.transient_response(one, sl.WhiteNoise(0.01), 8.0, envelope=quake, points=5)
    w, v = 2 * np.pi, 2 * np.pi * np.sqrt(1 - 0.05**2)
    for at, std in zip(found.time.values, found.displacement_std.values, strict=True):
        s = np.linspace(0, at**0.2, 20001) ** 5  # denser where the envelope is steep
        pulse = quake.at(s) * np.exp(-0.05 * w * (at - s)) * np.sin(v * (at - s)) / v
        variance = 2 * np.pi * 0.01 * scipy.integrate.trapezoid(pulse**2, s)
        assert std == pytest.approx(np.sqrt(variance), rel=1e-5, abs=1e-12)


@pytest.mark.extreme
def test_a_structure_that_would_need_too_short_steps_is_refused():
    weak = sl.BoucWen(0.5, 0.05, 0.05, yield_displacement=1e-6, exponent=2.5)
    with pytest.raises(
        ArithmeticError, match=r"so weak that .* give it more strength, or simulate"
    ):
        sl.transient_response(weak, BROAD, 80.0, envelope=QUAKE)
