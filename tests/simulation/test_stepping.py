"""Time steps against solutions sharing no formula with them: adaptive integrators and algebra."""

import math

import cases
import numpy as np
import pytest
import scipy.linalg
from scipy.integrate import solve_ivp

from stochlin.kernels.basics.systems import System
from stochlin.kernels.simulation.ensemble import SteppedStructures
from stochlin.kernels.simulation.laws import BILINEAR, BOUC_WEN, OTHER_LAW, by_number
from stochlin.kernels.simulation.row_products import rows_of
from stochlin.kernels.simulation.state import Elements
from stochlin.kernels.simulation.stepping import (
    LANES,
    bilinear_block,
    filter_steps,
    ground_block,
    keep_extremes,
)

pytestmark = pytest.mark.oracle

SECONDS = 10.0
STEPS = 500  # of the coarsest run: 50 a period of the structure
REFINEMENTS = 4
SECOND_ORDER = (1.85, 2.15)  # slope of log error over log step; 1 or 3 are far outside
TIGHT = {"method": "LSODA", "rtol": 1e-10, "atol": 1e-12}  # below the finest error by 1e3 and more

W, DAMPING, ALPHA = 2 * np.pi, 0.05, 0.1
CHOSEN = range(0, LANES, 4)  # lanes that are followed by the other integrator
OSCILLATOR = np.array([2 * DAMPING * W, ALPHA * W**2, (1 - ALPHA) * W**2, 1.0])

# Three harmonics: about the natural frequency, below and above it; a phase and a strength each
# lane.
FREQUENCIES = np.array([0.63, 0.97, 1.71]) * W
RNG = np.random.default_rng(19)
AMPLITUDES = RNG.uniform(10.0, 30.0, (len(FREQUENCIES), LANES))
PHASES = RNG.uniform(0, 2 * np.pi, AMPLITUDES.shape)

GROUNDS = {
    "white noise": (),
    "narrow band": (np.pi, 0.05),
    "broad band": (15.0, 0.6),
    "high-passed": (15.0, 0.6, 1.5, 0.6),
}
every_ground = pytest.mark.parametrize("filters", GROUNDS.values(), ids=GROUNDS.keys())
every_step = pytest.mark.parametrize("dt", [0.005, 0.05, 0.3])


HARMONICS = np.stack(np.broadcast_arrays(AMPLITUDES, FREQUENCIES[:, None], PHASES)).T.tolist()


def forcing(t, lane):
    return sum(amplitude * math.sin(w * t + phase) for amplitude, w, phase in HARMONICS[lane])


def one_storey(kind):
    """A function with the arguments of `bilinear_block` for a building of one such storey."""

    def block(f, dt, law, u, v, z, *rest):
        (d, k, h, scale, *own), one = law[0], np.ones((1, 1))
        system = System(one[0], d * one, one, one, *map(np.atleast_1d, (k, h, 1.0)))
        part = SteppedStructures(
            Elements(system, np.array([kind]), np.array([1]), np.array([own])),
            by_number((BOUC_WEN,)),
        )
        state = part.at_rest()
        q, rate, elastic = state.coordinates.q, state.coordinates.v, state.elements.z
        q[:], rate[:], elastic[:] = u, v, z
        part.block(dt)(scale * f, state, *rest)
        u[:], v[:], z[:] = q, rate, elastic

    return block


def step_means(steps):
    """Mean forcing of each step, from the integral of the harmonics."""
    t = np.linspace(0, SECONDS, steps + 1)[:, None, None]
    rate = FREQUENCIES[:, None]
    integral = np.sum(-AMPLITUDES / rate * np.cos(rate * t + PHASES), axis=1)
    return np.diff(integral, axis=0) * steps / SECONDS


def rest(structures=1):
    return np.zeros((3, structures, LANES))


def histories(kernel, law, steps):
    """Displacements (steps, LANES) of one structure from rest."""
    out = np.empty((steps, 1, LANES))
    kernel(step_means(steps), SECONDS / steps, np.array([law]), *rest(), 1, out, 0)
    return out[:, 0]


def observed_order(kernel, law, exact):
    """Slope of the error over step size; the error is the root mean square over lanes and times."""
    sizes = STEPS * 2 ** np.arange(REFINEMENTS)
    errors = []
    for steps in sizes:
        u = histories(kernel, law, steps)[steps // STEPS - 1 :: steps // STEPS, CHOSEN]
        errors.append(np.sqrt(np.mean((u - exact) ** 2)))
    assert errors[-1] < 1e-3 * np.sqrt(np.mean(exact**2))
    return -np.polyfit(np.log(sizes), np.log(errors), 1)[0]


def bilinear_by_events(lane):
    """Displacement at the coarse steps; an event ends each elastic or plastic stretch."""
    d, k, h, _ = OSCILLATOR
    times = np.linspace(0, SECONDS, STEPS + 1)[1:]
    found = np.full(STEPS, np.nan)
    now, state, side = 0.0, np.zeros(3), 0  # side: +1 or -1 while yielding, 0 while elastic

    def rates(t, y):
        u, v, z = y.tolist()
        return [v, forcing(t, lane) - d * v - k * u - h * z, 0.0 if side else v]

    def until(function, direction):
        function.terminal, function.direction = True, direction
        return function

    yields = [until(lambda t, y: y[2] - 1, 1), until(lambda t, y: y[2] + 1, -1)]
    turns = [until(lambda t, y: y[1], 0)]
    while now < SECONDS:
        ahead = times > now
        part = solve_ivp(
            rates,
            (now, SECONDS),
            state,
            t_eval=times[ahead],
            events=turns if side else yields,
            **TIGHT,
        )
        if len(part.t):  # a short stretch may have none
            found[np.flatnonzero(ahead)[: len(part.t)]] = part.y[0]
        if part.status == 0:
            break
        which = next(n for n, hits in enumerate(part.t_events) if hits.size)
        now, state = part.t_events[which][0], part.y_events[which][0].copy()
        side = 0 if side else (1, -1)[which]
        state[2] = side or np.sign(state[2])
    return found


def test_bilinear_motion_converges_to_the_exact_one_with_the_square_of_the_step():
    exact = np.stack([bilinear_by_events(lane) for lane in CHOSEN], axis=1)
    assert np.isfinite(exact).all()
    assert np.abs(exact).max(axis=0).min() > 1.5  # every lane yields
    for block in (bilinear_block, one_storey(BILINEAR)):
        order = observed_order(block, OSCILLATOR, exact)
        assert SECOND_ORDER[0] < order < SECOND_ORDER[1]


@pytest.mark.slow
@pytest.mark.parametrize("exponent", [1.0, 1.5, 2.0])
@pytest.mark.parametrize(("beta", "gamma"), [(0.5, 0.5), (0.7, -0.3)])
def test_bouc_wen_motion_converges_to_the_exact_one_with_the_square_of_the_step(
    exponent, beta, gamma
):
    law = np.array([*OSCILLATOR, beta, gamma, exponent])
    d, k, h, _ = OSCILLATOR

    def rates(t, y, lane):
        u, v, z = y.tolist()
        slip = beta * abs(v) * abs(z) ** (exponent - 1) * z + gamma * v * abs(z) ** exponent
        return [v, forcing(t, lane) - d * v - k * u - h * z, v - slip]

    times = np.linspace(0, SECONDS, STEPS + 1)[1:]
    rest = (0, SECONDS), np.zeros(3)
    runs = [solve_ivp(rates, *rest, t_eval=times, args=(lane,), **TIGHT) for lane in CHOSEN]
    exact = np.stack([run.y[0] for run in runs], axis=1)
    assert np.abs(exact).max(axis=0).min() > 1.5
    order = observed_order(one_storey(OTHER_LAW), law, exact)
    assert SECOND_ORDER[0] < order < SECOND_ORDER[1]


def test_blocks_of_any_length_and_sampling_give_one_history():
    laws = np.stack([OSCILLATOR, OSCILLATOR * [1, 4, 4, 1]])
    f, dt = step_means(STEPS), SECONDS / STEPS
    whole, thinned = np.empty((STEPS, 2, LANES)), np.empty((STEPS // 5, 2, LANES))
    bilinear_block(f, dt, laws, *rest(2), 1, whole, 0)
    state = rest(2)
    for part in range(4):
        steps = slice(part * STEPS // 4, (part + 1) * STEPS // 4)
        samples = slice(part * STEPS // 20, (part + 1) * STEPS // 20)
        bilinear_block(f[steps], dt, laws, *state, 5, thinned[samples], 0)
    np.testing.assert_array_equal(thinned, whole[4::5])


def test_lanes_are_independent_and_odd_in_the_motion():
    f, dt = step_means(STEPS), SECONDS / STEPS
    runs = []
    for sign, order in ((1, slice(None)), (-1, slice(None, None, -1))):
        out = np.empty((STEPS, 1, LANES))
        given = np.ascontiguousarray(sign * f[:, order])
        bilinear_block(given, dt, OSCILLATOR[None], *rest(), 1, out, 0)
        runs.append(sign * out[..., order])
    np.testing.assert_array_equal(*runs)


KERNELS = {
    "oscillators": bilinear_block,
    "bilinear storey": one_storey(BILINEAR),
    "Bouc-Wen storey": one_storey(OTHER_LAW),
}


@pytest.mark.parametrize("kernel", KERNELS.values(), ids=KERNELS.keys())
def test_elastic_motion_is_newmarks_of_average_acceleration(kernel):
    law = np.array([2 * DAMPING * W, W**2, 0.0, 1.3, 0.5, 0.5, 1.0])[
        : 4 if kernel is bilinear_block else 7
    ]
    dt = SECONDS / STEPS
    nodal = np.array([[forcing(s * dt, lane) for lane in range(LANES)] for s in range(STEPS + 1)])
    nodal[0] = 0  # at rest with no acceleration
    u, v, a = np.zeros((3, LANES))
    expected = np.empty((STEPS, LANES))
    d, k, _, scale = law[:4]
    for s in range(STEPS):  # the textbook's predictor and corrector, beta = 1/4, gamma = 1/2
        u_trial, v_trial = u + dt * v + dt**2 / 4 * a, v + dt / 2 * a
        a = (scale * nodal[s + 1] - d * v_trial - k * u_trial) / (1 + d * dt / 2 + k * dt**2 / 4)
        u, v = u_trial + dt**2 / 4 * a, v_trial + dt / 2 * a
        expected[s] = u
    out = np.empty((STEPS, 1, LANES))
    u, _, z = state = rest()
    kernel(0.5 * (nodal[1:] + nodal[:-1]), dt, law[None], *state, 1, out, 0)
    np.testing.assert_allclose(out[:, 0], expected, rtol=0, atol=1e-12 * np.abs(expected).max())
    if kernel is bilinear_block:  # beyond the yield displacement of 1, without a plastic one
        assert np.abs(expected).max() > 1
        np.testing.assert_array_equal(z, u)


def ground_system(filters, structures=()):
    """Matrix, noise vector and forcing row of the ground's states, by the shared builder."""
    matrix, noise = (np.array(part, float) for part in cases.augmented_system(structures, filters))
    if not filters:
        return matrix, noise, np.zeros(0)
    w, xi = filters[-2:]
    row = np.array([w**2, 2 * xi * w])
    output = row if len(filters) == 2 else matrix[-1]  # xf'' is the high-passed acceleration itself
    return matrix, noise, output


@every_ground
@every_step
def test_stationary_covariance_of_elastic_structures_is_exact_for_any_step(filters, dt):
    """The compiled step, driven by unit vectors, is a matrix; its covariance the continuous one."""
    stiffness, damping = np.array([W**2, 0.3 * W**2]), np.array([0.1 * W, 0.04 * W])
    size, intensity = len(filters), 0.7
    continuous, noise, _ = ground_system(filters, list(zip(stiffness, damping, strict=True)))
    exact = scipy.linalg.solve_continuous_lyapunov(continuous, -intensity * np.outer(noise, noise))
    ground, driver, output = (
        ground_system(filters) if filters else (np.zeros((0, 0)), *np.zeros((2, 0)))
    )
    steps = filter_steps(ground, driver, output, intensity, dt)
    laws = np.stack([damping, stiffness, np.zeros(2), np.ones(2)], axis=1)

    # Lane j starts from unit vector j; one more starts from rest and feels a unit random number.
    total = 4 + size
    start = np.zeros((total, LANES))
    start[range(total), range(total)] = 1
    xi, f = np.zeros((1, LANES)), np.empty((1, LANES))
    xi[0, total] = 1
    q, u, v = (np.ascontiguousarray(part) for part in (start[4:], start[0:4:2], start[1:4:2]))
    ground_block(steps)(xi, q, f)
    still = np.zeros((2, LANES))
    bilinear_block(f, dt, laws, u, v, still, 1, np.empty((1, 2, LANES)), 0)
    columns = np.concatenate([np.stack([u, v], axis=1).reshape(4, LANES), q])
    transition, gain = columns[:, :total], columns[:, total]

    units = np.sqrt(np.outer(np.diag(exact), np.diag(exact)))
    after = transition @ exact @ transition.T + np.outer(gain, gain)
    np.testing.assert_allclose(after / units, exact / units, rtol=0, atol=1e-12)


@pytest.mark.parametrize("steps", [30.8, 32.9, 33.4])
def test_a_peak_between_two_steps_is_known_to_1e_5(steps):
    """Of ``1 - cos``, whose steps miss it by 1e-3 or more, and in the difference of two of them."""
    path = 1 - np.cos(2 * np.pi / steps * np.arange(1.0, 41.0))
    assert 2 - path.max() > 1e-3
    out = np.repeat(np.stack([3 * path, path], axis=1)[..., None], LANES, axis=2)
    begin, way, highest, lowest = np.zeros((4, 2, LANES))
    for part in np.split(out, [20]):  # block by block
        keep_extremes(
            part, rows_of(np.array([[1.0, -1.0], [0.0, -1.0]])), begin, way, highest, lowest
        )
    for found, exact in ((highest[0], 4.0), (lowest[0], 0.0), (highest[1], 0.0), (lowest[1], -2.0)):
        np.testing.assert_allclose(found, exact, rtol=1e-5, atol=5e-5)
