"""Linear and smooth interpolation on a rectangular grid with any number of axes; NaN outside it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicHermiteSpline, make_interp_spline

from stochlin.kernels.basics.arrays import Array

ROUNDING = 1e-9  # distance beyond the end of an axis at which a point still counts as inside
TOGETHER = 1024  # points interpolated together
NEAR = 4  # points of an axis, in a row, of which all others have no weight

# Weights (n, m) of the m points of an axis at places (n,), most of them 0.
Weights = Callable[[Array], Array]


def linear(points: Array) -> Weights:
    """Linear interpolation on an axis."""
    return make_interp_spline(points, np.eye(points.size), k=1)


def smooth(points: Array) -> Weights:
    """Interpolation by cubic polynomials without kinks.

    The slope at a point is that of the parabola through it and its two neighbours, and 0 at both ends
    of the axis, beyond which values may be held.
    """
    slopes = np.asarray(np.gradient(np.eye(points.size), points, axis=0))
    slopes[[0, -1]] = 0.0
    return CubicHermiteSpline(points, np.eye(points.size), slopes)


class Grid(NamedTuple):
    """Columns of values on a rectangular grid."""

    axes: Sequence[Array]  # increasing points
    weights: Sequence[Weights]  # of each axis
    values: Array  # a dimension for each axis, and one for the columns
    ends: Array  # (2, axes, 1) first and last point of each axis

    @classmethod
    def of(
        cls, axes: Sequence[Array], values: Array, weights: Callable[[Array], Weights] = smooth
    ) -> Grid:
        """The grid of these axes; ``values`` have a dimension for each, and one for columns or none."""
        columns = np.asarray(values, float).reshape(*(axis.size for axis in axes), -1)
        ends = np.array([axis[[0, -1]] for axis in axes]).T[..., None]
        return cls(axes, [weights(axis) for axis in axes], columns, ends)

    def on_points(self, axes: Sequence[Array]) -> Array:
        """Values at all combinations of points on the axes; 0 where one of them is outside."""
        values = self.values
        for n, (own, weights, x) in enumerate(zip(self.axes, self.weights, axes, strict=True)):
            inside = (x >= own[0]) & (x <= own[-1])
            rows = weights(np.clip(x, own[0], own[-1])) * inside[:, None]
            values = np.moveaxis(np.tensordot(rows, values, (1, n)), 0, n)
        return values

    def at(self, points: Array) -> Array:
        """Values (columns, n) at ``points`` (axes, n); NaN at points outside or with NaN.

        Points that need the same part of the grid, but for the last axis, are interpolated together.
        """
        low, high = self.ends
        cells = np.flatnonzero(((points >= low - ROUNDING) & (points <= high + ROUNDING)).all(axis=0))
        places = np.clip(points[:, cells], low, high)
        out = np.full((self.values.shape[-1], points.shape[1]), np.nan)
        *corners, lowest = (
            np.clip(axis.searchsorted(x, "right") - 2, 0, max(axis.size - NEAR, 0))
            for axis, x in zip(self.axes, places, strict=True)
        )
        part = np.ravel_multi_index((*corners, 0 * lowest), (*self.values.shape[:-2], 1))
        order = np.argsort(part, kind="stable")
        for begin in range(0, cells.size, TOGETHER):
            chosen = order[begin : begin + TOGETHER]
            *others, last = (rows(x[chosen]) for rows, x in zip(self.weights, places, strict=True))
            along = np.ones((chosen.size, 1))
            for rows, corner in zip(others, corners, strict=True):
                near = corner[chosen, None] + np.arange(min(NEAR, rows.shape[1]))
                weight = np.take_along_axis(rows, near, axis=1)
                along = (along[:, :, None] * weight[:, None]).reshape(chosen.size, -1)
            new = 1 + np.flatnonzero(np.diff(part[chosen]))
            for first, end in pairwise([0, *new.tolist(), chosen.size]):
                own = chosen[first:end]
                used = slice(lowest[own].min(), lowest[own].max() + NEAR)
                block = self.values[(*(slice(c[own[0]], c[own[0]] + NEAR) for c in corners), used)]
                sums = along[first:end] @ block.reshape(along.shape[1], -1)
                sums = sums.reshape(end - first, block.shape[-2], -1)
                out[:, cells[own]] = (last[first:end, None, used] @ sums)[:, 0].T
        return out
