"""Covariance of linear(ized) structures under a modulated ground, from rest, over all cells at once.

``f(t) = m(t) o q`` with the filter's states ``q`` stationary and ``m`` the envelope. With
``C = E[x q']``, ``X = E[x x']`` of one structure, ``X12 = E[x1 x2']`` of a pair, and ``b`` what a unit
of ``f`` does to ``x``,

    C'   = A C + C F' + m b (P o)'
    X'   = A X + X A' + m [b (C o)' + (C o) b']
    X12' = A1 X12 + X12 A2' + m [b1 (C2 o)' + (C1 o) b2'],

on white noise ``2 pi S0 m^2 b b'`` in place of the brackets. ``A`` of a yielding structure follows
``X``: these are as many nonlinear equations as there are structures; the pairs' are linear and ride
along. A structure is a stack of storeys, an oscillator one of them. States are, storey by storey,
``d/s``, ``d'/(s w)`` and ``y/s`` with its drift ``d`` and the slip ``y = d - uy z``, as in `covariance`,
and a scale ``s`` of the storey's own: all of order one. Where structures have fewer storeys than others,
the states that they lack stand still.
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
RESTING = np.array([1.0, 1.0, 0.0])  # (sv, sz, r) where nothing moves: what is found does not count
AT_ONCE = 32  # steps whose moments are taken together
WINDOW, MOST_STEPS = 200, 1e6  # steps between looks at their length; steps of a run
ROUNDING = 1e-9  # a relative variance of the difference below is none


class Structures(NamedTuple):
    """Of up to ``m`` storeys: ``d'' = -damping d' - stiffness d + coupling y``, and ``f`` in the first.

    Storeys that a structure lacks have zeros, a scale of 1 and are elastic.
    """

    frequency: Array  # (n,) w [rad/s]
    stiffness: Array  # (n, m, m) [1/s^2]
    damping: Array  # (n, m, m) [1/s]
    coupling: Array  # (n, m, m) [1/s^2], 0 where elastic
    yield_displacement: Array  # (n, m) [m], infinite where elastic
    scale: Array  # (n, m) [m]
    seen: Array  # (n, h, m): by drifts, the displacements that are looked at


class Filters(NamedTuple):
    """The ground filter of each structure, its states over their standard deviations."""

    matrix: Array  # (n, k, k)
    output: Array  # (n, k) [m/s^2]
    covariance: Array  # (n, k, k)
    intensity: Array  # (n,) 2 pi S0 [m^2/s^3] where k = 0, for white noise


class Own(NamedTuple):
    """Second moments of each structure, and the coefficients that hold then."""

    displacement: Array  # variance [m^2], over (times, n h)
    velocity: Array  # variance [m^2/s^2]
    z: Array  # variance [m^2], of the storeys: over (times, n m)
    slip: Array  # 1 + c_e
    relaxation: Array  # k_e [1/s]


class Difference(NamedTuple):
    """Second moments of ``d = u_1 - u_2`` over (times, pairs h)."""

    d_d: Array  # [m^2]
    d_v: Array  # [m^2/s], E[d d']
    v_v: Array  # [m^2/s^2]
    product: Array  # E[u_1 u_2] [m^2]


Envelope = Callable[[float], float]
# (sv, sz, r) of ductility, (3, ..., n), to (1 + c_e, k_e), (2, ..., n)
Coefficients = Callable[[Array], Array]


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
        w, s, k = structures.frequency, structures.scale, filters.output.shape[1]
        n, m = s.shape
        self.shapes = ((n, 3 * m, k), (n, 3 * m, 3 * m), (pairs.shape[1], 3 * m, 3 * m))
        ends = np.cumsum([np.prod(shape) for shape in self.shapes])
        self.blocks = tuple(map(slice, [0, *ends[:-1]], ends))  # of the state: C, X, X12
        d, v, y = self.parts = slice(m), slice(m, 2 * m), slice(2 * m, 3 * m)
        self.yields = np.isfinite(structures.yield_displacement)
        x = np.arange(ends[0], ends[1]).reshape(self.shapes[1])
        squares = [
            _diagonal(x[:, one, two]) for one, two in ((d, d), (d, y), (y, y), (v, d), (v, y), (v, v))
        ]
        self.squares = np.stack(squares)  # (6, n, m): where the state has what `z` hangs on
        self.of_yielding = self.squares[:, self.yields]
        self.unit = (s / structures.yield_displacement)[self.yields]
        self.frequency = np.broadcast_to(w[:, None], s.shape)[self.yields]
        self.seen = structures.seen * s[:, None]
        self.push = 1 / (s[:, 0] * w)
        self.ground_push = np.einsum("nij,nj->ni", filters.covariance, filters.output)
        ratio, rate = s[:, None] / s[..., None], w[:, None, None]
        self.matrix = np.zeros((n, 3 * m, 3 * m))
        _diagonal(self.matrix[:, d, v])[...] = w[:, None]
        self.matrix[:, v, d] = -structures.stiffness * ratio / rate
        self.matrix[:, v, v] = -structures.damping * ratio
        self.matrix[:, v, y] = structures.coupling * ratio / rate
        self.slips = tuple(_diagonal(self.matrix[:, y, part]) for part in self.parts)

    def solve(self, times: Array, kinks: Sequence[float] = ()) -> tuple[Own, Difference]:
        """From rest at 0; ``times`` increase from 0. At the envelope's kinks the steps begin anew.

        Raises an ArithmeticError if the integration fails.
        """
        rtol = RTOL if self.closure is None else RTOL_YIELDING
        state = np.zeros(self.blocks[-1].stop)
        states, reached, begin = [state[None]], 1, 0.0
        found: list[tuple[Own, Difference]] = []
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
                if until > reached:
                    states.append(solver.dense_output()(times[reached:until]).T)
                    reached = until
                if len(states) == AT_ONCE or until == times.size:
                    found.append(self._moments(np.concatenate(states)))
                    states = []
            begin, state = end, solver.y
        own, both = zip(*found, strict=True)
        return (
            Own(*(np.concatenate(column) for column in zip(*own, strict=True))),
            Difference(*(np.concatenate(column) for column in zip(*both, strict=True))),
        )

    def _split(self, state: Array) -> tuple[Array, ...]:
        """The covariances (..., n, 3 m, .) in the states (..., size)."""
        lead, parts = state.shape[:-1], zip(self.blocks, self.shapes, strict=True)
        return tuple(state[..., block].reshape(lead + shape) for block, shape in parts)

    def _rate(self, time: float, state: Array) -> Array:
        c, x, both = self._split(state)
        if self.closure is not None:
            slip, relaxation = self.coefficients(state)
            by_drift, by_rate, by_slip = self.slips
            by_drift[...], by_slip[...] = relaxation, -relaxation
            by_rate[...] = slip * self.structures.frequency[:, None]
        a, first = self.matrix, self.parts[1].start  # the ground moves the first storey
        m = self.envelope(time)
        one, two = self.pairs
        push = m * self.push
        c_rate = a @ c + c @ self.filters.matrix.transpose(0, 2, 1)
        c_rate[:, first] += push[:, None] * self.ground_push
        half = a @ x
        both_rate = a[one] @ both + both @ a[two].transpose(0, 2, 1)
        if c.shape[2]:
            forced = (c @ self.filters.output[..., None])[..., 0]
            half[:, first] += push[:, None] * forced
            both_rate[:, first, :] += push[one, None] * forced[two]
            both_rate[:, :, first] += push[two, None] * forced[one]
        else:
            half[:, first, first] += 0.5 * self.filters.intensity * push**2
            both_rate[:, first, first] += self.filters.intensity[one] * push[one] * push[two]
        x_rate = half + half.transpose(0, 2, 1)
        return np.concatenate([c_rate.ravel(), x_rate.ravel(), both_rate.ravel()])

    @np.errstate(under="ignore", invalid="ignore", divide="ignore")
    def coefficients(self, state: Array) -> Array:
        """``1 + c_e`` and ``k_e`` (2, ..., n, m) that the closure finds for states (..., size)."""
        values = np.zeros((2, *state.shape[:-1], *self.structures.scale.shape))
        if self.closure is None:
            return values
        d_d, d_y, y_y, v_d, v_y, v_v = np.moveaxis(state[..., self.of_yielding], -2, 0)
        unit, z_z, v_z = self.unit, d_d - 2 * d_y + y_y, v_d - v_y
        sz, sv = np.sqrt(np.maximum(z_z, 0)), np.sqrt(np.maximum(v_v, 0))
        moving = (sz * unit > LEAST_Z) & (sv > 0)
        r = np.minimum(np.maximum(v_z / (sv * sz), -LARGEST_CORRELATION), LARGEST_CORRELATION)
        rates = sv * unit * self.frequency
        resting = RESTING.reshape(3, *(1,) * moving.ndim)
        latent = np.where(moving, np.stack([rates, sz * unit, r]), resting)
        values[..., self.yields] = np.where(moving, self.closure(latent), 0.0)
        return values

    def _moments(self, states: Array) -> tuple[Own, Difference]:
        """Of states (times, size)."""
        _, x, both = self._split(states)
        w, (one, two) = self.structures.frequency[:, None], self.pairs
        d, v, _ = self.parts

        def seen(left: Array, blocks: Array, right: Array) -> Array:
            return ((left @ blocks) * right).sum(axis=-1)

        own, first, second = self.seen, self.seen[one], self.seen[two]
        u_u, v_v = seen(own, x[..., d, d], own), w**2 * seen(own, x[..., v, v], own)
        u_v = w * seen(own, x[..., d, v], own)
        product = seen(first, both[..., d, d], second)
        crossed = w[two] * seen(first, both[..., d, v], second)
        crossed += w[one] * seen(first, both[..., v, d], second)
        velocities = w[one] * w[two] * seen(first, both[..., v, v], second)

        def of_both(values: Array) -> Array:
            return values[:, one] + values[:, two]

        squares = of_both(u_u)
        d_d = squares - 2 * product
        difference = Difference(
            np.where(d_d > ROUNDING * squares, d_d, 0.0),
            of_both(u_v) - crossed,
            of_both(v_v) - 2 * velocities,
            product,
        )
        d_d, d_y, y_y = np.moveaxis(states[:, self.squares[:3]], 1, 0)
        z_z = self.structures.scale**2 * (d_d - 2 * d_y + y_y)
        structures = Own(u_u, v_v, z_z, *self.coefficients(states))
        rows = (len(states), -1)
        return (
            Own(*(values.reshape(rows) for values in structures)),
            Difference(*(values.reshape(rows) for values in difference)),
        )


def _diagonal(blocks: Array) -> Array:
    """Diagonals of matrices (n, m, m), as a view that can be written to (n, m)."""
    return np.einsum("nii->ni", blocks)
