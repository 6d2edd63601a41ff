"""Events of buildings in a row: the first end of a branch within a time step, and the branch after it.

The events are: a storey or link yields or unloads; a link with slack becomes taut or loose; a dashpot
with an exponent changes between its linear range and its power law; a contact begins, changes from
closing to opening, or ends. Each is the time at which a linear function of the state (a `measure`)
leaves an interval. Two floors that move together separate when the force between them becomes zero.
"""

import numpy as np

from stochlin.kernels.basics.compiled import called_often, compiled
from stochlin.kernels.basics.linear_branch import evaluate, first_exit
from stochlin.kernels.pounding.contact import CLOSED, OPEN, OPENING, PARTED, TOGETHER
from stochlin.kernels.pounding.impacts import (
    DEEPEST,
    END,
    HANDED,
    LARGEST,
    begin_entry,
    end_entry,
    settle,
)
from stochlin.kernels.pounding.rates import (
    CLOSING_RATE,
    MARGIN,
    PENETRATION,
    STRAIN,
    STRAIN_RATE,
    STRETCH,
    STRETCH_RATE,
    measure,
    pull,
)
from stochlin.kernels.pounding.rows import (
    BILINEAR,
    BOUC_WEN,
    ELASTIC,
    EXPONENT,
    LIMIT,
    SLACK,
    creep_of,
    sizes,
)
from stochlin.kernels.pounding.steps import (
    NODES,
    STAGES,
    component_polynomial,
    depth_within,
    find_node_forces,
    force_polynomial,
    greatest,
    interpolate,
    polynomial,
    work_within,
)

NOTHING = -1  # in place of the number of an event or measure: none
INFINITE = np.inf
THIRDS = 16  # steps of the search for a peak, whose relative error is then about (2/3)^32
GRAIN = 1e-11  # rounding error of the interpolating polynomials, over the largest displacement


@called_often
def watched(row, branch, number):
    """Condition of the event with this number on the present branches.

    Returns a `measure` (NOTHING if there is no such event), the number of the storey, contact or link,
    and the shift and both ends of the interval: the event is the exit of the measure less the shift
    from the interval. Numbers 0 to ``2 n - 1`` are two conditions of each storey, the next ``2 c`` two
    of each contact, the next ``l`` those of the springs of links and the last ``l`` those of their
    dashpots. The force between floors that move together has no number here.
    """
    n, _, c, _ = sizes(row)
    if number < 2 * n:
        return _watched_storey(row, branch, number % n, number < n)
    if number >= 2 * (n + c):
        j, ties = number - 2 * (n + c), len(row.tied)
        return _watched_link(row, branch, j) if j < ties else _watched_dashpot(row, branch, j - ties)
    j = (number - 2 * n) % c
    return _watched_contact(row, branch, j, number < 2 * n + c)


@called_often
def _watched_storey(row, branch, i, first):
    """The first or the second condition of storey ``i``, as `watched` returns it."""
    law, sign, limit = row.law[i], branch.storey[i], row.strength[i]
    watch = NOTHING, i, 0.0, 0.0, 0.0
    if first and law == BILINEAR and sign == 0:
        watch = STRAIN, i, 0.0, -limit, limit
    elif first and law != ELASTIC:
        watch = _keeps_sign(STRAIN_RATE, i, 0.0, sign)
    elif law == BOUC_WEN:
        watch = _keeps_sign(STRAIN, i, 0.0, branch.side[i])
    return watch


@called_often
def _watched_contact(row, branch, j, first):
    """The first or the second condition of contact ``j``, as `watched` returns it."""
    kept, gap = branch.contact[j], row.gap[j]
    watch = NOTHING, j, 0.0, 0.0, 0.0
    if first and kept == OPEN:
        watch = _keeps_sign(PENETRATION, j, gap, -1)
    elif first and kept != TOGETHER:
        watch = _keeps_sign(MARGIN if kept == CLOSED else PENETRATION, j, gap, 1)
    elif kept == PARTED:
        watch = _keeps_sign(MARGIN, j, gap, -1)
    elif kept == OPENING:
        watch = _keeps_sign(CLOSING_RATE, j, 0.0, -1)
    elif kept == CLOSED and row.element[j].approach_only:
        watch = _keeps_sign(CLOSING_RATE, j, 0.0, 1)
    return watch


@called_often
def _watched_link(row, branch, j):
    """The condition of the spring of link ``j``, as `watched` returns it."""
    law, sign, limit = row.tie_law[j], branch.tie[j], row.tie[j, LIMIT]
    watch = NOTHING, j, 0.0, 0.0, 0.0
    if law == SLACK:
        watch = _keeps_sign(STRETCH, j, -limit, 1 - 2 * sign)
    elif law == BILINEAR and sign == 0:
        watch = STRETCH, j, 0.0, -limit, limit
    elif law == BILINEAR:
        watch = _keeps_sign(STRETCH_RATE, j, 0.0, sign)
    return watch


@called_often
def _watched_dashpot(row, branch, j):
    """The condition of the dashpot of link ``j``, as `watched` returns it."""
    sign, slowest = branch.pace[j], creep_of(row, j)
    if row.tie[j, EXPONENT] == 1.0:
        return NOTHING, j, 0.0, 0.0, 0.0
    if sign == 0:
        return STRETCH_RATE, j, 0.0, -slowest, slowest
    return _keeps_sign(STRETCH_RATE, j, sign * slowest, sign)


@called_often
def _keeps_sign(what, i, shift, sign):
    """The condition that the measure ``what`` less ``shift`` keeps the given sign."""
    return what, i, shift, 0.0 if sign > 0 else -INFINITE, INFINITE if sign > 0 else 0.0


@compiled
def _in_contact(branch):
    """Whether any contact is not open."""
    for kept in branch.contact:  # noqa: SIM110  a generator would allocate memory
        if kept != OPEN:
            return True
    return False


@compiled
def _storeys_stay(row, branch, h, x, space):
    """Whether no storey can end its branch within the step.

    This is the estimate of `first_event` by values and rates at both ends, for all storeys at once.
    False for Bouc-Wen storeys.
    """
    n, new, begin, end = row.mass.size, space.new, space.stages[0], space.stages[STAGES]
    for i in range(n):
        law, below = row.law[i], row.below[i]
        if law == ELASTIC:
            continue
        if law == BOUC_WEN:
            return False
        if branch.storey[i] == 0:
            y, y1, r, r1 = x[i] - x[2 * n + i], new[i] - new[2 * n + i], x[n + i], new[n + i]
            if below >= 0:
                y, y1, r, r1 = y - x[below], y1 - new[below], r - x[n + below], r1 - new[n + below]
            margin = row.strength[i] - max(abs(y), abs(y1))
        else:
            y, y1, r, r1 = x[n + i], new[n + i], begin[n + i], end[n + i]
            if below >= 0:
                y, y1 = y - x[n + below], y1 - new[n + below]
                r, r1 = r - begin[n + below], r1 - end[n + below]
            margin = min(branch.storey[i] * y, branch.storey[i] * y1)
        if h * max(abs(r), abs(r1)) > margin:
            return False
    return True


@compiled
def _contacts_stay(row, branch, h, x, space):
    """Whether all contacts are open and stay so within the step, by the same estimate."""
    new, begin, end = space.new, space.stages[0], space.stages[STAGES]
    for j in range(row.gap.size):
        if branch.contact[j] != OPEN:
            return False
        one, two, low = row.left[j], row.right[j], row.lower[j]
        first, second, third = row.weight[j]
        d = first * x[one] + second * x[two] + third * x[low]
        d1 = first * new[one] + second * new[two] + third * new[low]
        r = first * begin[one] + second * begin[two] + third * begin[low]
        r1 = first * end[one] + second * end[two] + third * end[low]
        if max(d, d1) - row.gap[j] + h * max(abs(r), abs(r1)) > 0.0:
            return False
    return True


@compiled
def first_event(row, branch, ground, slope, h, x, space):
    """First event within an accepted step.

    Returns its time as a share of the step (1 if there is none), its number, the side by which the
    measure leaves its interval (1 or -1), and whether the interpolating polynomials of the step have
    been computed. While any contact is not open they always are, together with the forces at the nodes.
    """
    n, _, c, _ = sizes(row)
    total = 2 * (n + c + len(row.tied))
    best, event, way, known = 1.0, NOTHING, 0, False
    if _in_contact(branch):
        interpolate(row, branch, ground, slope, h, x, space)
        find_node_forces(row, branch, ground, slope, h, x, space)
        known = True
    begins = 2 * n if _storeys_stay(row, branch, h, x, space) else 0
    open_on = 2 * (n + c) if _contacts_stay(row, branch, h, x, space) else 2 * n
    for number in range(begins, total):
        if 2 * n <= number < open_on:
            continue
        what, i, shift, lower, upper = watched(row, branch, number)
        if what == NOTHING:
            continue
        begin, end = measure(row, what, i, x) - shift, measure(row, what, i, space.new) - shift
        grain = GRAIN * greatest(space.reach[0])
        # Floors that touch at the beginning may be about to separate.
        if what == PENETRATION and upper == 0.0 and begin > -grain:
            upper = max(begin, 0.0) + grain
        rate = measure(row, what, i, space.stages[0])
        last_rate = measure(row, what, i, space.stages[STAGES])
        # Within a step a function changes by less than its larger rate at the two ends times ``h``.
        stray = h * max(abs(rate), abs(last_rate))
        if max(begin, end) + stray <= upper and min(begin, end) - stray >= lower:
            continue
        if not known:
            interpolate(row, branch, ground, slope, h, x, space)
            known = True
        polynomial(row, what, i, shift, x, space)
        t, side = first_exit(space.line, lower, upper, best, space.lines, space.marks)
        if side != 0 and (t < best or event == NOTHING):
            best, event, way = t, number, side
    for j in range(c):
        if branch.contact[j] == TOGETHER:
            force_polynomial(j, space)
            t, side = first_exit(space.line, 0.0, INFINITE, best, space.lines, space.marks)
            if side != 0 and (t < best or event == NOTHING):
                best, event, way = t, total + j, side
    return best, event, way, known


@compiled
def pass_event(row, branch, event, way, ground, time, x, space, table, used):
    """Change the branch at an event with this number; returns the number of table lines in use.

    Numbers are those of `first_event`. ``way`` is the side by which the measure left its interval. The
    table needs room for `MOST_BLOWS` further lines, and two for each contact.
    """
    n, _, c, _ = sizes(row)
    if event < 2 * n:
        if event >= n:
            branch.side[event - n] = -branch.side[event - n]
        elif row.law[event] == BOUC_WEN:
            branch.storey[event] = -branch.storey[event]
        else:
            branch.storey[event] = way if branch.storey[event] == 0 else 0
        return used
    ties = len(row.tied)
    if 2 * (n + c) <= event < 2 * (n + c + ties):
        j = event - 2 * (n + c)
        if j >= ties:
            branch.pace[j - ties] = way if branch.pace[j - ties] == 0 else 0
        elif row.tie_law[j] == SLACK:
            branch.tie[j] = 1 - branch.tie[j]
        else:
            branch.tie[j] = way if branch.tie[j] == 0 else 0
        return used
    j = (event - 2 * n) % c if event < 2 * (n + c) else event - 2 * (n + c + ties)
    if row.jumps:
        return settle(row, branch, j, ground, time, x, space, table, used)
    if branch.contact[j] == OPEN:
        v = measure(row, CLOSING_RATE, j, x)
        branch.contact[j] = CLOSED
        branch.approach[j] = v if v > row.slow else 0.0
        return begin_entry(row, branch, j, v, time, x, table, used)
    if event < 2 * n + c:
        _end_contact(row, branch, j, time, x, table)
    else:
        branch.contact[j] = OPENING if branch.contact[j] == CLOSED else CLOSED
    return used


@compiled
def _end_contact(row, branch, j, time, x, table):
    """Open contact ``j``, or set it to PARTED if its force is zero but the element is compressed."""
    parted = branch.contact[j] == PARTED
    end_entry(row, branch, j, table[branch.entry[j], END] if parted else time, x, table)
    pulls = row.element[j].tension or row.element[j].approach_only
    if not pulls and not parted and measure(row, PENETRATION, j, x) > row.gap[j]:
        branch.contact[j] = PARTED
    else:
        branch.contact[j] = OPEN
        branch.entry[j] = -1


@compiled
def watch_forces(branch, end, h, space, table, most):
    """Update forces, penetrations and work of impacts in the table by a step up to its share ``end``.

    While any contact is not open, the largest accelerations ``most`` (n,) are also updated, at the
    nodes.
    """
    for q in range(int(end * (NODES - 1)) + 1 if _in_contact(branch) else 0):
        for i in range(most.size):
            most[i] = max(most[i], abs(space.shaken[q, i]))
    for j in range(branch.contact.size):
        line = branch.entry[j]
        if line < 0 or branch.contact[j] in (OPEN, PARTED):
            continue
        here, last = 0, int(end * (NODES - 1))
        for q in range(1, last + 1):
            if space.nodes[q, j] > space.nodes[here, j]:
                here = q
        largest = max(table[line, LARGEST], space.nodes[here, j])
        force_polynomial(j, space)
        low, high = max(here - 1, 0) / (NODES - 1), min((here + 1) / (NODES - 1), end)
        for _ in range(THIRDS):  # ternary search for the peak of the polynomial
            third = (high - low) / 3.0
            one, two = evaluate(space.line, low + third)[0], evaluate(space.line, high - third)[0]
            if one < two:
                low += third
            else:
                high -= third
            largest = max(largest, one, two)
        table[line, LARGEST] = largest
        table[line, HANDED] += h * work_within(j, end, space)
        deepest = max(table[line, DEEPEST], depth_within(j, end, space))
        for q in range(last + 1):
            deepest = max(deepest, space.depths[q, j])
        table[line, DEEPEST] = deepest


@compiled
def watch_peaks(row, end, h, x, after, space, peaks, look):
    """Update the highest and lowest displacements ``peaks`` (2, n) by a step from ``x`` to ``after``.

    Returns whether a peak inside the step may be larger than those at its ends. If so, and if ``look``
    is true, the peak is found by the interpolating polynomials, which have to be computed before.
    """
    n, needed = row.mass.size, False
    for i in range(n):
        for side in range(2):
            sign = 1.0 - 2.0 * side
            u, v, u1, v1 = sign * x[i], sign * x[n + i], sign * after[i], sign * after[n + i]
            best = max(sign * peaks[side, i], u1)
            if v > 0.0 > v1 and max(u, u1) + 0.5 * h * max(v, -v1) > best:
                needed = True
                if look:
                    component_polynomial(n + i, sign, x, space)
                    t, _ = first_exit(space.line, 0.0, INFINITE, end, space.lines, space.marks)
                    component_polynomial(i, sign, x, space)
                    best = max(best, evaluate(space.line, t)[0])
            peaks[side, i] = sign * best
    return needed


@called_often
def watch_state(row, branch, ground, x, dx, most):
    """Update largest accelerations, storey shears and link forces by a state and its rates ``dx``."""
    n = row.mass.size
    for i in range(n):
        below = x[row.below[i]] if row.below[i] >= 0 else 0.0
        drift = x[i] - below
        shear = row.post[i] * drift + row.couple[i] * (drift - x[2 * n + i])
        most.shear[i] = max(most.shear[i], abs(shear))
        most.acceleration[i] = max(most.acceleration[i], abs(dx[n + i] + ground))
    for j in range(len(row.tied)):
        most.pull[j] = max(most.pull[j], abs(pull(row, branch, j, x)[0]))
