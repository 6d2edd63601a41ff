"""Covariance of linear(ized) structures under a modulated ground, from rest, over all cells at once.

``f(t) = m(t) o q`` with the filter's states ``q`` stationary and ``m`` the envelope. With
``C = E[x q']``, ``X = E[x x']`` of one structure, ``X12 = E[x1 x2']`` of a pair, and ``b`` what a unit
of ``f`` does to ``x``,

    C'   = A C + C F' + m b (P o)'
    X'   = A X + X A' + m [b (C o)' + (C o) b']
    X12' = A1 X12 + X12 A2' + m [b1 (C2 o)' + (C1 o) b2'],

on white noise ``2 pi S0 m^2 b b'`` in place of the brackets. ``A`` of a yielding structure follows
``X``. A structure is a stack of storeys, an oscillator one of them. States are, storey by storey,
``d/s``, ``d'/(s w)`` and ``y/s`` with its drift ``d`` and the slip ``y = d - uy z``, as in `covariance`,
and a scale ``s`` of the storey's own: all of order one. Where structures have fewer storeys than others,
the states that they lack stand still.

Time is divided into panels. Within one, from its start at ``t = 0``, the transition matrix ``Phi`` of a
structure, ``Phi' = A Phi``, reduces the equations to integrals over vectors:

    beta = m Phi^-1 b,    D = C(0) + Int beta (exp(-F t) P o)' dt,    gamma = D exp(F' t) o
    C = Phi D exp(F' t),  X12 = Phi1 [X12(0) + Int (beta1 gamma2' + gamma1 beta2') dt] Phi2',

with ``pi S0 beta`` for ``gamma`` on white noise, and integrals of polynomials through Lobatto's nodes.
With elastic structures ``Phi = exp(A t)``. Otherwise ``A*`` holds the coefficients of an instant before,
``Phi = exp(A* t) V`` with ``V' = exp(-A* t) (A - A*) Phi``, and the coefficients at all nodes of a panel
are found together, in sweeps that converge as those of Picard do.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.collocation import exponentials, lobatto

RTOL, ATOL = 1e-9, 1e-12  # of covariances in units of the elastic stationary response
RTOL_YIELDING = 1e-7  # where the equations are themselves an approximation
LEAST_Z = 0.04  # over yield; below, slip is rarer than 1e-130
LARGEST_CORRELATION = 1 - 1e-12
RESTING = np.array([1.0, 1.0, 0.0])  # (sv, sz, r) where nothing moves: what is found does not count
NODES = lobatto(24)  # of a panel
FIRST = 5.0  # rad of the fastest oscillation over the first panel
SHORTER, LONGER = 0.4, 2.0  # the next panel over the last one, at least and at most
MARGIN, WORTH_IT = 0.9, 1.25  # share of the length that would do; longer than that, it is changed
WINDOW, MOST_PANELS = 100, 1e5  # panels between looks at their length; panels of a run
SWEEPS, SETTLED = 15, 0.1  # of a panel; change by the last of them, in tolerances
HELD = 0.3  # change of a coefficient, times the panel's length, beyond which others are held
AT_ONCE = 64  # instants whose moments are taken together
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


class Covariances(NamedTuple):
    """At an instant, or at the nodes of a panel, which then come first."""

    soil: Array  # C (n, 3 m, k)
    own: Array  # X (n, 3 m, 3 m)
    both: Array  # X12 (p, 3 m, 3 m)


class Frame(NamedTuple):
    """What panels of one length share at their nodes while ``A*`` holds the same coefficients."""

    length: float  # [s]
    held: Array  # 1 + c_e and k_e (2, n, m)
    forward: Array  # exp(A* t) (q, n, 3 m, 3 m)
    slips: Array  # of exp(-A* t) the columns of slip (q, n, 3 m, m)
    push: Array  # exp(-A* t) b (q, n, 3 m)
    soil: Array  # exp(-F t) P o (q, n, k)
    output: Array  # exp(F' t) o (q, n, k)
    filters: Array  # exp(F t) at the end (n, k, k)


class Path(NamedTuple):
    """The structures at the nodes of a panel."""

    transition: Array  # Phi (q, n, 3 m, 3 m)
    push: Array  # beta (q, n, 3 m)
    pull: Array  # gamma (q, n, 3 m)
    soil: Array  # D (q, n, 3 m, k)
    own: Array  # X (q, n, 3 m, 3 m)


Envelope = Callable[[Array], Array]
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
        self.squares = np.stack(squares)  # (6, n, m): where X has what `z` hangs on
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
        """From rest at 0; ``times`` increase from 0. At the envelope's kinks panels begin anew.

        Raises an ArithmeticError if panels become too short.
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
        return Covariances(*map(np.zeros, self.shapes))

    def _panels(self, ends: Sequence[float]) -> Iterator[tuple[float, float, Covariances]]:
        """Start, end and covariances of panels, as long as nodes resolve them; some end at ``ends``."""
        structures = np.sqrt(np.abs(self.structures.stiffness).sum(axis=-1).max())
        fastest = max(structures, np.abs(self.filters.matrix).sum(axis=-1).max(initial=0))
        begin, length, now, frame = 0.0, FIRST / fastest, self._at_rest(), None
        for end in ends:
            left, tried, mark = 0, 0, begin  # panels of this length, to the end
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
        """The old one if it will do, else one that holds the coefficients of ``own``."""
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
            back[..., v.start] * self.push[:, None],  # the ground moves the first storey
            (exponentials(-f.matrix, times) @ self.ground_push[..., None])[..., 0],
            (soil.swapaxes(-1, -2) @ f.output[..., None])[..., 0],
            soil[-1],
        )

    @np.errstate(over="ignore", invalid="ignore")  # a panel that is too long is found out
    def _path(self, frame: Frame, envelope: Array, now: Covariances) -> Path | None:
        """The structures over a panel from ``now`` on; None if their coefficients do not settle."""
        push = frame.push * envelope[:, None, None]
        path = self._at_nodes(frame, frame.forward, push, now)
        if self.closure is None:
            return path
        for _ in range(SWEEPS):
            slip, relaxation = self.coefficients(path.own) - frame.held[:, None]
            slip *= self.structures.frequency[:, None]
            by_drift, by_rate, by_slip = (path.transition[..., part, :] for part in self.parts)
            rates = slip[..., None] * by_rate + relaxation[..., None] * (by_drift - by_slip)
            turn = NODES.integrate(frame.slips @ rates, frame.length)
            turn += np.eye(turn.shape[-1])
            turned = np.linalg.solve(turn, push[..., None])[..., 0]
            before, path = path, self._at_nodes(frame, frame.forward @ turn, turned, now)
            if self._over_tolerance(path.own - before.own, path.own) <= SETTLED:
                return path
        return None

    def _at_nodes(self, frame: Frame, transition: Array, push: Array, now: Covariances) -> Path:
        """With these transition matrices, and ``beta``."""
        soil = NODES.integrate(push[..., None] * frame.soil[..., None, :], frame.length) + now.soil
        pull = (soil @ frame.output[..., None])[..., 0]
        pull += 0.5 * self.filters.intensity[:, None] * push
        forced = push[..., None] * pull[..., None, :]
        own = NODES.integrate(forced + forced.swapaxes(-1, -2), frame.length) + now.own
        return Path(transition, push, pull, soil, transition @ own @ transition.swapaxes(-1, -2))

    def _over_tolerance(self, difference: Array, own: Array) -> float:
        """The largest of all structures, each beside its largest covariance."""
        error, size = (np.abs(array).max(axis=(0, 2, 3)) for array in (difference, own))
        return float((error / (self.tolerance * size + ATOL)).max())

    def _covariances(self, frame: Frame, path: Path, now: Covariances) -> Covariances:
        """At the nodes; those with the soil at the panel's end alone."""
        one, two = self.pairs
        forced = path.push[:, one, :, None] * path.pull[:, two, None, :]
        forced += path.pull[:, one, :, None] * path.push[:, two, None, :]
        both = NODES.integrate(forced, frame.length) + now.both
        both = path.transition[:, one] @ both @ path.transition[:, two].swapaxes(-1, -2)
        soil = path.transition[-1:] @ path.soil[-1:] @ frame.filters.swapaxes(-1, -2)
        return Covariances(soil, path.own, both)

    @np.errstate(under="ignore", invalid="ignore", divide="ignore")
    def coefficients(self, own: Array) -> Array:
        """``1 + c_e`` and ``k_e`` (2, ..., n, m) that the closure finds for ``X`` (..., n, 3 m, 3 m)."""
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
        """Of covariances at instants, which come first."""
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
        d_d, d_y, y_y = np.moveaxis(x.reshape(len(x), -1)[:, self.squares[:3]], 1, 0)
        z_z = self.structures.scale**2 * (d_d - 2 * d_y + y_y)
        structures = Own(u_u, v_v, z_z, *self.coefficients(x))
        rows = (len(x), -1)
        return (
            Own(*(values.reshape(rows) for values in structures)),
            Difference(*(values.reshape(rows) for values in difference)),
        )


def _check_pace(passed: float, length: float, begin: float, end: float) -> None:
    """Raise an ArithmeticError if panels advance so little in a window that too many are left."""
    if (end - begin) * WINDOW > MOST_PANELS * passed:
        raise ArithmeticError(
            f"the covariance equations need steps of {length:.2g} s at {begin:.3g} s: a structure is so "
            "weak that its plastic displacement follows at once; give it more strength, or simulate"
        )


def _diagonal(blocks: Array) -> Array:
    """Diagonals of matrices (n, m, m), as a view that can be written to (n, m)."""
    return np.einsum("nii->ni", blocks)
