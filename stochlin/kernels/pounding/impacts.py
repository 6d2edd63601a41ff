"""Impacts in the lanes near contact: their table, and stereomechanical blows.

A contact has an impact from the time at which the penetration becomes positive until it is negative
again. A stereomechanical blow multiplies the rate of penetration by ``-e`` at the time of touch, eq.
(13). A rebound that would last less than `REST` time steps ends in rest: both sides then move together,
as one impact, until they are pulled apart.
"""

from __future__ import annotations

import numpy as np

from stochlin.kernels.basics.compiled import called_often, compiled
from stochlin.kernels.simulation.contacts import force as force_at
from stochlin.kernels.simulation.contacts import mean_force, separation_margin, stored_in
from stochlin.kernels.simulation.laws import VISCOUS
from stochlin.kernels.simulation.time_step import KIND

LANE, CONTACT, BEGIN, APPROACH, LARGEST, END, LOST, HANDED, STORED, DEEPEST = range(10)
COLUMNS = 10
FIRST_LINES = 256  # initial length of the table
REST = 2.0  # time steps that a rebound takes at least
CALM = 1e-12  # rate of penetration that may be rounding, over the largest velocity
MOST_BLOWS = 200  # of all contacts after one time step; then all sides that still approach rest


@called_often
def row_product(column, weight, i, x, of, lane):
    """Row ``i`` of `Rows` times the rows of ``x`` from ``of`` on, in one lane."""
    total = 0.0
    for place in range(column.shape[1]):
        total += weight[i, place] * x[of + column[i, place], lane]
    return total


@compiled
def twice_as_long(table):
    """A table with the same lines, followed by as many without values."""
    longer = np.empty((2 * len(table), table.shape[1]))
    for line in range(len(table)):
        for column in range(table.shape[1]):
            longer[line, column] = table[line, column]
    return longer


@compiled
def _begin_impact(j, time, speed, largest, to, x, lane):
    """Begin an impact of contact ``j``."""
    x[to.begin + j, lane] = x[to.end + j, lane] = time
    x[to.speed + j, lane], x[to.largest + j, lane] = speed, largest
    x[to.last + j, lane], x[to.rise + j, lane], x[to.span + j, lane] = largest, 0.0, 0.0
    x[to.before + j, lane] = x[to.lost + j, lane]
    x[to.handed + j, lane] = x[to.deepest + j, lane] = 0.0


@compiled
def end_impact(j, number, stored, to, x, lane, table, used):
    """End the impact of contact ``j`` and write its line; returns the table and its lines in use.

    ``number`` is that of the motion in this lane.
    """
    if used == len(table):
        table = twice_as_long(table)
    line = table[used]
    line[LANE], line[CONTACT], line[BEGIN] = number, j, x[to.begin + j, lane]
    line[APPROACH], line[LARGEST] = x[to.speed + j, lane], x[to.largest + j, lane]
    line[END], line[LOST] = x[to.end + j, lane], x[to.lost + j, lane] - x[to.before + j, lane]
    line[HANDED], line[STORED] = x[to.handed + j, lane], stored
    line[DEEPEST] = x[to.deepest + j, lane]
    x[to.begin + j, lane] = np.nan
    return table, used + 1


@called_often
def _watch_force(j, now, span, to, x, lane):
    """Update the largest force by that at the end of a step, ``span`` [s] after the one before.

    Between steps the force is a parabola through three of its values.
    """
    rise, largest = (now - x[to.last + j, lane]) / span, now
    if x[to.rise + j, lane] > 0.0 > rise:
        before = x[to.span + j, lane]
        bend = (rise - x[to.rise + j, lane]) / (before + span)
        slope = rise - bend * span
        # Between equal steps it rises by an eighth of the larger difference at most.
        rises = min(
            -0.25 * slope * slope / bend, 0.125 * max(x[to.rise + j, lane] * before, -rise * span)
        )
        largest = x[to.last + j, lane] + rises
    x[to.largest + j, lane] = max(x[to.largest + j, lane], largest)
    x[to.last + j, lane], x[to.rise + j, lane], x[to.span + j, lane] = now, rise, span


@compiled
def watch_contact(contacts, j, dt, time, number, at, to, x, lane, table, used):
    """Update the impact of an element ``j`` by a time step that began at ``time`` [s].

    Returns the table of impacts and the number of its lines in use.
    """
    (column, weight), (right, share), law = contacts.rows, contacts.right, contacts.law[j]
    change = row_product(column, weight, j, x, at.dq, lane)
    before, force = x[at.depth + j, lane], x[at.force + j, lane]
    after, speed = before + change, x[at.approach + j, lane]
    if before <= 0.0 and after <= 0.0:
        return table, used
    if np.isnan(x[to.begin + j, lane]):
        touch = time + (dt * -before / change if before < 0.0 else 0.0)
        at_once = law.damping * speed if law.damping_exponent == 0.0 and not law.over_approach else 0.0
        _begin_impact(j, touch, speed, at_once, to, x, lane)
    v0 = speed if speed > x[at.slow, lane] else 0.0
    total, elastic = mean_force(law, v0, before, change, dt)
    x[to.lost + j, lane] += (total - elastic) * change
    x[to.handed + j, lane] -= force * row_product(right, share, j, x, at.dq, lane)
    rate = x[at.rate + j, lane]
    now = force_at(law, after, 2.0 * change / dt - rate, v0)
    _watch_force(j, now, dt * min(1.0, after / change) if before < 0.0 else dt, to, x, lane)
    fall = 2.0 * (rate - change / dt)  # of the rate in the step
    turn = before + 0.5 * dt * rate * rate / fall if rate > 0.0 and rate < fall else after
    x[to.deepest + j, lane] = max(x[to.deepest + j, lane], after, turn)
    if total != 0.0:
        margin = separation_margin(law, before, change / dt)
        left = separation_margin(law, after, change / dt)
        x[to.end + j, lane] = time + dt * (margin / (margin - left) if left < 0.0 < margin else 1.0)
    if after <= 0.0:
        table, used = end_impact(j, number, 0.0, to, x, lane, table, used)
    return table, used


@compiled
def strike(steps, parts, time, number, at, to, x, lane, table, used):
    """Stereomechanical blows after a time step that began at ``time`` [s], until no sides approach.

    Returns the table of impacts and the number of its lines in use.
    """
    contacts, mass, dt = steps.contacts, parts.mass, steps.dt
    for k in range(mass.size):
        x[to.gain + k, lane] = 2.0 * (x[at.v + k, lane] - x[at.dq + k, lane] / dt) / dt
    for j in range(contacts.gap.size):
        if x[at.held + j, lane] != 0.0:
            x[to.end + j, lane] = time + dt
            (column, weight), (right, share) = contacts.rows, contacts.right
            force = x[at.force + j, lane]
            x[to.handed + j, lane] -= force * row_product(right, share, j, x, at.dq, lane)
            x[to.lost + j, lane] += force * row_product(column, weight, j, x, at.dq, lane)
            if force == 0.0 and row_product(column, weight, j, x, at.v, lane) < 0.0:
                x[at.held + j, lane] = 0.0
                table, used = end_impact(j, number, 0.0, to, x, lane, table, used)
    calm = 0.0
    for k in range(mass.size):
        calm = max(calm, CALM * abs(x[at.v + k, lane]))
    for blow in range(MOST_BLOWS):
        struck, fastest, pressed = -1, calm, 0.0
        for j in range(contacts.gap.size):
            column, weight = contacts.rows
            rate = row_product(column, weight, j, x, at.v, lane)
            depth = row_product(column, weight, j, x, at.q, lane) - contacts.gap[j]
            if depth < 0.0:
                continue
            gain = row_product(column, weight, j, x, to.gain, lane)
            pressed = max(pressed, gain + x[at.force + j, lane] * _mobility(contacts, mass, j))
            # Sides that are held have no rate but for a neighbour's blow, and the rounding of the step.
            if rate > fastest and (blow > 0 or x[at.held + j, lane] == 0.0):
                struck, fastest = j, rate
        if struck < 0:
            break
        if blow > MOST_BLOWS // 2:
            pressed = np.inf
        table, used = _blow(
            steps, parts, struck, fastest, pressed, time, number, at, to, x, lane, table, used
        )
    return table, used


@called_often
def _mobility(contacts, mass, j):
    """Change of the rate of penetration of contact ``j`` by a unit impulse [1/kg]."""
    total, (column, weight) = 0.0, contacts.rows
    for place in range(column.shape[1]):
        total += weight[j, place] ** 2 / mass[column[j, place]]
    return total


@compiled
def _blow(steps, parts, j, rate, pressed, time, number, at, to, x, lane, table, used):
    """One blow of contact ``j``, with this rate of penetration at the end of the step.

    It takes place at the time of touch, from which velocities and displacements follow at the end of
    the step. ``pressed`` is the largest acceleration with which sides that touch are pressed together:
    a neighbour that is pressed against both ends a rebound too. Returns the table of impacts and the
    number of its lines in use.
    """
    contacts, mass, dt = steps.contacts, parts.mass, steps.dt
    (column, weight), (right, share) = contacts.rows, contacts.right
    depth = row_product(column, weight, j, x, at.q, lane) - contacts.gap[j]
    since, mobility = 0.0, _mobility(contacts, mass, j)
    gain = row_product(column, weight, j, x, to.gain, lane)
    at_touch = np.sqrt(max(rate * rate - 2.0 * gain * depth, 0.0))
    if at_touch > 0.0:  # the penetration is a parabola
        since = min(2.0 * depth / (rate + at_touch), dt)
        rate -= since * gain
    e = contacts.restitution
    if 2.0 * e * rate < REST * dt * pressed:
        e = 0.0
    impulse = (1.0 + e) * rate / mobility
    if x[at.held + j, lane] == 0.0:
        _begin_impact(j, time + dt - since, rate, np.nan, to, x, lane)
    moved = row_product(right, share, j, x, at.v, lane)
    sped = row_product(right, share, j, x, to.gain, lane)
    _watch_touch(steps, since, at, to, x, lane)
    for k in range(mass.size):
        x[to.way + k, lane] = 0.0
    for place in range(column.shape[1]):
        k = column[j, place]
        jump = -weight[j, place] * impulse / mass[k]
        x[at.v + k, lane] += jump
        x[to.way + k, lane] = jump * since
    moved = 0.5 * (moved + row_product(right, share, j, x, at.v, lane)) - since * sped
    _displace(steps, parts, at, to, x, lane)
    x[to.handed + j, lane] -= impulse * moved
    x[to.lost + j, lane] += 0.5 * (1.0 - e) * (1.0 + e) * rate * rate / mobility
    x[at.held + j, lane] = 1.0 if e == 0.0 else 0.0
    if e != 0.0:
        table, used = end_impact(j, number, 0.0, to, x, lane, table, used)
    return table, used


@compiled
def _watch_touch(steps, since, at, to, x, lane):
    """Update the largest and smallest displacements by those at a blow, ``since`` [s] before the end."""
    column, weight = steps.shapes
    for i in range(column.shape[0]):
        end = row_product(column, weight, i, x, at.q, lane)
        touch = end - since * row_product(column, weight, i, x, at.v, lane)
        x[to.highest + i, lane] = max(x[to.highest + i, lane], touch)
        x[to.lowest + i, lane] = min(x[to.lowest + i, lane], touch)


@compiled
def _displace(steps, parts, at, to, x, lane):
    """Displace the coordinates after a blow within the step, and the springs with them.

    The works on this way are those of the forces at the end of the step.
    """
    column, weight = steps.extensions
    for i in range(column.shape[0]):
        if steps.info[i, KIND] == VISCOUS:
            continue
        x[at.z + i, lane] += row_product(column, weight, i, x, to.way, lane)
    for k in range(parts.mass.size):
        moved, structure = x[to.way + k, lane], parts.structure[k]
        if moved != 0.0:
            x[at.q + k, lane] += moved
            x[to.entering + structure, lane] += parts.mass[k] * x[at.f, lane] * moved
            drag = 0.0
            for m in range(parts.mass.size):
                drag += parts.damping[k, m] * x[at.v + m, lane]
            x[to.viscous + structure, lane] += drag * moved


@compiled
def end_all(contacts, number, at, to, x, lane, table, used):
    """End the impacts that go on at the end of the motion."""
    for j in range(contacts.gap.size):
        if not np.isnan(x[to.begin + j, lane]):
            stored = 0.0
            if not contacts.jumps:
                column, weight = contacts.rows
                depth = row_product(column, weight, j, x, at.q, lane) - contacts.gap[j]
                stored = stored_in(contacts.law[j], depth)
            table, used = end_impact(j, number, stored, to, x, lane, table, used)
    return table, used
