"""The loop of statistical linearization, for any number of elements at once.

Coefficients make a linear system; its covariance says how the elements move; a closure makes new
coefficients of that. Put straight back they may cycle for ever. So the moments that the closure assumes,
``(log sigma_v, log sigma_z, atanh r)`` of each element, are corrected as in
`stochlin.kernels.linearization.fixed_point`, by the slopes of what comes out of them: each round takes
the loop once, and the last ones are Newton's method.
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
from stochlin.kernels.linearization.fixed_point import (
    AT_LEVEL,
    BOLD,
    BOLD_SHARE,
    CAREFUL,
    FIRST_RISE,
    LARGEST_MISMATCH,
    LARGEST_STEP,
    LEAST_RISE,
    LONGER,
    NEAR,
    SHORTER,
    WEAK,
    Closure,
    ClosureValue,
    Pace,
    next_delta,
    to_unknowns,
)
from stochlin.kernels.linearization.lyapunov import UnsolvableError
from stochlin.models.laws.bilinear import Bilinear


class Round(NamedTuple):
    """Once through the loop."""

    values: ClosureValue  # what the closure makes of the moments assumed
    motion: Solved  # of the linear system with these coefficients
    mismatch: Array  # (3, m): log sigma_v, log sigma_z, atanh r that come out, less those assumed
    slopes: Array  # of that by those assumed (3, m, 3, m)


class Change(NamedTuple):
    """From one round to the next."""

    covariance: float  # largest, over the product of the standard deviations
    coefficients: float  # largest of c_eq, and of k_eq over its sum with the frequency of the element


class Solution(NamedTuple):
    """Where the loop ended."""

    c_eq: Array  # of the elements (e,)
    k_eq: Array
    motion: Solved | None  # None if nothing can be computed
    history: tuple[Change, ...]
    status: int


@dataclass(frozen=True)
class Loop:
    """Structures on one ground, their strengths in metres, and how their laws are linearized."""

    equations: Equations
    closure: str
    tolerance: Tolerance

    @np.errstate(all="ignore")  # what is no number is judged where it counts
    def solve(self) -> Solution:
        """Boldly; with care; then, or where there may be several solutions, from weak shaking on."""
        try:
            elastic = self._elastic
        except UnsolvableError:
            elastic = np.full((3, 1), np.nan)
        if not np.isfinite(elastic).all():
            return Solution(np.empty(0), np.empty(0), None, (), labels.NOT_PHYSICAL)
        if not self.own.any():
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
            strong = np.exp(elastic[1].max()) > STRONG
            return self._solution(None, history, labels.TOO_STRONG if strong else labels.NOT_CONVERGED)
        return self._solution(found[1], history, labels.CONVERGED)

    def _settle(
        self, start: Array, rounds: int, pace: Pace, history: list[Change], level: float = 0.0
    ) -> tuple[Array, Round] | None:
        """THE LOOP, until covariance and coefficients stand still; None if they do not."""
        latent, step, norm, delta, last = start, np.zeros_like(start), np.inf, np.array(pace.first), None
        for _ in range(rounds):
            try:
                here = self._round(latent + step, level)
            except UnsolvableError:  # nothing stationary: take back most of the step
                delta = next_delta(delta, np.array(norm), np.array(np.inf), pace)
                step = 0.25 * step if last else step - np.array([[0.0], [1.0], [0.0]])
                continue
            change = self._change(last, here)
            history.append(change)
            latent, last, before = latent + step, here, norm
            norm = float(np.sqrt((here.mismatch**2).sum() / here.mismatch.shape[1]))
            rounding = norm <= self.tolerance.rtol or before < norm < LARGEST_MISMATCH
            if rounding and max(change) <= self.tolerance.rtol:
                return latent, here
            delta = next_delta(delta, np.array(before), np.array(norm), pace)
            size = latent.size
            damped = np.eye(size) / delta - here.slopes.reshape(size, size)
            try:
                step = np.linalg.solve(damped, here.mismatch.ravel()).reshape(latent.shape)
            except np.linalg.LinAlgError:
                return None
            step = step / max(1.0, np.abs(step).max() / LARGEST_STEP)
        return None

    def _round(self, latent: Array, level: float) -> Round:
        """Moments assumed, coefficients, linear system, covariance, moments that come out."""
        values = self._closure_of(latent)
        motion = self._motion(values.coefficients)
        _, *moments = motion.moments
        scale = self._strength**2
        reached, by_moments = to_unknowns(np.stack(moments) / scale)
        reached[:2] += level
        assumed, by_assumed = to_unknowns(values.covariance)
        by_latent = np.stack([np.exp(latent[0]), np.exp(latent[1]), 1 - np.tanh(latent[2]) ** 2])
        slopes = np.einsum(
            "iam,amcn,cln,ln->imln",
            by_moments,
            motion.slopes() / scale[:, None, None],
            values.coefficients_jacobian,
            by_latent,
        )
        m = np.arange(scale.size)
        own = np.einsum("iam,alm,lm->mil", by_assumed, values.covariance_jacobian, by_latent)
        slopes[:, m, :, m] -= own
        mismatch = reached - assumed
        if not (np.isfinite(mismatch).all() and np.isfinite(slopes).all()):
            raise UnsolvableError("the moments are not those of a motion")
        return Round(values, motion, mismatch, slopes)

    def _closure_of(self, latent: Array) -> ClosureValue:
        """Eqs. (9) and (10) for each element."""
        moments = np.stack([np.exp(latent[0]), np.exp(latent[1]), np.tanh(latent[2])])
        m = latent.shape[1]
        whole = ClosureValue(*(np.empty((*s, m)) for s in ((2,), (2, 3), (3,), (3, 3))))
        for elements, closure, parameters in self._laws:
            for field, part in zip(whole, closure(moments[:, elements], parameters), strict=True):
                field[..., elements] = part
        return whole

    def _motion(self, coefficients: Array) -> Solved:
        """Of the linear system with ``1 + c_eq`` and ``k_eq`` of the elements that yield."""
        c_eq, k_eq = -np.ones(self.own.size), np.zeros(self.own.size)
        c_eq[self.own], k_eq[self.own] = coefficients[0] - 1, coefficients[1]
        return Solved(self.equations.augmented(c_eq, k_eq, self.own))

    def _change(self, last: Round | None, here: Round) -> Change:
        if last is None:
            return Change(np.nan, np.nan)
        x = here.motion.covariance
        std = np.sqrt(np.diag(x))
        std[std == 0] = 1.0
        moved = np.abs(x - last.motion.covariance) / np.outer(std, std)
        c, k = np.abs(here.values.coefficients - last.values.coefficients)
        relative = k / (np.abs(here.values.coefficients[1]) + self._frequency)
        return Change(float(moved.max()), float(max(c.max(), relative.max())))

    def _follow(self, history: list[Change]) -> tuple[Array, Round] | None:
        """From shaking so weak that hardly anything yields up to the full, level by level."""
        elastic = self._elastic
        slope = np.ones_like(elastic) * np.array([[1.0], [1.0], [0.0]])
        level = min(0.0, np.log(WEAK) - elastic[1].max()) - FIRST_RISE
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
    def _elastic(self) -> Array:
        """``(log sigma_v, log sigma_z, atanh r)`` of the elements that yield, if they did not (3, m)."""
        moments = self._motion(np.zeros((2, self._strength.size))).moments
        log_uy = np.log(self._strength)
        sv, sz = (0.5 * np.log(v) - log_uy for v in (moments.velocity, moments.drift))
        return np.stack([sv, sz, np.full_like(sv, 0.1)])

    @staticmethod
    def _yielding(elastic: Array) -> Array:
        """As a start: ``z`` does not go far beyond 1."""
        return np.stack([elastic[0], np.minimum(elastic[1], 0.0), elastic[2]])

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
        motion = self._motion(np.zeros((2, self._strength.size))) if last is None else last.motion
        if last is not None:
            slip, relaxation = last.values.coefficients
            still = (np.abs(slip) < ELASTIC) & (np.abs(relaxation) < ELASTIC * self._frequency)
            c_eq[self.own], k_eq[self.own] = (
                np.where(still, -1, slip - 1),
                np.where(still, 0, relaxation),
            )
            status = labels.ELASTIC_LIMIT if still.all() else status
        return Solution(c_eq, k_eq, motion, tuple(history), status)
