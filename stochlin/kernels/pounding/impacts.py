"""Stereomechanical impacts of buildings in a row, and the table of all impacts.

Each impact has a line in the table, with these columns: time of its beginning [s], number of the
contact, approach velocity [m/s], largest force [N], time of its end [s], energy dissipated in the
contact before and after the impact [J], work of the impact on the structure on its right [J], elastic
energy of the contact element at its end [J], and largest penetration [m].
"""

import numpy as np

from stochlin.kernels.basics.compiled import compiled
from stochlin.kernels.pounding.contact import OPEN, TOGETHER, impact_loss, velocities_after_impact
from stochlin.kernels.pounding.rates import CLOSING_RATE, PENETRATION, linked, measure, rates_at_times
from stochlin.kernels.pounding.rows import sizes
from stochlin.kernels.pounding.steps import greatest

BEGIN, CONTACT, APPROACH, LARGEST, END, BEFORE, AFTER, HANDED, STORED, DEEPEST = range(10)
COLUMNS = 10
FIRST_LINES = 256  # initial length of the table
TOUCH = 1e-12  # distance at which floors touch, over the largest displacement
CALM = 1e-9  # approach velocity that is no impact, over the largest velocity
HOP = 1e-10  # rebound distance below which floors move together, over the largest displacement
MOST_BLOWS = 50  # largest number of impacts at one time; then all floors that touch move together


@compiled
def begin_entry(row, branch, j, velocity, time, x, table, used):
    """Begin a line of the table for an impact at contact ``j``; returns the number of lines in use."""
    lost = x[_account(row, j)]
    line = table[used]
    line[BEGIN], line[CONTACT], line[APPROACH], line[LARGEST] = time, j, velocity, -np.inf
    line[END], line[BEFORE], line[AFTER] = time, lost, lost
    line[HANDED] = line[STORED] = line[DEEPEST] = 0.0
    branch.entry[j] = used
    return used + 1


@compiled
def end_entry(row, branch, j, time, x, table):
    """Update the end of the present impact at contact ``j`` in its line of the table."""
    line = table[branch.entry[j]]
    line[END], line[AFTER] = time, x[_account(row, j)]
    if not row.jumps:
        d, n = measure(row, PENETRATION, j, x) - row.gap[j], row.element[j].exponent
        line[STORED] = row.element[j].stiffness * max(d, 0.0) ** (n + 1.0) / (n + 1.0)


@compiled
def _account(row, j):
    """Index of the energy dissipated in contact ``j`` in the state."""
    n, s, _, _ = sizes(row)
    return 3 * n + 3 * s + j


@compiled
def settle(row, branch, struck, ground, time, x, space, table, used):
    """Velocities and branches after a stereomechanical impact at contact ``struck``, or a separation.

    If its floors moved together, they separate. Otherwise eq. (13) is applied at all floors that touch,
    the fastest approach first, until none approach any more. A light floor between heavy ones needs very
    many such impacts; their number is limited by `MOST_BLOWS`. Floors that are pressed together so
    strongly that they would hardly rebound then move together, which ends chattering. Returns the number
    of lines of the table in use.
    """
    touch, calm = TOUCH * greatest(space.reach[0]), CALM * greatest(space.reach[1])
    if branch.contact[struck] == TOGETHER:
        _let_go(row, branch, struck, time, x, table)
        return used
    used, exhausted = _blows(row, branch, struck, touch, calm, time, x, table, used)
    for j in range(row.gap.size):
        if exhausted and branch.contact[j] == OPEN and _touches(row, branch, j, touch, x):
            if branch.entry[j] < 0:
                used = begin_entry(row, branch, j, 0.0, time, x, table, used)
            branch.contact[j] = TOGETHER
            _join(row, branch, j, x, table)
        if branch.contact[j] == TOGETHER:
            if measure(row, CLOSING_RATE, j, x) < -calm:
                _let_go(row, branch, j, time, x, table)
            else:
                _join(row, branch, j, x, table)
    for _ in range(row.gap.size):  # floors that now move together can press on the next one
        held = False
        for j in range(row.gap.size):
            if branch.contact[j] == OPEN and (j == struck or _touches(row, branch, j, touch, x)):
                used = _press(row, branch, j, ground, time, calm, x, space, table, used)
                held = held or branch.contact[j] == TOGETHER
        if not held:
            break
    return used


@compiled
def _blows(row, branch, struck, touch, calm, time, x, table, used):
    """Impacts by eq. (13), until no floors that touch approach each other, at most `MOST_BLOWS`.

    Returns the number of lines of the table in use, and whether the limit was reached.
    """
    for _ in range(MOST_BLOWS):
        which, fastest = -1, calm
        for j in range(row.gap.size):
            v = measure(row, CLOSING_RATE, j, x)
            if v > fastest and (j == struck or _touches(row, branch, j, touch, x)):
                which, fastest = j, v
        if which < 0:
            return used, False
        if branch.contact[which] == TOGETHER:
            _let_go(row, branch, which, time, x, table)
        used = begin_entry(row, branch, which, fastest, time, x, table, used)
        if row.restitution == 0.0:
            branch.contact[which] = TOGETHER
            _join(row, branch, which, x, table)
        else:
            table[branch.entry[which], HANDED] += _strike(row, which, row.restitution, x)
        end_entry(row, branch, which, time, x, table)
    return used, True


@compiled
def _press(row, branch, j, ground, time, calm, x, space, table, used):
    """Let the floors of contact ``j`` move together if they would rebound by less than `HOP`."""
    n = row.mass.size
    rates_at_times(row, branch, ground, x, space.rate, space.force)
    pressed = space.rate[n + row.left[j]] - space.rate[n + row.right[j]]
    v = measure(row, CLOSING_RATE, j, x)
    if pressed > 0.0 and v * v <= 2.0 * pressed * HOP * greatest(space.reach[0]):
        if branch.entry[j] < 0:
            used = begin_entry(row, branch, j, max(v, 0.0), time, x, table, used)
        branch.contact[j] = TOGETHER
        _join(row, branch, j, x, table)
    else:
        branch.entry[j] = -1
        if abs(v) <= calm:  # set the velocities equal, so that rounding causes no further impact
            _join(row, branch, j, x, table)
    return used


@compiled
def _touches(row, branch, j, touch, x):
    """Whether the floors of contact ``j`` move together or are at most ``touch`` [m] apart."""
    distance = measure(row, PENETRATION, j, x) - row.gap[j]
    return branch.contact[j] == TOGETHER or distance >= -touch


@compiled
def _let_go(row, branch, j, time, x, table):
    """Separate the floors of contact ``j`` and end its impact."""
    end_entry(row, branch, j, time, x, table)
    branch.contact[j] = OPEN
    branch.entry[j] = -1


@compiled
def _strike(row, j, e, x):
    """Apply one impact, eq. (13), to the velocities; returns its work on the right structure [J]."""
    n, one, two = row.mass.size, row.left[j], row.right[j]
    v1, v2, mass_1, mass_2 = x[n + one], x[n + two], row.mass[one], row.mass[two]
    x[n + one], x[n + two] = velocities_after_impact(v1, v2, mass_1, mass_2, e)
    x[_account(row, j)] += impact_loss(mass_1, mass_2, e) * (v1 - v2) * (v1 - v2)
    return 0.5 * mass_2 * (x[n + two] - v2) * (x[n + two] + v2)


@compiled
def _join(row, branch, j, x, table):
    """Give all floors that move together with those of contact ``j`` one velocity; momentum is kept."""
    n, c = row.mass.size, row.gap.size
    start, stop = j, j + 1
    while linked(row, branch, start):
        start -= 1
    while stop < c and linked(row, branch, stop) and branch.contact[stop] == TOGETHER:
        stop += 1
    mass = row.mass[row.left[start]]
    momentum = mass * x[n + row.left[start]]
    energy = momentum * x[n + row.left[start]]
    for i in range(start, stop):
        other = row.right[i]
        mass += row.mass[other]
        momentum += row.mass[other] * x[n + other]
        energy += row.mass[other] * x[n + other] ** 2
    common = momentum / mass
    x[_account(row, j)] += max(0.5 * (energy - momentum * common), 0.0)
    impulse = row.mass[row.left[start]] * (x[n + row.left[start]] - common)
    x[n + row.left[start]] = common
    for i in range(start, stop):
        other = row.right[i]
        if branch.entry[i] >= 0:
            table[branch.entry[i], HANDED] += 0.5 * impulse * (x[n + other] + common)
        impulse -= row.mass[other] * (common - x[n + other])
        x[n + other] = common
