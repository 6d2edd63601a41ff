"""The iteration of statistical linearization for systems of springs that yield, many at once.

The unknowns (u, c) of c cells are ``log sigma_v``, ``log sigma_z`` and ``atanh corr(v, z)`` of the m
springs that yield, and ``log sigma`` of the rates of k dashpots with an exponent. `linear_for` has the
coefficients of the closure, eqs. (9) and (10), for these moments. `respond` has the moments of the
response of the linear system with these coefficients. `fixed_points` repeats this, with the moments
that `Mixing` makes of those of the response, until covariance and coefficients stand still.

A dashpot with an exponent is linearized too (Roberts and Spanos 1990, Random vibration and statistical
linearization).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization.gaussian import Closure, equivalent_dashpot
from stochlin.kernels.linearization.iteration import FixedPoint, add, elastic_limit, follow, nothing
from stochlin.kernels.linearization.systems.mixing import Mixing
from stochlin.kernels.linearization.systems.response import StationaryResponse
from stochlin.kernels.linearization.systems.state_space import Mechanics, state_space

DEPTH = 10  # rounds that are mixed
AT_LEVEL = 30  # rounds at one level of shaking, where a solution is followed
HARDLY = 2.0  # by which log sigma_z of a system that hardly yields is smaller
SOLVED = 1e-7  # largest mismatch of a solution; rounding leaves this much in stiff equations
IDLE = 1e-6  # ratio of the rate of a link to those of its ends below which it may be a rounding error

Function = Callable[[Array, Array], Array]  # of moments (3, n) and parameters (p, n)


class Law(NamedTuple):
    """Hysteresis law of some of the springs that yield."""

    springs: Array  # (i,) their numbers among the springs that yield
    parameters: Array  # (p, c, i)
    closure: Closure
    states: int = 0  # number of further states, whose means are parameters after those of the law
    mean_rates: Function | None = None  # the rates of these means

    def at_means(self, means: Array) -> Law:
        """The law in which its further states have these means (states or more, c, m)."""
        own = means[: self.states, :, self.springs]
        return self._replace(parameters=np.concatenate([self.parameters, own]))

    def evaluated(self, function: Function, moments: Array) -> Array:
        """Results (r, c, i) of a function of moments and parameters, for moments (3, c, m)."""
        own = moments[..., self.springs]
        flat = function(own.reshape(3, -1), self.parameters.reshape(len(self.parameters), own[0].size))
        return flat.reshape(-1, *own.shape[1:])


class Linear(NamedTuple):
    """Equivalent coefficients of the springs that yield, and linear dashpots of all links."""

    slip: Array  # (c, m) 1 + c_eq
    relaxation: Array  # (c, m) k_eq [1/s]
    dashpots: Array  # (c, l) damping constants [N s/m]


class ResponseMoments(NamedTuple):
    """What the iteration needs of the response; NaN in cells without a stationary one."""

    covariance: Array  # (c, states, states)
    springs: Array  # (3, c, m) Var d', Var z, Cov(d', z) over the square of the strength
    rates: Array  # (c, k) variances of the rates of extension of linearized dashpots


class Springs(NamedTuple):
    """Systems with m springs that yield and l links, in c cells."""

    mechanics: Mechanics
    laws: Sequence[Law]
    dashpots: Array  # (c, l) constants of the dashpots of the links
    exponents: Array  # (c, l)
    power: Array  # (k,) numbers of the links that are linearized: exponents other than 1
    level: Array  # (c,) logarithm of the ratio of the shaking to the full one

    @property
    def springs(self) -> int:
        """The number m."""
        return self.mechanics.springs.size

    @property
    def strength(self) -> Array:
        """Extensions at yield (c, m) [m]."""
        return self.mechanics.system.strength[:, self.mechanics.springs]

    @property
    def linearized(self) -> Array:
        """Rows (k, n) that give the extensions of linearized dashpots; links are the last springs."""
        extensions = self.mechanics.system.extensions
        return np.asarray(extensions[len(extensions) - self.dashpots.shape[1] :][self.power])

    def at(self, cells: Array) -> Springs:
        """The cells with these numbers."""
        mechanics, laws, dashpots, exponents, power, level = self
        laws = [law._replace(parameters=law.parameters[:, cells]) for law in laws]
        of_links = dashpots[cells], exponents[cells], power
        return Springs(mechanics.at(cells), laws, *of_links, level[cells])


def linear_for(problem: Springs, unknowns: Array) -> Linear:
    """Equivalent linear systems for the unknowns."""
    m = problem.springs
    sv, sz, r = unknowns[: 3 * m].reshape(3, m, unknowns.shape[1]).swapaxes(1, 2)
    slip, relaxation = coefficients_of(problem.laws, np.stack([np.exp(sv), np.exp(sz), np.tanh(r)]))
    return Linear(slip, relaxation, _dashpots(problem, unknowns[3 * m :].T))


def _dashpots(problem: Springs, rates: Array) -> Array:
    """Damping constants (c, l) of all links; ``rates`` are ``log sigma`` of those with an exponent."""
    dashpots, power = problem.dashpots.copy(), problem.power
    constants, exponents = dashpots[:, power], problem.exponents[:, power]
    linear = equivalent_dashpot(constants, exponents, np.exp(rates))
    dashpots[:, power] = np.where(exponents == 1, constants, linear)
    return dashpots


def coefficients_of(laws: Sequence[Law], moments: Array) -> Array:
    """``1 + c_eq`` and ``k_eq`` (2, c, m) by the closures, eqs. (9) and (10).

    ``moments`` (3, c, m) are ``sigma_v``, ``sigma_z`` and their correlation.
    """
    coefficients = np.empty((2, *moments.shape[1:]))
    for law in laws:
        own = law.evaluated(lambda *cells: law.closure(*cells).coefficients, moments)  # noqa: B023
        coefficients[..., law.springs] = own
    return coefficients


def respond(problem: Springs, linear: Linear) -> ResponseMoments:
    """Covariance of the linear systems, from the Lyapunov equation, and moments of their springs."""
    response = StationaryResponse(state_space(problem.mechanics, linear.slip - 1, *linear[1:]))
    rates = response.std(problem.linearized, rates=True) ** 2
    return ResponseMoments(response.covariance, response.moments / problem.strength**2, rates)


def mismatch_of(problem: Springs, unknowns: Array, moments: ResponseMoments) -> Array:
    """Unknowns of these moments less the ``unknowns`` (u, c); NaN without a stationary response."""
    vv, zz, vz = moments.springs
    level, before = problem.level[:, None], unknowns[3 * problem.springs :].T
    sv, sz = 0.5 * np.log(vv) + level, 0.5 * np.log(zz) + level
    plain = problem.exponents[:, problem.power] == 1
    rates = np.where(plain, before, 0.5 * np.log(moments.rates) + level)
    after = np.hstack([sv, sz, np.arctanh(vz / np.sqrt(vv * zz)), rates]).T
    return np.asarray(after - unknowns)


def largest_change(problem: Springs, now: tuple[Linear, Array], before: tuple[Linear, Array]) -> Array:
    """Largest changes (2, c) of covariances and of coefficients.

    That of a covariance is over the product of the standard deviations, that of ``k_eq`` over ``k_eq``
    plus the frequency of the spring, that of a dashpot over its constant.
    """
    (linear, covariance), (old, old_covariance) = now, before
    std = np.sqrt(np.diagonal(covariance, axis1=1, axis2=2))
    std = np.where(std == 0, 1.0, std)
    moved = np.abs(covariance - old_covariance) / (std[:, :, None] * std[:, None])
    slip, relaxation, dashpots = (np.abs(new - last) for new, last in zip(linear, old, strict=True))
    relaxation = relaxation / (np.abs(linear.relaxation) + problem.mechanics.frequency)
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

    ``depth`` rounds are mixed; with none this is the substitution of the paper, which goes the share
    ``relaxation`` of the way to the moments of the response. The changes of all rounds (rounds, 2, c)
    are those of `stands_still`, and NaN after the last round of a cell.
    """
    part, cells, before = problem, np.arange(unknowns.shape[1]), None
    solution, changes = nothing(unknowns), []
    weak = unknowns.copy()
    weak[part.springs : 2 * part.springs] -= HARDLY
    mixing = Mixing.begin(weak, unknowns, depth)
    for _ in range(most):
        linear = linear_for(part, mixing.unknowns)
        moments = respond(part, linear)
        mismatch = mismatch_of(part, mixing.unknowns, moments)
        now = linear, moments.covariance
        change = largest_change(part, now, before) if before else np.full((2, cells.size), np.nan)
        norm = np.sqrt((mismatch**2).sum(axis=0) / max(1, part.springs + part.power.size))
        done = stands_still(change, relaxation * rtol) & (norm <= SOLVED)
        add(solution, cells, FixedPoint(mixing.unknowns, np.ones_like(cells), norm, done))
        changes.append(np.full((2, unknowns.shape[1]), np.nan))
        changes[-1][:, cells] = change
        left = np.flatnonzero(~done)
        if not left.size:
            break
        mixing = mixing.next(mismatch, relaxation).at(left)
        before = Linear(*(values[left] for values in linear)), moments.covariance[left]
        part, cells = part.at(left), cells[left]
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

    ``elastic`` (u, c) are the unknowns of the elastic response. Where a law may have several solutions,
    so that ``one_solution`` (c,) is false, and where mixing fails, the iteration begins at the end of
    the branch of solutions from weak to full shaking; substitution is always from the elastic response.
    """
    m = problem.springs
    solution, changes = nothing(elastic), np.full((most, 2, elastic.shape[1]), np.nan)
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
            return fixed_points(part.at(cells)._replace(level=level), guess, AT_LEVEL, rtol)[0]

        branch = follow(settle, elastic[:, cells], m, most)
        solution.iterations[cells] += branch.iterations
        iterate(cells[branch.converged], branch.unknowns[:, branch.converged])
    solution.unknowns[:, ~solution.converged] = np.nan
    shown = np.flatnonzero(np.isfinite(changes).any(axis=(1, 2)))
    return solution, changes[: shown.max(initial=-1) + 1]


def elastic_start(problem: Springs) -> tuple[Springs, Array]:
    """The problem, and the unknowns (3 m + k, c) of the elastic response.

    Dashpots with an exponent are linearized for the rates without them. Those that do not move have an
    exponent of 1 and no constant in the problem that is returned.
    """
    power, system = problem.power, problem.mechanics.system
    rates = np.zeros((len(problem.dashpots), power.size))
    if power.size:
        constants, exponents = problem.dashpots.copy(), problem.exponents.copy()
        constants[:, power] = 0.0
        _, rates = _elastic_std(problem, constants, problem.linearized)
        _, ends = _elastic_std(problem, constants, np.eye(system.mass.shape[1]))
        idle = rates < IDLE * ends @ np.abs(problem.linearized).T
        constants[:, power] = np.where(idle, 0.0, problem.dashpots[:, power])
        exponents[:, power] = np.where(idle, 1.0, exponents[:, power])
        problem = problem._replace(dashpots=constants, exponents=exponents)
        rates = np.where(idle, 0.0, np.log(rates))
    yielding = system.extensions[problem.mechanics.springs]
    drift, rate = _elastic_std(problem, _dashpots(problem, rates), yielding) / problem.strength
    sv, sz = np.log(rate), np.log(drift)
    return problem, np.hstack([sv, sz, np.where(np.isnan(sv), np.nan, 0.1), rates]).T


def _elastic_std(problem: Springs, dashpots: Array, weights: Array) -> Array:
    """Standard deviations of sums of coordinates (k, n) and of their rates (2, c, k) while elastic."""
    none = np.empty((len(dashpots), 0))
    response = StationaryResponse(state_space(problem.mechanics.elastic, none, none, dashpots))
    return np.array([response.std(weights, rates=rates) for rates in (False, True)])
