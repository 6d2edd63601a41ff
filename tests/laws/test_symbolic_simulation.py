"""Simulation of laws written in sympy, against compiled laws and an exact linear case."""

import numpy as np
import pytest
import sympy

import stochlin as sl
from stochlin.kernels.simulation.laws import BOUC_WEN as KNOWN
from stochlin.kernels.simulation.laws import OTHER_LAW as OF_LAW
from stochlin.kernels.simulation.laws import advance, by_number
from stochlin.kernels.simulation.stepping import LANES
from stochlin.models.laws import bilinear

pytestmark = [pytest.mark.oracle, pytest.mark.extreme]

V, Z = sympy.symbols("v z")
GROUND = sl.KanaiTajimi(1.0, 0.3)
BOUC_WEN = V - 0.7 * sympy.Abs(V) * sympy.Abs(Z) * Z + 0.2 * V * Z**2  # beta 0.7, gamma -0.2, n 2


def test_step_of_a_law_is_that_of_the_compiled_one():
    rng = np.random.default_rng(1)
    rates, before = rng.normal(0, 8, LANES), rng.uniform(-1, 1, (1, LANES))
    own = np.repeat([[0.7], [-0.2], [2.0]], LANES, axis=1)
    after = np.empty((2, 1, LANES))
    for new, law in zip(after, (sl.Hysteretic(1.0, 0.05, law=BOUC_WEN).step(), KNOWN), strict=True):
        advance(by_number((law,)), OF_LAW, LANES, rates, before, own, 1 / 32, new)
    np.testing.assert_allclose(*after, rtol=0, atol=1e-14)


def corner(beyond):
    """A law with this part, which is to be 0 for |z| < 1 and |z| - 1 else."""
    loops = (sympy.Abs(V) * Z + V * sympy.Abs(Z)) / 2
    law = V - loops - sympy.Abs(V) * sympy.sign(Z) * beyond
    return sl.Hysteretic(0.5, 0.05, 0.1, reduction_factor=3.0, mass=1e5, law=law)


# The same law, but for 1e-10 near its kink: once as linearization takes it, once as it does not.
FOUND = corner(sympy.Max(sympy.Abs(Z) - 1, 0))
HIDDEN = corner((sympy.Abs(Z) - 1 + sympy.sqrt((sympy.Abs(Z) - 1) ** 2 + 1e-20)) / 2)
OTHER = sl.Bilinear(0.7, 0.05, 0.1, yield_displacement=0.1, mass=1e5)
STRENGTH = {"hardening": 0.1, "yield_drifts": 0.01}
MOTIONS = {"duration": 5.0, "paths": 32}


@pytest.mark.slow
def test_law_that_cannot_be_linearized_is_simulated():
    with pytest.raises(ArithmeticError, match="cannot be linearized"):
        sl.linearize(HIDDEN, GROUND)
    one, other = (sl.simulate([law, OTHER], GROUND, **MOTIONS) for law in (FOUND, HIDDEN))
    np.testing.assert_allclose(one.peak_mean, other.peak_mean, rtol=1e-8)
    for members in (
        [HIDDEN, OTHER],
        [sl.ShearBuilding([1e5], [1e7], [3.0], 0.05, law=HIDDEN.law, **STRENGTH)],
    ):
        stationary = sl.simulate(members, GROUND, paths=16, relaxation_times=2.0)
        assert np.isfinite(stationary.displacement_std).all()


@pytest.mark.slow
def test_maxwell_element_has_the_variance_of_its_linear_system():
    damper = sl.Hysteretic(1.0, 0.05, 0.3, yield_displacement=0.1, law=V - 3 * Z)
    spring = sl.Bilinear(0.7, 0.05)
    table = sl.simulate([damper, spring], GROUND, paths=512, seed=5)
    exact = sl.correlate(damper, spring, GROUND)
    off = float(table.displacement_std[0] - exact.displacement_std_1)
    assert abs(off) < 4 * float(table.displacement_std_standard_error[0])
    assert abs(float(table.rho[0, 1] - exact.rho)) < 4 * float(table.rho_standard_error[0, 1])


@pytest.mark.parametrize("steps", [32, 128])
def test_law_with_jumps_moves_as_the_return_map(steps):
    """Steps in which the law jumps are divided, until what passes the strength is 1/1000 of it."""
    written = sl.Hysteretic(1.0, 0.05, 0.1, reduction_factor=4, law=bilinear.symbolic())
    mapped = sl.Bilinear(1.0, 0.05, 0.1, reduction_factor=4)
    options = {"steps_per_period": steps, "paths": 32, "relaxation_times": 10}
    sigma = sl.simulate([written, mapped], GROUND, **options).displacement_std.values
    assert sigma[0] == pytest.approx(sigma[1], rel=1e-3)


STEEP = V - 1e4 * abs(V) * Z * abs(Z) ** 20
GIVEN = {"period": 0.5, "damping": 0.05, "hardening": 0.1, "yield_displacement": 0.005, "mass": 1e5}


def test_a_step_in_which_a_stage_overflows_is_divided():
    """Powers of 21 of a stage beyond z = 1 are not finite; the solution ends at its limit."""
    rates, before = np.array([40.0, -300.0, 1e3, -2e3]), np.array([[0.0, 0.5, -0.6, 0.64]])
    own, after = np.zeros((0, 4)), np.empty((1, 4))
    law = by_number((sl.Hysteretic(**GIVEN, law=STEEP).step(),))
    with np.errstate(all="ignore"):
        advance(law, OF_LAW, 4, rates, before, own, 0.02, after)
    np.testing.assert_allclose(after[0], np.sign(rates) * 1e-4 ** (1 / 21), atol=5e-4)


RUNAWAY = V + abs(V) * Z
FINITE_MOTION = sl.KanaiTajimi(0.4, 0.6, 0.02)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::stochlin.messages.DoubtfulInput")
@pytest.mark.parametrize(
    "verb",
    [
        lambda one, _: sl.simulate(
            [sl.Bilinear(0.7, 0.05), one], FINITE_MOTION, paths=32, duration=8.0
        ),
        lambda one, _: sl.simulate([sl.Bilinear(0.7, 0.05), one], FINITE_MOTION, paths=32),
        sl.respond,
        lambda one, record: sl.pound([one], motion=record),
    ],
    ids=["simulate", "stationary", "respond", "pound"],
)
def test_a_law_that_runs_away_has_no_peaks(verb):
    record = sl.simulated_motions(FINITE_MOTION, 8.0, paths=2, seed=3)[0]
    cure = r"no longer finite.*law Hysteretic \(stochlin.*\) grow without end.*states stay bounded"
    with pytest.raises(ArithmeticError, match=cure):
        verb(sl.Hysteretic(**GIVEN, law=RUNAWAY), record)
