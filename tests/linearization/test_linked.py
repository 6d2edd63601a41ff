"""Linked structures: exact limits, the unlinked pair, an ODE solver, simulation with its error."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import stochlin as sl
from stochlin.kernels.simulation.stepping import LANES
from stochlin.models.systems import assembly_of
from stochlin.solver.simulation.connected_structures import connected_groups

pytestmark = [pytest.mark.oracle, pytest.mark.extreme]

GROUND = sl.KanaiTajimi(0.5, 0.4)
NOTHING = sl.Link()


def elastic(period, mass):
    return sl.Bilinear(period, 0.05, mass=mass)


def yielding(period, mass, factor=4.0):
    return sl.Bilinear(period, 0.05, 0.1, reduction_factor=factor, mass=mass)


def assert_apart(linked, apart, tolerance):
    """A link between two is as if it was not there."""
    assert float(linked.rho[0, 1]) == pytest.approx(float(apart.rho), rel=tolerance)
    for n in (0, 1):
        for name in ("displacement_std", "ductility_std"):
            assert float(linked[name][n]) == pytest.approx(
                float(apart[f"{name}_{n + 1}"]), rel=tolerance
            )


@pytest.mark.parametrize("make", [elastic, yielding])
def test_link_without_constants_is_no_link(make):
    pair = make(0.6, 1e6), make(1.0, 3e6)
    assert_apart(sl.linearize_system(pair, GROUND, [NOTHING]), sl.correlate(*pair, GROUND), 1e-7)
    tables = [
        sl.simulate(pair, GROUND, paths=32, relaxation_times=5, link=link)
        for link in (None, NOTHING)
    ]
    np.testing.assert_allclose(tables[0].rho, tables[1].rho, rtol=0, atol=1e-9)


def test_a_structure_that_only_its_neighbour_makes_yield():
    """Tied to a heavy one by a rigid link it moves, and yields, as that does."""
    light = sl.Bilinear(0.1, 0.05, 0.05, yield_displacement=0.02, mass=1e3)
    heavy = sl.Bilinear(2.0, 0.05, mass=1e8)
    ground = sl.WhiteNoise(0.01)
    assert float(sl.linearize(light, ground).ductility_std) < 0.06
    table = sl.linearize_system([light, heavy], ground, [sl.Link(stiffness=1e9)])
    assert float(table.ductility_std[0]) > 2
    assert float(table.c_eq[0]) > -0.9


def test_linear_pair_has_the_moments_of_its_simulation():
    pair, link = (elastic(0.6, 1e6), elastic(1.0, 3e6)), sl.Link(5e7, 1e6)
    exact = sl.linearize_system(pair, GROUND, [link])
    table = sl.simulate(pair, GROUND, link=link, paths=512, seed=4)
    off = table.displacement_std.values - exact.displacement_std.values
    assert (abs(off) < 4 * table.displacement_std_standard_error).all()
    assert abs(float(table.rho[0, 1]) - float(exact.rho[0, 1])) < 4 * table.rho_standard_error[0, 1]


@pytest.mark.parametrize("hardening", [1.0, 0.2])
def test_motion_of_the_pair_is_that_of_an_ode_solver(hardening):
    """One lane under a smooth force; elastic, and bilinear with its events left to a small step."""
    pair = [
        sl.Bilinear(period, 0.05, hardening, yield_displacement=uy, mass=mass)
        for period, uy, mass in ((0.6, 0.25, 1.0), (1.0, 0.4, 2.0))
    ]
    system = assembly_of(pair, [sl.Link(20.0, 1.0)])
    mass, damping, _, _, post, couple, strength = system.storeys

    def force(t):
        return 60 * np.sin(4 * t) * np.exp(-0.3 * t)

    def rate(t, x):
        u, v, z = x.reshape(3, 2)
        pull = 20.0 * (u[0] - u[1]) + 1.0 * (v[0] - v[1])
        a = force(t) - (damping @ v + post * u + couple * z + pull * np.array([1.0, -1.0])) / mass
        sliding = (np.abs(z) >= strength) & (v * z > 0)
        return np.concatenate([v, a, np.where(sliding, 0, v)])

    seconds, errors = 4.0, []
    solved = solve_ivp(rate, (0, seconds), np.zeros(6), rtol=1e-9, atol=1e-10, max_step=2e-3)
    (frame,) = connected_groups(system)
    for steps in (1000, 2000):
        dt = seconds / steps
        f = np.repeat(force(dt * (np.arange(steps) + 0.5))[:, None], LANES, axis=1)
        out = np.empty((1, 2, LANES))
        frame.part.block(dt)(f, frame.part.at_rest(), steps, out)
        errors.append(np.abs(out[0, :, 0] - solved.y[:2, -1]).max() / np.abs(solved.y[:2]).max())
    assert errors[1] < 2e-4
    assert errors[1] < 0.4 * errors[0] or errors[0] < 1e-5
    if hardening < 1:
        assert np.abs(solved.y[:2] - solved.y[4:]).max() > 0.25  # it did yield
