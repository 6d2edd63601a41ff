"""Relative displacement of pairs of structures in simulated motions, instant by instant."""

from __future__ import annotations

from functools import reduce
from operator import add
from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress, in_order
from stochlin.kernels.simulation.ensemble import Crowd, Motion, Plan
from stochlin.kernels.simulation.stepping import LANES, FilterSteps


class Watched(NamedTuple):
    """What is watched: pairs of structures, and gaps."""

    first: Array  # (p,) position in the crowd of the left structure
    second: Array  # (p,)
    scale_1: Array  # (p,) metres of a unit of its displacement
    scale_2: Array  # (p,)
    gap: Array  # (c,) [m]
    pair: Array  # (c,) the pair that the gap is between


class Histories(NamedTuple):
    """Sums over motions at the end of each block, the start included; the largest of each motion."""

    survivors: Array  # (blocks + 1, c): motions in which the gap has not been reached yet
    beyond: Array  # (blocks + 1, c): motions that are beyond the gap at the instant
    squares: Array  # (blocks + 1, 3, p): of u_1, u_2 and u_1 - u_2 [m^2]
    fourths: Array  # (blocks + 1, 3, p)
    largest: Array  # (motions, p): max of u_1 - u_2 [m]


def separation_histories(
    crowd: Crowd,
    ground: FilterSteps,
    root: Array,
    plan: Plan,
    envelope: Array,
    watched: Watched,
    progress: Progress | None,
) -> Histories:
    """Motions from rest under an envelope (steps,), a whole number of the plan's blocks long."""
    blocks = envelope.size // plan.samples

    def run(group: int) -> Histories:
        motion = Motion(crowd, ground, root, plan, plan.first_group + group)
        pairs, cells = watched.first.size, watched.gap.size
        survivors = np.full((blocks + 1, cells), LANES)
        beyond = np.zeros((blocks + 1, cells), int)
        squares, fourths = np.zeros((2, blocks + 1, 3, pairs))
        largest = np.zeros((LANES, pairs))
        for block in range(blocks):
            out = motion.block(envelope[block * plan.samples : (block + 1) * plan.samples])
            one = watched.scale_1[:, None] * out[:, watched.first]
            two = watched.scale_2[:, None] * out[:, watched.second]
            apart = one - two
            np.maximum(largest, apart.max(axis=2), out=largest)
            now = np.stack([one[..., -1], two[..., -1], apart[..., -1]], axis=1)
            survivors[block + 1] = (largest[:, watched.pair] <= watched.gap).sum(axis=0)
            beyond[block + 1] = (now[:, 2, watched.pair] > watched.gap).sum(axis=0)
            squares[block + 1], fourths[block + 1] = (now**2).sum(axis=0), (now**4).sum(axis=0)
        return Histories(survivors, beyond, squares, fourths, largest)

    def join(total: Histories, part: Histories) -> Histories:
        largest = np.concatenate([total.largest, part.largest])
        return Histories(*[*map(add, total[:-1], part[:-1]), largest])

    return reduce(join, in_order(run, plan.groups, progress))
