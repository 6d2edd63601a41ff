"""Response of oscillators and of pairs to records, on all cores: peaks and histories."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.compiled import entry
from stochlin.kernels.basics.parallel import Progress, in_order
from stochlin.kernels.records.oscillator import PEAKS, STATE, run, substeps, top, workspace

PARTS = 16  # number of tasks into which the structures on a record are divided
PAIR = 2.0  # number of sub-steps of a pair over that of its stiffer structure alone


class SampledMotion(NamedTuple):
    """The samples of a ground motion, which is linear between them."""

    acceleration: Array  # (samples,) [m/s^2], finite
    dt: float  # time step [s]


@entry
def _all_peaks(ground, dt, parameters, out):
    """Write the peaks of all structures to ``out`` (n, PEAKS)."""
    space, nothing = workspace(), np.empty((STATE, 0))
    for i in range(parameters.shape[0]):
        cuts = substeps(parameters[i, 0], dt, 1.0)
        run(parameters[i], ground, dt, cuts, out[i], 0, nothing, space)


@entry
def _all_gaps(ground, dt, first, second, out):
    """Write the results of `gaps_on_records` for one record to ``out`` (n, 2 PEAKS + 2)."""
    space = workspace()
    for i in range(first.shape[0]):
        cuts = substeps(max(first[i, 0], second[i, 0]), dt, PAIR)
        size = cuts * (ground.size - 1) + 1
        path_1, path_2 = np.empty((STATE, size)), np.empty((STATE, size))
        run(first[i], ground, dt, cuts, out[i, :PEAKS], 1, path_1, space)
        run(second[i], ground, dt, cuts, out[i, PEAKS : 2 * PEAKS], 1, path_2, space)
        apart, sum_11, sum_22, sum_12 = 0.0, 0.0, 0.0, 0.0
        for s in range(size - 1):
            d, d1 = path_1[0, s] - path_2[0, s], path_1[0, s + 1] - path_2[0, s + 1]
            rate, rate1 = path_1[1, s] - path_2[1, s], path_1[1, s + 1] - path_2[1, s + 1]
            apart = max(apart, top(dt / cuts, d, rate, d1, rate1))
            weight = 1.0 if s + 1 < size - 1 else 0.5  # trapezoidal rule; the first value is 0
            sum_11 += weight * path_1[0, s + 1] ** 2
            sum_22 += weight * path_2[0, s + 1] ** 2
            sum_12 += weight * path_1[0, s + 1] * path_2[0, s + 1]
        out[i, 2 * PEAKS] = apart
        out[i, 2 * PEAKS + 1] = sum_12 / np.sqrt(sum_11 * sum_22)


@entry
def _history(ground, dt, parameters, refine, out):
    """Write the states of one structure, ``refine`` in each interval of the record, to ``out``."""
    each = substeps(parameters[0], dt / refine, 1.0)
    run(parameters, ground, dt, each * refine, np.empty(PEAKS), each, out, workspace())


def peaks_on_records(
    grounds: Sequence[SampledMotion], parameters: Array, progress: Progress | None = None
) -> Array:
    """Peaks (records, n, PEAKS) on each record of structures with ``parameters`` (n, 4) as in `run`."""
    return _spread(_all_peaks, PEAKS, grounds, (parameters,), progress)


def gaps_on_records(
    grounds: Sequence[SampledMotion], first: Array, second: Array, progress: Progress | None = None
) -> Array:
    """Response of pairs to each record, (records, n, 2 PEAKS + 2).

    The columns are the peaks of both structures, the largest ``u1 - u2`` [m], and the correlation of the
    two displacements over the record. Both structures of a pair take the same sub-steps.
    """
    return _spread(_all_gaps, 2 * PEAKS + 2, grounds, (first, second), progress)


def history(ground: SampledMotion, parameters: Array, refine: int) -> Array:
    """States (STATE, times) of one structure, at ``refine`` times in each interval of the record."""
    out = np.empty((STATE, refine * (len(ground.acceleration) - 1) + 1))
    _history(*ground, parameters, refine, out)
    return out


def _spread(
    fill: Callable[..., None],
    columns: int,
    grounds: Sequence[SampledMotion],
    structures: Sequence[Array],
    progress: Progress | None,
) -> Array:
    """Results (records, n, columns) of ``fill`` for all records and structures, on all cores.

    A task takes every `PARTS`-th structure, so that all tasks have short and long periods.
    """
    count = len(structures[0])
    parts = max(1, min(count, PARTS))
    result = np.empty((len(grounds), count, columns))

    def task(number: int) -> None:
        """One part of the structures on one record."""
        record, part = number // parts, slice(number % parts, None, parts)
        out = np.empty(result[record, part].shape)
        fill(*grounds[record], *(np.ascontiguousarray(rows[part]) for rows in structures), out)
        result[record, part] = out

    list(in_order(task, parts * len(grounds), progress))
    return result
