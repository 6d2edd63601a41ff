"""Impacts in the lanes near contact: their table, and stereomechanical blows.

A contact has an impact from the time at which the penetration becomes positive until it is negative
again. A stereomechanical blow multiplies the rate of penetration by ``-e`` at the time of touch, eq.
(13). A rebound that would last less than `REST` time steps ends in rest: both sides then move together,
as one impact, until they are pulled apart.
"""

from __future__ import annotations

import numpy as np

from stochlin.kernels.basics.compiled import called_often, compiled
from stochlin.kernels.simulation.account import ENTERING, HIGHEST, LOWEST, VISCOUS_LOSS
from stochlin.kernels.simulation.contacts import force as force_at
from stochlin.kernels.simulation.contacts import mean_force, separation_margin, stored_in
from stochlin.kernels.simulation.laws import VISCOUS
from stochlin.kernels.simulation.time_step import (
    DEPTH,
    DISSIPATED,
    DQ,
    FORCE,
    GAIN,
    HELD,
    RATE,
    SLOW,
    SPEED,
    WAY,
    F,
    Q,
    V,
    Z,
)

# Columns of the table of impacts, and of the present impact of each contact (c, columns, lanes), whose
# begin is NaN if there is none. Of this the force at the end of the last step is known too, with the
# rate at which it rose in that step, and the duration of contact in it.
LANE, CONTACT, BEGIN, APPROACH, LARGEST, END, LOST, HANDED, STORED, DEEPEST = range(10)
COLUMNS = 10
LAST, RISE, SPAN = range(10, 13)
FIRST_LINES = 256  # initial length of the table
REST = 2.0  # time steps that a rebound takes at least
CALM = 1e-12  # rate of penetration that may be rounding, over the largest velocity
MOST_BLOWS = 200  # of all contacts after one time step; then all sides that still approach rest


@called_often
def row_product(column, weight, i, values, of, lane):
    """Row ``i`` of `Rows` times a column of the values, in one lane."""
    total = 0.0
    for place in range(column.shape[1]):
        total += weight[i, place] * values[column[i, place], of, lane]
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
def _begin_impact(impact, time, speed, largest, lane):
    """Begin the impact of a contact."""
    for column in range(BEGIN, impact.shape[0]):
        impact[column, lane] = 0.0
    impact[BEGIN, lane] = impact[END, lane] = time
    impact[APPROACH, lane], impact[LARGEST, lane], impact[LAST, lane] = speed, largest, largest


@compiled
def end_impact(j, number, stored, impact, lane, table, used):
    """End the impact of contact ``j`` and write its line; returns the table and its lines in use.

    ``number`` is that of the motion in this lane.
    """
    if used == len(table):
        table = twice_as_long(table)
    line = table[used]
    for column in range(BEGIN, COLUMNS):
        line[column] = impact[column, lane]
    line[LANE], line[CONTACT], line[STORED] = number, j, stored
    impact[BEGIN, lane] = np.nan
    return table, used + 1


@called_often
def _watch_force(impact, now, span, lane):
    """Update the largest force by that at the end of a step, ``span`` [s] after the one before.

    Between steps the force is a parabola through three of its values.
    """
    last, rose, before = impact[LAST, lane], impact[RISE, lane], impact[SPAN, lane]
    rise, largest = (now - last) / span, now
    if rose > 0.0 > rise:
        bend = (rise - rose) / (before + span)
        slope = rise - bend * span
        # Between equal steps it rises by an eighth of the larger difference at most.
        largest = last + min(-0.25 * slope * slope / bend, 0.125 * max(rose * before, -rise * span))
    impact[LARGEST, lane] = max(impact[LARGEST, lane], largest)
    impact[LAST, lane], impact[RISE, lane], impact[SPAN, lane] = now, rise, span


@compiled
def watch_contact(steps, j, time, number, motions, lane, table, used):
    """Update the impact of an element ``j`` by a time step that began at ``time`` [s].

    ``number`` is that of the motion in this lane. Returns the table of impacts and the number of its
    lines in use.
    """
    contacts, dt, impact = steps.contacts, steps.dt, motions.impacts[j]
    (column, weight), (right, share), law = contacts.rows, contacts.right, contacts.law[j]
    coordinates, contact = motions.moving.coordinates, motions.moving.contacts[j]
    change = row_product(column, weight, j, coordinates, DQ, lane)
    before, force, speed = contact[DEPTH, lane], contact[FORCE, lane], contact[SPEED, lane]
    after = before + change
    if before <= 0.0 and after <= 0.0:
        return table, used
    if np.isnan(impact[BEGIN, lane]):
        touch = time + (dt * -before / change if before < 0.0 else 0.0)
        at_once = law.damping * speed if law.damping_exponent == 0.0 and not law.over_approach else 0.0
        _begin_impact(impact, touch, speed, at_once, lane)
    v0 = speed if speed > motions.moving.motions[SLOW, lane] else 0.0
    total, elastic = mean_force(law, v0, before, change, dt)
    _lose(contact, impact, (total - elastic) * change, lane)
    impact[HANDED, lane] -= force * row_product(right, share, j, coordinates, DQ, lane)
    rate = contact[RATE, lane]
    now = force_at(law, after, 2.0 * change / dt - rate, v0)
    _watch_force(impact, now, dt * min(1.0, after / change) if before < 0.0 else dt, lane)
    fall = 2.0 * (rate - change / dt)  # of the rate in the step
    turn = before + 0.5 * dt * rate * rate / fall if rate > 0.0 and rate < fall else after
    impact[DEEPEST, lane] = max(impact[DEEPEST, lane], after, turn)
    if total != 0.0:
        margin = separation_margin(law, before, change / dt)
        left = separation_margin(law, after, change / dt)
        impact[END, lane] = time + dt * (margin / (margin - left) if left < 0.0 < margin else 1.0)
    if after <= 0.0:
        table, used = end_impact(j, number, 0.0, impact, lane, table, used)
    return table, used


@called_often
def _lose(contact, impact, energy, lane):
    """Add an energy to what the contact and its present impact have dissipated."""
    contact[DISSIPATED, lane] += energy
    impact[LOST, lane] += energy


@called_often
def strike(steps, parts, time, number, motions, lane, table, used):
    """Stereomechanical blows after a time step that began at ``time`` [s], until no sides approach.

    Returns the table of impacts and the number of its lines in use.
    """
    contacts, mass, dt, (moving, account, impacts) = steps.contacts, parts.mass, steps.dt, motions
    (column, weight), (right, share), coordinates = contacts.rows, contacts.right, moving.coordinates
    for k in range(mass.size):
        change = coordinates[k, V, lane] - coordinates[k, DQ, lane] / dt
        coordinates[k, GAIN, lane] = 2.0 * change / dt
    for j in range(contacts.gap.size):
        contact, impact = moving.contacts[j], impacts[j]
        if contact[HELD, lane] != 0.0:
            impact[END, lane] = time + dt
            force = contact[FORCE, lane]
            impact[HANDED, lane] -= force * row_product(right, share, j, coordinates, DQ, lane)
            _lose(contact, impact, force * row_product(column, weight, j, coordinates, DQ, lane), lane)
            if force == 0.0 and row_product(column, weight, j, coordinates, V, lane) < 0.0:
                contact[HELD, lane] = 0.0
                table, used = end_impact(j, number, 0.0, impact, lane, table, used)
    calm = 0.0
    for k in range(mass.size):
        calm = max(calm, CALM * abs(coordinates[k, V, lane]))
    for blow in range(MOST_BLOWS):
        struck, fastest, pressed = -1, calm, 0.0
        for j in range(contacts.gap.size):
            contact = moving.contacts[j]
            rate = row_product(column, weight, j, coordinates, V, lane)
            depth = row_product(column, weight, j, coordinates, Q, lane) - contacts.gap[j]
            if depth < 0.0:
                continue
            gain = row_product(column, weight, j, coordinates, GAIN, lane)
            pressed = max(pressed, gain + contact[FORCE, lane] * _mobility(contacts, mass, j))
            # Sides that are held have no rate but for a neighbour's blow, and the rounding of the step.
            if rate > fastest and (blow > 0 or contact[HELD, lane] == 0.0):
                struck, fastest = j, rate
        if struck < 0:
            break
        if blow > MOST_BLOWS // 2:
            pressed = np.inf
        impact = impacts[struck]
        rests = _blow(steps, parts, struck, fastest, pressed, time, moving, account, impact, lane)
        if not rests:
            table, used = end_impact(struck, number, 0.0, impact, lane, table, used)
    return table, used


@called_often
def _mobility(contacts, mass, j):
    """Change of the rate of penetration of contact ``j`` by a unit impulse [1/kg]."""
    total, (column, weight) = 0.0, contacts.rows
    for place in range(column.shape[1]):
        total += weight[j, place] ** 2 / mass[column[j, place]]
    return total


@compiled
def _blow(steps, parts, j, rate, pressed, time, moving, account, impact, lane):
    """One blow of contact ``j``, with this rate of penetration at the end of the step.

    It takes place at the time of touch, from which velocities and displacements follow at the end of
    the step. ``pressed`` is the largest acceleration with which sides that touch are pressed together:
    a neighbour that is pressed against both ends a rebound too. Returns whether both sides rest.
    """
    contacts, mass, dt = steps.contacts, parts.mass, steps.dt
    (column, weight), (right, share), coordinates = contacts.rows, contacts.right, moving.coordinates
    depth = row_product(column, weight, j, coordinates, Q, lane) - contacts.gap[j]
    since, mobility, contact = 0.0, _mobility(contacts, mass, j), moving.contacts[j]
    gain = row_product(column, weight, j, coordinates, GAIN, lane)
    at_touch = np.sqrt(max(rate * rate - 2.0 * gain * depth, 0.0))
    if at_touch > 0.0:  # the penetration is a parabola
        since = min(2.0 * depth / (rate + at_touch), dt)
        rate -= since * gain
    e = contacts.restitution
    if 2.0 * e * rate < REST * dt * pressed:
        e = 0.0
    impulse = (1.0 + e) * rate / mobility
    if contact[HELD, lane] == 0.0:
        _begin_impact(impact, time + dt - since, rate, np.nan, lane)
    moved = row_product(right, share, j, coordinates, V, lane)
    sped = row_product(right, share, j, coordinates, GAIN, lane)
    _watch_touch(parts, since, coordinates, account.displacements, lane)
    for k in range(mass.size):
        coordinates[k, WAY, lane] = 0.0
    for place in range(column.shape[1]):
        k = column[j, place]
        jump = -weight[j, place] * impulse / mass[k]
        coordinates[k, V, lane] += jump
        coordinates[k, WAY, lane] = jump * since
    moved = 0.5 * (moved + row_product(right, share, j, coordinates, V, lane)) - since * sped
    _displace(steps, parts, moving, account.structures, lane)
    impact[HANDED, lane] -= impulse * moved
    _lose(contact, impact, 0.5 * (1.0 - e) * (1.0 + e) * rate * rate / mobility, lane)
    contact[HELD, lane] = 1.0 if e == 0.0 else 0.0
    return e == 0.0


@compiled
def _watch_touch(parts, since, coordinates, extremes, lane):
    """Update the largest and smallest displacements by those at a blow, ``since`` [s] before the end."""
    column, weight = parts.watched
    for i in range(column.shape[0]):
        end = row_product(column, weight, i, coordinates, Q, lane)
        touch = end - since * row_product(column, weight, i, coordinates, V, lane)
        extremes[i, HIGHEST, lane] = max(extremes[i, HIGHEST, lane], touch)
        extremes[i, LOWEST, lane] = min(extremes[i, LOWEST, lane], touch)


@compiled
def _displace(steps, parts, moving, structures, lane):
    """Displace the coordinates after a blow within the step, and the springs with them.

    The works on this way are those of the forces at the end of the step.
    """
    (column, weight), coordinates = steps.extensions, moving.coordinates
    for i in range(column.shape[0]):
        if steps.kind[i] != VISCOUS:
            moving.elements[i, Z, lane] += row_product(column, weight, i, coordinates, WAY, lane)
    for k in range(parts.mass.size):
        moved, energies = coordinates[k, WAY, lane], structures[parts.structure[k]]
        if moved != 0.0:
            coordinates[k, Q, lane] += moved
            energies[ENTERING, lane] += parts.mass[k] * moving.motions[F, lane] * moved
            drag = 0.0
            for m in range(parts.mass.size):
                drag += parts.damping[k, m] * coordinates[m, V, lane]
            energies[VISCOUS_LOSS, lane] += drag * moved


@compiled
def end_all(contacts, number, moving, impacts, lane, table, used):
    """End the impacts that go on at the end of the motion."""
    for j in range(contacts.gap.size):
        if not np.isnan(impacts[j, BEGIN, lane]):
            stored = 0.0
            if not contacts.jumps:
                column, weight = contacts.rows
                depth = row_product(column, weight, j, moving.coordinates, Q, lane) - contacts.gap[j]
                stored = stored_in(contacts.law[j], depth)
            table, used = end_impact(j, number, stored, impacts[j], lane, table, used)
    return table, used
