"""Relative displacements of pairs of structures over time, in simulated motions."""

from __future__ import annotations

from functools import reduce
from operator import add
from typing import Any, NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress
from stochlin.kernels.simulation.ensemble import Crowd, MotionGroup, functions_of
from stochlin.kernels.simulation.stepping import LANES, turning_points

AT_ONCE = 1 << 18  # displacements that are compared with gaps at once
# Displacements of structures that have fallen, left and right: beyond any gap, but with fourth powers.
OUT_OF_THE_WAY = np.array([1e75, -1e75]).reshape(2, 1, 1, 1)
FALLEN = 1e60  # deviation of displacements that is larger only if a structure has fallen in some motion


class Falls(NamedTuple):
    """Drifts beyond which structures fall: of the left ones of all pairs, then of the right ones."""

    drifts: Array  # rows (d, n) [m]
    limit: Array  # (d, 1) or (d, motions) [m]
    start: Array  # (2 p,): number of the first drift of each structure

    def in_block(self, out: Array, group: int) -> Array:
        """Whether structures fall (samples, 2, p, LANES) at displacements ``out`` of a group."""
        own = slice(group * LANES, (group + 1) * LANES)
        limit = self.limit if self.limit.shape[1] == 1 else self.limit[:, own]
        beyond = ~(np.abs(functions_of(out, self.drifts)) <= limit)
        return np.logical_or.reduceat(beyond, self.start, axis=1).reshape(len(out), 2, -1, LANES)


class Watched(NamedTuple):
    """Pairs of structures, the heights at which they can meet, and the gaps to be checked."""

    first: Array  # rows (r, n): displacements of the left structures [m], at all heights of all pairs
    second: Array  # rows (r, n): the same of the right structures
    start: Array  # (p,): number of the first height of each pair
    gap: Array  # (c,) [m]
    pair: Array  # (c,): number of the pair that each gap is between
    falls: Falls | None = None  # None if no structure can fall

    def sides(self, out: Array) -> Array:
        """Displacements (2, samples, r, LANES) [m] of the left and of the right structures."""
        return np.stack([functions_of(out, self.first), functions_of(out, self.second)])

    def fallen(self, out: Array, before: Array, group: int) -> Array:
        """Whether structures have fallen by each sample (2, 1 + samples, r, LANES), or ``before``."""
        assert self.falls is not None
        heights = np.diff(np.append(self.start, before.shape[2]))
        now = np.repeat(self.falls.in_block(out, group), heights, axis=2).swapaxes(0, 1)
        return np.logical_or.accumulate(np.concatenate([before, now], axis=1), axis=1)


class Histories(NamedTuple):
    """Sums over all motions at ``t`` times, the first at the start; and maxima of each motion."""

    survivors: Array  # (t, c): number of motions in which the gap has not been exceeded so far
    beyond: Array  # (t, c): number of motions in which the gap is exceeded at this time
    squares: Array  # (t, 3, r): sums of squares of u_1, u_2 and u_1 - u_2 [m^2]
    fourths: Array  # (t, 3, r): sums of their fourth powers [m^4]
    largest: Array  # (motions, r): largest u_1 - u_2 of each motion [m]; infinite if one has fallen


def separation_histories(
    crowd: Crowd, envelope: Array, instants: Array, watched: Watched, progress: Progress | None
) -> Histories:
    """Simulate motions from rest under an ``envelope`` (steps,), and evaluate them at ``instants`` (t,).

    The instants are numbers of steps since the start, of which the first is 0. They need not be whole:
    displacements are interpolated linearly between steps.
    """
    rows, cells = len(watched.first), watched.gap.size
    at_once = max(1, AT_ONCE // (cells * LANES))

    def counts(apart: Array, holds: Any) -> Array:
        """Number (k, c) of motions in which ``holds`` of ``apart`` (k, r, LANES) and each gap."""
        numbers = np.empty((len(apart), cells), int)
        for begin in range(0, len(apart), at_once):
            some = slice(begin, begin + at_once)
            farthest = np.maximum.reduceat(apart[some], watched.start, axis=1)  # over the heights
            numbers[some] = holds(farthest[:, watched.pair], watched.gap[:, None]).sum(axis=-1)
        return numbers

    def of_group(motion: MotionGroup) -> Histories:
        """The histories of one group of motions."""
        survivors, beyond = np.full((instants.size, cells), LANES), np.zeros((instants.size, cells), int)
        squares, fourths = np.zeros((2, instants.size, 3, rows))
        largest, before, way = np.zeros((3, rows, LANES))
        last = np.zeros((2, 1, rows, LANES))
        fallen = np.zeros((2, 1, rows, LANES), bool)
        begin = 0
        for out in motion.under(envelope):
            sides = np.concatenate([last, watched.sides(out)], axis=1)  # at the start, after each step
            apart = sides[0] - sides[1]
            turns = apart.copy()
            turning_points(apart[1:], before, way, turns[1:])
            if watched.falls is not None:
                fallen = watched.fallen(out, fallen[:, -1:], motion.group)
                sides = np.where(fallen, OUT_OF_THE_WAY, sides)
            so_far = np.maximum(np.maximum.accumulate(np.fmax(turns, sides[0] - sides[1])), largest)
            last, largest = sides[:, -1:], so_far[-1]
            inside = (instants > begin) & (instants <= begin + len(out))
            step, share = np.divmod(instants[inside] - begin, 1)
            step, share = step.astype(int), share[:, None, None]
            u_1, u_2 = (1 - share) * sides[:, step] + share * sides[:, np.minimum(step + 1, len(out))]
            now = np.stack([u_1, u_2, u_1 - u_2], axis=1)
            squared = now * now
            survivors[inside] = counts(so_far[step], np.less_equal)
            beyond[inside] = counts(now[:, 2], np.greater)
            squares[inside], fourths[inside] = squared.sum(axis=-1), (squared * squared).sum(axis=-1)
            begin += len(out)
        return Histories(survivors, beyond, squares, fourths, largest.T)

    def join(total: Histories, part: Histories) -> Histories:
        """Add the histories of a group to those of the groups before."""
        largest = np.concatenate([total.largest, part.largest])
        return Histories(*[*map(add, total[:-1], part[:-1]), largest])

    total = reduce(join, crowd.over_groups(of_group, progress))
    return total._replace(largest=infinite_if_fallen(total.largest))


def infinite_if_fallen(values: Array) -> Array:
    """Displacements and their deviations, infinite where a structure has fallen."""
    return np.where(values > FALLEN, np.inf, values)
