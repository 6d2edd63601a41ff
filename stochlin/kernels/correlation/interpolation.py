"""Linear and smooth interpolation on a rectangular grid with any number of axes; NaN outside it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array

ROUNDING = 1e-9  # distance beyond the end of an axis at which a point still counts as inside
TOGETHER = 1024  # points interpolated together


class Axis(NamedTuple):
    """An axis of a grid."""

    points: Array  # (m,) increasing
    cubics: Array  # (m - 1, 4, 4): weights of the four points around an interval, by powers in it

    @classmethod
    def of(cls, points: Array) -> Axis:
        """The values between two points are a cubic polynomial without kinks.

        Its slope at a point is that of the parabola through it and its two neighbours, and 0 at both
        ends of the axis, beyond which values may be held.
        """
        around = np.pad(points, 1, mode="edge")
        first, start, stop, end = (around[n : n + points.size - 1, None] for n in range(4))
        step, before, after = stop - start, start - first, end - stop
        smooth, rise, fall = np.array([[0, 0, 3, -2], [0, 1, -2, 1], [0, 0, 1, -1.0]])
        back, on = _of_slope(step, before) * rise, before / (before + step) * rise
        ahead, off = _of_slope(step, after) * fall, after / (after + step) * fall
        constant = np.array([1.0, 0, 0, 0])
        stay, move = constant - smooth + back - on + off, smooth + on + ahead - off
        return cls(points, np.stack([-back, stay, move, -ahead], axis=1))


def _of_slope(step: Array, beside: Array) -> Array:
    """Weight of a point in the slope at its neighbour; 0 where there is no point."""
    known = beside > 0
    return np.where(known, step**2 / np.where(known, beside * (beside + step), 1), 0.0)


class Grid(NamedTuple):
    """Columns of values on a rectangular grid."""

    axes: Sequence[Axis]
    values: Array  # a dimension for each axis, and one for the columns
    ends: Array  # (2, axes, 1): first and last point of each axis

    @classmethod
    def of(cls, axes: Sequence[Array], values: Array) -> Grid:
        """The grid of these axes; ``values`` have a dimension for each, and one for columns or none."""
        columns = np.asarray(values, float).reshape(*(axis.size for axis in axes), -1)
        ends = np.array([[axis[n] for axis in axes] for n in (0, -1)])[..., None]
        return cls([Axis.of(axis) for axis in axes], columns, ends)

    def on_points(self, axes: Sequence[Array], around: Around) -> Array:
        """Values at all combinations of points on the axes; 0 where one of them is outside."""
        values = self.values
        for n, (axis, x) in enumerate(zip(self.axes, axes, strict=True)):
            inside = (x >= axis.points[0]) & (x <= axis.points[-1])
            weights = around(axis, x) * inside[:, None]
            values = np.moveaxis(np.tensordot(weights, values, (1, n)), 0, n)
        return values


Around = Callable[[Axis, Array], Array]  # weights (n, m) of the points of an axis at places (n,)


def linearly(axis: Axis, x: Array) -> Array:
    """Weights in linear interpolation, of the two points around each place."""
    low, t = _interval(axis, x)
    return _spread(axis, low, np.stack([1 - t, t], axis=1))


def smoothly(axis: Axis, x: Array) -> Array:
    """Weights in interpolation without kinks, of the four points around each place."""
    low, t = _interval(axis, x)
    cubic, t = axis.cubics[low], t[:, None]
    weights = ((cubic[..., 3] * t + cubic[..., 2]) * t + cubic[..., 1]) * t + cubic[..., 0]
    return _spread(axis, low, weights)


def interpolate(grid: Grid, points: Array, around: Around = linearly) -> Array:
    """Values (columns, n) of a grid at ``points`` (axes, n); NaN at points outside or with NaN.

    Points in the same intervals of all axes but the last are interpolated together.
    """
    low, high = grid.ends
    inside = ((points >= low - ROUNDING) & (points <= high + ROUNDING)).all(axis=0)
    out = np.full((grid.values.shape[-1], inside.size), np.nan)
    cells = np.flatnonzero(inside)
    if not cells.size:
        return out
    places, interval = np.clip(points[:, cells], low, high), np.zeros(cells.size, int)
    for axis, x in zip(grid.axes[:-1], places, strict=False):
        interval = interval * axis.points.size + axis.points.searchsorted(x, side="right")
    order = np.argsort(interval, kind="stable")
    weights = [around(axis, x[order]) for axis, x in zip(grid.axes, places, strict=True)]
    new = np.diff(interval[order]) != 0
    new[TOGETHER - 1 :: TOGETHER] = True
    ends = [0, *(1 + np.flatnonzero(new)), cells.size]
    for begin, end in pairwise(ends):
        out[:, cells[order[begin:end]]] = _sums(grid.values, [rows[begin:end] for rows in weights])
    return out


def _interval(axis: Axis, x: Array) -> tuple[Array, Array]:
    """Number of the interval of an axis with each place, and the place in it from 0 to 1."""
    points = axis.points
    low = np.clip(points.searchsorted(x, side="right") - 1, 0, points.size - 2)
    return low, (x - points[low]) / (points[low + 1] - points[low])


def _spread(axis: Axis, low: Array, weights: Array) -> Array:
    """Weights (n, m) of all points of an axis from those of the points around the intervals ``low``."""
    n, k = weights.shape
    spread = np.zeros((n, axis.points.size + 2))  # with a point before and one behind the axis
    spread[np.arange(n)[:, None], low[:, None] + np.arange(2 - k // 2, 2 + k // 2)] = weights
    return spread[:, 1:-1]


def _sums(values: Array, weights: Sequence[Array]) -> Array:
    """Columns (columns, n) of a grid at places of which most points have no weight."""
    used = [np.flatnonzero(rows.any(axis=0)) for rows in weights]
    parts = [slice(points[0], points[-1] + 1) for points in used]
    *others, last = (rows[:, part] for rows, part in zip(weights, parts, strict=True))
    block, along = values[tuple(parts)], np.ones((len(last), 1))
    for n in reversed(range(len(others))):
        rows = others[n]
        if (rows == rows[0]).all():  # all places are equal on this axis
            block = np.tensordot(rows[0], block, (0, n))
        else:
            along = (rows[:, :, None] * along[:, None, :]).reshape(len(rows), -1)
    block = block.reshape(along.shape[1], -1)
    if len(block) == 1:
        return (last @ block.reshape(last.shape[1], -1)).T
    sums: Array = last[:, None] @ (along @ block).reshape(*last.shape, -1)
    return sums[:, 0].T
