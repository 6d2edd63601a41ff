"""The loop of statistical linearization, for any number of elements and dashpots at once.

Coefficients make a linear system; its covariance says how the elements move; a closure makes new
coefficients of that. Put straight back they may cycle for ever. So the moments that the closure assumes,
``(log sigma_v, log sigma_z, atanh r)`` of each element, are corrected as in
`stochlin.kernels.linearization.fixed_point`, by the slopes of what comes out of them: each round takes
the loop once, and the last ones are Newton's method. A dashpot with an exponent is linearized likewise:
``log sigma`` of the rate beside it is one more unknown (Roberts and Spanos 1990, Random vibration and
statistical linearization).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from stochlin.analyses.linearization.equivalent_systems import ELASTIC, STRONG
from stochlin.analyses.linearization.systems.state_space import Equations
from stochlin.analyses.linearization.tolerance import Tolerance
from stochlin.analyses.tables import labels
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization.augmented import Solved
from stochlin.kernels.linearization.cells.steps import (
    LARGEST_MISMATCH,
    LARGEST_STEP,
    Pace,
    next_delta,
)
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
from stochlin.kernels.linearization.lyapunov import UnsolvableError
from stochlin.models.laws.bilinear import Bilinear

IDLE = 1e-6  # rate of a link over those of its ends: less may be rounding


class Round(NamedTuple):
    """Once through the loop."""

    values: ClosureValue  # what the closure makes of the moments assumed
    dashpots: Array  # (t,): of all links, linear ones as they are
    motion: Solved  # of the linear system with these coefficients
    mismatch: Array  # (3 m + l,): unknowns that come out, less those assumed
    slopes: Array  # of that by those assumed


class Change(NamedTuple):
    """From one round to the next."""

    covariance: float  # largest, over the product of the standard deviations
    coefficients: float  # largest of c_eq, and of k_eq over its sum with the frequency of the element


class Solution(NamedTuple):
    """Where the loop ended."""

    c_eq: Array  # of the elements (e,)
    k_eq: Array
    dashpots: Array  # of the links (t,), NaN where one with an exponent is idle
    motion: Solved | None  # None if nothing can be computed
    history: tuple[Change, ...]
    status: int


@dataclass(frozen=True)
class Loop:
    """Structures on one ground, their strengths in metres, and how their laws are linearized.

    Its unknowns are ``log sigma_v``, ``log sigma_z`` and ``atanh r`` of the ``m`` elements that yield,
    and ``log sigma`` of the rates beside the ``l`` dashpots with an exponent.
    """

    equations: Equations
    closure: str
    tolerance: Tolerance

    @np.errstate(all="ignore")  # what is no number is judged where it counts
    def solve(self) -> Solution:
        """By large steps, then by small ones; else, or with several solutions, from weak shaking on."""
        try:
            elastic = self._elastic
        except UnsolvableError:
            elastic = np.full(1, np.nan)
        if not np.isfinite(elastic).all():
            return Solution(np.empty(0), np.empty(0), np.empty(0), None, (), labels.NOT_PHYSICAL)
        if not elastic.size:
            return self._solution(None, [], labels.ELASTIC_LIMIT)
        most = self.tolerance.max_iterations
        bold = max(1, int(BOLD_SHARE * most))
        history: list[Change] = []
        found = None
        if self._one_solution:
            start = self._yielding(elastic)
            found = self._settle(start, bold, BOLD, history)
            if found is None and most > bold:
                found = self._settle(start, most - bold, CAREFUL, history)
        if found is None:
            found = self._follow(history)
        if found is None:
            strong = np.exp(self._of_elements(elastic)[1].max(initial=-np.inf)) > STRONG
            return self._solution(None, history, labels.TOO_STRONG if strong else labels.NOT_CONVERGED)
        return self._solution(found[1], history, labels.CONVERGED)

    def _settle(
        self, start: Array, rounds: int, pace: Pace, history: list[Change], level: float = 0.0
    ) -> tuple[Array, Round] | None:
        """The iteration until covariance and coefficients converge; None if they do not."""
        latent, step, norm, delta, last = start, np.zeros_like(start), np.inf, np.array(pace.first), None
        for _ in range(rounds):
            try:
                here = self._round(latent + step, level)
            except UnsolvableError:  # nothing stationary: take back most of the step
                delta = next_delta(delta, np.array(norm), np.array(np.inf), pace)
                step = 0.25 * step if last else step - self._flat([0.0, 1.0, 0.0], 0.0)
                continue
            change = self._change(last, here)
            history.append(change)
            latent, last, before = latent + step, here, norm
            norm = float(np.sqrt((here.mismatch**2).sum() / self._count))
            rounding = norm <= self.tolerance.rtol or before < norm < LARGEST_MISMATCH
            if rounding and max(change) <= self.tolerance.rtol:
                return latent, here
            delta = next_delta(delta, np.array(before), np.array(norm), pace)
            damped = np.eye(latent.size) / delta - here.slopes
            try:
                step = np.linalg.solve(damped, here.mismatch)
            except np.linalg.LinAlgError:
                return None
            step = step / max(1.0, np.abs(step).max() / LARGEST_STEP)
        return None

    def _round(self, unknowns: Array, level: float) -> Round:
        """Moments assumed, coefficients, linear system, covariance, moments that come out."""
        latent, rates = self._of_elements(unknowns), unknowns[3 * self._strength.size :]
        values, dashpots = self._closure_of(latent), self._dashpots(rates)
        motion = self._motion(values.coefficients, dashpots)
        _, *moments = motion.moments
        scale = self._strength**2
        reached, by_moments = to_unknowns(np.stack(moments) / scale)
        reached[:2] += level
        assumed, by_assumed = to_unknowns(values.covariance)
        by_latent = np.stack([np.exp(latent[0]), np.exp(latent[1]), 1 - np.tanh(latent[2]) ** 2])
        m, n = scale.size, 3 * scale.size
        all_slopes = motion.slopes(self._beside, self.equations.system.all("mass"))
        slopes = np.einsum(
            "iam,amcn,cln,ln->imln",
            by_moments,
            all_slopes[:n, : 2 * m].reshape(3, m, 2, m) / scale[:, None, None],
            values.coefficients_jacobian,
            by_latent,
        )
        each = np.arange(m)
        own = np.einsum("iam,alm,lm->mil", by_assumed, values.covariance_jacobian, by_latent)
        slopes[:, each, :, each] -= own
        mismatch, slopes = (reached - assumed).ravel(), slopes.reshape(n, n)
        if rates.size:
            variance = motion.std(self.equations.extensions[self._beside], rates=True) ** 2
            mismatch = np.append(mismatch, 0.5 * np.log(variance) + level - rates)
            whole = np.zeros((mismatch.size, mismatch.size))
            whole[:n, :n] = slopes
            by_rates = dashpots[self._power] * (self.equations.exponents[self._power] - 1)
            of_moments = all_slopes[:n, 2 * m :].reshape(3, m, rates.size) / scale[:, None]
            whole[:n, n:] = (
                np.einsum("iam,aml->iml", by_moments, of_moments).reshape(n, rates.size) * by_rates
            )
            of_rates = 0.5 / variance[:, None] * all_slopes[n:]
            by_elements = of_rates[:, : 2 * m].reshape(rates.size, 2, m)
            chain = np.einsum("kcm,clm,lm->klm", by_elements, values.coefficients_jacobian, by_latent)
            whole[n:, :n] = chain.reshape(rates.size, n)
            whole[n:, n:] = of_rates[:, 2 * m :] * by_rates - np.eye(rates.size)
            slopes = whole
        if not (np.isfinite(mismatch).all() and np.isfinite(slopes).all()):
            raise UnsolvableError("the moments are not those of a motion")
        return Round(values, dashpots, motion, mismatch, slopes)

    def _of_elements(self, unknowns: Array) -> Array:
        """Those of the elements that yield (3, m)."""
        return unknowns[: 3 * self._strength.size].reshape(3, -1)

    def _flat(self, of_elements: Sequence[float], of_rates: float) -> Array:
        """A vector like that of the unknowns with these in place of each kind of them."""
        return np.append(
            np.repeat(of_elements, self._strength.size), np.full(self._power.size, of_rates)
        )

    def _dashpots(self, rates: Array) -> Array:
        """Of all links (t,), with an exponent linearized for these ``log sigma`` of their rates."""
        equations, power = self.equations, self._power
        dashpots = np.where(self._idle, 0.0, equations.dashpots)
        exponents = equations.exponents[power]
        dashpots[power] = equivalent_dashpot(dashpots[power], exponents, np.exp(rates))
        return dashpots

    def _closure_of(self, latent: Array) -> ClosureValue:
        """Eqs. (9) and (10) for each element."""
        moments = np.stack([np.exp(latent[0]), np.exp(latent[1]), np.tanh(latent[2])])
        m = latent.shape[1]
        whole = ClosureValue(*(np.empty((*s, m)) for s in ((2,), (2, 3), (3,), (3, 3))))
        for elements, closure, parameters in self._laws:
            for field, part in zip(whole, closure(moments[:, elements], parameters), strict=True):
                field[..., elements] = part
        return whole

    def _motion(self, coefficients: Array, dashpots: Array) -> Solved:
        """Of the linear system with ``1 + c_eq`` and ``k_eq`` of the elements that yield."""
        c_eq, k_eq = -np.ones(self.own.size), np.zeros(self.own.size)
        c_eq[self.own], k_eq[self.own] = coefficients[0] - 1, coefficients[1]
        return Solved(self.equations.augmented(c_eq, k_eq, self.own, dashpots))

    def _change(self, last: Round | None, here: Round) -> Change:
        if last is None:
            return Change(np.nan, np.nan)
        x = here.motion.covariance
        std = np.sqrt(np.diag(x))
        std[std == 0] = 1.0
        moved = np.abs(x - last.motion.covariance) / np.outer(std, std)
        c, k = np.abs(here.values.coefficients - last.values.coefficients)
        relative = k / (np.abs(here.values.coefficients[1]) + self._frequency)
        dashpots = here.dashpots[self._power] / last.dashpots[self._power] - 1
        changes = (part.max(initial=0.0) for part in (c, relative, np.abs(dashpots)))
        return Change(float(moved.max()), float(max(changes)))

    def _follow(self, history: list[Change]) -> tuple[Array, Round] | None:
        """From shaking so weak that hardly anything yields up to the full, level by level."""
        elastic = self._elastic
        slope = self._flat([1.0, 1.0, 0.0], 1.0)
        most = self._of_elements(elastic)[1].max(initial=-np.inf)
        level = min(0.0, np.log(WEAK) - most) - FIRST_RISE
        latent, rise, near = elastic + slope * level, FIRST_RISE, np.inf
        for _ in range(self.tolerance.max_iterations):
            at = min(0.0, level + rise)
            guess = latent + slope * (at - level)
            found = self._settle(guess, AT_LEVEL, BOLD, history, at)
            if found is None or np.abs(found[0] - guess).max() > near:
                rise *= SHORTER
                if rise < LEAST_RISE:
                    return None
                continue
            if at == 0:
                return found
            if np.isfinite(near):
                slope = (found[0] - latent) / (at - level)
            latent, level, near, rise = found[0], at, NEAR, rise * LONGER
        return None

    @cached_property
    def own(self) -> Array:
        """Which elements yield (e,)."""
        return np.isfinite(self.equations.strength)

    @cached_property
    def _strength(self) -> Array:
        return self.equations.strength[self.own]

    @cached_property
    def _frequency(self) -> Array:
        """Of the elements that yield (m,), with the masses at their ends [rad/s]."""
        equations = self.equations
        springs = equations.elements[self.own]
        masses = equations.extensions[springs] ** 2 @ (1 / equations.system.all("mass"))
        return np.sqrt(equations.stiffness[springs] * masses)

    @cached_property
    def _power(self) -> Array:
        """Numbers of the links whose dashpots have an exponent and move (l,)."""
        return np.flatnonzero(self._with_exponent & ~self._idle)

    @property
    def _beside(self) -> Array:
        """The springs beside these dashpots (l,)."""
        return len(self.equations.system.floors) + self._power

    @cached_property
    def _idle(self) -> Array:
        """Which links have a dashpot with an exponent whose ends move as one (t,)."""
        system, power = self.equations.system, self._with_exponent
        if not power.any():
            return power
        ends = np.abs(self.equations.extensions[len(system.floors) :])
        floors = self._undamped.std(np.eye(len(system.floors)), rates=True)
        return power & (self._undamped_rates < IDLE * (ends @ floors))

    @cached_property
    def _with_exponent(self) -> Array:
        """Which links have a dashpot with an exponent (t,)."""
        return np.array([tie.link.is_power_law for tie in self.equations.system.ties], bool)

    @cached_property
    def _undamped(self) -> Solved:
        """The elastic motion without dashpots that have an exponent."""
        none = np.where(self._with_exponent, 0.0, self.equations.dashpots)
        return self._motion(np.zeros((2, self._strength.size)), none)

    @property
    def _undamped_rates(self) -> Array:
        """Standard deviations of the rates of all links in that (t,)."""
        links = self.equations.extensions[len(self.equations.system.floors) :]
        return self._undamped.std(links, rates=True)

    @cached_property
    def _count(self) -> int:
        """Of elements and dashpots that the loop is about."""
        return self._strength.size + self._power.size

    @cached_property
    def _elastic(self) -> Array:
        """The unknowns if no element yielded, and dashpots moved as if there were none."""
        rates = np.log(self._undamped_rates[self._power])
        moments = self._motion(np.zeros((2, self._strength.size)), self._dashpots(rates)).moments
        log_uy = np.log(self._strength)
        sv, sz = (0.5 * np.log(v) - log_uy for v in (moments.velocity, moments.drift))
        return np.concatenate([sv, sz, np.full_like(sv, 0.1), rates])

    def _yielding(self, elastic: Array) -> Array:
        """As a start: ``z`` does not go far beyond 1."""
        sv, sz, r = self._of_elements(elastic)
        return np.concatenate([sv, np.minimum(sz, 0.0), r, elastic[3 * sv.size :]])

    @cached_property
    def _laws(self) -> Sequence[tuple[Array, Closure, Array]]:
        """Elements that yield, by their number among these, with their closure and parameters (k, m)."""
        found, begin = [], 0
        for stack in self.equations.system.stacks:
            yields = np.isfinite(stack.strength)
            mine = begin + np.arange(yields.sum())
            if mine.size:
                found.append((mine, stack.law.closure(self.closure), stack.law_parameters[yields].T))
            begin += mine.size
        links = np.arange(begin, self._strength.size)
        if links.size:
            bilinear = Bilinear.closures[self.closure]
            assert bilinear is not None
            found.append((links, bilinear, np.empty((0, links.size))))
        return found

    @cached_property
    def _one_solution(self) -> bool:
        stacks = self.equations.system.stacks
        return all(bool(s.law.has_one_solution().all()) for s in stacks if np.isfinite(s.strength).any())

    def _solution(self, last: Round | None, history: list[Change], status: int) -> Solution:
        c_eq, k_eq = -np.ones(self.own.size), np.zeros(self.own.size)
        motion = self._undamped if last is None else last.motion
        dashpots = np.where(self._idle, np.nan, self.equations.dashpots)
        if last is not None:
            dashpots = np.where(self._idle, np.nan, last.dashpots)
            slip, relaxation = last.values.coefficients
            still = (np.abs(slip) < ELASTIC) & (np.abs(relaxation) < ELASTIC * self._frequency)
            c_eq[self.own], k_eq[self.own] = (
                np.where(still, -1, slip - 1),
                np.where(still, 0, relaxation),
            )
            status = labels.ELASTIC_LIMIT if still.all() else status
        return Solution(c_eq, k_eq, dashpots, motion, tuple(history), status)
