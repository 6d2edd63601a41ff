"""Searches for the values of a parameter at which a required gap equals the existing one.

The required gap comes from a simulation and has a 95 % interval. Each value of the parameter is
simulated only once. Whether a gap is sufficient is often clear from a few motions; an edge is found with
all of them. The interval of a found value follows from the same simulations: it contains the
values at which the existing gap is within the interval of the required gap.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np
import scipy.optimize

from stochlin.kernels.basics.arrays import Array

FAR = 1e6  # [m], in place of a required gap that is infinite, since a structure falls
CLOSE = 1e-3  # relative tolerance of a found value, and of an estimated gap there
FEW, LEAST_FEW = 8, 64  # a few motions are one in eight, and at least this many
CLEAR = 2.0  # half 95 % intervals between a gap from a few motions and the limit, so that these decide


Ends = tuple[float, float, float]  # required gap, and the ends of its interval [m]


class Edge(NamedTuple):
    """A value at which the required gap equals the existing one, and its 95 % interval."""

    value: float
    lower: float = np.nan
    upper: float = np.nan


NONE, NO_LIMIT = Edge(np.nan), Edge(np.inf)


class Required:
    """The required gap by simulation as a function of a value; ``most`` is the existing gap.

    ``gaps`` gives it for a value and a number of motions, and ``known`` those of all ``paths`` by value.
    Whether a gap is sufficient is decided by a few motions, where these are clear. ``interval`` says
    whether the intervals of edges are wanted, which take two more simulations each.
    """

    def __init__(
        self,
        gaps: Callable[[float, int], Ends],
        most: float,
        paths: int,
        known: Mapping[float, Ends],
        interval: bool = True,
    ) -> None:
        self.most, self._gaps, self._interval = most, gaps, interval
        self._paths, self._few = paths, max(paths // FEW, LEAST_FEW)
        self._known = {(value, paths): _finite(ends) for value, ends in known.items()}

    def __call__(self, value: float) -> float:
        """Required gap at a value [m]."""
        return self._at(value, self._paths)[0]

    def _at(self, value: float, paths: int) -> Ends:
        key = float(value), paths
        if key not in self._known:
            self._known[key] = _finite(self._gaps(*key))
        return self._known[key]

    def enough(self, value: float) -> bool:
        """Whether the existing gap is sufficient at a value."""
        if self._few < self._paths and (float(value), self._paths) not in self._known:
            gap, least, most = self._at(value, self._few)
            if gap + CLEAR * (most - gap) < self.most or gap - CLEAR * (gap - least) > self.most:
                return gap < self.most
        return self(value) <= self.most

    def edge(self, first: float, second: float) -> Edge:
        """The edge between a sufficient value and one that is not."""
        low, high = sorted((float(first), float(second)))
        if self(first) > self.most or self(second) <= self.most:  # all contradict the few, just so
            root = first if self(first) > self.most else second
        else:
            root = scipy.optimize.brentq(self._excess, low, high, rtol=CLOSE, xtol=1e-6)
        if not self._interval:
            return Edge(float(root))
        required, *ends = self._at(root, self._paths)
        slope = (self(high) - self(low)) / (high - low)
        for end in ends:  # near these values, the ends of the interval equal the limit
            moved = root - (end - required) / slope
            if end != required and moved > 0:
                self(moved)
        return Edge(float(root), *self._around(float(root)))

    def _excess(self, value: float) -> float:
        """Required gap less the existing one [m]; 0 if it is close."""
        excess = self(value) - self.most
        return 0.0 if abs(excess) <= CLOSE * self.most else excess

    def _around(self, value: float) -> tuple[float, float]:
        """Values next to ``value`` at which the ends of the required gap's interval equal the limit."""
        known = {x: ends for (x, paths), ends in self._known.items() if paths == self._paths}
        at = np.array(sorted(known))
        ends = np.array([known[x][1:] for x in at]).T
        passed = np.concatenate([_crossings(at, end - self.most) for end in ends])
        below, above = passed[passed <= value], passed[passed >= value]
        return float(below.max(initial=at[0])), float(above.min(initial=at[-1]))


def _finite(ends: Ends) -> Ends:
    required, least, most = np.minimum(ends, FAR)
    return float(required), float(least), float(most)


def _crossings(at: Array, values: Array) -> Array:
    """Positions at which values change sign, by linear interpolation."""
    low, high = values[:-1], values[1:]
    n = np.flatnonzero((low <= 0) != (high <= 0))
    positions: Array = at[n] + (at[n + 1] - at[n]) * low[n] / (low[n] - high[n])
    return positions


def up_to(required: Required, grid: Sequence[float] | Array) -> Edge:
    """Largest value up to which all are sufficient; `NO_LIMIT` for all values, `NONE` for none."""
    return _end(required, grid, 0, 1, NO_LIMIT) if required.enough(grid[0]) else NONE


def least(required: Required, grid: Sequence[float] | Array) -> Edge:
    """First sufficient value; `NONE` if there is none."""
    first = next((n for n, value in enumerate(grid) if required.enough(value)), None)
    if first is None:
        return NONE
    return _end(required, grid, first, -1, Edge(*[float(grid[0])] * 3))


def around(required: Required, grid: Sequence[float] | Array, start: int) -> tuple[Edge, Edge]:
    """Both ends of the range of sufficient values around ``grid[start]``, or of the next such range.

    The next range is sought below ``grid[start]`` first, then above. An end beyond the grid is 0 or
    `NO_LIMIT`.
    """
    order = (*range(start, -1, -1), *range(start + 1, len(grid)))
    inside = next((n for n in order if required.enough(grid[n])), None)
    if inside is None:
        return NONE, NONE
    lower = _end(required, grid, inside, -1, Edge(0.0))
    return lower, _end(required, grid, inside, 1, NO_LIMIT)


def _end(
    required: Required, grid: Sequence[float] | Array, inside: int, way: int, open_end: Edge
) -> Edge:
    """End of the sufficient values on one side of ``grid[inside]``, which is sufficient itself."""
    n = inside
    while 0 <= n < len(grid) and required.enough(grid[n]):
        n += way
    return required.edge(grid[n - way], grid[n]) if 0 <= n < len(grid) else open_end
