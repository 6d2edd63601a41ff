"""Relative displacements of pairs of structures over time, in simulated motions."""

from __future__ import annotations

from functools import reduce
from operator import add
from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress, in_order
from stochlin.kernels.simulation.ensemble import AnyGround, Crowd, Motion, Plan, View
from stochlin.kernels.simulation.stepping import LANES


class Watched(NamedTuple):
    """Pairs of structures, the heights at which they can meet, and the gaps to be checked."""

    first: View  # (r,): displacements of the left structures [m], at all heights of all pairs
    second: View  # (r,): the same of the right structures
    start: Array  # (p,): number of the first height of each pair
    gap: Array  # (c,) [m]
    pair: Array  # (c,): number of the pair that each gap is between


class Histories(NamedTuple):
    """Sums over all motions at ``t`` times, the first at the start; and maxima of each motion."""

    survivors: Array  # (t, c): number of motions in which the gap has not been exceeded so far
    beyond: Array  # (t, c): number of motions in which the gap is exceeded at this time
    squares: Array  # (t, 3, r): sums of squares of u_1, u_2 and u_1 - u_2 [m^2]
    fourths: Array  # (t, 3, r): sums of their fourth powers [m^4]
    largest: Array  # (motions, r): largest u_1 - u_2 of each motion [m]


def separation_histories(
    crowd: Crowd,
    ground: AnyGround,
    root: Array,
    plan: Plan,
    envelope: Array,
    instants: Array,
    watched: Watched,
    progress: Progress | None,
) -> Histories:
    """Simulate motions from rest under an ``envelope`` (steps,), and evaluate them at ``instants`` (t,).

    The instants are numbers of steps since the start, of which the first is 0. They need not be whole:
    displacements are interpolated linearly between steps.
    """
    rows = len(watched.first.row)

    def farthest(apart: Array) -> Array:
        """Largest value (LANES, p) over the heights of each pair, of ``apart`` (LANES, r)."""
        return np.maximum.reduceat(apart, watched.start, axis=1)

    def run(group: int) -> Histories:
        """The histories of one group of motions."""
        motion = Motion(crowd, ground, root, plan, plan.first_group + group)
        cells = watched.gap.size
        survivors = np.full((instants.size, cells), LANES)
        beyond = np.zeros((instants.size, cells), int)
        squares, fourths = np.zeros((2, instants.size, 3, rows))
        largest, number = np.zeros((LANES, rows)), 1
        last = np.zeros((2, 1, rows, LANES))
        for begin in range(0, envelope.size, plan.samples):
            part = envelope[begin : begin + plan.samples]
            out = motion.block(np.concatenate([part, np.zeros(plan.samples - part.size)]))[: part.size]
            sides = np.stack([watched.first.of(out), watched.second.of(out)])
            sides = np.concatenate([last, sides], axis=1)  # at the start, then after each step
            last, apart, passed = sides[:, -1:], sides[0] - sides[1], 0
            while number < instants.size and instants[number] <= begin + part.size:
                here = instants[number] - begin
                step, share = int(here), here % 1
                following = min(step + 1, part.size)
                largest = np.maximum(largest, apart[passed : step + 1].max(axis=0).T)
                one, two = (1 - share) * sides[:, step] + share * sides[:, following]
                now = np.stack([one.T, two.T, (one - two).T], axis=1)
                survivors[number] = (farthest(largest)[:, watched.pair] <= watched.gap).sum(axis=0)
                beyond[number] = (farthest(now[:, 2])[:, watched.pair] > watched.gap).sum(axis=0)
                squares[number], fourths[number] = (now**2).sum(axis=0), (now**4).sum(axis=0)
                passed, number = step, number + 1
            largest = np.maximum(largest, apart[passed:].max(axis=0).T)
        return Histories(survivors, beyond, squares, fourths, largest)

    def join(total: Histories, part: Histories) -> Histories:
        """Add the histories of a group to those of the groups before."""
        largest = np.concatenate([total.largest, part.largest])
        return Histories(*[*map(add, total[:-1], part[:-1]), largest])

    return reduce(join, in_order(run, plan.groups, progress))
