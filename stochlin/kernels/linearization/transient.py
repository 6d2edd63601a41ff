"""Covariance of linear and linearized structures over time, from rest under a modulated ground.

A structure has one or more elements: an oscillator has one, a building one for each storey or mode. Its
states ``x`` are those of the ground filter and, for each element, the extension ``d``, its rate ``d'``
and the elastic part ``z`` of the extension:

    q' = F q + n w,    d'' = -C d' - K d - H z + s f,    z' = -c_e d' - k_e z.

The ground has the acceleration ``f = m(t) o q``, with the envelope ``m`` and white noise ``w``; without
a filter it is ``m(t) w``. Together they are ``x' = A x + b w``. The covariance ``X_ij = E[x_i x_j']`` of
two structures, or of a structure with itself, follows from

    X_ij' = A_i X_ij + X_ij A_j' + b_i b_j'.

``A_i`` depends on ``X_ii`` by the coefficients ``c_e`` and ``k_e`` of eqs. (9) and (10). They also
depend on the means of further states, if the law has any, and the means have rates by the law. All
these equations are integrated together by the Runge-Kutta method of Dormand and Prince, of order 5,
with steps that follow from an estimate of their error.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress
from stochlin.kernels.basics.systems import System
from stochlin.kernels.linearization.filters import Filter, stationary
from stochlin.kernels.linearization.gaussian import ClosureInTime

if TYPE_CHECKING:
    from scipy.integrate import RK45

# Tolerances of a step, the latter for covariances over the squares of their units. The standard
# deviations of 48 random structures and pairs, with up to 20 + 20 storeys, were within 1e-4 of their
# largest value of those by another method with a tolerance of 1e-7 and less.
RTOL, ATOL = 1e-5, 1e-9
LEAST_Z = 0.04  # sz over the yield displacement below which closures are those of this sz
LEAST_RATE = 1e-12  # sv over the yield displacement to which it is limited [1/s]
LARGEST_CORRELATION = 1 - 1e-12  # to which corr(v, z) is limited
LEAST_PHASE, FIRST_STEPS = 5e-3, 100  # least length of steps, as this phase, after the first ones [rad]
FIRST_PHASE = 0.1  # length of the first step, as phase of the fastest oscillation [rad]
AT_ONCE = 64  # times whose moments are computed together
Q, D, V, Z = range(4)  # blocks of states: the ground, extensions, their rates, their elastic parts
EQUAL = 1e-6  # relative variance of the difference below which it is an error of the integration


class Own(NamedTuple):
    """Second moments and coefficients of the structures over time, structure by structure."""

    displacement: Array  # (times, n h) variance [m^2]
    velocity: Array  # (times, n h) variance [m^2/s^2]
    z: Array  # (times, all elements) variance of uy z [m^2]
    slip: Array  # (times, all elements) 1 + c_e
    relaxation: Array  # (times, all elements) k_e [1/s]
    means: Array  # (times, states, all elements) of the work on z, and of the further states of the laws


class Difference(NamedTuple):
    """Second moments of the differences ``d = u_1 - u_2`` over time, each (times, pairs h)."""

    d_d: Array  # [m^2]
    d_v: Array  # [m^2/s], E[d d']
    v_v: Array  # [m^2/s^2]
    product: Array  # E[u_1 u_2] [m^2]


class Law(NamedTuple):
    """The linearized law of the elements; those without a strength stay elastic."""

    closure: ClosureInTime
    parameters: Array  # (k, n m)


class Structures:
    """The equations of n structures with m elements each, and of the ground of each.

    Parameters
    ----------
    system, ground : System, Filter
        Over the structures.
    law : Law or None
        Linearized law of the elements that yield.
    seen : (h, m) array
        Factors that give the displacements of the results from the coordinates.
    limit : (n, m) array
        Extension at which the structure falls [m]; infinite if it cannot.
    unit : (2, n) array
        Units in which errors of extensions [m] and of their rates [m/s] count.
    """

    def __init__(
        self, system: System, ground: Filter, law: Law | None, *, seen: Array, limit: Array, unit: Array
    ) -> None:
        (n, m), k, extensions = system.mass.shape, len(ground.states), system.extensions
        self.blocks = [slice(*ends) for ends in pairwise(np.cumsum([0, k, m, m, m]).tolist())]
        q, d, v, z = self.blocks
        forces, shaken = extensions / system.mass[:, None], extensions.sum(axis=1)
        # The state matrix while elastic, and the part of it that the envelope multiplies.
        self.matrix, self.modulated = np.zeros((2, n, z.stop, z.stop))
        noise = np.zeros((n, z.stop))
        self.matrix[:, q, q], noise[:, q], output = ground.arrays
        self.matrix[:, d, v] = self.matrix[:, z, v] = np.eye(m)
        self.matrix[:, v, d] = -(forces @ extensions.T) * system.post[:, None]
        self.matrix[:, v, v] = -forces @ system.damping @ np.linalg.inv(extensions)
        self.matrix[:, v, z] = -(forces @ extensions.T) * system.couple[:, None]
        self.modulated[:, v, q] = shaken[:, None] * output[..., None, :]
        noise[:, v] = 0.0 if k else shaken  # white noise acts on the structures, times the envelope
        self.noise = noise * np.sqrt(2 * np.pi * ground.intensity)[:, None]
        self.start = np.zeros_like(self.matrix)
        if k:
            self.start[:, q, q] = stationary(self.matrix[:, q, q], self.noise[:, q])
        of_ground = np.sqrt(np.diagonal(self.start, axis1=1, axis2=2)[:, q])
        self.units = np.hstack([of_ground, np.repeat(unit[[0, 1, 0]].T, m, axis=1)])
        self.law, self.strength, self.most = law, system.strength, limit**2
        self.seen = seen @ np.linalg.inv(extensions)
        self.rate_of, self.z_of = np.arange(v.start, v.stop), np.arange(z.start, z.stop)

    @property
    def states(self) -> int:
        """Number of means: that of the work on z, and those of the further states of the law."""
        return 1 + self.law.closure.states if self.law else 0

    def linearized(self, level: float, covariance: Array, means: Array) -> tuple[Array, Array]:
        """``A`` at a level of the envelope, and the rates of the means."""
        matrix = self.matrix + level * self.modulated
        if self.law is None:
            return matrix, np.zeros_like(means)
        slip, relaxation, rates = self.coefficients(covariance[None], means[None])
        matrix[:, self.z_of, self.rate_of] = 1 - slip[0]
        matrix[:, self.z_of, self.z_of] = -relaxation[0]
        return matrix, rates[0]

    def coefficients(self, covariance: Array, means: Array) -> tuple[Array, Array, Array]:
        """``1 + c_e`` and ``k_e`` (times, n, m), and the rates of the means.

        They follow from ``covariance`` (times, n, states, states) and ``means`` (times, states, n m).
        """
        v, z, none = self.rate_of, self.z_of, np.zeros((len(means), *self.strength.shape))
        if self.law is None:
            return none, none, np.zeros_like(means)
        unit = 1 / self.strength
        sv = np.maximum(np.sqrt(np.maximum(covariance[..., v, v], 0)) * unit, LEAST_RATE)
        sz = np.maximum(np.sqrt(np.maximum(covariance[..., z, z], 0)) * unit, LEAST_Z)
        r = covariance[..., v, z] * unit**2 / (sv * sz)
        latent = np.array([sv, sz, np.clip(r, -LARGEST_CORRELATION, LARGEST_CORRELATION)]).reshape(3, -1)
        (closure, _, mean_rates), parameters = self.law
        states = means[:, 1 : self.states].swapaxes(0, 1).reshape(-1, latent.shape[1])
        rows = np.concatenate([np.tile(parameters, len(means)), states])
        coefficients = closure(latent, rows).coefficients.reshape(2, *none.shape)
        of_means = np.vstack([latent.prod(axis=0), mean_rates(latent, rows)])
        rates = np.zeros_like(means)
        rates[:, : self.states] = of_means.reshape(-1, *means[:, 0].shape).swapaxes(0, 1)
        return *np.where(np.isfinite(self.strength), coefficients, 0.0), rates

    def product(self, a: int, b: int, covariance: Array) -> Array:
        """``E[a b]`` (times, n, h) of the displacements, `D`, or velocities, `V`, of the results."""
        return _weighted(self.seen, covariance[..., self.blocks[a], self.blocks[b]], self.seen)

    def moments(self, covariance: Array, means: Array) -> Own:
        """Moments from covariances (times, n, states, states) and means (times, states, n m)."""
        slip, relaxation, _ = self.coefficients(covariance, means)
        u_u, v_v = (self.product(k, k, covariance) for k in (D, V))
        z_z = covariance[..., self.z_of, self.z_of]
        u_u, v_v, z_z, c, k = (row.reshape(len(row), -1) for row in (u_u, v_v, z_z, slip, relaxation))
        return Own(u_u, v_v, z_z, c, k, means)


class Covariances:
    """The covariances of all structures and of pairs of them, integrated as one row of numbers.

    The first structures of ``pairs`` (2, p) are in the first of the ``sides``, and the others in the
    last one; they are counted over all sides. ``envelope`` gives its values at times (t,).
    """

    def __init__(
        self, sides: Sequence[Structures], pairs: Array, envelope: Callable[[Array], Array]
    ) -> None:
        self.sides, self.envelope = sides, envelope
        self.pairs = i, j = pairs[0], pairs[1] - sum(len(side.matrix) for side in sides[:-1])
        ground = sides[0].blocks[Q]

        def products(of: str) -> list[Array]:
            """Products of rows of each side with itself, and of the pairs."""
            rows = [getattr(side, of) for side in sides]
            both = [(row, row) for row in rows] + [(rows[0][i], rows[-1][j])]
            return [a[..., None] * b[..., None, :] for a, b in both]

        self.drives, (*units, unit) = products("noise"), products("units")
        both, states = np.zeros_like(unit), max(side.states for side in sides)
        both[:, ground, ground] = sides[0].start[i, ground, ground]
        means = [np.zeros((states, side.strength.size)) for side in sides]
        start = [*(side.start for side in sides), *means, both]
        self.shapes, ends = [part.shape for part in start], np.cumsum([part.size for part in start])
        self.places = [slice(end - part.size, end) for end, part in zip(ends, start, strict=True)]
        self.start, scale = _row(start), _row([*units, *(1 + mean for mean in means), unit])
        # The integrator takes the mean square error over all numbers.
        share = np.sqrt(i.size + sum(len(side.matrix) for side in sides))
        self.tolerances = {"rtol": RTOL / share, "atol": ATOL / share * scale}
        self.fastest = max(float(np.abs(np.linalg.eigvals(side.matrix)).max()) for side in sides)

    def parts(self, numbers: Array) -> tuple[list[tuple[Array, Array]], Array]:
        """Covariance and means of each side, and covariances of the pairs, from numbers (..., all)."""
        lead, count = numbers.shape[:-1], len(self.sides)
        *parts, both = (
            numbers[..., place].reshape(lead + shape)
            for place, shape in zip(self.places, self.shapes, strict=True)
        )
        return list(zip(parts[:count], parts[count:], strict=True)), both

    def rates(self, time: float, numbers: Array) -> Array:
        """The rates of all numbers at a time [s]."""
        level, (of_sides, both) = float(self.envelope(np.array(time))), self.parts(numbers)
        drives = self.drives if self.sides[0].blocks[Q].stop else [level**2 * d for d in self.drives]
        matrices, rates, of_means = [], [], []
        for side, (covariance, means), own in zip(self.sides, of_sides, drives, strict=False):
            matrix, rates_of_means = side.linearized(level, covariance, means)
            flow = matrix @ covariance
            matrices.append(matrix)
            rates.append(flow + flow.swapaxes(1, 2) + own)
            of_means.append(rates_of_means)
        (i, j), transposed = self.pairs, np.ascontiguousarray(matrices[-1].swapaxes(1, 2))
        across = matrices[0][i] @ both + both @ transposed[j] + drives[-1]
        return _row([*rates, *of_means, across])

    def _steps(self, ends: Sequence[float]) -> Iterator[RK45]:
        """The integrator after each of its steps, from rest on; steps also end at each of ``ends``."""
        from scipy.integrate import RK45  # takes long to import

        begin, numbers = 0.0, self.start
        for end in ends:
            first = min(FIRST_PHASE / self.fastest, end - begin)
            solver = RK45(self.rates, begin, numbers, end, first_step=first, **self.tolerances)
            while solver.status == "running":
                solver.step()
                self._check(solver)
                yield solver
            begin, numbers = end, solver.y

    def _check(self, solver: RK45) -> None:
        """Raise an ArithmeticError if steps are too short, or a structure falls."""
        settled = solver.status == "running" and solver.nfev > 6 * FIRST_STEPS
        if solver.status == "failed" or (settled and solver.step_size * self.fastest < LEAST_PHASE):
            raise ArithmeticError(
                f"the covariance equations need steps of less than {LEAST_PHASE / self.fastest:.2g} s "
                f"at {solver.t:.3g} s: a structure is so weak that its plastic displacement follows at "
                "once; give it more strength, or simulate"
            )
        for side, (covariance, _) in zip(self.sides, self.parts(solver.y)[0], strict=True):
            if (np.diagonal(covariance, axis1=1, axis2=2)[:, side.blocks[D]] > side.most).any():
                raise ArithmeticError(
                    "the linearized displacement of a structure exceeds the one at which it falls, at "
                    f"{solver.t:.3g} s, since its stiffness after yielding is negative; give it more "
                    "hardening, or simulate"
                )

    @np.errstate(all="ignore")  # a step that is too long may overflow, and is repeated
    def solve(
        self, times: Array, kinks: Sequence[float] = (), progress: Progress | None = None
    ) -> tuple[Own, Difference]:
        """Moments at increasing ``times`` from 0 on, from rest at 0.

        Steps end at ``kinks``, the times at which the envelope is not smooth. ``progress`` is called
        with the share of the time that is done. An ArithmeticError is raised if steps become too short,
        or if a structure falls.
        """
        reached, numbers, moments = 0, [], []
        for solver in self._steps([*sorted(k for k in kinks if 0 < k < times[-1]), times[-1]]):
            until = int(np.searchsorted(times, solver.t, side="right"))
            if until > reached:
                numbers.append(solver.dense_output()(times[reached:until]).T)
                reached = until
            if sum(map(len, numbers)) >= AT_ONCE or solver.t == times[-1]:
                moments.append(self._moments(np.concatenate(numbers)))
                numbers = []
            if progress is not None:
                progress(float(solver.t / times[-1]))
        own, differences = zip(*moments, strict=True)
        return _joined(Own, own, axis=0), _joined(Difference, differences, axis=0)

    def _moments(self, numbers: Array) -> tuple[Own, Difference]:
        """Moments from numbers (times, all)."""
        of_sides, both = self.parts(numbers)
        own = [side.moments(*part) for side, part in zip(self.sides, of_sides, strict=True)]
        (i, j), first, last = self.pairs, self.sides[0], self.sides[-1]

        def alone(a: int, b: int) -> Array:
            """``E[a_1 b_1] + E[a_2 b_2]`` of displacements, `D`, or velocities, `V`."""
            (x_1, _), (x_2, _) = of_sides[0], of_sides[-1]
            return first.product(a, b, x_1)[:, i] + last.product(a, b, x_2)[:, j]

        def across(a: int, b: int) -> Array:
            """``E[a_1 b_2]``."""
            return _weighted(first.seen, both[..., first.blocks[a], last.blocks[b]], last.seen)

        squares, product = alone(D, D), across(D, D)
        d_d = squares - 2 * product
        least = EQUAL * ATOL * first.units[i, first.blocks[D].start, None] ** 2
        d_d = np.where(d_d > EQUAL * squares + least, d_d, 0.0)
        d_v = alone(D, V) - across(D, V) - across(V, D)
        v_v = alone(V, V) - 2 * across(V, V)
        differences = (part.reshape(len(part), -1) for part in (d_d, d_v, v_v, product))
        return _joined(Own, own, axis=-1), Difference(*differences)


def _row(parts: Sequence[Array]) -> Array:
    return np.concatenate([part.ravel() for part in parts])


def _joined(kind: type[Any], parts: Sequence[Any], axis: int) -> Any:
    """Moments of several times or sides as one."""
    return kind(*(np.concatenate(arrays, axis) for arrays in zip(*parts, strict=True)))


def _weighted(left: Array, blocks: Array, right: Array) -> Array:
    """Covariances of weighted sums of states, from blocks of covariances of the states."""
    covariances: Array = ((left @ blocks) * right).sum(axis=-1)
    return covariances
