"""Pounding in simulated motions, beside which the formulas stand."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stochlin.analyses.linearization.state_space import ground_matrices
from stochlin.analyses.linearization.transient_systems import Course, Side
from stochlin.analyses.simulation.ensembles import Cells, joined_laws, prepare
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress
from stochlin.kernels.simulation.separation_histories import Histories, Watched, separation_histories
from stochlin.kernels.simulation.stepping import LANES, filter_steps
from stochlin.models.grounds import Ground

STEPS_PER_PERIOD = 32


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
    columns = np.concatenate([side.columns[:4] for side in sides], axis=1)
    parameters = np.concatenate([side.ground for side in sides], axis=1)
    if (parameters[1:] != parameters[1:, :1]).any():
        raise ValueError(
            "ground has several periods or dampings; a simulation is of one ground, whose intensity "
            "alone may vary: simulate one ground at a time"
        )
    amplitude = np.sqrt(parameters[0] / parameters[0, 0])
    period, damping, hardening, uy = columns
    lone = ground.isel({name: slice(0, 1) for name in _dimensions(ground)})
    cells = Cells(
        period,
        damping,
        hardening,
        uy / amplitude,
        joined_laws([side.columns[5:].T for side in sides]),
        np.concatenate([np.full(side.columns.shape[1], side.structure.block()) for side in sides]),
        1 / (damping * 2 * np.pi / period),
        np.zeros(period.size),
        np.ones(period.size, bool),
    )
    run = prepare(cells, lone, paths=paths, seed=seed, steps_per_period=STEPS_PER_PERIOD)
    blocks = course.shown.size - 1
    samples = int(np.ceil(course.duration / blocks / run.plan.dt))
    dt = course.duration / blocks / samples
    _, matrix, noise, output = ground_matrices(list(parameters[:, 0]))
    steps = filter_steps(matrix, noise, output, 2 * np.pi * parameters[0, 0], dt)
    plan = run.plan._replace(dt=dt, every=1, samples=samples)
    middle = dt * (np.arange(blocks * samples) + 0.5)
    shape = np.ones_like(middle) if course.envelope is None else course.envelope.at(middle)
    metres = run.scale * amplitude
    one, two = pairs
    watched = Watched(run.order[one], run.order[two], metres[one], metres[two], *gaps)
    return separation_histories(run.crowd, steps, run.root, plan, shape, watched, progress)


def motions(paths: int) -> int:
    """How many motions are run for so many paths: whole groups of them."""
    return int(np.ceil(paths / LANES)) * LANES


def _dimensions(ground: Ground) -> set[str]:
    return {str(dim) for array in ground.arrays().values() for dim in array.dims}
