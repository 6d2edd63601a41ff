"""Standard deviation of ``u1 - u2`` and its bias, in tables of pairs."""

from __future__ import annotations

import math

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.compiled import called_often, entry
from stochlin.kernels.basics.parallel import in_ranges
from stochlin.kernels.correlation.tables import OFF, PART
from stochlin.kernels.correlation.tiles import LANES, cells_of_tile

NONE_LEFT = 1e-13  # value of 1 - rho below which it is rounding error, and taken as 0


def steps_of(shape: tuple[int, ...], dimensions: int) -> Array:
    """Strides (dimensions,) in entries of a C-ordered array of this shape; 0 where it broadcasts."""
    whole = (1,) * (dimensions - len(shape)) + shape
    steps = [math.prod(whole[d + 1 :]) if whole[d] > 1 else 0 for d in range(dimensions)]
    return np.array(steps, int)


def differences(
    std_1: Array,
    std_2: Array,
    rho: Array,
    bias_1: Array,
    bias_2: Array,
    bias: Array,
) -> tuple[Array, Array, Array]:
    """Standard deviation of ``u1 - u2``, its relative bias, and the caution; the inputs broadcast.

    ``bias_1`` and ``bias_2`` are the relative errors of the standard deviations, and ``bias`` is the
    absolute error of ``rho``. The caution is 0, 1 for a bias beyond `OFF`, or 2 for an unknown bias.
    """
    shape = np.broadcast_shapes(*(array.shape for array in (std_1, std_2, rho, bias_1, bias_2, bias)))
    rho, count = np.broadcast_to(rho, shape).reshape(-1), math.prod(shape)
    parts: list[Array] = []
    for std, off in ((std_1, bias_1), (std_2, bias_2)):
        both = np.stack(np.broadcast_arrays(std, std / (1 + off)))
        parts += [both.reshape(2, -1), steps_of(both.shape[1:], len(shape))]
    parts += [bias.reshape(-1), steps_of(bias.shape, len(shape))]
    results = np.empty(count), np.empty(count), np.empty(count, np.int8)

    def part(cells: slice) -> None:
        _fill(*parts, np.array(shape, int), rho, cells.start, cells.stop, *results)

    if count == 1:  # in plain Python: to compile that takes a second
        (a, b), (c, d) = parts[0][:, 0], parts[2][:, 0]
        results[0][0], results[1][0] = _difference(a, b, c, d, rho[0], parts[4][0])
        results[2][0] = _flag(results[1][0])
    else:
        in_ranges(part, count, PART)
    std, off, flag = (array.reshape(shape) for array in results)
    return std, off, flag


@called_often
def _difference(a, b, c, d, rho, bias):
    """Its standard deviation and the bias of that, from those of both (``b`` and ``d`` without bias)."""
    truth = min(max(rho - bias, -1.0), 1.0)
    square = (a - c) * (a - c)
    left = 0.0 if 1 - rho < NONE_LEFT else 1 - rho
    std = np.sqrt(square + 2 * a * c * left)
    square = (b - d) * (b - d)
    left = 0.0 if 1 - truth < NONE_LEFT else 1 - truth
    truth = np.sqrt(square + 2 * b * d * left)
    none = (std == 0) & (truth == 0)
    return std, 0.0 if none else std / truth - 1


@called_often
def _flag(off):
    return 2 if np.isnan(off) else (1 if abs(off) > OFF else 0)


@entry
def _fill(std_1, steps_1, std_2, steps_2, bias, steps, shape, rho, begin, end, std, off, flag):
    """Compute the cells from ``begin`` to ``end``, tile by tile.

    ``std_1`` and ``std_2`` (2, n) are standard deviations as computed and as corrected by their bias.
    """
    cells_1, cells_2, cells = (
        np.empty(LANES, np.int64), np.empty(LANES, np.int64), np.empty(LANES, np.int64)
    )  # fmt: skip
    a, b, c, d = np.empty(LANES), np.empty(LANES), np.empty(LANES), np.empty(LANES)
    r, e, stds, true = np.empty(LANES), np.empty(LANES), np.empty(LANES), np.empty(LANES)
    r[:] = 0.0
    for start in range(begin, end, LANES):
        count = min(LANES, end - start)
        cells_of_tile(start, count, shape, steps_1, cells_1)
        cells_of_tile(start, count, shape, steps_2, cells_2)
        cells_of_tile(start, count, shape, steps, cells)
        for lane in range(LANES):
            a[lane], b[lane] = std_1[0, cells_1[lane]], std_1[1, cells_1[lane]]
            c[lane], d[lane] = std_2[0, cells_2[lane]], std_2[1, cells_2[lane]]
            e[lane] = bias[cells[lane]]
        for lane in range(count):
            r[lane] = rho[start + lane]
        for lane in range(LANES):
            stds[lane], true[lane] = _difference(a[lane], b[lane], c[lane], d[lane], r[lane], e[lane])
        for lane in range(count):
            std[start + lane], off[start + lane] = stds[lane], true[lane]
            flag[start + lane] = _flag(true[lane])
