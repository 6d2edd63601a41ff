"""The fixed point of statistical linearization, solved for all cells at once.

The unknowns are the moments ``(sigma_v, sigma_z, corr(v, z))`` of the Gaussian density that a closure
assumes, in the variables ``(log, log, atanh)``, in which every iterate is a valid density for any
hysteresis law. The mismatch ``F`` is the difference of two sets of moments: those of the stationary
response of the linear system with the closure's coefficients, less those that the closure assumes. The
fixed point is the stationary solution of ``y' = F(y)``. It is approached by pseudo-transient
continuation (Kelley and Keyes 1998, SIAM J. Numer. Anal. 35), with steps from
``(1/delta - dF/dy) step = F``, which become those of Newton's method as ``delta`` grows.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.compiled import worth_compiling
from stochlin.kernels.basics.parallel import in_ranges
from stochlin.kernels.linearization.cells.fixed_points import (
    FOUND,
    OF_GROUND,
    settle,
    settle_cells,
)
from stochlin.kernels.linearization.cells.steps import (
    BASE,
    DELTA,
    DONE,
    NORM,
    STATE,
    STEP,
    Pace,
    advance_cells,
    slope_of_unknowns,
)
from stochlin.kernels.linearization.covariance import EquivalentSystem
from stochlin.kernels.linearization.filters import Filter
from stochlin.kernels.linearization.gaussian import Closure, clipped, gaussian

CLIPPED: dict[Closure, bool] = {gaussian: False, clipped: True}  # closures that `cells.fixed_points` has
CHUNK = 2048  # cells solved together: the temporary arrays of a step then stay in the cache
BOLD = Pace(first=30.0, restart=1.0, shorter=0.25, longer=3.0, longest=100.0)  # nearly Newton's method
CAREFUL = Pace(first=0.5, restart=0.5, shorter=0.5, longer=1.1, longest=1.5)  # short pseudo-time steps
WEAK = 0.3  # standard deviation of the elastic ductility at which hardly any structure yields
FIRST_RISE, LONGER, SHORTER, LEAST_RISE = 0.5, 2.0, 0.5, 1e-4  # rise of the logarithm of the shaking
AT_LEVEL = 12  # iterations at one level of shaking
NEAR = 0.05  # largest distance of a solution from its extrapolation for the same branch of solutions
# Share of max_iterations for nearly Newton's method: 30 of 200, while the bilinear law needs 13.
BOLD_SHARE = 0.15


class FixedPoint(NamedTuple):
    """The last iterate of each cell."""

    coefficients: Array  # (2, n): 1 + c_e, k_e
    latent: Array  # (3, n): moments sv, sz, r of the closure's Gaussian density
    iterations: Array  # (n,)
    residual: Array  # (n,): Euclidean norm of the mismatch of (log sigma_v, log sigma_z, atanh corr)
    converged: Array  # (n,)


def solve_fixed_point(
    structure: Array,
    law: Array,
    ground: Filter,
    start: Array,
    one_solution: Array,
    closure: Closure,
    rtol: float,
    atol: float,
    max_iterations: int,
) -> FixedPoint:
    """Solve all cells, in chunks, on all cores.

    ``structure`` (3, n) has stiffness, damping and coupling of the equivalent system, and ``start`` (3,
    n) the moments ``sv, sz, r`` of the elastic response; ``law`` (m, n) has the parameters of the law,
    for the closure. Cells for which ``one_solution`` (n,) is true have at most one solution, and the
    iteration starts from the elastic response. For the others the branch of solutions that begins with
    the elastic response to weak shaking is followed up to full shaking. A cell has converged when
    ``|dy| <= atol + rtol |y|`` for each of its moments ``y``; ``atol`` applies to the correlation only,
    since the other two are positive scales. ``max_iterations`` limits the steps of an iteration, or the
    levels of shaking along a branch.
    """
    level = np.zeros(start.shape[1])
    whole = _Problem(structure, law, ground, one_solution, level, closure, rtol, atol)

    @np.errstate(all="ignore")  # an iterate may belong to an unstable system, without moments
    def part(cells: slice) -> FixedPoint:
        return _solve(whole.of(cells), start[:, cells], max_iterations)

    parts = in_ranges(part, start.shape[1], CHUNK)
    return FixedPoint(*map(np.hstack, zip(*parts, strict=True)))


class _Problem(NamedTuple):
    """The data of `solve_fixed_point` for some cells."""

    structure: Array
    law: Array
    ground: Filter
    one_solution: Array
    level: Array  # (n,): logarithm of the ratio of the shaking to the full one, as standard deviations
    closure: Closure
    rtol: float
    atol: float

    def of(self, cells: Array | slice) -> _Problem:
        """The data of a selection of the cells."""
        if self.level[cells].size == self.level.size:  # the selection is all cells
            return self
        return self._replace(
            structure=_columns(self.structure, cells),
            law=_columns(self.law, cells),
            ground=self.ground.at(cells),
            one_solution=self.one_solution[cells],
            level=self.level[cells],
        )


def _columns(rows: Array, cells: Array | slice) -> Array:
    """Columns (m, selected) of ``rows`` (m, n)."""
    return rows[:, cells] if isinstance(cells, slice) else rows.take(cells, axis=1)


def _solve(problem: _Problem, start: Array, max_iterations: int) -> FixedPoint:
    """Try the three methods in turn, each for the cells in which those before did not converge."""
    elastic = _unknowns(start)
    # Starting values from the elastic response, with the standard deviation of z at most 1.
    yielding = np.array([elastic[0], np.minimum(elastic[1], 0), elastic[2]])
    bold = max(1, int(BOLD_SHARE * max_iterations))
    with_care, any_law = max_iterations - bold, np.ones(start.shape[1], bool)
    ways = (
        (BOLD, yielding, bold, problem.one_solution),  # nearly Newton's method
        (CAREFUL, yielding, with_care, problem.one_solution),  # also passes the end of a branch
        (None, elastic, with_care, any_law),
    )
    solution = _nothing(start.shape[1])
    for pace, begin, most, allowed in ways:
        cells = np.flatnonzero(~solution.converged & allowed)
        if cells.size and most > 0:
            part, y = problem.of(cells), begin[:, cells]
            found = _evolve(part, y, most, pace) if pace else _follow(part, y, most)
            spent = found.iterations + solution.iterations[cells]
            _put(solution, cells, found._replace(iterations=spent))
    return solution


def _follow(problem: _Problem, elastic: Array, most_levels: int) -> FixedPoint:
    """Follow a branch of solutions from weak to full shaking, level by level.

    A level is the logarithm of the ratio of the shaking to the full one. It begins where hardly any
    structure yields. The solution at the next level is extrapolated linearly from the last two. A
    solution that is farther than `NEAR` from its extrapolation belongs to another branch, and the step
    is repeated with a lower level.
    """
    n = elastic.shape[1]
    slope = np.stack([np.ones(n), np.ones(n), np.zeros(n)])
    level = np.minimum(0, np.log(WEAK) - elastic[1]) - FIRST_RISE
    y, rise, near = elastic + slope * level, np.full(n, FIRST_RISE), np.full(n, np.inf)
    solution, cells = _nothing(n), np.arange(n)
    for _ in range(most_levels):
        at = np.minimum(0, level[cells] + rise[cells])
        guess = y[:, cells] + slope[:, cells] * (at - level[cells])
        found = _evolve(problem.of(cells)._replace(level=at), guess, AT_LEVEL, BOLD)
        reached = _unknowns(found.latent)
        good = found.converged & (np.abs(reached - guess).max(axis=0) <= near[cells])
        spent = found.iterations + solution.iterations[cells]
        _put(solution, cells, found._replace(iterations=spent, converged=good & (at == 0)))
        on, known = cells[good], np.isfinite(near[cells[good]])
        found_slope = (reached[:, good] - y[:, on]) / (at[good] - level[on])
        slope[:, on] = np.where(known, found_slope, slope[:, on])
        y[:, on], level[on], near[on] = reached[:, good], at[good], NEAR
        rise[cells] *= np.where(good, LONGER, SHORTER)
        cells = np.flatnonzero(~solution.converged & (rise > LEAST_RISE))
        if not cells.size:
            break
    return solution


def _nothing(n: int) -> FixedPoint:
    """The result for ``n`` cells that are not yet solved: NaN, not converged."""
    none = np.full(n, np.nan)
    return FixedPoint(np.array([none] * 2), np.array([none] * 3), np.zeros(n, np.int32), none, none > 0)


def _put(solution: FixedPoint, cells: Array, found: FixedPoint) -> None:
    """Write the results of some cells into those of all."""
    for field, value in zip(solution, found, strict=True):
        field[..., cells] = value


def _unknowns(latent: Array) -> Array:
    """The unknowns ``(log sv, log sz, atanh r)`` of moments (3, n)."""
    unknowns = np.empty_like(latent)
    np.log(latent[:2], out=unknowns[:2])
    np.arctanh(latent[2], out=unknowns[2])
    return unknowns


def _evolve(problem: _Problem, y: Array, max_iterations: int, pace: Pace) -> FixedPoint:
    """Pseudo-transient continuation from the unknowns ``y`` (3, n), until all cells converge."""
    if problem.closure in CLIPPED and problem.ground.oscillators is not None:
        return _settled(problem, y, max_iterations, pace)
    n = y.shape[1]
    whole, iterations = np.zeros((STATE, n)), np.zeros(n, np.int32)
    whole[BASE:NORM], whole[NORM], whole[DELTA] = y, np.inf, pace.first
    state, part, cells = whole, problem, np.arange(n)
    for _ in range(max_iterations):
        _advance(part, state, pace)
        iterations[cells] += 1
        done = state[DONE] > 0
        if done.all():
            break
        if done.any():
            whole[:, cells] = state
            left = np.flatnonzero(~done)
            state, part, cells = state.take(left, axis=1), part.of(left), cells[left]
    whole[:, cells] = state
    latent = _latent(whole[BASE:NORM] + whole[STEP:DELTA])
    coefficients = problem.closure(latent, problem.law).coefficients
    return FixedPoint(coefficients, latent, iterations, whole[NORM], whole[DONE] > 0)


def _settled(problem: _Problem, y: Array, max_iterations: int, pace: Pace) -> FixedPoint:
    """As `_evolve`, with all iterations of a cell in compiled code; a few cells in plain Python."""
    n, soil = y.shape[1], (problem.ground.intensity, *(problem.ground.oscillators or ()))
    cells, ground, start = (
        np.array([*problem.structure, problem.level]),
        np.ones((OF_GROUND, n)),
        y.copy(),
    )
    for row, entry in enumerate(soil):
        ground[row] = entry
    found, iterations = np.empty((FOUND, n)), np.zeros(n, np.int32)
    kind = CLIPPED[problem.closure], len(soil) // 2
    rule = pace, float(problem.rtol), float(problem.atol), max_iterations
    if worth_compiling(settle_cells, n):
        settle_cells(*kind, cells, ground, start, *rule, found, iterations)
    else:
        for at in range(n):
            column = slice(at, at + 1)
            given = [rows[:, at].tolist() for rows in (cells, ground, start)]
            try:
                found[:, at], iterations[at] = settle(*kind, *given, *rule)
            except (ArithmeticError, ValueError):  # compiled code goes on with infinity or NaN
                one = (rows[:, column].copy() for rows in (cells, ground, start))
                settle_cells(*kind, *one, *rule, found[:, column], iterations[column])
    return FixedPoint(found[:2], found[2:5], iterations, found[5], found[6] > 0)


def _latent(y: Array) -> Array:
    """The moments ``sv, sz, r`` (3, n) of the unknowns."""
    latent = np.exp(y)
    np.tanh(y[2], out=latent[2])
    return latent


def _advance(problem: _Problem, state: Array, pace: Pace) -> None:
    """One step of the iteration with a closure or a ground that is not compiled."""
    latent = _latent(state[BASE:NORM] + state[STEP:DELTA])
    value = problem.closure(latent, problem.law)
    forcings = problem.ground.forcing_and_slopes(
        EquivalentSystem(*problem.structure, *value.coefficients)
    )
    values = np.concatenate([field.reshape(-1, latent.shape[1]) for field in value])
    cells = np.array([*problem.structure, problem.level])
    advance_cells(cells, latent, values, forcings, state, pace, problem.rtol, problem.atol)


def to_unknowns(covariance: Array) -> tuple[Array, Array]:
    """``(log sv, log sz, atanh r)`` of a covariance ``(vv, zz, vz)``, and the Jacobian (3, 3, ...).

    NaN where the three numbers are not a covariance.
    """
    vv, zz, vz = covariance
    root = np.sqrt(vv * zz)
    r = vz / root
    columns = [slope_of_unknowns(vv, zz, root, r, unit) for unit in np.eye(3)]
    unknowns = np.array([0.5 * np.log(vv), 0.5 * np.log(zz), np.arctanh(r)])
    return unknowns, np.stack([np.stack(column) for column in columns], axis=1)
