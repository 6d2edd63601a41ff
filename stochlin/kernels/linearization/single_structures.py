"""Newton's method for single structures, whose stationary covariances have closed forms.

The fixed point of linearization is the stationary solution of ``y' = F(y)``, with the unknowns and the
mismatch ``F`` of `iteration`. It is approached by pseudo-transient continuation (Kelley and Keyes 1998,
SIAM J. Numer. Anal. 35), with steps from ``(1/delta - dF/dy) step = F``, which become those of Newton's
method as the pseudo-time step ``delta`` grows. The slopes are differences. A `StepControl` says how
``delta`` begins, grows while ``F`` falls, and shrinks where it does not.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.elementary import solve_3x3
from stochlin.kernels.linearization.covariance import (
    EquivalentSystem,
    own_covariance,
    stable,
)
from stochlin.kernels.linearization.filters import Filter
from stochlin.kernels.linearization.gaussian import Closure, ClosureValue
from stochlin.kernels.linearization.iteration import FixedPoint, add, elastic_limit, follow, nothing


class StepControl(NamedTuple):
    """Control of the pseudo-time step: its first value and how it changes."""

    first: float  # first pseudo-time step
    restart: float  # upper bound after a rise of the mismatch
    shorter: float  # factor after a rise of the mismatch
    longer: float  # factor after a fall, besides the ratio of the mismatches
    longest: float  # largest factor after a fall


# Nearly Newton's method, and short pseudo-time steps.
BOLD = StepControl(first=30.0, restart=1.0, shorter=0.25, longer=3.0, longest=100.0)
CAREFUL = StepControl(first=0.5, restart=0.5, shorter=0.5, longer=1.1, longest=1.5)
# Share of max_iterations for nearly Newton's method: 30 of 200, while the bilinear law needs 13.
BOLD_SHARE = 0.15
AT_LEVEL = 12  # iterations at one level of shaking
ALONG = 1e-6  # step of the differences for the slopes
MOVED = ALONG * np.eye(3, 4, 1)  # no step, and one of each unknown
LARGEST_STEP = 1.0  # largest step in log(sigma) and atanh(corr)
LEAST_DELTA = 0.05  # smallest pseudo-time step
LARGEST_MISMATCH = 1e-6  # largest norm of the mismatch of a converged cell
CHUNK = 8192  # cells solved together, which limits the temporary arrays of a step


class State(NamedTuple):
    """State of the iteration of n cells, with u = 3 unknowns."""

    base: Array  # (u, n) the last iterate that has a stationary response
    norm: Array  # (n,) norm of its mismatch F
    step: Array  # (u, n) the next iterate less base
    delta: Array  # (n,) pseudo-time step, from which this step was found
    done: Array  # (n,) whether it has converged

    @classmethod
    def begin(cls, unknowns: Array, pace: StepControl) -> State:
        """Before the first evaluation; the first iterate is ``unknowns`` (u, n) itself."""
        n = unknowns.shape[1]
        first = np.full(n, np.inf), np.zeros_like(unknowns), np.full(n, pace.first), np.zeros(n, bool)
        return cls(unknowns.copy(), *first)

    @property
    def ended(self) -> Array:
        """The cells (n,) that have converged, or whose next step is not a number."""
        ended: Array = self.done | ~np.isfinite(self.step).all(axis=0)
        return ended

    def at(self, cells: Array) -> State:
        """The state of the cells with these numbers."""
        return State(*(part.take(cells, axis=-1) for part in self))

    def put(self, cells: Array, state: State) -> None:
        """Replace the state of the cells with these numbers."""
        for whole, part in zip(self, state, strict=True):
            whole[..., cells] = part


class Law(NamedTuple):
    """Hysteresis law of n cells."""

    closure: Closure
    parameters: Array  # (m, n)
    one_solution: Array  # (n,) whether linearization is known to have at most one solution

    def at(self, cells: Array) -> Law:
        """The cells with these numbers, or those for which this is true."""
        return Law(self.closure, self.parameters[:, cells], self.one_solution[cells])


class SingleStructures(NamedTuple):
    """Single structures on their grounds, those of one law after those of another."""

    structure: Array  # (3, n) stiffness, damping and coupling of the equivalent system
    laws: Sequence[Law]
    ground: Filter
    level: Array  # (n,): logarithm of the ratio of the shaking to the full one, as standard deviations
    rtol: float
    atol: float

    def by_law(self, cells: Array) -> Iterator[tuple[Law, Array]]:
        """Each law with its part of an array (..., n)."""
        ends = np.cumsum([law.one_solution.size for law in self.laws])[:-1]
        return zip(self.laws, np.split(cells, ends, axis=-1), strict=True)

    def at(self, cells: Array) -> SingleStructures:
        """The cells with these numbers, which increase."""
        if cells.size == self.level.size:
            return self
        chosen = np.zeros(self.level.size, bool)
        chosen[cells] = True
        laws = [law.at(own) for law, own in self.by_law(chosen)]
        structure, level = self.structure[:, cells], self.level[cells]
        return SingleStructures(structure, laws, self.ground.at(cells), level, self.rtol, self.atol)

    def closure(self, latent: Array) -> ClosureValue:
        """What the closures have for these moments (3, ..., n)."""
        values = []
        for law, own in self.by_law(latent):
            parameters = np.tile(law.parameters, math.prod(own.shape[1:-1]))
            rows = law.closure(own.reshape(3, math.prod(own.shape[1:])), parameters)
            values.append([row.reshape(len(row), *own.shape[1:]) for row in rows])
        return ClosureValue(*(np.concatenate(rows, axis=-1) for rows in zip(*values, strict=True)))

    def settle(self, unknowns: Array, most: int, pace: StepControl) -> FixedPoint:
        """The fixed points from these unknowns (3, n) in at most so many steps."""
        n = self.level.size
        chunks = np.split(np.arange(n), np.arange(CHUNK, n, CHUNK))
        parts = [iterate(self.at(cells), unknowns[:, cells], most, pace) for cells in chunks]
        return FixedPoint(*map(np.hstack, zip(*parts, strict=True)))

    def advance(self, state: State, pace: StepControl) -> State:
        """One step of all cells.

        If the unknowns have no stationary response, a smaller step from the last valid ones is tried;
        before the first valid ones, a more elastic start.
        """
        base, before, step, delta, _ = state
        unknowns = base + step
        off, *moved = self.mismatch(unknowns[:, None] + MOVED[..., None]).swapaxes(0, 1)
        jacobian = (np.stack(moved, axis=1) - off[:, None]) / ALONG
        norm = np.sqrt((off * off).sum(axis=0))
        valid = np.isfinite(norm + jacobian.sum(axis=(0, 1)))
        delta = next_delta(delta, before, np.where(valid, norm, np.inf), pace)
        # Convergence is judged by Newton's step, since a damped step is also small if delta is small.
        damped, full = newton_steps(jacobian, off, np.array([1 / delta, 0 * delta])).swapaxes(0, 1)
        more_elastic = step - np.array([0 * norm, 0 * norm + 1.0, 0.5 * unknowns[2]])
        shorter = np.where(np.isinf(before), more_elastic, 0.25 * step)
        r = np.tanh(unknowns[2])
        of_r = (1 - r * r) * self.rtol / (self.atol + self.rtol * np.abs(r))
        still = (np.abs(full[:2]).max(axis=0) <= self.rtol) & (np.abs(full[2]) * of_r <= self.rtol)
        return State(
            np.where(valid, unknowns, base),
            np.where(valid, norm, before),
            np.where(valid, damped, shorter),
            delta,
            valid & (norm <= LARGEST_MISMATCH) & still,
        )

    def mismatch(self, unknowns: Array) -> Array:
        """Mismatch (3, ..., n) of the unknowns.

        It is NaN for systems that are not stable. This is checked by the criterion of Routh and Hurwitz,
        since on filtered ground the formulas can also give a valid covariance there.
        """
        value = self.closure(moments_of(unknowns))
        system = EquivalentSystem(*self.structure, *value.coefficients)
        own = own_covariance(system, self.ground.forcing(system))
        v_v = np.where(stable(*system) & (own.mu_mu > 0), own.v_v, np.nan)
        response, assumed = np.array([v_v, own.z_z, own.v_z]), value.covariance
        corr, r = correlation(response), correlation(assumed)
        scales = 0.5 * np.log(response[:2] / assumed[:2]) + self.level
        return np.array([*scales, np.arctanh((corr - r) / (1 - corr * r))])


@np.errstate(all="ignore")  # an iterate may belong to an unstable system, without moments
def solve_structures(problem: SingleStructures, start: Array, max_iterations: int) -> FixedPoint:
    """The fixed points of all cells, from the moments ``sv, sz, r`` (3, n) of the elastic response.

    In cells with at most one solution the iteration starts from the elastic response, with ``sz`` at
    most 1, in large steps and then in small ones. In the others, and where this fails, the branch of
    solutions that begins with the elastic response to weak shaking is followed up to full shaking.
    ``max_iterations`` limits the steps of an iteration, or the levels of shaking along a branch.

    A cell has converged when ``|dy| <= atol + rtol |y|`` for each of its moments ``y``; ``atol`` applies
    to the correlation only, since the other two are positive scales.
    """
    elastic = np.array([*np.log(start[:2]), np.arctanh(start[2])])
    bold = max(1, int(BOLD_SHARE * max_iterations))
    solution, careful = nothing(elastic), max_iterations - bold
    one_solution = np.concatenate([law.one_solution for law in problem.laws])
    for pace, most in ((BOLD, bold), (CAREFUL, careful)):
        cells = np.flatnonzero(~solution.converged & one_solution)
        if cells.size and most:
            limited = elastic_limit(elastic[:, cells], 1)
            add(solution, cells, problem.at(cells).settle(limited, most, pace))
    cells = np.flatnonzero(~solution.converged)
    if cells.size and careful:
        part = problem.at(cells)

        def settle(cells: Array, level: Array, guess: Array) -> FixedPoint:
            return part.at(cells)._replace(level=level).settle(guess, AT_LEVEL, BOLD)

        add(solution, cells, follow(settle, elastic[:, cells], 1, careful))
    return solution


def iterate(problem: SingleStructures, unknowns: Array, most: int, pace: StepControl) -> FixedPoint:
    """Take at most so many steps from these unknowns, each cell until it converges."""
    whole = State.begin(unknowns, pace)
    state, part, cells = whole, problem, np.arange(unknowns.shape[1])
    iterations = np.zeros(cells.size, np.int32)
    for _ in range(most):
        state = part.advance(state, pace)
        iterations[cells] += 1
        whole.put(cells, state)
        left = np.flatnonzero(~state.ended)
        if not left.size:
            break
        if left.size < cells.size:
            state, part, cells = state.at(left), part.at(left), cells[left]
    return FixedPoint(whole.base + whole.step, iterations, whole.norm, whole.done)


def moments_of(unknowns: Array) -> Array:
    """The moments ``sv, sz, r`` (3, n) of the unknowns."""
    moments = np.exp(unknowns)
    np.tanh(unknowns[2], out=moments[2])
    return moments


def next_delta(delta: Array, before: Array, now: Array, pace: StepControl) -> Array:
    """Next pseudo-time step, by switched evolution relaxation: longer if the mismatch has fallen."""
    ratio = np.where(np.isinf(before) | (now == 0), 1.0, before / now)
    shorter = np.maximum(pace.shorter * np.minimum(delta, pace.restart), LEAST_DELTA)
    longer = delta * np.minimum(pace.longer * ratio, pace.longest)
    return np.where(ratio < 1, shorter, longer)


def newton_steps(jacobian: Array, mismatch: Array, damping: Array) -> Array:
    """``(damping - J)^-1 F`` (3, k, n), limited to `LARGEST_STEP`, for ``damping`` (k, n).

    It is Newton's step for a damping of 0.
    """
    (a, b, c), (d, e, f), (g, h, i) = -jacobian
    matrix = (damping + a, b, c), (d, damping + e, f), (g, h, damping + i)
    steps = np.array(solve_3x3(matrix, [*mismatch]))
    return steps / np.maximum(1.0, np.abs(steps).max(axis=0) / LARGEST_STEP)


def correlation(covariance: Array) -> Array:
    """Correlation of ``v`` and ``z`` from ``Var v``, ``Var z`` and ``Cov(v, z)``."""
    return covariance[2] / np.sqrt(covariance[0] * covariance[1])
