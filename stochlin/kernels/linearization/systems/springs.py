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

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization.gaussian import Closure, equivalent_dashpot
from stochlin.kernels.linearization.iteration import FixedPoint, elastic_limit, solve
from stochlin.kernels.linearization.systems.mixing import Mixing
from stochlin.kernels.linearization.systems.response import StationaryResponse, alike
from stochlin.kernels.linearization.systems.state_space import Mechanics, state_space

DEPTH = 10  # rounds that are mixed
AT_LEVEL = 30  # rounds at one level of shaking, where a solution is followed
SOLVED = 1e-7  # largest mismatch of a solution; rounding leaves this much in stiff equations
IDLE = 1e-6  # ratio of the rate of a link to those of its ends below which it may be a rounding error


class Law(NamedTuple):
    """Hysteresis law of some of the springs that yield."""

    springs: Array  # (i,) their numbers among the springs that yield
    closure: Closure
    parameters: Array  # (p, c, i)


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
    """Systems with m springs that yield and l links, in c cells: a `Problem` of the iteration."""

    mechanics: Mechanics
    laws: Sequence[Law]
    dashpots: Array  # (c, l) constants of the dashpots of the links
    exponents: Array  # (c, l)
    power: Array  # (k,) numbers of the links that are linearized: exponents other than 1
    idle: Array  # (c, k) whether such a link does not move while the response is elastic
    level: Array  # (c,) logarithm of the ratio of the shaking to the full one
    rtol: float  # of the stop rule
    cells: Array  # (c,) their numbers among all cells
    rounds: list[tuple[Array, Array]]  # cells of all rounds, and their changes as in `stands_still`

    @classmethod
    def of(
        cls,
        mechanics: Mechanics,
        laws: Sequence[Law],
        dashpots: Array,
        exponents: Array,
        rtol: float,
    ) -> Springs:
        """All cells under full shaking, before the first round."""
        count, power = len(dashpots), np.flatnonzero(((exponents != 1) & (dashpots > 0)).any(axis=0))
        idle, level = np.zeros((count, power.size), bool), np.zeros(count)
        of_links = dashpots, exponents, power, idle
        return cls(mechanics, laws, *of_links, level, rtol, np.arange(count), [])

    @property
    def springs(self) -> int:
        """The number m."""
        return self.mechanics.springs.size

    @property
    def size(self) -> int:
        """Number of the coefficients of `Linear`."""
        return 2 * self.springs + int(self.dashpots.shape[1])

    @property
    def strength(self) -> Array:
        """Extensions at yield (c, m) [m]."""
        return self.mechanics.system.strength[:, self.mechanics.springs]

    @property
    def linearized_dashpots(self) -> Array:
        """Numbers (k,) of the springs beside linearized dashpots; links are the last springs."""
        links = self.dashpots.shape[1]
        return len(self.mechanics.system.extensions) - links + self.power

    def at(self, cells: Array) -> Springs:
        """The cells with these numbers."""
        return self._replace(
            mechanics=self.mechanics.at(cells),
            laws=[law._replace(parameters=law.parameters[:, cells]) for law in self.laws],
            dashpots=self.dashpots[cells],
            exponents=self.exponents[cells],
            idle=self.idle[cells],
            level=self.level[cells],
            cells=self.cells[cells],
        )

    def shaken(self, level: Array) -> Springs:
        """The cells under other shaking."""
        return self._replace(level=level)

    def settle(self, unknowns: Array, most: int, pace: object) -> FixedPoint:
        """The fixed points at one level of shaking, from these unknowns (u, c)."""
        return fixed_points(self, unknowns, max(most, AT_LEVEL))

    def split(self, unknowns: Array) -> tuple[Array, Array]:
        """Unknowns (3, c, m) of the springs and (c, k) of the dashpots."""
        n = 3 * self.springs
        of_springs = unknowns[:n].reshape(3, self.springs, unknowns.shape[1])
        return of_springs.swapaxes(1, 2), unknowns[n:].T


def coefficients_of(problem: Springs, moments: Array) -> Array:
    """``1 + c_eq`` and ``k_eq`` (2, c, m) by the closures, eqs. (9) and (10).

    ``moments`` (3, c, m) are ``sigma_v``, ``sigma_z`` and their correlation.
    """
    coefficients = np.empty((2, *moments.shape[1:]))
    for springs, closure, parameters in problem.laws:
        own = moments[..., springs]
        flat = closure(own.reshape(3, -1), parameters.reshape(len(parameters), own[0].size))
        coefficients[..., springs] = flat.coefficients.reshape(2, *own.shape[1:])
    return coefficients


def linear_for(problem: Springs, unknowns: Array) -> Linear:
    """Equivalent linear systems for the unknowns."""
    (sv, sz, r), rates = problem.split(unknowns)
    slip, relaxation = coefficients_of(problem, np.stack([np.exp(sv), np.exp(sz), np.tanh(r)]))
    return Linear(slip, relaxation, _dashpots(problem, rates))


def respond(problem: Springs, linear: Linear) -> ResponseMoments:
    """Covariance of the linear systems, from the Lyapunov equation, and moments of their springs."""
    mechanics, strength = problem.mechanics, problem.strength
    system = state_space(mechanics, linear.slip - 1, linear.relaxation, linear.dashpots)
    links = mechanics.system.extensions[problem.linearized_dashpots]
    shapes = system.matrix.shape, (3, *strength.shape), (len(strength), len(links))
    moments = ResponseMoments(*(np.empty(shape) for shape in shapes))
    for cells, part in alike(system):
        response = StationaryResponse(part)
        moments.covariance[cells] = response.covariance
        moments.springs[:, cells] = np.stack(response.moments[1:]) / strength[cells] ** 2
        moments.rates[cells] = response.std(links, rates=True) ** 2
    return moments


def mismatch_of(problem: Springs, unknowns: Array, moments: ResponseMoments) -> Array:
    """Unknowns of these moments less the ``unknowns`` (u, c); NaN without a stationary response."""
    vv, zz, vz = moments.springs
    level, k = problem.level[:, None], problem.power.size
    sv, sz = 0.5 * np.log(vv) + level, 0.5 * np.log(zz) + level
    rates = 0.5 * np.log(moments.rates) + level
    mismatch = np.hstack([sv, sz, np.arctanh(vz / np.sqrt(vv * zz)), rates]).T - unknowns
    mismatch[len(mismatch) - k :][problem.idle.T] = 0.0
    return np.asarray(mismatch)


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
    problem: Springs, unknowns: Array, most: int, depth: int = DEPTH, relaxation: float = 1.0
) -> FixedPoint:
    """The loop: coefficients, response and the next moments, until both stand still in each cell.

    ``depth`` rounds are mixed; with none this is the substitution of the paper, which goes the share
    ``relaxation`` of the way to the moments of the response.
    """
    part, cells, mixing = problem, np.arange(unknowns.shape[1]), Mixing.begin(unknowns, depth)
    solution = FixedPoint(
        unknowns.copy(),
        np.full((problem.size, cells.size), np.nan),
        np.zeros(cells.size, np.int32),
        np.full(cells.size, np.nan),
        np.zeros(cells.size, bool),
    )
    weaker = np.zeros((len(unknowns), 1))
    weaker[problem.springs : 2 * problem.springs] = -1.0  # of log sigma_z: less yielding
    before = None
    for _ in range(most):
        if not cells.size:
            break
        linear = linear_for(part, mixing.unknowns)
        moments = respond(part, linear)
        mismatch = mismatch_of(part, mixing.unknowns, moments)
        now = linear, moments.covariance
        change = largest_change(part, now, before) if before else np.full((2, cells.size), np.nan)
        part.rounds.append((part.cells, change))
        norm = np.sqrt((mismatch**2).sum(axis=0) / max(1, part.springs + part.power.size))
        done = stands_still(change, relaxation * part.rtol) & (norm <= SOLVED)
        rows = mixing.unknowns, np.concatenate(linear, axis=1).T
        for field, values in zip(
            solution, (*rows, solution.iterations[cells] + 1, norm, done), strict=True
        ):
            field[..., cells] = values
        left = np.flatnonzero(~done)
        mixing = mixing.next(mismatch, weaker, relaxation).at(left)
        before = Linear(*(values[left] for values in linear)), moments.covariance[left]
        part, cells = part.at(left), cells[left]
    return solution


class SpringSolution(NamedTuple):
    """Result of the iteration."""

    linear: Linear  # NaN in cells that have not converged
    idle: Array  # (c, k) as in `Springs`
    converged: Array  # (c,)
    demand: Array  # (c,) largest elastic standard deviation of an extension over its strength
    changes: Array  # (rounds, 2, c) as in `stands_still`, NaN after the last round
    rounds: Array  # (c,)


@np.errstate(all="ignore")  # NaN is checked where it matters
def solve_springs(
    problem: Springs, one_solution: Array, max_iterations: int, relaxation: float | None = None
) -> SpringSolution:
    """Equivalent linear systems of all cells, by substitution if a ``relaxation`` factor is given.

    Otherwise by `fixed_points` with mixing. Where a law may have several solutions, so that
    ``one_solution`` (c,) is false, and where this fails, the solution is followed by `solve`.
    """
    problem, elastic = elastic_start(problem)
    m, count = problem.springs, elastic.shape[1]
    rows, converged = np.full((problem.size, count), np.nan), np.zeros(count, bool)
    if not len(elastic):  # nothing is to be linearized
        rows[:], converged[:] = np.concatenate(linear_for(problem, elastic), axis=1).T, True

    def keep(cells: Array, solution: FixedPoint) -> None:
        converged[cells] = solution.converged
        rows[:, cells] = np.where(solution.converged, solution.coefficients, np.nan)

    start, tried = elastic_limit(elastic, m), np.isfinite(elastic).all(axis=0) & ~converged
    if relaxation is not None:
        cells = np.flatnonzero(tried)
        part = problem.at(cells)
        keep(cells, fixed_points(part, start[:, cells], max_iterations, 0, relaxation))
    else:
        cells = np.flatnonzero(tried & one_solution)
        keep(cells, fixed_points(problem.at(cells), start[:, cells], max_iterations))
        cells = np.flatnonzero(tried & ~converged)
        part, followed = problem.at(cells), np.zeros(cells.size, bool)
        keep(cells, solve(part, elastic[:, cells], followed, max_iterations))
    linear = Linear(*np.split(rows.T, [m, 2 * m], axis=1))
    demand = np.exp(elastic[m : 2 * m].max(axis=0, initial=-np.inf))
    return SpringSolution(linear, problem.idle, converged, demand, *_history(problem))


def _history(problem: Springs) -> tuple[Array, Array]:
    """Changes (rounds, 2, c) in the rounds of each cell, NaN after its last, and their number (c,)."""
    count = np.zeros(len(problem.cells), np.int32)
    changes = np.full((len(problem.rounds), 2, count.size), np.nan)
    for cells, change in problem.rounds:
        changes[count[cells], :, cells] = change.T
        count[cells] += 1
    return changes[: count.max(initial=0)], count


def elastic_start(problem: Springs) -> tuple[Springs, Array]:
    """The problem with its idle dashpots, and the unknowns (3 m + k, c) of the elastic response.

    Dashpots with an exponent are linearized for the rates without them.
    """
    mechanics, power = problem.mechanics, problem.power
    none = np.zeros_like(problem.strength)
    rates = np.zeros(problem.idle.shape)
    if power.size:
        constants = problem.dashpots.copy()
        constants[:, power] = 0.0
        links = mechanics.system.extensions[problem.linearized_dashpots]
        coordinates, ends = np.eye(mechanics.system.mass.shape[1]), np.zeros_like(rates)
        for cells, system in alike(state_space(mechanics, none - 1, none, constants)):
            undamped = StationaryResponse(system)
            rates[cells] = undamped.std(links, rates=True)
            ends[cells] = undamped.std(coordinates, rates=True) @ np.abs(links).T
        problem = problem._replace(idle=rates < IDLE * ends)
        rates = np.where(problem.idle, 0.0, np.log(rates))
    variances = respond(problem, Linear(none, none, _dashpots(problem, rates))).springs
    sv, sz = 0.5 * np.log(variances[:2])
    return problem, np.hstack([sv, sz, np.where(np.isnan(sv), np.nan, 0.1), rates]).T


def _dashpots(problem: Springs, rates: Array) -> Array:
    """Damping constants (c, l) of all links; ``rates`` are ``log sigma`` of those with an exponent."""
    dashpots, power = problem.dashpots.copy(), problem.power
    constants, exponents = dashpots[:, power], problem.exponents[:, power]
    linear = equivalent_dashpot(constants, exponents, np.exp(rates))
    linear = np.where(exponents == 1, constants, linear)
    dashpots[:, power] = np.where(problem.idle, 0.0, linear)
    return dashpots
