"""Linked structures: exact limits, the unlinked pair, an ODE solver, and simulation with its error."""

import numpy as np
import pytest
import scipy.integrate
import sympy

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


V, Z = sympy.symbols("v z")
BOUC_WEN = sl.BoucWen(0.6, 0.05, 0.1, reduction_factor=3, gamma=0.2, exponent=2.0, mass=1e6)
OWN = sl.Hysteretic(
    0.6, 0.05, 0.1, reduction_factor=3, mass=1e6, law=V - 0.5 * abs(V) * Z - 0.5 * V * abs(Z)
)


@pytest.mark.parametrize("first", [BOUC_WEN, OWN], ids=["Bouc-Wen", "in symbols"])
def test_every_law_can_be_linked(first):
    second = yielding(1.0, 3e6)
    linked = sl.linearize_system([first, second], GROUND, [NOTHING])
    assert_apart(linked, sl.correlate(first, second, GROUND), 1e-9)
    tied = sl.linearize_system([first, second], GROUND, [sl.Link(1e12)])
    assert float(tied.rho[0, 1]) == pytest.approx(1, abs=1e-6)


def test_a_structure_that_only_its_neighbour_makes_yield():
    """Tied to a heavy one by a rigid link it moves, and yields, as that does."""
    light = sl.Bilinear(0.1, 0.05, 0.05, yield_displacement=0.02, mass=1e3)
    heavy = sl.Bilinear(2.0, 0.05, mass=1e8)
    ground = sl.WhiteNoise(0.01)
    assert float(sl.linearize(light, ground).ductility_std) < 0.06
    table = sl.linearize_system([light, heavy], ground, [sl.Link(stiffness=1e9)])
    assert float(table.ductility_std[0]) > 2
    assert float(table.c_eq[0]) > -0.9


def test_rigid_link_makes_one_structure_of_two():
    w, masses = 2 * np.pi / np.array([0.6, 1.0]), np.array([1e6, 3e6])
    pair = elastic(0.6, 1e6), elastic(1.0, 3e6)
    tied = sl.linearize_system(pair, GROUND, [sl.Link(stiffness=1e13)])
    stiffness = (masses * w**2).sum() / masses.sum()
    damping = (masses * 2 * 0.05 * w).sum() / masses.sum()
    one = sl.Bilinear(2 * np.pi / np.sqrt(stiffness), damping / (2 * np.sqrt(stiffness)))
    expected = float(sl.linearize(one, GROUND).displacement_std)
    np.testing.assert_allclose(tied.displacement_std, expected, rtol=1e-4)
    assert float(tied.rho[0, 1]) == pytest.approx(1, abs=1e-6)
    # The spring carries what keeps the two from moving apart: its force does not fade.
    assert float(tied.link_force_std[0]) > 0


LINKS = [sl.Link(2e7, 0.0), sl.Link(0.0, 2e6), sl.Link(5e7, 1e6), sl.Link(3e8, 4e7)]


@pytest.mark.parametrize("link", LINKS, ids=[link.describe() for link in LINKS])
def test_linear_pair_has_the_moments_of_its_simulation(link):
    pair = elastic(0.6, 1e6), elastic(1.0, 3e6)
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


def test_what_cannot_be_linked_is_refused():
    pair = yielding(0.6, 1e6), sl.Bilinear(1.0, 0.05)
    with pytest.raises(ValueError, match="structure 2: mass is not given"):
        sl.linearize_system(pair, GROUND, [LINKS[0]])
    with pytest.raises(ValueError, match="structure 2: mass is not given"):
        sl.simulate(pair, GROUND, link=LINKS[0])


def test_a_link_joins_two():
    three = [elastic(period, 1e6) for period in (0.5, 0.7, 1.0)]
    with pytest.raises(ValueError, match="1 given; allowed: one between each two neighbours"):
        sl.simulate(three, GROUND, link=LINKS[0])
    with pytest.raises(ValueError, match="stiffness = -1 is out of range"):
        sl.Link(stiffness=-1.0)
