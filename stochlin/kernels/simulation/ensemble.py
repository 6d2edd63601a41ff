"""Ensembles of simulated motions of one ground, and the response of all structures to each of them.

Motions are simulated in groups of `LANES`. Each group has a stream of random numbers of its own,
spawned from the seed by the number of the group. Groups are independent tasks, whose results are
summed in their order: a seed gives the same result for any number of threads. The random factors on
the intensity of the motions (their scatter) come from a further stream of the group, so that the
motions with and without scatter are the same but for these factors.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import reduce
from operator import add
from typing import Any, NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array, zeros_on_a_line
from stochlin.kernels.basics.parallel import Progress, in_order
from stochlin.kernels.simulation.laws import VISCOUS
from stochlin.kernels.simulation.links import LinkPeaks, watch_links
from stochlin.kernels.simulation.normal_numbers import fill_normal, generator_state
from stochlin.kernels.simulation.row_products import times_rows
from stochlin.kernels.simulation.state import Elements, State
from stochlin.kernels.simulation.stepping import (
    LANES,
    FilterSteps,
    add_products,
    bilinear_block,
    ground_block,
    keep_extremes,
    observe,
)
from stochlin.kernels.simulation.time_step import (
    Steps,
    sampled_block,
    sampled_steps,
    step_of,
    steps_of,
    system_block,
)

# number of the stream, within that of a group, of the factors by which motions scatter
SCATTER_STREAM = 1
SAMPLES = 32  # default number of samples of a block, which then fits the second-level cache

Block = Callable[..., None]


class SteppedOscillators(NamedTuple):
    """Independent bilinear oscillators, in units of their yield displacements."""

    parameters: Array  # (n, 4): parameters of each oscillator, as in `bilinear_block`

    @property
    def size(self) -> int:
        """Number of displacements."""
        return len(self.parameters)

    def at_rest(self, lanes: int = LANES, group: int = 0) -> Any:
        """The state before a motion: ``u``, ``v`` and ``z`` (n, lanes)."""
        return tuple(zeros_on_a_line(3, self.size, lanes))

    def begin(self, state: Any, start: Array) -> None:
        """Begin motions with displacements and velocities (2, n), where nothing has yielded."""
        u, v, z = state
        u[:] = z[:] = start[0][:, None]
        v[:] = start[1][:, None]

    def shown(self, start: Array) -> Array:
        """What is watched (2, w) of displacements and velocities (2, n)."""
        return start

    def block(self, dt: float, group: int = 0) -> Block:
        """The function for blocks of time steps of length ``dt`` [s].

        It takes the forcing, the state, which it updates, the number of steps from sample to
        sample, the output, and the number of its first row to be written.
        """

        def block(f: Array, state: Any, every: int, out: Array, at: int = 0) -> None:
            bilinear_block(f, dt, self.parameters, *state, every, out, at)

        return block

    def plastic(self, state: Any) -> Array:
        """The plastic parts of the displacements (n, lanes)."""
        u, _, z = state
        plastic: Array = u - z
        return plastic


@dataclass(frozen=True, eq=False)
class SteppedStructures:
    """Buildings and oscillators with any laws, and links; displacements are those of the shapes."""

    elements: Elements
    law: Any  # the result of `laws.by_number`
    # elements with uncertain parameters: one set for each motion, group after group
    samples: Sequence[Elements] = ()
    # (w, n): 1 for the element, of the first n, that belongs to a displacement, else 0; None if
    # each displacement is that of its element
    incidence: Array | None = None
    _steps: dict[float, Steps] = field(default_factory=dict, init=False)

    @property
    def size(self) -> int:
        """Number of displacements."""
        return len(self.elements.system.shapes)

    def at_rest(self, lanes: int = LANES, group: int = 0) -> Any:
        """The state before a motion of this group."""
        return State.at_rest(self._of(group) or [self.elements], lanes)

    def begin(self, state: State, start: Array) -> None:
        """Begin motions with values (2, n) of the coordinates, as in `SteppedOscillators`."""
        coordinates = state.coordinates
        coordinates.q[:], coordinates.v[:] = start[..., None]
        springs = self.elements.kind != VISCOUS
        extension = np.where(springs, self.elements.system.extensions @ start[0], 0.0)
        state.elements.z[:] = extension[:, None]

    def shown(self, start: Array) -> Array:
        """What is watched (2, w) of values of the coordinates (2, n)."""
        return start @ self.elements.system.shapes.T

    def _of(self, group: int) -> Sequence[Elements]:
        """The samples of a group."""
        return self.samples[group * LANES : (group + 1) * LANES]

    def block(self, dt: float, group: int = 0) -> Block:
        """Function for blocks of time steps of a group of motions, as in `SteppedOscillators`."""
        if self.samples:
            steps = sampled_steps(self._of(group), dt)
            block_of = sampled_block
        else:
            if dt not in self._steps:
                self._steps[dt] = steps_of(self.elements, dt)
            steps = self._steps[dt]
            block_of = system_block
        step, slip = step_of(self.law, steps, self.at_rest(LANES, group), LANES)

        def block(f: Array, state: Any, every: int, out: Array, at: int = 0) -> None:
            block_of(f, step, slip, self.law, steps, state, every, out, at)

        return block

    def plastic(self, state: State) -> Array:
        """The plastic parts of the extensions that the displacements show (w, lanes)."""
        n = self.elements.system.mass.size
        extensions = self.elements.system.extensions[:n] @ state.coordinates.q
        plastic: Array = extensions - state.elements.z[:n]
        return plastic if self.incidence is None else self.incidence @ plastic


class UncertainGround(NamedTuple):
    """A ground with other properties in each motion."""

    steps: Sequence[FilterSteps]  # one for each motion, group after group
    roots: Sequence[Array]  # matrices (m, m) with root root' = covariance of the filter's states

    def of(self, group: int) -> tuple[FilterSteps, Array]:
        """The steps of the grounds of a group, and the roots of their covariances (m, m, LANES)."""
        members = slice(group * LANES, (group + 1) * LANES)
        samples = self.steps[members]
        steps: Any = {
            name: np.stack([getattr(sample, name) for sample in samples], axis=-1)
            for name in FilterSteps._fields
        }
        return FilterSteps(**steps), np.stack(self.roots[members], axis=-1)


AnyGround = FilterSteps | UncertainGround


class Plan(NamedTuple):
    """Number and length of the motions and time steps of a simulation."""

    dt: float  # time step [s]
    every: int  # number of steps from sample to sample
    burn_in: int  # number of blocks before the response is taken as stationary
    recorded: int  # number of blocks whose samples are used
    groups: int  # number of groups of motions
    seed: int
    samples: int = SAMPLES  # number of samples in a block
    first_group: int = 0  # number of the stream of the first group
    # standard deviation of the logarithm of a factor of median 1 on each motion
    scatter: float = 0.0

    @property
    def block(self) -> float:
        """Duration of a block [s]."""
        return self.dt * self.every * self.samples


class Ensemble(NamedTuple):
    """Structures that are subjected to the same simulated motions, in parts of one kind each."""

    parts: Sequence[SteppedOscillators | SteppedStructures]
    ground: AnyGround
    root: Array  # matrix with root root' = stationary covariance of the filter's states
    plan: Plan
    starts: Sequence[Array] = ()  # for each part what `begin` takes, unless motions are from rest

    @property
    def size(self) -> int:
        """Number of displacements of all parts."""
        return sum(part.size for part in self.parts)

    def at_start(self, rows: Array) -> Array:
        """Linear functions (m, n) of displacements at the start, and changes in a step (2, m)."""
        pairs = zip(self.parts, self.starts, strict=True)
        u, v = np.concatenate([part.shown(values) for part, values in pairs], axis=1)
        return np.array([times_rows(rows, u), self.plan.dt * times_rows(rows, v)])

    def over_groups(
        self, task: Callable[[MotionGroup], Any], progress: Progress | None = None
    ) -> Iterator[Any]:
        """Results of a ``task`` with the motions of each group, in the order of the groups."""
        first = self.plan.first_group
        return in_order(
            lambda group: task(MotionGroup(self, first + group)), self.plan.groups, progress
        )


class Links(NamedTuple):
    """Links between floors of an `Ensemble`, which are watched."""

    extensions: Array  # rows (l, n) [m] of the displacements of the ensemble
    parameters: Array  # (l, 5): see `watch_links`


class Extremes(NamedTuple):
    """Largest and smallest value of each function in each motion, including 0 at the start.

    Both are NaN where the function is not finite at the end, since a law has run away. With links
    also those of `LinkPeaks`. ``last`` are all displacements at the end, and ``plastic`` what is
    plastic of them, or of the drifts of storeys.
    """

    highest: Array  # (motions, m)
    lowest: Array  # (motions, m)
    force: Array  # (motions, l)
    stroke: Array  # (motions, l)
    energy: Array  # (motions, l)
    last: Array  # (motions, n)
    plastic: Array  # (motions, n)


class Sums(NamedTuple):
    """Sums over motions of the second moments ``G`` (n, n) of each motion, and of their products.

    From these sums follow the standard errors of moments and correlations.
    """

    moments: Array  # (n, n): sum of G
    squares: Array  # (n, n): sum of G_ij^2
    with_diagonal: Array  # (n, n): sum of G_ij G_ii
    diagonal: Array  # (n, n): sum of G_ii G_jj
    # (n,): sum of the increase of G_ii from the first to the second half of the motion
    change: Array
    change_squares: Array  # (n,): sum of its square


class MotionGroup:
    """A group of `LANES` motions: the state of the ground and of all structures."""

    def __init__(self, ensemble: Ensemble, group: int) -> None:
        plan = ensemble.plan
        ground = ensemble.ground
        root = ensemble.root
        self.ensemble = ensemble
        self.plan = plan
        self.group = group
        if isinstance(ground, UncertainGround):
            ground, root = ground.of(group)
        self.ground_block = ground_block(ground)
        self.random = generator_state(plan.seed, group, LANES)
        self.strength = strengths(plan, group) if plan.scatter else None
        start = np.empty((len(root), LANES))
        fill_normal(self.random, start)
        self.q = zeros_on_a_line(len(root), LANES)
        self.q[:] = root @ start if root.ndim == 2 else (root * start).sum(axis=1)
        self.states = [part.at_rest(LANES, group) for part in ensemble.parts]
        for part, state, values in zip(ensemble.parts, self.states, ensemble.starts, strict=False):
            part.begin(state, values)
        self.xi, self.f = zeros_on_a_line(2, plan.every * plan.samples, LANES)
        self.out = zeros_on_a_line(plan.samples, ensemble.size, LANES)
        self.blocks = [part.block(plan.dt, group) for part in ensemble.parts]

    def block(self, envelope: Array | None = None) -> Array:
        """Simulate the next block; returns displacements (samples, n, LANES).

        ``envelope`` has a factor on the ground acceleration for each step; a shorter one ends the
        block.
        """
        f = self.f
        out = self.out
        fill_normal(self.random, self.xi)
        self.ground_block(self.xi, self.q, f)
        if envelope is not None:
            f, out = f[: envelope.size], out[: envelope.size // self.plan.every]
            f *= envelope[:, None]
        if self.strength is not None:
            f *= self.strength
        begin = 0
        for part, block, state in zip(self.ensemble.parts, self.blocks, self.states, strict=True):
            block(f, state, self.plan.every, out, begin)
            begin += part.size
        return out

    def burn_in(self) -> None:
        """Simulate the blocks before the response is taken as stationary."""
        for _ in range(self.plan.burn_in):
            self.block()

    def under(self, envelope: Array) -> Iterator[Array]:
        """Simulate a motion under an ``envelope`` (steps,); gives displacements block by block."""
        for begin in range(0, envelope.size, self.plan.samples):
            yield self.block(envelope[begin : begin + self.plan.samples])

    def plastic(self) -> Array:
        """The plastic displacements and drifts of all structures (n, LANES)."""
        pairs = zip(self.ensemble.parts, self.states, strict=True)
        return np.concatenate([part.plastic(state) for part, state in pairs])


def strengths(plan: Plan, group: int) -> Array:
    """Random factors (LANES,) on the ground accelerations of the motions of a group."""
    normal = np.empty((1, LANES))
    fill_normal(generator_state(plan.seed, group, LANES, SCATTER_STREAM), normal)
    factors: Array = np.exp(plan.scatter * normal[0])
    return factors


def functions_of(out: Array, rows: Array) -> Array:
    """Linear functions (samples, m, LANES) of displacements ``out`` (samples, n, LANES)."""
    values = zeros_on_a_line(len(out), len(rows), LANES)
    observe(out, rows, values)
    return values


def stationary_sums(ensemble: Ensemble, rows: Array, progress: Progress | None) -> Sums:
    """Sums of the second moments of linear functions (m, n) of the stationary displacements."""
    plan = ensemble.plan

    @np.errstate(all="ignore")  # overflow gets a status of its own later
    def of_group(motion: MotionGroup) -> Sums:
        """The sums over one group of motions."""
        motion.burn_in()
        half = plan.recorded // 2
        first_half = _gram(motion, rows, half)
        second_half = _gram(motion, rows, plan.recorded - half)
        first = np.einsum("lii->li", first_half)
        second = np.einsum("lii->li", second_half)
        weight = half / (plan.recorded - half)
        change = weight * second - first
        moments = (first_half + second_half) / (plan.recorded * plan.samples)
        diagonal = np.einsum("lii->li", moments)
        return Sums(
            moments=moments.sum(axis=0),
            squares=np.einsum("lij,lij->ij", moments, moments),
            with_diagonal=np.einsum("lij,li->ij", moments, diagonal),
            # unlike with BLAS, the rounding does not depend on n
            diagonal=np.einsum("li,lj->ij", diagonal, diagonal),
            change=change.sum(axis=0),
            change_squares=(change**2).sum(axis=0),
        )

    groups = ensemble.over_groups(of_group, progress)
    return reduce(lambda total, sums: Sums(*map(add, total, sums)), groups)


def plastic_displacements(ensemble: Ensemble, stride: int) -> Array:
    """`MotionGroup.plastic` after every ``stride``-th recorded block, (times, n, motions)."""

    def of_group(motion: MotionGroup) -> Array:
        """The plastic displacements in one group of motions."""
        motion.burn_in()
        histories = np.empty((ensemble.plan.recorded // stride, ensemble.size, LANES))
        for history in histories:
            for _ in range(stride):
                motion.block()
            history[:] = motion.plastic()
        return histories

    return np.concatenate(list(ensemble.over_groups(of_group)), axis=2)


def finite_extremes(
    ensemble: Ensemble, rows: Array, envelope: Array, progress: Progress | None, links: Links
) -> Extremes:
    """Extremes of linear functions (m, n) of the displacements, and of links.

    The motions are under an ``envelope`` (steps,).

    The plan has to sample every step; its numbers of blocks are not used.
    """

    def of_group(motion: MotionGroup) -> Extremes:
        """The extremes in one group of motions."""
        begin, way, highest, lowest = np.zeros((4, len(rows), LANES))
        peaks = LinkPeaks(*np.zeros((6, len(links.parameters), LANES)))
        if ensemble.starts:
            begin[:], way[:] = ensemble.at_start(rows)[..., None]
            highest[:] = np.maximum(begin, 0.0)
            lowest[:] = np.minimum(begin, 0.0)
            peaks.extension[:], peaks.way[:] = ensemble.at_start(links.extensions)[..., None]
            peaks.elastic[:] = peaks.extension
            peaks.stroke[:] = np.abs(peaks.extension)
        for out in motion.under(envelope):
            keep_extremes(out, rows, begin, way, highest, lowest)
            if links.parameters.size:
                extensions = functions_of(out, links.extensions)
                watch_links(extensions, links.parameters, ensemble.plan.dt, peaks)
        not_finite = ~np.isfinite(functions_of(out[-1:], rows)[0])
        highest[not_finite] = lowest[not_finite] = np.nan
        return Extremes(
            highest=highest,
            lowest=lowest,
            force=peaks.force,
            stroke=peaks.stroke,
            energy=peaks.dissipated,
            last=out[-1].copy(),
            plastic=motion.plastic(),
        )

    groups = list(ensemble.over_groups(of_group, progress))
    columns = zip(*groups, strict=True)
    return Extremes._make(np.concatenate(column, axis=1).T for column in columns)


def ground_motions(ensemble: Ensemble, steps: int, progress: Progress | None) -> Array:
    """Forcing of each step (motions, steps) by the ground of an ensemble without structures."""

    def of_group(motion: MotionGroup) -> Array:
        """The forcing in one group of motions."""
        history = np.empty((steps, LANES))
        for begin in range(0, steps, ensemble.plan.samples):
            motion.block()
            part = history[begin : begin + ensemble.plan.samples]
            part[:] = motion.f[: len(part)]
        return history.T

    return np.concatenate(list(ensemble.over_groups(of_group, progress)))


def _gram(motion: MotionGroup, rows: Array, blocks: int) -> Array:
    """Sums (LANES, m, m) of ``x_i x_j`` over the samples of the next blocks."""
    size = len(rows)
    sums = zeros_on_a_line(size, size, LANES)
    for _ in range(blocks):
        add_products(functions_of(motion.block(), rows), sums)
    total = sums.transpose(2, 0, 1)
    return total + np.tril(total, -1).transpose(0, 2, 1)
