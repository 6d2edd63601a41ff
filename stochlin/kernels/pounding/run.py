"""Response of a row of buildings to motions, one or many at once, with impacts.

Every step is first taken without contacts, in all motions. Those that are near contact in it are taken
again, in shorter steps with contacts: their lanes are gathered, and scattered again afterwards. No lane
depends on another, so that a motion has the same bits alone and among others. In lanes without contacts
the same buildings move each alone.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.compiled import compiled, entry
from stochlin.kernels.pounding.impacts import (
    BEGIN,
    COLUMNS,
    CONTACT,
    FIRST_LINES,
    LANE,
    end_all,
    strike,
    watch_contact,
)
from stochlin.kernels.simulation.account import Account, Parts, balance, watch, watch_displacements
from stochlin.kernels.simulation.contacts import Contacts
from stochlin.kernels.simulation.time_step import (
    Elements,
    Places,
    fill,
    lanes_at_rest,
    named_rows,
    steps_of,
    take_step,
    times_row,
    tolerances,
)


class BuildingRow(NamedTuple):
    """Buildings in a row."""

    elements: Elements
    law: Any  # the result of `laws.by_number`
    contacts: Contacts
    parts: Parts
    structures: int  # their number

    @property
    def places(self) -> tuple[Places, Account]:
        """The rows of the array ``x`` of all numbers of every motion."""
        c = self.contacts.gap.size
        places = Places.of(self.elements, c)
        links = self.parts.spring.size
        return places, Account.of(places, self.elements, self.structures, links, c)


class StepCounts(NamedTuple):
    """The time steps of a run."""

    cuts: int  # steps in an interval of the motion
    substeps: int  # steps in each of them near contact


class GroundMotions(NamedTuple):
    """Ground motions with one time step, linear between their samples."""

    acceleration: Array  # (samples, lanes) [m/s^2]; zero after the end of a motion
    dt: float  # [s]
    intervals: Array  # (lanes,): number of intervals of each motion
    slow: Array  # (lanes,) [m/s]: rate of approach below which a contact is elastic
    meets: Array  # (lanes,): whether contacts act


class RowResponse(NamedTuple):
    """Response of a row of buildings to one motion."""

    numbers: Array  # (rows,) at its end
    impacts: Array  # (impacts, COLUMNS): the table of `impacts`, as they begin
    history: Array  # (samples, rows): those of the first motion of a run, if they were asked for
    rows: Mapping[str, slice]  # by the names in `Places` and `Account`

    def at_end(self, name: str) -> Array:
        """The numbers of this name at the end."""
        return self.numbers[self.rows[name]]

    def over_time(self, name: str) -> Array:
        """The history of the numbers of this name (samples, n)."""
        return self.history[:, self.rows[name]]

    @property
    def peaks(self) -> Array:
        """Largest absolute displacement of each floor [m]."""
        return np.maximum(self.at_end("highest"), -self.at_end("lowest"))


@compiled
def _copy_lanes(source, of, target, to, count, first, last):
    """Copy rows from ``first`` to ``last`` in the lanes ``of`` to another array, in the lanes ``to``."""
    for row in range(first, last):
        for k in range(count):
            target[row, to[k]] = source[row, of[k]]


@compiled
def _near(contacts, dt, at, to, x, lanes, near):
    """Find the lanes that are in contact in the step taken without it, or may be.

    Within a step the penetration is a parabola, which rises above the ends by an eighth of the change of
    the rate times ``dt`` at most. Lanes are written to ``near``, and do not count; returns their number.
    """
    count, gap, (column, weight) = 0, contacts.gap, contacts.rows
    fill(x, to.scratch_3, -1.0, lanes)
    for j in range(gap.size):
        times_row(column, weight, j, x, at.q, to.scratch_1, lanes)
        times_row(column, weight, j, x, at.dq, at.change, lanes)
        times_row(column, weight, j, x, at.v, to.scratch_2, lanes)
        for lane in range(lanes):
            bulge = 0.25 * abs(dt * x[to.scratch_2, lane] - x[at.change, lane])
            highest = x[to.scratch_1, lane] + max(-x[at.change, lane], 0.0) + bulge - gap[j]
            open_now = np.isnan(x[to.begin + j, lane])
            reach = highest if open_now else 1.0
            x[to.scratch_3, lane] = max(x[to.scratch_3, lane], reach)
    for lane in range(lanes):
        if x[to.scratch_3, lane] > 0.0 and x[to.counts, lane] * x[at.meets, lane] > 0.0:
            x[to.counts, lane] = 0.0
            near[count] = lane
            count += 1
    return count


@compiled
def _end_failed(steps, limit, time, at, to, x, lanes):
    """End the motions in which an extension is beyond its limit, or not a number."""
    column, weight = steps.extensions
    for i in range(limit.size):
        times_row(column, weight, i, x, at.q, to.scratch_1, lanes)
        for lane in range(lanes):
            if not abs(x[to.scratch_1, lane]) <= limit[i] and x[to.failed, lane] == np.inf:
                x[to.failed, lane] = time


@compiled
def _keep(x, state):
    """Write the numbers of the first lane to a line of a history."""
    for row in range(len(x)):
        state[row] = x[row, 0]


@compiled
def _set_forcing(ground, sample, share, of, f, x, lanes):
    """Write the forcing at a share of an interval of the motion, in the lanes ``of``."""
    for k in range(lanes):
        lane = of[k]
        rise = ground[sample + 1, lane] - ground[sample, lane]
        x[f, k] = -(ground[sample, lane] + share * rise)


@compiled
def _count_going(intervals, sample, to, x, lanes):
    """Mark the motions that go on, in which steps count; returns their number."""
    going = 0
    for lane in range(lanes):
        goes = sample < intervals[lane] and x[to.failed, lane] == np.inf
        x[to.counts, lane] = 1.0 if goes else 0.0
        going += goes
    return going


@compiled
def _keep_ended(old, at, to, x, lanes, ended):
    """Leave motions that have ended as they were before the step."""
    count = 0
    for lane in range(lanes):
        if x[to.counts, lane] == 0.0:
            ended[count] = lane
            count += 1
    _copy_lanes(old, ended, x, ended, count, 0, at.work)


@compiled
def _watch_impacts(short, parts, time, near, count, at, to, y, table, used):
    """Update the impacts in all lanes near contact by a step; returns the table and its lines in use."""
    for k in range(count):
        if short.contacts.jumps:
            table, used = strike(short, parts, time, near[k], at, to, y, k, table, used)
        else:
            for j in range(short.contacts.gap.size):
                table, used = watch_contact(
                    short.contacts, j, short.dt, time, near[k], at, to, y, k, table, used
                )
    return table, used


@entry
def _run(law, steps, short, parts, at, to, x, motions, cuts, substeps, history):
    """All motions from their beginning, see `run`; ``steps`` are without contacts, ``short`` with.

    The first motion's states at the samples are written to ``history``, if it has lines. Returns the
    table of impacts and the number of these lines.
    """
    ground, dt, contacts = motions.acceleration, steps.dt, short.contacts
    lanes = ground.shape[1]
    old, y = np.empty((at.work, lanes)), np.zeros(x.shape)
    every, near = np.arange(lanes), np.empty(lanes, np.int64)
    table, used, kept = np.empty((FIRST_LINES, COLUMNS)), 0, 1
    tolerances(steps.spring, steps.info, at, x, lanes)
    tolerances(short.spring, short.info, at, y, lanes)
    if len(history) > 0:
        _keep(x, history[0])
    for s in range(cuts * (len(ground) - 1)):
        sample, cut, time = s // cuts, s % cuts, s * dt
        going = _count_going(motions.intervals, sample, to, x, lanes)
        if going == 0:
            break
        _copy_lanes(x, every, old, every, lanes, 0, at.work)
        _set_forcing(ground, sample, (cut + 0.5) / cuts, every, at.f, x, lanes)
        take_step(law, steps, at, x, lanes)
        if going < lanes:
            _keep_ended(old, at, to, x, lanes, near)
        count = _near(contacts, dt, at, to, x, lanes, near)
        watch(steps, parts, at, to, x, lanes)
        watch_displacements(steps, at, to, x, lanes)
        if count > 0:
            _copy_lanes(old, near, y, every, count, 0, at.work)
            _copy_lanes(x, near, y, every, count, to.first, to.work)
            fill(y, to.counts, 1.0, count)
            for part in range(substeps):
                now = time + part * short.dt
                within = (cut + (part + 0.5) / substeps) / cuts
                _set_forcing(ground, sample, within, near, at.f, y, count)
                take_step(law, short, at, y, count)
                watch(short, parts, at, to, y, count)
                table, used = _watch_impacts(short, parts, now, near, count, at, to, y, table, used)
                watch_displacements(short, at, to, y, count)
            _copy_lanes(y, every, x, near, count, 0, at.work)
            _copy_lanes(y, every, x, near, count, to.first, to.work)
            for k in range(count):
                x[to.counts, near[k]] = 1.0
        if cut == cuts - 1:
            balance(steps, contacts, parts, at, to, x, lanes)
            _end_failed(steps, parts.limit, time + dt, at, to, x, lanes)
            if len(history) > 0:
                _keep(x, history[sample + 1])
                kept = sample + 2
    for lane in range(lanes):
        table, used = end_all(contacts, lane, at, to, x, lane, table, used)
    return table[:used], kept


def run(
    row: BuildingRow, motions: GroundMotions, pace: StepCounts, keep: bool = False
) -> list[RowResponse]:
    """Responses of a row of buildings to motions from rest; states are kept of the first motion only.

    They are those at the samples of the motion, up to the end of one that fails.
    """
    at, to = row.places
    lanes = motions.acceleration.shape[1]
    x = np.concatenate([lanes_at_rest(at, [row.elements], lanes), np.zeros((to.rows - at.rows, lanes))])
    x[at.slow], x[at.meets], x[to.failed] = motions.slow, motions.meets, np.inf
    x[to.begin : to.end] = np.nan
    dt = motions.dt / pace.cuts
    steps = steps_of(row.elements, dt)
    short = steps_of(row.elements, dt / pace.substeps, row.contacts)
    history = np.empty((len(motions.acceleration) if keep else 0, to.rows))
    table, kept = _run(
        *(row.law, steps, short, row.parts, at, to, x, motions, pace.cuts, pace.substeps), history
    )
    table = table[np.lexsort((table[:, CONTACT], table[:, BEGIN]))]
    lines = (table[table[:, LANE] == lane] for lane in range(lanes))
    rows = named_rows(at, to)
    return [RowResponse(x[:, n], own, history[:kept], rows) for n, own in enumerate(lines)]
