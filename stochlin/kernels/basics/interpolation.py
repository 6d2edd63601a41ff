"""Linear and smooth interpolation on a rectangular grid with any number of axes; NaN outside it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from scipy import sparse

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.slabs import in_ranges

ROUNDING = 1e-9  # distance beyond the end of an axis at which a point still counts as inside
CELLS = 128  # points interpolated together
Shares = tuple[Array, Array]  # numbers (n, k) of the points of an axis around each place, and weights
Around = Callable[[Array, Array], Shares]


class Grid(NamedTuple):
    """Columns of values on a rectangular grid."""

    axes: Sequence[Array]  # increasing coordinates along each axis
    values: Array  # a dimension for each axis, and one for the columns

    @classmethod
    def of(cls, axes: Sequence[Array], values: Array) -> Grid:
        """The grid of these axes; ``values`` have a dimension for each, and one for columns or none."""
        return cls(axes, np.asarray(values, float).reshape(*(axis.size for axis in axes), -1))


def linearly(axis: Array, x: Array) -> Shares:
    """The two points around each place, and their weights in linear interpolation."""
    low = _interval(axis, x)
    upper = (x - axis[low]) / (axis[low + 1] - axis[low])
    return np.stack([low, low + 1], axis=1), np.stack([1 - upper, upper], axis=1)


def smoothly(axis: Array, x: Array) -> Shares:
    """The four points around each place, and their weights in interpolation without kinks.

    The values between two points are a cubic polynomial. Its slope at a point is that of the parabola
    through it and its two neighbours, and 0 at both ends of the axis, beyond which values may be held.
    """
    low, last = _interval(axis, x), axis.size - 1
    nodes = np.clip(low[:, None] + np.arange(-1, 3, dtype=np.int32), 0, last)
    first, start, stop, end = axis[nodes].T
    step, before, after = stop - start, start - first, end - stop
    t = (x - start) / step
    smooth = t * t * (3 - 2 * t)
    rise, fall = t * (1 - t) ** 2 / (before + step), t**2 * (1 - t) / (after + step)
    with np.errstate(divide="ignore", invalid="ignore"):  # at the ends there is no neighbour
        back, on = np.where(low > 0, (rise * step**2 / before, rise * before), 0.0)
        ahead, off = np.where(low < last - 1, (fall * step**2 / after, fall * after), 0.0)
    shares = -back, 1 - smooth + back - on + off, smooth + on + ahead - off, -ahead
    return nodes, np.stack(shares, axis=1)


def interpolate(grid: Grid, points: Array, around: Around = linearly) -> Array:
    """Values (columns, n) of a grid at ``points`` (axes, n); NaN at points outside or with NaN.

    Along an axis on which all places are equal, the whole grid is interpolated once.
    """
    axes, values = list(grid.axes), grid.values
    inside = np.all([_within(axis, x) for axis, x in zip(axes, points, strict=True)], axis=0)
    places = [np.clip(x[inside], axis[0], axis[-1]) for axis, x in zip(axes, points, strict=True)]
    out = np.full((values.shape[-1], inside.size), np.nan)
    if not inside.any():
        return out
    for d in reversed(range(len(axes))):
        if (places[d] == places[d][0]).all():
            nodes, shares = around(axes.pop(d), places.pop(d)[:1])
            values = np.tensordot(shares[0], values.take(nodes[0], axis=d), (0, d))
    result, columns = np.empty((len(out), inside.sum())), values.reshape(-1, len(out))

    def part(cells: slice) -> None:
        result[:, cells] = _weighted(axes, columns, [x[cells] for x in places], around)

    in_ranges(part, result.shape[1], CELLS)
    out[:, inside] = result
    return out


def _interval(axis: Array, x: Array) -> Array:
    """Number of the interval of an axis with each place."""
    low = np.clip(np.searchsorted(axis, x, side="right") - 1, 0, axis.size - 2)
    return low.astype(np.int32)


def _within(axis: Array, x: Array) -> Array:
    return (x >= axis[0] - ROUNDING) & (x <= axis[-1] + ROUNDING)


def _weighted(axes: Sequence[Array], columns: Array, places: Sequence[Array], around: Around) -> Array:
    """Columns (columns, n) of a grid at places inside, as sums over the points around them."""
    if not axes:
        return columns.T
    n = places[0].size
    corners, weights = np.zeros((n, 1), np.int32), np.ones((n, 1))
    for axis, x in zip(axes, places, strict=True):
        nodes, shares = around(axis, x)
        corners = (corners[:, :, None] * axis.size + nodes[:, None, :]).reshape(n, -1)
        weights = (weights[:, :, None] * shares[:, None, :]).reshape(n, -1)
    begin = np.arange(n + 1, dtype=np.int32) * weights.shape[1]
    return (sparse.csr_array((weights.ravel(), corners.ravel(), begin), (n, len(columns))) @ columns).T
