"""Response of oscillators and of pairs to records, on all cores: peaks and histories."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress, in_order
from stochlin.kernels.records.oscillator import HIGHEST, LONGEST, PEAKS, RHO, STATE, compare, run

PAIR = 2.0  # number of sub-steps of a pair over that of its stiffer structure alone


class SampledMotion(NamedTuple):
    """The samples of a ground motion, which is linear between them."""

    acceleration: Array  # (samples,) [m/s^2], finite
    dt: float  # time step [s]


def response(ground: SampledMotion, parameters: Array, refine: int) -> tuple[Array, Array]:
    """Peaks (PEAKS,) of one structure, and its states (times, STATE), as in `run`."""
    peaks = np.zeros(PEAKS)
    path = np.zeros((refine * (len(ground.acceleration) - 1) + 1, STATE))
    run(*ground, parameters, refine, peaks, path)
    return peaks, path


def peaks_on_records(
    grounds: Sequence[SampledMotion], *sides: Array, progress: Progress | None = None
) -> Array:
    """Peaks and last states of structures, or of pairs of them, (records, n, sides, PEAKS + STATE).

    A side has the parameters (n, 4) of its structures as in `run`. Both structures of a pair take the
    same sub-steps.
    """
    cells = np.ascontiguousarray(np.stack(sides, axis=1))

    def task(number: int) -> Array:
        """One structure or pair on one record."""
        ground, structures, refine = grounds[number // len(cells)], cells[number % len(cells)], 1
        if len(structures) == 2:
            refine = int(np.ceil(PAIR * structures[:, 0].max() * ground.dt / LONGEST))
        peaks, paths = zip(*(response(ground, each, refine) for each in structures), strict=True)
        if len(structures) == 2:
            peaks[0][HIGHEST], peaks[0][RHO] = compare(*paths, ground.dt / refine)
        return np.column_stack([peaks, [path[-1] for path in paths]])

    rows = list(in_order(task, len(grounds) * len(cells), progress))
    return np.array(rows).reshape(len(grounds), len(cells), len(sides), PEAKS + STATE)
