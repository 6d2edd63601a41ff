"""Linked structures: exact limits, the unlinked pair, an ODE solver, and simulation with its error."""

import numpy as np
import pytest
import scipy.integrate

import stochlin as sl
from stochlin.kernels.basics.systems import System
from stochlin.kernels.simulation.ensemble import SteppedStructures
from stochlin.kernels.simulation.laws import BILINEAR, LINEAR, by_number
from stochlin.kernels.simulation.moving import Elements
from stochlin.kernels.simulation.stepping import LANES

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
        sl.simulate(pair, GROUND, paths=32, relaxation_times=5, link=link) for link in (None, NOTHING)
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
    d, k, h = (
        np.array([0.6, 0.3]),
        hardening * np.array([100.0, 40.0]),
        (1 - hardening) * np.array([100.0, 40.0]),
    )
    scale, link_k, link_c = np.array([1.0, 1.5]), np.array([20.0, 10.0]), np.array([1.0, 0.5])
    ratio = np.array([scale[0] / scale[1], scale[1] / scale[0]])
    mass, apart = link_k[0] / link_k, np.array([1.0, -1.0])
    system = System(
        mass,
        np.diag(d * mass) + link_c[0] * np.outer(apart, apart),
        np.vstack([np.eye(2), apart]),
        np.eye(2),
        np.append(k * mass, link_k[0]),
        np.append(h * mass, 0.0),
        np.append(1 / scale, np.inf),
    )
    elements = Elements(
        system,
        np.array([BILINEAR, BILINEAR, LINEAR]),
        np.ones(3, int),
        np.empty((3, 0)),
    )

    def force(t):
        return 60 * np.sin(4 * t) * np.exp(-0.3 * t)

    def rate(t, x):
        u, v, z = x.reshape(3, 2)
        other = slice(None, None, -1)
        pull = link_k * (u - ratio * u[other]) + link_c * (v - ratio * v[other])
        a = scale * force(t) - d * v - k * u - h * z - pull
        sliding = (np.abs(z) >= 1) & (v * z > 0)
        return np.concatenate([v, a, np.where(sliding, 0, v)])

    seconds = 4.0
    solved = scipy.integrate.solve_ivp(
        rate, (0, seconds), np.zeros(6), rtol=1e-9, atol=1e-10, max_step=2e-3
    )
    errors = []
    for steps in (1000, 2000):
        dt = seconds / steps
        middle = dt * (np.arange(steps) + 0.5)
        f = np.repeat(force(middle)[:, None], LANES, axis=1)
        part, out = SteppedStructures(elements, by_number(())), np.empty((1, 2, LANES))
        part.block(dt)(f, part.at_rest(), steps, out)
        errors.append(np.abs(out[0, :, 0] * scale - solved.y[:2, -1]).max() / np.abs(solved.y[:2]).max())
    assert errors[1] < 2e-4
    assert errors[1] < 0.4 * errors[0] or errors[0] < 1e-5
    if hardening < 1:
        assert np.abs(solved.y[:2] - solved.y[4:]).max() > 0.5  # it did yield
