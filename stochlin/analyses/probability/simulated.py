"""Pounding in simulated motions, beside which the formulas stand."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stochlin.analyses.linearization.transient_systems import Course, Side, grounds_of, oscillators_of
from stochlin.analyses.simulation.ensembles import SimulationCells, joined_laws, prepare, seconds_of
from stochlin.analyses.tables.work import check_work
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress
from stochlin.kernels.simulation.separation_histories import Histories, Watched, separation_histories
from stochlin.kernels.simulation.stepping import LANES, filter_steps
from stochlin.models.grounds import Ground

STEPS_PER_PERIOD = 32
ENVELOPES, RESULTS = 6, 6  # numbers that are held at once, of each step and of each motion of a pair
WATCHED = 200.0  # to watch a pair, over the time that its difference alone takes


def simulate_course(
    sides: Sequence[Side],
    pairs: Array,
    gaps: tuple[Array, Array],
    ground: Ground,
    course: Course,
    paths: int,
    seed: int,
    progress: Progress | None,
) -> Histories:
    """All pairs (2, p) on the same motions, at the instants of the result.

    ``gaps`` are gaps [m] and the pair of each. Intensities may differ from cell to cell: a structure
    under ``a`` times the motion is one of strength ``uy/a`` whose displacement is multiplied by ``a``.
    """
    below = grounds_of(sides)
    if any((row != row[0]).any() for name, row in below.items() if name != "intensity"):
        raise ValueError(
            "ground has several periods or dampings; a simulation is of one ground, whose intensity "
            "alone may vary: simulate one ground at a time"
        )
    amplitude = np.sqrt(below["intensity"] / below["intensity"][0])
    period, damping, hardening, uy, _ = oscillators_of(sides)
    dims = [array.dims for array in ground.arrays().values()]
    lone = ground.isel({name: slice(0, 1) for name in set().union(*dims)})
    cells = SimulationCells(
        period,
        damping,
        hardening,
        uy / amplitude,
        joined_laws([side.law.T for side in sides]),
        np.concatenate([np.full(side.cells.period.size, side.structure.block()) for side in sides]),
        1 / (damping * 2 * np.pi / period),
        np.zeros(period.size),
        np.ones(period.size, bool),
    )
    run = prepare(cells, lone, paths=paths, seed=seed, steps_per_period=STEPS_PER_PERIOD)
    pairs_in_all, instants = pairs.shape[1], course.duration / run.plan.dt
    check_work(
        f"duration = {course.duration:g} s, in steps of {run.plan.dt:.2g} s and on "
        f"{whole_groups(paths)} paths, would take",
        "shorten it, lower paths, or leave out the shortest period",
        memory=8 * (ENVELOPES * instants + RESULTS * float(whole_groups(paths)) * pairs_in_all),
        seconds=seconds_of(run, instants, WATCHED * pairs_in_all),
    )
    blocks = course.shown.size - 1
    samples = int(np.ceil(course.duration / blocks / run.plan.dt))
    dt = course.duration / blocks / samples
    soil = ground.filter({name: float(row[0]) for name, row in below.items()})
    steps = filter_steps(*soil.arrays, 2 * np.pi * soil.intensity, dt)
    plan = run.plan._replace(dt=dt, every=1, samples=samples)
    middle = dt * (np.arange(blocks * samples) + 0.5)
    shape = np.ones_like(middle) if course.envelope is None else course.envelope.at(middle)
    metres = run.scale * amplitude
    one, two = pairs
    watched = Watched(run.order[one], run.order[two], metres[one], metres[two], *gaps)
    return separation_histories(run.crowd, steps, run.root, plan, shape, watched, progress)


def whole_groups(paths: int) -> int:
    """How many motions are run for so many paths: whole groups of them."""
    return int(np.ceil(paths / LANES)) * LANES
