"""Equations of motion of buildings in a row, on the branches that they are on; compiled.

A building is a stack of floors on springs with dashpots, or one mass; the force of a storey is ``alpha k
drift + (1 - alpha) k y``, where ``y = drift - slip`` [m] and the slip moves only with yielding.
Neighbours meet at contacts, each between a floor of the left one and a floor of the right one, with the
penetration ``d = u_left - u_right - gap``. Which branch a storey or a contact is on is told, so that
the rates are smooth functions: they go on smoothly a little beyond the end of the branch too.

The state holds displacements, velocities and slips of all floors, the work that the ground, the
dashpots and the yielding have done in each building, and what each contact has dissipated.
"""

from __future__ import annotations

from typing import NamedTuple

import numba as nb
import numpy as np

from stochlin.kernels.arrays import Array
from stochlin.kernels.contact import (
    HERTZ_DAMP,
    IMPACT_KELVIN,
    JANKOWSKI,
    KELVIN,
    NO_TENSION,
    separation_margin,
)
from stochlin.kernels.linear_branch import jit

ELASTIC, BILINEAR, BOUC_WEN = range(3)  # laws of a storey
STEREOMECHANICAL = 6  # beside the kinds of contact elements
OPEN, CLOSED, OPENING, PARTED, TOGETHER = range(5)  # branches of a contact
STRAIN, STRAIN_RATE, PENETRATION, CLOSING_RATE, MARGIN = range(5)  # see `measure`

lean = nb.njit(nogil=True, error_model="numpy")


class Row(NamedTuple):
    """Buildings in a row: n floors of s buildings, c contacts."""

    first: Array  # (s + 1,): number of the first floor of each building, and n
    below: Array  # (n,): number of the floor below, -1 for the ground
    mass: Array  # (n,) [kg]
    post: Array  # (n,) [N/m]: alpha k of the storey below the floor
    couple: Array  # (n,) [N/m]: (1 - alpha) k
    strength: Array  # (n,) [m]: yield drift, or uy of the Bouc-Wen law
    law: Array  # (n,)
    shape: Array  # (n, 3): beta, gamma and exponent of the Bouc-Wen law
    damping: Array  # (n, n) [N s/m]: zero between buildings
    left: Array  # (c,): number of the floor on the left; contacts along one level follow one another
    right: Array  # (c,)
    gap: Array  # (c,) [m]
    kind: int  # of the contacts, for all of them
    element: Array  # (c, 3): stiffness, exponent and damping, as `stochlin.kernels.contact` takes them
    restitution: float  # of stereomechanical impacts
    slow: float  # [m/s]: an approach slower than this does not count as one in the Hertz-damp law


class Branches(NamedTuple):
    """Where each storey and contact is on its law."""

    storey: Array  # (n,): bilinear: 0, or the sign of yielding; Bouc-Wen: sign of the strain rate
    side: Array  # (n,): Bouc-Wen: sign of the strain y
    contact: Array  # (c,)
    approach: Array  # (c,) [m/s]: velocity at the beginning of this contact
    entry: Array  # (c,): its line in the table of impacts, or -1


@lean
def sizes(row):  # type: ignore[no-untyped-def]
    """Numbers of floors, buildings and contacts, and the length of the state."""
    n, s, c = row.mass.size, row.first.size - 1, row.gap.size
    return n, s, c, 3 * n + 3 * s + c


@lean
def slip_rate(row, branch, i, y, rate):  # type: ignore[no-untyped-def]
    """Rate of the slip of a storey; Bouc-Wen: ``v |z|^n (beta sign(v z) + gamma)``."""
    law = row.law[i]
    if law == BILINEAR:
        return rate if branch.storey[i] != 0 else 0.0
    if law == ELASTIC:
        return 0.0
    beta, gamma, exponent = row.shape[i]
    z = branch.side[i] * y / row.strength[i]
    if exponent != 1.0:
        z = max(z, 0.0) ** exponent
    return rate * z * (beta * branch.storey[i] * branch.side[i] + gamma)


@lean
def branch_force(kind, branch, element, d, v, v0):  # type: ignore[no-untyped-def]
    """Force of a contact element and its elastic part [N]; see `stochlin.kernels.contact.force`."""
    k, n, c = element
    if branch == OPEN:
        return 0.0, 0.0
    elastic = k * d if n == 1.0 else k * max(d, 0.0) ** n
    if branch == PARTED:
        return 0.0, elastic
    if kind == HERTZ_DAMP:
        return (elastic * (1.0 + c * v / v0) if v0 > 0.0 else elastic), elastic
    if kind in (KELVIN, NO_TENSION) or (kind == IMPACT_KELVIN and branch == CLOSED):
        return elastic + c * v, elastic
    if kind == JANKOWSKI and branch == CLOSED:
        return elastic + c * max(d, 0.0) ** (0.5 * (n - 1.0)) * v, elastic
    return elastic, elastic


@lean
def rates(row, branch, ground, x, dx, force):  # type: ignore[no-untyped-def]
    """Rates ``dx`` of the state ``x`` and forces (c,) of the contacts, for a ground acceleration."""
    n, s, c, _ = sizes(row)
    for b in range(s):
        lo, hi = row.first[b], row.first[b + 1]
        entering, viscous, hysteretic, above = 0.0, 0.0, 0.0, 0.0
        dx[n + lo : n + hi] = 0.0
        for j in range(lo, hi):  # drags of the dashpots
            for i in range(lo, hi):
                dx[n + i] += row.damping[j, i] * x[n + j]
        for i in range(hi - 1, lo - 1, -1):
            drift, rate = x[i], x[n + i]
            if i > lo:
                drift -= x[i - 1]
                rate -= x[n + i - 1]
            y = drift - x[2 * n + i]
            slip = slip_rate(row, branch, i, y, rate)
            shear = row.post[i] * drift + row.couple[i] * y
            drag = dx[n + i]
            dx[i], dx[2 * n + i] = x[n + i], slip
            dx[n + i] = (above - shear - drag) / row.mass[i] - ground
            entering -= row.mass[i] * ground * x[n + i]
            viscous += drag * x[n + i]
            hysteretic += row.couple[i] * y * slip
            above = shear
        dx[3 * n + b], dx[3 * n + s + b], dx[3 * n + 2 * s + b] = entering, viscous, hysteretic
    for j in range(c):
        f, lost, kept = 0.0, 0.0, branch.contact[j]
        if kept not in (OPEN, TOGETHER):
            one, two = row.left[j], row.right[j]
            d, v = x[one] - x[two] - row.gap[j], x[n + one] - x[n + two]
            f, elastic = branch_force(row.kind, kept, row.element[j], d, v, branch.approach[j])
            lost = (f - elastic) * v
            dx[n + one] -= f / row.mass[one]
            dx[n + two] += f / row.mass[two]
        force[j], dx[3 * n + 3 * s + j] = f, lost
    if row.kind == STEREOMECHANICAL:
        _hold_together(row, branch, dx, force)


@lean
def _hold_together(row, branch, dx, force):  # type: ignore[no-untyped-def]
    """Forces with which floors that move together have one acceleration; tridiagonal along a level."""
    n, c = row.mass.size, row.gap.size
    for j in range(c):  # elimination: the rest of each pivot's line is parked in ``force``
        if branch.contact[j] == TOGETHER:
            one = row.left[j]
            free = dx[n + one] - dx[n + row.right[j]]
            if linked(row, branch, j):
                free += force[j - 1] / row.mass[one]
            force[j] = free / _pivot(row, branch, j)
    for j in range(c - 1, -1, -1):
        if branch.contact[j] == TOGETHER and j + 1 < c and linked(row, branch, j + 1):
            force[j] += force[j + 1] / (row.mass[row.right[j]] * _pivot(row, branch, j))
    for j in range(c):
        if branch.contact[j] == TOGETHER:
            dx[n + row.left[j]] -= force[j] / row.mass[row.left[j]]
            dx[n + row.right[j]] += force[j] / row.mass[row.right[j]]
    for j in range(c):  # equal to the last bit, so that rounding cannot part them
        if branch.contact[j] == TOGETHER:
            dx[n + row.right[j]] = dx[n + row.left[j]]


@lean
def linked(row, branch, j):  # type: ignore[no-untyped-def]
    """Whether the floor on the left of contact ``j`` also moves together with its own left."""
    return j > 0 and row.right[j - 1] == row.left[j] and branch.contact[j - 1] == TOGETHER


@lean
def _pivot(row, branch, j):  # type: ignore[no-untyped-def]
    """Pivot of contact ``j`` in the elimination, from the beginning of its chain."""
    start = j
    while linked(row, branch, start):
        start -= 1
    pivot = 0.0
    for i in range(start, j + 1):
        one, two = row.mass[row.left[i]], row.mass[row.right[i]]
        coupling = 1.0 / (one * one * pivot) if i > start else 0.0
        pivot = 1.0 / one + 1.0 / two - coupling
    return pivot


@lean
def measure(row, what, i, x):  # type: ignore[no-untyped-def]
    """Linear function of a state, or of its rates: of a storey or a contact with the number ``i``.

    STRAIN is ``y``; PENETRATION leaves out the gap; MARGIN is what ends a contact.
    """
    n = row.mass.size
    if what == STRAIN:
        below = x[row.below[i]] if row.below[i] >= 0 else 0.0
        return x[i] - below - x[2 * n + i]
    if what == STRAIN_RATE:
        below = x[n + row.below[i]] if row.below[i] >= 0 else 0.0
        return x[n + i] - below
    one, two = row.left[i], row.right[i]
    if what == CLOSING_RATE:
        return x[n + one] - x[n + two]
    apart = x[one] - x[two]
    if what == PENETRATION:
        return apart
    k, exponent, c = row.element[i]
    return separation_margin(row.kind, (k, exponent, c), apart, x[n + one] - x[n + two])


@jit
def starting_branches(row, x):  # type: ignore[no-untyped-def]
    """Branches at a state from which the motion begins: elastic; at rest at a gap of 0, together."""
    n, _, c, _ = sizes(row)
    branch = Branches(
        np.zeros(n, np.int64),
        np.ones(n, np.int64),
        np.zeros(c, np.int64),
        np.zeros(c),
        np.full(c, -1),
    )
    for i in range(n):
        if row.law[i] == BOUC_WEN:
            branch.storey[i] = 1
    for j in range(c):
        d = measure(row, PENETRATION, j, x) - row.gap[j]
        if row.kind == STEREOMECHANICAL and d >= 0 and measure(row, CLOSING_RATE, j, x) == 0:
            branch.contact[j] = TOGETHER
    return branch
