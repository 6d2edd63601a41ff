"""Impacts in the lanes near contact: their table, and stereomechanical blows.

A contact has an impact from the time at which the penetration becomes positive until it is negative
again. A stereomechanical blow multiplies the rate of penetration by ``-e`` at the time of touch,
eq. (13). A rebound that would last less than `LEAST_REBOUND_STEPS` ends in rest: both sides
then move together, as one impact, until they are pulled apart.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.borrowed import borrowed
from stochlin.kernels.basics.compiled import called_often, called_once, compiled
from stochlin.kernels.simulation.contacts import force as force_at
from stochlin.kernels.simulation.contacts import mean_force, separation_margin
from stochlin.kernels.simulation.laws import VISCOUS
from stochlin.kernels.simulation.row_products import row_product
from stochlin.kernels.simulation.state import PresentImpacts

LINES_PER_MOTION = 256  # of the table of impacts; it is made longer if these are too few
LEAST_REBOUND_STEPS = 2.0  # fewest time steps of a rebound
ROUNDING_OF_RATES = 1e-12  # rate of penetration that may be rounding, over the largest velocity
MOST_BLOWS = 200  # of all contacts after one time step; then all sides that still approach rest

_COLUMNS = [
    ("motion", np.int64),
    ("contact", np.int64),
    ("begin", float),  # [s]
    ("end", float),  # of the force [s]
    ("approach_velocity", float),  # [m/s]
    ("largest_force", float),  # [N]; NaN of a blow
    ("largest_penetration", float),  # [m]
    ("dissipated", float),  # [J]
    ("work_on_right", float),  # on the structure on the right [J]
    ("stored", float),  # energy left in the contact at the end of the motion [J]
]
PRESENT = [name for name, _ in _COLUMNS if name in PresentImpacts._fields]
IMPACT = np.dtype((np.record, np.dtype(_COLUMNS)))  # a record: fields are also attributes


@borrowed
class ImpactTable(NamedTuple):
    """The impacts of all motions, as they end."""

    lines: Array  # of the type IMPACT
    number: Array  # (1,): that of all impacts so far, of which the table may have no line


@compiled
def _begin_impact(impacts, j, time, speed, force, lane):
    """Begin the impact of contact ``j``."""
    impacts.begin[j, lane] = time
    impacts.approach_velocity[j, lane] = speed
    impacts.largest_force[j, lane] = force
    impacts.end[j, lane] = time
    impacts.dissipated[j, lane] = 0.0
    impacts.work_on_right[j, lane] = 0.0
    impacts.largest_penetration[j, lane] = 0.0
    impacts.force[j, lane] = force
    impacts.force_rise[j, lane] = 0.0
    impacts.time_in_contact[j, lane] = 0.0


@compiled
def _end_impact(impacts, j, motion, lane, table):
    """End the impact of contact ``j`` and write its line, if the table has one left.

    ``motion`` is the number of that in this lane.
    """
    if table.number[0] < table.lines.size:
        line = table.lines[table.number[0]]
        line.motion = motion
        line.contact = j
        line.begin = impacts.begin[j, lane]
        line.end = impacts.end[j, lane]
        line.approach_velocity = impacts.approach_velocity[j, lane]
        line.largest_force = impacts.largest_force[j, lane]
        line.largest_penetration = impacts.largest_penetration[j, lane]
        line.dissipated = impacts.dissipated[j, lane]
        line.work_on_right = impacts.work_on_right[j, lane]
        line.stored = 0.0
    impacts.begin[j, lane] = np.nan
    table.number[0] += 1


@called_once
def _watch_force(impacts, j, now, span, lane):
    """Update the largest force by that at the end of a step, ``span`` [s] after the one before.

    Between steps the force is a parabola through three of its values.
    """
    last = impacts.force[j, lane]
    rose = impacts.force_rise[j, lane]
    before = impacts.time_in_contact[j, lane]
    rise = (now - last) / span
    largest = now
    if rose > 0.0 > rise:
        bend = (rise - rose) / (before + span)
        slope = rise - bend * span
        # Between equal steps it rises by an eighth of the larger difference at most.
        largest = last + min(-0.25 * slope * slope / bend, 0.125 * max(rose * before, -rise * span))
    impacts.largest_force[j, lane] = max(impacts.largest_force[j, lane], largest)
    impacts.force[j, lane] = now
    impacts.force_rise[j, lane] = rise
    impacts.time_in_contact[j, lane] = span


def watch_contacts(steps, parts, time, near, count, state, table):
    """Update the impacts in the lanes near contact by a time step that began at ``time`` [s].

    ``near`` numbers the motions in the lanes.
    """
    for lane in range(count):
        for j in range(steps.contacts.gap.size):
            change = row_product(steps.contacts.rows, j, state.coordinates.dq, lane)
            before = state.contacts.penetration[j, lane]
            after = before + change
            if before > 0.0 or after > 0.0:
                _watch_contact(steps, j, time, before, change, state, lane)
                if after <= 0.0:
                    _end_impact(state.impacts, j, near[lane], lane, table)


@called_once
def _watch_contact(steps, j, time, before, change, state, lane):
    """Update the impact of contact ``j`` by a time step in which its sides touch.

    The penetration grows by ``change`` from that ``before`` the step.
    """
    dt = steps.dt
    law = steps.contacts.law[j]
    contacts = state.contacts
    impacts = state.impacts
    force = contacts.mean_force[j, lane]
    speed = contacts.speed[j, lane]
    rate = contacts.rate[j, lane]
    after = before + change
    if np.isnan(impacts.begin[j, lane]):
        touch = time + (dt * -before / change if before < 0.0 else 0.0)
        first_force = (
            law.damping * speed if law.damping_exponent == 0.0 and not law.over_approach else 0.0
        )
        _begin_impact(impacts, j, touch, speed, first_force, lane)
    v0 = speed if speed > state.motions.least_approach[lane] else 0.0
    total, elastic = mean_force(law, v0, before, change, dt)
    _dissipate(state, j, (total - elastic) * change, lane)
    right = steps.contacts.right
    impacts.work_on_right[j, lane] -= force * row_product(right, j, state.coordinates.dq, lane)
    _add_work_of_wall(steps.contacts, j, force, state.coordinates, state.coordinates.dq, lane)
    now = force_at(law, after, 2.0 * change / dt - rate, v0)
    _watch_force(impacts, j, now, dt * min(1.0, after / change) if before < 0.0 else dt, lane)
    fall = 2.0 * (rate - change / dt)  # of the rate in the step
    turn = before + 0.5 * dt * rate * rate / fall if rate > 0.0 and rate < fall else after
    impacts.largest_penetration[j, lane] = max(impacts.largest_penetration[j, lane], after, turn)
    if total != 0.0:
        margin = separation_margin(law, before, change / dt)
        margin_after = separation_margin(law, after, change / dt)
        within = margin / (margin - margin_after) if margin_after < 0.0 < margin else 1.0
        impacts.end[j, lane] = time + dt * within


@called_often
def _add_work_of_wall(contacts, j, push, coordinates, moved, lane):
    """Add the work of a wall, a force times a way, or an impulse times a velocity."""
    weight = contacts.of_wall[j]
    if weight != 0.0:
        wall = coordinates.q.shape[0] - 1
        coordinates.input_energy[wall, lane] += push * weight * moved[wall, lane]


@called_often
def _dissipate(state, j, energy, lane):
    """Add an energy to what contact ``j`` and its present impact have dissipated."""
    state.contacts.dissipated[j, lane] += energy
    state.impacts.dissipated[j, lane] += energy


def strike_all(steps, parts, time, near, count, state, table):
    """Stereomechanical blows after a time step that began at ``time`` [s], until no sides approach.

    The arguments are those of `watch_contacts`.
    """
    coordinates = state.coordinates
    for lane in range(count):
        rounding = 0.0
        for k in range(coordinates.q.shape[0]):
            rounding = max(rounding, ROUNDING_OF_RATES * abs(coordinates.v[k, lane]))
            change = coordinates.v[k, lane] - coordinates.dq[k, lane] / steps.dt
            state.blows.acceleration[k, lane] = 2.0 * change / steps.dt
        for j in range(steps.contacts.gap.size):
            if state.contacts.sticks[j, lane] != 0.0:
                _watch_sticking(steps, j, time, near[lane], state, lane, table)
        for blow in range(MOST_BLOWS):
            struck, fastest, pressed = _fastest(steps, parts, rounding, blow > 0, state, lane)
            if struck < 0:
                break
            if blow > MOST_BLOWS // 2:
                pressed = np.inf
            rests = _blow(steps, parts, struck, fastest, pressed, time, state, lane)
            if not rests:
                _end_impact(state.impacts, struck, near[lane], lane, table)


@called_once
def _watch_sticking(steps, j, time, motion, state, lane, table):
    """Update the impact of contact ``j`` whose sides stick, and end it if they are pulled apart."""
    coordinates = state.coordinates
    impacts = state.impacts
    force = state.contacts.mean_force[j, lane]
    impacts.end[j, lane] = time + steps.dt
    moved = row_product(steps.contacts.right, j, coordinates.dq, lane)
    impacts.work_on_right[j, lane] -= force * moved
    _add_work_of_wall(steps.contacts, j, force, coordinates, coordinates.dq, lane)
    _dissipate(state, j, force * row_product(steps.contacts.rows, j, coordinates.dq, lane), lane)
    if force == 0.0 and row_product(steps.contacts.rows, j, coordinates.v, lane) < 0.0:
        state.contacts.sticks[j, lane] = 0.0
        _end_impact(impacts, j, motion, lane, table)


@called_once
def _fastest(steps, parts, rounding, struck_before, state, lane):
    """The contact with the largest rate of penetration, or -1, and this rate.

    Also the largest acceleration with which sides that touch are pressed together.
    """
    rows = steps.contacts.rows
    coordinates = state.coordinates
    contacts = state.contacts
    struck = -1
    fastest = rounding
    pressed = 0.0
    for j in range(steps.contacts.gap.size):
        rate = row_product(rows, j, coordinates.v, lane)
        depth = row_product(rows, j, coordinates.q, lane) - steps.contacts.gap[j]
        if depth < 0.0:
            continue
        gain = row_product(rows, j, state.blows.acceleration, lane)
        push = contacts.mean_force[j, lane] * _mobility(rows, parts.mass, j)
        pressed = max(pressed, gain + push)
        # Sides that stick have no rate but for a neighbour's blow, and for rounding.
        if rate > fastest and (struck_before or contacts.sticks[j, lane] == 0.0):
            struck = j
            fastest = rate
    return struck, fastest, pressed


@called_often
def _mobility(rows, mass, j):
    """Change of the rate of penetration of contact ``j`` by a unit impulse [1/kg]."""
    total = 0.0
    for place in range(rows.shape[1]):
        k = rows[j, place]["column"]
        if k < mass.size:  # not a wall
            total += rows[j, place]["weight"] ** 2 / mass[k]
    return total


@called_once
def _blow(steps, parts, j, rate, pressed, time, state, lane):
    """One blow of contact ``j``, with this rate of penetration at the end of the step.

    It takes place at the time of touch, from which velocities and displacements follow at the end
    of the step. ``pressed`` is the largest acceleration with which sides that touch are pressed
    together: a neighbour that is pressed against both ends a rebound too. Returns whether both
    sides rest.
    """
    dt = steps.dt
    rows = steps.contacts.rows
    right = steps.contacts.right
    coordinates = state.coordinates
    impacts = state.impacts
    blows = state.blows
    depth = row_product(rows, j, coordinates.q, lane) - steps.contacts.gap[j]
    since = 0.0
    mobility = _mobility(rows, parts.mass, j)
    gain = row_product(rows, j, blows.acceleration, lane)
    rate_at_touch = np.sqrt(max(rate * rate - 2.0 * gain * depth, 0.0))
    if rate_at_touch > 0.0:  # the penetration is a parabola
        since = min(2.0 * depth / (rate + rate_at_touch), dt)
        rate -= since * gain
    e = steps.contacts.restitution
    if 2.0 * e * rate < LEAST_REBOUND_STEPS * dt * pressed:
        e = 0.0
    impulse = (1.0 + e) * rate / mobility
    if state.contacts.sticks[j, lane] == 0.0:
        _begin_impact(impacts, j, time + dt - since, rate, np.nan, lane)
    before = row_product(right, j, coordinates.v, lane)
    gain_of_right = row_product(right, j, blows.acceleration, lane)
    _watch_touch(parts.watched, since, coordinates, state.peaks, lane)
    for k in range(parts.mass.size):
        blows.shift[k, lane] = 0.0
    for place in range(rows.shape[1]):
        k = rows[j, place]["column"]
        if k < parts.mass.size:  # not a wall
            jump = -rows[j, place]["weight"] * impulse / parts.mass[k]
            coordinates.v[k, lane] += jump
            blows.shift[k, lane] = jump * since
    after = row_product(right, j, coordinates.v, lane)
    velocity_of_right = 0.5 * (before + after) - since * gain_of_right
    _displace(steps, parts, state, lane)
    impacts.work_on_right[j, lane] -= impulse * velocity_of_right
    _add_work_of_wall(steps.contacts, j, impulse, coordinates, coordinates.v, lane)
    _add_work_of_wall(steps.contacts, j, -impulse * since, coordinates, blows.acceleration, lane)
    _dissipate(state, j, 0.5 * (1.0 - e) * (1.0 + e) * rate * rate / mobility, lane)
    state.contacts.sticks[j, lane] = 1.0 if e == 0.0 else 0.0
    return e == 0.0


@called_once
def _watch_touch(rows, since, coordinates, peaks, lane):
    """Update largest and smallest displacements by those at a blow ``since`` [s] before the end."""
    for i in range(rows.shape[0]):
        end = row_product(rows, i, coordinates.q, lane)
        touch = end - since * row_product(rows, i, coordinates.v, lane)
        peaks.highest[i, lane] = max(peaks.highest[i, lane], touch)
        peaks.lowest[i, lane] = min(peaks.lowest[i, lane], touch)


@called_once
def _displace(steps, parts, state, lane):
    """Displace the coordinates after a blow within the step, and the springs with them.

    The works on this way are those of the forces at the end of the step.
    """
    coordinates = state.coordinates
    shift = state.blows.shift
    for i in range(steps.kind.size):
        if steps.kind[i] != VISCOUS:
            state.elements.z[i, lane] += row_product(steps.extensions, i, shift, lane)
    for k in range(parts.mass.size):
        moved = shift[k, lane]
        drag = 0.0
        for m in range(parts.mass.size):
            drag += parts.damping[k, m] * coordinates.v[m, lane]
        coordinates.drag[k, lane] = drag
        coordinates.q[k, lane] += moved
        coordinates.input_energy[k, lane] += parts.mass[k] * state.motions.forcing[lane] * moved
        coordinates.viscous_energy[k, lane] += drag * moved
