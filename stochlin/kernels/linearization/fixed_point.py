"""The fixed point of statistical linearization, over all cells at once.

The unknowns are the moments ``(sigma_v, sigma_z, corr(v, z))`` of the Gaussian density
that a closure assumes, as ``(log, log, atanh)``: every iterate is then a valid density,
whatever the hysteresis law. The mismatch ``F`` is what the linear system implied by the
closure really does, less what the closure assumes. ``y' = F(y)`` relaxes to the fixed point;
it is followed by pseudo-transient continuation (Kelley & Keyes 1998, SIAM J. Numer. Anal. 35),
``(1/delta - dF/dy) step = F``, which ends as Newton's method.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import in_ranges
from stochlin.kernels.linearization.cells.steps import (
    BASE,
    DELTA,
    DONE,
    NORM,
    RESPONSE,
    STATE,
    STEP,
    Pace,
    advance,
    respond,
    slope_of_unknowns,
)
from stochlin.kernels.linearization.covariance import EquivalentSystem
from stochlin.kernels.linearization.filters import Filter
from stochlin.kernels.linearization.gaussian import Closure

CHUNK = 2048  # cells: temporaries of one Newton step then stay in the cache
BOLD = Pace(first=30.0, restart=1.0, shorter=0.25, longer=3.0, longest=100.0)  # nearly Newton
CAREFUL = Pace(first=0.5, restart=0.5, shorter=0.5, longer=1.1, longest=1.5)
WEAK = 0.3  # elastic ductility, as standard deviation: hardly anything yields
FIRST_RISE, LONGER, SHORTER, LEAST_RISE = 0.5, 2.0, 0.5, 1e-4  # of the rise from level to level
AT_LEVEL = 12  # iterations
NEAR = 0.05  # how far from where it was sought a solution is still of the same branch
BOLD_SHARE = 0.15  # of max_iterations: 13 do for the bilinear law, a cell that needs 30 is lost


class FixedPoint(NamedTuple):
    """Where Newton's method stopped, per cell."""

    coefficients: Array  # (2, n): 1 + c_e, k_e
    latent: Array  # (3, n): sv, sz, r
    iterations: Array
    residual: Array  # mismatch of (log sigma_v, log sigma_z, atanh corr(v, z)), Euclidean norm
    converged: Array


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
    """Solve every cell, in chunks, on all cores.

    ``structure`` (3, n) has stiffness, damping and coupling of the equivalent system, ``start`` (3, n)
    the latent moments of the elastic response; ``law`` (m, n) is handed through to the closure. Where
    ``one_solution`` (n,) says that there is one at most, it is sought from the elastic response at once;
    elsewhere the branch that begins there is followed. A cell is done when ``|dy| <= atol + rtol |y|``
    for each latent moment ``y``; ``atol`` counts for the correlation only, since the other two are
    positive scales. ``max_iterations`` are the steps of a search, or the levels of a branch.
    """
    level = np.zeros(start.shape[1])
    whole = _Problem(structure, law, ground, one_solution, level, closure, rtol, atol)

    @np.errstate(all="ignore")  # an iterate may be no density, or imply no stationary system
    def part(cells: slice) -> FixedPoint:
        return _solve(whole.of(cells), start[:, cells], max_iterations)

    parts = in_ranges(part, start.shape[1], CHUNK)
    return FixedPoint(*(np.concatenate(field, axis=-1) for field in zip(*parts, strict=True)))


class _Problem(NamedTuple):
    structure: Array
    law: Array
    ground: Filter
    one_solution: Array
    level: Array  # logarithm of the share of the shaking
    closure: Closure
    rtol: float
    atol: float

    def of(self, cells: Array | slice) -> _Problem:
        if self.level[cells].size == self.level.size:  # all of them
            return self
        return self._replace(
            structure=_columns(self.structure, cells),
            law=_columns(self.law, cells),
            ground=self.ground.at(cells),
            one_solution=self.one_solution[cells],
            level=self.level[cells],
        )


def _columns(rows: Array, cells: Array | slice) -> Array:
    return rows[:, cells] if isinstance(cells, slice) else rows.take(cells, axis=1)


def _solve(problem: _Problem, start: Array, max_iterations: int) -> FixedPoint:
    """Each way to the solution for the cells that the one before has lost."""
    elastic = _unknowns(start)
    bold = max(1, int(BOLD_SHARE * max_iterations))
    with_care, any_law = max_iterations - bold, np.ones(start.shape[1], bool)
    ways = (
        (_at_once, bold, problem.one_solution),
        (_relax, with_care, problem.one_solution),
        (_follow, with_care, any_law),
    )
    solution = _nothing(start.shape[1])
    for way, most, allowed in ways:
        cells = np.flatnonzero(~solution.converged & allowed)
        if cells.size and most > 0:
            found = way(problem.of(cells), elastic[:, cells], most)
            spent = found.iterations + solution.iterations[cells]
            _put(solution, cells, found._replace(iterations=spent))
    return solution


def _at_once(problem: _Problem, elastic: Array, max_iterations: int) -> FixedPoint:
    """By large steps from the elastic response."""
    return _evolve(problem, _yielding(elastic), max_iterations, BOLD)


def _relax(problem: _Problem, elastic: Array, max_iterations: int) -> FixedPoint:
    """By small steps from the elastic response, also over a jump at which a branch ends."""
    return _evolve(problem, _yielding(elastic), max_iterations, CAREFUL)


def _follow(problem: _Problem, elastic: Array, most_levels: int) -> FixedPoint:
    """From shaking so weak that hardly anything yields up to the full, level by level.

    A level is the logarithm of the share of the shaking. Two solutions tell where the next is sought:
    one far from there belongs to another branch, and is sought again at a lower level.
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
    """Of cells not yet solved."""
    none = np.full(n, np.nan)
    return FixedPoint(np.array([none] * 2), np.array([none] * 3), np.zeros(n, np.int32), none, none > 0)


def _put(solution: FixedPoint, cells: Array, found: FixedPoint) -> None:
    for field, value in zip(solution, found, strict=True):
        field[..., cells] = value


def _yielding(elastic: Array) -> Array:
    """The elastic response as a start: ``z`` does not go far beyond 1."""
    return np.array([elastic[0], np.minimum(elastic[1], 0), elastic[2]])


def _unknowns(latent: Array) -> Array:
    unknowns = np.empty_like(latent)
    np.log(latent[:2], out=unknowns[:2])
    np.arctanh(latent[2], out=unknowns[2])
    return unknowns


def _evolve(problem: _Problem, y: Array, max_iterations: int, pace: Pace) -> FixedPoint:
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


def _latent(y: Array) -> Array:
    latent = np.exp(y)
    np.tanh(y[2], out=latent[2])
    return latent


def _advance(problem: _Problem, state: Array, pace: Pace) -> None:
    """What the implied linear system does less what the closure assumes, and what is made of it."""
    y = state[BASE:NORM] + state[STEP:DELTA]
    latent = _latent(y)
    value = problem.closure(latent, problem.law)
    system = np.concatenate([problem.structure, value.coefficients])
    response = np.empty((RESPONSE, y.shape[1]))
    respond(system, problem.ground.forcing_and_slopes(EquivalentSystem(*system)), response)
    mismatch = _unknowns_of(*response[[0, 1, 3]])
    mismatch[:2] += problem.level
    vv, zz, vz = value.covariance
    mismatch -= _unknowns_of(vv, zz, vz / np.sqrt(vv * zz))
    advance(
        y,
        latent,
        mismatch,
        response,
        np.ascontiguousarray(value.coefficients_jacobian).reshape(6, -1),
        np.ascontiguousarray(value.covariance),
        np.ascontiguousarray(value.covariance_jacobian).reshape(9, -1),
        state,
        pace,
        problem.rtol,
        problem.atol,
    )


def _unknowns_of(vv: Array, zz: Array, r: Array) -> Array:
    return np.array([0.5 * np.log(vv), 0.5 * np.log(zz), np.arctanh(r)])


def to_unknowns(covariance: Array) -> tuple[Array, Array]:
    """``(log sv, log sz, atanh r)`` of a covariance and the Jacobian; NaN where it is none."""
    vv, zz, vz = covariance
    r = vz / np.sqrt(vv * zz)
    columns = [slope_of_unknowns(vv, zz, r, unit) for unit in np.eye(3)]
    return _unknowns_of(vv, zz, r), np.stack([np.stack(column) for column in columns], axis=1)
