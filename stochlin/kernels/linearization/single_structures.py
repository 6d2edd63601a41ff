"""Newton's method for single structures, whose stationary covariances have closed forms.

The fixed point of linearization is the stationary solution of ``y' = F(y)``, with the unknowns and the
mismatch ``F`` of `iteration`. It is approached by pseudo-transient continuation (Kelley and Keyes 1998,
SIAM J. Numer. Anal. 35), with steps from ``(1/delta - dF/dy) step = F``, which become those of Newton's
method as the pseudo-time step ``delta`` grows. A `StepControl` says how ``delta`` begins, grows while
``F`` falls, and shrinks where it does not. The functions of one step take numbers or arrays of cells.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.elementary import choose, solve_3x3
from stochlin.kernels.basics.slabs import in_ranges
from stochlin.kernels.linearization.covariance import (
    EquivalentSystem,
    Forcing,
    hurwitz,
    own_covariance,
    stable,
)
from stochlin.kernels.linearization.filters import Filter
from stochlin.kernels.linearization.gaussian import Closure
from stochlin.kernels.linearization.iteration import FixedPoint, add, elastic_limit, follow, nothing


class StepControl(NamedTuple):
    """Control of the pseudo-time step: its first value and how it changes."""

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
AT_LEVEL = 12  # iterations at one level of shaking
LARGEST_STEP = 1.0  # largest step in log(sigma) and atanh(corr)
LEAST_DELTA = 0.05  # smallest pseudo-time step
LARGEST_MISMATCH = 1e-6  # largest norm of the mismatch of a converged cell
CHUNK = 4096  # cells solved together: the temporary arrays of a step then stay in the cache


class State(NamedTuple):
    """State of the iteration of n cells, with u = 3 unknowns."""

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
        """The next iterate (u, n), at which `SingleStructures.advance` evaluates the mismatch."""
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


class SingleStructures(NamedTuple):
    """Single structures on their grounds."""

    structure: Array  # (3, n) stiffness, damping and coupling of the equivalent system
    law: Array  # (m, n) parameters of the law, for the closure
    ground: Filter
    level: Array  # (n,): logarithm of the ratio of the shaking to the full one, as standard deviations
    closure: Closure
    rtol: float
    atol: float

    def at(self, cells: Array | slice) -> SingleStructures:
        """The cells with these numbers."""
        if self.level[cells].size == self.level.size:  # the selection is all cells
            return self
        structure, law = (rows[:, cells] for rows in self[:2])
        return self._replace(
            structure=structure, law=law, ground=self.ground.at(cells), level=self.level[cells]
        )

    def settle(self, unknowns: Array, most: int, pace: StepControl) -> FixedPoint:
        """The fixed points from these unknowns (3, n) in at most so many steps."""

        def part(cells: slice) -> FixedPoint:
            return iterate(self.at(cells), unknowns[:, cells], most, pace)

        parts = in_ranges(part, unknowns.shape[1], CHUNK)
        return FixedPoint(*map(np.hstack, zip(*parts, strict=True)))

    def advance(self, state: State, pace: StepControl) -> State:
        """One step of all cells."""
        latent = moments_of(state.unknowns)
        value = self.closure(latent, self.law)
        forcings = self.ground.forcing_and_slopes(EquivalentSystem(*self.structure, *value.coefficients))
        cell, limits = (*self.structure, self.level), (self.rtol, self.atol)
        return State(*map(np.array, advance(cell, latent, value, forcings, state, pace, *limits)))

    def coefficients(self, unknowns: Array) -> Array:
        """``1 + c_e`` and ``k_e`` (2, n)."""
        return self.closure(moments_of(unknowns), self.law).coefficients


@np.errstate(all="ignore")  # an iterate may belong to an unstable system, without moments
def solve_structures(
    problem: SingleStructures, start: Array, one_solution: Array, max_iterations: int
) -> FixedPoint:
    """The fixed points of all cells, from the moments ``sv, sz, r`` (3, n) of the elastic response.

    Cells for which ``one_solution`` (n,) is true have at most one solution, and the iteration starts
    from the elastic response, with ``sz`` at most 1, in large steps and then in small ones. For the
    others, and where this fails, the branch of solutions that begins with the elastic response to weak
    shaking is followed up to full shaking. ``max_iterations`` limits the steps of an iteration, or the
    levels of shaking along a branch.

    A cell has converged when ``|dy| <= atol + rtol |y|`` for each of its moments ``y``; ``atol`` applies
    to the correlation only, since the other two are positive scales.
    """
    elastic = np.array([*np.log(start[:2]), np.arctanh(start[2])])
    bold = max(1, int(BOLD_SHARE * max_iterations))
    solution, careful = nothing(elastic), max_iterations - bold
    for pace, most in ((BOLD, bold), (CAREFUL, careful)):
        cells = np.flatnonzero(~solution.converged & one_solution)
        if cells.size and most:
            limited = elastic_limit(elastic[:, cells], 1)
            add(solution, cells, problem.at(cells).settle(limited, most, pace))
    cells = np.flatnonzero(~solution.converged)
    if cells.size and careful:
        part = problem.at(cells)

        def settle(cells: Array, level: Array, guess: Array) -> FixedPoint:
            return part.at(cells)._replace(level=level).settle(guess, AT_LEVEL, BOLD)

        add(solution, cells, follow(settle, elastic[:, cells], 1, careful))
    return solution


def iterate(problem: SingleStructures, unknowns: Array, most: int, pace: StepControl) -> FixedPoint:
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
    return FixedPoint(whole.unknowns, iterations, whole.norm, whole.done > 0)


def moments_of(unknowns: Array) -> Array:
    """The moments ``sv, sz, r`` (3, n) of the unknowns."""
    moments = np.exp(unknowns)
    np.tanh(unknowns[2], out=moments[2])
    return moments


def advance(
    cell: Any,
    moments: Any,
    value: Any,
    forcings: Any,
    state: Any,
    pace: StepControl,
    rtol: float,
    atol: float,
) -> Any:
    """The next `State` of cells after one evaluation of closure and forcing at their unknowns.

    ``cell`` has stiffness, damping, coupling and level of shaking, ``value`` is what the closure found,
    and ``forcings`` are the forcing and its derivatives by slip and by relaxation. If the unknowns have
    no stationary response, a smaller step from the last valid ones is tried.
    """
    base, before, old, last, _ = state
    y = base[0] + old[0], base[1] + old[1], base[2] + old[2]
    off, columns = mismatch(cell, moments, value, forcings)
    norm = np.sqrt(off[0] * off[0] + off[1] * off[1] + off[2] * off[2])
    total = norm
    for column in columns:
        total = total + column[0] + column[1] + column[2]
    valid = np.isfinite(total)
    now = choose(valid, norm, np.inf)
    delta = next_delta(last, before, now, pace)
    new = newton_step(columns, off, 1 / delta)
    # If not stationary: try a quarter of the step; before the first valid iterate, a more elastic start.
    untried = np.isinf(before)
    back = (
        choose(untried, old[0], 0.25 * old[0]),
        choose(untried, old[1] - 1.0, 0.25 * old[1]),
        choose(untried, old[2] - 0.5 * y[2], 0.25 * old[2]),
    )
    # Convergence is judged by the Newton step, since a damped step is also small if delta is small.
    change, r = newton_step(columns, off, 0.0), moments[2]
    of_r = (1 - r * r) * rtol / (atol + rtol * np.abs(r))
    still = (np.abs(change[0]) <= rtol) & (np.abs(change[1]) <= rtol)
    still = still & (np.abs(change[2]) * of_r <= rtol)
    return (
        (choose(valid, y[0], base[0]), choose(valid, y[1], base[1]), choose(valid, y[2], base[2])),
        choose(valid, norm, before),
        (choose(valid, new[0], back[0]), choose(valid, new[1], back[1]), choose(valid, new[2], back[2])),
        delta,
        choose(valid & (norm <= LARGEST_MISMATCH) & still, 1.0, 0.0),
    )


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


def mismatch(cell: Any, moments: Any, value: Any, forcings: Any) -> Any:
    """Mismatch of the unknowns, and the three columns of its Jacobian.

    All is NaN for systems that are not stable. This is checked by the criterion of Routh and Hurwitz,
    since on filtered ground the formulas can also give a valid covariance there.
    """
    stiffness, damping, coupling, level = cell
    coefficients, (of_slip, of_relaxation), (vv, zz, vz), by_latent = value
    system = EquivalentSystem(stiffness, damping, coupling, coefficients[0], coefficients[1])
    forcing, by_slip, by_relaxation = forcings
    own = own_covariance(system, Forcing(forcing[0], forcing[1], forcing[2]))
    well = stable(*system) & (own.mu_mu > 0)
    v_v = choose(well, own.v_v, np.nan)
    response, assumed = _scales(v_v, own.z_z, own.v_z), _scales(vv, zz, vz)
    r, corr = assumed[3], response[3]
    off = (
        0.5 * np.log(v_v / vv) + level,
        0.5 * np.log(own.z_z / zz) + level,
        np.arctanh((corr - r) / (1 - corr * r)),
    )
    slopes = (
        slope_of_unknowns(response, _slope(system, own, forcing, by_slip, 1.0, 0.0)),
        slope_of_unknowns(response, _slope(system, own, forcing, by_relaxation, 0.0, 1.0)),
    )
    scales = moments[0], moments[1], 1 - moments[2] * moments[2]
    closure = of_slip, of_relaxation, by_latent, assumed
    return off, (
        _column(0, closure, slopes, scales), _column(1, closure, slopes, scales),
        _column(2, closure, slopes, scales),
    )  # fmt: skip


def _scales(vv: Any, zz: Any, vz: Any) -> Any:
    """Variances of a covariance, the square root of their product, and the correlation."""
    root = np.sqrt(vv * zz)
    return vv, zz, root, vz / root


def _slope(system: Any, own: Any, forcing: Any, slope: Any, dp: float, dk: float) -> Any:
    """Derivatives of Var v, Var z and Cov(v, z) of `own_covariance` by slip or by relaxation.

    ``slope`` is the derivative of the forcing; ``dp`` is 1 for that by slip, ``dk`` is 1 for relaxation.
    """
    _, d, h, p, k = system
    f_mu, f_v, f_y = slope[0], slope[1], slope[2]
    c = 1 - p
    steeper = dk * (d * (d + 2 * k) + c * h) - dp * h * (d + k)
    mu_z = (c * f_v - dp * forcing[1] + d * (f_mu - f_y) - own.mu_z * steeper) / hurwitz(*system)
    v_z = k * mu_z + dk * own.mu_z
    return (f_v - h * v_z) / d, c * mu_z - dp * own.mu_z, v_z


def _column(n: int, closure: Any, response: Any, scales: Any) -> Any:
    """A column of the Jacobian, by the unknown ``n``, whose moment changes by its scale.

    ``closure`` are derivatives of the closure's coefficients and covariance, and this covariance;
    ``response`` are derivatives of the unknowns of the response by the coefficients.
    """
    of_slip, of_relaxation, (of_vv, of_zz, of_vz), assumed = closure
    slip, relaxation, (by_slip, by_relaxation) = of_slip[n], of_relaxation[n], response
    less = slope_of_unknowns(assumed, (of_vv[n], of_zz[n], of_vz[n]))
    return (
        (by_slip[0] * slip + by_relaxation[0] * relaxation - less[0]) * scales[n],
        (by_slip[1] * slip + by_relaxation[1] * relaxation - less[1]) * scales[n],
        (by_slip[2] * slip + by_relaxation[2] * relaxation - less[2]) * scales[n],
    )


def newton_step(columns: Any, mismatch: Any, damping: Any) -> Any:
    """``(damping - J)^-1 F``, limited to `LARGEST_STEP`; Newton's step for ``damping = 0``."""
    (a, d, g), (b, e, h), (c, f, i) = columns
    matrix = (damping - a, -b, -c), (-d, damping - e, -f), (-g, -h, damping - i)
    step_1, step_2, step_3 = solve_3x3(matrix, mismatch)
    largest = np.maximum(np.maximum(np.abs(step_1), np.abs(step_2)), np.abs(step_3))
    shorter = np.maximum(1.0, largest / LARGEST_STEP)
    return step_1 / shorter, step_2 / shorter, step_3 / shorter
