"""Response of a row of buildings to motions, one or many at once, with impacts.

Every step is first taken without contacts, in all motions. Those that are near contact in it are
taken again, in shorter steps with contacts: their lanes are gathered, and scattered again
afterwards. No lane depends on another, so that a motion has the same bits alone and among others.
In lanes without contacts the same buildings move each alone.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.borrowed import borrowed
from stochlin.kernels.basics.compiled import by_pointer, called_once, compiled, entry
from stochlin.kernels.pounding.impacts import (
    IMPACT,
    LINES_PER_MOTION,
    PRESENT,
    ImpactTable,
    strike_all,
    watch_contacts,
)
from stochlin.kernels.simulation.account import (
    Parts,
    add_works,
    add_works_of_linked,
    balance,
    watch,
)
from stochlin.kernels.simulation.contacts import Contacts, stored_in
from stochlin.kernels.simulation.laws import VISCOUS
from stochlin.kernels.simulation.row_products import fill, products
from stochlin.kernels.simulation.state import Elements, State, copy, copy_all
from stochlin.kernels.simulation.time_step import Steps, step_of, steps_of


class BuildingRow(NamedTuple):
    """Buildings in a row."""

    elements: Elements
    law: Any  # the result of `laws.by_number`
    contacts: Contacts
    parts: Parts

    def at_rest(self, lanes: int) -> State:
        """Motions before their beginning."""
        sizes = self.contacts.gap.size, len(self.parts.watched), self.parts.spring.size
        return State.at_rest([self.elements], lanes, *sizes)

    def from_start(self, q: Array, v: Array) -> Array:
        """Block (rows,) of a motion that starts with these displacements [m] and velocities [m/s].

        Its springs have not slipped, and its contacts are open. Their energy counts as put in.
        """
        state = self.at_rest(1)
        system = self.elements.system
        masses = self.parts.mass.size
        springs = self.elements.kind != VISCOUS
        extension = np.where(springs, system.extensions @ q, 0.0)
        coordinates = state.coordinates
        coordinates.q[:, 0] = q
        coordinates.v[:, 0] = v
        coordinates.input_energy[:masses, 0] = 0.5 * self.parts.mass * v[:masses] ** 2
        owner = (system.extensions != 0).argmax(axis=1)
        np.add.at(coordinates.input_energy[:, 0], owner, 0.5 * system.elastic * extension**2)
        coordinates.drag[:masses, 0] = self.parts.damping @ v[:masses]
        state.elements.z[:, 0] = extension
        watch(steps_of(self.elements, 1.0), self.parts, state, 1)  # nothing moves in this step
        return state.block[:, 0].copy()


class StepCounts(NamedTuple):
    """The time steps of a run."""

    cuts: int  # steps in an interval of the motion
    substeps: int  # steps in each of them near contact


@borrowed
class GroundMotions(NamedTuple):
    """Ground motions with one time step, linear between their samples."""

    acceleration: Array  # (samples, lanes) [m/s^2]; zero after the end of a motion
    dt: float  # [s]
    intervals: Array  # (lanes,): number of intervals of each motion
    slow: Array  # (lanes,) [m/s]: rate of approach below which a contact is elastic
    meets: Array  # (lanes,): whether contacts act


class RowResponse(NamedTuple):
    """Response of a row of buildings to one motion."""

    end: State  # at the end of the motion
    impacts: Array  # a table of the type IMPACT, as they begin
    history: State  # over its samples, in place of motions, if they were asked for
    floors: int

    @property
    def peaks(self) -> Array:
        """Largest absolute displacement of each floor [m]."""
        return self.end.largest[: self.floors]

    def end_after(self, seconds: float) -> Array:
        """Block (rows,) at the end of a motion of this length, with times of impacts from there."""
        impacts = self.end.impacts
        impacts.begin[...] -= seconds
        impacts.end[...] -= seconds
        return self.end.block.copy()


class StepFunctions(NamedTuple):
    """The compiled functions of a step, by their pointers."""

    law: Any  # the result of `laws.by_number`
    slip: Any  # that of `step_of`
    step: Any  # `take_step`
    add_works: Any  # or `add_works_of_linked`
    meet: Any  # `watch_contacts` or `strike_all`
    watch: Any
    balance: Any


@borrowed
class RowSteps(NamedTuple):
    """The time steps of a row of buildings."""

    parts: Parts
    free: Steps  # without contacts
    near: Steps  # near contact, shorter ones
    cuts: int  # steps in an interval of the motion
    substeps: int  # steps near contact in each of them


@borrowed
class RowStates(NamedTuple):
    """The states of a row of buildings in all motions."""

    all: State
    before: Array  # (rows, lanes): before the step
    near: State  # of the motions near contact
    history: Array  # (rows, samples): of the first motion at its samples, if they were asked for


@called_once
def _near(contacts, dt, state, lanes, near):
    """Write the lanes that are in contact in the step, or may be; returns their number.

    The step was taken without contacts.

    Within a step the penetration is a parabola, which rises above the ends by an eighth of the
    change of the rate times ``dt`` at most.
    """
    motions = state.motions
    of_rows = state.products
    reach = state.totals.reach
    products(contacts.rows, state.coordinates.q, of_rows.q, lanes)
    products(contacts.rows, state.coordinates.dq, of_rows.dq, lanes)
    products(contacts.rows, state.coordinates.v, of_rows.v, lanes)
    fill(reach, -1.0, lanes)
    for j in range(contacts.gap.size):
        for lane in range(lanes):
            change = of_rows.dq[j, lane]
            bulge = 0.25 * abs(dt * of_rows.v[j, lane] - change)
            highest = of_rows.q[j, lane] + max(-change, 0.0) + bulge - contacts.gap[j]
            goes_on = not np.isnan(state.impacts.begin[j, lane])
            reach[lane] = max(reach[lane], 1.0 if goes_on else highest)
    count = 0
    for lane in range(lanes):
        if reach[lane] > 0.0 and motions.active[lane] * motions.meets[lane] > 0.0:
            near[count] = lane
            count += 1
    return count


@compiled
def _set_forcing(acceleration, sample, share, members, forcing, lanes):
    """Write the forcing at a share of an interval of the motion, in these lanes."""
    for k in range(lanes):
        lane = members[k]
        rise = acceleration[sample + 1, lane] - acceleration[sample, lane]
        forcing[k] = -(acceleration[sample, lane] + share * rise)


@called_once
def _end(intervals, sample, motions, lanes, ended):
    """Find the motions that have ended by a sample; returns their number."""
    count = 0
    for lane in range(lanes):
        goes = sample < intervals[lane] and motions.failed[lane] == np.inf
        motions.active[lane] = 1.0 if goes else 0.0
        if not goes:
            ended[count] = lane
            count += 1
    return count


@entry
def _run(functions, steps, ground, states, table):
    """All motions from their beginning, see `follow`."""
    state = states.all
    near_state = states.near
    history = states.history
    cuts = steps.cuts
    dt = steps.free.dt
    lanes = ground.acceleration.shape[1]
    all_lanes = np.arange(lanes)
    near = np.empty(lanes, np.int64)
    ended = np.empty(lanes, np.int64)
    copy(state.block, all_lanes, history, all_lanes, min(1, history.shape[1]))
    for s in range(cuts * (len(ground.acceleration) - 1)):
        sample = s // cuts
        cut = s % cuts
        time = s * dt
        ends = _end(ground.intervals, sample, state.motions, lanes, ended)
        if ends == lanes:
            break
        copy_all(state.block, states.before)
        share = (cut + 0.5) / cuts
        _set_forcing(ground.acceleration, sample, share, all_lanes, state.motions.forcing, lanes)
        functions.step(functions.slip, functions.law, steps.free, state, lanes)
        count = _near(steps.near.contacts, dt, state, lanes, near)
        functions.add_works(steps.free, steps.parts, state, lanes)
        functions.watch(steps.free, steps.parts, state, lanes)
        if count > 0:
            copy(states.before, near, near_state.block, all_lanes, count)
            for part in range(steps.substeps):
                share = (cut + (part + 0.5) / steps.substeps) / cuts
                _set_forcing(
                    ground.acceleration, sample, share, near, near_state.motions.forcing, count
                )
                functions.step(functions.slip, functions.law, steps.near, near_state, count)
                functions.add_works(steps.near, steps.parts, near_state, count)
                begin = time + part * steps.near.dt
                functions.meet(steps.near, steps.parts, begin, near, count, near_state, table)
                functions.watch(steps.near, steps.parts, near_state, count)
            copy(near_state.block, all_lanes, state.block, near, count)
        copy(states.before, ended, state.block, ended, ends)
        if cut == cuts - 1:
            functions.balance(steps.near, steps.parts, time + dt, state, lanes)
            if history.shape[1] > 0:
                for row in range(len(history)):
                    history[row, sample + 1] = state.block[row, 0]


def _functions(row: BuildingRow, steps: RowSteps, states: RowStates, table: ImpactTable) -> Any:
    """The functions of the steps of a row of buildings."""
    near = steps.near
    state = states.near
    lanes = state.block.shape[1]
    numbers = np.zeros(lanes, np.int64)
    step, slip = step_of(row.law, near, state, lanes)
    adder = add_works_of_linked if row.parts.spring.size else add_works
    meet = strike_all if row.contacts.jumps else watch_contacts
    return StepFunctions(
        law=row.law,
        slip=slip,
        step=step,
        add_works=by_pointer(adder, near, row.parts, state, lanes),
        meet=by_pointer(meet, near, row.parts, 0.0, numbers, lanes, state, table),
        watch=by_pointer(watch, near, row.parts, state, lanes),
        balance=by_pointer(balance, near, row.parts, 0.0, state, lanes),
    )


def _last_impacts(contacts: Contacts, state: State) -> Array:
    """The lines of the impacts that go on at the end of the motions."""
    j, lane = np.nonzero(~np.isnan(state.impacts.begin))
    depth = (contacts.weights[j] * state.coordinates.q[:, lane].T).sum(axis=1) - contacts.gap[j]
    laws = zip(contacts.law[j], depth, strict=True)
    lines = np.empty(j.size, IMPACT)
    for name in PRESENT:
        lines[name] = getattr(state.impacts, name)[j, lane]
    lines["motion"] = lane
    lines["contact"] = j
    lines["stored"] = [0.0 if contacts.jumps else stored_in(law, d) for law, d in laws]
    return lines


def follow(
    row: BuildingRow, state: State, ground: GroundMotions, pace: StepCounts, history: Array
) -> Array:
    """Motions ``state`` (n lanes) that go on from this state, which is changed.

    The states of the first motion are written to ``history`` (rows, samples), if it has columns,
    NaN after the end of one that fails. Returns the table of `impacts`, as they begin.
    """
    lanes = ground.acceleration.shape[1]
    state.motions.least_approach[:] = ground.slow
    state.motions.meets[:] = ground.meets
    begin = state.block.copy()
    dt = ground.dt / pace.cuts
    states = RowStates(state, np.empty_like(begin), row.at_rest(lanes), history)
    steps = RowSteps(
        row.parts,
        free=steps_of(row.elements, dt),
        near=steps_of(row.elements, dt / pace.substeps, row.contacts),
        cuts=pace.cuts,
        substeps=pace.substeps,
    )
    table = ImpactTable(np.empty(LINES_PER_MOTION * lanes, IMPACT), np.zeros(1, np.int64))
    functions = _functions(row, steps, states, table)
    history[:] = np.nan
    _run(functions=functions, steps=steps, ground=ground, states=states, table=table)
    if table.number[0] > table.lines.size:  # the motions again, with lines for all impacts
        table = ImpactTable(np.empty(table.number[0], IMPACT), np.zeros(1, np.int64))
        state.block[:] = begin
        _run(functions=functions, steps=steps, ground=ground, states=states, table=table)
    lines = np.concatenate([table.lines[: table.number[0]], _last_impacts(row.contacts, state)])
    return lines[np.lexsort((lines["contact"], lines["begin"]))]


def run(
    row: BuildingRow,
    ground: GroundMotions,
    pace: StepCounts,
    keep: bool = False,
    start: Array | None = None,
) -> list[RowResponse]:
    """Responses of a row of buildings to motions; with the states of the first motion.

    They begin from rest, or from ``start`` (rows, lanes): blocks of `BuildingRow.from_start`, or of
    the ends of other motions.
    """
    samples, lanes = ground.acceleration.shape
    state = row.at_rest(lanes)
    if start is not None:
        state.block[:] = start
    history = row.at_rest(samples if keep else 0)
    impacts = follow(row, state, ground, pace, history.block)
    floors = len(row.parts.carried)
    return [
        RowResponse(state.of_lane(lane), impacts[impacts["motion"] == lane], history, floors)
        for lane in range(lanes)
    ]
