"""Exact response of linear and bilinear oscillators to a recorded ground acceleration.

The ground acceleration is linear between its samples, the structure is linear on each of its branches,
and changes of branch are located within a step: the response has no error of discretization. Each
interval of the record is divided into sub-steps. They are so short that a cubic polynomial through the
values and rates at both ends gives peaks with a relative error of a few 1e-4. The unit of time is the
sub-step, also in velocities and accelerations.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.compiled import compiled
from stochlin.kernels.basics.linear_branch import (
    LONGEST,
    MARKS,
    TERMS,
    evaluate,
    expand,
    first_exit,
)

# Columns of the peaks: largest u and largest -u [m]; largest velocity, absolute acceleration and energy
# radius sqrt(u^2 + (u'/w)^2); u and y at the end; input, viscous and hysteretic energy per unit mass.
HIGHEST, LOWEST, VELOCITY, ACCELERATION, RADIUS, LAST, LAST_Y, INPUT, VISCOUS, HYSTERETIC = range(10)
PEAKS = 10
STATE = 6  # rows of a history: u, u', y, and the three energies so far
MOST_LEGS = 64  # changes of branch in one sub-step; more than six are unusual
SMALLEST = 1e-12  # smallest advance past a change of branch, in sub-steps
Unit = tuple[float, float, float]


class Oscillator(NamedTuple):
    """One structure, with the sub-step ``h`` as unit of time.

    The restoring force per unit mass is ``post u + couple y``, with ``y = uy z`` [m].
    """

    damping: float  # 2 xi w h
    stiffness: float  # (w h)^2
    post: float  # alpha (w h)^2
    couple: float  # (1 - alpha) (w h)^2
    uy: float  # yield displacement [m]
    elastic: tuple[Unit, Unit, Unit]  # `_transition` of the elastic branch
    plastic: tuple[Unit, Unit, Unit]  # that of the yielding branches


@compiled
def substeps(w, dt, per_radian):
    """Number of sub-steps of an interval of the record: ``per_radian`` times the smallest possible."""
    return max(1, int(np.ceil(w * dt * per_radian / LONGEST)))


@compiled
def oscillator(parameters, h, c):
    """The structure with ``parameters`` (4,) as in `run`, for sub-steps of ``h`` seconds."""
    w, xi, alpha, uy = parameters
    damping, stiffness = 2 * xi * w * h, (w * h) ** 2
    post = alpha * stiffness
    elastic, plastic = _transition(damping, stiffness, c), _transition(damping, post, c)
    return Oscillator(damping, stiffness, post, (1 - alpha) * stiffness, uy, elastic, plastic)


@compiled
def _transition(damping, stiffness, c):
    """Results of a sub-step per unit velocity, push and slope at its beginning, as in `expand`."""
    of_velocity = _after(c, 1.0, 0.0, 0.0, damping, stiffness)
    of_push = _after(c, 0.0, 1.0, 0.0, damping, stiffness)
    return of_velocity, of_push, _after(c, 0.0, 0.0, 1.0, damping, stiffness)


@compiled
def _after(c, velocity, push, slope, damping, stiffness):
    """Change of the displacement in a sub-step, velocity at its end, and integral of the change."""
    expand(c, velocity, push, slope, damping, stiffness)
    change, rate = evaluate(c, 1.0)
    return change, rate, _integral(c, 1.0)


@compiled
def _integral(c, t):
    """Integral from 0 to ``t`` of the polynomial with coefficients ``c``."""
    total = 0.0
    for n in range(TERMS - 1, -1, -1):
        total = (total + c[n] / (n + 1)) * t
    return total


@compiled
def _stride(o, u, v, y, side, ground, h, cuts, at, peaks, each, out):
    """Advance on one branch, from sub-step ``at`` to one in which the branch may change, or to the end.

    ``side`` is the direction of yielding, 1 or -1, and 0 on the elastic branch. Every ``each``-th state
    is written to ``out``, none if ``each`` is 0. Returns the number of the sub-step and the state.
    """
    stiffness = o.stiffness if side == 0 else o.post
    (xv, vv, sv), (xp, vp, sp), (xs, vs, ss) = o.elastic if side == 0 else o.plastic
    while at < cuts * (ground.size - 1):
        if each and at % each == 0:
            _keep(o, u, v, y, h, peaks, out[:, at // each])
        now, rise = _ground_in(ground, h, cuts, at)
        push = -now - o.post * u - o.couple * y
        change = xv * v + xp * push - xs * rise
        v1 = vv * v + vp * push - vs * rise
        u1, y1 = u + change, y + change if side == 0 else y
        a = push - o.damping * v
        a1 = -now - rise - o.post * u1 - o.couple * y1 - o.damping * v1
        if o.uy < np.inf and _may_change(o, stiffness, v, a, y, v1, a1, y1, rise, side):
            return at, u, v, y
        integral = sv * v + sp * push - ss * rise
        _update(o, 1.0, side, u, v, a, now, u1, v1, a1, now + rise, integral, peaks)
        u, v, y, at = u1, v1, y1, at + 1
    if each:
        _keep(o, u, v, y, h, peaks, out[:, at // each])
    return at, u, v, y


@compiled
def _ground_in(ground, h, cuts, at):
    """Ground acceleration at the beginning of a sub-step, and its rise within it."""
    s = at // cuts
    rise = (ground[s + 1] - ground[s]) * h * h / cuts
    return ground[s] * h * h + (at - s * cuts) * rise, rise


@compiled
def _viscous(o, u, v, y, peaks):
    """Energy per unit mass dissipated by damping: the input less what yielding took and what is left."""
    left = v * v + o.post * u * u + o.couple * y * y
    return peaks[INPUT] - peaks[HYSTERETIC] - 0.5 * left


@compiled
def _keep(o, u, v, y, h, peaks, state):
    """Write a state of a history (STATE,), with time in seconds."""
    state[0], state[1], state[2] = u, v / h, y
    state[3], state[5] = peaks[INPUT] / (h * h), peaks[HYSTERETIC] / (h * h)
    state[4] = _viscous(o, u, v, y, peaks) / (h * h)


@compiled
def _may_change(o, stiffness, v, a, y, v1, a1, y1, rise, side):
    """Whether the branch may change within a sub-step with these states at its ends.

    A function differs from its chord by at most an eighth of its largest second derivative. The
    derivatives of the acceleration are bounded by the equation of motion, which is linear.
    """
    speed = max(abs(v), abs(v1))
    most = 1.08 * (max(abs(a), abs(a1)) + 0.125 * o.damping * (abs(rise) + stiffness * speed))
    if side == 0:
        return max(abs(y), abs(y1)) + 0.125 * most > o.uy
    jerk = abs(rise) + o.damping * most + abs(stiffness) * (speed + 0.125 * most)
    return min(side * v, side * v1) <= 0.125 * jerk


@compiled
def _legs(o, u, v, y, side, ground, rise, peaks, space):
    """Advance by one sub-step, from one change of branch to the next.

    Returns the state and the branch ``side`` at its end.
    """
    c, row, rows, marks = space
    t, count = 0.0, 0
    while t < 1.0:
        now = ground + rise * t
        push = -now - o.post * u - o.couple * y
        stiffness = o.stiffness if side == 0 else o.post
        expand(c, v, push, -rise, o.damping, stiffness)
        if side == 0:
            for n in range(TERMS):
                row[n] = c[n]
            row[0] = y
            length, way = first_exit(row, -o.uy, o.uy, 1.0 - t, rows, marks)
        else:
            for n in range(TERMS - 1):
                row[n] = side * (n + 1) * c[n + 1]
            row[TERMS - 1] = 0.0
            length, way = first_exit(row, 0.0, np.inf, 1.0 - t, rows, marks)
        if way != 0:  # advance a little, so that rounding cannot cause endless changes of branch
            count += 1
            length = min(max(length, SMALLEST if 2 * count < MOST_LEGS else 2 / MOST_LEGS), 1.0 - t)
        change, v1 = evaluate(c, length)
        a, u1, y1, next_side = push - o.damping * v, u + change, y, side
        if side == 0:
            y1, next_side = (y + change, 0) if way == 0 else (way * o.uy, way)
        elif way != 0:
            v1, next_side = 0.0, 0
        then = now + rise * length
        a1 = -then - o.post * u1 - o.couple * y1 - o.damping * v1
        _update(o, length, side, u, v, a, now, u1, v1, a1, then, _integral(c, length), peaks)
        u, v, y, side = u1, v1, y1, next_side
        t = 1.0 if way == 0 else t + length
    return u, v, y, side


@compiled
def _update(o, length, side, u, v, a, ground, u1, v1, a1, ground1, integral, peaks):
    """Update peaks and energies by a part of a sub-step on one branch, of this ``length``.

    ``integral`` is that of the change of displacement over the part: by parts, the input is exact.
    """
    stiffness = o.stiffness if side == 0 else o.post
    peaks[INPUT] -= ground1 * (u1 - u) - (ground1 - ground) / length * integral
    peaks[HYSTERETIC] += 0.0 if side == 0 else o.couple * o.uy * abs(u1 - u)
    peaks[HIGHEST] = max(peaks[HIGHEST], top(length, u, v, u1, v1))
    peaks[LOWEST] = max(peaks[LOWEST], top(length, -u, -v, -u1, -v1))
    peaks[VELOCITY] = max(peaks[VELOCITY], top(length, v, a, v1, a1), top(length, -v, -a, -v1, -a1))
    b, b1 = a + ground, a1 + ground1
    rate, rate1 = -o.damping * a - stiffness * v, -o.damping * a1 - stiffness * v1
    either = max(top(length, b, rate, b1, rate1), top(length, -b, -rate, -b1, -rate1))
    peaks[ACCELERATION] = max(peaks[ACCELERATION], either)
    turn = _turn_of_radius(o, length, u, v, a, u1, v1, a1)
    peaks[RADIUS] = max(peaks[RADIUS], u1 * u1 + v1 * v1 / o.stiffness, turn)


@compiled
def _turn_of_radius(o, length, u, v, a, u1, v1, a1):
    """Square of the energy radius at a stationary point within a part of a sub-step, 0 for none.

    The rate of ``u^2 + u'^2/w^2`` is ``2 u' (u + u''/w^2)``. Where ``u'`` is zero the radius is a peak
    of the displacement, which is treated there. A zero of the other factor is found by linear
    interpolation; since the square is stationary there, its error is of second order.
    """
    away, away1 = u * o.stiffness + a, u1 * o.stiffness + a1
    if away * away1 >= 0:
        return 0.0
    s = away / (away - away1)
    displacement = _cubic(s, length, u, v, u1, v1)
    velocity = _cubic(s, length, v, a, v1, a1)
    return displacement**2 + velocity**2 / o.stiffness


@compiled
def _cubic(s, length, value, rate, value1, rate1):
    """Cubic polynomial through the values and rates at both ends, at the share ``s`` of the length."""
    begin, end, rise = rate * length, rate1 * length, value1 - value
    square, cube = 3 * rise - 2 * begin - end, begin + end - 2 * rise
    return value + s * (begin + s * (square + s * cube))


@compiled
def top(length, value, rate, value1, rate1):
    """Largest value of the cubic polynomial through the values and rates at both ends of a length."""
    largest = max(value, value1)
    if rate > 0 > rate1:
        begin, end, rise = rate * length, rate1 * length, value1 - value
        square, cube = 3 * rise - 2 * begin - end, begin + end - 2 * rise
        s = begin / (np.sqrt(square * square - 3 * cube * begin) - square)
        largest = max(largest, _cubic(s, length, value, rate, value1, rate1))
    return largest


@compiled
def workspace():
    """Working space for the steps of one thread."""
    return np.empty(TERMS), np.empty(TERMS), np.empty((4, TERMS)), np.empty((2, MARKS))


@compiled
def run(parameters, ground, dt, cuts, peaks, each, out, space):
    """Response of one structure from rest to ``ground`` (samples,) [m/s^2], with time step ``dt`` [s].

    Each interval has ``cuts`` sub-steps. ``parameters`` (4,) are the circular frequency ``w`` [rad/s],
    damping ratio, hardening ratio, and yield displacement [m] or infinity. The results are written to
    ``peaks`` (PEAKS,). Every ``each``-th state (``u``, ``u'``, ``y``, and the input, viscous and
    hysteretic energies per unit mass so far) is written to a column of ``out``, none if ``each`` is 0.
    """
    h = dt / cuts
    o = oscillator(parameters, h, space[0])
    u, v, y, side = 0.0, 0.0, 0.0, 0
    peaks[:] = 0.0
    at, u, v, y = _stride(o, u, v, y, side, ground, h, cuts, 0, peaks, each, out)
    while at < cuts * (ground.size - 1):
        u, v, y, side = _legs(o, u, v, y, side, *_ground_in(ground, h, cuts, at), peaks, space)
        at, u, v, y = _stride(o, u, v, y, side, ground, h, cuts, at + 1, peaks, each, out)
    peaks[VELOCITY] /= h
    peaks[ACCELERATION] /= h * h
    peaks[RADIUS] = max(np.sqrt(peaks[RADIUS]), peaks[HIGHEST], peaks[LOWEST])
    peaks[LAST], peaks[LAST_Y], peaks[VISCOUS] = u, y, _viscous(o, u, v, y, peaks)
    peaks[INPUT:] /= h * h
