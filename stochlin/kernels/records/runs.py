"""Response of oscillators and of pairs to records, on all cores: peaks and histories."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.compiled import compiled, entry
from stochlin.kernels.basics.parallel import Progress, in_order
from stochlin.kernels.records.oscillator import PEAKS, STATE, run, substeps, top

PARTS = 16  # number of tasks into which the structures on a record are divided
PAIR = 2.0  # number of sub-steps of a pair over that of its stiffer structure alone


class SampledMotion(NamedTuple):
    """The samples of a ground motion, which is linear between them."""

    acceleration: Array  # (samples,) [m/s^2], finite
    dt: float  # time step [s]


@entry
def _all_peaks(ground, dt, sides, out):
    """Write the results of `peaks_on_records` for one record to ``out``; ``sides`` (1 or 2, n, 4)."""
    pair = len(sides) == 2
    for i in range(sides.shape[1]):
        cuts = substeps(sides[:, i, 0].max(), dt, PAIR if pair else 1.0)
        size = cuts * (ground.size - 1) + 1 if pair else 0
        paths = np.empty((len(sides), STATE, size))
        for n in range(len(sides)):
            peaks = out[i, n * PEAKS : (n + 1) * PEAKS]
            run(sides[n, i], ground, dt, cuts, peaks, 1 if pair else 0, paths[n])
        if pair:
            together = _together(paths[0, 0], paths[1, 0], paths[0, 1], paths[1, 1], dt / cuts)
            out[i, 2 * PEAKS], out[i, 2 * PEAKS + 1] = together


@compiled
def _together(u, u_2, v, v_2, step):
    """Largest ``u1 - u2`` and correlation of two displacements with these velocities."""
    apart = 0.0
    for s in range(u.size - 1):
        before, after = u[s] - u_2[s], u[s + 1] - u_2[s + 1]
        apart = max(apart, top(step, before, v[s] - v_2[s], after, v[s + 1] - v_2[s + 1]))
    u[-1] *= np.sqrt(0.5)  # by the trapezoidal rule; the first value is 0
    u_2[-1] *= np.sqrt(0.5)
    return apart, (u * u_2).sum() / np.sqrt((u * u).sum() * (u_2 * u_2).sum())


@entry
def _history(ground, dt, parameters, refine, out):
    """Write the states of one structure, ``refine`` in each interval of the record, to ``out``."""
    each = substeps(parameters[0], dt / refine, 1.0)
    run(parameters, ground, dt, each * refine, np.empty(PEAKS), each, out)


def peaks_on_records(
    grounds: Sequence[SampledMotion], *sides: Array, progress: Progress | None = None
) -> Array:
    """Peaks of structures, or of pairs of them, on each record, (records, n, columns).

    A side has the parameters (n, 4) of its structures as in `run`. The columns are `PEAKS` for each
    side, and of pairs the largest ``u1 - u2`` [m] and the correlation of the two displacements over the
    record. Both structures of a pair take the same sub-steps. A task takes every `PARTS`-th structure,
    so that all tasks have short and long periods.
    """
    both, count = np.stack(sides), len(sides[0])
    parts = max(1, min(count, PARTS))
    result = np.empty((len(grounds), count, len(sides) * PEAKS + 2 * (len(sides) - 1)))

    def task(number: int) -> None:
        """One part of the structures on one record."""
        record, part = number // parts, slice(number % parts, None, parts)
        out = np.empty(result[record, part].shape)
        _all_peaks(*grounds[record], np.ascontiguousarray(both[:, part]), out)
        result[record, part] = out

    list(in_order(task, parts * len(grounds), progress))
    return result


def history(ground: SampledMotion, parameters: Array, refine: int) -> Array:
    """States (STATE, times) of one structure, at ``refine`` times in each interval of the record."""
    out = np.empty((STATE, refine * (len(ground.acceleration) - 1) + 1))
    _history(*ground, parameters, refine, out)
    return out
