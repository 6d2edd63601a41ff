"""Smooth interpolation on a rectangular grid with any number of axes; NaN outside it."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from stochlin.kernels.basics.arrays import Array

ROUNDING = 1e-9  # distance beyond the end of an axis at which a point still counts as inside
TOGETHER = 1024  # points interpolated together


def smooth(points: Array) -> CubicHermiteSpline:
    """Weights (n, m) of the m points of an axis at places (n,), most of them 0.

    They belong to cubic polynomials without kinks. The slope at a point is that of the parabola through
    it and its two neighbours, and 0 at both ends of the axis, beyond which values may be held.
    """
    slopes = np.asarray(np.gradient(np.eye(points.size), points, axis=0))
    slopes[[0, -1]] = 0.0
    return CubicHermiteSpline(points, np.eye(points.size), slopes)


class Grid(NamedTuple):
    """Columns of values on a rectangular grid."""

    axes: Sequence[Array]  # increasing points
    weights: Sequence[CubicHermiteSpline]  # of each axis
    values: Array  # a dimension for each axis, and one for the columns
    ends: Array  # (2, axes, 1) first and last point of each axis

    @classmethod
    def of(cls, axes: Sequence[Array], values: Array) -> Grid:
        """The grid of these axes; ``values`` have a dimension for each, and one for columns or none."""
        columns = np.asarray(values, float).reshape(*(axis.size for axis in axes), -1)
        ends = np.array([axis[[0, -1]] for axis in axes]).T[..., None]
        return cls(axes, [smooth(axis) for axis in axes], columns, ends)

    def section(self, number: int, x: float) -> Grid:
        """The grid of the other axes, at this place on the axis of this number."""
        axes, weights = list(self.axes), list(self.weights)
        del axes[number]
        values = np.tensordot(weights.pop(number)(x), self.values, (0, number))
        return Grid(axes, weights, values, np.delete(self.ends, number, axis=1))

    def at(self, points: Array) -> Array:
        """Values (columns, n) at ``points`` (axes, n); NaN at points outside or with NaN.

        Points in the same intervals of all axes but the last are interpolated together.
        """
        low, high = self.ends
        inside = ((points >= low - ROUNDING) & (points <= high + ROUNDING)).all(axis=0)
        out = np.full((self.values.shape[-1], inside.size), np.nan)
        cells = np.flatnonzero(inside)
        if not cells.size:
            return out
        places, interval = np.clip(points[:, cells], low, high), np.zeros(cells.size, int)
        for axis, x in zip(self.axes[:-1], places, strict=False):
            interval = interval * axis.size + axis.searchsorted(x, side="right")
        order = np.argsort(interval, kind="stable")
        weights = [rows(x[order]) for rows, x in zip(self.weights, places, strict=True)]
        new = np.diff(interval[order]) != 0
        new[TOGETHER - 1 :: TOGETHER] = True
        for begin, end in pairwise([0, *(1 + np.flatnonzero(new)), cells.size]):
            part = [rows[begin:end] for rows in weights]
            out[:, cells[order[begin:end]]] = _sums(self.values, part)
        return out


def _sums(values: Array, weights: Sequence[Array]) -> Array:
    """Columns (columns, n) of a grid at places of which most points have no weight."""
    used = [np.flatnonzero(rows.any(axis=0)) for rows in weights]
    parts = [slice(points[0], points[-1] + 1) for points in used]
    block = values[tuple(parts)]
    *others, last = (rows[:, part] for rows, part in zip(weights, parts, strict=True))
    along = np.ones((len(last), 1))
    for rows in others:
        along = (along[:, :, None] * rows[:, None, :]).reshape(len(rows), -1)
    sums = (along @ block.reshape(along.shape[1], -1)).reshape(*last.shape, -1)
    return (last[:, None] @ sums)[:, 0].T
