"""Impacts in the lanes near contact: their table, and stereomechanical blows.

A contact has an impact from the time at which the penetration becomes positive until it is negative
again. A stereomechanical blow multiplies the rate of penetration by ``-e`` at the time of touch, eq.
(13). A rebound that would last less than `REST` time steps ends in rest: both sides then move together,
as one impact, until they are pulled apart.
"""

from __future__ import annotations

import numpy as np

from stochlin.kernels.basics.compiled import called_often, called_once, compiled
from stochlin.kernels.simulation.account import watch_displacements
from stochlin.kernels.simulation.contacts import force as force_at
from stochlin.kernels.simulation.contacts import mean_force, separation_margin
from stochlin.kernels.simulation.laws import VISCOUS
from stochlin.kernels.simulation.moving import (
    APPROACH,
    BEGIN,
    DEEPEST,
    DEPTH,
    DISSIPATED,
    DQ,
    END,
    ENTERING,
    FORCE,
    GAIN,
    HANDED,
    HELD,
    HIGHEST,
    LARGEST,
    LAST,
    LOST,
    LOWEST,
    RATE,
    RISE,
    SLOW,
    SPAN,
    SPEED,
    VISCOUS_LOSS,
    WAY,
    F,
    Q,
    V,
    Z,
    row_product,
)

# Columns of the table of impacts after those of the present impact of a contact, up to DEEPEST. Of the
# present impact the force at the end of the last step is known too, with the rate at which it rose in
# that step, and the duration of contact in it.
LANE, CONTACT, STORED = range(DEEPEST + 1, DEEPEST + 4)
COLUMNS = STORED + 1
LINES = 256  # length of the table for each motion, if it is long enough
REST = 2.0  # time steps that a rebound takes at least
CALM = 1e-12  # rate of penetration that may be rounding, over the largest velocity
MOST_BLOWS = 200  # of all contacts after one time step; then all sides that still approach rest


@compiled
def _begin_impact(impact, time, speed, largest, lane):
    """Begin the impact of a contact."""
    for column in range(BEGIN, SPAN + 1):
        impact[column, lane] = 0.0
    impact[BEGIN, lane] = impact[END, lane] = time
    impact[APPROACH, lane], impact[LARGEST, lane], impact[LAST, lane] = speed, largest, largest


@compiled
def _end_impact(j, number, stored, impact, lane, table, used):
    """End the impact of contact ``j`` and write its line, if the table has one left.

    ``number`` is that of the motion in this lane, and ``used`` (1,) the number of all impacts so far.
    """
    if used[0] < len(table):
        line = table[used[0]]
        for column in range(BEGIN, DEEPEST + 1):
            line[column] = impact[column, lane]
        line[LANE], line[CONTACT], line[STORED] = number, j, stored
    impact[BEGIN, lane] = np.nan
    used[0] += 1


@called_once
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


def watch_contacts(steps, parts, time, near, count, moving, table, used):
    """Update the impacts in the lanes near contact by a time step that began at ``time`` [s].

    ``near`` numbers the motions; ``table`` and ``used`` are those of `_end_impact`.
    """
    contacts, dt, coordinates = steps.contacts, steps.dt, moving.coordinates
    for lane in range(count):
        for j in range(contacts.gap.size):
            law, impact, slow = contacts.law[j], moving.contacts[j], moving.motions[SLOW, lane]
            change = row_product(contacts.rows, j, coordinates, DQ, lane)
            before, force, speed = impact[DEPTH, lane], impact[FORCE, lane], impact[SPEED, lane]
            after = before + change
            if before <= 0.0 and after <= 0.0:
                continue
            if np.isnan(impact[BEGIN, lane]):
                touch = time + (dt * -before / change if before < 0.0 else 0.0)
                at_once = (
                    law.damping * speed if law.damping_exponent == 0.0 and not law.over_approach else 0.0
                )
                _begin_impact(impact, touch, speed, at_once, lane)
            v0 = speed if speed > slow else 0.0
            total, elastic = mean_force(law, v0, before, change, dt)
            _lose(impact, (total - elastic) * change, lane)
            impact[HANDED, lane] -= force * row_product(contacts.right, j, coordinates, DQ, lane)
            rate = impact[RATE, lane]
            now = force_at(law, after, 2.0 * change / dt - rate, v0)
            _watch_force(impact, now, dt * min(1.0, after / change) if before < 0.0 else dt, lane)
            fall = 2.0 * (rate - change / dt)  # of the rate in the step
            turn = before + 0.5 * dt * rate * rate / fall if rate > 0.0 and rate < fall else after
            impact[DEEPEST, lane] = max(impact[DEEPEST, lane], after, turn)
            if total != 0.0:
                margin = separation_margin(law, before, change / dt)
                left = separation_margin(law, after, change / dt)
                impact[END, lane] = time + dt * (
                    margin / (margin - left) if left < 0.0 < margin else 1.0
                )
            if after <= 0.0:
                _end_impact(j, near[lane], 0.0, impact, lane, table, used)


@called_often
def _lose(impact, energy, lane):
    """Add an energy to what the contact and its present impact have dissipated."""
    impact[DISSIPATED, lane] += energy
    impact[LOST, lane] += energy


def strike_all(steps, parts, time, near, count, moving, table, used):
    """Stereomechanical blows after a time step that began at ``time`` [s], until no sides approach.

    The arguments are those of `watch_contacts`; displacements are watched after the blows.
    """
    contacts, mass, dt, coordinates = steps.contacts, parts.mass, steps.dt, moving.coordinates
    rows, right = contacts.rows, contacts.right
    for lane in range(count):
        calm = 0.0
        for k in range(mass.size):
            calm = max(calm, CALM * abs(coordinates[k, V, lane]))
            change = coordinates[k, V, lane] - coordinates[k, DQ, lane] / dt
            coordinates[k, GAIN, lane] = 2.0 * change / dt
        for j in range(contacts.gap.size):
            impact = moving.contacts[j]
            if impact[HELD, lane] != 0.0:
                impact[END, lane] = time + dt
                force = impact[FORCE, lane]
                impact[HANDED, lane] -= force * row_product(right, j, coordinates, DQ, lane)
                _lose(impact, force * row_product(rows, j, coordinates, DQ, lane), lane)
                if force == 0.0 and row_product(rows, j, coordinates, V, lane) < 0.0:
                    impact[HELD, lane] = 0.0
                    _end_impact(j, near[lane], 0.0, impact, lane, table, used)
        for blow in range(MOST_BLOWS):
            struck, fastest, pressed = -1, calm, 0.0
            for j in range(contacts.gap.size):
                impact = moving.contacts[j]
                rate = row_product(rows, j, coordinates, V, lane)
                depth = row_product(rows, j, coordinates, Q, lane) - contacts.gap[j]
                if depth < 0.0:
                    continue
                gain = row_product(rows, j, coordinates, GAIN, lane)
                pressed = max(pressed, gain + impact[FORCE, lane] * _mobility(contacts, mass, j))
                # Sides that are held have no rate but for a neighbour's blow, and for rounding.
                if rate > fastest and (blow > 0 or impact[HELD, lane] == 0.0):
                    struck, fastest = j, rate
            if struck < 0:
                break
            if blow > MOST_BLOWS // 2:
                pressed = np.inf
            rests = _blow(steps, parts, struck, fastest, pressed, time, moving, lane)
            if not rests:
                _end_impact(struck, near[lane], 0.0, moving.contacts[struck], lane, table, used)
    watch_displacements(steps, parts, moving, count)


@called_often
def _mobility(contacts, mass, j):
    """Change of the rate of penetration of contact ``j`` by a unit impulse [1/kg]."""
    total, rows = 0.0, contacts.rows
    for place in range(rows.shape[1]):
        total += rows[j, place]["weight"] ** 2 / mass[rows[j, place]["column"]]
    return total


@called_once
def _blow(steps, parts, j, rate, pressed, time, moving, lane):
    """One blow of contact ``j``, with this rate of penetration at the end of the step.

    It takes place at the time of touch, from which velocities and displacements follow at the end of
    the step. ``pressed`` is the largest acceleration with which sides that touch are pressed together:
    a neighbour that is pressed against both ends a rebound too. Returns whether both sides rest.
    """
    contacts, mass, dt, coordinates = steps.contacts, parts.mass, steps.dt, moving.coordinates
    rows, right, impact = contacts.rows, contacts.right, moving.contacts[j]
    depth = row_product(rows, j, coordinates, Q, lane) - contacts.gap[j]
    since, mobility = 0.0, _mobility(contacts, mass, j)
    gain = row_product(rows, j, coordinates, GAIN, lane)
    at_touch = np.sqrt(max(rate * rate - 2.0 * gain * depth, 0.0))
    if at_touch > 0.0:  # the penetration is a parabola
        since = min(2.0 * depth / (rate + at_touch), dt)
        rate -= since * gain
    e = contacts.restitution
    if 2.0 * e * rate < REST * dt * pressed:
        e = 0.0
    impulse = (1.0 + e) * rate / mobility
    if impact[HELD, lane] == 0.0:
        _begin_impact(impact, time + dt - since, rate, np.nan, lane)
    moved = row_product(right, j, coordinates, V, lane)
    sped = row_product(right, j, coordinates, GAIN, lane)
    _watch_touch(parts.watched, since, coordinates, moving.watched, lane)
    for k in range(mass.size):
        coordinates[k, WAY, lane] = 0.0
    for place in range(rows.shape[1]):
        k = rows[j, place]["column"]
        jump = -rows[j, place]["weight"] * impulse / mass[k]
        coordinates[k, V, lane] += jump
        coordinates[k, WAY, lane] = jump * since
    moved = 0.5 * (moved + row_product(right, j, coordinates, V, lane)) - since * sped
    _displace(steps, parts, moving, lane)
    impact[HANDED, lane] -= impulse * moved
    _lose(impact, 0.5 * (1.0 - e) * (1.0 + e) * rate * rate / mobility, lane)
    impact[HELD, lane] = 1.0 if e == 0.0 else 0.0
    return e == 0.0


@called_once
def _watch_touch(rows, since, coordinates, extremes, lane):
    """Update the largest and smallest displacements by those at a blow, ``since`` [s] before the end."""
    for i in range(rows.shape[0]):
        end = row_product(rows, i, coordinates, Q, lane)
        touch = end - since * row_product(rows, i, coordinates, V, lane)
        extremes[i, HIGHEST, lane] = max(extremes[i, HIGHEST, lane], touch)
        extremes[i, LOWEST, lane] = min(extremes[i, LOWEST, lane], touch)


@called_once
def _displace(steps, parts, moving, lane):
    """Displace the coordinates after a blow within the step, and the springs with them.

    The works on this way are those of the forces at the end of the step.
    """
    rows, coordinates = steps.extensions, moving.coordinates
    for i in range(rows.shape[0]):
        if steps.kind[i] != VISCOUS:
            moving.elements[i, Z, lane] += row_product(rows, i, coordinates, WAY, lane)
    for k in range(parts.mass.size):
        moved = coordinates[k, WAY, lane]
        if moved != 0.0:
            coordinates[k, Q, lane] += moved
            coordinates[k, ENTERING, lane] += parts.mass[k] * moving.motions[F, lane] * moved
            drag = 0.0
            for m in range(parts.mass.size):
                drag += parts.damping[k, m] * coordinates[m, V, lane]
            coordinates[k, VISCOUS_LOSS, lane] += drag * moved
