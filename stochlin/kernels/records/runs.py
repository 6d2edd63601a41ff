"""Response of oscillators and of pairs to records, on all cores: peaks and histories."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress, in_order
from stochlin.kernels.records.oscillator import LARGEST_PHASE_STEP, PEAKS, STATE, run

FINER_FOR_PAIRS = 2.0  # number of sub-steps of a pair over that of its stiffer structure alone
EACH = 20.0  # what a structure takes besides its sub-steps, in sub-steps
LEAST_SUBSTEPS = 1e5  # least number of sub-steps of a task, some milliseconds
MOST_TASKS = 1e4  # most tasks
NO_PATH = np.empty((0, STATE))


class SampledMotion(NamedTuple):
    """The samples of a ground motion, which is linear between them."""

    acceleration: Array  # (samples,) [m/s^2], finite
    dt: float  # time step [s]


def sub_steps(ground: SampledMotion, *sides: Array) -> Array:
    """Number of sub-steps (n,) in an interval of the ground, of structures or of pairs of them."""
    stiffest = np.max([parameters[:, 0] for parameters in sides], axis=0)
    finer = FINER_FOR_PAIRS if len(sides) == 2 else 1.0
    return np.maximum(1, np.ceil(finer * stiffest * ground.dt / LARGEST_PHASE_STEP).astype(int))


def work_of(ground: SampledMotion, *sides: Array) -> Array:
    """Work (n,) of the responses to a ground, in sub-steps."""
    return len(sides) * (len(ground.acceleration) * sub_steps(ground, *sides) + EACH)


def response(ground: SampledMotion, parameters: Array, refine: int, start: Array) -> Array:
    """States (times, STATE) of one structure from that at the start, as in `run`."""
    path = np.zeros((refine * (len(ground.acceleration) - 1) + 1, STATE))
    path[0] = start
    results = np.zeros((1, 1, PEAKS + STATE))
    results[0, 0, PEAKS:] = start
    run(*ground, parameters.reshape(1, 1, -1), np.array([refine]), results, path)
    return path


def peaks_on_records(
    grounds: Sequence[SampledMotion], *sides: Array, progress: Progress | None = None
) -> Array:
    """Peaks and last states of structures, or of pairs of them, (records, n, sides, PEAKS + STATE).

    A side has the parameters (n, 4) of its structures as in `run`. Both structures of a pair take
    the same sub-steps. A task is the response of a block of cells to a record.
    """
    cells = np.ascontiguousarray(np.stack(sides, axis=1))
    results = np.zeros((len(grounds), *cells.shape[:2], PEAKS + STATE))
    work = [work_of(ground, *sides) for ground in grounds]
    least = max(LEAST_SUBSTEPS, sum(substeps.sum() for substeps in work) / MOST_TASKS)
    tasks = [
        (number, cells_of)
        for number, substeps in enumerate(work)
        for cells_of in _blocks(substeps, least)
    ]

    def task(number: int) -> None:
        """A block of cells on one record."""
        record, block = tasks[number]
        ground = grounds[record]
        refine = np.ones(block.stop - block.start, int)
        if len(sides) == 2:
            refine = sub_steps(ground, *(parameters[block] for parameters in sides))
        run(*ground, cells[block], refine, results[record, block], NO_PATH)

    for _ in in_order(task, len(tasks), progress):
        pass
    return results


def _blocks(work: Array, least: float) -> list[slice]:
    """Consecutive cells with about the ``least`` sum of their ``work`` (n,), or single ones."""
    block = np.cumsum(work) // least
    begins = np.flatnonzero(np.diff(block, prepend=-1.0))
    ends = np.append(begins, len(work))[1:]
    return [slice(begin, end) for begin, end in zip(begins.tolist(), ends.tolist(), strict=True)]
