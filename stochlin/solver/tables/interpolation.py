"""Smooth interpolation on a rectangular grid with any number of axes; NaN outside it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from stochlin.kernels.basics.arrays import Array

# distance beyond the end of an axis at which a point still counts as inside
ROUNDING_OF_AXES = 1e-9
POINTS_AT_ONCE = 1024  # points interpolated together


class Axis(NamedTuple):
    """An axis of a grid, and the polynomials by which a few points around a place are weighted."""

    points: Array  # (m,) increasing
    first: Array  # (m - 1,) number of the first point with a weight in each interval
    # (degree + 1, p, m - 1) weights of p points from there by the distance from the begin
    powers: Array

    def around(self, x: Array, interval: Array) -> tuple[Array, Array]:
        """First point (n,) with a weight at these places, and the weights (p, n) from there on."""
        past = x - self.points.take(interval)
        highest, *others = self.powers.take(interval, axis=2)
        for power in others:
            highest *= past
            highest += power
        return self.first.take(interval), highest


def smooth(points: Array) -> Axis:
    """An axis between whose points values are cubic, without kinks.

    The slope at a point is that of the parabola through it and its two neighbours, and 0 at both
    ends of the axis, beyond which values may be held.
    """
    slopes = np.asarray(np.gradient(np.eye(points.size), points, axis=0))
    slopes[[0, -1]] = 0.0
    first = np.clip(np.arange(points.size - 1) - 1, 0, max(points.size - 4, 0))
    return _axis(points, first, CubicHermiteSpline(points, np.eye(points.size), slopes).c)


def linear(points: Array) -> Axis:
    """An axis between whose points values are linear."""
    left, right = np.eye(points.size)[:-1], np.eye(points.size)[1:]
    slopes = (right - left) / np.diff(points)[:, None]
    return _axis(points, np.arange(points.size - 1), np.array([slopes, left]))


def _axis(points: Array, first: Array, powers: Array) -> Axis:
    """The axis of polynomials (degree + 1, m - 1, m), of which most are 0."""
    near = first + np.arange(min(len(powers), points.size))[:, None]
    return Axis(points, first, powers[:, np.arange(first.size), near].copy())


class Grid(NamedTuple):
    """Columns of values on a rectangular grid."""

    axes: Sequence[Axis]
    values: Array  # a dimension for each axis, and one for the columns
    ends: Array  # (2, axes, 1) first and last point of each axis

    @classmethod
    def of(
        cls, axes: Sequence[Array], values: Array, between: Callable[[Array], Axis] = smooth
    ) -> Grid:
        """Grid of these axes; ``values`` have a dimension for each, and one for columns or none."""
        columns = np.asarray(values, float).reshape(*(points.size for points in axes), -1)
        ends = np.array([points[[0, -1]] for points in axes]).T[..., None]
        return cls([between(points) for points in axes], columns, ends)

    def section(self, number: int, x: float) -> Grid:
        """The grid of the other axes, at this place on the axis of this number."""
        axes = list(self.axes)
        axis = axes.pop(number)
        place = np.array([x])
        (first,), weights = axis.around(place, _interval(axis, place))
        part = self.values.take(range(first, first + len(weights)), number)
        values = np.tensordot(weights[:, 0], part, (0, number))
        return Grid(axes, values, np.delete(self.ends, number, axis=1))

    def at(self, points: Array) -> Array:
        """Values (columns, n) at ``points`` (axes, n); NaN at points outside or with NaN.

        Points in the same intervals of all axes but the last are interpolated together.
        """
        low, high = self.ends
        inside = ((points >= low - ROUNDING_OF_AXES) & (points <= high + ROUNDING_OF_AXES)).all(
            axis=0
        )
        out = np.full((self.values.shape[-1], inside.size), np.nan)
        cells = np.flatnonzero(inside)
        if not cells.size:
            return out
        places = np.minimum(np.maximum(points[:, cells], low), high)
        intervals = [_interval(axis, x) for axis, x in zip(self.axes, places, strict=True)]
        together = np.zeros(cells.size, int)
        for axis, interval in zip(self.axes[:-1], intervals, strict=False):
            together = together * axis.points.size + interval
        order = np.argsort(together, kind="stable")
        rows = zip(self.axes, places, intervals, strict=True)
        near = [axis.around(x[order], interval[order]) for axis, x, interval in rows]
        together = together[order]
        new = together[1:] != together[:-1]
        new[POINTS_AT_ONCE - 1 :: POINTS_AT_ONCE] = True
        for begin, end in pairwise([0, *(1 + np.flatnonzero(new)), cells.size]):
            part = [(first[begin:end], weights[:, begin:end]) for first, weights in near]
            out[:, cells[order[begin:end]]] = _sums(self.values, part)
        return out


def _interval(axis: Axis, x: Array) -> Array:
    """Numbers of the intervals of places on an axis."""
    return np.minimum(axis.points.searchsorted(x, side="right"), axis.points.size - 1) - 1


def _sums(values: Array, near: Sequence[tuple[Array, Array]]) -> Array:
    """Columns (columns, n) of a grid at places in the same intervals of all axes but the last."""
    *others, (first, weights) = near
    along = np.ones((first.size, 1))
    corner = list[slice]()
    for begin, share in others:
        along = (along[:, :, None] * share.T[:, None]).reshape(first.size, -1)
        corner.append(slice(begin[0], begin[0] + len(share)))
    block = values[tuple(corner)].reshape(along.shape[1], -1)
    sums = (along @ block).reshape(-1, values.shape[-1])
    place = np.arange(first.size) * values.shape[-2] + first
    total = weights[0] * sums.take(place, axis=0).T
    for n in range(1, len(weights)):
        total += weights[n] * sums.take(place + n, axis=0).T
    return total
