"""Linear and smooth interpolation on a rectangular grid with any number of axes; NaN outside it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.compiled import called_often, compiled, entry

ROUNDING = 1e-9  # distance beyond the end of an axis at which a point still counts as inside


class Grid(NamedTuple):
    """Values on a rectangular grid with ``d`` axes; for `interpolate_smoothly`, columns of values."""

    axes: Array  # (d, longest) coordinates along each axis, increasing, padded with infinity
    sizes: Array  # (d,) number of coordinates of each axis; then the number of columns, if any
    values: Array  # flat, in C order: the last axis varies fastest

    @classmethod
    def of(cls, axes: list[Array], values: Array) -> Grid:
        """The grid of these increasing axes; ``values`` have a dimension for each, and for columns."""
        padded = np.full((len(axes), max(axis.size for axis in axes)), np.inf)
        for row, axis in zip(padded, axes, strict=True):
            row[: axis.size] = axis
        return cls(padded, np.array(values.shape), np.ascontiguousarray(values, float).reshape(-1))


@entry
def interpolate(axes, sizes, values, points, out):
    """Interpolate a `Grid` at ``points`` (d, n) into ``out`` (n,); NaN at points outside or with NaN."""
    dimensions, count = points.shape
    share = np.empty(dimensions)
    for n in range(count):
        base, inside = 0, True
        for d in range(dimensions):
            x, last = points[d, n], sizes[d] - 1
            if not axes[d, 0] - ROUNDING <= x <= axes[d, last] + ROUNDING:
                inside = False
                break
            x = min(max(x, axes[d, 0]), axes[d, last])
            low = 0
            while low < last - 1 and axes[d, low + 1] <= x:
                low += 1
            share[d] = (x - axes[d, low]) / (axes[d, low + 1] - axes[d, low])
            base = base * sizes[d] + low
        if not inside:
            out[n] = np.nan
            continue
        total = 0.0
        for corner in range(1 << dimensions):
            weight, offset, stride = 1.0, 0, 1
            for d in range(dimensions - 1, -1, -1):
                upper = (corner >> d) & 1
                weight *= share[d] if upper else 1.0 - share[d]
                offset += upper * stride
                stride *= sizes[d]
            if weight > 0.0:
                total += weight * values[base + offset]
        out[n] = total


@entry
def interpolate_smoothly(axes, sizes, values, points, out):
    """Interpolate the columns of a `Grid` at ``points`` (d, n) into ``out`` (n, columns), without kinks.

    The values are those of the grid at its points, and cubic polynomials along each axis between them.
    The slope at a point is that of the parabola through it and its two neighbours, and 0 at both ends of
    an axis, beyond which values may be held. Where a point is outside or has a NaN, ``out`` is NaN.
    """
    count, other = points.shape[1], points.shape[0] - 1
    weights, offsets = np.empty(4**other), np.empty(4**other, np.int64)
    nodes, shares = np.empty(4, np.int64), np.empty(4)
    for n in range(count):
        weights[0], offsets[0], corners = 1.0, 0, 1
        for d in range(other + 1):
            x, last = points[d, n], sizes[d] - 1
            if not axes[d, 0] - ROUNDING <= x <= axes[d, last] + ROUNDING:
                corners = 0
                break
            around = _around(axes[d], last, min(max(x, axes[d, 0]), axes[d, last]), nodes, shares)
            if d == other:
                break
            # From the last corner on, so that none is overwritten before it is used.
            for corner in range(corners - 1, -1, -1):
                weight, base = weights[corner], offsets[corner] * sizes[d]
                for k in range(around):
                    weights[corner * around + k] = weight * shares[k]
                    offsets[corner * around + k] = base + nodes[k]
            corners *= around
        out[n] = 0.0 if corners else np.nan
        for corner in range(corners):
            _add_up(values, offsets[corner] * sizes[other], nodes, weights[corner], shares, out[n])


@compiled
def _around(axis, last, x, nodes, shares):
    """Find the points of an axis around ``x`` and their weights; returns how many there are, 1 or 4."""
    low = 0
    while low < last and axis[low + 1] <= x:
        low += 1
    if x == axis[low]:
        nodes[:], shares[:], shares[0] = low, 0.0, 1.0
        return 1
    step = axis[low + 1] - axis[low]
    t = (x - axis[low]) / step
    smooth = t * t * (3 - 2 * t)
    for k in range(4):
        nodes[k] = min(max(low - 1 + k, 0), last)
    shares[0], shares[1], shares[2], shares[3] = 0.0, 1 - smooth, smooth, 0.0
    if low > 0:
        before = axis[low] - axis[low - 1]
        slope = t * (1 - t) ** 2 / (before + step)
        back, on = slope * step**2 / before, slope * before
        shares[0], shares[1], shares[2] = -back, shares[1] + back - on, shares[2] + on
    if low < last - 1:
        after = axis[low + 2] - axis[low + 1]
        slope = t**2 * (1 - t) / (after + step)
        on, back = slope * step**2 / after, slope * after
        shares[1], shares[2], shares[3] = shares[1] + back, shares[2] + on - back, -on
    return 4


@called_often
def _add_up(values, base, nodes, weight, shares, out):
    """Add the columns at four points to ``out``, by slices, so that they stay in vector registers."""
    size = out.size
    a, b = (base + nodes[0]) * size, (base + nodes[1]) * size
    c, d = (base + nodes[2]) * size, (base + nodes[3]) * size
    column_a, column_b = values[a : a + size], values[b : b + size]
    column_c, column_d = values[c : c + size], values[d : d + size]
    of_a, of_b = weight * shares[0], weight * shares[1]
    of_c, of_d = weight * shares[2], weight * shares[3]
    for n in range(size):
        out[n] += of_a * column_a[n] + of_b * column_b[n] + of_c * column_c[n] + of_d * column_d[n]
