"""Covariance of linearized systems over time, from rest under a modulated ground.

The state vector ``x`` is that of `systems.state_space`, ``x' = A x + b n``. The envelope ``m(t)``
multiplies the acceleration of the ground, which is the white noise ``n`` itself if the ground has
no filter. The covariance ``X = E[x x']`` follows from

    X' = A X + X A' + 2 pi S0 b b',

where ``A`` depends on ``X`` by the coefficients of eqs. (9) and (10). These also depend on the
means of further states, if a law has any, and the means have rates by the law. All are integrated
together by the classical Runge-Kutta method of fourth order.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress
from stochlin.kernels.linearization.filters import stationary
from stochlin.kernels.linearization.systems.springs import Springs, coefficients_of
from stochlin.kernels.linearization.systems.state_space import state_space

PHASE = 0.25  # length of a step, as phase of the fastest motion that is followed [rad]
FIRST_PHASE = 0.1  # the same while a motion begins
LENGTH_OF_BEGINNING = 30.0  # how long that is, as phase [rad]
STABLE = 3.0  # ratio of the fastest oscillation or decay of all to the one that is followed
LEAST_PHASE = 4e-3  # shortest step, as the same phase
# ends of steps within the first interval, where an envelope is steep
FIRST_STEPS = 0.5 ** np.arange(12, 0, -1)
LEAST_Z = 0.04  # sz over the yield displacement below which closures are those of this sz
LEAST_RATE = 1e-12  # sv over the yield displacement to which it is limited [1/s]
LARGEST_CORRELATION = 1 - 1e-12  # to which corr(v, z) is limited


class MomentState(NamedTuple):
    """What is integrated, or its rates."""

    covariance: Array  # (c, states, states)
    # (1 + further states, c, m) of the work on z, and of the further states of the laws
    means: Array

    def moved(self, rates: MomentState, time: float) -> MomentState:
        """The state after a time [s] with these rates."""
        return MomentState(*(x + time * rate for x, rate in zip(self, rates, strict=True)))


class TransientMoments(NamedTuple):
    """Second moments and coefficients of c systems over time, with m springs that yield."""

    displacement: Array  # (times, c, k) variances of k sums of coordinates [m^2]
    mixed: Array  # (times, c, k) covariances of these sums and their rates [m^2/s]
    velocity: Array  # (times, c, k) variances of the rates [m^2/s^2]
    z: Array  # (times, c, m) variances [m^2]
    slip: Array  # (times, c, m) 1 + c_eq
    relaxation: Array  # (times, c, m) k_eq [1/s]
    means: Array  # (times, 1 + further states, c, m)


class TransientSystems:
    """Structures without links, in c cells, on a ground with an envelope.

    Parameters
    ----------
    problem : Springs
        Structures and ground; laws may have further states.
    limit : (c, s) array
        Extension of each spring at which its structure falls [m]; infinite if it cannot.
    followed : float
        Frequency of the fastest motion that is followed in detail [rad/s].
    envelope : callable
        Factor of the ground at a time [s].
    """

    def __init__(
        self,
        problem: Springs,
        limit: Array,
        followed: float,
        envelope: Callable[[float], float],
    ) -> None:
        elastic = np.zeros_like(problem.strength)
        space = state_space(problem, elastic - 1, elastic, problem.dashpots)
        self.blocks = space.blocks
        self.yielding = space.yielding
        self.laws = problem.laws
        self.envelope = envelope
        self.strength = problem.strength
        self.extensions = space.extensions
        self.most = limit**2
        g, _, v, _ = self.blocks
        self.matrix = space.matrix
        self.modulated = np.zeros_like(space.matrix)
        self.modulated[:, v, g] = self.matrix[:, v, g]
        self.matrix[:, v, g] = 0.0
        self.noise = space.noise[:, :, None] * space.noise[:, None] * space.intensity[:, None, None]
        self.filtered = g.stop > 0  # otherwise the noise itself has the envelope
        start = np.zeros_like(self.matrix)
        if self.filtered:
            root = np.sqrt(space.intensity)[:, None]
            start[:, g, g] = stationary(self.matrix[:, g, g], root * space.noise[:, g])
        states = max((law.states for law in problem.laws), default=0)
        self.start = MomentState(start, np.zeros((1 + states, *elastic.shape)))
        fastest = float(np.abs(np.linalg.eigvals(self.matrix)).max())
        self.followed = max(followed, fastest / STABLE)

    def coefficients(self, state: MomentState) -> tuple[Array, Array]:
        """``1 + c_eq`` and ``k_eq`` (2, c, m), and the rates of the means."""
        _, _, v, z = self.blocks
        unit = 1 / self.strength
        rate = self.yielding @ state.covariance[:, v]
        variance = _sums(rate[..., v], self.yielding)
        z_z = _diagonal(state.covariance[:, z, z])
        v_z = _diagonal(rate[..., z])
        sv = np.maximum(np.sqrt(np.maximum(variance, 0)) * unit, LEAST_RATE)
        sz = np.maximum(np.sqrt(np.maximum(z_z, 0)) * unit, LEAST_Z)
        r = np.clip(v_z * unit**2 / (sv * sz), -LARGEST_CORRELATION, LARGEST_CORRELATION)
        moments = np.stack([sv, sz, r])
        rates = np.zeros_like(state.means)
        laws = [law.at_means(state.means[1:]) for law in self.laws]
        rates[0] = sv * sz * r
        for law in laws:
            if law.mean_rates is not None:
                of_law = law.evaluated(law.mean_rates, moments)
                rates[1 : 1 + law.states, :, law.springs] = of_law
        return coefficients_of(laws, moments), rates

    def rates(self, time: float, state: MomentState) -> tuple[MomentState, float]:
        """The rates at a time [s], and the fastest motion that they need to follow [rad/s]."""
        level = self.envelope(time)
        _, _, v, z = self.blocks
        (slip, relaxation), of_means = self.coefficients(state)
        matrix = self.matrix + level * self.modulated
        of_z = np.arange(z.start, z.stop)
        matrix[:, z, v] = (1 - slip)[..., None] * self.yielding
        matrix[:, of_z, of_z] = -relaxation
        flow = matrix @ state.covariance
        drive = self.noise if self.filtered else level**2 * self.noise
        fastest = max(self.followed, float(relaxation.max(initial=0.0)))
        return MomentState(flow + flow.swapaxes(1, 2) + drive, of_means), fastest

    def advanced(self, begin: float, end: float, state: MomentState) -> MomentState:
        """The state at the end of an interval of time [s], by as many steps as its rates need."""
        time = begin
        steps = 2
        while steps > 1:
            at_begin, fastest = self.rates(time, state)
            phase = PHASE if time * self.followed > LENGTH_OF_BEGINNING else FIRST_PHASE
            if not fastest * LEAST_PHASE < self.followed * PHASE:
                raise ArithmeticError(
                    f"the covariance equations need steps of less than {PHASE / fastest:.2g} s at "
                    f"{time:.3g} s: a structure is so weak that its plastic displacement "
                    "follows at once; give it more strength, or simulate"
                )
            steps = int(np.ceil((end - time) * fastest / phase))
            length = (end - time) / steps
            at_middle, _ = self.rates(time + length / 2, state.moved(at_begin, length / 2))
            again, _ = self.rates(time + length / 2, state.moved(at_middle, length / 2))
            time = time + length if steps > 1 else end
            at_end, _ = self.rates(time, state.moved(again, length))
            stages = at_begin, at_middle, again, at_end
            for rates, weight in zip(stages, (1, 2, 2, 1), strict=True):
                state = state.moved(rates, weight * length / 6)
        self._check(end, state)
        return state

    def _check(self, time: float, state: MomentState) -> None:
        """Raise an ArithmeticError if a structure falls."""
        q = self.blocks[1]
        squares = _sums(self.extensions @ state.covariance[:, q, q], self.extensions)
        if not (squares <= self.most).all():
            raise ArithmeticError(
                "the linearized displacement of a structure exceeds the one at which it falls, at "
                f"{time:.3g} s, since its stiffness after yielding is negative; give it more "
                "hardening, or simulate"
            )

    @np.errstate(under="ignore")
    def solve(
        self,
        times: Array,
        rows: Array,
        kinks: Sequence[float] = (),
        progress: Progress | None = None,
    ) -> TransientMoments:
        """Moments at increasing ``times`` from 0 on, from rest at 0, of sums with weights (k, n).

        Steps end at ``kinks``, the times at which the envelope is not smooth. ``progress`` is
        called with the share of the time that is done. An ArithmeticError is raised if steps become
        too short, or if a structure falls.
        """
        moments = []
        for time, state in self._states(times, kinks):
            moments.append(self._moments(state, rows))
            if progress is not None:
                progress(float(time / times[-1]))
        return TransientMoments._make(map(np.stack, zip(*moments, strict=True)))

    def _states(self, times: Array, kinks: Sequence[float]) -> Iterator[tuple[float, MomentState]]:
        """The states at these times."""
        state = self.start
        yield 0.0, state
        inside = [kink for kink in kinks if 0 < kink < times[-1]]
        ends = np.unique([*times, *(FIRST_STEPS * times[1]), *inside])
        wanted = set(times.tolist())
        for begin, end in pairwise(ends.tolist()):
            state = self.advanced(begin, end, state)
            if end in wanted:
                yield end, state

    def _moments(self, state: MomentState, rows: Array) -> TransientMoments:
        """Moments at one time."""
        _, q, v, z = self.blocks
        (slip, relaxation), _ = self.coefficients(state)
        x = state.covariance
        z_z = _diagonal(state.covariance[:, z, z])
        u_u = _sums(rows @ x[:, q, q], rows)
        u_v = _sums(rows @ x[:, q, v], rows)
        v_v = _sums(rows @ x[:, v, v], rows)
        return TransientMoments(u_u, u_v, v_v, z_z, slip, relaxation, state.means)


def _sums(left: Array, right: Array) -> Array:
    """Sums (c, k) of the products of rows (c, k, n) with the rows (k, n)."""
    sums: Array = (left * right).sum(axis=-1)
    return sums


def _diagonal(matrices: Array) -> Array:
    """Diagonals (c, n) of matrices."""
    return np.diagonal(matrices, axis1=1, axis2=2)
