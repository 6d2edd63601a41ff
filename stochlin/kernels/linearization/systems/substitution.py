"""The iteration of statistical linearization for systems of springs that yield, many at once.

The unknowns (u, c) of c cells are ``log sigma_v``, ``log sigma_z`` and ``atanh corr(v, z)`` of the
m springs that yield, and ``log sigma`` of the rates of k dashpots with an exponent. `linear_for`
has the coefficients of the closure, eqs. (9) and (10), for these moments. `respond` has the moments
of the response of the linear system with these coefficients. `fixed_points` repeats this until
covariance and coefficients stand still.

Plain substitution takes the moments of the response as the next ones, which may cycle without end.
Anderson's mixing takes the linear combination of the last rounds that has the least mismatch of
both moments (Anderson 1965, J. ACM 12; Walker and Ni 2011, SIAM J. Numer. Anal. 49).

A dashpot with an exponent is linearized too (Roberts and Spanos 1990, Random vibration and
statistical linearization).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization.gaussian import equivalent_dashpot
from stochlin.kernels.linearization.iteration import (
    LARGEST_STEP,
    FixedPoint,
    add,
    elastic_limit,
    follow,
    unsolved,
)
from stochlin.kernels.linearization.systems.response import StationaryResponse
from stochlin.kernels.linearization.systems.springs import Springs, coefficients_of
from stochlin.kernels.linearization.systems.state_space import state_space

DEPTH = 10  # rounds that are mixed
# square of the share of a round that others do not determine, below which it is left
DEPENDENT = 1e-12
BACK = 0.25  # share of a step that is tried again where it led to no response
ROUNDS_AT_LEVEL = 30  # rounds at one level of shaking, where a solution is followed
HARDLY_YIELDING = 2.0  # by which log sigma_z of a system that hardly yields is smaller
SOLVED = 1e-7  # largest mismatch of a solution; rounding leaves this much in stiff equations
# log sigma of the rate [m/s] of a dashpot below which it may be a rounding error
IDLE = np.log(1e-6)


class EquivalentCoefficients(NamedTuple):
    """Equivalent coefficients of the springs that yield, and linear dashpots of all links."""

    slip: Array  # (c, m) 1 + c_eq
    relaxation: Array  # (c, m) k_eq [1/s]
    # (c, l) damping constants [N s/m]; 0 of those with an exponent that do not move
    dashpots: Array

    def at(self, cells: Array) -> EquivalentCoefficients:
        """The cells with these numbers."""
        return EquivalentCoefficients(*(values[cells] for values in self))


def linear_for(problem: Springs, unknowns: Array) -> EquivalentCoefficients:
    """Equivalent linear systems for the unknowns."""
    m = problem.yielding.size
    sv, sz, r = unknowns[: 3 * m].reshape(3, m, unknowns.shape[1]).swapaxes(1, 2)
    slip, relaxation = coefficients_of(problem.laws, np.stack([np.exp(sv), np.exp(sz), np.tanh(r)]))
    return EquivalentCoefficients(slip, relaxation, _dashpots(problem, unknowns[3 * m :].T))


def _dashpots(problem: Springs, rates: Array) -> Array:
    """Damping constants (c, l) of all links; ``rates``: ``log sigma`` of those with an exponent."""
    dashpots = problem.dashpots.copy()
    power = problem.power
    constants = dashpots[:, power]
    exponents = problem.exponents[:, power]
    linear = np.where(rates > IDLE, equivalent_dashpot(constants, exponents, np.exp(rates)), 0.0)
    dashpots[:, power] = np.where(exponents == 1, constants, linear)
    return dashpots


def response_of(problem: Springs, linear: EquivalentCoefficients) -> StationaryResponse:
    """Response of the linear systems with these coefficients and dashpots."""
    return StationaryResponse(state_space(problem, linear.slip - 1, *linear[1:]))


def respond(problem: Springs, linear: EquivalentCoefficients) -> tuple[Array, Array]:
    """Covariance (c, states, states) of the response, and the unknowns (u, c) of its moments.

    They are NaN in cells without a stationary response.
    """
    response = response_of(problem, linear)
    vv, zz, vz = response.moments / problem.strength**2
    level = problem.level[:, None]
    rates = response.std(problem.linearized, rates=True)
    sv = 0.5 * np.log(vv) + level
    sz = 0.5 * np.log(zz) + level
    correlation = np.arctanh(vz / np.sqrt(vv * zz))
    dashpot_rates = np.maximum(np.log(rates) + level, IDLE)
    unknowns = np.hstack([sv, sz, correlation, dashpot_rates]).T
    return response.covariance, unknowns


def mixed(tried: Array, mismatches: Array, relaxation: float) -> Array:
    """The step (u, c) from the last of the unknowns tried (d + 1, u, c), by their mismatches.

    It mixes d rounds; with none it is substitution, which goes the share ``relaxation`` of the way.
    """
    moves = np.nan_to_num(np.diff(tried, axis=0))
    changes = np.nan_to_num(np.diff(mismatches, axis=0))
    size = np.sqrt((changes**2).sum(axis=1))
    size[size == 0] = 1.0
    rows = (changes / size[:, None]).transpose(2, 0, 1)
    square = rows @ rows.swapaxes(1, 2) + DEPENDENT * np.eye(len(moves))
    mismatch = np.nan_to_num(mismatches[-1])
    weights = np.linalg.solve(square, rows @ mismatch.T[..., None])[..., 0].T / size
    step = relaxation * mismatch - ((moves + relaxation * changes) * weights[:, None]).sum(axis=0)
    shortened: Array = step / np.maximum(1.0, np.abs(step).max(axis=0) / LARGEST_STEP)
    return shortened


def largest_change(
    problem: Springs,
    now: tuple[EquivalentCoefficients, Array],
    before: tuple[EquivalentCoefficients, Array],
) -> Array:
    """Largest changes (2, c) of covariances and of coefficients.

    That of a covariance is over the product of the standard deviations, that of ``k_eq`` over
    ``k_eq`` plus the frequency of the spring, that of a dashpot over its constant.
    """
    linear, covariance = now
    old, old_covariance = before
    std = np.sqrt(np.diagonal(covariance, axis1=1, axis2=2))
    std = np.where(std == 0, 1.0, std)
    moved = np.abs(covariance - old_covariance) / (std[:, :, None] * std[:, None])
    slip = np.abs(linear.slip - old.slip)
    relaxation = np.abs(linear.relaxation - old.relaxation)
    relaxation = relaxation / (np.abs(linear.relaxation) + problem.frequency)
    dashpots = np.abs(linear.dashpots - old.dashpots)
    dashpots = np.where(dashpots == 0, 0.0, dashpots / np.abs(old.dashpots))[:, problem.power]
    parts = np.concatenate([slip, relaxation, dashpots], axis=1)
    return np.stack([moved.max(axis=(1, 2)), parts.max(axis=1, initial=0.0)])


def stands_still(change: Array, rtol: float) -> Array:
    """Whether neither covariance nor coefficients (2, c) changed by more than ``rtol``."""
    return np.asarray((change <= rtol).all(axis=0))


def fixed_points(
    problem: Springs,
    unknowns: Array,
    most: int,
    rtol: float,
    depth: int = DEPTH,
    relaxation: float = 1.0,
) -> tuple[FixedPoint, Array]:
    """The loop: coefficients, response and the next moments, until both stand still in each cell.

    ``depth`` rounds are mixed; with none this is the substitution of the paper. The changes of all
    rounds (rounds, 2, c) are those of `stands_still`, and NaN after the last round of a cell.
    """
    part = problem
    cells = np.arange(unknowns.shape[1])
    m = problem.yielding.size
    solution = unsolved(unknowns)
    changes = []
    before = None
    tried = np.tile(unknowns, (depth + 1, 1, 1))  # those with a response
    tried[:, m : 2 * m] -= HARDLY_YIELDING
    mismatches = np.full_like(tried, np.nan)
    for _ in range(most):
        linear = linear_for(part, unknowns)
        covariance, moments = respond(part, linear)
        mismatch = moments - unknowns
        now = (linear, covariance)
        change = largest_change(part, now, before) if before else np.full((2, cells.size), np.nan)
        norm = np.sqrt((mismatch**2).sum(axis=0) / max(1, m + part.power.size))
        done = stands_still(change, relaxation * rtol) & (norm <= SOLVED)
        add(solution, cells, FixedPoint(unknowns, np.ones_like(cells), norm, done))
        changes.append(np.full((2, solution.residual.size), np.nan))
        changes[-1][:, cells] = change
        left = np.flatnonzero(~done)
        if not left.size:
            break
        good = np.isfinite(mismatch).all(axis=0)
        tried = np.where(good, np.concatenate([tried[1:], unknowns[None]]), tried)[..., left]
        mismatches = np.where(good, np.concatenate([mismatches[1:], mismatch[None]]), mismatches)[
            ..., left
        ]
        back = BACK * (unknowns[:, left] - tried[-1])
        unknowns = tried[-1] + np.where(good[left], mixed(tried, mismatches, relaxation), back)
        before = linear.at(left), covariance[left]
        part = part.at(left)
        cells = cells[left]
    return solution, np.stack(changes)


def solve_springs(
    problem: Springs,
    elastic: Array,
    one_solution: Array,
    most: int,
    rtol: float,
    depth: int = DEPTH,
    relaxation: float = 1.0,
) -> tuple[FixedPoint, Array]:
    """The `fixed_points` of all cells.

    ``elastic`` (u, c) are the unknowns of the elastic response. Where a law may have several
    solutions, so that ``one_solution`` (c,) is false, and where mixing fails, the iteration begins
    at the end of the branch of solutions from weak to full shaking; substitution is always from the
    elastic response.
    """
    m = problem.yielding.size
    solution = unsolved(elastic)
    changes = np.full((most, 2, elastic.shape[1]), np.nan)
    solution.converged[:] = not len(elastic)  # nothing is to be linearized

    def iterate(cells: Array, start: Array) -> None:
        if cells.size:
            run, of_cells = fixed_points(problem.at(cells), start, most, rtol, depth, relaxation)
            add(solution, cells, run)
            changes[:, :, cells] = np.nan
            changes[: len(of_cells), :, cells] = of_cells

    tried = np.isfinite(elastic).all(axis=0) & ~solution.converged
    cells = np.flatnonzero(tried & (one_solution | (depth == 0)))
    iterate(cells, elastic_limit(elastic, m)[:, cells])
    cells = np.flatnonzero(tried & ~solution.converged & (depth > 0))
    if cells.size:
        part = problem.at(cells)

        def settle(cells: Array, level: Array, guess: Array) -> FixedPoint:
            return fixed_points(part.at(cells)._replace(level=level), guess, ROUNDS_AT_LEVEL, rtol)[
                0
            ]

        branch = follow(settle, elastic[:, cells], m, most)
        solution.iterations[cells] += branch.iterations
        iterate(cells[branch.converged], branch.unknowns[:, branch.converged])
    solution.unknowns[:, ~solution.converged] = np.nan
    shown = np.flatnonzero(np.isfinite(changes).any(axis=(1, 2)))
    return solution, changes[: shown.max(initial=-1) + 1]


def elastic_start(problem: Springs) -> Array:
    """The unknowns (3 m + k, c) of the elastic response.

    Dashpots with an exponent are linearized for the rates without them.
    """
    yielding = problem.system.extensions[problem.yielding]
    constants = problem.dashpots.copy()
    rates = np.empty((len(constants), problem.power.size))
    if rates.size:
        constants[:, problem.power] = 0.0
        rates = np.maximum(np.log(_elastic_std(problem, constants, problem.linearized)[1]), IDLE)
    sz, sv = np.log(_elastic_std(problem, _dashpots(problem, rates), yielding) / problem.strength)
    return np.hstack([sv, sz, np.where(np.isnan(sv), np.nan, 0.1), rates]).T


def _elastic_std(problem: Springs, dashpots: Array, weights: Array) -> Array:
    """Standard deviations of sums of coordinates (k, n) and their rates (2, c, k) while elastic."""
    none = np.empty((len(dashpots), 0))
    elastic = problem._replace(yielding=np.empty(0, int))
    response = response_of(elastic, EquivalentCoefficients(none, none, dashpots))
    return np.array([response.std(weights, rates=rates) for rates in (False, True)])
