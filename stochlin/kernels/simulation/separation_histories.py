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
    """Sums over motions at the end of each block, the start included; the largest of each motion."""

    survivors: Array  # (blocks + 1, c): motions in which the gap has not been reached yet
    beyond: Array  # (blocks + 1, c): motions that are beyond the gap at the instant
    squares: Array  # (blocks + 1, 3, r): of u_1, u_2 and u_1 - u_2 [m^2], pair by pair at all heights
    fourths: Array  # (blocks + 1, 3, r)
    largest: Array  # (motions, r): max of u_1 - u_2 [m]


def separation_histories(
    crowd: Crowd,
    ground: AnyGround,
    root: Array,
    plan: Plan,
    envelope: Array,
    watched: Watched,
    progress: Progress | None,
) -> Histories:
    """Motions from rest under an envelope (steps,), a whole number of the plan's blocks long."""
    blocks = envelope.size // plan.samples
    rows = len(watched.first.row)

    def farthest(apart: Array) -> Array:
        """Of each pair (LANES, p), over its heights."""
        return np.maximum.reduceat(apart, watched.start, axis=1)

    def run(group: int) -> Histories:
        motion = Motion(crowd, ground, root, plan, plan.first_group + group)
        cells = watched.gap.size
        survivors = np.full((blocks + 1, cells), LANES)
        beyond = np.zeros((blocks + 1, cells), int)
        squares, fourths = np.zeros((2, blocks + 1, 3, rows))
        largest = np.zeros((LANES, rows))
        for block in range(blocks):
            out = motion.block(envelope[block * plan.samples : (block + 1) * plan.samples])
            one, two = watched.first.of(out), watched.second.of(out)
            apart = one - two
            np.maximum(largest, apart.max(axis=0).T, out=largest)
            now = np.stack([part[-1].T for part in (one, two, apart)], axis=1)
            survivors[block + 1] = (farthest(largest)[:, watched.pair] <= watched.gap).sum(axis=0)
            beyond[block + 1] = (farthest(now[:, 2])[:, watched.pair] > watched.gap).sum(axis=0)
            squares[block + 1], fourths[block + 1] = (now**2).sum(axis=0), (now**4).sum(axis=0)
        return Histories(survivors, beyond, squares, fourths, largest)

    def join(total: Histories, part: Histories) -> Histories:
        largest = np.concatenate([total.largest, part.largest])
        return Histories(*[*map(add, total[:-1], part[:-1]), largest])

    return reduce(join, in_order(run, plan.groups, progress))
