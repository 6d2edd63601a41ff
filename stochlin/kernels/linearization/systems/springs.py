"""Steps of the iteration for systems of springs, many at once.

The equivalent coefficients define a linear system (`state_space`). Its covariance, from the Lyapunov
equation (`respond`), gives the moments of the springs that yield, and the closure gives the coefficients
for these moments (`coefficients_of`). This is repeated until covariance and coefficients stand still.
`Substitution` does so directly, which may cycle; `Springs` makes damped steps of Newton's method.

A dashpot with an exponent is linearized too, with ``log sigma`` of the rate of its extension as one more
unknown (Roberts and Spanos 1990, Random vibration and statistical linearization).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization.cells.steps import (
    LARGEST_MISMATCH,
    LARGEST_STEP,
    StepControl,
    next_delta,
    slope_of_unknowns,
)
from stochlin.kernels.linearization.gaussian import Closure, ClosureValue, equivalent_dashpot
from stochlin.kernels.linearization.iteration import (
    BOLD,
    FixedPoint,
    State,
    elastic_limit,
    iterate,
    solve,
)
from stochlin.kernels.linearization.systems.response import StationaryResponse, alike
from stochlin.kernels.linearization.systems.state_space import Mechanics, state_space

IDLE = 1e-6  # ratio of the rate of a link to those of its ends below which it may be a rounding error


class Law(NamedTuple):
    """Hysteresis law of some of the springs that yield."""

    springs: Array  # (i,) their numbers among the springs that yield
    closure: Closure
    parameters: Array  # (p, c, i)

    def values(self, latent: Array) -> ClosureValue:
        """What the closure finds for assumed moments (3, c, m) of all springs; arrays (..., c, i)."""
        moments = latent[..., self.springs]
        shape = moments.shape[1:]
        parameters = self.parameters.reshape(len(self.parameters), moments[0].size)
        flat = self.closure(moments.reshape(3, -1), parameters)
        return ClosureValue(*(field.reshape(*field.shape[:-1], *shape) for field in flat))


class Linear(NamedTuple):
    """Equivalent coefficients of the springs that yield, and linear dashpots of all links."""

    slip: Array  # (c, m) 1 + c_eq
    relaxation: Array  # (c, m) k_eq [1/s]
    dashpots: Array  # (c, l) damping constants [N s/m]

    def at(self, cells: Array) -> Linear:
        """The cells with these numbers."""
        return Linear(*(part[cells] for part in self))

    @property
    def rows(self) -> Array:
        """All coefficients (2 m + l, c)."""
        return np.concatenate(self, axis=1).T

    @classmethod
    def of(cls, problem: Springs, rows: Array) -> Linear:
        """From all coefficients (2 m + l, c)."""
        m = problem.springs
        return cls(rows[:m].T, rows[m : 2 * m].T, rows[2 * m :].T)


class ResponseMoments(NamedTuple):
    """What the iteration needs of the response; NaN in cells without a stationary one."""

    covariance: Array  # (c, states, states)
    springs: Array  # (3, c, m) Var d', Var z, Cov(d', z) over the square of the strength
    rates: Array  # (c, k) variances of the rates of extension of linearized dashpots
    slopes: Array  # (c, 3 m + k, 2 m + k) derivatives by the coefficients, if asked for


class Watch:
    """The linear systems of the last iteration of all cells, and the changes in each iteration."""

    def __init__(self, mechanics: Mechanics, linear: Linear) -> None:
        cells, states = len(mechanics.intensity), sum(part.size for part in mechanics.order)
        self.linear = linear
        self.covariance = np.full((cells, states, states), np.nan)
        self.changes = np.full((0, 2, cells), np.nan)
        self.iterations = np.zeros(cells, np.int32)

    def forget(self, cells: Array) -> None:
        """Forget the linear systems of some cells, for which an iteration begins."""
        for part in (*self.linear, self.covariance):
            part[cells] = np.nan

    def add(self, springs: Springs, linear: Linear, covariance: Array, good: Array) -> Array:
        """Add an iteration, and return the largest changes (2, cells) of covariance and coefficients.

        That of a covariance is over the product of the standard deviations, that of ``k_eq`` over
        ``k_eq`` plus the frequency of the spring, that of a dashpot over its constant. Cells that are
        not ``good`` have no covariance, and are not added.
        """
        cells, before, power = springs.cells, self.linear.at(springs.cells), springs.power
        std = np.sqrt(np.diagonal(covariance, axis1=1, axis2=2))
        std = np.where(std == 0, 1.0, std)
        moved = np.abs(covariance - self.covariance[cells]) / (std[:, :, None] * std[:, None])
        slip = np.abs(linear.slip - before.slip)
        scale = np.abs(linear.relaxation) + springs.mechanics.frequency
        relaxation = np.abs(linear.relaxation - before.relaxation) / scale
        rate = np.abs(linear.dashpots - before.dashpots)[:, power]
        relative = np.where(rate == 0, 0.0, rate / np.abs(before.dashpots[:, power]))
        parts = np.concatenate([slip, relaxation, relative], axis=1)
        changes = np.stack([moved.max(axis=(1, 2)), parts.max(axis=1, initial=0.0)])
        self.covariance[cells[good]] = covariance[good]
        for old, new in zip(self.linear, linear, strict=True):
            old[cells[good]] = new[good]
        self._record(cells[good], changes[:, good])
        return changes

    def _record(self, cells: Array, changes: Array) -> None:
        if self.iterations[cells].max(initial=-1) >= len(self.changes):
            more = np.full((max(16, len(self.changes)), *self.changes.shape[1:]), np.nan)
            self.changes = np.concatenate([self.changes, more])
        self.changes[self.iterations[cells], :, cells] = changes.T
        self.iterations[cells] += 1


class Springs(NamedTuple):
    """Systems with m springs that yield and l links, in c cells: a `Problem` of the iteration."""

    mechanics: Mechanics
    laws: Sequence[Law]
    dashpots: Array  # (c, l) damping constants of the links
    exponents: Array  # (c, l) of the dashpots
    power: Array  # (k,) numbers of the links whose dashpots are linearized
    idle: Array  # (c, k) whether the ends of such a link move together
    level: Array  # (c,) logarithm of the ratio of the shaking to the full one, as standard deviations
    rtol: float
    watch: Watch
    cells: Array  # (c,) their numbers among those that are watched

    @classmethod
    def of(
        cls,
        mechanics: Mechanics,
        laws: Sequence[Law],
        dashpots: Array,
        exponents: Array,
        rtol: float,
    ) -> Springs:
        """Under full shaking, before the first iteration."""
        power = np.flatnonzero(((exponents != 1) & (dashpots > 0)).any(axis=0))
        none = np.full((len(dashpots), mechanics.springs.size), np.nan)
        watch = Watch(mechanics, Linear(none, none.copy(), np.full_like(dashpots, np.nan)))
        idle, level = np.zeros((len(none), power.size), bool), np.zeros(len(none))
        of_links = dashpots, exponents, power, idle
        return cls(mechanics, laws, *of_links, level, rtol, watch, np.arange(len(none)))

    @property
    def springs(self) -> int:
        """The number m."""
        return self.mechanics.springs.size

    @property
    def strength(self) -> Array:
        """Extensions at yield (c, m) [m]."""
        return self.mechanics.system.strength[:, self.mechanics.springs]

    @property
    def size(self) -> int:
        """Number of the coefficients of `Linear`."""
        return 2 * self.springs + int(self.dashpots.shape[1])

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

    def settle(self, unknowns: Array, most: int, pace: StepControl) -> FixedPoint:
        """The fixed points from these unknowns (u, c)."""
        self.watch.forget(self.cells)
        return iterate(self, unknowns, most, pace)

    def coefficients(self, unknowns: Array) -> Array:
        """`Linear` for these unknowns, as rows (k, c)."""
        return _linear(self, unknowns)[0].rows

    def advance(self, state: State, pace: StepControl) -> State:
        """A damped step of Newton's method, which `StepControl` controls."""
        linear, moments, mismatch, slopes = _newton_round(self, state.unknowns)
        good = np.asarray(np.isfinite(mismatch).all(axis=1) & np.isfinite(slopes).all(axis=(1, 2)))
        before, count = state.norm, self.springs + self.power.size
        now = np.where(good, np.sqrt((mismatch**2).sum(axis=1) / count), np.inf)
        change = self.watch.add(self, linear, moments.covariance, good)
        rounding = (now <= self.rtol) | ((before < now) & (now < LARGEST_MISMATCH))
        delta = np.array(
            [next_delta(*each, pace) for each in zip(state.delta, before, now, strict=True)]
        )
        # Without a stationary response: take back most of the step, or begin with less yielding.
        weaker = state.step.copy()
        weaker[self.springs : 2 * self.springs] -= 1.0
        step = np.where(np.isinf(before), weaker, 0.25 * state.step)
        damped = np.eye(len(step)) / delta[good, None, None] - slopes[good]
        forward = _solve_each(damped, mismatch[good])
        forward /= np.maximum(1.0, np.abs(forward).max(axis=1, keepdims=True, initial=0) / LARGEST_STEP)
        step[:, good] = forward.T
        base = np.where(good, state.unknowns, state.base)
        done = good & rounding & stands_still(change, self.rtol)
        return State(base, np.where(good, now, before), step, delta, done.astype(float))


class Substitution(NamedTuple):
    """Springs whose covariance gives the next coefficients directly; these are the unknowns."""

    problem: Springs
    relaxation: float  # share of the way to the new coefficients

    def at(self, cells: Array) -> Substitution:
        """The cells with these numbers."""
        return self._replace(problem=self.problem.at(cells))

    def coefficients(self, unknowns: Array) -> Array:
        """The unknowns."""
        return unknowns

    def advance(self, state: State, pace: StepControl) -> State:
        """A step of the share ``relaxation``."""
        problem, old = self.problem, state.unknowns
        linear = Linear.of(problem, old)
        moments = respond(problem, linear)
        change = problem.watch.add(
            problem, linear, moments.covariance, np.ones(len(problem.cells), bool)
        )
        done = stands_still(change, self.relaxation * problem.rtol)
        step = np.where(done, 0.0, self.relaxation * (_renewed(problem, moments).rows - old))
        return State(old, change.max(axis=0), step, state.delta, done.astype(float))


class SpringSolution(NamedTuple):
    """Result of the iteration."""

    linear: Linear  # NaN in cells that have not converged
    idle: Array  # (c, k) as in `Springs`
    converged: Array  # (c,)
    demand: Array  # (c,) largest elastic standard deviation of an extension over its strength


@np.errstate(all="ignore")  # NaN is checked where it matters
def solve_springs(
    problem: Springs, one_solution: Array, max_iterations: int, relaxation: float | None = None
) -> SpringSolution:
    """Equivalent linear systems of all cells, by substitution if a ``relaxation`` factor is given.

    Otherwise they are found by `solve`, which follows the solution where a law may have several, so that
    ``one_solution`` (c,) is false.
    """
    problem, elastic = elastic_start(problem)
    m, count = problem.springs, elastic.shape[1]
    if not len(elastic):  # nothing is to be linearized
        linear = _linear(problem, elastic)[0]
        return SpringSolution(linear, problem.idle, np.ones(count, bool), np.zeros(count))
    tried = np.flatnonzero(np.isfinite(elastic).all(axis=0))
    part, start = problem.at(tried), elastic[:, tried]
    if relaxation is None:
        fixed_point = solve(part, start, one_solution[tried], max_iterations)
    else:
        begin = part.coefficients(elastic_limit(start, m))
        fixed_point = iterate(Substitution(part, relaxation), begin, max_iterations, BOLD)
    rows, done = np.full((problem.size, count), np.nan), tried[fixed_point.converged]
    rows[:, done] = fixed_point.coefficients[:, fixed_point.converged]
    demand = np.exp(elastic[m : 2 * m].max(axis=0, initial=-np.inf))
    return SpringSolution(
        Linear.of(problem, rows), problem.idle, np.isin(np.arange(count), done), demand
    )


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
        links, coordinates = _springs_of(problem), np.eye(mechanics.system.mass.shape[1])
        ends = np.zeros_like(rates)
        for cells, system in alike(state_space(mechanics, none - 1, none, constants)):
            undamped = StationaryResponse(system)
            rates[cells] = undamped.std(mechanics.system.extensions[links], rates=True)
            moved = undamped.std(coordinates, rates=True)
            ends[cells] = moved @ np.abs(mechanics.system.extensions[links]).T
        problem = problem._replace(idle=rates < IDLE * ends)
        rates = np.where(problem.idle, 0.0, np.log(rates))
    variances = respond(problem, Linear(none, none, _dashpots(problem, rates))).springs
    sv, sz = 0.5 * np.log(variances[:2])
    return problem, np.hstack([sv, sz, np.where(np.isnan(sv), np.nan, 0.1), rates]).T


def respond(problem: Springs, linear: Linear, *, slopes: bool = False) -> ResponseMoments:
    """Covariance of the linear systems, from the Lyapunov equation, and moments of their springs."""
    mechanics, strength, dashpots = problem.mechanics, problem.strength, _springs_of(problem)
    system = state_space(mechanics, linear.slip - 1, linear.relaxation, linear.dashpots)
    (cells, m), k = strength.shape, dashpots.size
    size = 3 * m + k if slopes else 0
    shapes = system.matrix.shape, (3, cells, m), (cells, k), (cells, size, 2 * m + k)
    moments = ResponseMoments(*(np.empty(shape) for shape in shapes))
    for group, part in alike(system):
        response = StationaryResponse(part)
        moments.covariance[group] = response.covariance
        moments.springs[:, group] = np.stack(response.moments[1:]) / strength[group] ** 2
        moments.rates[group] = response.std(mechanics.system.extensions[dashpots], rates=True) ** 2
        if slopes:
            moments.slopes[group] = response.slopes(dashpots, mechanics.system.mass[group])
    return moments


def coefficients_of(problem: Springs, latent: Array) -> ClosureValue:
    """Coefficients by the closure, eqs. (9) and (10), for assumed moments (3, c, m)."""
    shape = latent.shape[1:]
    whole = ClosureValue(*(np.empty((*rows, *shape)) for rows in ((2,), (2, 3), (3,), (3, 3))))
    for law in problem.laws:
        for field, part in zip(whole, law.values(latent), strict=True):
            field[..., law.springs] = part
    return whole


def stands_still(change: Array, rtol: float) -> Array:
    """Whether neither covariance nor coefficients (2, c) changed by more than ``rtol``."""
    return np.asarray((change <= rtol).all(axis=0))


def _newton_round(problem: Springs, unknowns: Array) -> tuple[Linear, ResponseMoments, Array, Array]:
    """Linear systems for the unknowns (u, c), their moments, and the mismatch (c, u) with its slopes."""
    linear, values = _linear(problem, unknowns)
    moments = respond(problem, linear, slopes=True)
    (u, cells), n, level = unknowns.shape, 3 * problem.springs, problem.level[:, None]
    reached, by_moments = to_unknowns(moments.springs)
    reached[:2] += level
    mismatch = np.empty((cells, u))
    mismatch[:, :n] = (reached - _of_springs(problem, unknowns)).transpose(1, 0, 2).reshape(cells, n)
    mismatch[:, n:] = 0.5 * np.log(moments.rates) + level - unknowns[n:].T
    slopes = _slopes_of_reached(problem, unknowns, linear, values, moments, by_moments) - np.eye(u)
    still = np.concatenate([np.zeros((cells, n), bool), problem.idle], axis=1)
    mismatch[still] = 0.0
    slopes = np.where(still[..., None], -np.eye(u), slopes)
    return linear, moments, mismatch, slopes


def _slopes_of_reached(
    problem: Springs,
    unknowns: Array,
    linear: Linear,
    values: ClosureValue,
    moments: ResponseMoments,
    by_moments: Array,
) -> Array:
    """Derivatives (c, u, u) of what the response reaches, as unknowns, by the unknowns.

    They are the product of those of the unknowns by the moments, of the moments by the coefficients, and
    of the coefficients by the unknowns.
    """
    (cells, m), k = problem.strength.shape, problem.power.size
    n, power = 3 * m, problem.power
    scaled = (
        moments.slopes[:, :n].reshape(cells, 3, m, 2 * m + k) / problem.strength[:, None, :, None] ** 2
    )
    of_springs = np.einsum("iacm,camx->cimx", by_moments, scaled).reshape(cells, n, 2 * m + k)
    of_rates = 0.5 / moments.rates[..., None] * moments.slopes[:, n:]
    reached = np.concatenate([of_springs, of_rates], axis=1)
    by_unknowns = values.coefficients_jacobian * _by_latent(problem, unknowns)
    slopes = np.empty((cells, n + k, n + k))
    by_coefficients = reached[..., : 2 * m].reshape(cells, n + k, 2, m)
    chain = np.einsum("xyan,alxn->xyln", by_coefficients, by_unknowns)
    slopes[..., :n] = chain.reshape(cells, n + k, n)
    of_constants = linear.dashpots[:, power] * (problem.exponents[:, power] - 1)
    slopes[..., n:] = reached[..., 2 * m :] * of_constants[:, None]
    return slopes


def _by_latent(problem: Springs, unknowns: Array) -> Array:
    """Derivatives (3, c, m) of the assumed moments by their unknowns."""
    sv, sz, r = _of_springs(problem, unknowns)
    return np.stack([np.exp(sv), np.exp(sz), 1 - np.tanh(r) ** 2])


def _linear(problem: Springs, unknowns: Array) -> tuple[Linear, ClosureValue]:
    """Equivalent linear systems for the unknowns, and what the closure finds."""
    latent = _of_springs(problem, unknowns)
    values = coefficients_of(
        problem, np.stack([np.exp(latent[0]), np.exp(latent[1]), np.tanh(latent[2])])
    )
    slip, relaxation = values.coefficients
    return Linear(slip, relaxation, _dashpots(problem, unknowns[3 * problem.springs :].T)), values


def _renewed(problem: Springs, moments: ResponseMoments) -> Linear:
    """Equivalent linear systems for the moments of the response."""
    vv, zz, vz = moments.springs
    latent = np.stack([np.sqrt(vv), np.sqrt(zz), vz / np.sqrt(vv * zz)])
    rates = np.where(problem.idle, 0.0, 0.5 * np.log(moments.rates))
    slip, relaxation = coefficients_of(problem, latent).coefficients
    return Linear(slip, relaxation, _dashpots(problem, rates))


def _dashpots(problem: Springs, rates: Array) -> Array:
    """Damping constants (c, l) of all links; ``rates`` are ``log sigma`` of those with an exponent."""
    dashpots, power = problem.dashpots.copy(), problem.power
    constants, exponents = dashpots[:, power], problem.exponents[:, power]
    linear = equivalent_dashpot(constants, exponents, np.exp(rates))
    linear = np.where(exponents == 1, constants, linear)
    dashpots[:, power] = np.where(problem.idle, 0.0, linear)
    return dashpots


def _springs_of(problem: Springs) -> Array:
    """Numbers (k,) of the springs beside linearized dashpots; links are the last springs."""
    return len(problem.mechanics.system.extensions) - problem.dashpots.shape[1] + problem.power


def _of_springs(problem: Springs, unknowns: Array) -> Array:
    """Unknowns (3, c, m) of the springs that yield."""
    cells, m = problem.strength.shape
    return unknowns[: 3 * m].reshape(3, m, cells).swapaxes(1, 2)


def _solve_each(matrices: Array, right: Array) -> Array:
    """Solutions (c, u) of linear equations; NaN for singular matrices."""
    try:
        return np.linalg.solve(matrices, right[..., None])[..., 0]
    except np.linalg.LinAlgError:
        if len(right) == 1:
            return np.full_like(right, np.nan)
        halves = zip(np.array_split(matrices, 2), np.array_split(right, 2), strict=True)
        return np.concatenate([_solve_each(*half) for half in halves])


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
