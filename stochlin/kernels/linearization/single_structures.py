"""Newton's method for single structures, whose stationary covariances have closed forms.

The unknowns and the mismatch ``F`` are those of `iteration`. Steps follow from
``(c |F| - dF/dy) step = F``. The slopes ``dF/dy`` are those of the closure times those of the response
by both coefficients, all by differences. This is pseudo-transient continuation (Kelley
and Keyes 1998, SIAM J. Numer. Anal. 35), which becomes Newton's method as ``F`` falls. Where it fails,
or where a law may have several solutions, the solution is followed from weak to full shaking.
"""

from __future__ import annotations

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
    nothing,
)

AT_LEVEL = 12  # iterations at one level of shaking
MOVED = np.eye(2, 3, 1)[..., None]  # no change, and one of each coefficient
STEPS = ALONG * np.eye(3, 4, 1)[..., None]  # the same of each unknown
DAMPING = 0.5  # c, with which the bilinear law needs 6 steps on average and at most 16
FEW = 30  # steps in two unknowns, after which there are three
FEW_CELLS = 4  # cells that are solved by numbers in place of arrays
STUCK = 24  # steps after which a cell takes a largest one, out of a least mismatch that is not zero


class SingleStructures(NamedTuple):
    """Structures of one law on their grounds, in n cells."""

    structure: Array  # (3, n) stiffness, damping and coupling of the equivalent system
    closure: Closure
    parameters: Array  # (m, n) of the law
    ground: Filter
    level: Array  # (n,): logarithm of the ratio of the shaking to the full one, as standard deviations
    rtol: float

    def at(self, cells: Array) -> SingleStructures:
        """The cells with these numbers."""
        return self._replace(
            structure=self.structure[:, cells],
            parameters=self.parameters[:, cells],
            ground=self.ground.at(cells),
            level=self.level[cells],
        )

    def closed(self, unknowns: Array) -> tuple[Array, Array]:
        """Coefficients and covariance (5, n) of the closure, and their slopes (5, 3, n)."""
        steps = moments_of(unknowns[:, None] + STEPS).reshape(3, -1)
        values = np.concatenate(self.closure(steps, np.tile(self.parameters, 4))).reshape(5, 4, -1)
        return values[:, 0], (values[:, 1:] - values[:, :1]) / ALONG

    def mismatch(self, unknowns: Array) -> tuple[Array, Array]:
        """Mismatch (3, n) of the unknowns, and its slopes (3, 3, n).

        It is NaN for systems that are not stable. This is checked by the criterion of Routh and Hurwitz,
        since on filtered ground the formulas can also give a valid covariance there.
        """
        values, slopes = self.closed(unknowns)
        by = ALONG * np.array([0 * self.structure[0] + 1, np.sqrt(self.structure[0])])
        # The response also after small changes of both coefficients.
        system = EquivalentSystem(*self.structure, *(values[:2, None] + by[:, None] * MOVED))
        own = own_covariance(system, self.ground.forcing(system))
        v_v = np.where(stable(*system) & (own.mu_mu > 0), own.v_v, np.nan)
        response, assumed = np.array([v_v, own.z_z, own.v_z]), values[2:, None]
        corr, r = correlation(response), correlation(assumed)
        scales = 0.5 * np.log(response[:2] / assumed[:2]) + self.level
        off = np.array([*scales, np.arctanh((corr - r) / (1 - corr * r))])
        of_scales = slopes[2:4] / (2 * assumed[:2])
        of_corr = slopes[4] / np.sqrt(assumed[0] * assumed[1]) - r * of_scales.sum(axis=0)
        by_slip, by_relaxation = ((off[:, 1:] - off[:, :1]) / by).swapaxes(0, 1)[:, :, None]
        of_response = by_slip * slopes[0] + by_relaxation * slopes[1]
        return off[:, 0], of_response - np.array([*of_scales, of_corr / (1 - r * r)])

    def step(self, unknowns: Array, number: int) -> tuple[Array, Array, Array]:
        """Step (3, n) from these unknowns, norm of their mismatch, and whether they are a solution."""
        off, slopes = self.mismatch(unknowns)
        norm = np.sqrt((off * off).sum(axis=0))
        matrix: Any = DAMPING * norm * np.eye(3)[..., None] - slopes
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

    In cells that have ``one_solution`` the iteration starts from the elastic response, with ``sz`` at
    most 1, and has two unknowns where the closure is one of `balance`. In the others, and where this
    fails, the solution is followed from weak to full shaking.
    ``max_iterations`` limits the steps of an iteration, and the levels of shaking along a branch.

    A cell has converged when a step changes the standard deviations by at most the share ``rtol``, and
    the correlation by at most ``rtol``.
    """
    elastic, solution = np.array([*np.log(start[:2]), np.arctanh(start[2])]), nothing(start)
    cells = np.flatnonzero(one_solution)
    if problem.closure in UNIVERSAL and cells.size and problem.ground.in_closed_form:
        limited = elastic_limit(elastic[:, cells], 1)
        add(solution, cells, balanced(problem.at(cells), limited, max_iterations))
        cells = np.flatnonzero(one_solution & ~solution.converged)
    if cells.size:
        limited = elastic_limit(elastic[:, cells], 1)
        add(solution, cells, iterate(problem.at(cells), limited, max_iterations))
    cells = np.flatnonzero(~solution.converged)
    if cells.size:
        part = problem.at(cells)

        def settle(cells: Array, level: Array, guess: Array) -> FixedPoint:
            return iterate(part.at(cells)._replace(level=level), guess, AT_LEVEL)

        add(solution, cells, follow(settle, elastic[:, cells], 1, max_iterations))
    return solution


def balanced(problem: SingleStructures, start: Array, most: int) -> FixedPoint:
    """`iterate` in the first two of these unknowns, from which the third one follows."""
    functions, n = functions_of(problem.closure), start.shape[1]
    oscillators = problem.ground.oscillators
    soil = np.ones((5, n))
    for row, entry in zip(soil, (problem.ground.intensity, *oscillators), strict=False):
        row[:] = entry
    two = BalancedStructures(problem.structure, soil, len(oscillators) // 2, functions, problem.rtol)
    solve = two.one_by_one if n <= FEW_CELLS else partial(iterate, two)
    solution = solve(start[:2], min(most, FEW))
    correlated, _ = interpolated(functions[:, 3:], solution.unknowns[1])
    return solution._replace(unknowns=np.concatenate([solution.unknowns, correlated]))


def iterate(problem: Any, start: Array, most: int) -> FixedPoint:
    """Take at most so many steps from these unknowns (u, n), each cell until it converges.

    If the unknowns have no stationary response, a smaller step from the last valid ones is tried.
    """
    n = start.shape[1]
    solution = FixedPoint(start.copy(), np.zeros(n, np.int32), np.full(n, np.inf), np.zeros(n, bool))
    base, cells = start, np.arange(n)
    for number in range(1, most + 1):
        unknowns, before = solution.unknowns[:, cells], solution.residual[cells]
        step, norm, done = problem.step(unknowns, number)
        valid = np.isfinite(norm + step.sum(axis=0))
        shorter = base + 0.25 * (unknowns - base)
        solution.unknowns[:, cells] = np.where(valid, unknowns + step, shorter)
        solution.iterations[cells] += 1
        solution.residual[cells] = np.where(valid, norm, before)
        solution.converged[cells] = done = done & valid
        base, left = np.where(valid, unknowns, base), np.flatnonzero(~done)
        if not left.size:
            break
        if left.size < cells.size:
            cells, base, problem = cells[left], base[:, left], problem.at(left)
    return solution


def moments_of(unknowns: Array) -> Array:
    """The moments ``sv, sz, r`` (3, ...) of the unknowns."""
    return np.array([*np.exp(unknowns[:2]), np.tanh(unknowns[2])])


def correlation(covariance: Array) -> Array:
    """Correlation of ``v`` and ``z`` from ``Var v``, ``Var z`` and ``Cov(v, z)``."""
    return covariance[2] / np.sqrt(covariance[0] * covariance[1])
