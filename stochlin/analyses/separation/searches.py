"""Where what is required passes what there is: the ends of the values that do, with intervals.

What is required is simulated, so that it has a 95 % interval itself. Each value is simulated once; the
interval of an end is read from the same simulations: it holds the values at which the gap lies
within that of what is required.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
import scipy.optimize

from stochlin.kernels.basics.arrays import Array

CLOSE = 1e-3  # relative, of what is searched


class Edge(NamedTuple):
    """A value at which what is required is just what there is, and its 95 % interval."""

    value: float
    lower: float = np.nan
    upper: float = np.nan

    def times(self, factor: float) -> Edge:
        """Of something so many times as large."""
        return Edge(*(factor * each for each in self))


NONE, NO_LIMIT = Edge(np.nan), Edge(np.inf)


class Required:
    """What is required, as a function of a value, which may give both ends of its interval too."""

    def __init__(self, function: Callable[[float], float | Sequence[float]], most: float) -> None:
        self._function, self.most = function, most
        self._known: dict[float, tuple[float, float, float]] = {}

    def __call__(self, value: float) -> float:
        """What is required [m]."""
        return self._at(float(value))[0]

    def _at(self, value: float) -> tuple[float, float, float]:
        if value not in self._known:
            found = np.broadcast_to(np.asarray(self._function(value), float), 3)
            self._known[value] = float(found[0]), float(found[1]), float(found[2])
        return self._known[value]

    def enough(self, value: float) -> bool:
        """Whether what there is will do."""
        return self(value) <= self.most

    def edge(self, one: float, other: float) -> Edge:
        """Between a value that will do and one that will not."""
        low, high = sorted((float(one), float(other)))
        found = scipy.optimize.brentq(lambda x: self(x) - self.most, low, high, rtol=CLOSE, xtol=1e-6)
        required, least, most = self._at(float(found))
        slope = (self(high) - self(low)) / (high - low)
        for end in (least, most):  # about there the ends of the interval pass, too
            moved = found - (end - required) / slope
            if end != required and moved > 0:
                self(moved)
        return Edge(float(found), *self._interval(float(found)))

    def _interval(self, value: float) -> tuple[float, float]:
        """Where the ends of what is required pass what there is, next to the value."""
        at = np.array(sorted(self._known))
        ends = np.array([self._known[x][1:] for x in at]).T
        passed = np.concatenate([_crossings(at, end - self.most) for end in ends])
        below, above = passed[passed <= value], passed[passed >= value]
        return float(below.max(initial=at[0])), float(above.min(initial=at[-1]))


def _crossings(at: Array, values: Array) -> Array:
    """Where values pass zero, linear in between."""
    low, high = values[:-1], values[1:]
    n = np.flatnonzero((low <= 0) != (high <= 0))
    found: Array = at[n] + (at[n + 1] - at[n]) * low[n] / (low[n] - high[n])
    return found


def up_to(required: Required, grid: Sequence[float] | Array) -> Edge:
    """The largest value up to which all will do; no limit if all do, none if the first does not."""
    before = None
    for value in grid:
        if not required.enough(value):
            return NONE if before is None else required.edge(before, value)
        before = value
    return NO_LIMIT


def least(required: Required, grid: Sequence[float] | Array) -> Edge:
    """The first value that will do; none if there is none."""
    before = None
    for value in grid:
        if required.enough(value):
            return Edge(*[float(value)] * 3) if before is None else required.edge(before, value)
        before = value
    return NONE


def around(required: Required, grid: Sequence[float] | Array, start: int) -> tuple[Edge, Edge]:
    """Both ends of the values next to ``grid[start]`` that will do; 0 and no limit where there is none.

    Those that hold it; else those below it, or, if there are none, above it.
    """
    inside = next(
        (n for n in (*range(start, -1, -1), *range(start + 1, len(grid))) if required.enough(grid[n])),
        None,
    )
    if inside is None:
        return NONE, NONE
    ends = []
    for way, open_end in ((-1, Edge(0.0)), (1, NO_LIMIT)):
        n = inside
        while 0 <= n < len(grid) and required.enough(grid[n]):
            n += way
        ends.append(required.edge(grid[n - way], grid[n]) if 0 <= n < len(grid) else open_end)
    return ends[0], ends[1]
