"""Damping devices and dashpots with an exponent, simulated: another integrator, limits, energy."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.integrate
import sympy

import stochlin as sl
from stochlin.kernels.simulation.moving import CHANGE, LEAST, MORE, SLIP, STILL
from stochlin.kernels.simulation.stepping import LANES
from stochlin.kernels.simulation.time_step import _dashpot
from stochlin.models.systems import arrangement_of
from stochlin.solver.simulation.connected_structures import connected_groups

pytestmark = pytest.mark.oracle

FIRM = sl.KanaiTajimi(2 * np.pi / 15, 0.6, 0.02)
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


def solved(system, seconds):
    """By backward differentiation where it is stiff; within 1e-7 m/s of rest the law is straight."""
    mass, ties, springs = system.storeys.mass, system.ties, system.extensions
    n = mass.size
    k = np.append(system.storeys.elastic, [tie.link.stiffness for tie in ties])
    c, a = (np.array([getattr(t.link, x) for t in ties]) for x in ("damping_constant", "exponent"))
    stiffness, along = (springs.T * k) @ springs, springs[n:]

    def rates(t, x):
        rate = along @ x[n:]
        dashpot = c * rate * (rate**2 + 1e-14) ** ((a - 1) / 2)
        load = stiffness @ x[:n] + system.storeys.damping @ x[n:] + along.T @ dashpot
        return np.concatenate([x[n:], force(t) - load / mass])

    def slopes(t, x):
        rate = along @ x[n:]
        least = rate**2 + 1e-14
        tangent = c * (least ** ((a - 1) / 2) + (a - 1) * rate**2 * least ** ((a - 3) / 2))
        damping = system.storeys.damping + (along.T * tangent) @ along
        upper = np.hstack([np.zeros((n, n)), np.eye(n)])
        return np.vstack([upper, -np.hstack([stiffness, damping]) / mass[:, None]])

    options = {"method": "LSODA", "jac": slopes, "rtol": 1e-8, "atol": 1e-11}
    return scipy.integrate.solve_ivp(rates, (0, seconds), np.zeros(2 * n), **options).y[:n]


PLACES = ["oscillator", "storeys", "between"]
POWERS = [(0.2, 1e7), (0.3, 1e6), (0.5, 1e6), (1.5, 1e7)]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("exponent", "constant", "where"),
    [
        pytest.param(*power, where, marks=[pytest.mark.slow] * (where == "storeys" and power[0] < 1))
        for where in PLACES
        for power in POWERS
    ],
)
def test_motion_is_that_of_another_integrator(exponent, constant, where):
    structures, links = {
        "oscillator": ([ONE], [damper(constant, exponent)]),
        "storeys": ([TOWER], in_every_storey(constant, exponent)),
        "between": ([TOWER, ONE], [sl.Link(1e7, constant, damping_exponent=exponent)]),
    }[where]
    system, seconds = arrangement_of(structures, links), 1.2
    theirs = solved(system, seconds)
    errors = []
    for steps in (300, 1200):
        (frame,) = connected_groups(system)
        off = stepped(frame.part, seconds, steps)[-1, : frame.watched.size] - theirs[:, -1]
        errors.append(np.abs(off).max() / np.abs(theirs).max())
    assert errors[1] < 3e-4
    assert errors[1] < 0.15 * errors[0] or errors[1] < 5e-5


@pytest.mark.parametrize("exponent", [0.02, 0.2, 0.5, 1.0, 2.0])
def test_what_the_ground_puts_in_is_stored_or_dissipated(exponent):
    """By the trapezoidal rule to the rounding of the passes, whatever the step."""
    system = arrangement_of([TOWER], in_every_storey(2e6, exponent))
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


YIELDING = {"hardening": 0.1, "yield_drifts": 0.004}
OTHER_TOWER = sl.ShearBuilding([3e5] * 2, [3e8] * 2, [3.0] * 2, 0.05, **YIELDING)
V, Z, E = sympy.symbols("v z e")
WEARING = {
    "z": (V - (1 + 0.02 * E) * (V * abs(Z) ** 1.3 + abs(V) * abs(Z) ** 0.3 * Z) / 2)
    * sympy.exp(-E / 50),
    "e": Z * V,
}
BATCHES = {
    "bilinear": ({}, []),
    "Bouc-Wen with powers": ({"law": "bouc_wen", "law_parameters": {"exponent": 1.7}}, []),
    "two states with powers and exponentials": ({"law": WEARING}, []),
    "dashpots with an exponent": ({}, in_every_storey(1e6, 0.5)),
}


@pytest.mark.slow
@pytest.mark.parametrize(("law", "links"), BATCHES.values(), ids=BATCHES.keys())
def test_a_motion_has_the_same_bits_alone_and_in_a_batch(law, links):
    tower = replace(TOWER, **YIELDING, **law)
    (frame, *_) = connected_groups(arrangement_of([tower, OTHER_TOWER], links))
    part, block = frame.part, frame.part.block(0.01)
    f = np.random.default_rng(2).normal(0, np.geomspace(0.5, 20, LANES), (300, LANES))
    together = np.empty((300, part.size, LANES))
    block(f, part.at_rest(), 1, together)
    for lane in (0, LANES // 2, LANES - 1):
        alone = np.empty((300, part.size, 1))
        block(np.ascontiguousarray(f[:, lane : lane + 1]), part.at_rest(1), 1, alone)
        np.testing.assert_array_equal(alone[..., 0], together[..., lane])
    assert np.ptp(np.abs(together).max(axis=(0, 1))) > 0.05  # some hardly yield, others a lot


def test_a_linear_dashpot_to_the_ground_is_damping():
    more = 0.1
    constant = 2 * more * 2 * np.pi / ONE.period * ONE.mass
    tied = sl.simulate([ONE], FIRM, link=damper(constant, None), **FINITE)
    damped = sl.simulate([replace(ONE, damping=0.05 + more)], FIRM, **FINITE)
    np.testing.assert_allclose(tied.peak, damped.peak, rtol=1e-9)


def test_a_hysteretic_device_in_an_elastic_oscillator_makes_it_bilinear():
    k, share, hardening = ONE.mass * (2 * np.pi / ONE.period) ** 2, 0.4, 0.1
    device = sl.Link(
        share * k, hardening=hardening, yield_displacement=0.01, structures=(1, 1), floors=(1, 0)
    )
    soft = replace(ONE, period=ONE.period / np.sqrt(1 - share), damping=0.05 / np.sqrt(1 - share))
    left = 1 - share + hardening * share
    whole = replace(ONE, hardening=left, yield_displacement=0.01)
    one, other = (
        sl.simulate([s], FIRM, link=link, **FINITE) for s, link in ((soft, device), (whole, None))
    )
    np.testing.assert_allclose(one.peak, other.peak, rtol=1e-7)


@pytest.mark.parametrize("exponent", [0.3, 0.4, 1.5])
def test_a_dashpot_has_a_root_however_small_its_motion_is(exponent):
    """Where the increment without slip is nearly 0, rounding would lead Newton's method below 0."""
    random, lanes, relief = np.random.default_rng(2), 20_000, 0.26637989156433006
    before = 10.0 ** random.uniform(-320, -2, lanes)
    alone = before * 10.0 ** random.uniform(-40, 1, lanes) * random.choice([-1, 0, 1], lanes)
    elements, motions = np.zeros((1, LEAST + 1, lanes)), np.zeros((STILL + 1, lanes))
    motions[CHANGE], elements[0, SLIP] = relief * before + alone, before
    own = np.broadcast_to(np.array([[6e3], [exponent]]), (1, 2, lanes))
    with np.errstate(under="ignore", over="ignore", invalid="ignore"):
        _dashpot(2e5, relief, 0.005, 0, elements, own, motions, lanes)
    assert np.isfinite(motions[MORE]).all()
