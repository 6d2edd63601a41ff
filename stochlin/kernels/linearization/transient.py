"""Covariance of linear and linearized structures over time, from rest under a modulated ground.

The forcing is ``f(t) = m(t) o q``, with the stationary states ``q`` and the output row ``o`` of the
ground filter ``q' = F q + noise``, and the envelope ``m``. ``P`` is the covariance of ``q``. The
structures follow ``x' = A x + b f``. With ``C = E[x q']``, ``X = E[x x']`` of one structure and
``X12 = E[x1 x2']`` of a pair,

    C'   = A C + C F' + m b (P o)'
    X'   = A X + X A' + m [b (C o)' + (C o) b']
    X12' = A1 X12 + X12 A2' + m [b1 (C2 o)' + (C1 o) b2'],

On white noise ``2 pi S0 m^2 b b'`` replaces ``m`` times the brackets. ``A`` of a yielding structure
depends on ``X`` through its coefficients. A structure has one or more storeys; an oscillator has one.
The states are, storey by storey, ``d/s``, ``d'/(s w)`` and ``y/s``, with the storey drift ``d``, the
slip ``y = d - uy z`` as in `covariance`, and a scale ``s`` for each storey that makes them of order
one. In structures with fewer storeys than others the states of the missing storeys remain zero.

Time is divided into panels. Within a panel, with ``t`` from its start, the transition matrix ``Phi`` of
a structure, ``Phi' = A Phi``, reduces the equations to integrals over vectors:

    beta = m Phi^-1 b,    D = C(0) + Int beta (exp(-F t) P o)' dt,    gamma = D exp(F' t) o
    C = Phi D exp(F' t),  X12 = Phi1 [X12(0) + Int (beta1 gamma2' + gamma1 beta2') dt] Phi2',

with ``gamma = pi S0 beta`` on white noise. The integrals are those of polynomials through the
Gauss-Lobatto nodes of the panel. For elastic structures ``Phi = exp(A t)``. For yielding ones ``A*`` has
constant coefficients, those at an earlier time, and ``Phi = exp(A* t) V`` with
``V' = exp(-A* t) (A - A*) Phi``. The coefficients at all nodes of a panel are found together by Picard
iteration.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.collocation import exponentials, lobatto

RTOL, ATOL = 1e-9, 1e-12  # tolerances of covariances, in units of the elastic stationary response
RTOL_YIELDING = 1e-7  # with yielding structures, for which linearization is itself an approximation
LEAST_Z = 0.04  # sz over the yield displacement below which slip is neglected (probability 1e-130)
LARGEST_CORRELATION = 1 - 1e-12  # to which corr(v, z) is limited
RESTING = np.array([1.0, 1.0, 0.0])  # (sv, sz, r) in place of those at rest, whose result is not used
NODES = lobatto(24)  # nodes of a panel
FIRST = 5.0  # length of the first panel, as phase of the fastest oscillation [rad]
SHORTER, LONGER = 0.4, 2.0  # smallest and largest ratio of the lengths of successive panels
MARGIN, WORTH_IT = 0.9, 1.25  # safety factor on the length; factor from which panels are lengthened
WINDOW, MOST_PANELS = 100, 1e5  # panels between checks of the progress; largest number in a run
SWEEPS, SETTLED = 15, 0.1  # Picard iterations of a panel; change by the last one, in tolerances
HELD = 0.3  # change of a coefficient, times the panel's length, from which A* is computed anew
AT_ONCE = 64  # times whose moments are computed together
ROUNDING = 1e-9  # relative variance of the difference below which it is rounding error


class Structures(NamedTuple):
    """Structures of up to ``m`` storeys, ``d'' = -damping d' - stiffness d + coupling y + f e_1``.

    ``e_1`` is 1 in the first storey. Missing storeys of a structure have zeros, a scale of 1, and are
    elastic.
    """

    frequency: Array  # (n,) w [rad/s], the scale of velocities
    stiffness: Array  # (n, m, m) [1/s^2]
    damping: Array  # (n, m, m) [1/s]
    coupling: Array  # (n, m, m) [1/s^2], 0 where elastic
    yield_displacement: Array  # (n, m) [m], infinite where elastic
    scale: Array  # (n, m) [m]
    seen: Array  # (n, h, m): weights of the drifts in the ``h`` displacements of the results


class Filters(NamedTuple):
    """The ground filter of each structure, with states over their standard deviations."""

    matrix: Array  # (n, k, k): F [1/s]
    output: Array  # (n, k): o [m/s^2]
    covariance: Array  # (n, k, k): P
    intensity: Array  # (n,) 2 pi S0 [m^2/s^3] for white noise, which has k = 0


class Own(NamedTuple):
    """Second moments and coefficients of the structures over time."""

    displacement: Array  # (times, n h) variance [m^2]
    velocity: Array  # (times, n h) variance [m^2/s^2]
    z: Array  # (times, n m) variance of uy z of the storeys [m^2]
    slip: Array  # (times, n m) 1 + c_e
    relaxation: Array  # (times, n m) k_e [1/s]


class Difference(NamedTuple):
    """Second moments of the differences ``d = u_1 - u_2`` over time, each (times, pairs h)."""

    d_d: Array  # [m^2]
    d_v: Array  # [m^2/s], E[d d']
    v_v: Array  # [m^2/s^2]
    product: Array  # E[u_1 u_2] [m^2]


class Covariances(NamedTuple):
    """The covariances at a time, or at the nodes of a panel, which are then the first dimension."""

    soil: Array  # C (n, 3 m, k)
    own: Array  # X (n, 3 m, 3 m)
    both: Array  # X12 (p, 3 m, 3 m)


class Frame(NamedTuple):
    """Matrix exponentials at the nodes, the same for all panels of one length with the same ``A*``."""

    length: float  # of the panel [s]
    held: Array  # (2, n, m) 1 + c_e and k_e of A*
    forward: Array  # (q, n, 3 m, 3 m) exp(A* t)
    slips: Array  # (q, n, 3 m, m) columns of exp(-A* t) that belong to the slips
    push: Array  # (q, n, 3 m) exp(-A* t) b
    soil: Array  # (q, n, k) exp(-F t) P o
    output: Array  # (q, n, k) exp(F' t) o
    filters: Array  # (n, k, k) exp(F t) at the end of the panel


class Path(NamedTuple):
    """The matrices of the module's docstring for the structures at the nodes of a panel."""

    transition: Array  # Phi (q, n, 3 m, 3 m)
    push: Array  # beta (q, n, 3 m)
    pull: Array  # gamma (q, n, 3 m)
    soil: Array  # D (q, n, 3 m, k)
    own: Array  # X (q, n, 3 m, 3 m)


Envelope = Callable[[Array], Array]
# From the moments (sv, sz, r) in yield displacements, (3, ..., n), to (1 + c_e, k_e), (2, ..., n).
Coefficients = Callable[[Array], Array]


class Transient:
    """The equations of all structures and pairs; ``closure`` is None if all structures are elastic."""

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
        self.tolerance = RTOL if closure is None else RTOL_YIELDING
        w, s, k = structures.frequency, structures.scale, filters.output.shape[1]
        n, m = s.shape
        self.shapes = (n, 3 * m, k), (n, 3 * m, 3 * m), (pairs.shape[1], 3 * m, 3 * m)
        d, v, y = self.parts = slice(m), slice(m, 2 * m), slice(2 * m, 3 * m)
        self.yields = np.isfinite(structures.yield_displacement)
        x = np.arange(n * (3 * m) ** 2).reshape(self.shapes[1])
        squares = [
            _diagonal(x[:, one, two]) for one, two in ((d, d), (d, y), (y, y), (v, d), (v, y), (v, v))
        ]
        self.squares = np.stack(squares)  # (6, n, m): indices in X of the moments that give those of z
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

    def solve(self, times: Array, kinks: Sequence[float] = ()) -> tuple[Own, Difference]:
        """Moments at increasing ``times`` from 0 on, from rest at 0.

        Panels end at ``kinks``, the times at which the envelope is not smooth. An ArithmeticError is
        raised if panels become too short.
        """
        ends = (*sorted({kink for kink in kinks if 0 < kink < times[-1]}), times[-1])
        _, own, both = self._at_rest()
        seen, reached, found = [(own[None], both[None])], 1, []
        for begin, end, over in self._panels(ends):
            until = int(np.searchsorted(times, end, side="right"))
            shares = (times[reached:until] - begin) / (end - begin)
            seen.append((NODES.interpolate(over.own, shares), NODES.interpolate(over.both, shares)))
            reached = until
            if sum(len(own) for own, _ in seen) >= AT_ONCE or until == times.size:
                found.append(self._moments(*map(np.concatenate, zip(*seen, strict=True))))
                seen = []
        structures, pairs = zip(*found, strict=True)
        return (
            Own(*(np.concatenate(column) for column in zip(*structures, strict=True))),
            Difference(*(np.concatenate(column) for column in zip(*pairs, strict=True))),
        )

    def _at_rest(self) -> Covariances:
        """Covariances at rest, all zero."""
        return Covariances(*map(np.zeros, self.shapes))

    def _panels(self, ends: Sequence[float]) -> Iterator[tuple[float, float, Covariances]]:
        """Start, end and covariances of successive panels, which also end at each of ``ends``.

        Their length is adapted to the tolerance, by the last terms of the Legendre series.
        """
        structures = np.sqrt(np.abs(self.structures.stiffness).sum(axis=-1).max())
        fastest = max(structures, np.abs(self.filters.matrix).sum(axis=-1).max(initial=0))
        begin, length, now, frame = 0.0, FIRST / fastest, self._at_rest(), None
        for end in ends:
            left, tried, mark = 0, 0, begin  # ``left``: number of panels of this length to the end
            while begin < end:
                if not left:
                    left = int(np.ceil((end - begin) / length))
                    length = (end - begin) / left
                tried += 1
                if tried % WINDOW == 0:
                    _check_pace(begin - mark, length, begin, end)
                    mark = begin
                frame = self._frame(length, now.own, frame)
                path = self._path(frame, self.envelope(begin + length * NODES.at), now)
                error = np.inf
                if path is not None:
                    error = self._over_tolerance(NODES.last_terms(path.own), path.own)
                factor = MARGIN * max(error, ATOL) ** (-1 / NODES.at.size)
                if path is None or not error <= 1:
                    length, left = length * max(SHORTER, factor), 0
                    continue
                left -= 1
                over, until = self._covariances(frame, path, now), begin + length if left else end
                yield begin, until, over
                begin, now = until, Covariances(*(part[-1] for part in over))
                if factor > WORTH_IT:
                    length, left = length * min(factor, LONGER), 0

    def _frame(self, length: float, own: Array, old: Frame | None) -> Frame:
        """The old frame if its length and coefficients are still valid, else a new one for ``own``."""
        held = self.coefficients(own)
        w, d, v, y = self.structures.frequency, *self.parts
        if old is not None and old.length == length:
            slip, relaxation = np.abs(held - old.held)
            if max((slip * w[:, None]).max(), relaxation.max()) * length <= HELD:
                return old
        slip, relaxation = held
        a, f = self.matrix.copy(), self.filters
        _diagonal(a[:, y, d])[...], _diagonal(a[:, y, y])[...] = relaxation, -relaxation
        _diagonal(a[:, y, v])[...] = slip * w[:, None]
        times = length * NODES.at
        back, soil = exponentials(-a, times), exponentials(f.matrix, times)
        return Frame(
            length,
            held,
            exponentials(a, times),
            np.ascontiguousarray(back[..., y]),
            back[..., v.start] * self.push[:, None],  # the ground accelerates the first storey
            (exponentials(-f.matrix, times) @ self.ground_push[..., None])[..., 0],
            (soil.swapaxes(-1, -2) @ f.output[..., None])[..., 0],
            soil[-1],
        )

    @np.errstate(over="ignore", invalid="ignore")  # too long a panel may overflow, and is repeated
    def _path(self, frame: Frame, envelope: Array, now: Covariances) -> Path | None:
        """The structures over a panel from ``now`` on; None if the iteration does not converge."""
        push = frame.push * envelope[:, None, None]
        path = self._at_nodes(frame, frame.forward, push, now)
        if self.closure is None:
            return path
        for _ in range(SWEEPS):
            slip, relaxation = self.coefficients(path.own) - frame.held[:, None]
            slip *= self.structures.frequency[:, None]
            by_drift, by_rate, by_slip = (path.transition[..., part, :] for part in self.parts)
            rates = slip[..., None] * by_rate + relaxation[..., None] * (by_drift - by_slip)
            turn = NODES.integrate(frame.slips @ rates, frame.length)  # V less the unit matrix
            turn += np.eye(turn.shape[-1])
            turned = np.linalg.solve(turn, push[..., None])[..., 0]
            before, path = path, self._at_nodes(frame, frame.forward @ turn, turned, now)
            if self._over_tolerance(path.own - before.own, path.own) <= SETTLED:
                return path
        return None

    def _at_nodes(self, frame: Frame, transition: Array, push: Array, now: Covariances) -> Path:
        """The path with these transition matrices ``Phi`` and with ``push``, that is ``beta``."""
        soil = NODES.integrate(push[..., None] * frame.soil[..., None, :], frame.length) + now.soil
        pull = (soil @ frame.output[..., None])[..., 0]
        pull += 0.5 * self.filters.intensity[:, None] * push
        forced = push[..., None] * pull[..., None, :]
        own = NODES.integrate(forced + forced.swapaxes(-1, -2), frame.length) + now.own
        return Path(transition, push, pull, soil, transition @ own @ transition.swapaxes(-1, -2))

    def _over_tolerance(self, difference: Array, own: Array) -> float:
        """Largest difference over its tolerance, which is relative to each structure's covariances."""
        error, size = (np.abs(array).max(axis=(0, 2, 3)) for array in (difference, own))
        return float((error / (self.tolerance * size + ATOL)).max())

    def _covariances(self, frame: Frame, path: Path, now: Covariances) -> Covariances:
        """The covariances at the nodes; those with the ground's states only at the end of the panel."""
        one, two = self.pairs
        forced = path.push[:, one, :, None] * path.pull[:, two, None, :]
        forced += path.pull[:, one, :, None] * path.push[:, two, None, :]
        both = NODES.integrate(forced, frame.length) + now.both
        both = path.transition[:, one] @ both @ path.transition[:, two].swapaxes(-1, -2)
        soil = path.transition[-1:] @ path.soil[-1:] @ frame.filters.swapaxes(-1, -2)
        return Covariances(soil, path.own, both)

    @np.errstate(under="ignore", invalid="ignore", divide="ignore")
    def coefficients(self, own: Array) -> Array:
        """``1 + c_e`` and ``k_e`` (2, ..., n, m) by the closure, for ``X`` (..., n, 3 m, 3 m)."""
        values = np.zeros((2, *own.shape[:-2], self.structures.scale.shape[1]))
        if self.closure is None:
            return values
        state = own.reshape(*own.shape[:-3], -1)
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

    def _moments(self, x: Array, both: Array) -> tuple[Own, Difference]:
        """Moments from the covariances ``X`` and ``X12``, whose first dimension is time."""
        w, (one, two) = self.structures.frequency[:, None], self.pairs
        d, v, _ = self.parts

        def seen(left: Array, blocks: Array, right: Array) -> Array:
            """Covariances of weighted sums of drifts, from blocks of covariances of the drifts."""
            return ((left @ blocks) * right).sum(axis=-1)

        own, first, second = self.seen, self.seen[one], self.seen[two]
        u_u, v_v = seen(own, x[..., d, d], own), w**2 * seen(own, x[..., v, v], own)
        u_v = w * seen(own, x[..., d, v], own)
        product = seen(first, both[..., d, d], second)
        crossed = w[two] * seen(first, both[..., d, v], second)
        crossed += w[one] * seen(first, both[..., v, d], second)
        velocities = w[one] * w[two] * seen(first, both[..., v, v], second)

        def of_both(values: Array) -> Array:
            """Sums of the values of both structures of each pair."""
            return values[:, one] + values[:, two]

        squares = of_both(u_u)
        d_d = squares - 2 * product
        difference = Difference(
            np.where(d_d > ROUNDING * squares, d_d, 0.0),
            of_both(u_v) - crossed,
            of_both(v_v) - 2 * velocities,
            product,
        )
        d_d, d_y, y_y = np.moveaxis(x.reshape(len(x), -1)[:, self.squares[:3]], 1, 0)
        z_z = self.structures.scale**2 * (d_d - 2 * d_y + y_y)
        structures = Own(u_u, v_v, z_z, *self.coefficients(x))
        rows = (len(x), -1)
        return (
            Own(*(values.reshape(rows) for values in structures)),
            Difference(*(values.reshape(rows) for values in difference)),
        )


def _check_pace(passed: float, length: float, begin: float, end: float) -> None:
    """Raise an ArithmeticError if the panels are so short that too many remain.

    ``passed`` is the time that the last `WINDOW` panels have covered [s].
    """
    if (end - begin) * WINDOW > MOST_PANELS * passed:
        raise ArithmeticError(
            f"the covariance equations need steps of {length:.2g} s at {begin:.3g} s: a structure is so "
            "weak that its plastic displacement follows at once; give it more strength, or simulate"
        )


def _diagonal(blocks: Array) -> Array:
    """Diagonals of matrices (n, m, m), as a view that can be written to (n, m)."""
    return np.einsum("nii->ni", blocks)
