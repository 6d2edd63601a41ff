"""Relative displacement of pairs of structures in simulated motions, instant by instant."""

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
    """What is watched: pairs of structures at the heights at which they could meet, and gaps."""

    first: View  # (r,): displacements [m] of the left structures, height by height, pair by pair
    second: View  # (r,)
    start: Array  # (p,): the first height of each pair
    gap: Array  # (c,) [m]
    pair: Array  # (c,) the pair that the gap is between


class Histories(NamedTuple):
    """Sums over motions at some instants, the start among them; the largest of each motion."""

    survivors: Array  # (t, c): motions in which the gap has not been reached yet
    beyond: Array  # (t, c): motions that are beyond the gap at the instant
    squares: Array  # (t, 3, r): of u_1, u_2 and u_1 - u_2 [m^2], pair by pair at all heights
    fourths: Array  # (t, 3, r)
    largest: Array  # (motions, r): max of u_1 - u_2 [m]


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
    """Motions from rest under an envelope (steps,), looked at after so many steps (t,), 0 first.

    Between steps displacements are interpolated.
    """
    rows = len(watched.first.row)

    def farthest(apart: Array) -> Array:
        """Of each pair (LANES, p), over its heights."""
        return np.maximum.reduceat(apart, watched.start, axis=1)

    def run(group: int) -> Histories:
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
            sides = np.concatenate([last, sides], axis=1)  # after none, one, ... of these steps
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
        largest = np.concatenate([total.largest, part.largest])
        return Histories(*[*map(add, total[:-1], part[:-1]), largest])

    return reduce(join, in_order(run, plan.groups, progress))
