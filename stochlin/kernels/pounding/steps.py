"""Runge-Kutta steps of order 8 by Dormand and Prince, and interpolating polynomials within them.

Hairer, E., Norsett, S. P. and Wanner, G. (1993), Solving Ordinary Differential Equations I, section
II.10: 12 stages, an error estimate from embedded formulas of orders 5 and 3, and with three more stages
a polynomial of degree 7 over the step.
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

# Contiguous arrays, since numba cannot cache code with other constant arrays.
A, B, C, ERROR_5, ERROR_3, A_MORE, C_MORE, DENSE = (
    np.ascontiguousarray(getattr(DOP853, name))
    for name in ("A", "B", "C", "E5", "E3", "A_EXTRA", "C_EXTRA", "D")
)
STAGES, ALL = 12, 16  # stages of a step; with the rates at its end and three stages for interpolation
SHAPES = 7  # shape functions of the interpolation: t, t (1-t), t^2 (1-t), t^2 (1-t)^2, ... t^4 (1-t)^3
POWERS = np.zeros((SHAPES, SHAPES + 1))  # coefficients of the powers of t in these functions
POWERS[0, 1] = 1.0
for _m in range(1, SHAPES):
    _times_t = np.roll(POWERS[_m - 1], 1)
    POWERS[_m] = _times_t if _m % 2 == 0 else POWERS[_m - 1] - _times_t
NODES = 8  # equally spaced times over a step at which contact forces are evaluated
FROM_NODES = np.ascontiguousarray(np.linalg.inv(np.vander(np.linspace(0, 1, NODES), increasing=True)))

TOLERANCE = 1e-10  # error of a step over the largest displacement, velocity and energy so far
ROUGH = 1e-2  # factor on the tolerance during contacts whose force has a fractional power of ``d``
TINY = 1e-150  # in place of zero for a building that has not moved; 1/TINY^2 is still finite
REACH = 3  # rows of the largest displacements, velocities and energy in `Space.reach`


class Space(NamedTuple):
    """Working space of a run: state of length ``k``, ``c`` contacts, ``n`` floors, ``s`` buildings."""

    stages: Array  # (ALL, k): rates at the stages; the first at the beginning, number STAGES at the end
    new: Array  # (k,): state at the end of the step
    after: Array  # (k,): state at the event that cuts the step short, or at its end
    shapes: Array  # (SHAPES, k): coefficients of the shape functions of the interpolation
    state: Array  # (k,): a state in between
    rate: Array  # (k,): its rates
    force: Array  # (c,) [N]: its contact forces
    nodes: Array  # (NODES, c) [N]: contact forces at the nodes
    depths: Array  # (NODES, c) [m]: penetrations
    powers: Array  # (NODES, c) [W]: powers of the contact forces on the structures on the right
    shaken: Array  # (NODES, n) [m/s^2]: absolute accelerations
    # (2 REACH, s): largest displacements and velocities of each building so far, and the largest energy
    # (in the first column); then the same including the step that is tried
    reach: Array
    line: Array  # (TERMS,): coefficients of one polynomial
    lines: Array  # (4, TERMS): working space of `linear_branch.first_exit`
    marks: Array  # (2, MARKS): the same

    @classmethod
    def of(cls, row: Row) -> Space:
        """Working space for a run of this row, all zero."""
        n, s, c, k = sizes_of(row)
        shapes = (
            *((ALL, k), (k,), (k,), (SHAPES, k), (k,), (k,), (c,)),
            *((NODES, c), (NODES, c), (NODES, c), (NODES, n)),
            *((2 * REACH, s), (TERMS,), (4, TERMS), (2, MARKS)),
        )
        return cls(*(np.zeros(shape) for shape in shapes))


@compiled
def copy(source, target):
    """Copy an array into another, entry by entry."""
    for i in range(source.size):
        target[i] = source[i]


@compiled
def _combine(weights, count, stages, h, x, out):
    """Write ``x + h sum(weights stages)``, over the first ``count`` stages, to ``out``."""
    copy(x, out)
    for j in range(count):
        w = h * weights[j]
        if w != 0.0:
            for i in range(x.size):
                out[i] += w * stages[j, i]


@compiled
def attempt(row, branch, ground, slope, h, x, space):
    """Compute a step of ``h`` seconds from ``x`` into ``space.new``.

    Returns its error over the tolerance. The ground acceleration is ``ground`` [m/s^2] at the beginning
    and changes by ``slope`` [m/s^3]. The rates at the beginning have to be in ``space.stages[0]``.
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
    """The largest of values that are not negative; 0 for none."""
    most = 0.0
    for value in values:
        most = max(most, value)
    return most


@called_often
def grow_reach(row, x, reach):
    """Update the largest displacements, velocities and energy in ``reach`` by the state ``x``."""
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
    """Error of the step over the tolerance: root of the sum, not the mean, of squares over the state."""
    n, k = row.mass.size, slip_of(row, 0)
    reach = space.reach[REACH:]  # including this step, which may still be rejected
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
    """Compute the interpolating polynomials of an accepted step into ``space.shapes``.

    The rates at its end have to be in ``space.stages[STAGES]``.
    """
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
    """Write the interpolated state at the share ``t``, 0 to 1, of the step to ``out``."""
    for i in range(x.size):
        value = 0.0
        for m in range(SHAPES - 1, -1, -1):
            value = (value + space.shapes[m, i]) * (t if m % 2 == 0 else 1.0 - t)
        out[i] = x[i] + value


@compiled
def polynomial(row, what, number, shift, x, space):
    """Write the polynomial of a `measure` less ``shift`` over the step to ``space.line``."""
    line = space.line
    line[:] = 0.0
    line[0] = measure(row, what, number, x) - shift
    for m in range(SHAPES):
        factor = measure(row, what, number, space.shapes[m])
        for p in range(1, SHAPES + 1):
            line[p] += factor * POWERS[m, p]


@compiled
def component_polynomial(i, sign, x, space):
    """Write the polynomial of ``sign`` times entry ``i`` of the state to ``space.line``."""
    line = space.line
    line[:] = 0.0
    line[0] = sign * x[i]
    for m in range(SHAPES):
        for p in range(1, SHAPES + 1):
            line[p] += sign * space.shapes[m, i] * POWERS[m, p]


@compiled
def find_node_forces(row, branch, ground, slope, h, x, space):
    """Write the values at the nodes of the step to ``nodes``, ``depths``, ``powers`` and ``shaken``."""
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
    """Write the polynomial through the nodal forces of a contact to ``space.line``."""
    _through(space.nodes, contact, space.line)


@compiled
def depth_within(contact, t, space):
    """Penetration of a contact at the share ``t`` of the step [m], interpolated between the nodes."""
    _through(space.depths, contact, space.line)
    return evaluate(space.line, t)[0]


@compiled
def work_within(contact, t, space):
    """Work of a contact on the structure on its right up to the share ``t``, over ``h`` [J/s]."""
    _through(space.powers, contact, space.line)
    work = 0.0
    for p in range(NODES - 1, -1, -1):
        work = (work + space.line[p] / (p + 1)) * t
    return work


@compiled
def _through(nodes, contact, line):
    """Write the polynomial through the values of a contact at the nodes to ``line``."""
    line[:] = 0.0
    for p in range(NODES):
        for q in range(NODES):
            line[p] += FROM_NODES[p, q] * nodes[q, contact]
