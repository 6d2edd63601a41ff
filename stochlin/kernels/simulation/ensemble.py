"""An ensemble of motions of one ground, with all structures riding on each of them.

Motions come in groups of LANES; a group draws from a stream of its own, spawned from the seed by its
number. Groups are independent tasks and are summed in their order: a seed gives the same answer
whatever the number of threads.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import reduce
from operator import add
from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress, in_order
from stochlin.kernels.simulation.normal_numbers import fill_normal, generator_state
from stochlin.kernels.simulation.stepping import (
    LANES,
    FilterSteps,
    add_products,
    ground_block,
    keep_extremes,
)

SAMPLES = 32  # of each block, unless a plan says otherwise: it then fits the second-level cache

Block = Callable[..., None]


class Crowd(NamedTuple):
    """Structures by their laws: those of one law after those of another."""

    parts: tuple[tuple[Block, Array], ...]  # time steps as `bilinear_block`, and its parameters

    @property
    def size(self) -> int:
        """Number of structures."""
        return sum(len(parameters) for _, parameters in self.parts)


class Plan(NamedTuple):
    """Steps of a run."""

    dt: float
    every: int  # steps from sample to sample
    burn_in: int  # blocks
    recorded: int  # blocks
    groups: int
    seed: int
    samples: int = SAMPLES  # of a block
    first_group: int = 0  # number of the first stream

    @property
    def block(self) -> float:
        """Seconds of a block."""
        return self.dt * self.every * self.samples


class Extremes(NamedTuple):
    """Of each motion over its whole length: largest and smallest displacement, largest difference."""

    highest: Array  # (motions, n)
    lowest: Array  # (motions, n)
    difference: Array  # (motions, n, n): of the first index less the second


class Sums(NamedTuple):
    """Sums over motions of the second moments ``G`` (n, n) of each, and of their products."""

    moments: Array  # sum of G
    squares: Array  # sum of G_ij^2
    with_own: Array  # sum of G_ij G_ii
    own: Array  # sum of G_ii G_jj
    change: Array  # (n,): sum over motions of G_ii of the second half less the first
    change_squares: Array  # (n,)


class Motion:
    """State of one group of LANES motions and the structures on them."""

    def __init__(self, crowd: Crowd, ground: FilterSteps, root: Array, plan: Plan, group: int) -> None:
        self.crowd, self.ground, self.plan = crowd, ground, plan
        self.random = generator_state(plan.seed, group, LANES)
        start = np.empty((len(root), LANES))
        fill_normal(self.random, start)
        self.q = np.ascontiguousarray(root @ start)
        self.state = np.zeros((3, crowd.size, LANES))
        steps = plan.every * plan.samples
        self.xi, self.f = np.empty((steps, LANES)), np.empty((steps, LANES))
        self.out = np.empty((LANES, crowd.size, plan.samples))

    def block(self, envelope: Array | None = None) -> Array:
        """Move on by one block; displacements (LANES, n, SAMPLES)."""
        plan, out = self.plan, self.out
        fill_normal(self.random, self.xi)
        ground_block(self.xi, self.q, *self.ground, self.f)
        if envelope is not None:
            self.f *= envelope[:, None]
        begin = 0
        for steps, parameters in self.crowd.parts:
            part = slice(begin, begin + len(parameters))
            steps(self.f, plan.dt, parameters, *self.state[:, part], plan.every, out[:, part])
            begin = part.stop
        return out


def stationary_sums(
    crowd: Crowd, ground: FilterSteps, root: Array, plan: Plan, progress: Progress | None
) -> Sums:
    """Run the ensemble and sum its second moments; ``root root'`` is the filter's covariance."""

    @np.errstate(all="ignore")  # what overflows is judged by its status
    def run(group: int) -> Sums:
        motion = Motion(crowd, ground, root, plan, plan.first_group + group)
        for _ in range(plan.burn_in):
            motion.block()
        halves = [_gram(motion, plan.recorded // 2), _gram(motion, plan.recorded - plan.recorded // 2)]
        first, second = (np.einsum("lii->li", half) for half in halves)
        weight = plan.recorded // 2 / (plan.recorded - plan.recorded // 2)
        change = weight * second - first
        moments = (halves[0] + halves[1]) / (plan.recorded * plan.samples)
        own = np.einsum("lii->li", moments)
        return Sums(
            moments.sum(axis=0),
            np.einsum("lij,lij->ij", moments, moments),
            np.einsum("lij,li->ij", moments, own),
            own.T @ own,
            change.sum(axis=0),
            (change**2).sum(axis=0),
        )

    groups = in_order(run, plan.groups, progress)
    return reduce(lambda total, sums: Sums(*map(add, total, sums)), groups)


def plastic_displacements(
    crowd: Crowd, ground: FilterSteps, root: Array, plan: Plan, stride: int
) -> Array:
    """``u - z`` of all structures after every ``stride``-th recorded block, (times, n, motions)."""

    def run(group: int) -> Array:
        motion = Motion(crowd, ground, root, plan, plan.first_group + group)
        for _ in range(plan.burn_in):
            motion.block()
        histories = np.empty((plan.recorded // stride, crowd.size, LANES))
        for history in histories:
            for _ in range(stride):
                motion.block()
            np.subtract(motion.state[0], motion.state[2], out=history)
        return histories

    return np.concatenate(list(in_order(run, plan.groups)), axis=2)


def finite_extremes(
    crowd: Crowd,
    scale: Array,
    ground: FilterSteps,
    root: Array,
    plan: Plan,
    envelope: Array,
    progress: Progress | None,
) -> Extremes:
    """Motions from rest under an envelope, which has a value a step.

    ``scale`` (n,) puts all structures into metres. The plan takes every step; its burn-in and
    length are not used.
    """

    def run(group: int) -> Extremes:
        motion = Motion(crowd, ground, root, plan, plan.first_group + group)
        size = (LANES, crowd.size)
        extremes = Extremes(np.zeros(size), np.zeros(size), np.zeros((*size, crowd.size)))
        for begin in range(0, envelope.size, plan.samples):
            part = envelope[begin : begin + plan.samples]
            shape = np.concatenate([part, np.zeros(plan.samples - part.size)])
            out = motion.block(shape)
            keep_extremes(out[:, :, : part.size], scale, *extremes)
        return extremes

    groups = in_order(run, plan.groups, progress)
    return Extremes(*(np.concatenate(field) for field in zip(*groups, strict=True)))


def _gram(motion: Motion, blocks: int) -> Array:
    """Sums of ``u_i u_j`` over the samples of the blocks, (LANES, n, n)."""
    total = np.zeros((LANES, motion.crowd.size, motion.crowd.size))
    for _ in range(blocks):
        add_products(motion.block(), total)
    return total + np.tril(total, -1).transpose(0, 2, 1)
