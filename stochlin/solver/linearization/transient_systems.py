"""Linearized systems in motions of finite length: the instants, and the moments at these."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress
from stochlin.kernels.linearization.systems.springs import Springs
from stochlin.kernels.linearization.transient import PHASE, TransientMoments, TransientSystems
from stochlin.models.envelopes import Envelope, envelope_at
from stochlin.models.systems import Assembly
from stochlin.solver.tables import labels
from stochlin.solver.tables.checks import check_duration, check_work

INSTANTS_PER_PERIOD = 16  # instants in the shortest period, for integrals over time
STRONG_SHARE = 0.5  # share of the envelope's maximum below which shaking is no longer strong
SCANNED = 4096  # instants at which an envelope is evaluated for checks
NUMBERS_PER_INSTANT = 4  # numbers that are stored for each sum or element of a cell at an instant
POINTS = 101  # instants of a result
TIME = "time"


class TimeGrid(NamedTuple):
    """The instants of a finite motion."""

    envelope: Envelope | None
    duration: float
    times: Array  # [s], for integrals over time
    shown: Array  # indices of the instants of the result
    strong_end: float  # end of the strong shaking [s]

    def values(self, times: Array) -> Array:
        """Values of the envelope at times [s]."""
        return envelope_at(self.envelope, times)


def check_course(duration: float | None, envelope: Envelope | None) -> float:
    """The duration [s], checked together with the envelope."""
    seconds = check_duration(duration)
    if envelope is None:
        return seconds
    values = np.asarray(envelope.at(np.linspace(0, seconds, SCANNED)), float)
    if not np.isfinite(values).all() or values.min() < 0:
        what = (
            f"envelope = {envelope.describe()} is {values[~(values >= 0)][0]:g} within the duration"
        )
        raise ValueError(f"{what}; allowed: finite values from 0 on")
    if not values.max() > 0:
        what = f"envelope = {envelope.describe()} is 0 during the whole duration = {seconds:g}"
        raise ValueError(f"{what}; allowed: positive values")
    return seconds


def course_of(envelope: Envelope | None, duration: float, shortest: float, points: int) -> TimeGrid:
    """Instants of a motion, close enough for integrals over time with the shortest period."""
    stretches = points - 1
    instants = duration * INSTANTS_PER_PERIOD / shortest
    check_work(
        f"duration = {duration:g} s, with a shortest period of {shortest:.3g} s, would take",
        "shorten it, or leave out the shortest period",
        numbers=NUMBERS_PER_INSTANT * instants,
        seconds=1e-4 * instants,
    )
    steps = max(1, int(np.ceil(instants / stretches)))
    times = np.linspace(0, duration, stretches * steps + 1)
    shown = np.arange(points) * steps
    scan = np.linspace(0, duration, SCANNED)
    values = envelope_at(envelope, scan)
    strong = np.flatnonzero(values >= STRONG_SHARE * values.max())
    last = duration if strong[-1] == SCANNED - 1 else float(scan[strong[-1] + 1])
    return TimeGrid(envelope, float(duration), times, shown, last)


def solve_course(
    system: Assembly,
    problem: Springs,
    rows: Array,
    course: TimeGrid,
    shortest: float,
    progress: Progress | None = None,
) -> TransientMoments:
    """Second moments of sums of coordinates with weights ``rows`` (k, n), from rest on.

    ``shortest`` is the shortest first period of all structures [s]. ``progress`` is called with the
    share of the duration that is done.
    """
    cells = problem.level.size
    limits = [np.broadcast_to(s.limits, (cells, s.coordinates)) for s in system.sticks]
    systems = TransientSystems(
        problem,
        np.concatenate(limits, axis=1),
        2 * np.pi / shortest,
        lambda time: float(course.values(np.array(time))),
    )
    states = systems.matrix.shape[1]
    check_work(
        f"{cells} systems at {course.times.size} instants, with {states} states, would take",
        "take fewer cells at a time, storeys together, or a shorter motion",
        numbers=NUMBERS_PER_INSTANT * course.times.size * cells * (len(rows) + len(system.springs)),
        seconds=8e-11 * 4 / PHASE * course.duration * systems.followed * cells * states**3,
    )
    kinks = () if course.envelope is None else course.envelope.kinks()
    return systems.solve(course.times, rows, kinks, progress)


def over_time(table: xr.Dataset, course: TimeGrid, *, drifts: bool = False) -> xr.Dataset:
    """The table with the times, the envelope, and a flag for the end of the strong shaking.

    With a closure that ``drifts`` there is no flag, since the permanent set is represented.
    """
    time = labels.axis(TIME, "time", course.times[course.shown], "s")
    flag = {
        "long_name": f"envelope finally below {STRONG_SHARE:g} of its maximum",
        "flag_values": np.arange(2, dtype=np.int8),
        "flag_meanings": "strong_shaking permanent_set_is_left_out",
    }
    columns: dict[str, Any] = {"envelope": ("time", course.values(time.to_numpy()))}
    if not drifts:
        over = (time.values > course.strong_end).astype(np.int8)
        columns["permanent_set_left_out"] = "time", over, flag
    return (
        table.assign(columns)
        .assign_coords(time=time)
        .assign_attrs(
            duration_s=course.duration,
            envelope_model="none" if course.envelope is None else course.envelope.describe(),
            strong_shaking_end_s=course.strong_end,
        )
    )
