"""Structures on records: peaks, gaps between two of them, histories; compiled, on all cores."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.compiled import entry
from stochlin.kernels.basics.parallel import in_order
from stochlin.kernels.records.oscillator import PEAKS, STATE, run, substeps, top, workspace

PARTS = 16  # into which the structures of a record are dealt out to the cores
PAIR = 2.0  # sub-steps of a pair per those that its stiffer structure alone would need


class SampledGround(NamedTuple):
    """A record."""

    acceleration: Array  # [m/s^2], finite
    dt: float  # [s]


@entry
def _all_peaks(ground, dt, parameters, out):
    space, nothing = workspace(), np.empty((STATE, 0))
    for i in range(parameters.shape[0]):
        cuts = substeps(parameters[i, 0], dt, 1.0)
        run(parameters[i], ground, dt, cuts, out[i], 0, nothing, space)


@entry
def _all_gaps(ground, dt, first, second, out):
    space = workspace()
    for i in range(first.shape[0]):
        cuts = substeps(max(first[i, 0], second[i, 0]), dt, PAIR)
        size = cuts * (ground.size - 1) + 1
        one, two = np.empty((STATE, size)), np.empty((STATE, size))
        run(first[i], ground, dt, cuts, out[i, :PEAKS], 1, one, space)
        run(second[i], ground, dt, cuts, out[i, PEAKS : 2 * PEAKS], 1, two, space)
        apart, sum_11, sum_22, sum_12 = 0.0, 0.0, 0.0, 0.0
        for s in range(size - 1):
            d, d1 = one[0, s] - two[0, s], one[0, s + 1] - two[0, s + 1]
            rate, rate1 = one[1, s] - two[1, s], one[1, s + 1] - two[1, s + 1]
            apart = max(apart, top(dt / cuts, d, rate, d1, rate1))
            weight = 1.0 if s + 1 < size - 1 else 0.5  # trapezoidal rule; it begins at rest
            sum_11 += weight * one[0, s + 1] ** 2
            sum_22 += weight * two[0, s + 1] ** 2
            sum_12 += weight * one[0, s + 1] * two[0, s + 1]
        out[i, 2 * PEAKS] = apart
        out[i, 2 * PEAKS + 1] = sum_12 / np.sqrt(sum_11 * sum_22)


@entry
def _history(ground, dt, parameters, refine, out):
    each = substeps(parameters[0], dt / refine, 1.0)
    run(parameters, ground, dt, each * refine, np.empty(PEAKS), each, out, workspace())


def peaks_on_records(grounds: Sequence[SampledGround], parameters: Array) -> Array:
    """Peaks (records, n, PEAKS) of structures ``parameters`` (n, 4) on each ground."""
    return _spread(_all_peaks, PEAKS, grounds, parameters)


def gaps_on_records(grounds: Sequence[SampledGround], first: Array, second: Array) -> Array:
    """Pairs on each ground, (records, n, 2 PEAKS + 2): peaks of both, largest ``u1 - u2``, correlation.

    Both structures of a pair take the same sub-steps.
    """
    return _spread(_all_gaps, 2 * PEAKS + 2, grounds, first, second)


def history(ground: SampledGround, parameters: Array, refine: int) -> Array:
    """States (STATE, samples) of one structure, ``refine`` to an interval."""
    out = np.empty((STATE, refine * (len(ground.acceleration) - 1) + 1))
    _history(*ground, parameters, refine, out)
    return out


def _spread(
    fill: Callable[..., None], columns: int, grounds: Sequence[SampledGround], *structures: Array
) -> Array:
    """The columns that ``fill`` finds; each part of the structures has short and long periods."""
    count = len(structures[0])
    parts = max(1, min(count, PARTS))
    result = np.empty((len(grounds), count, columns))

    def task(number: int) -> None:
        record, part = number // parts, slice(number % parts, None, parts)
        out = np.empty(result[record, part].shape)
        fill(*grounds[record], *(np.ascontiguousarray(rows[part]) for rows in structures), out)
        result[record, part] = out

    list(in_order(task, parts * len(grounds)))
    return result
