"""Equations of motion of buildings in a row, for given branches of all storeys, contacts and links.

A building is one mass, or floors on storey springs with dashpots. The force of a storey is
``alpha k drift + (1 - alpha) k y``, where ``y = drift - slip`` [m] and the slip changes only while the
storey yields. Neighbours meet at contacts. Each is between a floor of the left building and a floor of
the right one, with the penetration ``d = u_left - u_right - gap``. If a floor meets a column of its
neighbour, the displacement of the column is the weighted mean of the two floors at its ends.

Links are springs with dashpots between two floors, or between a floor and the ground. A spring may
yield as storeys do, or have slack and only pull; the force of a dashpot may be a power of its velocity.

The branches are given and stay fixed during a time step. The rates are therefore smooth functions of the
state, which also continue smoothly beyond the end of a branch. The state consists of the displacements,
velocities and slips of all floors; for each building the energy put in by the ground and the energies
dissipated by the dashpots and by yielding; the energy dissipated in each contact and in each link; and
the slips of the links.
"""

from stochlin.kernels.basics.compiled import called_often, compiled
from stochlin.kernels.pounding.contact import OPEN, TOGETHER, branch_force, separation_margin
from stochlin.kernels.pounding.rows import (
    BILINEAR,
    BOUC_WEN,
    COUPLE,
    DASHPOT,
    EXPONENT,
    LIMIT,
    POST,
    SLACK,
    creep_of,
    sizes,
    slip_of,
)

STRAIN, STRAIN_RATE, PENETRATION, CLOSING_RATE, MARGIN, STRETCH, STRETCH_RATE = range(7)  # see `measure`


@compiled
def _bouc_wen_rate(storey, side, shape, strength, y, rate):
    """Rate of the slip of a Bouc-Wen storey, ``v |z|^n (beta sign(v z) + gamma)`` [m/s].

    ``z = y/strength``, ``v`` is the rate of the drift; ``storey`` and ``side`` are the signs of ``v``
    and ``y`` on this branch.
    """
    beta, gamma, exponent = shape
    z = side * y / strength
    if exponent != 1.0:
        z = max(z, 0.0) ** exponent
    return rate * z * (beta * storey * side + gamma)


@called_often
def _drags(damping, lo, v, drag):
    """Dashpot forces of one building [N]: damping matrix times velocities ``v``.

    Four rows are summed at a time, so that the additions do not wait for one another.
    """
    m, i = v.size, 0
    while i + 4 <= m:
        a, b, c, d = 0.0, 0.0, 0.0, 0.0
        for j in range(m):
            w = v[j]
            a += damping[lo + i, lo + j] * w
            b += damping[lo + i + 1, lo + j] * w
            c += damping[lo + i + 2, lo + j] * w
            d += damping[lo + i + 3, lo + j] * w
        drag[i], drag[i + 1], drag[i + 2], drag[i + 3] = a, b, c, d
        i += 4
    for k in range(i, m):
        a = 0.0
        for j in range(m):
            a += damping[lo + k, lo + j] * v[j]
        drag[k] = a


@called_often
def _building(row, branch, b, ground, x, dx):
    """Write the rates of building ``b``, without contacts and links, into ``dx``."""
    n, s = row.mass.size, row.first.size - 1
    lo, hi = row.first[b], row.first[b + 1]
    u, v, slips = x[lo:hi], x[n + lo : n + hi], x[2 * n + lo : 2 * n + hi]
    shear, drag, slip = dx[lo:hi], dx[n + lo : n + hi], dx[2 * n + lo : 2 * n + hi]
    _drags(row.damping, lo, v, drag)
    entering, viscous, hysteretic, below, base = 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(u.size):
        at = lo + i
        drift, rate, law, storey = u[i] - below, v[i] - base, row.law[at], branch.storey[at]
        y = drift - slips[i]
        slipping = rate if law == BILINEAR and storey != 0 else 0.0
        if law == BOUC_WEN:
            shape, strength, side = row.shape[at], row.strength[at], branch.side[at]
            slipping = _bouc_wen_rate(storey, side, shape, strength, y, rate)
        held = row.couple[at] * y
        shear[i], slip[i] = row.post[at] * drift + held, slipping
        entering -= row.mass[at] * v[i]
        viscous += drag[i] * v[i]
        hysteretic += held * slipping
        below, base = u[i], v[i]
    above = 0.0
    for i in range(u.size - 1, -1, -1):
        drag[i] = (above - shear[i] - drag[i]) * row.per_mass[lo + i] - ground
        above = shear[i]
        shear[i] = v[i]
    dx[3 * n + b], dx[3 * n + s + b], dx[3 * n + 2 * s + b] = entering * ground, viscous, hysteretic


@called_often
def rates(row, branch, ground, x, dx, force):
    """Write the rates ``dx`` of the state ``x`` and the contact forces (c,) [N].

    ``ground`` is the ground acceleration [m/s^2].
    """
    n, s, c, _ = sizes(row)
    for b in range(s):
        _building(row, branch, b, ground, x, dx)
    for j in range(len(row.tied)):
        one, two = row.tied[j]
        force_there, lost, slipping = pull(row, branch, j, x)
        dx[n + one] -= force_there * row.per_mass[one]
        if two >= 0:
            dx[n + two] += force_there * row.per_mass[two]
        dx[3 * n + 3 * s + c + j], dx[slip_of(row, j)] = lost, slipping
    for j in range(c):
        f, lost, kept = 0.0, 0.0, branch.contact[j]
        if kept not in (OPEN, TOGETHER):
            one, two, low = row.left[j], row.right[j], row.lower[j]
            first, second, third = row.weight[j]
            d, v = _apart(row, j, 0, x) - row.gap[j], _apart(row, j, n, x)
            f, elastic = branch_force(row.element[j], kept, d, v, branch.approach[j])
            lost = (f - elastic) * v
            dx[n + one] -= first * f * row.per_mass[one]
            dx[n + two] -= second * f * row.per_mass[two]
            dx[n + low] -= third * f * row.per_mass[low]
        force[j], dx[3 * n + 3 * s + j] = f, lost
    if row.jumps:
        _hold_together(row, branch, dx, force)


@compiled
def rates_at_times(row, branch, ground, x, dx, force):
    """The same as `rates`, but not inlined: for calls outside the Runge-Kutta stages."""
    rates(row, branch, ground, x, dx, force)


@called_often
def pull(row, branch, j, x):
    """Force of link ``j`` [N], the power that it dissipates [W], and the rate of its slip [m/s]."""
    law = row.tie_law[j]
    stretch, rate = _between(row, j, 0, x), _between(row, j, row.mass.size, x)
    drag, held, slipping = _drag(row, branch, j, rate), 0.0, 0.0
    if law == BILINEAR:
        held = row.tie[j, COUPLE] * (stretch - x[slip_of(row, j)])
        slipping = rate if branch.tie[j] != 0 else 0.0
    elif law == SLACK and branch.tie[j] != 0:
        held = row.tie[j, COUPLE] * (stretch + row.tie[j, LIMIT])
    return row.tie[j, POST] * stretch + drag + held, drag * rate + held * slipping, slipping


@called_often
def _between(row, j, offset, x):
    """Difference of the displacements at both ends of link ``j`` [m], which is called its stretch.

    With ``offset`` 0 displacements are taken, with the offset of the velocities in the state the result
    is the rate of the stretch.
    """
    one, two = row.tied[j]
    return x[offset + one] - x[offset + two] if two >= 0 else x[offset + one]


@called_often
def _drag(row, branch, j, rate):
    """Dashpot force of link ``j`` [N]: ``c |v|^a sign(v)``, linear for ``|v|`` below `creep_of`."""
    c, a = row.tie[j, DASHPOT], row.tie[j, EXPONENT]
    if a == 1.0:
        return c * rate
    sign, slowest = branch.pace[j], creep_of(row, j)
    if sign == 0:
        return c * slowest ** (a - 1.0) * rate
    if sign * rate > slowest:
        return sign * c * (sign * rate) ** a
    # Beyond the end of this branch: the tangent, so that the force is smooth there.
    return sign * c * slowest**a * (1.0 + a * (sign * rate / slowest - 1.0))


@called_often
def _apart(row, j, offset, x):
    """Penetration of contact ``j`` plus its gap [m]; with the offset of the velocities, its rate."""
    one, two, low = x[offset + row.left[j]], x[offset + row.right[j]], x[offset + row.lower[j]]
    return row.weight[j, 0] * one + row.weight[j, 1] * two + row.weight[j, 2] * low


@compiled
def _hold_together(row, branch, dx, force):
    """Contact forces that give floors moving together one acceleration, added to the rates ``dx``.

    The forces along one level are the solution of a tridiagonal system.
    """
    n, c = row.mass.size, row.gap.size
    for j in range(c):  # elimination; ``force`` holds the right-hand sides over the pivots
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
    for j in range(c):  # set exactly equal, so that rounding does not separate the floors
        if branch.contact[j] == TOGETHER:
            dx[n + row.right[j]] = dx[n + row.left[j]]


@compiled
def linked(row, branch, j):
    """Whether the left floor of contact ``j`` also moves together with the floor to its own left."""
    return j > 0 and row.right[j - 1] == row.left[j] and branch.contact[j - 1] == TOGETHER


@compiled
def _pivot(row, branch, j):
    """Pivot of contact ``j`` in the elimination, from the first of the contacts that move together."""
    start = j
    while linked(row, branch, start):
        start -= 1
    pivot = 0.0
    for i in range(start, j + 1):
        one, two = row.mass[row.left[i]], row.mass[row.right[i]]
        coupling = 1.0 / (one * one * pivot) if i > start else 0.0
        pivot = 1.0 / one + 1.0 / two - coupling
    return pivot


@called_often
def measure(row, what, i, x):
    """A linear function of the state ``x`` that belongs to the storey, contact or link number ``i``.

    STRAIN is ``y`` of a storey and STRAIN_RATE the rate of its drift. PENETRATION is that of a contact
    plus the gap, CLOSING_RATE its rate, and MARGIN the quantity whose zero ends the contact
    (`separation_margin`) plus the gap. STRETCH is the stretch of a link less its slip, STRETCH_RATE the
    rate of the stretch. Applied to rates ``dx`` in place of ``x`` it gives time derivatives.
    """
    n = row.mass.size
    if what == STRAIN:
        below = x[row.below[i]] if row.below[i] >= 0 else 0.0
        return x[i] - below - x[2 * n + i]
    if what == STRAIN_RATE:
        below = x[n + row.below[i]] if row.below[i] >= 0 else 0.0
        return x[n + i] - below
    if what in (STRETCH, STRETCH_RATE):
        slip = x[slip_of(row, i)] if what == STRETCH else 0.0
        return _between(row, i, 0 if what == STRETCH else n, x) - slip
    if what == CLOSING_RATE:
        return _apart(row, i, n, x)
    apart = _apart(row, i, 0, x)
    if what == PENETRATION:
        return apart
    return separation_margin(row.element[i], apart, _apart(row, i, n, x))


@compiled
def start(row, branch, x):
    """Set the branches for the state ``x`` at the beginning of the motion.

    All springs are elastic. Floors that touch and do not move relative to each other move together if
    the contacts are stereomechanical.
    """
    n, _, c, _ = sizes(row)
    for i in range(n):
        if row.law[i] == BOUC_WEN:
            branch.storey[i] = 1
    for j in range(len(row.tied)):
        rate = measure(row, STRETCH_RATE, j, x)
        if row.tie[j, EXPONENT] != 1.0 and abs(rate) > creep_of(row, j):
            branch.pace[j] = 1 if rate > 0 else -1
    for j in range(c):
        d = measure(row, PENETRATION, j, x) - row.gap[j]
        if row.jumps and d >= 0 and measure(row, CLOSING_RATE, j, x) == 0:
            branch.contact[j] = TOGETHER
