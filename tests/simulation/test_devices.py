"""Damping devices and dashpots with an exponent, simulated: their energy and their limits."""

from dataclasses import replace

import numpy as np
import pytest

import stochlin as sl
from stochlin.kernels.simulation.state import ElementStates, Iteration
from stochlin.kernels.simulation.stepping import LANES
from stochlin.kernels.simulation.time_step import _dashpot_slip
from stochlin.models.systems import assembly_of
from stochlin.solver.simulation.connected_structures import connected_groups

pytestmark = pytest.mark.oracle

BROAD = sl.KanaiTajimi(2 * np.pi / 15, 0.6, 0.02)
TOWER = sl.ShearBuilding([2e5] * 4, np.array([4, 3.6, 3, 2.2]) * 1e8, [3.0] * 4, 0.05)
ONE = sl.Bilinear(0.5, 0.05, mass=1e6)
FINITE = {"paths": 32, "duration": 8.0, "seed": 3}


def damper(constant, exponent, structure=1, floors=(1, 0)):
    place = {"structures": (structure, structure), "floors": floors}
    return sl.Link(0.0, constant, damping_exponent=exponent, **place)


def in_every_storey(constant, exponent):
    return [damper(constant, exponent, floors=(n, n - 1)) for n in (1, 2, 3, 4)]


def force(t):
    return 9 * np.sin(11 * t + 0.5) * np.cos(2 * t)


def stepped(part, seconds, steps):
    """Displacements of the floors of a frame after each step (steps, n), on the first lane."""
    dt = seconds / steps
    f = np.repeat(force(dt * (np.arange(steps) + 0.5))[:, None], LANES, axis=1)
    out = np.empty((steps, part.size, LANES))
    part.block(dt)(f, part.at_rest(), 1, out)
    assert (out == out[..., :1]).all()  # equal motions, equal answers
    return out[..., 0]


@pytest.mark.parametrize("exponent", [0.02, 0.2, 0.5, 1.0, 2.0])
def test_what_the_ground_puts_in_is_stored_or_dissipated(exponent):
    """By the trapezoidal rule to the rounding of the passes, whatever the step."""
    system = assembly_of([TOWER], in_every_storey(2e6, exponent))
    (frame,) = connected_groups(system)
    n, seconds, steps = 4, 2.0, 200
    dt = seconds / steps
    u = np.vstack([np.zeros(n), stepped(frame.part, seconds, steps)[:, :n]])
    moved = np.diff(u, axis=0)
    v = np.zeros_like(u)
    for step in range(steps):
        v[step + 1] = 2 * moved[step] / dt - v[step]
    mass, springs = system.storeys.mass, system.extensions
    put_in = ((moved @ mass) * force(dt * (np.arange(steps) + 0.5))).sum()
    pace = moved / dt
    lost = dt * np.einsum("si,ij,sj->", pace, system.storeys.damping, pace)
    dashpots = dt * 2e6 * (np.abs(pace @ springs[n:].T) ** (exponent + 1)).sum()
    stored = 0.5 * (mass @ v[-1] ** 2 + system.storeys.elastic @ (springs[:n] @ u[-1]) ** 2)
    assert stored + lost + dashpots == pytest.approx(put_in, rel=1e-7)
    assert dashpots > 0.1 * put_in


def test_a_linear_dashpot_to_the_ground_is_damping():
    more = 0.1
    constant = 2 * more * 2 * np.pi / ONE.period * ONE.mass
    tied = sl.simulate([ONE], BROAD, link=damper(constant, None), **FINITE)
    damped = sl.simulate([replace(ONE, damping=0.05 + more)], BROAD, **FINITE)
    np.testing.assert_allclose(tied.peak, damped.peak, rtol=1e-9)


@pytest.mark.extreme
def test_a_hysteretic_device_in_an_elastic_oscillator_makes_it_bilinear():
    k, share, hardening = ONE.mass * (2 * np.pi / ONE.period) ** 2, 0.4, 0.1
    device = sl.Link(
        share * k, hardening=hardening, yield_displacement=0.01, structures=(1, 1), floors=(1, 0)
    )
    soft = replace(ONE, period=ONE.period / np.sqrt(1 - share), damping=0.05 / np.sqrt(1 - share))
    left = 1 - share + hardening * share
    whole = replace(ONE, hardening=left, yield_displacement=0.01)
    one, other = (
        sl.simulate([s], BROAD, link=link, **FINITE) for s, link in ((soft, device), (whole, None))
    )
    np.testing.assert_allclose(one.peak, other.peak, rtol=1e-7)


@pytest.mark.parametrize("exponent", [0.3, 0.4, 1.5])
def test_a_dashpot_has_a_root_however_small_its_motion_is(exponent):
    """Where the increment without slip is nearly 0, rounding would lead Newton's method below 0."""
    random, lanes, relief = np.random.default_rng(2), 20_000, 0.26637989156433006
    before = 10.0 ** random.uniform(-320, -2, lanes)
    alone = before * 10.0 ** random.uniform(-40, 1, lanes) * random.choice([-1, 0, 1], lanes)
    elements = ElementStates.zeros(1, lanes)
    iteration = Iteration.zeros(lanes)
    iteration.change[:] = relief * before + alone
    elements.slip[0] = before
    parameters = np.broadcast_to(np.array([[6e3], [exponent]]), (1, 2, lanes))
    with np.errstate(under="ignore", over="ignore", invalid="ignore"):
        _dashpot_slip(2e5, relief, 0.005, 0, elements, parameters, iteration, lanes)
    assert np.isfinite(iteration.slip_change).all()
