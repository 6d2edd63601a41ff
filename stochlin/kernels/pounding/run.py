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
from stochlin.kernels.basics.compiled import by_pointer, called_once, compiled, entry
from stochlin.kernels.pounding.impacts import (
    COLUMNS,
    CONTACT,
    LANE,
    LINES,
    strike_all,
    watch_contacts,
)
from stochlin.kernels.simulation.account import Parts, balance, watch, watch_linked
from stochlin.kernels.simulation.contacts import Contacts, stored_in
from stochlin.kernels.simulation.moving import (
    BEGIN,
    DEEPEST,
    DQ,
    FAILED,
    FIRST,
    GOES,
    MEETS,
    OF_DQ,
    OF_Q,
    OF_V,
    SLOW,
    Elements,
    F,
    Moving,
    Q,
    V,
    copy,
    fill,
    products,
)
from stochlin.kernels.simulation.time_step import step_of, steps_of


class BuildingRow(NamedTuple):
    """Buildings in a row."""

    elements: Elements
    law: Any  # the result of `laws.by_number`
    contacts: Contacts
    parts: Parts

    def at_rest(self, lanes: int) -> Moving:
        """Motions before their beginning."""
        sizes = self.contacts.gap.size, len(self.parts.watched), self.parts.spring.size
        return Moving.at_rest([self.elements], lanes, *sizes)


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
    impacts: Array  # (impacts, COLUMNS): the table of `impacts`, as they begin
    history: Moving  # over its samples, in place of motions, if they were asked for
    floors: int

    @property
    def peaks(self) -> Array:
        """Largest absolute displacement of each floor [m]."""
        return self.moving.largest[: self.floors]


@called_once
def _near(contacts, dt, moving, lanes, near):
    """Write the lanes that are in contact in the step taken without it, or may be; returns their number.

    Within a step the penetration is a parabola, which rises above the ends by an eighth of the change of
    the rate times ``dt`` at most.
    """
    count, gap, rows = 0, contacts.gap, contacts.rows
    motions, of_rows = moving.motions, moving.products
    products(rows, moving.coordinates, Q, of_rows, OF_Q, lanes)
    products(rows, moving.coordinates, DQ, of_rows, OF_DQ, lanes)
    products(rows, moving.coordinates, V, of_rows, OF_V, lanes)
    fill(motions, FIRST, -1.0, lanes)
    for j in range(gap.size):
        for lane in range(lanes):
            change = of_rows[j, OF_DQ, lane]
            bulge = 0.25 * abs(dt * of_rows[j, OF_V, lane] - change)
            highest = of_rows[j, OF_Q, lane] + max(-change, 0.0) + bulge - gap[j]
            reach = highest if np.isnan(moving.contacts[j, BEGIN, lane]) else 1.0
            motions[FIRST, lane] = max(motions[FIRST, lane], reach)
    for lane in range(lanes):
        if motions[FIRST, lane] > 0.0 and motions[GOES, lane] * motions[MEETS, lane] > 0.0:
            near[count] = lane
            count += 1
    return count


@compiled
def _set_forcing(ground, sample, share, of, motions, lanes):
    """Write the forcing at a share of an interval of the motion, in the lanes ``of``."""
    for k in range(lanes):
        lane = of[k]
        rise = ground[sample + 1, lane] - ground[sample, lane]
        motions[F, k] = -(ground[sample, lane] + share * rise)


@called_once
def _end(intervals, sample, motions, lanes, ended):
    """Find the motions that have ended by a sample; returns their number."""
    count = 0
    for lane in range(lanes):
        goes = sample < intervals[lane] and motions[FAILED, lane] == np.inf
        motions[GOES, lane] = 1.0 if goes else 0.0
        if not goes:
            ended[count] = lane
            count += 1
    return count


@entry
def _run(
    step,
    look,
    meet,
    settle,
    other,
    law,
    steps,
    short,
    parts,
    x,
    y,
    old,
    ground,
    intervals,
    cuts,
    substeps,
    table,
    used,
    history,
):
    """All motions ``x`` from their beginning, see `follow`; ``steps`` are without contacts.

    The first arguments are the functions of a step, ``short`` are steps with contacts, and ``old`` and
    ``y`` are for the states before a step and for what moves near contact. The first motion is written
    at the samples to ``history``, if it has any.
    """
    lanes = ground.shape[1]
    every, near, ended = np.arange(lanes), np.empty(lanes, np.int64), np.empty(lanes, np.int64)
    copy(x.state, every, history, every, min(1, history.shape[1]))
    for s in range(cuts * (len(ground) - 1)):
        sample, cut, time = s // cuts, s % cuts, s * steps.dt
        over = _end(intervals, sample, x.motions, lanes, ended)
        if over == lanes:
            break
        copy(x.state, every, old, every, lanes)
        _set_forcing(ground, sample, (cut + 0.5) / cuts, every, x.motions, lanes)
        step(other, law, steps, x, lanes)
        count = _near(short.contacts, steps.dt, x, lanes, near)
        look(steps, parts, x, lanes)
        if count > 0:
            copy(old, near, y.state, every, count)
            for part in range(substeps):
                within = (cut + (part + 0.5) / substeps) / cuts
                _set_forcing(ground, sample, within, near, y.motions, count)
                step(other, law, short, y, count)
                look(short, parts, y, count)
                meet(short, parts, time + part * short.dt, near, count, y, table, used)
            copy(y.state, every, x.state, near, count)
        copy(old, ended, x.state, ended, over)
        if cut == cuts - 1:
            settle(short, parts, time + steps.dt, x, lanes)
            if history.shape[1] > 0:
                for row in range(len(history)):
                    history[row, sample + 1] = x.state[row, 0]


def _last_impacts(contacts: Contacts, x: Moving) -> Array:
    """The lines of the impacts that go on at the end of the motions."""
    j, lane = np.nonzero(~np.isnan(x.contacts[:, BEGIN]))
    depth = (contacts.weights[j] * x.coordinates[:, Q, lane].T).sum(axis=1) - contacts.gap[j]
    laws = zip(contacts.law[j], depth, strict=True)
    stored = [0.0 if contacts.jumps else stored_in(law, d) for law, d in laws]
    return np.column_stack([x.contacts[j, : DEEPEST + 1, lane], lane, j, stored])


def follow(row: BuildingRow, x: Moving, ground: GroundMotions, pace: StepCounts, history: Array) -> Any:
    """Motions ``x`` (n lanes) from their state on, which is changed.

    The states of the first motion are written to ``history`` (rows, samples), if it has columns, NaN
    after the end of one that fails. Returns the table of `impacts`, as they begin.
    """
    lanes = ground.acceleration.shape[1]
    x.motions[SLOW], x.motions[MEETS], begin = ground.slow, ground.meets, x.state.copy()
    y, old, dt = row.at_rest(lanes), np.empty_like(begin), ground.dt / pace.cuts
    steps = steps_of(row.elements, dt)
    short = steps_of(row.elements, dt / pace.substeps, row.contacts)
    table, used = np.empty((LINES * lanes, COLUMNS)), np.zeros(1, np.int64)
    known = short, row.parts, 0.1, used, lanes, y, table, used
    step, other = step_of(row.law, short, y, lanes)
    functions = (
        step,
        by_pointer(watch_linked if row.parts.spring.size else watch, short, row.parts, y, lanes),
        by_pointer(strike_all if row.contacts.jumps else watch_contacts, *known),
        by_pointer(balance, short, row.parts, 0.1, y, lanes),
    )
    history[:] = np.nan
    numbers = ground.acceleration, ground.intervals, pace.cuts, pace.substeps
    moves = *functions, other, row.law, steps, short, row.parts, x, y, old, *numbers
    _run(*moves, table, used, history)
    if used[0] > len(table):  # the motions again, with lines for all impacts
        table, x.state[:], used[:] = np.empty((used[0], COLUMNS)), begin, 0
        _run(*moves, table, used, history)
    table = np.concatenate([table[: used[0]], _last_impacts(row.contacts, x)])
    return table[np.lexsort((table[:, CONTACT], table[:, BEGIN]))]


def run(
    row: BuildingRow, ground: GroundMotions, pace: StepCounts, keep: bool = False
) -> list[RowResponse]:
    """Responses of a row of buildings to motions from rest; with the states of the first motion."""
    samples, lanes = ground.acceleration.shape
    x, history = row.at_rest(lanes), row.at_rest(samples if keep else 0)
    table, floors = follow(row, x, ground, pace, history.state), len(row.parts.shear_of_q)

    def of(lane: int) -> RowResponse:
        """The response to the motion of a lane."""
        end = on_arrays(lambda values: values[..., lane], x)
        return RowResponse(end, table[table[:, LANE] == lane], history, floors)

    return [of(lane) for lane in range(lanes)]
