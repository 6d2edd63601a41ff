"""Iteration of statistical linearization for a system of any number of elements and dashpots.

The equivalent coefficients define a linear system. Its covariance gives the moments of the elements, and
the closure gives the coefficients for these moments. Direct substitution may cycle. The unknowns are
therefore the moments that the closure assumes, ``(log sigma_v, log sigma_z, atanh r)`` of each element.
Their mismatch, the moments of the linear system less those assumed, is brought to zero by a damped
Newton's method, as in `stochlin.kernels.linearization.fixed_point`. A dashpot with an exponent is
linearized too, with ``log sigma`` of the rate of its extension as one more unknown (Roberts and Spanos
1990, Random vibration and statistical linearization).
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

IDLE = 1e-6  # ratio of the rate of a link to those of its ends below which it may be a rounding error


class Round(NamedTuple):
    """One iteration, for m yielding elements, t links, and l dashpots with an exponent."""

    values: ClosureValue  # coefficients and covariance by the closure for the assumed moments
    dashpots: Array  # (t,) damping constants of all links, linearized
    motion: Solved  # response of the linear system with these coefficients
    mismatch: Array  # (3 m + l,) unknowns from the response, less those assumed
    slopes: Array  # derivatives of the mismatch with respect to the unknowns


class Change(NamedTuple):
    """Changes from one iteration to the next."""

    covariance: float  # largest change of a covariance over the product of the standard deviations
    coefficients: float  # largest change of c_eq, and of k_eq over k_eq plus the frequency


class Solution(NamedTuple):
    """Result of the iteration."""

    c_eq: Array  # (e,), of the elements
    k_eq: Array  # (e,) [1/s]
    dashpots: Array  # (t,) damping constants of the links, NaN for idle ones with an exponent
    motion: Solved | None  # None if the elastic response cannot be computed
    history: tuple[Change, ...]
    status: int


@dataclass(frozen=True)
class Loop:
    """Iteration for structures on one ground, with strengths in metres.

    The unknowns are ``log sigma_v``, ``log sigma_z`` and ``atanh r`` of the ``m`` elements that yield,
    and ``log sigma`` of the rates of extension of the ``l`` dashpots with an exponent.
    """

    equations: Equations
    closure: str
    tolerance: Tolerance

    @np.errstate(all="ignore")  # NaN is checked where it matters
    def solve(self) -> Solution:
        """Result by large steps, else by small steps, else by raising the intensity step by step.

        Where a law may have several solutions, only the last method is used.
        """
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
            except UnsolvableError:  # there is no stationary response: take back most of the step
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
        """One iteration: coefficients for the unknowns, the response, the mismatch and its slopes."""
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
        """Unknowns (3, m) of the elements that yield."""
        return unknowns[: 3 * self._strength.size].reshape(3, -1)

    def _flat(self, of_elements: Sequence[float], of_rates: float) -> Array:
        """A vector in the order of the unknowns, with one value for each kind of unknown."""
        return np.append(
            np.repeat(of_elements, self._strength.size), np.full(self._power.size, of_rates)
        )

    def _dashpots(self, rates: Array) -> Array:
        """Damping constants (t,) of all links; ``rates`` are ``log sigma`` of the rates (l,)."""
        equations, power = self.equations, self._power
        dashpots = np.where(self._idle, 0.0, equations.dashpots)
        exponents = equations.exponents[power]
        dashpots[power] = equivalent_dashpot(dashpots[power], exponents, np.exp(rates))
        return dashpots

    def _closure_of(self, latent: Array) -> ClosureValue:
        """Coefficients and covariance by the closure, eqs. (9) and (10), for each element."""
        moments = np.stack([np.exp(latent[0]), np.exp(latent[1]), np.tanh(latent[2])])
        m = latent.shape[1]
        whole = ClosureValue(*(np.empty((*s, m)) for s in ((2,), (2, 3), (3,), (3, 3))))
        for elements, closure, parameters in self._laws:
            for field, part in zip(whole, closure(moments[:, elements], parameters), strict=True):
                field[..., elements] = part
        return whole

    def _motion(self, coefficients: Array, dashpots: Array) -> Solved:
        """Response for coefficients ``(1 + c_eq, k_eq)``, (2, m), of the elements that yield."""
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
        """Follow the solution while the intensity rises from one for which hardly anything yields."""
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
        """Whether each element (e,) yields."""
        return np.isfinite(self.equations.strength)

    @cached_property
    def _strength(self) -> Array:
        return self.equations.strength[self.own]

    @cached_property
    def _frequency(self) -> Array:
        """Frequencies (m,) [rad/s] of the elements that yield, with the masses at their ends."""
        equations = self.equations
        springs = equations.elements[self.own]
        masses = equations.extensions[springs] ** 2 @ (1 / equations.system.all("mass"))
        return np.sqrt(equations.stiffness[springs] * masses)

    @cached_property
    def _power(self) -> Array:
        """Numbers (l,) of the links with a moving dashpot with an exponent."""
        return np.flatnonzero(self._with_exponent & ~self._idle)

    @property
    def _beside(self) -> Array:
        """Numbers (l,) of the springs of these links."""
        return len(self.equations.system.floors) + self._power

    @cached_property
    def _idle(self) -> Array:
        """Whether each link (t,) has a dashpot with an exponent whose ends move together."""
        system, power = self.equations.system, self._with_exponent
        if not power.any():
            return power
        ends = np.abs(self.equations.extensions[len(system.floors) :])
        floors = self._undamped.std(np.eye(len(system.floors)), rates=True)
        return power & (self._undamped_rates < IDLE * (ends @ floors))

    @cached_property
    def _with_exponent(self) -> Array:
        """Whether each link (t,) has a dashpot with an exponent."""
        return np.array([tie.link.is_power_law for tie in self.equations.system.ties], bool)

    @cached_property
    def _undamped(self) -> Solved:
        """Elastic response without the dashpots with an exponent."""
        none = np.where(self._with_exponent, 0.0, self.equations.dashpots)
        return self._motion(np.zeros((2, self._strength.size)), none)

    @property
    def _undamped_rates(self) -> Array:
        """Standard deviations (t,) of the rates of extension of all links in this response."""
        links = self.equations.extensions[len(self.equations.system.floors) :]
        return self._undamped.std(links, rates=True)

    @cached_property
    def _count(self) -> int:
        """Number of elements and dashpots that are linearized."""
        return self._strength.size + self._power.size

    @cached_property
    def _elastic(self) -> Array:
        """Unknowns of the elastic response, with dashpots linearized for the rates without them."""
        rates = np.log(self._undamped_rates[self._power])
        moments = self._motion(np.zeros((2, self._strength.size)), self._dashpots(rates)).moments
        log_uy = np.log(self._strength)
        sv, sz = (0.5 * np.log(v) - log_uy for v in (moments.velocity, moments.drift))
        return np.concatenate([sv, sz, np.full_like(sv, 0.1), rates])

    def _yielding(self, elastic: Array) -> Array:
        """Unknowns to start from: those of the elastic response, with ``sigma_z`` at most 1."""
        sv, sz, r = self._of_elements(elastic)
        return np.concatenate([sv, np.minimum(sz, 0.0), r, elastic[3 * sv.size :]])

    @cached_property
    def _laws(self) -> Sequence[tuple[Array, Closure, Array]]:
        """Closures of the laws, each with the numbers of its yielding elements and their parameters."""
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
