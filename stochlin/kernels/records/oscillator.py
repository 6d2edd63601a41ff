"""Exact response of linear and bilinear oscillators to a recorded ground acceleration.

The ground acceleration is linear between its samples, the structure is linear on each of its branches,
and changes of branch are located within a step: the response has no error of discretization. Each
interval of the record is divided into sub-steps of ``h`` seconds, with ``w h`` at most `LONGEST`. Their
Taylor series gives the solution to rounding error, without the cancellations of the closed form, and a
cubic polynomial through the values and rates at both ends gives peaks with a relative error of a few
1e-4. The unit of time is the sub-step, also in velocities and accelerations.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.compiled import compiled

# Columns of the peaks: largest u and largest -u [m]; largest velocity, absolute acceleration and energy
# radius sqrt(u^2 + (u'/w)^2); u and y at the end; input, viscous and hysteretic energy per unit mass.
HIGHEST, LOWEST, VELOCITY, ACCELERATION, RADIUS, LAST, LAST_Y, INPUT, VISCOUS, HYSTERETIC = range(10)
PEAKS = 10
STATE = 6  # rows of a history: u, u', y, and the three energies so far
LONGEST = 1 / 3  # largest w h [rad]; the damping 2 xi w h is then below 2/3
TERMS = 18  # of the Taylor series; the first term left out is below (2/3)^18 / 18!, 1e-19
SMALLEST = 1e-12  # least time between changes of branch, in sub-steps; more than six are unusual


class Oscillator(NamedTuple):
    """One structure, with the sub-step ``h`` as unit of time.

    The restoring force per unit mass is ``post u + couple y``, with ``y = uy z`` [m].
    """

    damping: float  # 2 xi w h
    stiffness: float  # (w h)^2
    post: float  # alpha (w h)^2
    couple: float  # (1 - alpha) (w h)^2
    uy: float  # yield displacement [m]
    # (branches, results, causes): change of the displacement in a sub-step, velocity at its end, and
    # integral of the change, per unit velocity, push and slope as in `expand`; first if elastic.
    transitions: Array


@compiled
def substeps(w, dt, per_radian):
    """Number of sub-steps of an interval of the record: ``per_radian`` times the smallest possible."""
    return max(1, int(np.ceil(w * dt * per_radian / LONGEST)))


@compiled
def oscillator(parameters, h, c):
    """The structure with ``parameters`` (4,) as in `run`, for sub-steps of ``h`` seconds."""
    w, xi, alpha, uy = parameters
    damping, stiffness = 2 * xi * w * h, (w * h) ** 2
    post, causes, transitions = alpha * stiffness, np.eye(3), np.empty((2, 3, 3))
    for branch, of_branch in enumerate((stiffness, post)):
        for n in range(3):
            expand(c, causes[n, 0], causes[n, 1], causes[n, 2], damping, of_branch)
            transitions[branch, 0, n], transitions[branch, 1, n] = evaluate(c, 1.0)
            transitions[branch, 2, n] = _integral(c, 1.0)
    return Oscillator(damping, stiffness, post, (1 - alpha) * stiffness, uy, transitions)


@compiled
def expand(c, velocity, push, slope, damping, stiffness):
    """Taylor coefficients ``c`` (TERMS,) of ``x'' + damping x' + stiffness x = push + slope t``.

    They are those with ``x(0) = 0`` and ``x'(0) = velocity``.
    """
    c[0] = 0.0
    c[1] = velocity
    c[2] = (push - damping * velocity) / 2
    c[3] = (slope - 2 * damping * c[2] - stiffness * velocity) / 6
    for n in range(4, TERMS):
        c[n] = -(damping * (n - 1) * c[n - 1] + stiffness * c[n - 2]) / (n * (n - 1))


@compiled
def evaluate(c, t):
    """Value and derivative at ``t`` of the polynomial with coefficients ``c``, by Horner's scheme."""
    value, rate = c[TERMS - 1], 0.0
    for n in range(TERMS - 2, -1, -1):
        rate = rate * t + value
        value = value * t + c[n]
    return value, rate


@compiled
def _integral(c, t):
    """Integral from 0 to ``t`` of the polynomial with coefficients ``c``."""
    total = 0.0
    for n in range(TERMS - 1, -1, -1):
        total = (total + c[n] / (n + 1)) * t
    return total


@compiled
def _acceleration(o, u, v, y, ground):
    """Relative acceleration by the equation of motion."""
    return -ground - o.post * u - o.couple * y - o.damping * v


@compiled
def _quiet(o, u, v, y, side, ground, rise, peaks):
    """Advance by one sub-step on one branch; ``side`` is 1 or -1 where it yields, and 0 if elastic."""
    push = _acceleration(o, u, 0.0, y, ground)
    to = o.transitions[0 if side == 0 else 1]
    change = to[0, 0] * v + to[0, 1] * push - to[0, 2] * rise
    v1 = to[1, 0] * v + to[1, 1] * push - to[1, 2] * rise
    integral = to[2, 0] * v + to[2, 1] * push - to[2, 2] * rise
    u1, y1 = u + change, y + change if side == 0 else y
    _update(o, 1.0, side, u, v, y, ground, u1, v1, y1, ground + rise, integral, peaks)
    return u1, v1, y1


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
def _largest_acceleration(o, stiffness, v, a, rise):
    """Bound of the acceleration within a sub-step that begins with this velocity and acceleration.

    Its rate is ``-rise - damping a - stiffness v``, and the velocity is at most ``v`` and it together.
    """
    stiffness = abs(stiffness)
    return (abs(a) + abs(rise) + stiffness * abs(v)) / (1.0 - o.damping - stiffness)


@compiled
def _until(left, rate, curve, change, end):
    """Shortest time, at most ``end``, in which a value covers a distance.

    The value has this rate and curvature, and its curvature changes at ``change`` at most: while it
    remains negative the rate alone counts.
    """
    time = _covered(left, rate, max(curve + change * end, 0.0), end)
    return max(time, _covered(left, rate, 0.0, min(end, -curve / change))) if curve < 0 else time


@compiled
def _covered(left, rate, curve, end):
    """Time, at most ``end``, in which a distance is covered with this rate and constant curvature."""
    root = np.sqrt(rate * rate + 2.0 * curve * max(left, 0.0))
    if rate > 0:
        return min(end, 2.0 * left / (root + rate))
    return min(end, (root - rate) / curve) if curve > 0 else end


@compiled
def _until_change(o, c, v, y, side, push, rise, end):
    """Time until the branch changes, at most ``end``; ``c`` are the coefficients of the displacement.

    Each step goes as far as bounds of the derivatives allow without a change, so that none is missed
    however brief it is; near a change the steps are those of Newton.
    """
    stiffness = o.stiffness if side == 0 else o.post
    most = _largest_acceleration(o, stiffness, v, push - o.damping * v, rise)
    jerk = abs(rise) + o.damping * most + abs(stiffness) * (abs(v) + most)
    snap = o.damping * jerk + abs(stiffness) * most
    t = 0.0
    while True:
        x, rate = evaluate(c, t)
        a = push - rise * t - o.damping * rate - stiffness * x
        if side == 0:
            step = min(
                _until(o.uy - y - x, rate, a, jerk, end - t),
                _until(o.uy + y + x, -rate, -a, jerk, end - t),
            )
        else:
            curve = side * (rise + o.damping * a + stiffness * rate)
            step = _until(side * rate, -side * a, curve, snap, end - t)
        if not step < end - t:  # or the structure fell, beyond all numbers
            return end
        t += step
        if step <= SMALLEST:
            return t


@compiled
def _legs(o, u, v, y, side, ground, rise, peaks, c):
    """Advance by one sub-step, from one change of branch to the next.

    Returns the state and the branch ``side`` at its end.
    """
    t, count = 0.0, 0
    while t < 1.0:
        now, left = ground + rise * t, 1.0 - t
        push = _acceleration(o, u, 0.0, y, now)
        expand(c, v, push, -rise, o.damping, o.stiffness if side == 0 else o.post)
        length = _until_change(o, c, v, y, side, push, rise, left)
        changes = length < left
        if changes:  # advance a little, so that rounding cannot cause endless changes of branch
            count += 1
            length = min(max(length, SMALLEST * 2.0**count), left)
        change, v1 = evaluate(c, length)
        u1, y1, next_side = u + change, y + change if side == 0 else y, side
        if changes and side == 0:
            next_side = 1 if y1 > 0 else -1
            y1 = next_side * o.uy
        elif changes:
            v1, next_side = 0.0, 0
        integral, then = _integral(c, length), now + rise * length
        _update(o, length, side, u, v, y, now, u1, v1, y1, then, integral, peaks)
        u, v, y, side = u1, v1, y1, next_side
        t = t + length if changes else 1.0
    return u, v, y, side


@compiled
def _update(o, length, side, u, v, y, ground, u1, v1, y1, ground1, integral, peaks):
    """Update peaks and energies by a part of a sub-step on one branch, of this ``length``.

    ``integral`` is that of the change of displacement over the part: by parts, the input is exact.
    """
    stiffness = o.stiffness if side == 0 else o.post
    a, a1 = _acceleration(o, u, v, y, ground), _acceleration(o, u1, v1, y1, ground1)
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
def _coefficients(length, value, rate, value1, rate1):
    """Those of the cubic polynomial through the values and rates at both ends, over the share."""
    begin, end, rise = rate * length, rate1 * length, value1 - value
    return begin, 3 * rise - 2 * begin - end, begin + end - 2 * rise


@compiled
def _cubic(s, length, value, rate, value1, rate1):
    """Value of that polynomial at the share ``s`` of the length."""
    begin, square, cube = _coefficients(length, value, rate, value1, rate1)
    return value + s * (begin + s * (square + s * cube))


@compiled
def top(length, value, rate, value1, rate1):
    """Largest value of the cubic polynomial through the values and rates at both ends of a length."""
    largest = max(value, value1)
    if rate > 0 > rate1:
        begin, square, cube = _coefficients(length, value, rate, value1, rate1)
        s = begin / (np.sqrt(square * square - 3 * cube * begin) - square)
        largest = max(largest, value + s * (begin + s * (square + s * cube)))
    return largest


@compiled
def run(parameters, ground, dt, cuts, peaks, each, out):
    """Response of one structure from rest to ``ground`` (samples,) [m/s^2], with time step ``dt`` [s].

    Each interval has ``cuts`` sub-steps. ``parameters`` (4,) are the circular frequency ``w`` [rad/s],
    damping ratio, hardening ratio, and yield displacement [m] or infinity. The results are written to
    ``peaks`` (PEAKS,). Every ``each``-th state (``u``, ``u'``, ``y``, and the input, viscous and
    hysteretic energies per unit mass so far) is written to a column of ``out``, none if ``each`` is 0.
    """
    h, c = dt / cuts, np.empty(TERMS)
    o = oscillator(parameters, h, c)
    u, v, y, side = 0.0, 0.0, 0.0, 0
    peaks[:] = 0.0
    steps = cuts * (ground.size - 1)
    for at in range(steps + 1):
        if each and at % each == 0:
            _keep(o, u, v, y, h, peaks, out[:, at // each])
        if at == steps:
            break
        s = at // cuts
        rise = (ground[s + 1] - ground[s]) * h * h / cuts
        now = ground[s] * h * h + (at - s * cuts) * rise
        a, stiffness = _acceleration(o, u, v, y, now), o.stiffness if side == 0 else o.post
        most = _largest_acceleration(o, stiffness, v, a, rise)
        if side * v > most if side != 0 else abs(y) + abs(v) + 0.5 * most <= o.uy:
            u, v, y = _quiet(o, u, v, y, side, now, rise, peaks)
        else:
            u, v, y, side = _legs(o, u, v, y, side, now, rise, peaks, c)
    peaks[VELOCITY] /= h
    peaks[ACCELERATION] /= h * h
    peaks[RADIUS] = max(np.sqrt(peaks[RADIUS]), peaks[HIGHEST], peaks[LOWEST])
    peaks[LAST], peaks[LAST_Y], peaks[VISCOUS] = u, y, _viscous(o, u, v, y, peaks)
    peaks[INPUT:] /= h * h
