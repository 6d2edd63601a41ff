"""How a solution of statistical linearization is followed from weak to full shaking.

The unknowns are the moments ``(sigma_v, sigma_z, corr(v, z))`` of the Gaussian density that a
closure assumes for each of m springs that yield, in the variables ``(log, log, atanh)``, in which
every iterate is a valid density for any hysteresis law: first ``log sigma_v`` of all springs, then
their ``log sigma_z`` and ``atanh corr``. The mismatch is the difference of two sets of moments:
those of the stationary response of the linear system with the closure's coefficients, less those
that the closure assumes.

Single structures are iterated by Newton's method with closed forms of the moments
(`single_structures`), systems of springs by the substitution of the paper with mixing
(`systems.springs`).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array

# standard deviation of the elastic ductility at which hardly any structure yields
WEAK_SHAKING = 0.3
# rise of the logarithm of the shaking
FIRST_RISE = 0.5
LONGER = 2.0
SHORTER = 0.5
LEAST_RISE = 1e-4
ALONG = 1e-6  # step of the differences for slopes of the mismatch
LARGEST_STEP = 1.0  # largest step in log(sigma) and atanh(corr)
LARGEST_MISMATCH = 1e-7  # largest norm of the mismatch of a converged cell
# largest distance of a solution from its extrapolation for the same branch of solutions
SAME_BRANCH = 0.05


class FixedPoint(NamedTuple):
    """The last iterate of each cell; NaN in cells that were not tried."""

    unknowns: Array  # (u, n)
    iterations: Array  # (n,)
    residual: Array  # (n,): norm of the mismatch
    converged: Array  # (n,)


def elastic_limit(elastic: Array, springs: int) -> Array:
    """Unknowns (u, n) of the elastic response, with ``sigma_z`` of the ``springs`` at most 1."""
    limited = elastic.copy()
    z = slice(springs, 2 * springs)
    limited[z] = np.minimum(elastic[z], 0.0)
    return limited


def follow(
    settle: Callable[[Array, Array, Array], FixedPoint],
    elastic: Array,
    springs: int,
    most_levels: int,
) -> FixedPoint:
    """Follow a branch of solutions from weak to full shaking, level by level.

    ``settle`` has the fixed points of the cells with these numbers, at a level of shaking and from
    these unknowns; ``elastic`` (u, n) are those of the elastic response.

    A level is the logarithm of the ratio of the shaking to the full one. It begins where hardly any
    spring yields. The solution at the next level is extrapolated linearly from the last two. A
    solution that is farther than `SAME_BRANCH` from its extrapolation belongs to another branch,
    and the step is repeated with a lower level.
    """
    m = springs
    n = elastic.shape[1]
    # slope of the unknowns by the level, first that of the elastic response
    slope = np.ones_like(elastic)
    slope[2 * m : 3 * m] = 0.0  # which keeps its correlations
    strongest = elastic[m : 2 * m].max(axis=0, initial=-np.inf)
    level = np.minimum(0.0, np.log(WEAK_SHAKING) - strongest) - FIRST_RISE
    y = elastic + slope * level
    rise = np.full(n, FIRST_RISE)
    near = np.full(n, np.inf)  # the first solution may be anywhere
    solution = unsolved(elastic)
    cells = np.arange(n)
    for _ in range(most_levels):
        at = np.minimum(0.0, level[cells] + rise[cells])
        guess = y[:, cells] + slope[:, cells] * (at - level[cells])
        fixed_point = settle(cells, at, guess)
        reached = fixed_point.unknowns
        good = fixed_point.converged & (np.abs(reached - guess).max(axis=0) <= near[cells])
        add(solution, cells, fixed_point._replace(converged=good & (at == 0)))
        advanced = cells[good]
        followed = np.isfinite(near[cells[good]])
        new_slope = (reached[:, good] - y[:, advanced]) / (at[good] - level[advanced])
        slope[:, advanced] = np.where(followed, new_slope, slope[:, advanced])
        y[:, advanced] = reached[:, good]
        level[advanced] = at[good]
        near[advanced] = SAME_BRANCH
        rise[cells] *= np.where(good, LONGER, SHORTER)
        cells = np.flatnonzero(~solution.converged & (rise > LEAST_RISE))
        if not cells.size:
            break
    return solution


def unsolved(unknowns: Array) -> FixedPoint:
    """A result of cells of which none is solved yet."""
    none = np.full(unknowns.shape[1], np.nan)
    return FixedPoint(np.full_like(unknowns, np.nan), np.zeros(none.size, np.int32), none, none > 0)


def add(solution: FixedPoint, cells: Array, fixed_point: FixedPoint) -> None:
    """Write the results of some cells into those of all, and add their iterations."""
    iterations = fixed_point.iterations + solution.iterations[cells]
    for field, value in zip(solution, fixed_point._replace(iterations=iterations), strict=True):
        field[..., cells] = value
