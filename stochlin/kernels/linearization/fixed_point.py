"""The fixed point of statistical linearization, over all cells at once.

The unknowns are the moments ``(sigma_v, sigma_z, corr(v, z))`` of the Gaussian density
that a closure assumes, as ``(log, log, atanh)``: every iterate is then a valid density,
whatever the hysteresis law. The mismatch ``F`` is what the linear system implied by the
closure really does, less what the closure assumes. ``y' = F(y)`` relaxes to the fixed point;
it is followed by pseudo-transient continuation (Kelley & Keyes 1998, SIAM J. Numer. Anal. 35),
``(1/delta - dF/dy) step = F``, which ends as Newton's method.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.small_systems import solve_3x3
from stochlin.kernels.linearization.covariance import EquivalentSystem, Forcing, own_covariance

CHUNK = 2048  # cells: temporaries of one Newton step then stay in the cache
COMPLEX_STEP = 1e-30
LARGEST_STEP = 1.0  # in log(sigma) and atanh(corr)
LEAST_DELTA = 0.05
LARGEST_MISMATCH = 1e-6  # of a converged cell, whatever its last step


class Pace(NamedTuple):
    """How boldly the relaxation is followed: the pseudo-time step ``delta`` and how it changes."""

    first: float
    restart: float  # where to begin again after a rise of the mismatch
    shorter: float  # factors from one step to the next: after a rise,
    longer: float  # after a fall, times the ratio of the mismatches,
    longest: float  # and at most


BOLD = Pace(first=30.0, restart=1.0, shorter=0.25, longer=3.0, longest=100.0)  # nearly Newton
CAREFUL = Pace(first=0.5, restart=0.5, shorter=0.5, longer=1.1, longest=1.5)
WEAK = 0.3  # elastic ductility, as standard deviation: hardly anything yields
FIRST_RISE, LONGER, SHORTER, LEAST_RISE = 0.5, 2.0, 0.5, 1e-4  # of the rise from level to level
AT_LEVEL = 12  # iterations
NEAR = 0.05  # how far from where it was sought a solution is still of the same branch
BOLD_SHARE = 0.15  # of max_iterations: 13 do for the bilinear law, a cell that needs 30 is lost


class ClosureValue(NamedTuple):
    """A closure at latent moments ``(sv, sz, r)``, and its derivatives by them.

    ``coefficients`` are ``(1 + c_e, k_e)``, ``covariance`` is ``(Var v, Var z, Cov(v, z))``
    under the density assumed. Shapes (2, n), (2, 3, n), (3, n), (3, 3, n).
    """

    coefficients: Array
    coefficients_jacobian: Array
    covariance: Array
    covariance_jacobian: Array


class FixedPoint(NamedTuple):
    """Where Newton's method stopped, per cell."""

    coefficients: Array  # (2, n): 1 + c_e, k_e
    latent: Array  # (3, n): sv, sz, r
    iterations: Array
    residual: Array  # mismatch of (log sigma_v, log sigma_z, atanh corr(v, z)), Euclidean norm
    converged: Array


Closure = Callable[[Array, Array], ClosureValue]  # latent moments, law parameters
ForcingOf = Callable[[EquivalentSystem, Array], Forcing]  # system, ground parameters


def gaussian_covariance(latent: Array) -> tuple[Array, Array]:
    """Covariance and its Jacobian of the Gaussian density with moments ``(sv, sz, r)``."""
    sv, sz, r = latent
    zero = np.zeros_like(sv)
    jacobian = np.array([[2 * sv, zero, zero], [zero, 2 * sz, zero], [r * sz, r * sv, sv * sz]])
    return np.array([sv * sv, sz * sz, r * sv * sz]), jacobian


def solve_fixed_point(
    structure: Array,
    law: Array,
    ground: Array,
    start: Array,
    one_solution: Array,
    closure: Closure,
    forcing_of: ForcingOf,
    rtol: float,
    atol: float,
    max_iterations: int,
) -> FixedPoint:
    """Solve every cell, in chunks.

    ``structure`` (3, n) has stiffness, damping and coupling of the equivalent system, ``start`` (3, n)
    the latent moments of the elastic response; ``law`` and ``ground`` (m, n) are handed through to
    closure and ``forcing_of``. Where ``one_solution`` (n,) says that there is one at most, it is sought
    from the elastic response at once; elsewhere the branch that begins there is followed. A cell is
    done when ``|dy| <= atol + rtol |y|`` for each latent moment ``y``; ``atol`` counts for the
    correlation only, since the other two are positive scales. ``max_iterations`` are the steps of a
    search, or the levels of a branch.
    """
    level = np.zeros(start.shape[1])
    whole = _Problem(structure, law, ground, one_solution, level, closure, forcing_of, rtol, atol)
    parts = []
    for begin in range(0, max(1, start.shape[1]), CHUNK):
        cells = slice(begin, begin + CHUNK)
        parts.append(_solve(whole.of(cells), start[:, cells], max_iterations))
    return FixedPoint(*(np.concatenate(field, axis=-1) for field in zip(*parts, strict=True)))


class _Problem(NamedTuple):
    structure: Array
    law: Array
    ground: Array
    one_solution: Array
    level: Array  # logarithm of the share of the shaking
    closure: Closure
    forcing_of: ForcingOf
    rtol: float
    atol: float

    def of(self, cells: Array | slice) -> _Problem:
        return self._replace(
            structure=self.structure[:, cells],
            law=self.law[:, cells],
            ground=self.ground[:, cells],
            one_solution=self.one_solution[cells],
            level=self.level[cells],
        )


class _State(NamedTuple):
    """Last valid iterate of each cell, its mismatch, the step from there and the pseudo-time step."""

    base: Array
    norm: Array
    step: Array
    delta: Array


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
    """Boldly from the elastic response."""
    return _evolve(problem, _yielding(elastic), max_iterations, BOLD)


def _relax(problem: _Problem, elastic: Array, max_iterations: int) -> FixedPoint:
    """From the elastic response with care, also over a jump at which a branch ends."""
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
    return FixedPoint(np.stack([none] * 2), np.stack([none] * 3), np.zeros(n, np.int32), none, none > 0)


def _put(solution: FixedPoint, cells: Array, found: FixedPoint) -> None:
    for field, value in zip(solution, found, strict=True):
        field[..., cells] = value


def _yielding(elastic: Array) -> Array:
    """The elastic response as a start: ``z`` does not go far beyond 1."""
    return np.stack([elastic[0], np.minimum(elastic[1], 0), elastic[2]])


def _unknowns(latent: Array) -> Array:
    return np.stack([np.log(latent[0]), np.log(latent[1]), np.arctanh(latent[2])])


def _evolve(problem: _Problem, y: Array, max_iterations: int, pace: Pace) -> FixedPoint:
    n = y.shape[1]
    state = _State(y.copy(), np.full(n, np.inf), np.zeros_like(y), np.full(n, pace.first))
    iterations, converged = np.zeros(n, np.int32), np.zeros(n, bool)
    for _ in range(max_iterations):
        active = np.flatnonzero(~converged)
        if not active.size:
            break
        converged[active] = _advance(problem.of(active), state, active, pace)
        iterations[active] += 1
    y = state.base + state.step
    latent = np.stack([np.exp(y[0]), np.exp(y[1]), np.tanh(y[2])])
    with np.errstate(all="ignore"):  # where a cell ran away
        coefficients = problem.closure(latent, problem.law).coefficients
    return FixedPoint(coefficients, latent, iterations, state.norm, converged)


def _advance(problem: _Problem, state: _State, cells: Array, pace: Pace) -> Array:
    """One evaluation of the cells, and what is made of it: a new step, or a part of the old one."""
    y = state.base[:, cells] + state.step[:, cells]
    mismatch, jacobian = _mismatch(problem, y)
    norm = np.sqrt((mismatch**2).sum(axis=0))
    valid = np.isfinite(norm) & np.isfinite(jacobian).all(axis=(0, 1))
    delta = next_delta(state.delta[cells], state.norm[cells], np.where(valid, norm, np.inf), pace)
    step = _newton_step(jacobian, mismatch, delta)
    # Not stationary: take back most of the step, or if there was none yet, start nearer to elastic.
    untried = np.isinf(state.norm[cells])
    towards_elastic = state.step[:, cells] - np.stack([0 * y[0], np.ones_like(y[1]), 0.5 * y[2]])
    retreat = np.where(untried, towards_elastic, 0.25 * state.step[:, cells])
    state.base[:, cells] = np.where(valid, y, state.base[:, cells])
    state.norm[cells] = np.where(valid, norm, state.norm[cells])
    state.step[:, cells] = np.where(valid, step, retreat)
    state.delta[cells] = delta
    # Judged by the undamped step: a damped one is also small where delta is.
    change = np.abs(_newton_step(jacobian, mismatch, np.inf))
    r, rtol = np.tanh(y[2]), problem.rtol
    change[2] *= (1 - r * r) * rtol / (problem.atol + rtol * np.abs(r))
    return valid & (norm <= LARGEST_MISMATCH) & (change.max(axis=0) <= rtol)


def next_delta(delta: Array, before: Array, now: Array, pace: Pace) -> Array:
    """Switched evolution relaxation: longer as the mismatch falls, short again when it rises."""
    with np.errstate(invalid="ignore", divide="ignore"):
        ratio = np.where(np.isinf(before), 1, before / now)
    shorter = np.maximum(pace.shorter * np.minimum(delta, pace.restart), LEAST_DELTA)
    return np.where(ratio < 1, shorter, delta * np.minimum(pace.longer * ratio, pace.longest))


def _newton_step(jacobian: Array, mismatch: Array, delta: Array | float) -> Array:
    """``(1/delta - J)^-1 F``, limited in length: a relaxation for small delta, Newton for large."""
    matrix = -jacobian
    matrix[np.arange(3), np.arange(3)] += 1 / delta
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        step = np.stack(solve_3x3(list(matrix), list(mismatch)))
        return step / np.maximum(1, np.abs(step).max(axis=0) / LARGEST_STEP)


def _mismatch(problem: _Problem, y: Array) -> tuple[Array, Array]:
    """What the implied linear system does less what the closure assumes, and the Jacobian."""
    sv, sz, r = np.exp(y[0]), np.exp(y[1]), np.tanh(y[2])
    # An iterate may be no density or imply no stationary system: its NaN is the answer.
    with np.errstate(all="ignore"):
        value = problem.closure(np.stack([sv, sz, r]), problem.law)
        response, by_coefficients = _response(problem, value.coefficients)
        reached, d_reached = to_unknowns(response)
        reached[:2] += problem.level
        assumed, d_assumed = to_unknowns(value.covariance)
        scale = np.stack([sv, sz, 1 - r * r])
        jacobian = np.einsum("ijn,jkn,kln->iln", d_reached, by_coefficients, value.coefficients_jacobian)
        jacobian -= np.einsum("ijn,jkn->ikn", d_assumed, value.covariance_jacobian)
    return reached - assumed, jacobian * scale


def _response(problem: _Problem, coefficients: Array) -> tuple[Array, Array]:
    """``(Var v, Var z, Cov(v, z))`` of the linear system, and its derivatives by (slip, relaxation).

    NaN where the system is unstable. The moments do not tell: on coloured ground they may look like a
    covariance then.
    """
    derivatives = []
    for which in range(2):
        shifted = coefficients.astype(complex)
        shifted[which] += COMPLEX_STEP * 1j
        system = EquivalentSystem(*problem.structure, *shifted)
        own = own_covariance(system, problem.forcing_of(system, problem.ground))
        response = np.stack([own.v_v, own.z_z, own.v_z])
        derivatives.append(response.imag / COMPLEX_STEP)
    stationary = EquivalentSystem(*problem.structure, *coefficients).stable & (own.mu_mu.real > 0)
    return np.where(stationary, response.real, np.nan), np.stack(derivatives, axis=1)


def to_unknowns(covariance: Array) -> tuple[Array, Array]:
    """``(log sv, log sz, atanh r)`` of a covariance and the Jacobian; NaN where it is none."""
    vv, zz, vz = covariance
    sv, sz = np.sqrt(vv), np.sqrt(zz)
    r = vz / (sv * sz)
    zero = np.zeros_like(r)
    spread = 1 / (1 - r * r)
    by_moments = [-0.5 * r * spread / vv, -0.5 * r * spread / zz, spread / (sv * sz)]
    jacobian = np.array([[0.5 / vv, zero, zero], [zero, 0.5 / zz, zero], by_moments])
    return np.array([np.log(sv), np.log(sz), np.arctanh(r)]), jacobian
