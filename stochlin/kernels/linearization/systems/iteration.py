"""The iteration of statistical linearization for systems of springs, for many cells at once.

The equivalent coefficients define a linear system (`state_space`). Its covariance, from the Lyapunov
equation (`respond`), gives the moments of the springs that yield, and the closure gives the coefficients
for these moments (`coefficients_of`). This is repeated until covariance and coefficients stand still
(`stands_still`).

`by_substitution` does so directly, which may cycle. In `by_newton` the unknowns are the moments that the
closure assumes, ``(log sigma_v, log sigma_z, atanh r)`` of each spring. Their mismatch, the moments of
the linear system less those assumed, is brought to zero by a damped Newton's method, as in
`stochlin.kernels.linearization.fixed_point`. A dashpot with an exponent is linearized too, with ``log
sigma`` of the rate of its extension as one more unknown (Roberts and Spanos 1990, Random vibration and
statistical linearization).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np
from scipy.optimize import elementwise

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization.cells.steps import LARGEST_MISMATCH, LARGEST_STEP, Pace, next_delta
from stochlin.kernels.linearization.fixed_point import (
    AT_LEVEL,
    BOLD,
    BOLD_SHARE,
    CAREFUL,
    FIRST_RISE,
    LEAST_RISE,
    LONGER,
    NEAR,
    SHORTER,
    WEAK,
    to_unknowns,
)
from stochlin.kernels.linearization.gaussian import Closure, ClosureValue, equivalent_dashpot
from stochlin.kernels.linearization.systems.response import Response, alike
from stochlin.kernels.linearization.systems.state_space import Mechanics, state_space

IDLE = 1e-6  # ratio of the rate of a link to those of its ends below which it may be a rounding error


class Law(NamedTuple):
    """Hysteresis law of some of the springs that yield."""

    springs: Array  # (i,) their numbers among the springs that yield
    closure: Closure
    parameters: Array  # (p, c, i)
    clips: bool  # whether the moments that the closure assumes are those before clipping

    def values(self, latent: Array) -> ClosureValue:
        """What the closure finds for assumed moments (3, c, m) of all springs; arrays (..., c, i)."""
        moments = latent[..., self.springs]
        shape = moments.shape[1:]
        flat = self.closure(moments.reshape(3, -1), self._parameters)
        return ClosureValue(*(field.reshape(*field.shape[:-1], *shape) for field in flat))

    def assumed(self, moments: Array) -> Array:
        """The moments (3, c, i) that the closure assumes, for those of the response (3, c, m)."""
        own = moments[..., self.springs]
        if not self.clips:
            return own
        return before_clipping(own.reshape(3, -1), self._parameters, self.closure).reshape(own.shape)

    @property
    def _parameters(self) -> Array:
        kinds, cells, springs = self.parameters.shape
        return self.parameters.reshape(kinds, cells * springs)


class Problem(NamedTuple):
    """Systems with m springs that yield and l links, in c cells."""

    mechanics: Mechanics
    strength: Array  # (c, m) extension at yield [m]
    laws: Sequence[Law]
    dashpots: Array  # (c, l) damping constants of the links
    exponents: Array  # (c, l) of the dashpots
    power: Array  # (k,) numbers of the links whose dashpots are linearized
    idle: Array  # (c, k) whether the ends of such a link move together

    def at(self, cells: Array) -> Problem:
        """The cells with these numbers."""
        mechanics, strength, laws, dashpots, exponents, power, idle = self
        chosen = [law._replace(parameters=law.parameters[:, cells]) for law in laws]
        of_links = dashpots[cells], exponents[cells], power, idle[cells]
        return Problem(mechanics.at(cells), strength[cells], chosen, *of_links)


class Linear(NamedTuple):
    """Equivalent coefficients of the springs that yield, and linear dashpots of all links."""

    slip: Array  # (c, m) 1 + c_eq
    relaxation: Array  # (c, m) k_eq [1/s]
    dashpots: Array  # (c, l) damping constants [N s/m]

    def at(self, cells: Array) -> Linear:
        """The cells with these numbers."""
        return Linear(*(part[cells] for part in self))

    @classmethod
    def unknown(cls, problem: Problem) -> Linear:
        """NaN for all cells."""
        parts = problem.strength, problem.strength, problem.dashpots
        return cls(*(np.full_like(part, np.nan) for part in parts))


class Moments(NamedTuple):
    """What the iteration needs of the response; NaN in cells without a stationary one."""

    covariance: Array  # (c, states, states)
    springs: Array  # (3, c, m) Var d', Var z, Cov(d', z) over the square of the strength
    rates: Array  # (c, k) variances of the rates of extension of linearized dashpots
    slopes: Array  # (c, 3 m + k, 2 m + k) derivatives by the coefficients, if asked for


class History:
    """Largest changes of covariance and coefficients in each iteration of each cell."""

    def __init__(self, cells: int) -> None:
        self.changes = np.full((0, 2, cells), np.nan)
        self.iterations = np.zeros(cells, np.int32)

    def add(self, cells: Array, changes: Array) -> None:
        """Add an iteration of some cells, with its changes (2, cells)."""
        if self.iterations[cells].max(initial=-1) >= len(self.changes):
            more = np.full((max(16, len(self.changes)), *self.changes.shape[1:]), np.nan)
            self.changes = np.concatenate([self.changes, more])
        self.changes[self.iterations[cells], :, cells] = changes.T
        self.iterations[cells] += 1


class Solution(NamedTuple):
    """Result of the iteration."""

    linear: Linear  # NaN in cells that have not converged
    idle: Array  # (c, k) as in `Problem`
    converged: Array  # (c,)
    demand: Array  # (c,) largest elastic standard deviation of an extension over its strength
    history: History


@np.errstate(all="ignore")  # NaN is checked where it matters
def solve(
    problem: Problem,
    one_solution: Array,
    rtol: float,
    max_iterations: int,
    relaxation: float | None = None,
) -> Solution:
    """Equivalent linear systems of all cells.

    With a ``relaxation`` factor it is by substitution. Otherwise it is by Newton's method: by large
    steps, else by small steps, else by raising the intensity step by step, which alone is used where a
    law may have several solutions, so that ``one_solution`` (c,) is false.
    """
    problem, elastic = elastic_start(problem)
    history, count, linear = History(len(elastic)), len(elastic), Linear.unknown(problem)
    solvable, converged = np.isfinite(elastic).all(axis=1), np.zeros(count, bool)
    start, all_cells = _yielding(problem, elastic), np.ones(count, bool)
    if not elastic.shape[1]:  # nothing is to be linearized
        return Solution(_linear(problem, elastic)[0], problem.idle, all_cells, np.zeros(count), history)
    bold = max(1, int(BOLD_SHARE * max_iterations))

    def newton(cells: Array, rounds: int, pace: Pace) -> tuple[Array, Linear]:
        here = problem.at(cells)
        done, unknowns = by_newton(here, start[cells], rounds, pace, rtol, history, cells)
        return done, _linear(here, unknowns)[0]

    def follow(cells: Array) -> tuple[Array, Linear]:
        here = problem.at(cells)
        done, unknowns = _follow(here, elastic[cells], max_iterations, rtol, history, cells)
        return done, _linear(here, unknowns)[0]

    def substitution(cells: Array) -> tuple[Array, Linear]:
        assert relaxation is not None
        given = problem.at(cells), start[cells], max_iterations, relaxation, rtol
        return by_substitution(*given, history, cells)

    ways: list[tuple[Callable[[Array], tuple[Array, Linear]], Array]] = [
        (partial(newton, rounds=bold, pace=BOLD), one_solution),
        (partial(newton, rounds=max_iterations - bold, pace=CAREFUL), one_solution),
        (follow, all_cells),
    ]
    for way, allowed in ways if relaxation is None else [(substitution, all_cells)]:
        cells = np.flatnonzero(solvable & ~converged & allowed)
        if cells.size:
            converged[cells], found = way(cells)
            for part, value in zip(linear, found, strict=True):
                part[cells[converged[cells]]] = value[converged[cells]]
    demand = np.exp(_of_springs(problem, elastic)[1].max(axis=1, initial=-np.inf))
    return Solution(linear, problem.idle, converged, demand, history)


def elastic_start(problem: Problem) -> tuple[Problem, Array]:
    """The problem with its idle dashpots, and the unknowns (c, 3 m + k) of the elastic response.

    Dashpots with an exponent are linearized for the rates without them.
    """
    mechanics, power = problem.mechanics, problem.power
    none = np.zeros_like(problem.strength)
    rates = np.zeros(problem.idle.shape)
    if power.size:
        constants = problem.dashpots.copy()
        constants[:, power] = 0.0
        floors, links = np.eye(mechanics.mass.shape[1]), _springs_of(problem)
        ends = np.zeros_like(rates)
        for cells, system in alike(state_space(mechanics, none - 1, none, constants)):
            undamped = Response(system)
            rates[cells] = undamped.std(mechanics.extensions[links], rates=True)
            moved = undamped.std(floors, rates=True)
            ends[cells] = moved @ np.abs(mechanics.extensions[links]).T
        problem = problem._replace(idle=rates < IDLE * ends)
        rates = np.where(problem.idle, 0.0, np.log(rates))
    variances = respond(problem, Linear(none, none, _dashpots(problem, rates))).springs
    sv, sz = 0.5 * np.log(variances[:2])
    return problem, np.concatenate([sv, sz, np.where(np.isnan(sv), np.nan, 0.1), rates], axis=1)


def by_substitution(
    problem: Problem,
    start: Array,
    rounds: int,
    relaxation: float,
    rtol: float,
    history: History,
    cells: Array,
) -> tuple[Array, Linear]:
    """Direct substitution: each covariance gives the next coefficients.

    The coefficients move by the share ``relaxation`` of the way to the new ones. Returns which cells
    have converged, and their equivalent linear systems.
    """
    linear, left = _linear(problem, start)[0], np.arange(len(cells))
    done, last = np.zeros(len(cells), bool), _Last.none(problem)
    for _ in range(rounds):
        here, now = problem.at(left), linear.at(left)
        moments = respond(here, now)
        change = last.change(here, left, now, moments.covariance)
        history.add(cells[left], change)
        done[left] = stands_still(change, relaxation * rtol)
        new = _renewed(here, moments)
        finite = np.ones(left.size, bool)
        for part, old, renewed in zip(linear, now, new, strict=True):
            moved = np.where(done[left, None], old, old + relaxation * (renewed - old))
            part[left] = moved
            finite &= np.isfinite(moved).all(axis=1)
        left = left[finite & ~done[left]]
        if not left.size:
            break
    return done, linear


def by_newton(
    problem: Problem,
    start: Array,
    rounds: int,
    pace: Pace,
    rtol: float,
    history: History,
    cells: Array,
    level: Array | None = None,
) -> tuple[Array, Array]:
    """Damped Newton's method from the unknowns ``start``, for an intensity lower by ``level``.

    The level (c,) is the logarithm of the ratio of the shaking to the full one, as standard deviations.
    Returns which cells have converged, and their unknowns.
    """
    base, step = start.copy(), np.zeros_like(start)
    norm, delta = np.full(len(cells), np.inf), np.full(len(cells), pace.first)
    done, left, last = np.zeros(len(cells), bool), np.arange(len(cells)), _Last.none(problem)
    level = np.zeros(len(cells)) if level is None else level
    for _ in range(rounds):
        here, tried = problem.at(left), base[left] + step[left]
        linear, moments, mismatch, slopes = _newton_round(here, tried, level[left])
        good = np.asarray(np.isfinite(mismatch).all(axis=1) & np.isfinite(slopes).all(axis=(1, 2)))
        before, known = norm[left], left[good]
        now = np.where(good, np.sqrt((mismatch**2).sum(axis=1) / _count(problem)), np.inf)
        change = last.change(here, left, linear, moments.covariance, good)
        history.add(cells[known], change[:, good])
        rounding = (now <= rtol) | ((before < now) & (now < LARGEST_MISMATCH))
        done[left] = good & rounding & stands_still(change, rtol)
        base[known], norm[known] = tried[good], now[good]
        delta[left] = [next_delta(*each, pace) for each in zip(delta[left], before, now, strict=True)]
        # Without a stationary response: take back most of the step, or begin with less yielding.
        back = np.where(
            np.isinf(before)[:, None], step[left] - _flat(problem, 0.0, 1.0, 0.0, 0.0), 0.25 * step[left]
        )
        damped = np.eye(step.shape[1]) / delta[left, None, None] - slopes
        forward = np.full_like(back, np.nan)
        forward[good] = _solve_each(damped[good], mismatch[good])
        forward /= np.maximum(1.0, np.abs(forward).max(axis=1, keepdims=True, initial=0) / LARGEST_STEP)
        step[left] = np.where(good[:, None], forward, back)
        left = left[~done[left] & np.isfinite(step[left]).all(axis=1)]
        if not left.size:
            break
    return done, base


def _follow(
    problem: Problem, elastic: Array, most: int, rtol: float, history: History, cells: Array
) -> tuple[Array, Array]:
    """Follow the solution while the intensity rises from one for which hardly anything yields."""
    count = len(cells)
    slope = np.tile(_flat(problem, 1.0, 1.0, 0.0, 1.0), (count, 1))
    largest = _of_springs(problem, elastic)[1].max(axis=1, initial=-np.inf)
    level = np.minimum(0.0, np.log(WEAK) - largest) - FIRST_RISE
    base, rise = elastic + slope * level[:, None], np.full(count, FIRST_RISE)
    near, done, left = np.full(count, np.inf), np.zeros(count, bool), np.arange(count)
    for _ in range(most):
        at = np.minimum(0.0, level[left] + rise[left])
        guess = base[left] + slope[left] * (at - level[left])[:, None]
        found, reached = by_newton(
            problem.at(left), guess, AT_LEVEL, BOLD, rtol, history, cells[left], at
        )
        good = found & (np.abs(reached - guess).max(axis=1) <= near[left])
        on = left[good]
        steeper = (reached[good] - base[on]) / (at[good] - level[on])[:, None]
        slope[on] = np.where(np.isfinite(near[on])[:, None], steeper, slope[on])
        base[on], level[on], near[on] = reached[good], at[good], NEAR
        rise[left] *= np.where(good, LONGER, SHORTER)
        done[on] = at[good] == 0
        left = left[~done[left] & (rise[left] > LEAST_RISE)]
        if not left.size:
            break
    return done, base


def respond(problem: Problem, linear: Linear, *, slopes: bool = False) -> Moments:
    """Covariance of the linear systems, from the Lyapunov equation, and moments of their springs."""
    mechanics, strength, dashpots = problem.mechanics, problem.strength, _springs_of(problem)
    system = state_space(mechanics, linear.slip - 1, linear.relaxation, linear.dashpots)
    (cells, m), k = strength.shape, dashpots.size
    size = 3 * m + k if slopes else 0
    shapes = system.matrix.shape, (3, cells, m), (cells, k), (cells, size, 2 * m + k)
    moments = Moments(*(np.empty(shape) for shape in shapes))
    for group, part in alike(system):
        response = Response(part)
        moments.covariance[group] = response.covariance
        moments.springs[:, group] = np.stack(response.moments[1:]) / strength[group] ** 2
        moments.rates[group] = response.std(mechanics.extensions[dashpots], rates=True) ** 2
        if slopes:
            moments.slopes[group] = response.slopes(dashpots, mechanics.mass[group])
    return moments


def coefficients_of(problem: Problem, latent: Array) -> ClosureValue:
    """Coefficients and covariance by the closure, eqs. (9) and (10), for assumed moments (3, c, m)."""
    shape = latent.shape[1:]
    whole = ClosureValue(*(np.empty((*rows, *shape)) for rows in ((2,), (2, 3), (3,), (3, 3))))
    for law in problem.laws:
        for field, part in zip(whole, law.values(latent), strict=True):
            field[..., law.springs] = part
    return whole


def stands_still(change: Array, rtol: float) -> Array:
    """Whether neither covariance nor coefficients (2, c) changed by more than ``rtol``."""
    return np.asarray((change <= rtol).all(axis=0))


class _Last(NamedTuple):
    """Last linear systems of all cells and their covariances."""

    linear: Linear
    covariance: Array

    @classmethod
    def none(cls, problem: Problem) -> _Last:
        """Before the first iteration."""
        states = sum(part.size for part in problem.mechanics.order)
        covariance = np.full((len(problem.strength), states, states), np.nan)
        return cls(Linear.unknown(problem), covariance)

    def change(
        self,
        problem: Problem,
        cells: Array,
        linear: Linear,
        covariance: Array,
        good: Array | None = None,
    ) -> Array:
        """Largest changes (2, cells) of covariance and coefficients, and keep those of ``good`` cells.

        That of a covariance is over the product of the standard deviations, that of ``k_eq`` over
        ``k_eq`` plus the frequency of the spring, that of a dashpot over its constant.
        """
        std = np.sqrt(np.diagonal(covariance, axis1=1, axis2=2))
        std = np.where(std == 0, 1.0, std)
        moved = np.abs(covariance - self.covariance[cells]) / (std[:, :, None] * std[:, None])
        before, power = self.linear.at(cells), problem.power
        slip = np.abs(linear.slip - before.slip)
        scale = np.abs(linear.relaxation) + problem.mechanics.frequency
        relaxation = np.abs(linear.relaxation - before.relaxation) / scale
        rate = np.abs(linear.dashpots - before.dashpots)[:, power]
        relative = np.where(rate == 0, 0.0, rate / np.abs(before.dashpots[:, power]))
        parts = np.concatenate([slip, relaxation, relative], axis=1)
        kept = slice(None) if good is None else good
        self.covariance[cells[kept]] = covariance[kept]
        for old, new in zip(self.linear, linear, strict=True):
            old[cells[kept]] = new[kept]
        return np.stack([moved.max(axis=(1, 2)), parts.max(axis=1, initial=0.0)])


def _newton_round(
    problem: Problem, unknowns: Array, level: Array
) -> tuple[Linear, Moments, Array, Array]:
    """Linear systems for the unknowns (c, u), their moments, and the mismatch (c, u) with its slopes."""
    linear, values = _linear(problem, unknowns)
    moments = respond(problem, linear, slopes=True)
    cells, n = len(unknowns), 3 * problem.strength.shape[1]
    reached, by_moments = to_unknowns(moments.springs)
    reached[:2] += level[:, None]
    assumed, by_assumed = to_unknowns(values.covariance)
    mismatch = np.empty_like(unknowns)
    mismatch[:, :n] = (reached - assumed).transpose(1, 0, 2).reshape(cells, n)
    mismatch[:, n:] = 0.5 * np.log(moments.rates) + level[:, None] - unknowns[:, n:]
    slopes = _slopes_of_reached(problem, unknowns, linear, values, moments, by_moments)
    latent = _by_latent(problem, unknowns)
    own = np.einsum("iacm,alcm,lcm->cmil", by_assumed, values.covariance_jacobian, latent)
    for spring, block in enumerate(own.swapaxes(0, 1)):
        place = np.arange(spring, n, problem.strength.shape[1])
        slopes[:, place[:, None], place] -= block
    rates = np.arange(n, unknowns.shape[1])
    slopes[:, rates, rates] -= 1.0
    still = np.concatenate([np.zeros((cells, n), bool), problem.idle], axis=1)
    mismatch[still] = 0.0
    slopes = np.where(still[..., None], -np.eye(unknowns.shape[1]), slopes)
    return linear, moments, mismatch, slopes


def _slopes_of_reached(
    problem: Problem,
    unknowns: Array,
    linear: Linear,
    values: ClosureValue,
    moments: Moments,
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


def _by_latent(problem: Problem, unknowns: Array) -> Array:
    """Derivatives (3, c, m) of the assumed moments by their unknowns."""
    sv, sz, r = _of_springs(problem, unknowns)
    return np.stack([np.exp(sv), np.exp(sz), 1 - np.tanh(r) ** 2])


def _linear(problem: Problem, unknowns: Array) -> tuple[Linear, ClosureValue]:
    """Equivalent linear systems for the unknowns, and what the closure finds."""
    latent = _of_springs(problem, unknowns)
    values = coefficients_of(
        problem, np.stack([np.exp(latent[0]), np.exp(latent[1]), np.tanh(latent[2])])
    )
    rates = unknowns[:, 3 * problem.strength.shape[1] :]
    slip, relaxation = values.coefficients
    return Linear(slip, relaxation, _dashpots(problem, rates)), values


def _renewed(problem: Problem, moments: Moments) -> Linear:
    """Equivalent linear systems for the moments of the response."""
    vv, zz, vz = moments.springs
    found = np.stack([np.sqrt(vv), np.sqrt(zz), vz / np.sqrt(vv * zz)])
    latent = np.empty_like(found)
    for law in problem.laws:
        latent[..., law.springs] = law.assumed(found)
    rates = np.where(problem.idle, 0.0, 0.5 * np.log(moments.rates))
    slip, relaxation = coefficients_of(problem, latent).coefficients
    return Linear(slip, relaxation, _dashpots(problem, rates))


def _dashpots(problem: Problem, rates: Array) -> Array:
    """Damping constants (c, l) of all links; ``rates`` are ``log sigma`` of those with an exponent."""
    dashpots, power = problem.dashpots.copy(), problem.power
    constants, exponents = dashpots[:, power], problem.exponents[:, power]
    linear = equivalent_dashpot(constants, exponents, np.exp(rates))
    linear = np.where(exponents == 1, constants, linear)
    dashpots[:, power] = np.where(problem.idle, 0.0, linear)
    return dashpots


def _springs_of(problem: Problem) -> Array:
    """Numbers (k,) of the springs beside linearized dashpots; links are the last springs."""
    return len(problem.mechanics.extensions) - problem.dashpots.shape[1] + problem.power


def _of_springs(problem: Problem, unknowns: Array) -> Array:
    """Unknowns (3, c, m) of the springs that yield."""
    cells, m = problem.strength.shape
    return unknowns[:, : 3 * m].reshape(cells, 3, m).transpose(1, 0, 2)


def _flat(problem: Problem, sv: float, sz: float, r: float, rate: float) -> Array:
    """A row of unknowns with one value for each kind of unknown."""
    m, k = problem.strength.shape[1], problem.power.size
    return np.repeat([sv, sz, r, rate], [m, m, m, k])


def _count(problem: Problem) -> int:
    """Number of springs and dashpots that are linearized."""
    return problem.strength.shape[1] + problem.power.size


def _yielding(problem: Problem, elastic: Array) -> Array:
    """Unknowns to start from: those of the elastic response, with ``sigma_z`` at most 1."""
    m = problem.strength.shape[1]
    start = elastic.copy()
    start[:, m : 2 * m] = np.minimum(start[:, m : 2 * m], 0.0)
    return start


def _solve_each(matrices: Array, right: Array) -> Array:
    """Solutions (c, u) of linear equations; NaN for singular matrices."""
    try:
        return np.linalg.solve(matrices, right[..., None])[..., 0]
    except np.linalg.LinAlgError:
        regular = np.linalg.matrix_rank(matrices) == right.shape[1]
        found = np.full_like(right, np.nan)
        found[regular] = np.linalg.solve(matrices[regular], right[regular, :, None])[..., 0]
        return found


def before_clipping(moments: Array, parameters: Array, closure: Closure) -> Array:
    """Moments (3, n) of ``(v, z~)`` before clipping, for those after it; NaN where there are none.

    The standard deviation of ``z~`` is found by a search. The covariance of ``v`` and ``z`` is
    proportional to the correlation before clipping.
    """
    sv, sz, r = moments

    def variance(log_sz: Array, index: Array) -> Array:
        here = index.astype(int)
        guess = np.stack([sv[here], np.exp(log_sz), np.zeros_like(log_sz)])
        return np.log(closure(guess, parameters[:, here]).covariance[1] / sz[here] ** 2)

    index = np.arange(sz.size, dtype=float)
    lowest = np.full_like(sz, np.log(np.min(sz, initial=1.0)) - 1)
    root = elementwise.find_root(variance, (lowest, np.full_like(sz, 25.0)), args=(index,))
    latent = np.stack([sv, np.where(root.success, np.exp(root.x), np.nan), np.full_like(sz, 0.5)])
    half = closure(latent, parameters).covariance[2]
    latent[2] = 0.5 * r * sv * sz / half
    latent[:, np.abs(latent[2]) >= 1] = np.nan
    return latent
