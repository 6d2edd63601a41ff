"""An ensemble of motions of one ground, with all structures riding on each of them.

Motions come in groups of LANES; a group draws from a stream of its own, spawned from the seed by its
number. Groups are independent tasks and are summed in their order: a seed gives the same answer
whatever the number of threads. How strong the motions are among one another is drawn from yet another
stream of the group: they are the same motions with and without this scatter.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import reduce
from operator import add
from typing import Any, NamedTuple

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
    observe,
)
from stochlin.kernels.simulation.storey_stepping import (
    Elements,
    Steps,
    sampled_steps,
    steps_of,
    storey_block,
)

STRENGTHS = 1  # the stream of a group that these come from
SAMPLES = 32  # of each block, unless a plan says otherwise: it then fits the second-level cache

Block = Callable[..., None]


class Oscillators(NamedTuple):
    """Structures of one degree of freedom and of one law, each on its own."""

    steps: Block  # as `bilinear_block`
    parameters: Array  # (n, k)

    @property
    def size(self) -> int:
        """Rows of the state, and displacements."""
        return len(self.parameters)

    def block(self, dt: float, group: int = 0) -> Block:
        """Time steps of this length, of the forcing, the state, every how many and the output."""

        def block(f: Array, u: Array, v: Array, z: Array, every: int, out: Array) -> None:
            self.steps(f, dt, self.parameters, u, v, z, every, out)

        return block


class Storeys(NamedTuple):
    """Floors on storeys that act on one another: displacements of the floors, then of the links."""

    elements: Elements
    law: Any  # a `law_of`

    @property
    def size(self) -> int:
        """As for `Oscillators`."""
        return self.elements.kind.size

    def block(self, dt: float, group: int = 0) -> Block:
        """As for `Oscillators`."""
        return _storeys_by(steps_of(self.elements, dt), self.law)


class SampledStoreys(NamedTuple):
    """The same, with elements of their own in every motion."""

    elements: Sequence[Elements]  # of the motions, group after group
    law: Any

    @property
    def size(self) -> int:
        """As for `Oscillators`."""
        return self.elements[0].kind.size

    def block(self, dt: float, group: int = 0) -> Block:
        """As for `Oscillators`."""
        own = self.elements[group * LANES : (group + 1) * LANES]
        return _storeys_by(sampled_steps(own, dt), self.law)


def _storeys_by(steps: Steps, law: Any) -> Block:
    def block(f: Array, d: Array, v: Array, z: Array, every: int, out: Array) -> None:
        storey_block(f, steps, law, d, v, z, every, out)

    return block


class SampledGround(NamedTuple):
    """A ground of its own for every motion."""

    steps: Sequence[FilterSteps]  # of the motions, group after group
    roots: Sequence[Array]

    def of(self, group: int) -> tuple[FilterSteps, Array]:
        """The grounds of a group, and the roots of their covariances (m, m, LANES)."""
        own = slice(group * LANES, (group + 1) * LANES)
        columns = zip(*self.steps[own], strict=True)
        lanes: list[Any] = [np.stack(column, axis=-1) for column in columns]
        return FilterSteps(*lanes), np.stack(self.roots[own], axis=-1)


AnyGround = FilterSteps | SampledGround


class Crowd(NamedTuple):
    """All that rides on a motion, part after part."""

    parts: tuple[Oscillators | Storeys | SampledStoreys, ...]

    @property
    def size(self) -> int:
        """Rows of the state, and displacements."""
        return sum(part.size for part in self.parts)


class View(NamedTuple):
    """Linear functions of the displacements of a crowd."""

    row: Array  # (m, k): displacements that each takes
    weight: Array  # (m, k): zero where it takes fewer

    def of(self, out: Array) -> Array:
        """Their values (samples, m, LANES)."""
        seen = np.empty((len(out), len(self.row), LANES))
        observe(out, self.row, self.weight, seen)
        return seen


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
    scatter: float = 0.0  # standard deviation of ln of a factor on each motion, of median 1

    @property
    def block(self) -> float:
        """Seconds of a block."""
        return self.dt * self.every * self.samples


class Extremes(NamedTuple):
    """Largest and smallest values of what is viewed over the length of each motion, 0 included."""

    highest: Array  # (motions, m)
    lowest: Array  # (motions, m)


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

    def __init__(self, crowd: Crowd, ground: AnyGround, root: Array, plan: Plan, group: int) -> None:
        self.crowd, self.plan = crowd, plan
        if isinstance(ground, SampledGround):
            ground, root = ground.of(group)
        self.ground_block = ground_block(ground)
        self.random = generator_state(plan.seed, group, LANES)
        self.strength = strengths(plan, group) if plan.scatter else None
        start = np.empty((len(root), LANES))
        fill_normal(self.random, start)
        self.q = np.ascontiguousarray(root @ start if root.ndim == 2 else (root * start).sum(axis=1))
        self.state = np.zeros((3, crowd.size, LANES))
        steps = plan.every * plan.samples
        self.xi, self.f = np.empty((steps, LANES)), np.empty((steps, LANES))
        self.out = np.empty((plan.samples, crowd.size, LANES))
        self.blocks = [part.block(plan.dt, group) for part in crowd.parts]

    def block(self, envelope: Array | None = None) -> Array:
        """Move on by one block; displacements (samples, n, LANES)."""
        plan, out = self.plan, self.out
        fill_normal(self.random, self.xi)
        self.ground_block(self.xi, self.q, self.f)
        if envelope is not None:
            self.f *= envelope[:, None]
        if self.strength is not None:
            self.f *= self.strength
        begin = 0
        for part, block in zip(self.crowd.parts, self.blocks, strict=True):
            rows = slice(begin, begin + part.size)
            block(self.f, *self.state[:, rows], plan.every, out[:, rows])
            begin = rows.stop
        return out


def strengths(plan: Plan, group: int) -> Array:
    """The factors (LANES,) of the motions of a group."""
    normal = np.empty((1, LANES))
    fill_normal(generator_state(plan.seed, group, LANES, STRENGTHS), normal)
    factors: Array = np.exp(plan.scatter * normal[0])
    return factors


def stationary_sums(
    crowd: Crowd,
    view: View | None,
    ground: AnyGround,
    root: Array,
    plan: Plan,
    progress: Progress | None,
) -> Sums:
    """Run the ensemble and sum the second moments of what is viewed, or of all displacements.

    ``root root'`` is the filter's covariance.
    """

    @np.errstate(all="ignore")  # what overflows is judged by its status
    def run(group: int) -> Sums:
        motion = Motion(crowd, ground, root, plan, plan.first_group + group)
        for _ in range(plan.burn_in):
            motion.block()
        half = plan.recorded // 2
        halves = [_gram(motion, view, half), _gram(motion, view, plan.recorded - half)]
        first, second = (np.einsum("lii->li", half) for half in halves)
        weight = half / (plan.recorded - half)
        change = weight * second - first
        moments = (halves[0] + halves[1]) / (plan.recorded * plan.samples)
        own = np.einsum("lii->li", moments)
        return Sums(
            moments.sum(axis=0),
            np.einsum("lij,lij->ij", moments, moments),
            np.einsum("lij,li->ij", moments, own),
            np.einsum("li,lj->ij", own, own),  # whose sums, unlike those of BLAS, do not depend on n
            change.sum(axis=0),
            (change**2).sum(axis=0),
        )

    groups = in_order(run, plan.groups, progress)
    return reduce(lambda total, sums: Sums(*map(add, total, sums)), groups)


def plastic_displacements(
    crowd: Crowd, ground: AnyGround, root: Array, plan: Plan, stride: int
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
    view: View,
    ground: AnyGround,
    root: Array,
    plan: Plan,
    envelope: Array,
    progress: Progress | None,
) -> Extremes:
    """Motions from rest under an envelope, which has a value a step.

    The plan takes every step; its burn-in and length are not used.
    """

    def run(group: int) -> Extremes:
        motion = Motion(crowd, ground, root, plan, plan.first_group + group)
        size = (len(view.row), LANES)
        extremes = Extremes(np.zeros(size), np.zeros(size))
        for begin in range(0, envelope.size, plan.samples):
            part = envelope[begin : begin + plan.samples]
            shape = np.concatenate([part, np.zeros(plan.samples - part.size)])
            out = motion.block(shape)
            keep_extremes(out[: part.size], *view, *extremes)
        return extremes

    groups = in_order(run, plan.groups, progress)
    return Extremes(*(np.concatenate(field, axis=1).T for field in zip(*groups, strict=True)))


def ground_motions(
    ground: FilterSteps, output: Array, root: Array, plan: Plan, steps: int, progress: Progress | None
) -> Array:
    """Ground acceleration ``output q`` at the beginning of each step, (motions, steps).

    The motions are those under which a crowd moves by this plan; white noise, which has no value at an
    instant, is given by its mean over the step.
    """
    at_instants = ground._replace(row=output, direct=0.0) if output.size else ground

    def run(group: int) -> Array:
        motion = Motion(Crowd(()), at_instants, root, plan, plan.first_group + group)
        history = np.empty((steps, LANES))
        for begin in range(0, steps, plan.samples):
            motion.block()
            part = history[begin : begin + plan.samples]
            part[:] = motion.f[: len(part)]
        return history.T

    return np.concatenate(list(in_order(run, plan.groups, progress)))


def _gram(motion: Motion, view: View | None, blocks: int) -> Array:
    """Sums of ``x_i x_j`` over the samples of the blocks, (LANES, m, m)."""
    size = motion.crowd.size if view is None else len(view.row)
    sums = np.zeros((size, size, LANES))
    for _ in range(blocks):
        out = motion.block()
        add_products(out if view is None else view.of(out), sums)
    total = sums.transpose(2, 0, 1)
    return total + np.tril(total, -1).transpose(0, 2, 1)
