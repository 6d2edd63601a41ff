"""Response of buildings in a row to a ground motion, with time steps that end at every event.

The ground acceleration is linear between its samples, and time steps end at each of them. An event is
the end of a branch, for instance yielding or the beginning of a contact. If it falls into a step, its
time follows from the interpolating polynomials. The step is cut off there, and the next one begins on
the new branch. The time steps do not depend on the times at which states are requested.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.compiled import called_often, compiled, entry
from stochlin.kernels.pounding.contact import (
    CLOSED,
    OPEN,
    PARTED,
    TOGETHER,
    has_fractional_power,
)
from stochlin.kernels.pounding.events import (
    NOTHING,
    first_event,
    pass_event,
    watch_forces,
    watch_peaks,
    watch_state,
)
from stochlin.kernels.pounding.impacts import COLUMNS, FIRST_LINES, MOST_BLOWS, begin_entry, end_entry
from stochlin.kernels.pounding.lending import borrow
from stochlin.kernels.pounding.rates import rates, rates_at_times, start
from stochlin.kernels.pounding.rows import LAWS, Branches, Row, sizes_of
from stochlin.kernels.pounding.steps import (
    STAGES,
    Space,
    attempt,
    copy,
    grow_reach,
    interpolate,
    state_within,
)

SAFETY, SHRINK, GROW, ORDER = 0.9, 0.2, 5.0, 8.0  # constants of the step size control
OUTSET = 1e-3  # initial scale of the error control, over the velocity dt max |a| of one interval
FIRST = 0.1  # first time step, over the interval of the record
LEAST = 1e-12  # smallest advance past an event, over the interval of the record
STUCK = 1e-14  # smallest time step, over the interval of the record; a smaller one ends the run
MOST_STEPS = 500_000  # largest number of trial steps in one interval of the record
ON_CONTACT = 0.3  # first time step in contact, over the time scale of the contact
ON_HERTZ = 1e-4  # the same for a force with a fractional power of the penetration


class SampledMotion(NamedTuple):
    """A ground motion, and the output times at which the state is requested."""

    acceleration: Array  # (samples,) [m/s^2]
    dt: float  # [s]
    interval: Array  # (times,): number of the interval of the record with the output time, increasing
    since: Array  # (times,) [s]: time since the beginning of this interval, from 0 to dt


class Most(NamedTuple):
    """Largest magnitudes at the ends of steps; accelerations in contact also at the nodes of steps."""

    acceleration: Array  # (n,) [m/s^2]: absolute accelerations of the floors
    shear: Array  # (n,) [N]: storey shears
    pull: Array  # (l,) [N]: forces of the links


class Asked(NamedTuple):
    """Output times as in `SampledMotion`, and the arrays of `Run` that are written at them."""

    interval: Array
    since: Array
    states: Array
    forces: Array
    accelerations: Array
    peaks: Array


class Run(NamedTuple):
    """Response of a row of buildings to one motion."""

    states: Array  # (times, k): states at the output times
    forces: Array  # (times, c) [N]: contact forces
    accelerations: Array  # (times, n) [m/s^2]: absolute accelerations of the floors
    peaks: Array  # (2, n) [m]: highest and lowest displacement of each floor
    most: Most
    impacts: Array  # (impacts, COLUMNS): the table of `impacts`
    steps: int  # number of trial steps
    completed: bool  # the end of the motion was reached
    time: float  # time reached [s]
    last: Array  # (k,): state at this time


@compiled
def _advance(row, branch, ground, slope, h, x, space):
    """Compute one step, reduced until its error is within the tolerance.

    Returns its length [s] (0 if no length succeeded), the length to try next and the number of trials.
    """
    for trial in range(1, 60):
        error = attempt(row, branch, ground, slope, h, x, space)
        if error <= 1.0:
            growth = GROW if error == 0.0 else min(GROW, SAFETY * error ** (-1.0 / ORDER))
            now = ground + slope * h
            rates(row, branch, now, space.new, space.stages[STAGES], space.force)
            return h, h * growth, trial
        # After overflow the error is not finite and gives no estimate of the right length.
        h *= max(SHRINK, SAFETY * error ** (-1.0 / ORDER)) if error < np.inf else SHRINK
    return 0.0, h, trial


@compiled
def _watch(row, branch, ground, slope, h, end, x, after, known, space, asked, most, table):
    """Update peaks and largest forces by a step up to its share ``end``.

    Returns whether the interpolating polynomials of the step have been computed.
    """
    needed = watch_peaks(row, end, h, x, after, space, asked.peaks, known)
    if needed and not known:
        interpolate(row, branch, ground, slope, h, x, space)
        watch_peaks(row, end, h, x, after, space, asked.peaks, needed)
        known = needed
    watch_forces(branch, end, h, space, table, most.acceleration)
    return known


@compiled
def _report(row, branch, ground, slope, h, tau, last, x, after, known, space, asked, at, done):
    """Write the states at output times from ``tau`` to ``last`` [s] of interval ``at`` of the record.

    Returns the number of output times that are done.
    """
    while done < asked.since.size and asked.interval[done] == at and asked.since[done] <= last:
        state, t = asked.states[done], (asked.since[done] - tau) / h
        if asked.since[done] == last:
            copy(after, state)
        else:
            if not known:
                interpolate(row, branch, ground, slope, h, x, space)
                known = True
            state_within(x, t, space, state)
        now = ground + slope * (t * h)
        rates_at_times(row, branch, now, state, space.rate, asked.forces[done])
        _keep_accelerations(row, now, space.rate, asked.accelerations[done])
        done += 1
    return done


@called_often
def _keep_accelerations(row, ground, rate, out):
    """Write the absolute accelerations of the floors to ``out`` (n,)."""
    for i in range(row.mass.size):
        out[i] = rate[row.mass.size + i] + ground


@compiled
def _first_in_contact(row, branch, j):
    """First time step in contact ``j`` [s], a share of the time scale of contact of two free masses."""
    law = row.element[j]
    k, n, c = law.stiffness, law.exponent, 0.0 if law.over_approach else law.damping
    mass = row.meeting[j]
    pace = (mass * branch.approach[j] ** (1.0 - n) / k) ** (1.0 / (n + 1.0))
    if has_fractional_power(law):
        return ON_HERTZ * pace
    return ON_CONTACT * (min(pace, mass / c) if c > 0.0 else pace)


@compiled
def _pass(row, branch, event, way, ground, time, planned, x, space, table, used):
    """Change to the branch after an event.

    Returns the table of impacts, extended if necessary, the number of its lines in use, and the length
    of the next step.
    """
    before = branch.contact.copy()
    if used + MOST_BLOWS + 2 * before.size > len(table):
        longer = np.empty((2 * len(table), COLUMNS))
        for line in range(used):
            copy(table[line], longer[line])
        table = longer
    used = pass_event(row, branch, event, way, ground, time, x, space, table, used)
    for j in range(before.size):
        if before[j] == OPEN and branch.contact[j] == CLOSED:
            planned = min(planned, _first_in_contact(row, branch, j))
    rates_at_times(row, branch, ground, x, space.stages[0], space.force)
    return table, used, planned


@compiled
def _interval(row, branch, begin, slope, dt, at, planned, x, space, asked, most, done, table, used):
    """All steps in interval ``at`` of the record, with the ground acceleration ``begin + slope tau``.

    Returns the time reached in the interval, the number of trial steps, the length of the next step, the
    number of output times done, the table of impacts and the number of its lines in use.
    """
    tau, count, after = 0.0, 0, space.after
    while tau < dt:
        ground, left = begin + slope * tau, dt - tau
        h = left if planned >= left else min(planned, 0.5 * left)
        taken, following, trials = _advance(row, branch, ground, slope, h, x, space)
        count += trials
        if count > MOST_STEPS or taken < min(STUCK * dt, left):
            break
        planned = max(following, planned) if taken == h else following
        end, event, way, known = first_event(row, branch, ground, slope, taken, x, space)
        if event != NOTHING:
            end = min(1.0, max(end, LEAST * dt / taken))
        if end < 1.0:
            state_within(x, end, space, after)
        else:
            copy(space.new, after)
        last = dt if taken == left and end == 1.0 else tau + end * taken
        known = _watch(
            row, branch, ground, slope, taken, end, x, after, known, space, asked, most, table
        )
        done = _report(
            row, branch, ground, slope, taken, tau, last, x, after, known, space, asked, at, done
        )
        copy(after, x)
        tau = last
        grow_reach(row, x, space.reach)
        if event == NOTHING:
            copy(space.stages[STAGES], space.stages[0])
        else:
            now, time = begin + slope * tau, at * dt + tau
            rates_at_times(row, branch, now, x, space.rate, space.force)
            watch_state(row, branch, now, x, space.rate, most)
            table, used, planned = _pass(
                row, branch, event, way, now, time, planned, x, space, table, used
            )
        watch_state(row, branch, begin + slope * tau, x, space.stages[0], most)
    return tau, count, planned, done, table, used


@entry
def _run(row_, branch_, space_, asked_, most_, acceleration, dt, speed, x):
    """The whole motion, from the state ``x``, which is changed to the last one.

    Returns the table of impacts, the number of trial steps, whether the end was reached, and the time
    reached.
    """
    row, branch, space = borrow(row_), borrow(branch_), borrow(space_)
    asked, most = borrow(asked_), borrow(most_)
    start(row, branch, x)
    table = np.empty((FIRST_LINES + 4 * row.gap.size, COLUMNS))
    used = steps = done = 0
    for peaks in asked.peaks:
        copy(x[: row.mass.size], peaks)
    for b in range(row.first.size - 1):
        space.reach[0, b], space.reach[1, b] = speed * dt, speed
    grow_reach(row, x, space.reach)
    rates_at_times(row, branch, acceleration[0], x, space.stages[0], space.force)
    for j in range(row.gap.size):
        if branch.contact[j] == TOGETHER:
            used = begin_entry(row, branch, j, 0.0, 0.0, x, table, used)
    while done < asked.since.size and asked.interval[done] == 0 and asked.since[done] <= 0.0:
        copy(x, asked.states[done])
        copy(space.force, asked.forces[done])
        _keep_accelerations(row, acceleration[0], space.stages[0], asked.accelerations[done])
        done += 1
    watch_state(row, branch, acceleration[0], x, space.stages[0], most)
    planned, time, completed = FIRST * dt, 0.0, True
    for at in range(acceleration.size - 1):
        begin, slope = acceleration[at], (acceleration[at + 1] - acceleration[at]) / dt
        tau, count, planned, done, table, used = _interval(
            row, branch, begin, slope, dt, at, planned, x, space, asked, most, done, table, used
        )
        steps, time, completed = steps + count, at * dt + tau, tau >= dt
        if not completed:
            break
    for j in range(row.gap.size):
        if completed and branch.contact[j] not in (OPEN, PARTED):
            end_entry(row, branch, j, time, x, table)
    return table[:used], steps, completed, time


def run(row: Row, motion: SampledMotion, start: Array | None = None) -> Run:
    """Response of a row of buildings to a motion, from rest or from the state ``start`` (k,).

    If a time step cannot be completed the run ends: ``completed`` is then false, and ``time`` and
    ``last`` give the time and the state reached.
    """
    if not np.isin(row.law, LAWS).all():
        raise ValueError(f"law = {row.law} has one that is not known; allowed: {list(LAWS)}")
    n, _, c, k = sizes_of(row)
    state = np.zeros(k) if start is None else np.array(start, float)
    times = motion.since.size
    states, forces, accelerations = (np.zeros((times, size)) for size in (k, c, n))
    asked = Asked(motion.interval, motion.since, states, forces, accelerations, np.zeros((2, n)))
    most = Most(np.zeros(n), np.zeros(n), np.zeros(len(row.tied)))
    speed = OUTSET * motion.dt * np.abs(motion.acceleration).max()
    table, steps, completed, time = _run(
        row, Branches.of(row), Space.of(row), asked, most, motion.acceleration, motion.dt, speed, state
    )
    kept = asked.states, asked.forces, asked.accelerations, asked.peaks, most
    return Run(*kept, table, steps, completed, time, state)


def standing_alone(row: Row) -> Row:
    """The same buildings without contacts and without links between buildings.

    Links between two floors of one building, or between a floor and the ground, remain.
    """
    of = np.searchsorted(row.first, row.tied, side="right")
    own = (row.tied[:, 1] < 0) | (of[:, 0] == of[:, 1])
    none, nothing = np.zeros(0, np.int64), np.zeros(0)
    alone = row._replace(left=none, right=none, lower=none, gap=nothing, element=row.element[:0])
    alone = alone._replace(weight=row.weight[:0], meeting=nothing)
    return alone._replace(tied=row.tied[own], tie=row.tie[own], tie_law=row.tie_law[own])
