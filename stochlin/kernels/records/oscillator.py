"""Exact response of linear and bilinear oscillators to a recorded ground acceleration.

The ground acceleration is linear between its samples, the structure is linear on each of its
branches, and changes of branch are located within a step: the response has no error of
discretization. Each interval of the record is divided into sub-steps of ``h`` seconds, with ``w h``
at most `LARGEST_PHASE_STEP`. Their Taylor series gives the solution to rounding error, without the
cancellations of the closed form, and a cubic polynomial through the values and rates at both ends
gives peaks with a relative error of a few 1e-4.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.compiled import called_once, compiled, entry

# Columns of the peaks: largest u [m], and largest magnitude of u, of the velocity, of the
# acceleration of structure and ground together, and of the energy radius sqrt(u^2 + (u'/w)^2). Of a
# pair, the first column of the first structure is the largest u1 - u2, and the last the correlation
# of u1 and u2.
PEAKS = 6
HIGHEST, DISPLACEMENT, VELOCITY, ACCELERATION, RADIUS, RHO = range(PEAKS)
# Columns of a state: u, u', y, and the input and hysteretic energy per unit mass so far.
STATE = 5
INPUT_ENERGY = 3
HYSTERETIC = 4
LARGEST_PHASE_STEP = 1 / 3  # largest w h [rad]; the damping 2 xi w h is then below 2/3
TERMS = 18  # of the Taylor series; those left out are below (2/3)^14 4! / 18!, 1e-17 of the first
# error of the time of a change of branch, and least time between two, in sub-steps
SMALLEST = 1e-12


class Oscillator(NamedTuple):
    """One structure with restoring force ``post u + couple y`` per unit mass, ``y = uy z`` [m]."""

    damping: float  # 2 xi w [1/s]
    stiffness: tuple[float, float]  # w^2, and post = alpha w^2 while it yields [1/s^2]
    uy: float  # yield displacement [m]
    h: float  # sub-step [s]
    whole: tuple[tuple[float, ...], ...]  # `_impulse` after a sub-step, with each stiffness


@compiled
def _impulse(damping, stiffness, t):
    """Displacement at time ``t`` after a unit velocity at rest, and its first three integrals.

    The equation of motion relates successive integrals: the Taylor series of two gives the others.
    """
    before = 0.0
    term = t**4 / 24
    twice = 4 * term
    third = term
    for n in range(5, TERMS):
        before, term = term, -damping * t / n * term - stiffness * t * t / (n * (n - 1)) * before
        third += term
        twice += n * term
    twice /= t
    once = t * t / 2 - damping * twice - stiffness * third
    return t - damping * once - stiffness * twice, once, twice, third


@called_once
def _after(o, side, v, push, slope, t):
    """Change of displacement ``x``, its integral, velocity, acceleration after a time on a branch.

    They solve ``x'' + damping x' + stiffness x = push + slope t`` with ``x = 0`` and ``x' = v``
    before. The branch ``side`` is 1 or -1 where the structure yields, and 0 if it is elastic.
    """
    stiffness = o.stiffness[abs(side)]
    g, once, twice, third = o.whole[abs(side)] if t == o.h else _impulse(o.damping, stiffness, t)
    x = g * v + once * push + twice * slope
    integral = once * v + twice * push + third * slope
    v1 = v + (push + slope * t / 2) * t - o.damping * x - stiffness * integral
    return x, integral, v1, push + slope * t - o.damping * v1 - stiffness * x


@called_once
def _part(o, y, side, v, push, slope, end, least):
    """A time on this branch, at most ``end``, the branch after it, and the result of `_after`.

    No change of branch is missed, however brief the stay is (until 1e-12 sub-steps). The
    acceleration is zero at most once in a sub-step: where it has one sign at both ends of a time,
    or the velocity is too large to reach zero, the sign of the velocity at both ends says whether
    it turns, and displacements are between those at both ends if it does not. Where this does not
    decide, and yield is near, the time is halved. A change is located by Newton's method, and by
    halves where that leaves the bracket.
    """
    begin = min(least, end)
    last = end
    until = end
    then = side
    a = push - o.damping * v
    while True:
        x, integral, v1, a1 = _after(o, side, v, push, slope, until)
        turns = a * a1 < 0 and abs(v) < until * abs(a)
        outward = -side
        past = -side * v1
        rate = -side * a1
        if side == 0:
            reach = until * (abs(v) + until * max(abs(a), abs(a1)))
            turns = (turns or v * v1 < 0) and abs(y) + reach > o.uy
            outward = 1 if x > 0 else -1
            past = outward * (y + x) - o.uy
            rate = outward * v1
        if then == side:
            if turns and until > 2 * least:
                until /= 2
                continue
            if not past > 0:
                break
            then = side + outward
        begin, last = (begin, until) if past > 0 else (until, last)
        t = until - past / rate
        if not begin <= t <= last:
            t = begin + (last - begin) / 2
        if abs(t - until) <= SMALLEST * o.h:
            break
        until = t
    return until, then, x, integral, v1, a1


@called_once
def _advance(o, state, side, ground, slope, peaks):
    """Advance ``state`` (STATE,) by a sub-step, in parts on one branch; returns the last branch."""
    left = o.h
    least = SMALLEST * o.h
    post = o.stiffness[1]
    couple = o.stiffness[0] - post
    while left > 0:
        u = state[0]
        v = state[1]
        y = state[2]
        push = -ground - post * u - couple * y
        length, then, x, integral, v1, a1 = _part(o, y, side, v, push, -slope, left, least)
        ground1 = ground + slope * length
        _update(o, side, length, u, v, push - o.damping * v, ground, u + x, v1, a1, ground1, peaks)
        state[0] = u + x
        state[1] = v1
        state[INPUT_ENERGY] -= ground1 * x - slope * integral  # exact, by parts
        if side == 0:
            state[2] = y + x if then == 0 else then * o.uy
        else:
            state[HYSTERETIC] += couple * o.uy * abs(x)
            state[1] = v1 if then == side else 0.0
        side = then
        left = left - length
        least = 2 * least
        ground = ground1
    return side


@called_once
def _update(o, side, length, u, v, a, ground, u1, v1, a1, ground1, peaks):
    """Update peaks by a part of a sub-step on one branch, of this ``length``."""
    elastic = o.stiffness[0]
    stiffness = o.stiffness[abs(side)]
    turn = turning(length, u, v, u1, v1)
    peaks[HIGHEST] = max(peaks[HIGHEST], u1, turn)
    peaks[DISPLACEMENT] = max(peaks[DISPLACEMENT], abs(u1), abs(turn))
    peaks[VELOCITY] = max(peaks[VELOCITY], abs(v1), abs(turning(length, v, a, v1, a1)))
    b = a + ground
    b1 = a1 + ground1
    turn = turning(length, b, -o.damping * a - stiffness * v, b1, -o.damping * a1 - stiffness * v1)
    peaks[ACCELERATION] = max(peaks[ACCELERATION], abs(b1), abs(turn))
    peaks[RADIUS] = max(peaks[RADIUS], u1 * u1 + v1 * v1 / elastic)
    # The rate of u^2 + u'^2/w^2 is 2 u' (u + u''/w^2). Where u' is zero, it is u^2. A zero of the
    # other factor by linear interpolation is near enough, since the radius is stationary there.
    away = u * elastic + a
    away1 = u1 * elastic + a1
    if away * away1 < 0:
        s = away / (away - away1)
        u = _cubic(s, length, u, v, u1, v1)
        v = _cubic(s, length, v, a, v1, a1)
        peaks[RADIUS] = max(peaks[RADIUS], u * u + v * v / elastic)


@compiled
def _cubic(s, length, value, rate, value1, rate1):
    """Value at the share ``s`` of a cubic polynomial with these values and rates at both ends."""
    begin = rate * length
    end = rate1 * length
    rise = value1 - value
    return value + s * (begin + s * (3 * rise - 2 * begin - end + s * (begin + end - 2 * rise)))


@compiled
def turning(length, value, rate, value1, rate1):
    """Value at which that polynomial turns within the length, or that at the end if it does not."""
    if not rate * rate1 < 0:
        return value1
    middle = 3 * (value1 - value) / length - rate - rate1
    s = rate / (np.copysign(np.sqrt(middle * middle - rate * rate1), rate) + rate - middle)
    if not 0.0 <= s <= 1.0:  # the rates are below the rounding errors of the values
        return value1
    return _cubic(s, length, value, rate, value1, rate1)


@compiled
def _oscillator(parameters, step):
    """The structure with parameters (4,) of `run`, and its number of sub-steps in a step [s]."""
    w, xi, alpha, uy = parameters
    substeps = max(1, int(np.ceil(w * step / LARGEST_PHASE_STEP)))
    h = step / substeps
    damping = 2 * xi * w
    stiffness = (w * w, alpha * w * w)
    whole = _impulse(damping, stiffness[0], h), _impulse(damping, stiffness[1], h)
    return Oscillator(damping, stiffness, uy, h, whole), substeps


@compiled
def _branch(o, state):
    """The branch of a state: that where the structure yields if it is at yield and goes on."""
    y = state[2]
    if abs(y) == o.uy and y * state[1] > 0:
        return 1 if y > 0 else -1
    return 0


@called_once
def _respond(ground, dt, structures, refine, results, path):
    """Response of one cell of `run`: ``structures`` (sides, 4), ``results`` (sides, columns)."""
    sides = len(structures)
    last = refine * (len(ground) - 1)
    step = dt / refine
    first, substeps_of_first = _oscillator(structures[0], step)
    second, substeps_of_second = _oscillator(structures[sides - 1], step)
    branch_of_first = _branch(first, results[0, PEAKS:])
    branch_of_second = _branch(second, results[sides - 1, PEAKS:])
    apart = 0.0
    difference = 0.0
    speed = 0.0
    square = 0.0
    product = 0.0
    square_2 = 0.0
    for at in range(last):
        s = at // refine
        slope = (ground[s + 1] - ground[s]) / dt
        part = at - s * refine
        for number in range(sides):
            is_first = number == 0
            o = first if is_first else second
            substeps = substeps_of_first if is_first else substeps_of_second
            branch = branch_of_first if is_first else branch_of_second
            for n in range(substeps):
                now = ground[s] + slope * o.h * (part * substeps + n)
                branch = _advance(o, results[number, PEAKS:], branch, now, slope, results[number])
            branch_of_first = branch if is_first else branch_of_first
            branch_of_second = branch_of_second if is_first else branch
        if len(path) > 0:
            for n in range(STATE):
                path[at + 1, n] = results[0, PEAKS + n]
        if sides == 2:
            u = results[0, PEAKS]
            u_2 = results[1, PEAKS]
            weight = 1.0 if at + 1 < last else 0.5  # the trapezoidal rule
            before = difference
            rate = speed
            difference = u - u_2
            speed = results[0, PEAKS + 1] - results[1, PEAKS + 1]
            apart = max(apart, difference, turning(step, before, rate, difference, speed))
            square += weight * u * u
            product += weight * u * u_2
            square_2 += weight * u_2 * u_2
    for number in range(sides):
        peaks = results[number]
        peaks[RADIUS] = max(np.sqrt(peaks[RADIUS]), peaks[DISPLACEMENT])
    if sides == 2:
        results[0, HIGHEST] = apart
        results[0, RHO] = product / np.sqrt(square * square_2)


@entry
def run(ground, dt, cells, refine, results, path):
    """Responses of cells of one or two structures to ``ground`` (samples,) [m/s^2].

    ``dt`` [s] is the time step of the ground. The parameters in ``cells`` (n, sides, 4) are the
    circular frequency ``w`` [rad/s], damping ratio, hardening ratio, and yield displacement [m] or
    infinity. Peaks and last states are written to ``results`` (n, sides, PEAKS + STATE), which has
    the states at the start, and zeros. Each interval of the ground has ``refine`` (n,) times, at
    which the two structures of a cell are compared. The states of the first structure at these
    times are written to ``path`` (times, STATE), but for that at the start, unless it is empty.
    """
    for cell in range(len(cells)):
        _respond(ground, dt, cells[cell], refine[cell], results[cell], path)
