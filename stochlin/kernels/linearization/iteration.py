"""How a solution of statistical linearization is searched, and followed from weak to full shaking.

The unknowns are the moments ``(sigma_v, sigma_z, corr(v, z))`` of the Gaussian density that a closure
assumes for each spring that yields, in the variables ``(log, log, atanh)``, in which every iterate is a
valid density for any hysteresis law. The mismatch ``F`` is the difference of two sets of moments: those
of the stationary response of the linear system with the closure's coefficients, less those that the
closure assumes.

`solve` decides from where and by which steps to iterate single structures: it tries large steps, then
small ones, and then follows the solution from weak to full shaking. The iteration is that of the
`Problem`, Newton's method with closed forms of the moments (`single_structures`). Systems of springs
have the substitution of the paper with mixing (`systems.springs`), and are followed by `follow` too.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import NamedTuple, Protocol, Self

import numpy as np

from stochlin.kernels.basics.arrays import Array


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
WEAK = 0.3  # standard deviation of the elastic ductility at which hardly any structure yields
FIRST_RISE, LONGER, SHORTER, LEAST_RISE = 0.5, 2.0, 0.5, 1e-4  # rise of the logarithm of the shaking
AT_LEVEL = 12  # iterations at one level of shaking
NEAR = 0.05  # largest distance of a solution from its extrapolation for the same branch of solutions


class FixedPoint(NamedTuple):
    """The last iterate of each cell; NaN in cells that were not tried."""

    unknowns: Array  # (u, n)
    coefficients: Array  # (k, n): of single structures 1 + c_e and k_e
    iterations: Array  # (n,)
    residual: Array  # (n,): norm of the mismatch
    converged: Array  # (n,)


class Problem(Protocol):
    """Cells whose equivalent coefficients are sought, as `solve` needs them.

    The unknowns are ``log sigma_v`` of the m springs, their ``log sigma_z`` and their ``atanh corr``.
    """

    @property
    def springs(self) -> int:
        """Number m of the springs that yield in a cell."""
        raise NotImplementedError

    @property
    def size(self) -> int:
        """Number k of the equivalent coefficients of a cell."""
        raise NotImplementedError

    def at(self, cells: Array) -> Self:
        """The cells with these numbers."""
        raise NotImplementedError

    def shaken(self, level: Array) -> Self:
        """The cells under other shaking, with this logarithm (n,) of the ratio to the full one."""
        raise NotImplementedError

    def settle(self, unknowns: Array, most: int, pace: StepControl) -> FixedPoint:
        """The fixed points from these unknowns (u, n) in at most so many steps."""
        raise NotImplementedError


def solve(problem: Problem, elastic: Array, one_solution: Array, max_iterations: int) -> FixedPoint:
    """Solve all cells, whose elastic response has the unknowns ``elastic`` (u, n).

    Cells for which ``one_solution`` (n,) is true have at most one solution, and the iteration starts
    from the elastic response, with ``sigma_z`` at most 1. For the others, and where this fails, the
    branch of solutions that begins with the elastic response to weak shaking is followed up to full
    shaking. ``max_iterations`` limits the steps of an iteration, or the levels of shaking along a
    branch.
    """
    m, bold = problem.springs, max(1, int(BOLD_SHARE * max_iterations))
    yielding, solution = elastic_limit(elastic, m), nothing(problem.size, elastic)
    for pace, most in ((BOLD, bold), (CAREFUL, max_iterations - bold), (None, max_iterations - bold)):
        allowed = one_solution if pace else True
        cells = np.flatnonzero(~solution.converged & allowed)
        if cells.size and most > 0:
            part = problem.at(cells)
            if pace:
                fixed_point = part.settle(yielding[:, cells], most, pace)
            else:
                settle = partial(_settled, part)
                fixed_point = follow(settle, elastic[:, cells], m, part.size, most)
            add(solution, cells, fixed_point)
    return solution


def elastic_limit(elastic: Array, springs: int) -> Array:
    """The unknowns (u, n) of the elastic response, with ``sigma_z`` of the ``springs`` at most 1."""
    limited, z = elastic.copy(), slice(springs, 2 * springs)
    limited[z] = np.minimum(elastic[z], 0.0)
    return limited


def _settled(problem: Problem, cells: Array, level: Array, guess: Array) -> FixedPoint:
    """The fixed points of some cells at a level of shaking."""
    return problem.at(cells).shaken(level).settle(guess, AT_LEVEL, BOLD)


def follow(
    settle: Callable[[Array, Array, Array], FixedPoint],
    elastic: Array,
    springs: int,
    size: int,
    most_levels: int,
) -> FixedPoint:
    """Follow a branch of solutions from weak to full shaking, level by level.

    ``settle`` has the fixed points, with ``size`` coefficients, of the cells with these numbers, at a
    level of shaking and from these unknowns.

    A level is the logarithm of the ratio of the shaking to the full one. It begins where hardly any
    spring yields. The solution at the next level is extrapolated linearly from the last two. A solution
    that is farther than `NEAR` from its extrapolation belongs to another branch, and the step is
    repeated with a lower level.
    """
    m, n = springs, elastic.shape[1]
    slope = np.ones_like(elastic)  # of the unknowns by the level, first that of the elastic response
    slope[2 * m : 3 * m] = 0.0  # which keeps its correlations
    strongest = elastic[m : 2 * m].max(axis=0, initial=-np.inf)
    level = np.minimum(0.0, np.log(WEAK) - strongest) - FIRST_RISE
    y, rise = elastic + slope * level, np.full(n, FIRST_RISE)
    near = np.full(n, np.inf)  # the first solution may be anywhere
    solution, cells = nothing(size, elastic), np.arange(n)
    for _ in range(most_levels):
        at = np.minimum(0.0, level[cells] + rise[cells])
        guess = y[:, cells] + slope[:, cells] * (at - level[cells])
        fixed_point = settle(cells, at, guess)
        reached = fixed_point.unknowns
        good = fixed_point.converged & (np.abs(reached - guess).max(axis=0) <= near[cells])
        add(solution, cells, fixed_point._replace(converged=good & (at == 0)))
        on, known = cells[good], np.isfinite(near[cells[good]])
        found_slope = (reached[:, good] - y[:, on]) / (at[good] - level[on])
        slope[:, on] = np.where(known, found_slope, slope[:, on])
        y[:, on], level[on], near[on] = reached[:, good], at[good], NEAR
        rise[cells] *= np.where(good, LONGER, SHORTER)
        cells = np.flatnonzero(~solution.converged & (rise > LEAST_RISE))
        if not cells.size:
            break
    return solution


def nothing(size: int, unknowns: Array) -> FixedPoint:
    """The result for cells that are not yet solved."""
    n = unknowns.shape[1]
    coefficients, none = np.full((size, n), np.nan), np.full(n, np.nan)
    return FixedPoint(0 * unknowns + np.nan, coefficients, np.zeros(n, np.int32), none, none > 0)


def add(solution: FixedPoint, cells: Array, fixed_point: FixedPoint) -> None:
    """Write the results of some cells into those of all, and add their iterations."""
    spent = fixed_point.iterations + solution.iterations[cells]
    for field, value in zip(solution, fixed_point._replace(iterations=spent), strict=True):
        field[..., cells] = value
