"""Time steps of many oscillators on one ground, for `LANES` independent motions at once.

Ground filter, displacement and velocity follow the trapezoidal rule as one linear system. For
linear structures its stationary covariance is *exact for any step*: with ``(I - dt A/2) x_new = (I
+ dt A/2) x + b dW`` the stationary ``X`` satisfies ``A X + X A' + b b' = 0``, the equation of the
continuous system. With the exact transition of the filter in place of its trapezoidal rule this
would not hold. For a structure under a given motion the rule is Newmark's with average
acceleration. The bilinear law is stepped by an exact return map: an elastic trial step, which is
corrected to a plastic one if it exceeds yield. Both are linear and solved in closed form.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.compiled import called_often, entry, of_lane, variant

# Independent motions in the innermost loop, which fit vector registers and first-level cache.
# Loops with many constants take this number from the shape of an array. If the compiler knows it,
# it unrolls them completely, which takes up to twice as long, since constants do not stay in
# registers.
LANES = 32


def whole_groups(motions: int) -> int:
    """Number of motions rounded up to whole groups of `LANES`, which is the number simulated."""
    return -(-motions // LANES) * LANES


class FilterSteps(NamedTuple):
    """Step of a ground filter: ``q_new = transition q + gain xi``, forcing ``row q + direct xi``.

    ``xi`` is a standard normal number for each step; white noise has no states (m = 0). If every
    lane has another ground, all arrays have a last axis of `LANES`.
    """

    transition: Array  # (m, m)
    gain: Array  # (m,)
    row: Array  # (m,)
    direct: float


def filter_steps(
    matrix: Array, noise: Array, output: Array, intensity: float, dt: float
) -> FilterSteps:
    """Trapezoidal rule for ``q' = matrix q + noise n(t)``, where ``intensity`` is ``2 pi S0``.

    The forcing of a step is the mean of ``output q`` at both ends.
    """
    size = len(noise)
    if size == 0:
        direct = float(np.sqrt(intensity / dt))
        return FilterSteps(np.zeros((0, 0)), np.zeros(0), np.zeros(0), direct)
    left = np.linalg.inv(np.eye(size) - 0.5 * dt * matrix)
    transition = left @ (np.eye(size) + 0.5 * dt * matrix)
    # Where the matrix lets one state act on another neither directly nor through others, rounding
    # errors of the inverse are removed.
    acts = np.linalg.matrix_power(np.eye(size) + (matrix != 0), size) > 0
    transition = np.where(acts, transition, 0.0)
    gain = left @ noise * np.sqrt(intensity * dt)
    row = 0.5 * output @ (np.eye(size) + transition)
    return FilterSteps(transition, gain, row, float(0.5 * output @ gain))


def ground_block(ground: FilterSteps) -> Callable[[Array, Array, Array], None]:
    """Function that writes the mean forcing of each step to ``f`` and updates the filter's state.

    It takes normal numbers ``xi`` (steps, LANES), the state ``q`` (m, LANES) and ``f`` (steps,
    LANES). States that do not act on one another, such as those of grounds in parallel, are stepped
    separately. Filters of one oscillator and of two in a cascade have functions without loops over
    states, which are ten times as fast. The choice is made in Python, so that only what is used is
    compiled.
    """
    # the random numbers act on the forcing directly through the first of these
    blocks: list[Any] = []
    for states in _independent(ground.transition):
        arrays = ground.transition[states, states], ground.gain[states], ground.row[states]
        block = any_ground if np.ndim(ground.direct) == 0 else ground_of_each_lane
        if np.ndim(ground.direct) == 0 and len(arrays[1]) == 2:
            block = _one_oscillator
        elif np.ndim(ground.direct) == 0 and len(arrays[1]) == 4 and not arrays[0][:2, 2:].any():
            block = _two_oscillators
        direct = 0.0 * ground.direct if blocks else ground.direct
        blocks.append((block, states, [np.ascontiguousarray(array) for array in arrays], direct))

    def steps(xi: Array, q: Array, f: Array) -> None:
        if not blocks:
            np.multiply(xi, ground.direct, out=f)
        for number, (block, states, arrays, direct) in enumerate(blocks):
            part = np.empty_like(f) if number else f
            block(xi, q[states], *arrays, direct, part)
            if number:
                f += part

    return steps


def _independent(transition: Array) -> list[slice]:
    """Ranges of states that neither act on states outside the range nor are acted on by them."""
    acts: Any = transition if transition.ndim == 2 else np.abs(transition).max(axis=2)
    ends = [k for k in range(1, len(acts) + 1) if not (acts[:k, k:].any() or acts[k:, :k].any())]
    return [slice(begin, end) for begin, end in pairwise([0, *ends])]


def _any_states(xi, q, transition, gain, row, direct, f):
    """`ground_block` for any number of states, also with another ground in each lane."""
    moved = np.empty_like(q)
    for s in range(xi.shape[0]):
        number, force = xi[s], f[s]
        for lane in range(LANES):
            force[lane] = of_lane(direct, lane) * number[lane]
        for i in range(q.shape[0]):
            state, new, weight, push = q[i], moved[i], row[i], gain[i]
            for lane in range(LANES):
                force[lane] += of_lane(weight, lane) * state[lane]
                new[lane] = of_lane(push, lane) * number[lane]
            for j in range(q.shape[0]):
                other, part = q[j], transition[i, j]
                for lane in range(LANES):
                    new[lane] += of_lane(part, lane) * other[lane]
        for i in range(q.shape[0]):
            for lane in range(LANES):
                q[i, lane] = moved[i, lane]


any_ground = entry(_any_states)
ground_of_each_lane = entry(variant(_any_states, "ground_of_each_lane"))


@entry
def _one_oscillator(xi, q, transition, gain, row, direct, f):
    """`ground_block` for two states."""
    a00, a01, a10, a11 = transition[0, 0], transition[0, 1], transition[1, 0], transition[1, 1]
    g0, g1, r0, r1 = gain[0], gain[1], row[0], row[1]
    q0, q1 = q[0], q[1]
    for s in range(xi.shape[0]):
        for lane in range(xi.shape[1]):
            x0, x1, number = q0[lane], q1[lane], xi[s, lane]
            f[s, lane] = direct * number + (r0 * x0 + r1 * x1)
            q0[lane] = a00 * x0 + a01 * x1 + g0 * number
            q1[lane] = a10 * x0 + a11 * x1 + g1 * number


@entry
def _two_oscillators(xi, q, transition, gain, row, direct, f):
    """`ground_block` for two oscillators, of which the first drives the second."""
    a00, a01, a10, a11 = transition[0, 0], transition[0, 1], transition[1, 0], transition[1, 1]
    b00, b01, b10, b11 = transition[2, 0], transition[2, 1], transition[3, 0], transition[3, 1]
    c00, c01, c10, c11 = transition[2, 2], transition[2, 3], transition[3, 2], transition[3, 3]
    g0, g1, g2, g3 = gain[0], gain[1], gain[2], gain[3]
    r0, r1, r2, r3 = row[0], row[1], row[2], row[3]
    q0, q1, q2, q3 = q[0], q[1], q[2], q[3]
    for s in range(xi.shape[0]):
        for lane in range(xi.shape[1]):
            x0, x1, x2, x3, number = q0[lane], q1[lane], q2[lane], q3[lane], xi[s, lane]
            f[s, lane] = direct * number + (r0 * x0 + r1 * x1 + r2 * x2 + r3 * x3)
            q0[lane] = a00 * x0 + a01 * x1 + g0 * number
            q1[lane] = a10 * x0 + a11 * x1 + g1 * number
            q2[lane] = b00 * x0 + b01 * x1 + c00 * x2 + c01 * x3 + g2 * number
            q3[lane] = b10 * x0 + b11 * x1 + c10 * x2 + c11 * x3 + g3 * number


@entry
def bilinear_block(f, dt, parameters, u, v, z, every, out, first):
    """Steps of bilinear structures under the forcing ``f`` (steps, LANES).

    The state ``u``, ``v``, ``z`` (n, LANES) is displacement and velocity over the yield
    displacement and the hysteretic displacement; it is updated. The displacements after every
    ``every``-th step are written to the rows of ``out`` (samples, n or more, LANES) from ``first``
    on. ``parameters`` (n, 4) are damping ``2 xi w``, post-yield stiffness ``alpha w^2``, coupling
    ``(1 - alpha) w^2``, and the factor on ``f`` in the equation for ``u``.

    The increment ``moved`` of the displacement is that of an elastic step. If it takes ``z`` beyond
    yield, velocity and displacement are corrected in proportion to the excess, since the equations
    of the elastic and of the plastic step are linear and differ in ``z`` alone.
    """
    half, rate = 0.5 * dt, 2.0 / dt
    for n in range(u.shape[0]):
        d, k, h, scale = parameters[n]
        elastic = half / (1.0 + half * d + half * half * (k + h))
        push, carry, pull, trial = (
            dt * scale * elastic,
            2.0 * elastic,
            dt * k * elastic,
            dt * h * elastic,
        )
        ease = half * h / (1.0 + half * d + half * half * k)
        shift = half * ease
        limit = np.inf if h == 0.0 else 1.0  # of a linear structure z is kept at u
        un, vn, zn = u[n], v[n], z[n]
        sample = 0
        for s in range(f.shape[0]):
            for lane in range(f.shape[1]):
                disp, vel, hyst = un[lane], vn[lane], zn[lane]
                moved = (push * f[s, lane] - trial * hyst) + (carry * vel - pull * disp)
                z_trial = hyst + moved
                z_new = min(max(z_trial, -limit), limit)
                excess = z_trial - z_new
                zn[lane] = z_new
                un[lane] = (disp + moved) + shift * excess
                vn[lane] = (rate * moved - vel) + ease * excess
            if (s + 1) % every == 0:
                for lane in range(f.shape[1]):
                    out[sample, first + n, lane] = un[lane]
                sample += 1


@entry
def add_products(out, total):
    """Add ``sum_samples u_i u_j`` of ``out`` (samples, n, LANES) to lower triangles of ``total``.

    BLAS is not used, since for such small matrices its threads compete with those of the groups.
    Four samples are added at a time, to save writing the sum in between.
    """
    samples, n, lanes = out.shape
    fours = samples - samples % 4
    for i in range(n):
        for j in range(i + 1):
            row = total[i, j]
            for s in range(0, fours, 4):
                for lane in range(lanes):
                    row[lane] += (
                        out[s, i, lane] * out[s, j, lane]
                        + out[s + 1, i, lane] * out[s + 1, j, lane]
                    ) + (
                        out[s + 2, i, lane] * out[s + 2, j, lane]
                        + out[s + 3, i, lane] * out[s + 3, j, lane]
                    )
            for s in range(fours, samples):
                for lane in range(lanes):
                    row[lane] += out[s, i, lane] * out[s, j, lane]


@called_often
def _value(displacements, row, value):
    """Write a weighted sum of the displacements (n, LANES) at one sample to ``value`` (LANES,)."""
    first, weight = displacements[row[0]["column"]], row[0]["weight"]
    for lane in range(LANES):
        value[lane] = weight * first[lane]
    for k in range(1, len(row)):
        displacement, weight = displacements[row[k]["column"]], row[k]["weight"]
        if weight != 0.0:
            for lane in range(LANES):
                value[lane] += weight * displacement[lane]


@entry
def observe(out, rows, values):
    """Write functions of the displacements ``out`` to ``values`` (samples, m, LANES).

    The ``rows`` are those of `rows_of`.
    """
    for s in range(out.shape[0]):
        for i in range(len(rows)):
            _value(out[s], rows[i], values[s, i])


@called_often
def turned(begin, end, way):
    """The displacement at which a step turns, or else ``end``, and ``way`` at the end of the step.

    ``way`` is the velocity times the time step. By the trapezoidal rule the change of the
    displacement is its mean at both ends, and the displacement within the step a parabola.
    """
    end_way = 2.0 * (end - begin) - way
    return (begin + 0.5 * way * way / (way - end_way) if way * end_way < 0.0 else end), end_way


@entry
def keep_extremes(out, rows, begin, way, highest, lowest):
    """Update the extremes (m, LANES) of weighted sums of displacements by those in ``out``.

    ``begin`` is the sum at the end of the step before, and ``way`` as in `turned`; they are
    updated. Values that are NaN are left out. To the extremes so far 0 is added, since the compiler
    would otherwise write only to the lanes whose extreme changes, and a write to some lanes takes
    much longer than one to all.
    """
    value = np.empty(LANES)
    for i in range(len(rows)):
        for s in range(out.shape[0]):
            _value(out[s], rows[i], value)
            for lane in range(LANES):
                end = value[lane]
                turn, way[i, lane] = turned(begin[i, lane], end, way[i, lane])
                begin[i, lane] = end
                high, low = highest[i, lane] + 0.0, lowest[i, lane] + 0.0
                larger, smaller = (turn, end) if turn > end else (end, turn)
                highest[i, lane] = larger if larger > high else high
                lowest[i, lane] = smaller if smaller < low else low
