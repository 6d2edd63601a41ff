"""The integrator of pounding rows on free masses: restitution and contact time in closed form."""

from __future__ import annotations

import hypothesis.strategies as st
import numpy as np
import pytest
import scipy.integrate
from hypothesis import given

import stochlin as sl
from stochlin.kernels.basics.linear_branch import evaluate
from stochlin.kernels.pounding import contact as forces
from stochlin.kernels.pounding import run as kernel
from stochlin.kernels.pounding import steps
from stochlin.kernels.pounding.contact import CLOSED, OPENING
from stochlin.kernels.pounding.impacts import (
    AFTER,
    APPROACH,
    BEFORE,
    BEGIN,
    CONTACT,
    END,
    HANDED,
    LARGEST,
)
from stochlin.kernels.pounding.rates import STRAIN_RATE

pytestmark = pytest.mark.oracle

EXACT = 1e-8  # what is asked for; measured: 4e-10 in restitutions, 4e-9 in times
RATIOS = [0.001, 0.01, 0.1, 0.3, 0.5, 0.9, 0.999999, 1.0, 1.000001, 1.5, 3.0]
KINDS = [sl.Kelvin, sl.NoTensionKelvin, sl.ImpactKelvin]
LINEAR = [(kind, xi) for kind in KINDS for xi in RATIOS if kind is not sl.Kelvin or xi < 0.99]
STIFFNESS = 5e7


def free_row(masses, contact, gap=0.0):
    """Masses without springs in a row."""
    n = len(masses)
    left, right = np.arange(n - 1), np.arange(1, n)
    mass = np.array(masses, float)
    jumps = isinstance(contact, sl.Stereomechanical)
    laws = [
        forces.ForceLaw() if jumps else contact.force_law(forces.reduced_mass(mass[i], mass[i + 1]))
        for i in range(n - 1)
    ]
    return kernel.Row(
        first=np.arange(n + 1),
        below=np.full(n, -1),
        mass=mass,
        per_mass=1 / mass,
        post=np.zeros(n),
        couple=np.zeros(n),
        strength=np.full(n, np.inf),
        law=np.zeros(n, np.int64),
        shape=np.ones((n, 3)),
        damping=np.zeros((n, n)),
        left=left,
        right=right,
        lower=right,
        weight=np.tile([1.0, -1.0, 0.0], (n - 1, 1)),
        meeting=forces.reduced_mass(mass[:-1], mass[1:]),
        gap=np.full(n - 1, gap),
        element=forces.law_table(laws),
        jumps=jumps,
        restitution=contact.e,
        slow=0.0,
        tied=np.zeros((0, 2), np.int64),
        tie=np.zeros((0, 4)),
        tie_law=np.zeros(0, np.int64),
    )


def fly(masses, velocities, contact, duration, gap=0.0, samples=17, push=0.0, places=0.0):
    """The run of free masses for ``duration`` under a ground acceleration ``push``."""
    n, dt = len(masses), duration / (samples - 1)
    row = free_row(masses, contact, gap)
    start = np.zeros(3 * n + 3 * n + n - 1)
    start[:n], start[n : 2 * n] = places, velocities
    ends = np.arange(samples - 1)
    motion = kernel.SampledMotion(np.full(samples, push), dt, ends, np.full(samples - 1, dt))
    return kernel.run(row, motion, start)


def collide(contact, masses=(2e5, 3e5), v0=0.8, gap=0.013):
    """Restitution and contact time of one collision; and the run."""
    mass = forces.reduced_mass(*masses)
    scale = contact.time_scale(mass, v0)
    velocities = (0.3 * v0, -0.7 * v0)
    run = fly(masses, velocities, contact, gap / v0 + 40 * scale, gap)
    assert run.completed
    assert len(run.impacts) == 1
    n = len(masses)
    v = run.last[n : 2 * n]
    [line] = run.impacts
    assert line[BEGIN] == pytest.approx(gap / v0, rel=1e-9)
    assert line[APPROACH] == pytest.approx(v0, rel=1e-9)
    return (v[1] - v[0]) / v0, (line[END] - line[BEGIN]) / scale, run


def check_conservation(run, masses, v0, e):
    n, masses = len(masses), np.array(masses)
    before, after = np.array([0.3 * v0, -0.7 * v0]), run.last[n : 2 * n]
    size = masses @ np.abs(before)
    assert masses @ after == pytest.approx(masses @ before, abs=1e-12 * size)
    loss = 0.5 * forces.reduced_mass(*masses) * v0**2 * (1 - e**2)
    [line] = run.impacts
    # Energies are right to 1e-10 of all there is, a few steps long; velocities to EXACT of v0.
    allowed = EXACT * forces.reduced_mass(*masses) * v0**2 + 1e-9 * masses @ before**2
    assert line[AFTER] - line[BEFORE] == pytest.approx(loss, abs=allowed)
    assert 0.5 * masses @ (before**2 - after**2) == pytest.approx(loss, abs=allowed)


@pytest.mark.parametrize(("kind", "xi"), LINEAR)
def test_linear_elements_deliver_their_restitution_and_contact_time(kind, xi):
    e, time, run = collide(kind(STIFFNESS, damping_ratio=xi))
    assert e == pytest.approx(kind.restitution(xi), abs=EXACT)
    assert time == pytest.approx(kind.contact_time(xi), abs=EXACT * max(1, kind.contact_time(xi)))
    check_conservation(run, (2e5, 3e5), 0.8, kind.restitution(xi))


@pytest.mark.parametrize("xi", [1.0, 1.5, 3.0])
def test_kelvin_of_critical_damping_holds_on(xi):
    scale = np.sqrt(forces.reduced_mass(2e5, 3e5) / STIFFNESS)
    run = fly((2e5, 3e5), (0.24, -0.56), sl.Kelvin(STIFFNESS, damping_ratio=xi), 10 * scale)
    [line] = run.impacts
    assert line[END] == run.time
    # d'' + 2 xi d' + d = 0 from d = 0, d' = 1, in units of the contact
    root, t = np.sqrt(complex(xi * xi - 1)), 10.0
    wanted = t * np.exp(-t) if xi == 1 else (np.exp(-xi * t) * np.sinh(root * t) / root).real
    assert (run.last[0] - run.last[1]) / (0.8 * scale) == pytest.approx(wanted, abs=1e-8)


@pytest.mark.parametrize("kind", [sl.HertzDamp, sl.Jankowski])
@pytest.mark.parametrize("e", [0.05, 0.3, 0.65, 0.95, 1.0])
def test_damped_hertz_contacts_deliver_their_restitution(kind, e):
    found, _, run = collide(kind(2e9, restitution=e))
    assert found == pytest.approx(e, abs=EXACT)
    check_conservation(run, (2e5, 3e5), 0.8, e)


@pytest.mark.parametrize("exponent", [1.0, 1.5, 2.2])
def test_hertz_contact_takes_its_time(exponent):
    contact = sl.Hertz(2e9, exponent=exponent)
    e, time, run = collide(contact)
    assert e == pytest.approx(1, abs=EXACT)
    assert time == pytest.approx(contact.contact_time(exponent), abs=EXACT)
    [line] = run.impacts
    m = forces.reduced_mass(2e5, 3e5)
    deepest = (0.5 * (exponent + 1) * m * 0.8**2 / 2e9) ** (1 / (exponent + 1))
    assert line[LARGEST] == pytest.approx(2e9 * deepest**exponent, rel=1e-4)


@given(
    masses=st.tuples(*2 * [st.floats(1e3, 1e7)]),
    v0=st.floats(1e-3, 5.0),
    e=st.floats(0.02, 1.0),
    kind=st.sampled_from([*KINDS, sl.HertzDamp, sl.Jankowski]),
)
def test_any_masses_velocities_and_restitutions(masses, v0, e, kind):
    contact = kind(1e8, restitution=e)
    found, time, run = collide(contact, masses, v0, 0.01 * v0)
    assert found == pytest.approx(e, abs=EXACT)
    if kind in KINDS:
        assert time == pytest.approx(contact.contact_time(contact.damping), rel=1e-7)
    check_conservation(run, masses, v0, e)


@given(masses=st.tuples(*2 * [st.floats(1e3, 1e7)]), v0=st.floats(1e-3, 5.0), e=st.floats(0.0, 1.0))
def test_stereomechanical_impact_is_eq_13(masses, v0, e):
    contact = sl.Stereomechanical(e)
    run = fly(masses, (0.3 * v0, -0.7 * v0), contact, 1.0, 0.1 * v0)
    wanted = contact.velocities_after(0.3 * v0, -0.7 * v0, *masses)
    np.testing.assert_allclose(run.last[2:4], [float(v) for v in wanted], rtol=0, atol=1e-12 * v0)
    check_conservation(run, masses, v0, e)


def test_three_equal_masses_hand_their_velocity_on():
    run = fly((1e5, 1e5, 1e5), (1.0, 0.0, 0.0), sl.Stereomechanical(1.0), 1.0, gap=0.1)
    np.testing.assert_allclose(run.last[3:6], [0.0, 0.0, 1.0], atol=1e-12)
    assert len(run.impacts) == 2


def test_simultaneous_blows_on_both_sides_are_symmetric():
    run = fly((1e5, 4e5, 1e5), (1.0, 0.0, -1.0), sl.Stereomechanical(0.5), 0.3, gap=0.1)
    v = run.last[3:6]
    assert run.completed
    assert 1e5 * v[0] + 4e5 * v[1] + 1e5 * v[2] == pytest.approx(0, abs=1e-7)
    assert (np.diff(v) >= -1e-12).all()  # they all part, or stay


def test_plastic_impact_without_pressure_leaves_the_masses_side_by_side():
    run = fly((1e5, 2e5), (1.0, 0.0), sl.Stereomechanical(0.0), 1.0, gap=0.1)
    np.testing.assert_allclose(run.last[2:4], 1 / 3, atol=1e-12)
    assert run.last[0] - run.last[1] == pytest.approx(0.1, abs=1e-11)


@given(
    masses=st.tuples(*3 * [st.floats(1e4, 1e6)]),
    share=st.floats(0.05, 0.95),
    e=st.floats(0.1, 1.0),
    side=st.sampled_from([1, -1]),
)
def test_a_hit_on_a_free_column_moves_both_its_floors(masses, share, e, side):
    """Floor 0 meets the column between the floors 1, below, and 2: the impulse goes by the shares."""
    mass, v0 = np.array(masses), 0.8
    sides = (0, 2) if side > 0 else (2, 0)
    weight = side * np.array([1.0, -share, share - 1.0])
    meeting = 1 / (1 / mass[0] + share**2 / mass[2] + (1 - share) ** 2 / mass[1])
    contact = sl.Kelvin(1e8, restitution=e)
    row = free_row(masses, contact)._replace(
        first=np.array([0, 1, 3]) if side > 0 else np.array([0, 2, 3]),
        left=np.array(sides[:1]),
        right=np.array(sides[1:]),
        lower=np.array([1]),
        weight=weight[[0, 1, 2] if side > 0 else [1, 0, 2]].reshape(1, 3),
        meeting=np.array([meeting]),
        gap=np.array([0.0]),
        element=forces.law_table([contact.force_law(meeting)]),
    )
    start = np.zeros(9 + 6 + 1)
    start[3] = side * v0
    duration = 40 * contact.time_scale(meeting, v0)
    motion = kernel.SampledMotion(np.zeros(17), duration / 16, np.array([0]), np.array([0.0]))
    run = kernel.run(row, motion, start)
    [line] = run.impacts
    v = run.last[3:6]
    impulse = side * (1 + e) * meeting * v0
    np.testing.assert_allclose(
        v - start[3:6], impulse * np.array([-1, 1 - share, share]) / mass, rtol=0, atol=10 * EXACT * v0
    )
    assert mass @ v == pytest.approx(mass[0] * side * v0, rel=1e-10)
    lost = 0.5 * (1 - e * e) * meeting * v0**2
    energies = 0.5 * mass * (v**2 - start[3:6] ** 2)
    size = 0.5 * mass[0] * v0**2
    assert line[AFTER] - line[BEFORE] == pytest.approx(lost, abs=1e-7 * size)
    right = energies[1:].sum() if side > 0 else energies[0]
    assert line[HANDED] == pytest.approx(right, abs=1e-7 * size)


def test_an_element_without_tension_pushes_again_while_it_is_still_compressed():
    """It lets go at 0.089 s; a third mass throws the second back, and it pushes at 0.122 s, at 7.7 mm.

    Against ``max(k d + c v, 0)`` for ``d > 0`` by scipy; steps of 1e-4 s there leave 1e-8 m/s.
    """
    mass, places, velocities, duration = 2e5, [0.0, 0.0, 0.3], [1.0, 0.0, -2.0], 0.4
    damping = 2 * np.sqrt(STIFFNESS * mass / 2)  # of critical of the reduced mass

    def pushes(state):
        d, v = -np.diff(state[:3], axis=0), -np.diff(state[3:], axis=0)
        return np.where(d > 0, np.maximum(STIFFNESS * d + damping * v, 0), 0)

    def rates(_, state):
        one, two = pushes(state)
        return [*state[3:], -one / mass, (one - two) / mass, two / mass]

    exact = scipy.integrate.solve_ivp(
        rates, (0, duration), [*places, *velocities], rtol=1e-10, atol=1e-13, max_step=1e-4
    )
    pushing = pushes(exact.y)[0] > 0
    (changes,) = np.nonzero(np.diff(pushing))
    assert exact.t[changes] == pytest.approx([0.0, 0.0894, 0.1224, 0.2635], abs=2e-4)
    assert exact.y[0, changes[2]] - exact.y[1, changes[2]] == pytest.approx(7.7e-3, abs=1e-4)
    contact = sl.NoTensionKelvin(STIFFNESS, damping_ratio=1.0)
    run = fly([mass] * 3, velocities, contact, duration, places=places)
    np.testing.assert_allclose(run.last[3:6], exact.y[3:, -1], atol=1e-7)
    of_first = run.impacts[run.impacts[:, CONTACT] == 0]
    assert len(of_first) == 1  # both pushes are one impact
    assert of_first[0, END] == pytest.approx(exact.t[changes[3]], abs=2e-4)


@given(d=st.floats(1e-6, 0.1), v=st.floats(-0.5, 0.5), v0=st.floats(0.01, 1))
def test_forces_on_branches_are_those_of_the_elements(d, v, v0):
    mass = 1.2e5
    for kind in (*KINDS, sl.HertzDamp, sl.Jankowski):
        contact = kind(3e7, restitution=0.5)
        law = contact.force_law(mass)
        branch = OPENING if v < 0 and kind in (sl.ImpactKelvin, sl.Jankowski) else CLOSED
        found, elastic = forces.branch_force(law, branch, d, v, v0)
        assert elastic == pytest.approx(3e7 * d**law.exponent, rel=1e-14)
        if kind is sl.NoTensionKelvin:
            found = max(found, 0.0)  # this branch ends where it would pull
        wanted = forces.force(law, d, v, v0)
        assert found == pytest.approx(wanted, rel=1e-14, abs=1e-9)


# --- Polynomials within a step: all forms of one have its values -----------------------------------

TWO = free_row([1.0, 2.0], sl.Kelvin(1e6, damping_ratio=0.1))
SHARES = np.linspace(0, 1, 41)


def test_interpolated_states_are_their_polynomials_in_powers_of_time():
    random, space = np.random.default_rng(1), steps.Space.of(TWO)
    x = random.standard_normal(space.new.size)
    space.shapes[:] = random.standard_normal(space.shapes.shape)
    states = np.empty((SHARES.size, x.size))
    for share, state in zip(SHARES, states, strict=True):
        steps.state_within(x, share, space, state)
    np.testing.assert_array_equal(states[[0, -1]], [x, x + space.shapes[0]])
    for i in range(x.size):
        steps.component_polynomial(i, -1, x, space)
        values = [evaluate(space.line, share)[0] for share in SHARES]
        np.testing.assert_allclose(values, -states[:, i], atol=1e-13)
    for i in range(2):
        steps.polynomial(TWO, STRAIN_RATE, i, 0.7, x, space)
        values = [evaluate(space.line, share)[0] for share in SHARES]
        np.testing.assert_allclose(values, states[:, 2 + i] - 0.7, atol=1e-13)


def test_what_is_known_at_nodes_is_interpolated_and_integrated_exactly():
    """Up to the degree of a polynomial through all nodes."""
    space = steps.Space.of(TWO)
    known = np.polynomial.Polynomial(np.random.default_rng(2).standard_normal(steps.NODES))
    for values in (space.nodes, space.depths, space.powers):
        values[:, 0] = known(np.linspace(0, 1, steps.NODES))
    steps.force_polynomial(0, space)
    np.testing.assert_allclose([evaluate(space.line, t)[0] for t in SHARES], known(SHARES), atol=1e-10)
    depths = [steps.depth_within(0, share, space) for share in SHARES]
    np.testing.assert_allclose(depths, known(SHARES), atol=1e-10)
    works = [steps.work_within(0, share, space) for share in SHARES]
    np.testing.assert_allclose(works, known.integ()(SHARES), atol=1e-10)
