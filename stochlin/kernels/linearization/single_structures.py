"""Newton's method for single structures, whose stationary covariances have closed forms.

The unknowns and the mismatch ``F`` are those of `iteration`. Steps follow from ``(c |F| - dF/dy)
step = F``, with slopes ``dF/dy`` by differences. This is pseudo-transient continuation (Kelley and
Keyes 1998, SIAM J. Numer. Anal. 35), which becomes Newton's method as ``F`` falls. Where it fails,
or where a law may have several solutions, the solution is followed from weak to full shaking.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array, solve_3x3
from stochlin.kernels.linearization.balance import (
    UNIVERSAL,
    BalancedStructures,
    functions_of,
    interpolated,
)
from stochlin.kernels.linearization.covariance import EquivalentSystem, own_covariance, stable
from stochlin.kernels.linearization.filters import Filter
from stochlin.kernels.linearization.gaussian import Closure
from stochlin.kernels.linearization.iteration import (
    ALONG,
    LARGEST_MISMATCH,
    LARGEST_STEP,
    FixedPoint,
    add,
    elastic_limit,
    follow,
    unsolved,
)

ITERATIONS_AT_LEVEL = 12  # iterations at one level of shaking
TRIAL_STEPS = ALONG * np.eye(3, 4, 1)[..., None]  # no change, and one of each unknown
ITERATION_DAMPING = 0.5  # c, with which the bilinear law needs 6 steps on average and at most 16
STEPS_IN_TWO_UNKNOWNS = 30  # steps in two unknowns, after which there are three
FEW_CELLS = 4  # cells that are solved by numbers in place of arrays
STUCK = 24  # steps after which a cell takes a largest one, out of a least mismatch that is not zero


class SingleStructures(NamedTuple):
    """Structures of one law on their grounds, in n cells."""

    structure: Array  # (3, n) stiffness, damping and coupling of the equivalent system
    closure: Closure
    parameters: Array  # (m, n) of the law
    ground: Filter
    # (n,): logarithm of the ratio of the shaking to the full one, as standard deviations
    level: Array
    rtol: float

    def at(self, cells: Array) -> SingleStructures:
        """The cells with these numbers."""
        return self._replace(
            structure=self.structure[:, cells],
            parameters=self.parameters[:, cells],
            ground=self.ground.at(cells),
            level=self.level[cells],
        )

    def mismatch(self, unknowns: Array) -> Array:
        """Mismatch (3, k, n) of unknowns of the same shape.

        It is NaN for systems that are not stable. This is checked by the criterion of Routh and
        Hurwitz, since on filtered ground the formulas can also give a valid covariance there.
        """
        points = unknowns.shape[1]
        latent = moments_of(unknowns).reshape(3, -1)
        values = np.concatenate(self.closure(latent, np.tile(self.parameters, points)))
        slip, relaxation, *assumed = values.reshape(5, points, -1)
        w2, d, h = self.structure
        system = EquivalentSystem(w2, d, h, slip, relaxation)
        covariance = own_covariance(system, self.ground.forcing(system))
        v_v = np.where(stable(*system) & (covariance.mu_mu > 0), covariance.v_v, np.nan)
        corr = correlation((v_v, covariance.z_z, covariance.v_z))
        r = correlation(assumed)
        scales = 0.5 * np.log([v_v / assumed[0], covariance.z_z / assumed[1]]) + self.level
        return np.array([*scales, np.arctanh((corr - r) / (1 - corr * r))])

    def step(self, unknowns: Array, number: int) -> tuple[Array, Array, Array]:
        """Step (3, n) from unknowns, norm of their mismatch, and whether they are a solution."""
        mismatch = self.mismatch(unknowns[:, None] + TRIAL_STEPS)
        off = mismatch[:, 0]
        slopes = (mismatch[:, 1:] - mismatch[:, :1]) / ALONG
        norm = np.sqrt((off * off).sum(axis=0))
        matrix: Any = ITERATION_DAMPING * norm * np.eye(3)[..., None] - slopes
        step = np.array(solve_3x3(matrix, [*off]))
        step /= np.maximum(1.0, np.abs(step).max(axis=0) / LARGEST_STEP)
        change = np.abs([step[0], step[1], step[2] / np.cosh(unknowns[2]) ** 2]).max(axis=0)
        done = (change <= self.rtol) & (norm <= LARGEST_MISMATCH)
        if number % STUCK == 0:
            step /= np.where(done, LARGEST_STEP, np.abs(step).max(axis=0)) / LARGEST_STEP
        return step, norm, done


@np.errstate(all="ignore")  # an iterate may belong to an unstable system, without moments
def solve_structures(
    problem: SingleStructures, start: Array, one_solution: Array, max_iterations: int
) -> FixedPoint:
    """The fixed points of all cells, from the moments ``sv, sz, r`` (3, n) of the elastic response.

    In cells that have ``one_solution`` the iteration starts from the elastic response, with ``sz``
    at most 1, and has two unknowns where the closure is one of `balance`. In the others, and where
    this fails, the solution is followed from weak to full shaking. ``max_iterations`` limits the
    steps of an iteration, and the levels of shaking along a branch.

    A cell has converged when a step changes the standard deviations by at most the share ``rtol``,
    and the correlation by at most ``rtol``.
    """
    elastic = np.array([*np.log(start[:2]), np.arctanh(start[2])])
    solution = unsolved(start)
    cells = np.flatnonzero(one_solution)
    if problem.closure in UNIVERSAL and cells.size and problem.ground.in_closed_form:
        limited = elastic_limit(elastic[:, cells], 1)
        part = problem.at(cells) if cells.size < one_solution.size else problem
        add(solution, cells, balanced(part, limited, max_iterations))
        cells = np.flatnonzero(one_solution & ~solution.converged)
    if cells.size:
        limited = elastic_limit(elastic[:, cells], 1)
        add(solution, cells, iterate(problem.at(cells), limited, max_iterations))
    cells = np.flatnonzero(~solution.converged)
    if cells.size:
        part = problem.at(cells)

        def settle(cells: Array, level: Array, guess: Array) -> FixedPoint:
            return iterate(part.at(cells)._replace(level=level), guess, ITERATIONS_AT_LEVEL)

        add(solution, cells, follow(settle, elastic[:, cells], 1, max_iterations))
    return solution


def balanced(problem: SingleStructures, start: Array, most: int) -> FixedPoint:
    """`iterate` in the first two of these unknowns, from which the third one follows."""
    functions = functions_of(problem.closure)
    n = start.shape[1]
    oscillators = problem.ground.oscillators
    ground = np.ones((5, n))
    for row, entry in zip(ground, (problem.ground.intensity, *oscillators), strict=False):
        row[:] = entry
    two = BalancedStructures(
        problem.structure, ground, len(oscillators) // 2, functions, problem.rtol
    )
    solve = two.one_by_one if n <= FEW_CELLS else partial(iterate, two)
    solution = solve(start[:2], min(most, STEPS_IN_TWO_UNKNOWNS))
    correlated, _ = interpolated(functions[:, 3:], solution.unknowns[1])
    return solution._replace(unknowns=np.concatenate([solution.unknowns, correlated]))


def iterate(problem: Any, start: Array, most: int) -> FixedPoint:
    """Take at most so many steps from these unknowns (u, n), each cell until it converges.

    If the unknowns have no stationary response, a smaller step from the last valid ones is tried.
    """
    n = start.shape[1]
    solution = FixedPoint(
        start.copy(), np.zeros(n, np.int32), np.full(n, np.inf), np.zeros(n, bool)
    )
    base = start
    cells = np.arange(n)
    for number in range(1, most + 1):
        unknowns = solution.unknowns[:, cells]
        before = solution.residual[cells]
        step, norm, done = problem.step(unknowns, number)
        valid = np.isfinite(norm + step.sum(axis=0))
        shorter = base + 0.25 * (unknowns - base)
        solution.unknowns[:, cells] = np.where(valid, unknowns + step, shorter)
        solution.iterations[cells] += 1
        solution.residual[cells] = np.where(valid, norm, before)
        solution.converged[cells] = done = done & valid
        base = np.where(valid, unknowns, base)
        left = np.flatnonzero(~done)
        if not left.size:
            break
        if left.size < cells.size:
            cells = cells[left]
            base = base[:, left]
            problem = problem.at(left)
    return solution


def moments_of(unknowns: Array) -> Array:
    """The moments ``sv, sz, r`` (3, ...) of the unknowns."""
    return np.array([*np.exp(unknowns[:2]), np.tanh(unknowns[2])])


def correlation(covariance: Sequence[Array]) -> Array:
    """Correlation of ``v`` and ``z`` from ``Var v``, ``Var z`` and ``Cov(v, z)``."""
    return covariance[2] / np.sqrt(covariance[0] * covariance[1])
