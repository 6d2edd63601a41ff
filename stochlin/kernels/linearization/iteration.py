"""The iteration of statistical linearization, for single structures and for systems of springs.

The unknowns are the moments ``(sigma_v, sigma_z, corr(v, z))`` of the Gaussian density that a closure
assumes for each spring that yields, in the variables ``(log, log, atanh)``, in which every iterate is a
valid density for any hysteresis law. The mismatch ``F`` is the difference of two sets of moments: those
of the stationary response of the linear system with the closure's coefficients, less those that the
closure assumes. The fixed point is the stationary solution of ``y' = F(y)``. It is approached by
pseudo-transient continuation (Kelley and Keyes 1998, SIAM J. Numer. Anal. 35), with steps from
``(1/delta - dF/dy) step = F``, which become those of Newton's method as the pseudo-time step ``delta``
grows. A `StepControl` says how ``delta`` begins, grows while ``F`` falls, and shrinks where it does not.

`solve` decides from where and by which steps to iterate: it tries large ones, then small ones, and then
follows the solution from weak to full shaking. It leaves each iteration to the `Problem`. A system of
springs iterates by `iterate` here, which makes the steps of all cells together by `Stepping.advance`,
each with a Lyapunov equation (`systems.springs`) or, for single structures, with closed forms of the
moments (`single_structures`).
"""

from __future__ import annotations

from typing import Any, NamedTuple, Protocol, Self

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.elementary import choose


class StepControl(NamedTuple):
    """Control of the pseudo-time step: its first value and how it changes, see `next_delta`."""

    first: float  # first pseudo-time step
    restart: float  # upper bound after a rise of the mismatch
    shorter: float  # factor after a rise of the mismatch
    longer: float  # factor after a fall, besides the ratio of the mismatches
    longest: float  # largest factor after a fall


# Nearly Newton's method, and short pseudo-time steps.
BOLD = StepControl(first=30.0, restart=1.0, shorter=0.25, longer=3.0, longest=100.0)
CAREFUL = StepControl(first=0.5, restart=0.5, shorter=0.5, longer=1.1, longest=1.5)
# Share of max_iterations for nearly Newton's method: 30 of 200, while the bilinear law needs 13.
BOLD_SHARE = 0.15
WEAK = 0.3  # standard deviation of the elastic ductility at which hardly any structure yields
FIRST_RISE, LONGER, SHORTER, LEAST_RISE = 0.5, 2.0, 0.5, 1e-4  # rise of the logarithm of the shaking
AT_LEVEL = 12  # iterations at one level of shaking
LARGEST_STEP = 1.0  # largest step in log(sigma) and atanh(corr)
LEAST_DELTA = 0.05  # smallest pseudo-time step
LARGEST_MISMATCH = 1e-6  # largest norm of the mismatch of a converged cell
NEAR = 0.05  # largest distance of a solution from its extrapolation for the same branch of solutions


class State(NamedTuple):
    """State of the iteration of n cells with u unknowns."""

    base: Array  # (u, n) the last iterate that has a stationary response
    norm: Array  # (n,) norm of its mismatch F
    step: Array  # (u, n) the next iterate less base
    delta: Array  # (n,) pseudo-time step, from which this step was found
    done: Array  # (n,) 1 where it has converged

    @classmethod
    def begin(cls, unknowns: Array, pace: StepControl) -> State:
        """Before the first evaluation; the first iterate is ``unknowns`` (u, n) itself."""
        n = unknowns.shape[1]
        first = np.full(n, np.inf), np.zeros_like(unknowns), np.full(n, pace.first), np.zeros(n)
        return cls(unknowns.copy(), *first)

    @property
    def unknowns(self) -> Array:
        """The next iterate (u, n), at which `Stepping.advance` evaluates the mismatch."""
        moved: Array = self.base + self.step
        return moved

    @property
    def ended(self) -> Array:
        """The cells (n,) that have converged, or whose next step is not a number."""
        ended: Array = (self.done > 0) | ~np.isfinite(self.step).all(axis=0)
        return ended

    def at(self, cells: Array) -> State:
        """The state of the cells with these numbers."""
        return State(*(part.take(cells, axis=-1) for part in self))

    def put(self, cells: Array, state: State) -> None:
        """Replace the state of the cells with these numbers."""
        for whole, part in zip(self, state, strict=True):
            whole[..., cells] = part


class FixedPoint(NamedTuple):
    """The last iterate of each cell; NaN in cells that were not tried."""

    unknowns: Array  # (u, n)
    coefficients: Array  # (k, n): of single structures 1 + c_e and k_e
    iterations: Array  # (n,)
    residual: Array  # (n,): norm of the mismatch
    converged: Array  # (n,)


class Problem(Protocol):
    """Cells whose equivalent coefficients are sought, as `solve` needs them.

    The unknowns are ``log sigma_v`` of the m springs, their ``log sigma_z``, their ``atanh corr``, and
    ``log sigma`` of the rates of dashpots.
    """

    @property
    def springs(self) -> int:
        """Number m of the springs that yield in a cell."""
        raise NotImplementedError

    @property
    def size(self) -> int:
        """Number k of the equivalent coefficients of a cell."""
        raise NotImplementedError

    def at(self, cells: Array) -> Self:
        """The cells with these numbers."""
        raise NotImplementedError

    def shaken(self, level: Array) -> Self:
        """The cells under other shaking, with this logarithm (n,) of the ratio to the full one."""
        raise NotImplementedError

    def settle(self, unknowns: Array, most: int, pace: StepControl) -> FixedPoint:
        """The fixed points from these unknowns (u, n) in at most so many steps, as by `iterate`."""
        raise NotImplementedError


class Stepping(Protocol):
    """Cells whose iteration is made step by step, as `iterate` needs them."""

    def at(self, cells: Array) -> Self:
        """The cells with these numbers."""
        raise NotImplementedError

    def advance(self, state: State, pace: StepControl) -> State:
        """The state after one evaluation of the mismatch at ``state.unknowns``."""
        raise NotImplementedError

    def coefficients(self, unknowns: Array) -> Array:
        """Equivalent coefficients (k, n) for these unknowns."""
        raise NotImplementedError


def next_delta(delta: Any, before: Any, now: Any, pace: StepControl) -> Any:
    """Next pseudo-time step, by switched evolution relaxation: longer if the mismatch has fallen."""
    ratio = choose(np.isinf(before) | (now == 0), 1.0, before / now)
    shorter = np.maximum(pace.shorter * np.minimum(delta, pace.restart), LEAST_DELTA)
    return choose(ratio < 1, shorter, delta * np.minimum(pace.longer * ratio, pace.longest))


def slope_of_unknowns(moments: Any, slope: Any) -> Any:
    """Derivative of ``(log sv, log sz, atanh r)`` if ``(vv, zz, vz)`` changes by ``slope``.

    ``moments`` are ``vv``, ``zz``, the square root of their product, and ``r``.
    """
    vv, zz, root, r = moments
    of_v, of_z = 0.5 * slope[0] / vv, 0.5 * slope[1] / zz
    return of_v, of_z, (slope[2] / root - r * (of_v + of_z)) / (1 - r * r)


def iterate(problem: Stepping, unknowns: Array, most: int, pace: StepControl) -> FixedPoint:
    """Take at most so many steps from these unknowns, each cell until it converges."""
    whole = State.begin(unknowns, pace)
    state, part, cells = whole, problem, np.arange(unknowns.shape[1])
    iterations = np.zeros(cells.size, np.int32)
    for _ in range(most):
        state = part.advance(state, pace)
        iterations[cells] += 1
        whole.put(cells, state)
        left = np.flatnonzero(~state.ended)
        if not left.size:
            break
        if left.size < cells.size:
            state, part, cells = state.at(left), part.at(left), cells[left]
    reached = whole.unknowns
    return FixedPoint(reached, problem.coefficients(reached), iterations, whole.norm, whole.done > 0)


def solve(problem: Problem, elastic: Array, one_solution: Array, max_iterations: int) -> FixedPoint:
    """Solve all cells, whose elastic response has the unknowns ``elastic`` (u, n).

    Cells for which ``one_solution`` (n,) is true have at most one solution, and the iteration starts
    from the elastic response, with ``sigma_z`` at most 1. For the others, and where this fails, the
    branch of solutions that begins with the elastic response to weak shaking is followed up to full
    shaking. ``max_iterations`` limits the steps of an iteration, or the levels of shaking along a
    branch.
    """
    m, bold = problem.springs, max(1, int(BOLD_SHARE * max_iterations))
    yielding, solution = elastic_limit(elastic, m), _nothing(problem, elastic)
    for pace, most in ((BOLD, bold), (CAREFUL, max_iterations - bold), (None, max_iterations - bold)):
        allowed = one_solution if pace else True
        cells = np.flatnonzero(~solution.converged & allowed)
        if cells.size and most > 0:
            part = problem.at(cells)
            if pace:
                fixed_point = part.settle(yielding[:, cells], most, pace)
            else:
                fixed_point = _follow(part, elastic[:, cells], most)
            _add(solution, cells, fixed_point)
    return solution


def elastic_limit(elastic: Array, springs: int) -> Array:
    """The unknowns (u, n) of the elastic response, with ``sigma_z`` of the ``springs`` at most 1."""
    limited, z = elastic.copy(), slice(springs, 2 * springs)
    limited[z] = np.minimum(elastic[z], 0.0)
    return limited


def _follow(problem: Problem, elastic: Array, most_levels: int) -> FixedPoint:
    """Follow a branch of solutions from weak to full shaking, level by level.

    A level is the logarithm of the ratio of the shaking to the full one. It begins where hardly any
    spring yields. The solution at the next level is extrapolated linearly from the last two. A solution
    that is farther than `NEAR` from its extrapolation belongs to another branch, and the step is
    repeated with a lower level.
    """
    m, n = problem.springs, elastic.shape[1]
    slope = np.ones_like(elastic)  # of the unknowns by the level, first that of the elastic response
    slope[2 * m : 3 * m] = 0.0  # which keeps its correlations
    strongest = elastic[m : 2 * m].max(axis=0, initial=-np.inf)
    level = np.minimum(0.0, np.log(WEAK) - strongest) - FIRST_RISE
    y, rise = elastic + slope * level, np.full(n, FIRST_RISE)
    near = np.full(n, np.inf)  # the first solution may be anywhere
    solution, cells = _nothing(problem, elastic), np.arange(n)
    for _ in range(most_levels):
        at = np.minimum(0.0, level[cells] + rise[cells])
        guess = y[:, cells] + slope[:, cells] * (at - level[cells])
        fixed_point = problem.at(cells).shaken(at).settle(guess, AT_LEVEL, BOLD)
        reached = fixed_point.unknowns
        good = fixed_point.converged & (np.abs(reached - guess).max(axis=0) <= near[cells])
        _add(solution, cells, fixed_point._replace(converged=good & (at == 0)))
        on, known = cells[good], np.isfinite(near[cells[good]])
        found_slope = (reached[:, good] - y[:, on]) / (at[good] - level[on])
        slope[:, on] = np.where(known, found_slope, slope[:, on])
        y[:, on], level[on], near[on] = reached[:, good], at[good], NEAR
        rise[cells] *= np.where(good, LONGER, SHORTER)
        cells = np.flatnonzero(~solution.converged & (rise > LEAST_RISE))
        if not cells.size:
            break
    return solution


def _nothing(problem: Problem, unknowns: Array) -> FixedPoint:
    """The result for cells that are not yet solved."""
    n = unknowns.shape[1]
    coefficients, none = np.full((problem.size, n), np.nan), np.full(n, np.nan)
    return FixedPoint(0 * unknowns + np.nan, coefficients, np.zeros(n, np.int32), none, none > 0)


def _add(solution: FixedPoint, cells: Array, fixed_point: FixedPoint) -> None:
    """Write the results of some cells into those of all, and add their iterations."""
    spent = fixed_point.iterations + solution.iterations[cells]
    for field, value in zip(solution, fixed_point._replace(iterations=spent), strict=True):
        field[..., cells] = value
