"""Response of a row of buildings to one motion, in the row and each alone, and its expected cost."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stochlin.analyses.pounding.rows import Building
from stochlin.analyses.tables.work import check_work
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import cores
from stochlin.kernels.pounding import run as kernel
from stochlin.kernels.pounding.rows import Row, sizes_of
from stochlin.kernels.records.runs import SampledGround
from stochlin.models.buildings import ShearBuilding

STEP, STEPS_PER_PERIOD = 2.5e-6, 10.0  # computing time of a step and floor [s]; steps in a period
ON_GRID = 1e-9  # share of a time step within which an output time counts as a sample of the record
HISTORIES = 4  # memory of a running motion per sample, in states
RUNS = 2  # number of runs for each motion, in the row and alone


def check_runs(structures: Sequence[Building], row: Row, grounds: Sequence[SampledGround]) -> None:
    """Raise a ValueError if the motions would take too much time or memory."""
    modes = [
        structure.periods() if isinstance(structure, ShearBuilding) else structure.arrays()["period"]
        for structure in structures
    ]
    shortest = min(float(periods.min()) for periods in modes)
    lengths = np.array([len(ground.acceleration) for ground in grounds])
    seconds = float(sum(ground.dt * (len(ground.acceleration) - 1) for ground in grounds))
    at_once = cores()
    each = STEP * sum(periods.size for periods in modes) * STEPS_PER_PERIOD * seconds / shortest
    many = f"{len(grounds)} motions, " if len(grounds) > 1 else ""
    check_work(
        f"{many}{seconds:g} s of motion, with a shortest period of {shortest:.3g} s, would take",
        f"take softer structures, or {'fewer motions' if many else 'a shorter record'}",
        memory=8.0 * HISTORIES * sizes_of(row)[-1] * float(np.sort(lengths)[-at_once:].sum()),
        seconds=each * max(1.0, RUNS / min(at_once, RUNS * len(grounds))),
    )


def in_row(
    structures: Sequence[Building], row: Row, ground: SampledGround, times: Array | None = None
) -> kernel.Run:
    """Response of the row to a motion, with states at ``times`` since its beginning [s].

    Without ``times`` the states are at the samples of the motion.
    """
    intervals = len(ground.acceleration) - 1
    if times is None:
        times = ground.dt * np.arange(intervals + 1)
    asked = _intervals(times, ground.dt, intervals)
    return _completed(structures, row, kernel.SampledMotion(*ground, *asked))


def alone(
    structures: Sequence[Building], row: Row, ground: SampledGround, sampled: bool = False
) -> kernel.Run:
    """Response of the same structures, each without neighbours, with states at the samples or none."""
    if sampled:
        return in_row(structures, kernel.standing_alone(row), ground)
    never = np.empty(0, np.int64), np.empty(0)
    return _completed(structures, kernel.standing_alone(row), kernel.SampledMotion(*ground, *never))


def _intervals(times: Array, dt: float, intervals: int) -> tuple[Array, Array]:
    """Number of the interval between samples, and time since the start of this interval [s].

    A time at a sample belongs to the interval that ends there.
    """
    scaled = times / dt
    whole = np.rint(scaled)
    scaled = np.where(np.abs(scaled - whole) < ON_GRID, whole, scaled)
    number = np.clip(np.ceil(scaled).astype(np.int64) - 1, 0, intervals - 1)
    share = np.clip(scaled - number, 0.0, 1.0)
    return number, share * dt


def _completed(structures: Sequence[Building], row: Row, motion: kernel.SampledMotion) -> kernel.Run:
    run = kernel.run(row, motion)
    _check_standing(structures, row, run)
    if run.completed:
        return run
    n = row.mass.size
    u, v = ([f"{value:.6g}" for value in run.last[part : part + n]] for part in (0, n))
    raise ArithmeticError(
        f"pound: the step from {run.time:.9g} s after the beginning could not be completed, after "
        f"{run.steps} steps; displacements of the floors [{', '.join(u)}] m, velocities "
        f"[{', '.join(v)}] m/s; use a softer or less damped contact or link, or a smaller restitution"
    )


def _check_standing(structures: Sequence[Building], row: Row, run: kernel.Run) -> None:
    """Raise an ArithmeticError if a storey with P-delta has drifted by more than its height."""
    for number, structure in enumerate(structures, start=1):
        if not isinstance(structure, ShearBuilding) or not structure.p_delta:
            continue
        u = run.last[row.first[number - 1] : row.first[number]]
        heights = structure.arrays()["heights"].to_numpy()
        excess = np.abs(np.diff(u, prepend=0.0)) / heights
        if excess.max() > 1:
            worst = int(np.argmax(excess))
            raise ArithmeticError(
                f"pound: structure {number} falls over: by {run.time:.4g} s after the beginning its "
                f"storey {worst + 1} has drifted by more than its height of {heights[worst]:g} m, "
                "since after yield the weight above takes more stiffness than it has; give it more "
                "hardening or strength, or a weaker motion"
            )
