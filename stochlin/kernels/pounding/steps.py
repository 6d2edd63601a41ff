"""Runge-Kutta steps of the 8th order by Dormand and Prince, polynomials within them; compiled.

Hairer, E., Norsett, S. P. and Wanner, G. (1993), Solving Ordinary Differential Equations I, section
II.10: 12 stages, an error from rules of order 5 and 3, and with three more stages a polynomial of degree
7 over the step.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.integrate import DOP853

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.compiled import called_often, compiled
from stochlin.kernels.basics.linear_branch import MARKS, TERMS, evaluate
from stochlin.kernels.pounding.contact import OPEN, has_fractional_power
from stochlin.kernels.pounding.rates import PENETRATION, measure, rates, rates_at_times
from stochlin.kernels.pounding.rows import Row, sizes, sizes_of, slip_of

# Contiguous, for numba's cache does not take constants that are not.
A, B, C, ERROR_5, ERROR_3, A_MORE, C_MORE, DENSE = (
    np.ascontiguousarray(getattr(DOP853, name))
    for name in ("A", "B", "C", "E5", "E3", "A_EXTRA", "C_EXTRA", "D")
)
STAGES, ALL = 12, 16
SHAPES = 7  # 1 t, 2 t (1-t), 3 t^2 (1-t), 4 t^2 (1-t)^2, ... 7 t^4 (1-t)^3
POWERS = np.zeros((SHAPES, SHAPES + 1))  # of t in these shapes
POWERS[0, 1] = 1.0
for _m in range(1, SHAPES):
    _times_t = np.roll(POWERS[_m - 1], 1)
    POWERS[_m] = _times_t if _m % 2 == 0 else POWERS[_m - 1] - _times_t
NODES = 8  # evenly over a step, where the forces of the contacts are looked at
FROM_NODES = np.ascontiguousarray(np.linalg.inv(np.vander(np.linspace(0, 1, NODES), increasing=True)))

TOLERANCE = 1e-10  # of a step, over the largest displacement, velocity and energy so far
ROUGH = 1e-2  # of that in a contact whose force ends with a fractional power, as no polynomial does
TINY = 1e-150  # for a building that was never moved; its inverse squared is still a number
REACH = 3


class Space(NamedTuple):
    """Arrays that a run writes into; k the length of the state, c contacts."""

    stages: Array  # (ALL, k): the first is the rates at the beginning, number STAGES those at the end
    new: Array  # (k,): the state at the end
    after: Array  # (k,): and where the step is cut
    shapes: Array  # (SHAPES, k): the polynomials
    state: Array  # (k,)
    rate: Array  # (k,)
    force: Array  # (c,)
    nodes: Array  # (NODES, c): forces
    depths: Array  # (NODES, c): compressions
    powers: Array  # (NODES, c): of these forces on the right
    shaken: Array  # (NODES, n): absolute accelerations, in contact
    reach: Array  # (2 REACH, s): largest displacement and velocity of each building, energy; and again
    line: Array  # (TERMS,)
    lines: Array  # (4, TERMS)
    marks: Array  # (2, MARKS)

    @classmethod
    def of(cls, row: Row) -> Space:
        """New ones for a run."""
        n, s, c, k = sizes_of(row)
        shapes = (
            *((ALL, k), (k,), (k,), (SHAPES, k), (k,), (k,), (c,)),
            *((NODES, c), (NODES, c), (NODES, c), (NODES, n)),
            *((2 * REACH, s), (TERMS,), (4, TERMS), (2, MARKS)),
        )
        return cls(*(np.zeros(shape) for shape in shapes))


@compiled
def copy(source, target):
    """Copy entries of a state."""
    for i in range(source.size):
        target[i] = source[i]


@compiled
def _combine(weights, count, stages, h, x, out):
    copy(x, out)
    for j in range(count):
        w = h * weights[j]
        if w != 0.0:
            for i in range(x.size):
                out[i] += w * stages[j, i]


@compiled
def attempt(row, branch, ground, slope, h, x, space):
    """Take a step of ``h`` seconds from ``x``; returns its error over the tolerance.

    The ground acceleration is ``ground`` at the beginning and has the slope ``slope``; the rates at the
    beginning are there.
    """
    for m in range(1, STAGES):
        _combine(A[m], m, space.stages, h, x, space.state)
        now = ground + slope * (C[m] * h)
        rates(row, branch, now, space.state, space.stages[m], space.force)
    _combine(B, STAGES, space.stages, h, x, space.new)
    error = _error(row, h, space)
    for j in range(row.gap.size):
        if branch.contact[j] != OPEN and has_fractional_power(row.element[j]):
            return error / ROUGH
    return error


@compiled
def greatest(values):
    """Of some that are not negative."""
    most = 0.0
    for value in values:
        most = max(most, value)
    return most


@called_often
def grow_reach(row, x, reach):
    """Take a state into the largest displacement, velocity and energy."""
    n, s, _, _ = sizes(row)
    kinetic = 0.0
    for b in range(s):
        for i in range(row.first[b], row.first[b + 1]):
            reach[0, b] = max(reach[0, b], abs(x[i]))
            reach[1, b] = max(reach[1, b], abs(x[n + i]))
            kinetic += 0.5 * row.mass[i] * x[n + i] ** 2
    reach[2, 0] = max(reach[2, 0], kinetic)
    for i in range(3 * n, slip_of(row, 0)):
        reach[2, 0] = max(reach[2, 0], abs(x[i]))


@compiled
def _error(row, h, space):
    """Error of the step over the tolerance: the root of the sum over the state, not of its mean."""
    n, k = row.mass.size, slip_of(row, 0)
    reach = space.reach[REACH:]  # that of this step, which may yet be refused
    for i in range(REACH):
        copy(space.reach[i], reach[i])
    grow_reach(row, space.new, reach)
    fives, threes = space.state, space.rate
    for i in range(k):
        fives[i] = threes[i] = 0.0
    for m in range(STAGES):
        five, three = ERROR_5[m], ERROR_3[m]
        for i in range(k):
            fives[i] += five * space.stages[m, i]
            threes[i] += three * space.stages[m, i]
    fifth, third = 0.0, 0.0
    for i in range(3 * n, k):
        fifth, third = fifth + fives[i] ** 2, third + threes[i] ** 2
    weight = 1.0 / (TOLERANCE * reach[2, 0] + TINY)
    fifth, third = fifth * weight**2, third * weight**2
    for b in range(row.first.size - 1):
        for part in range(3):
            size = reach[1 if part == 1 else 0, b]
            weight = 1.0 / (TOLERANCE * size + TINY)
            for i in range(part * n + row.first[b], part * n + row.first[b + 1]):
                fifth += (fives[i] * weight) ** 2
                third += (threes[i] * weight) ** 2
    if fifth == 0.0 and third == 0.0:
        return 0.0
    return h * fifth / np.sqrt(fifth + 0.01 * third)


@compiled
def interpolate(row, branch, ground, slope, h, x, space):
    """Find the polynomials of the step that was taken; the rates at its end are there."""
    stages, shapes = space.stages, space.shapes
    for m in range(3):
        _combine(A_MORE[m], STAGES + 1 + m, stages, h, x, space.state)
        now = ground + slope * (C_MORE[m] * h)
        rates_at_times(row, branch, now, space.state, stages[STAGES + 1 + m], space.force)
    for i in range(x.size):
        rise = space.new[i] - x[i]
        shapes[0, i] = rise
        shapes[1, i] = h * stages[0, i] - rise
        shapes[2, i] = 2.0 * rise - h * (stages[0, i] + stages[STAGES, i])
    for m in range(4):
        for i in range(x.size):
            shapes[3 + m, i] = 0.0
        for j in range(ALL):
            w = h * DENSE[m, j]
            if w != 0.0:
                for i in range(x.size):
                    shapes[3 + m, i] += w * stages[j, i]


@compiled
def state_within(x, t, space, out):
    """State at the share ``t`` of the step."""
    for i in range(x.size):
        value = 0.0
        for m in range(SHAPES - 1, -1, -1):
            value = (value + space.shapes[m, i]) * (t if m % 2 == 0 else 1.0 - t)
        out[i] = x[i] + value


@compiled
def polynomial(row, what, number, shift, x, space):
    """Coefficients of a `measure` less ``shift`` over the step, in ``space.line``."""
    line = space.line
    line[:] = 0.0
    line[0] = measure(row, what, number, x) - shift
    for m in range(SHAPES):
        factor = measure(row, what, number, space.shapes[m])
        for p in range(1, SHAPES + 1):
            line[p] += factor * POWERS[m, p]


@compiled
def component_polynomial(i, sign, x, space):
    """Coefficients of one entry of the state over the step, times ``sign``, in ``space.line``."""
    line = space.line
    line[:] = 0.0
    line[0] = sign * x[i]
    for m in range(SHAPES):
        for p in range(1, SHAPES + 1):
            line[p] += sign * space.shapes[m, i] * POWERS[m, p]


@compiled
def find_node_forces(row, branch, ground, slope, h, x, space):
    """Forces, compressions and powers of the contacts, and accelerations, evenly over the step."""
    n = row.mass.size
    for q in range(NODES):
        t = q / (NODES - 1)
        state_within(x, t, space, space.state)
        now = ground + slope * (t * h)
        rates_at_times(row, branch, now, space.state, space.rate, space.nodes[q])
        for i in range(n):
            space.shaken[q, i] = space.rate[n + i] + now
        for j in range(row.gap.size):
            v = row.weight[j, 1] * space.state[n + row.right[j]]
            v += min(row.weight[j, 2], 0.0) * space.state[n + row.lower[j]]
            space.powers[q, j] = -space.nodes[q, j] * v
            space.depths[q, j] = measure(row, PENETRATION, j, space.state) - row.gap[j]


@compiled
def force_polynomial(contact, space):
    """Coefficients of the force of a contact over the step, in ``space.line``."""
    _through(space.nodes, contact, space.line)


@compiled
def depth_within(contact, t, space):
    """Compression of a contact at the share ``t`` of the step."""
    _through(space.depths, contact, space.line)
    return evaluate(space.line, t)[0]


@compiled
def work_within(contact, t, space):
    """Work of a contact on its right up to the share ``t`` of the step, over its length [J/s]."""
    _through(space.powers, contact, space.line)
    work = 0.0
    for p in range(NODES - 1, -1, -1):
        work = (work + space.line[p] / (p + 1)) * t
    return work


@compiled
def _through(nodes, contact, line):
    """Coefficients of the polynomial through values at the nodes."""
    line[:] = 0.0
    for p in range(NODES):
        for q in range(NODES):
            line[p] += FROM_NODES[p, q] * nodes[q, contact]
