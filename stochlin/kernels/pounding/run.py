"""Response of a row of buildings to motions, one or many at once, with impacts.

Every step is first taken without contacts, in all motions. Those that are near contact in it are taken
again, in shorter steps with contacts: their lanes are gathered, and scattered again afterwards. No lane
depends on another, so that a motion has the same bits alone and among others. In lanes without contacts
the same buildings move each alone.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array, on_arrays
from stochlin.kernels.basics.compiled import called_often, compiled, entry
from stochlin.kernels.pounding.impacts import (
    BEGIN,
    COLUMNS,
    CONTACT,
    FIRST_LINES,
    LANE,
    SPAN,
    end_all,
    strike,
    watch_contact,
)
from stochlin.kernels.simulation.account import (
    COUNTS,
    FAILED,
    FIRST,
    SECOND,
    THIRD,
    Account,
    Parts,
    balance,
    copy_account,
    watch,
    watch_displacements,
)
from stochlin.kernels.simulation.contacts import Contacts
from stochlin.kernels.simulation.time_step import (
    CHANGE,
    DQ,
    MEETS,
    SLOW,
    Elements,
    F,
    Moving,
    Q,
    V,
    copy,
    copy_state,
    fill,
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

    def at_rest(self, lanes: int) -> Motions:
        """Motions before their beginning."""
        count = self.contacts.gap.size
        moving = Moving.at_rest([self.elements], lanes, count)
        impacts = np.full((count, SPAN + 1, lanes), np.nan)
        return Motions(moving, Account.of(self.parts, lanes), impacts)


class Motions(NamedTuple):
    """All that is known of every motion (the last axis)."""

    moving: Moving
    account: Account
    impacts: Array  # (c, columns, lanes): the present impact of each contact, see `impacts`


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

    moving: Moving  # at its end
    account: Account
    impacts: Array  # (impacts, COLUMNS): the table of `impacts`, as they begin
    history: Motions  # over its samples, in place of motions, if they were asked for

    @property
    def peaks(self) -> Array:
        """Largest absolute displacement of each floor [m]."""
        return self.account.largest[: len(self.account.floors)]


@called_often
def _near(contacts, dt, x, lanes, near):
    """Find the lanes that are in contact in the step taken without it, or may be.

    Within a step the penetration is a parabola, which rises above the ends by an eighth of the change of
    the rate times ``dt`` at most. Lanes are written to ``near``, and do not count; returns their number.
    """
    count, gap, (column, weight) = 0, contacts.gap, contacts.rows
    coordinates, meets, motions = x.moving.coordinates, x.moving.motions, x.account.motions
    fill(motions, THIRD, -1.0, lanes)
    for j in range(gap.size):
        times_row(column, weight, j, coordinates, Q, motions, FIRST, lanes)
        times_row(column, weight, j, coordinates, DQ, meets, CHANGE, lanes)
        times_row(column, weight, j, coordinates, V, motions, SECOND, lanes)
        for lane in range(lanes):
            change = meets[CHANGE, lane]
            bulge = 0.25 * abs(dt * motions[SECOND, lane] - change)
            highest = motions[FIRST, lane] + max(-change, 0.0) + bulge - gap[j]
            reach = highest if np.isnan(x.impacts[j, BEGIN, lane]) else 1.0
            motions[THIRD, lane] = max(motions[THIRD, lane], reach)
    for lane in range(lanes):
        if motions[THIRD, lane] > 0.0 and motions[COUNTS, lane] * meets[MEETS, lane] > 0.0:
            motions[COUNTS, lane] = 0.0
            near[count] = lane
            count += 1
    return count


@compiled
def _end_failed(steps, limit, time, coordinates, motions, lanes):
    """End the motions in which an extension is beyond its limit, or not a number."""
    column, weight = steps.extensions
    for i in range(limit.size):
        times_row(column, weight, i, coordinates, Q, motions, FIRST, lanes)
        for lane in range(lanes):
            if not abs(motions[FIRST, lane]) <= limit[i] and motions[FAILED, lane] == np.inf:
                motions[FAILED, lane] = time


@compiled
def _keep(x, history, sample):
    """Keep what is known of the first motion at a sample."""
    first, place = np.zeros(1, np.int64), np.full(1, sample)
    copy_state(x.moving, first, history.moving, place, 1)
    copy_account(x.account, first, history.account, place, 1)


@compiled
def _set_forcing(ground, sample, share, of, motions, lanes):
    """Write the forcing at a share of an interval of the motion, in the lanes ``of``."""
    for k in range(lanes):
        lane = of[k]
        rise = ground[sample + 1, lane] - ground[sample, lane]
        motions[F, k] = -(ground[sample, lane] + share * rise)


@compiled
def _count_going(intervals, sample, motions, lanes):
    """Mark the motions that go on, in which steps count; returns their number."""
    going = 0
    for lane in range(lanes):
        goes = sample < intervals[lane] and motions[FAILED, lane] == np.inf
        motions[COUNTS, lane] = 1.0 if goes else 0.0
        going += goes
    return going


@called_often
def _keep_ended(old, x, lanes, ended):
    """Leave motions that have ended as they were before the step."""
    count = 0
    for lane in range(lanes):
        if x.account.motions[COUNTS, lane] == 0.0:
            ended[count] = lane
            count += 1
    copy_state(old, ended, x.moving, ended, count)


@called_often
def _watch_impacts(short, parts, time, near, count, y, table, used):
    """Update the impacts in all lanes near contact by a step; returns the table and its lines in use."""
    for k in range(count):
        if short.contacts.jumps:
            table, used = strike(short, parts, time, near[k], y, k, table, used)
        else:
            for j in range(short.contacts.gap.size):
                table, used = watch_contact(short, j, time, near[k], y, k, table, used)
    return table, used


@entry
def _run(law, steps, short, parts, x, old, y, ground, cuts, substeps, history):
    """All motions ``x`` from their beginning, see `run`; ``steps`` are without contacts, ``short`` with.

    ``old`` and ``y`` are for what moves before a step and near contact. The first motion is kept at the
    samples in ``history``, if it has any. Returns the table of impacts and the number of samples kept.
    """
    dt, contacts, acceleration = steps.dt, short.contacts, ground.acceleration
    lanes, samples = acceleration.shape[1], history.account.motions.shape[1]
    moving, account = x.moving, x.account
    every, near = np.arange(lanes), np.empty(lanes, np.int64)
    table, used, kept = np.empty((FIRST_LINES, COLUMNS)), 0, 1
    tolerances(steps.spring, steps.kind, moving.elements, lanes)
    tolerances(short.spring, short.kind, y.moving.elements, lanes)
    if samples > 0:
        _keep(x, history, 0)
    for s in range(cuts * (len(acceleration) - 1)):
        sample, cut, time = s // cuts, s % cuts, s * dt
        going = _count_going(ground.intervals, sample, account.motions, lanes)
        if going == 0:
            break
        copy_state(moving, every, old, every, lanes)
        _set_forcing(acceleration, sample, (cut + 0.5) / cuts, every, moving.motions, lanes)
        take_step(law, steps, moving, lanes)
        if going < lanes:
            _keep_ended(old, x, lanes, near)
        count = _near(contacts, dt, x, lanes, near)
        watch(steps, parts, moving, account, lanes)
        watch_displacements(dt, parts, moving, account, lanes)
        if count > 0:
            copy_state(old, near, y.moving, every, count)
            copy_account(account, near, y.account, every, count)
            copy(x.impacts, near, y.impacts, every, count, SPAN + 1)
            for k in range(count):
                y.moving.motions[SLOW, k] = moving.motions[SLOW, near[k]]
            fill(y.account.motions, COUNTS, 1.0, count)
            for part in range(substeps):
                now = time + part * short.dt
                within = (cut + (part + 0.5) / substeps) / cuts
                _set_forcing(acceleration, sample, within, near, y.moving.motions, count)
                take_step(law, short, y.moving, count)
                watch(short, parts, y.moving, y.account, count)
                table, used = _watch_impacts(short, parts, now, near, count, y, table, used)
                watch_displacements(short.dt, parts, y.moving, y.account, count)
            copy_state(y.moving, every, moving, near, count)
            copy_account(y.account, every, account, near, count)
            copy(y.impacts, every, x.impacts, near, count, SPAN + 1)
            for k in range(count):
                account.motions[COUNTS, near[k]] = 1.0
        if cut == cuts - 1:
            balance(steps, contacts, parts, moving, account, lanes)
            _end_failed(steps, parts.limit, time + dt, moving.coordinates, account.motions, lanes)
            if samples > 0:
                _keep(x, history, sample + 1)
                kept = sample + 2
    for lane in range(lanes):
        table, used = end_all(contacts, lane, moving, x.impacts, lane, table, used)
    return table[:used], kept


def run(
    row: BuildingRow, ground: GroundMotions, pace: StepCounts, keep: bool = False
) -> list[RowResponse]:
    """Responses of a row of buildings to motions from rest; states are kept of the first motion only.

    They are those at the samples of the motion, NaN after the end of one that fails.
    """
    samples, lanes = ground.acceleration.shape
    x, y, history = (row.at_rest(count) for count in (lanes, lanes, samples if keep else 0))
    x.moving.motions[SLOW], x.moving.motions[MEETS] = ground.slow, ground.meets
    dt = ground.dt / pace.cuts
    steps = steps_of(row.elements, dt)
    short = steps_of(row.elements, dt / pace.substeps, row.contacts)
    old = Moving.at_rest([row.elements], lanes, row.contacts.gap.size)
    table, kept = _run(
        row.law, steps, short, row.parts, x, old, y, ground, pace.cuts, pace.substeps, history
    )
    table = table[np.lexsort((table[:, CONTACT], table[:, BEGIN]))]
    for values in (*history.moving, *history.account):
        values[..., kept:] = np.nan

    def of(lane: int) -> RowResponse:
        """The response to the motion of a lane."""
        end = on_arrays(lambda values: values[..., lane], x)
        return RowResponse(end.moving, end.account, table[table[:, LANE] == lane], history)

    return [of(lane) for lane in range(lanes)]
