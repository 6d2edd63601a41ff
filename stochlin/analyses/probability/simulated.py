"""Pounding of pairs of oscillators in simulated motions."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from stochlin.analyses.linearization.transient_systems import (
    StructureCells,
    TimeGrid,
    grounds_of,
    oscillators_of,
)
from stochlin.analyses.simulation.ensembles import (
    SimulationCells,
    SimulationRun,
    joined_laws,
    prepare,
    work_of,
)
from stochlin.analyses.simulation.finite_motions import finite_steps
from stochlin.analyses.simulation.views import view_of
from stochlin.analyses.tables.work import check_work
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress, cores
from stochlin.kernels.simulation.separation_histories import Histories, Watched, separation_histories
from stochlin.kernels.simulation.stepping import LANES
from stochlin.models.grounds import Ground

STEPS_PER_PERIOD = 32
ENVELOPES, RESULTS = 6, 6  # numbers in memory at once for each step, and for each motion and pair


class Draws(NamedTuple):
    """Number, seed and scatter of simulated motions."""

    paths: int
    seed: int
    scatter: float  # standard deviation of the logarithm of a random factor on each motion


def simulate_course(
    sides: Sequence[StructureCells],
    pairs: Array,
    gaps: tuple[Array, Array],
    ground: Ground,
    course: TimeGrid,
    draws: Draws,
    progress: Progress | None,
) -> Histories:
    """Simulated histories of pairs (2, p) under the same motions, at the instants of the result.

    ``gaps`` are gaps [m] and the number of the pair of each. Cells may have different intensities: the
    response to ``a`` times a motion is ``a`` times that of a structure with the strength ``uy/a`` to the
    motion.
    """
    below = grounds_of(sides)
    if any((row != row[0]).any() for name, row in below.items() if name != "intensity"):
        raise ValueError(
            "ground has several periods or damping ratios; allowed in a simulation: one ground, of "
            "which only the intensity is an array; simulate one ground at a time"
        )
    amplitude = np.sqrt(below["intensity"] / below["intensity"][0])
    period, damping, hardening, uy = oscillators_of(sides)
    dims = [array.dims for array in ground.arrays().values()]
    lone = ground.isel({name: slice(0, 1) for name in set().union(*dims)})
    cells = SimulationCells(
        period,
        damping,
        hardening,
        uy / amplitude,
        joined_laws([side.law.T for side in sides]),
        np.concatenate([np.full(side.period.size, side.stack.law.step(), object) for side in sides]),
        1 / (damping * 2 * np.pi / period),
        np.zeros(period.size),
        np.ones(period.size, bool),
    )
    run = prepare(cells, lone, steps_per_period=STEPS_PER_PERIOD, **draws._asdict())
    metres = run.scale * amplitude
    view_1, view_2 = (view_of([{int(n): 1.0} for n in side], run.order, metres) for side in pairs)
    watched = Watched(view_1, view_2, np.arange(pairs.shape[1]), *gaps)
    return histories_of(run, course, watched, progress)


def histories_of(
    run: SimulationRun, course: TimeGrid, watched: Watched, progress: Progress | None
) -> Histories:
    """Simulated histories of a run; the motions are those of `simulate` with the same seed."""
    paths, steps = run.plan.groups * LANES, course.duration / run.plan.dt
    count = len(watched.first.row)
    check_work(
        f"duration = {course.duration:g} s, in steps of {run.plan.dt:.2g} s and on {paths} paths, would "
        "take",
        "shorten it, lower paths, or leave out the shortest period",
        work_of(run, steps)
        | {
            "steps of a distance to gaps": steps * paths * count,
            "numbers": ENVELOPES * steps + RESULTS * float(paths) * count,
        },
        cores(),
    )
    plan, shape = finite_steps(run, course.duration, course.envelope)
    instants = course.times[course.shown] / plan.dt
    instants[-1] = shape.size
    return separation_histories(
        run.crowd, run.ground, run.root, plan, shape, instants, watched, progress
    )
