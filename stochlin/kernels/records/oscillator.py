"""Exact response of linear and bilinear structures to a recorded ground acceleration; compiled.

The ground is linear between its samples, each branch of a structure is a linear system, and changes
of branch are located inside the step: there is no error of discretization. Each interval of the record
is cut into sub-steps short enough that between them a cubic through values and rates finds peaks to
a few 1e-4. Time is counted in sub-steps, velocities and accelerations accordingly.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.compiled import compiled
from stochlin.kernels.basics.linear_branch import (
    LONGEST,
    MARKS,
    TERMS,
    evaluate,
    expand,
    first_exit,
    transition,
)

HIGHEST, LOWEST, VELOCITY, ACCELERATION, RADIUS, LAST, LAST_Y, INPUT, VISCOUS, HYSTERETIC = range(10)
PEAKS = 10
STATE = 6  # of a history: u, u', y, and the three energies so far
MOST_LEGS = 64  # of one sub-step; three reversals, each with two changes of branch, are many
SMALLEST = 1e-12  # advance past a change of branch, in sub-steps
# Gauss points of a stretch and their weights: energies to 1e-11 of what a sub-step adds.
_X, _W = np.polynomial.legendre.leggauss(4)
NODES, WEIGHTS = tuple(0.5 + 0.5 * _X), tuple(0.5 * _W)


class Oscillator(NamedTuple):
    """One structure in units of a sub-step; force ``post u + couple y``, ``y = uy z`` [m]."""

    damping: float  # 2 xi w h
    stiffness: float  # (w h)^2
    post: float  # alpha (w h)^2
    couple: float  # (1 - alpha) (w h)^2
    uy: float
    elastic: tuple[float, float, float, float, float, float]
    plastic: tuple[float, float, float, float, float, float]
    velocities: Array  # (2, NODES, 3): at the nodes, elastic and plastic, per velocity, push and slope


@compiled
def substeps(w, dt, per_radian):
    """Sub-steps of an interval of the record, ``per_radian`` times as many as a branch needs."""
    return max(1, int(np.ceil(w * dt * per_radian / LONGEST)))


@compiled
def oscillator(parameters, h, c):
    """The structure whose ``parameters`` these are, for sub-steps of ``h`` seconds."""
    w, xi, alpha, uy = parameters
    damping, stiffness = 2 * xi * w * h, (w * h) ** 2
    velocities = np.empty((2, len(NODES), 3))
    for branch in range(2):
        velocities_at(damping, stiffness if branch == 0 else alpha * stiffness, c, velocities[branch])
    return Oscillator(
        damping,
        stiffness,
        alpha * stiffness,
        (1 - alpha) * stiffness,
        uy,
        transition(damping, stiffness, c),
        transition(damping, alpha * stiffness, c),
        velocities,
    )


@compiled
def velocities_at(damping, stiffness, c, out):
    """Velocities at the nodes of a sub-step (NODES, 3), per unit of velocity, push and slope."""
    for unit in range(3):
        velocity, push = 1.0 if unit == 0 else 0.0, 1.0 if unit == 1 else 0.0
        expand(c, velocity, push, 1.0 - velocity - push, damping, stiffness)
        for n in range(len(NODES)):
            out[n, unit] = evaluate(c, NODES[n])[1]


@compiled
def _stride(o, u, v, y, side, ground, h, cuts, at, peaks, each, out):
    """Sub-steps from number ``at`` up to one in which the branch may change, or to the end.

    ``side`` is 1 or -1 while yielding, 0 otherwise. Every ``each``-th state goes into ``out``, if that
    has room.
    """
    stiffness = o.stiffness if side == 0 else o.post
    xv, xp, xs, vv, vp, vs = o.elastic if side == 0 else o.plastic
    between = o.velocities[0 if side == 0 else 1]
    push = 0.0
    first, begin = at // cuts, at % cuts
    for s in range(first, ground.size - 1):
        start, rise = ground[s] * h * h, (ground[s + 1] - ground[s]) * h * h / cuts
        for cut in range(begin, cuts):
            if each and at % each == 0:
                _keep(out[:, at // each], u, v, y, h, peaks)
            now = start + cut * rise
            push = -now - o.post * u - o.couple * y
            change = xv * v + xp * push - xs * rise
            v1 = vv * v + vp * push - vs * rise
            u1, y1 = u + change, y + change if side == 0 else y
            a = push - o.damping * v
            a1 = -now - rise - o.post * u1 - o.couple * y1 - o.damping * v1
            if o.uy < np.inf and _may_change(o, stiffness, v, a, y, v1, a1, y1, rise, side):
                return at, u, v, y
            _update(o, 1.0, stiffness, u, v, a, now, u1, v1, a1, now + rise, peaks)
            for n in range(len(NODES)):
                rate = between[n, 0] * v + between[n, 1] * push - between[n, 2] * rise
                peaks[INPUT] -= WEIGHTS[n] * (now + NODES[n] * rise) * rate
                peaks[VISCOUS] += WEIGHTS[n] * o.damping * rate * rate
            peaks[HYSTERETIC] += 0.0 if side == 0 else o.couple * o.uy * abs(change)
            u, v, y = u1, v1, y1
            at += 1
        begin = 0
    if each:
        _keep(out[:, at // each], u, v, y, h, peaks)
    return at, u, v, y


@compiled
def _keep(state, u, v, y, h, peaks):
    """A state (STATE,) of a history, in seconds."""
    state[0], state[1], state[2] = u, v / h, y
    for n in range(3):
        state[3 + n] = peaks[INPUT + n] / (h * h)


@compiled
def _may_change(o, stiffness, v, a, y, v1, a1, y1, rise, side):
    """Whether the branch might change within a sub-step with these states at its ends.

    A function strays from its chord by at most an eighth of its largest second derivative; the
    derivatives of the acceleration follow from the equation of motion, which is linear.
    """
    speed = max(abs(v), abs(v1))
    most = 1.08 * (max(abs(a), abs(a1)) + 0.125 * o.damping * (abs(rise) + stiffness * speed))
    if side == 0:
        return max(abs(y), abs(y1)) + 0.125 * most > o.uy
    jerk = abs(rise) + o.damping * most + stiffness * (speed + 0.125 * most)
    return min(side * v, side * v1) <= 0.125 * jerk


@compiled
def _legs(o, u, v, y, side, ground, rise, peaks, space):
    """One sub-step, from change of branch to change of branch."""
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
        if way != 0:  # rounding must not let two branches hand over to each other without end
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
        _update(o, length, stiffness, u, v, a, now, u1, v1, a1, then, peaks)
        for n in range(len(NODES)):
            rate = evaluate(c, NODES[n] * length)[1]
            peaks[INPUT] -= length * WEIGHTS[n] * (now + NODES[n] * rise * length) * rate
            peaks[VISCOUS] += length * WEIGHTS[n] * o.damping * rate * rate
        peaks[HYSTERETIC] += 0.0 if side == 0 else o.couple * o.uy * abs(change)
        u, v, y, side = u1, v1, y1, next_side
        t = 1.0 if way == 0 else t + length
    return u, v, y, side


@compiled
def _update(o, length, stiffness, u, v, a, ground, u1, v1, a1, ground1, peaks):
    """Take the peaks of one stretch on one branch into account."""
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
    """Square of the radius where it is stationary within a stretch, 0 for none.

    The rate of ``u^2 + u'^2/w^2`` is ``2 u' (u + u''/w^2)``: where ``u'`` vanishes the radius is a peak
    of the displacement; where the other factor does the square is flat, and its chord finds it.
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
    """The cubic through values and rates at both ends, at the share ``s`` of a stretch."""
    begin, end, rise = rate * length, rate1 * length, value1 - value
    square, cube = 3 * rise - 2 * begin - end, begin + end - 2 * rise
    return value + s * (begin + s * (square + s * cube))


@compiled
def top(length, value, rate, value1, rate1):
    """Largest value of the cubic through values and rates at both ends of a stretch."""
    largest = max(value, value1)
    if rate > 0 > rate1:
        begin, end, rise = rate * length, rate1 * length, value1 - value
        square, cube = 3 * rise - 2 * begin - end, begin + end - 2 * rise
        s = begin / (np.sqrt(square * square - 3 * cube * begin) - square)
        largest = max(largest, _cubic(s, length, value, rate, value1, rate1))
    return largest


@compiled
def workspace():
    """Arrays that the steps of one thread write into."""
    return np.empty(TERMS), np.empty(TERMS), np.empty((4, TERMS)), np.empty((2, MARKS))


@compiled
def run(parameters, ground, dt, cuts, peaks, each, out, space):
    """One structure from rest over ``ground`` (samples,) [m/s^2], in ``cuts`` sub-steps an interval.

    ``parameters`` (4,): w [rad/s], damping ratio, hardening ratio, yield displacement [m] or infinity.
    ``peaks`` (PEAKS,) is filled; every ``each``-th state ``u, u', y`` and the energies per unit mass
    that were put in and dissipated by then go into a column of ``out``, for ``each = 0`` none.
    """
    h = dt / cuts
    o = oscillator(parameters, h, space[0])
    total = cuts * (ground.size - 1)
    u, v, y, side = 0.0, 0.0, 0.0, 0
    for n in range(PEAKS):
        peaks[n] = 0.0
    at, u, v, y = _stride(o, u, v, y, side, ground, h, cuts, side, peaks, each, out)
    while at < total:
        s, cut = at // cuts, at % cuts
        start, rise = ground[s] * h * h, (ground[s + 1] - ground[s]) * h * h / cuts
        u, v, y, side = _legs(o, u, v, y, side, start + cut * rise, rise, peaks, space)
        at, u, v, y = _stride(o, u, v, y, side, ground, h, cuts, at + 1, peaks, each, out)
    peaks[VELOCITY] /= h
    peaks[ACCELERATION] /= h * h
    peaks[RADIUS] = max(np.sqrt(peaks[RADIUS]), peaks[HIGHEST], peaks[LOWEST])
    peaks[LAST], peaks[LAST_Y] = u, y
    for n in range(INPUT, PEAKS):
        peaks[n] /= h * h
