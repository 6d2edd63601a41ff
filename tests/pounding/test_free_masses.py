"""Time steps of pounding rows on free masses: restitution and contact time in closed form.

Steps are a share of a half-period of the contact: ``h = pi/steps`` in units of its time scale, or
of the time ``m/c`` of its dashpot, if shorter. For linear elements the trapezoidal rule solves the
modified equation ``x' = A' x`` with ``A' = A + h^2/12 A^3``. Since ``A^2 = -2 xi A - 1``, this is
``A' = (1 + (4 xi^2 - 1) h^2/12) A + 2 xi h^2/12``: another pace, and a growth of all by ``exp(xi t
h^2/6)``. Masses therefore part at ``1 + xi h^2 T/6`` times their velocity, ``T`` being the time in
which the dashpot acts, after ``1 + (1 - 4 xi^2) h^2/12`` times the time. Nonlinear elements have
similar expressions, which are derived where they are used. The tolerances are of the next order.
"""

import hypothesis.strategies as st
import numpy as np
import pytest
import scipy.integrate
import scipy.optimize
from hypothesis import given

import stochlin as sl
from stochlin.kernels.basics.systems import System
from stochlin.kernels.pounding import run as kernel
from stochlin.kernels.pounding.impacts import LEAST_REBOUND_STEPS
from stochlin.kernels.simulation import contacts as forces
from stochlin.kernels.simulation.account import Parts
from stochlin.kernels.simulation.laws import LINEAR, by_number
from stochlin.kernels.simulation.row_products import rows_of
from stochlin.kernels.simulation.state import Elements

pytestmark = pytest.mark.oracle

RATIOS = [0.001, 0.01, 0.1, 0.3, 0.5, 0.9, 0.999999, 1.0, 1.000001, 1.5, 3.0]
KINDS = [sl.Kelvin, sl.NoTensionKelvin, sl.ImpactKelvin]
LINEARS = [(kind, xi) for kind in KINDS for xi in RATIOS if kind is not sl.Kelvin or xi < 0.99]
STIFFNESS = 5e7
PAIR, SPEED = (2e5, 3e5), 0.8
PHASES = 16  # collisions at once, which begin at as many places within a step
STEPS = [32, 64, 128]  # in half a period
ROUNDING = 1e-10  # of forces and of differences of penetrations, over many steps


def free_row(masses, contact, gap=0.0, sides=None, springs=0.0):
    """Masses in a row, each on a spring to the ground or none; ``sides`` are weights on either."""
    mass = np.array(masses, float)
    n, zero = mass.size, np.zeros(mass.size)
    left, right = (np.eye(n)[:-1], -np.eye(n)[1:]) if sides is None else sides
    space = np.full(len(left), gap)
    if isinstance(contact, sl.Stereomechanical):
        laws, e = [forces.ForceLaw()] * len(left), contact.e
    else:
        laws, e = [contact.force_law(float(1 / (w**2 @ (1 / mass)))) for w in left + right], None
    post = zero + springs
    system = System(mass, np.zeros((n, n)), np.eye(n), np.eye(n), post, zero, np.full(n, np.inf))
    elements = Elements(system, np.full(n, LINEAR), np.ones(n, np.int64), np.zeros((n, 0)))
    none = np.zeros(0, np.int64)
    accelerations = -np.hstack([np.eye(n), np.eye(n), (left + right).T]) / mass[:, None]
    shears = np.hstack([np.eye(n), np.zeros((n, n + len(left)))])
    parts = Parts(
        mass=mass,
        elements=n,
        damping=np.zeros((n, n)),
        contacts=len(left),
        of_forces=rows_of(np.vstack([accelerations, shears])),
        carried=zero,
        watched=rows_of(np.vstack([np.eye(n), np.eye(n)])),
        limit=np.full(n, np.inf),
        spring=none,
        dashpot=none,
        constant=np.zeros(0),
    )
    contacts = forces.Contacts.of(laws, n, left, right, space, e)
    return kernel.BuildingRow(elements, by_number(()), contacts, parts)


class Flight:
    """The run of masses (n,), or of many lanes of them (n, lanes), from places and velocities."""

    def __init__(self, row, velocities, dt, duration, places=0.0, substeps=1, slow=0.0):
        mass, n = row.parts.mass, row.parts.mass.size
        v = np.array(velocities, float).reshape(n, -1)
        lanes, intervals = v.shape[1], int(np.ceil(duration / (dt * substeps)))
        x = row.at_rest(lanes)
        self.q, self.v = x.coordinates.q, x.coordinates.v
        self.v[:], self.q[:] = v, np.broadcast_to(np.array(places, float).T, v.T.shape).T

        def energies():
            return (
                0.5 * mass[:, None] * self.v**2
                + 0.5 * row.elements.system.post[:, None] * self.q**2
            )

        start = energies()
        x.coordinates.input_energy[:] = start  # as if the ground had done it
        ground = np.zeros((intervals + 1, lanes))
        counts, rates = np.full(lanes, intervals), np.full(lanes, slow)
        motions = kernel.GroundMotions(ground, substeps * dt, counts, rates, np.ones(lanes))
        none = np.empty((len(x.block), 0))
        table = kernel.follow(row, x, motions, kernel.StepCounts(1, substeps), none)
        self.impacts = table[np.argsort(table["motion"], kind="stable")]
        self.imbalance = x.motions.imbalance
        self.duration = intervals * substeps * dt
        self.gained = energies() - start


def time_scale(contact, mass, v0):
    """The unit of time of a contact [s], in which a linear one without damping takes ``pi``."""
    k, n, *_ = contact.force_law(mass)
    return float((mass * v0 ** (1 - n) / k) ** (1 / (n + 1)))


def contact_time(kind, xi):
    """Contact time of a linear element over its scale."""
    half, root = np.sqrt(complex(1 - xi) / 2), np.sqrt(complex(1 - xi * xi))
    angle = 1.0 if xi == 1 else float((2 * np.arcsin(half) / root).real)  # acos(xi) over the root
    if kind is sl.Kelvin:
        return np.pi / np.sqrt(1 - xi * xi) if xi < 1 else np.inf
    return 2 * angle if kind is sl.NoTensionKelvin else angle + np.pi / 2


class Collisions:
    """Collisions of a pair in steps of one length, which begin at `PHASES` places within a step."""

    def __init__(self, contact, steps, masses=PAIR, v0=SPEED):
        self.masses, self.v0, self.mass = np.array(masses), v0, forces.reduced_mass(*masses)
        law, self.scale = contact.force_law(self.mass), time_scale(contact, self.mass, v0)
        stopped = np.inf if law.over_approach or not law.damping else self.mass / law.damping
        self.dt = np.pi * min(self.scale, stopped) / steps
        self.h = self.dt / self.scale  # the step in units of the contact
        self.touch = np.arange(PHASES) / PHASES * self.dt
        places = np.stack([np.zeros(PHASES), v0 * self.touch])
        velocities = np.repeat([[0.3 * v0], [-0.7 * v0]], PHASES, axis=1)
        self.before = velocities
        self.run = run = Flight(
            free_row(masses, contact), velocities, self.dt, 40 * self.scale, places
        )
        np.testing.assert_array_equal(run.impacts["motion"], np.arange(PHASES))  # one each
        self.e = (run.v[1] - run.v[0]) / v0
        self.late = (run.impacts["begin"] - self.touch) / self.scale
        self.time = (run.impacts["end"] - run.impacts["begin"]) / self.scale

    def check_conservation(self):
        """Momentum, and the energies of the table, all to rounding in whatever steps."""
        run, lost, size = self.run, self.run.impacts["dissipated"], self.mass * self.v0**2
        # A free mass keeps its velocity but for some rounding in each step, which may add up.
        drift = 1e-15 * run.duration / self.dt
        momentum, all_of_it = self.masses @ self.before, self.masses @ abs(self.before)
        np.testing.assert_allclose(self.masses @ run.v, momentum, rtol=0, atol=drift * all_of_it[0])
        allowed = ROUNDING * size + 2 * drift * self.masses @ self.before[:, 0] ** 2
        np.testing.assert_allclose(lost, 0.5 * size * (1 - self.e**2), rtol=0, atol=allowed)
        np.testing.assert_allclose(lost, -run.gained.sum(axis=0), rtol=0, atol=allowed)
        np.testing.assert_allclose(
            run.impacts["work_on_right"], run.gained[1], rtol=0, atol=allowed
        )
        np.testing.assert_allclose(run.impacts["approach_velocity"], self.v0, rtol=1e-12)
        np.testing.assert_array_equal(run.impacts["stored"], 0)  # nothing is left in it
        assert (run.imbalance < ROUNDING).all()


def collide(contact, **others):
    """Collisions in steps that are halved twice."""
    return [Collisions(contact, steps, **others) for steps in STEPS]


def check_order(values, exact, near, ratio=4):
    """Errors fall by 4 when steps are halved, and the extrapolated value is the exact one."""
    errors = np.array(values) - exact
    assert errors[:-1] / errors[1:] == pytest.approx(ratio, rel=0.25)  # the first order would be 2
    assert (ratio * values[-1] - values[-2]) / (ratio - 1) == pytest.approx(exact, abs=near)


def free_motion(xi, t):
    """Penetration and rate of a linear element at the time ``t``, in its units, from touch."""
    root = np.sqrt(complex(1 - xi * xi))
    shape = np.sin(root * t) / root if xi != 1 else t
    d = (np.exp(-xi * t) * shape).real
    return d, (np.exp(-xi * t) * (np.cos(root * t) - xi * shape)).real


@pytest.mark.parametrize(("kind", "xi"), LINEARS)
def test_linear_elements_deliver_their_restitution_and_contact_time(kind, xi):
    e, time = kind.restitution(xi), contact_time(kind, xi)
    damped, free = (time - np.pi / 2, np.pi / 2) if kind is sl.ImpactKelvin else (time, 0.0)
    runs = collide(kind(STIFFNESS, damping_ratio=xi))
    for one in runs:
        square = one.h**2
        # what follows from the modified equation, to the next order: steps in which contact begins
        # and ends, h^3; measured, 7 % of it in the coarsest steps
        grown = xi * damped / 6
        np.testing.assert_allclose(one.e / e, 1 + grown * square, rtol=0, atol=0.1 * grown * square)
        # Touch is found with the mean rate of the step, too small by xi h (1 - s), after the share
        # s: up to xi h^2/4 too late. The end of no tension is found with the mean rate too: xi
        # h^2/2.
        paced = (damped * (1 - 4 * xi * xi) + free) / 12
        allowed = 0.02 * square + 0.02 * abs(paced) * square
        off = one.time - time - paced * square
        assert ((-allowed <= off) & (off <= 0.5 * xi * square + allowed)).all()
        assert ((one.late >= -1e-12) & (one.late <= 0.25 * xi * square + 0.01 * square)).all()
        one.check_conservation()
        # the force and the penetration, at which the dashpot has acted for less than the whole time
        d, v = free_motion(xi, np.linspace(0, min(time, 20), 100_001))
        pushes = d + 2 * xi * (np.maximum(v, 0) if kind is sl.ImpactKelvin else v)
        unit = SPEED * one.scale
        largest, deepest = (
            one.run.impacts["largest_force"] / unit / STIFFNESS,
            one.run.impacts["largest_penetration"] / unit,
        )
        np.testing.assert_allclose(deepest, d.max(), rtol=0, atol=0.07 * square)
        np.testing.assert_allclose(largest, pushes.max(), rtol=0, atol=0.07 * square)
    check_order([one.e[0] for one in runs], e, 1e-6)  # measured: 5e-7
    exactly_half = kind is sl.Kelvin and xi == 0.5  # the pace is then right to the fourth order
    # The end within a step scatters the times, the less the more places they are the mean of.
    check_order([one.time.mean() for one in runs], time, 1e-5, 16 if exactly_half else 4)


@pytest.mark.slow
@given(
    masses=st.tuples(*2 * [st.floats(1e3, 1e7)]),
    v0=st.floats(1e-3, 5.0),
    e=st.floats(0.05, 1.0),
    kind=st.sampled_from([*KINDS, sl.HertzDamp, sl.Jankowski]),
)
def test_any_masses_velocities_and_restitutions(masses, v0, e, kind):
    contact = kind(1e8, restitution=e)
    one = Collisions(contact, 64, masses, v0)
    one.check_conservation()
    # e grows by at most e xi T/6, which is -e log(e)/6 or a quarter of it, and with xi > 1 as 1/(4
    # xi^2)
    np.testing.assert_allclose(one.e, e, rtol=0, atol=0.1 * (np.pi / 64) ** 2)
    if kind in KINDS:
        xi, time = contact.damping, contact_time(kind, contact.damping)
        allowed = (time * abs(1 - 4 * xi * xi) / 12 + np.pi / 24 + 0.5 * xi + 0.05) * one.h**2
        np.testing.assert_allclose(one.time, time, rtol=0, atol=allowed)


def test_a_slow_approach_is_elastic():
    """The dashpot over the velocity of approach has no use below the one that counts as zero."""
    row = free_row(PAIR, sl.HertzDamp(2e9, restitution=0.3))
    for slow, e in ((0.79, 0.3), (0.81, 1.0)):
        run = Flight(row, (0.3 * SPEED, -0.7 * SPEED), 1e-3, 1.0, slow=slow)
        assert (run.v[1, 0] - run.v[0, 0]) / SPEED == pytest.approx(e, abs=1e-3)
        assert run.impacts["approach_velocity"][0] == pytest.approx(SPEED, rel=1e-12)


# --- Stereomechanical impacts
# -----------------------------------------------------------------------


@given(
    masses=st.tuples(*2 * [st.floats(1e3, 1e7)]),
    v0=st.floats(1e-3, 5.0),
    e=st.just(0.0) | st.floats(1e-3, 1.0),
)
def test_stereomechanical_impact_is_eq_13(masses, v0, e):
    contact, mass, both = sl.Stereomechanical(e), np.array(masses), forces.reduced_mass(*masses)
    before = np.array([0.3 * v0, -0.7 * v0])
    run = Flight(free_row(masses, contact, 0.1 * v0), before, 1 / 16, 1.0)
    wanted = np.array(forces.velocities_after_impact(*before, *masses, e))
    np.testing.assert_allclose(run.v[:, 0], wanted, rtol=0, atol=1e-12 * v0)
    exact = 0.1 * before + 0.9 * wanted  # the rebound begins at the time of touch
    np.testing.assert_allclose(run.q[:, 0], exact, rtol=0, atol=1e-12 * v0)
    line, *more = run.impacts
    # Masses that part at no more than rounding may meet again at that.
    assert all(each["approach_velocity"] < 1e-12 * v0 for each in more)
    assert line["begin"] == pytest.approx(0.1, rel=1e-9)
    assert line["approach_velocity"] == pytest.approx(v0, rel=1e-9)
    assert np.isnan(line["largest_force"])
    energies = mass * before**2
    lost = 0.5 * both * v0**2 * (1 - e * e)
    allowed = 1e-12 * energies.sum() + 1e-12 * both * v0**2
    assert line["dissipated"] == pytest.approx(lost, abs=allowed)
    assert -run.gained.sum() == pytest.approx(lost, abs=allowed)
    assert line["work_on_right"] == pytest.approx(
        0.5 * mass[1] * (wanted[1] ** 2 - before[1] ** 2), abs=allowed
    )
    if e > 0:
        assert line["end"] == line["begin"]
    assert run.imbalance[0] < 1e-12


@given(
    masses=st.tuples(*4 * [st.floats(1e5, 3e5)]),
    velocities=st.tuples(*4 * [st.floats(-1, 1)]),
    spaces=st.tuples(*3 * [st.floats(0.001, 0.1)]),
    e=st.floats(0.7, 1.0),
)
def test_any_blows_conserve_momentum_and_account_for_the_energy(masses, velocities, spaces, e):
    """In long steps, so that many blows take place in one; from masses that are driven together.

    With a light mass between heavy ones, or much damping, there would be blows without end, and
    rest.
    """
    mass, v0 = np.array(masses), np.add(velocities, [1.0, 0.5, -0.5, -1.0])
    row = free_row(masses, sl.Stereomechanical(e))
    run = Flight(row, v0, 0.1, 2.0, np.append(0.0, np.cumsum(spaces)))
    size, energy = mass @ abs(v0), 0.5 * mass @ v0**2
    assert mass @ run.v[:, 0] == pytest.approx(mass @ v0, rel=0, abs=1e-11 * size)
    lost = run.impacts["dissipated"].sum()
    assert lost == pytest.approx(-run.gained.sum(), rel=0, abs=1e-11 * energy)
    handed = np.bincount(run.impacts["contact"], run.impacts["work_on_right"], minlength=3)
    assert handed[2] == pytest.approx(run.gained[3, 0], rel=0, abs=1e-11 * energy)
    assert (run.impacts["dissipated"] >= -1e-11 * energy).all()


WALL, SPRING, LIGHT, PRESS = 1e22, 1e6, 1e5, 0.1


@pytest.mark.parametrize("e", [0.0, 0.3, 0.6])
def test_a_mass_bounces_on_a_wall_and_rests_until_it_is_pulled_away(e):
    """A spring presses the mass on a wall, 0.1 m before its place; the wall moves away at 0.05 m/s.

    Between blows the motion is harmonic, about the place of the spring; rebounds become shorter and
    end. The mass then goes with the wall, and is left at the place of its spring, where it is not
    pressed.
    """
    row = free_row((LIGHT, WALL), sl.Stereomechanical(e), -PRESS, springs=np.array([SPRING, 0.0]))
    u, drop, dt, w = 0.05, 0.02, 1e-3, np.sqrt(SPRING / LIGHT)
    run = Flight(row, (0.0, u), dt, 4.0, (-PRESS - drop, 0.0))
    t, place, speed, touches, speeds = 0.0, -PRESS - drop, 0.0, [], []
    while True:  # from one touch to the next: the place less that of the wall is zero again

        def beyond(s, t=t, place=place, speed=speed):
            return place * np.cos(w * s) + speed / w * np.sin(w * s) + PRESS - u * (t + s)

        ahead = np.linspace(1e-6, 0.5, 100_001)
        first = ahead[np.argmax(beyond(ahead) > 0)]
        after = scipy.optimize.brentq(beyond, first - 5e-6, first)
        if touches and after < LEAST_REBOUND_STEPS * dt:
            break
        approach = speed * np.cos(w * after) - place * w * np.sin(w * after) - u
        t += after
        place, speed = u * t - PRESS, u - e * approach
        touches.append(t)
        speeds.append(approach)
        if e == 0:
            break
    np.testing.assert_allclose(run.impacts["begin"], touches, rtol=0, atol=1e-5)
    np.testing.assert_allclose(run.impacts["approach_velocity"], speeds, rtol=0, atol=2e-5)
    assert run.impacts["end"][-1] == pytest.approx(PRESS / u, abs=2 * dt)
    np.testing.assert_array_equal(run.impacts["end"][:-1], run.impacts["begin"][:-1])
    swing = run.q[0, 0] / u * w, run.v[0, 0] / u
    assert np.hypot(*swing) == pytest.approx(
        1, abs=1e-3
    )  # it was left with the velocity of the wall
    lost = (
        0.5
        * LIGHT
        * run.impacts["approach_velocity"] ** 2
        * (1 - np.append(np.full(len(touches) - 1, e), 0) ** 2)
    )
    # The last one goes on pressing for the rest of its step, with the velocity of so much time.
    pressing = 0.5 * LIGHT * (dt * w**2 * PRESS) ** 2
    np.testing.assert_allclose(run.impacts["dissipated"][:-1], lost[:-1], rtol=1e-9)
    np.testing.assert_allclose(run.impacts["dissipated"][-1], lost[-1], rtol=1e-9, atol=pressing)


# --- More than two masses
# ---------------------------------------------------------------------------


@given(
    masses=st.tuples(*3 * [st.floats(1e4, 1e6)]),
    share=st.floats(0.05, 0.95),
    e=st.floats(0.1, 1.0),
    side=st.sampled_from([1, -1]),
)
def test_a_hit_on_a_free_column_moves_both_its_floors(masses, share, e, side):
    """Floor 0 meets the column between floors 1, below, and 2: the impulse goes by the shares."""
    mass, v0 = np.array(masses), 0.8
    alone, column = np.array([[1.0, 0.0, 0.0]]), np.array([[0.0, 1 - share, share]])
    sides = (alone, -column) if side > 0 else (column, -alone)
    meeting = 1 / (1 / mass[0] + share**2 / mass[2] + (1 - share) ** 2 / mass[1])
    contact = sl.Kelvin(1e8, restitution=e)
    row = free_row(masses, contact, sides=sides)
    scale = time_scale(contact, meeting, v0)
    start, h = np.array([side * v0, 0, 0]), np.pi / 64
    run = Flight(row, start, h * scale, 20 * scale)
    [line] = run.impacts
    grown = e * (
        1 - np.log(e) * h**2 / 6
    )  # the restitution of these steps, see the top of this file
    impulse = side * (1 + grown) * meeting * v0
    wanted = start + impulse * np.array([-1, 1 - share, share]) / mass
    np.testing.assert_allclose(run.v[:, 0], wanted, rtol=0, atol=0.05 * h**2 * v0)
    assert mass @ run.v[:, 0] == pytest.approx(mass @ start, rel=1e-12)
    right = run.gained[1:].sum() if side > 0 else run.gained[0, 0]
    size = mass[0] * v0**2
    assert line["dissipated"] == pytest.approx(-run.gained.sum(), abs=ROUNDING * size)
    assert line["dissipated"] == pytest.approx(
        0.5 * (1 - grown**2) * meeting * v0**2, abs=0.05 * h**2 * size
    )
    assert line["work_on_right"] == pytest.approx(right, abs=ROUNDING * size)


def test_an_element_without_tension_pushes_again_while_it_is_still_compressed():
    """It lets go at 0.089 s; a third mass throws the second back; it pushes at 0.122 s, at 7.7 mm.

    Against ``max(k d + c v, 0)`` for ``d > 0`` by scipy.
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
    for steps in (500, 1000, 2000):
        run = Flight(free_row([mass] * 3, contact), velocities, duration / steps, duration, places)
        of_first = run.impacts[run.impacts["contact"] == 0]
        assert len(of_first) == 1  # both pushes are one impact
        assert of_first["end"][0] == pytest.approx(
            exact.t[changes[3]], abs=2e-4 + duration / steps / 10
        )
        square = (duration / steps) ** 2 * STIFFNESS / (mass / 2)
        assert abs(run.v[:, 0] - exact.y[3:, -1]).max() < 0.15 * square  # measured: 0.06 at most
