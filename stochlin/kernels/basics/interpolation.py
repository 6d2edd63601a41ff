"""Multilinear interpolation on a grid of any number of axes; compiled, NaN outside."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.compiled import entry

ROUNDING = 1e-9  # by which a point may miss the end of an axis


class Grid(NamedTuple):
    """Values on a rectangular grid: axes padded to one length, with infinity."""

    axes: Array  # (d, longest)
    sizes: Array  # (d,) of whole numbers
    values: Array  # flat, last axis fastest

    @classmethod
    def of(cls, axes: list[Array], values: Array) -> Grid:
        """From increasing axes and values over them."""
        padded = np.full((len(axes), max(axis.size for axis in axes)), np.inf)
        for row, axis in zip(padded, axes, strict=True):
            row[: axis.size] = axis
        flat = np.ascontiguousarray(values, float).reshape(-1)
        return cls(padded, np.array(values.shape), flat)


@entry
def interpolate(axes, sizes, values, points, out):
    """Interpolate at ``points`` (d, n) into ``out`` (n,); NaN outside and where a point is NaN."""
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
