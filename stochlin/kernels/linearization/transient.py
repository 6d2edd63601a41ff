"""Covariance of linear(ized) structures under a modulated ground, from rest, over all cells at once.

``f(t) = m(t) o q`` with the filter's states ``q`` stationary and ``m`` the envelope. With
``C = E[x q']``, ``X = E[x x']`` of one structure, ``X12 = E[x1 x2']`` of a pair, and ``b`` what a unit
of ``f`` does to ``x``,

    C'   = A C + C F' + m b (P o)'
    X'   = A X + X A' + m [b (C o)' + (C o) b']
    X12' = A1 X12 + X12 A2' + m [b1 (C2 o)' + (C1 o) b2'],

on white noise ``2 pi S0 m^2 b b'`` in place of the brackets. ``A`` of a yielding structure follows
``X``: these are as many nonlinear equations as there are structures; the pairs' are linear and ride
along. States are ``u/s``, ``u'/(s w)`` and ``y/s`` with ``y = u - uy z`` the slip, as in `covariance`,
and a scale ``s`` of the structure's own: all of order one.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from scipy.integrate import DOP853

from stochlin.kernels.basics.arrays import Array

RTOL, ATOL = 1e-9, 1e-12  # of covariances in units of the elastic stationary response
RTOL_YIELDING = 1e-7  # where the equations are themselves an approximation
LEAST_Z = 0.04  # over yield; below, slip is rarer than 1e-130
LARGEST_CORRELATION = 1 - 1e-12
WINDOW, MOST_STEPS = 200, 1e6  # steps between looks at their length; steps of a run
ROUNDING = 1e-9  # a relative variance of the difference below is none


class Structures(NamedTuple):
    """Structures on their grounds; arrays (n,) unless said otherwise."""

    frequency: Array  # w [rad/s]
    damping: Array  # 2 xi w [1/s]
    coupling: Array  # (1 - alpha) w^2 [1/s^2], 0 where elastic
    yield_displacement: Array  # [m], infinite where elastic
    scale: Array  # [m]


class Filters(NamedTuple):
    """The ground filter of each structure, its states over their standard deviations."""

    matrix: Array  # (n, k, k)
    output: Array  # (n, k) [m/s^2]
    covariance: Array  # (n, k, k)
    intensity: Array  # (n,) 2 pi S0 [m^2/s^3] where k = 0, for white noise


class Own(NamedTuple):
    """Second moments of structures over (times, n), and the coefficients that hold then."""

    displacement: Array  # variance [m^2]
    velocity: Array  # variance [m^2/s^2]
    z: Array  # variance [m^2]
    slip: Array  # 1 + c_e
    relaxation: Array  # k_e [1/s]


class Difference(NamedTuple):
    """Second moments of ``d = u_1 - u_2`` over (times, pairs)."""

    d_d: Array  # [m^2]
    d_v: Array  # [m^2/s], E[d d']
    v_v: Array  # [m^2/s^2]
    product: Array  # E[u_1 u_2] [m^2]


Envelope = Callable[[float], float]
Coefficients = Callable[[Array], Array]  # (sv, sz, r) of ductility, (3, n), to (1 + c_e, k_e), (2, n)


class Transient:
    """The equations of all structures and pairs; ``closure`` is None where all are elastic."""

    def __init__(
        self,
        structures: Structures,
        filters: Filters,
        pairs: Array,
        closure: Coefficients | None,
        envelope: Envelope,
    ) -> None:
        self.structures, self.filters, self.envelope = structures, filters, envelope
        self.pairs, self.closure = pairs, closure
        w, n, k = structures.frequency, structures.frequency.size, filters.output.shape[1]
        self.shapes = ((n, 3, k), (n, 3, 3), (pairs.shape[1], 3, 3))
        self.push = 1 / (structures.scale * w)
        self.ground_push = np.einsum("nij,nj->ni", filters.covariance, filters.output)
        self.matrix = np.zeros((n, 3, 3))
        self.matrix[:, 0, 1], self.matrix[:, 1, 0] = w, -w
        self.matrix[:, 1, 1] = -structures.damping
        self.matrix[:, 1, 2] = structures.coupling / w

    def solve(self, times: Array, kinks: Sequence[float] = ()) -> tuple[Own, Difference]:
        """From rest at 0; ``times`` increase from 0. At the envelope's kinks the steps begin anew.

        Raises an ArithmeticError if the integration fails.
        """
        rtol = RTOL if self.closure is None else RTOL_YIELDING
        state = np.zeros(sum(int(np.prod(shape)) for shape in self.shapes))
        rows, begin = [self._moments(state)], 0.0
        for end in (*sorted({kink for kink in kinks if 0 < kink < times[-1]}), times[-1]):
            solver = DOP853(self._rate, begin, state, end, rtol=rtol, atol=ATOL)
            taken, mark = 0, begin
            while solver.status == "running":
                message = solver.step()
                taken += 1
                if taken % WINDOW == 0:
                    if (end - solver.t) / (solver.t - mark) * WINDOW > MOST_STEPS + times.size:
                        raise ArithmeticError(
                            f"the covariance equations need steps of {solver.step_size:.2g} s at "
                            f"{solver.t:.3g} s: a structure is so weak that its plastic displacement "
                            "follows at once; give it more strength, or simulate"
                        )
                    mark = solver.t
                if solver.status == "failed":
                    raise ArithmeticError(f"the covariance equations were not integrated: {message}")
                until = int(np.searchsorted(times, solver.t, side="right"))
                if until > len(rows):
                    dense = solver.dense_output()
                    rows += [self._moments(dense(time)) for time in times[len(rows) : until]]
            begin, state = end, solver.y
        own, both = zip(*rows, strict=True)
        return (
            Own(*(np.stack(column) for column in zip(*own, strict=True))),
            Difference(*(np.stack(column) for column in zip(*both, strict=True))),
        )

    def _split(self, state: Array) -> tuple[Array, Array, Array]:
        c, x, both = self.shapes
        first = int(np.prod(c))
        second = first + int(np.prod(x))
        return state[:first].reshape(c), state[first:second].reshape(x), state[second:].reshape(both)

    def _rate(self, time: float, state: Array) -> Array:
        c, x, both = self._split(state)
        slip, relaxation = self.coefficients(x)
        a = self.matrix
        a[:, 2, 0], a[:, 2, 1], a[:, 2, 2] = relaxation, slip * self.structures.frequency, -relaxation
        m = self.envelope(time)
        one, two = self.pairs
        push = m * self.push
        c_rate = a @ c + c @ self.filters.matrix.transpose(0, 2, 1)
        c_rate[:, 1] += push[:, None] * self.ground_push
        half = a @ x
        both_rate = a[one] @ both + both @ a[two].transpose(0, 2, 1)
        if c.shape[2]:
            forced = np.einsum("nij,nj->ni", c, self.filters.output)
            half[:, 1] += push[:, None] * forced
            both_rate[:, 1, :] += push[one, None] * forced[two]
            both_rate[:, :, 1] += push[two, None] * forced[one]
        else:
            half[:, 1, 1] += 0.5 * self.filters.intensity * push**2
            both_rate[:, 1, 1] += self.filters.intensity[one] * push[one] * push[two]
        x_rate = half + half.transpose(0, 2, 1)
        return np.concatenate([c_rate.ravel(), x_rate.ravel(), both_rate.ravel()])

    @np.errstate(under="ignore")
    def coefficients(self, x: Array) -> tuple[Array, Array]:
        """``1 + c_e`` and ``k_e`` that the closure finds for the covariances (n, 3, 3)."""
        if self.closure is None:
            return np.zeros(len(x)), np.zeros(len(x))
        s = self.structures
        unit = s.scale / s.yield_displacement
        z_z, v_z = x[:, 0, 0] - 2 * x[:, 0, 2] + x[:, 2, 2], x[:, 1, 0] - x[:, 1, 2]
        sz, sv = np.sqrt(np.maximum(z_z, 0)), np.sqrt(np.maximum(x[:, 1, 1], 0))
        moving = (sz * unit > LEAST_Z) & (sv > 0)
        with np.errstate(invalid="ignore", divide="ignore"):
            r = np.where(moving, v_z / (sv * sz), 0.0)
        r = np.clip(r, -LARGEST_CORRELATION, LARGEST_CORRELATION)
        latent = np.stack(
            [np.where(moving, sv * unit * s.frequency, 1.0), np.where(moving, sz * unit, 1.0), r]
        )
        values = np.where(moving, self.closure(latent), 0.0)
        return values[0], values[1]

    def _moments(self, state: Array) -> tuple[Own, Difference]:
        _, x, both = self._split(state)
        s, w = self.structures.scale, self.structures.frequency
        u_u, v_v, u_v = s**2 * x[:, 0, 0], (s * w) ** 2 * x[:, 1, 1], s**2 * w * x[:, 0, 1]
        z_z = s**2 * (x[:, 0, 0] - 2 * x[:, 0, 2] + x[:, 2, 2])
        one, two = self.pairs
        unit = s[one] * s[two]
        product = unit * both[:, 0, 0]
        crossed = unit * (w[two] * both[:, 0, 1] + w[one] * both[:, 1, 0])
        velocities = unit * w[one] * w[two] * both[:, 1, 1]
        d_d = u_u[one] + u_u[two] - 2 * product
        difference = Difference(
            np.where(d_d > ROUNDING * (u_u[one] + u_u[two]), d_d, 0.0),
            u_v[one] + u_v[two] - crossed,
            v_v[one] + v_v[two] - 2 * velocities,
            product,
        )
        return Own(u_u, v_v, z_z, *self.coefficients(x)), difference
