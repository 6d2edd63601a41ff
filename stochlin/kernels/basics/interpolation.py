"""Multilinear interpolation on a rectangular grid with any number of axes; NaN outside the grid."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.compiled import entry

ROUNDING = 1e-9  # distance beyond the end of an axis at which a point still counts as inside


class Grid(NamedTuple):
    """Values on a rectangular grid with ``d`` axes."""

    axes: Array  # (d, longest) coordinates along each axis, increasing, padded with infinity
    sizes: Array  # (d,) number of coordinates of each axis
    values: Array  # flat, in C order: the last axis varies fastest

    @classmethod
    def of(cls, axes: list[Array], values: Array) -> Grid:
        """The grid of these increasing axes, with ``values`` of one dimension for each axis."""
        padded = np.full((len(axes), max(axis.size for axis in axes)), np.inf)
        for row, axis in zip(padded, axes, strict=True):
            row[: axis.size] = axis
        flat = np.ascontiguousarray(values, float).reshape(-1)
        return cls(padded, np.array(values.shape), flat)


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
