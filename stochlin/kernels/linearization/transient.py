"""Covariance of linear and linearized structures over time, from rest under a modulated ground.

The forcing is ``f(t) = o(t) q + d(t) e`` with unit white noise ``e`` and the stationary states ``q`` of
the ground filter ``q' = F q + n e``. ``P`` is the covariance of ``q``. The output ``o(t), d(t)`` is a
constant row times the envelope. The structures follow ``x' = A x + b f``. With ``C = E[x q']``,
``X = E[x x']`` of one structure, ``X12 = E[x1 x2']`` of a pair, and ``g = P o + d n``,

    C'   = A C + C F' + b g'
    X'   = A X + X A' + b (C o)' + (C o) b' + d^2 b b'
    X12' = A1 X12 + X12 A2' + b1 (C2 o)' + (C1 o) b2' + d^2 b1 b2'.

On white noise without a filter only ``d`` remains. ``A`` of a yielding structure depends on ``X``
through its coefficients. A structure has one or more storeys; an oscillator has one.
The states are, storey by storey, ``d/s``, ``d'/(s w)`` and ``y/s``, with the storey drift ``d``, the
slip ``y = d - uy z`` as in `covariance`, and a scale ``s`` for each storey that makes them of order
one. Structures with the same number of storeys are computed together.

Time is divided into panels. Within a panel, with ``t`` from its start, the transition matrix ``Phi`` of
a structure, ``Phi' = A Phi``, reduces the equations to integrals over vectors:

    beta = Phi^-1 b,      D = C(0) + Int beta (exp(-F t) g)' dt,    gamma = D exp(F' t) o + d^2 beta / 2
    C = Phi D exp(F' t),  X12 = Phi1 [X12(0) + Int (beta1 gamma2' + gamma1 beta2') dt] Phi2'.

The integrals are those of polynomials through the
Gauss-Lobatto nodes of the panel. For elastic structures ``Phi = exp(A t)``. For yielding ones ``A*`` has
constant coefficients, those at an earlier time, and ``Phi = exp(A* t) V`` with
``V' = exp(-A* t) (A - A*) Phi``; its inverse is ``U exp(-A* t)`` with
``U' = -U exp(-A* t) (A - A*) exp(A* t)``; of one storey, ``V`` is inverted. The coefficients, ``V`` and
``U`` at all nodes of a panel are found together by Picard iteration.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.collocation import Nodes, exponentials, lobatto
from stochlin.kernels.basics.parallel import Progress

RTOL, ATOL = 1e-9, 1e-12  # tolerances of covariances, in units of the elastic stationary response
RTOL_YIELDING = 1e-7  # with yielding structures, for which linearization is itself an approximation
LEAST_Z = 0.04  # sz over the yield displacement below which closures are those of this sz
LEAST_RATE = 1e-12  # sv over w times the yield displacement, to which it is limited
LARGEST_CORRELATION = 1 - 1e-12  # to which corr(v, z) is limited
# Nodes of a panel: fewer with storeys, whose larger matrices then remain in the processor's cache.
NODES, NODES_OF_STOREYS = lobatto(24), lobatto(16)
FIRST = 5.0  # length of the first panel, as phase of the fastest oscillation [rad]
SHORTER, LONGER = 0.4, 2.0  # smallest and largest ratio of the lengths of successive panels
MARGIN, WORTH_IT = 0.9, 1.25  # safety factor on the length; factor from which panels are lengthened
WINDOW, MOST_PANELS = 100, 1e5  # panels between checks of the progress; largest number in a run
SWEEPS, SETTLED = 15, 0.1  # Picard iterations of a panel; change by the last one, in tolerances
HELD = 0.3  # change of a coefficient, times the panel's length, from which A* is computed anew
AT_ONCE = 64  # times whose moments are computed together
ROUNDING = 1e-9  # relative variance of the difference below which it is rounding error


class StoreyChains(NamedTuple):
    """Structures of ``m`` storeys or modes, ``d'' = -damping d' - stiffness d + coupling y + shaken f``.

    Of storeys, the ground accelerates only the first one; of modes all.
    """

    frequency: Array  # (n,) w [rad/s], the scale of velocities
    stiffness: Array  # (n, m, m) [1/s^2]
    damping: Array  # (n, m, m) [1/s]
    coupling: Array  # (n, m, m) [1/s^2], 0 where elastic
    yield_displacement: Array  # (n, m) [m], infinite where elastic
    limit: Array  # (n, m) [m], drift at which the structure falls, infinite if it cannot
    scale: Array  # (n, m) [m]
    shaken: Array  # (n, m): share of the forcing that acts on each of them
    seen: Array  # (n, h, m): weights of the drifts in the ``h`` displacements of the results


class Filters(NamedTuple):
    """The ground filter of each structure, with states over their standard deviations.

    Times the envelope at a time, the rows are the output ``o, d`` and its ``g``.
    Where all structures have the same filter, it stands there once, ``n`` = 1.
    """

    matrix: Array  # (n, k, k): F [1/s]
    output: Array  # (n, k): of o [m/s^2]
    ground_push: Array  # (n, k): of g [m/s^2]
    direct: Array  # (n,): of d [m/s^1.5]


class Own(NamedTuple):
    """Second moments and coefficients of the structures over time, structure by structure."""

    displacement: Array  # (times, n h) variance [m^2]
    velocity: Array  # (times, n h) variance [m^2/s^2]
    z: Array  # (times, all storeys) variance of uy z of the storeys [m^2]
    slip: Array  # (times, all storeys) 1 + c_e
    relaxation: Array  # (times, all storeys) k_e [1/s]
    means: Array  # (times, states, all storeys) of the further states of the laws


class Difference(NamedTuple):
    """Second moments of the differences ``d = u_1 - u_2`` over time, each (times, pairs h)."""

    d_d: Array  # [m^2]
    d_v: Array  # [m^2/s], E[d d']
    v_v: Array  # [m^2/s^2]
    product: Array  # E[u_1 u_2] [m^2]


class Covariances(NamedTuple):
    """The covariances at a time, or at the nodes of a panel, which are then the first dimension."""

    soil: list[Array]  # C (n, 3 m, k) of each group
    own: list[Array]  # X (n, 3 m, 3 m) of each group
    both: Array  # X12 (p, 3 m, 3 m)
    means: Array  # (states, y) of the further states of all yielding storeys


class PanelMatrices(NamedTuple):
    """Matrix exponentials at the nodes, the same for all panels of one length with the same ``A*``."""

    length: float  # of the panel [s]
    held: Array  # (2, n, m) 1 + c_e and k_e of A*
    forward: Array  # (q, n, 3 m, 3 m) exp(A* t)
    slips: Array  # (q, n, 3 m, m) columns of exp(-A* t) that belong to the slips
    push: Array  # (q, n, 3 m) exp(-A* t) b
    soil: Array  # (q, n, k) exp(-F t) g without the envelope
    output: Array  # (q, n, k) exp(F' t) o without the envelope
    filters: Array  # (n, k, k) exp(F t) at the end of the panel


class GroundMotion(NamedTuple):
    """The motion of the ground at the nodes of a panel."""

    soil: Array  # (q, n, k) exp(-F t) g
    output: Array  # (q, n, k) exp(F' t) o
    half_white: Array  # (q, n) d^2 / 2


class Path(NamedTuple):
    """The matrices of the module's docstring for the structures of a group at the nodes of a panel."""

    transition: Array  # Phi (q, n, 3 m, 3 m)
    inverse: Array  # U (q, n, 3 m, 3 m)
    push: Array  # beta (q, n, 3 m)
    pull: Array  # gamma (q, n, 3 m)
    soil: Array  # D (q, n, 3 m, k)
    half: Array  # Phi^-1 X Phi'^-1 from the left by Phi (q, n, 3 m, 3 m)
    squares: Array  # (6, q, n, m) the moments in X that give those of z

    def own(self) -> Array:
        """``X`` (q, n, 3 m, 3 m)."""
        covariances: Array = self.half @ self.transition.swapaxes(-1, -2)
        return covariances

    def soil_at_end(self, frame: PanelMatrices) -> Array:
        """``C`` (n, 3 m, k) at the end of the panel."""
        covariances: Array = self.transition[-1] @ self.soil[-1] @ frame.filters.swapaxes(-1, -2)
        return covariances


Shaking = Callable[[Array], Array]  # from times (q,) to values of the envelope (q,)


class LawsInTime(NamedTuple):
    """The laws of all yielding storeys, linearized, with the means of their further states."""

    states: int  # largest number of further states
    # From the moments (sv, sz, r) in yield displacements, (3, ..., y), and the means (states, ..., y) to
    # the coefficients (1 + c_e, k_e), (2, ..., y), and the rates of the means, (states, ..., y).
    closure: Callable[[Array, Array], tuple[Array, Array]]


class ChainEquations:
    """The equations of structures with the same number of storeys."""

    def __init__(self, structures: StoreyChains, filters: Filters, nodes: Nodes) -> None:
        self.structures, self.filters, self.nodes = structures, filters, nodes
        w, s, k = structures.frequency, structures.scale, filters.output.shape[-1]
        n, m = s.shape
        self.shapes = (n, 3 * m, k), (n, 3 * m, 3 * m)
        d, v, y = self.parts = slice(m), slice(m, 2 * m), slice(2 * m, 3 * m)
        self.squares = (d, d), (d, y), (y, y), (v, d), (v, y), (v, v)
        self.yields = np.isfinite(structures.yield_displacement)
        self.unit = (s / structures.yield_displacement)[self.yields]
        self.most = (structures.limit / s) ** 2
        self.frequency = np.broadcast_to(w[:, None], s.shape)[self.yields]
        self.seen = structures.seen * s[:, None]
        self.push = structures.shaken / (s * w[:, None])
        ratio, rate = s[:, None] / s[..., None], w[:, None, None]
        self.matrix = np.zeros((n, 3 * m, 3 * m))
        _diagonal(self.matrix[:, d, v])[...] = w[:, None]
        self.matrix[:, v, d] = -structures.stiffness * ratio / rate
        self.matrix[:, v, v] = -structures.damping * ratio
        self.matrix[:, v, y] = structures.coupling * ratio / rate

    def fastest(self) -> float:
        """Upper bound of the rates of all structures and filters [1/s]."""
        structures = np.sqrt(np.abs(self.structures.stiffness).sum(axis=-1).max())
        return float(max(structures, np.abs(self.filters.matrix).sum(axis=-1).max(initial=0)))

    def frame(self, length: float, held: Array, old: PanelMatrices | None) -> PanelMatrices:
        """The old frame if its length and coefficients are still valid, else a new one for ``held``."""
        w, d, v, y = self.structures.frequency, *self.parts
        if old is not None and old.length == length:
            slip, relaxation = np.abs(held - old.held)
            if max((slip * w[:, None]).max(), relaxation.max()) * length <= HELD:
                return old
        slip, relaxation = held
        a, f = self.matrix.copy(), self.filters
        _diagonal(a[:, y, d])[...], _diagonal(a[:, y, y])[...] = relaxation, -relaxation
        _diagonal(a[:, y, v])[...] = slip * w[:, None]
        times = length * self.nodes.at[:, None, None, None]
        back, soil = exponentials(-a * times), exponentials(f.matrix * times)
        return PanelMatrices(
            length,
            held,
            exponentials(a * times),
            np.ascontiguousarray(back[..., y]),
            (back[..., v] @ self.push[..., None])[..., 0],
            (exponentials(-f.matrix * times) @ f.ground_push[..., None])[..., 0],
            (f.output[:, None] @ soil)[..., 0, :],
            soil[-1],
        )

    def ground_motion(self, frame: PanelMatrices, envelope: Array) -> GroundMotion:
        """The motion of the ground in a panel with these values (q,) of the envelope at its nodes."""
        at_nodes, direct = envelope[:, None, None], envelope[:, None] * self.filters.direct
        return GroundMotion(at_nodes * frame.soil, at_nodes * frame.output, 0.5 * direct**2)

    def first(self, frame: PanelMatrices, ground: GroundMotion, soil: Array, own: Array) -> Path:
        """The path from covariances ``C`` and ``X`` on with the coefficients of the frame."""
        identity = np.broadcast_to(np.eye(frame.forward.shape[-1]), frame.forward.shape)
        return self._at_nodes(frame, ground, frame.forward, identity, frame.push, soil, own)

    def next(
        self,
        frame: PanelMatrices,
        ground: GroundMotion,
        path: Path,
        held: Array,
        soil: Array,
        own: Array,
    ) -> Path:
        """The path with other coefficients ``held`` (2, q, n, m) than that of the last iteration."""
        slip, relaxation = held - frame.held[:, None]
        slip = slip * self.structures.frequency[:, None]

        def rates(transition: Array) -> Array:
            """Rates of the slips by the difference of the coefficients."""
            by_drift, by_rate, by_slip = (transition[..., part, :] for part in self.parts)
            slip_rates: Array = by_drift - by_slip
            slip_rates *= relaxation[..., None]
            slip_rates += slip[..., None] * by_rate
            return slip_rates

        identity = np.eye(frame.forward.shape[-1])
        turn = self.nodes.integrate(frame.slips @ rates(path.transition), frame.length) + identity
        push = frame.push[..., None]
        if self.structures.scale.shape[1] == 1:  # matrices so small are solved with faster
            inverse, push = path.inverse, np.linalg.solve(turn, push)
        else:
            back = (path.inverse @ frame.slips) @ rates(frame.forward)
            inverse = identity - self.nodes.integrate(back, frame.length)
            push = inverse @ push
        return self._at_nodes(frame, ground, frame.forward @ turn, inverse, push[..., 0], soil, own)

    def _at_nodes(
        self,
        frame: PanelMatrices,
        ground: GroundMotion,
        transition: Array,
        inverse: Array,
        push: Array,
        soil: Array,
        own: Array,
    ) -> Path:
        """The path with ``Phi``, ``U`` and ``beta``, which is ``push``."""
        soil = self.nodes.integrate(push[..., None] * ground.soil[..., None, :], frame.length) + soil
        pull = (soil @ ground.output[..., None])[..., 0]
        pull += ground.half_white[..., None] * push
        forced = push[..., None] * pull[..., None, :]
        forced += forced.swapaxes(-1, -2).copy()
        half = transition @ (self.nodes.integrate(forced, frame.length) + own)
        squares = [
            np.einsum("qnij,qnij->qni", half[..., i, :], transition[..., j, :]) for i, j in self.squares
        ]
        return Path(transition, inverse, push, pull, soil, half, np.stack(squares))

    def squares_of(self, own: Array) -> Array:
        """The moments (6, ..., n, m) in ``X`` (..., n, 3 m, 3 m) that give those of z."""
        return np.stack([np.einsum("...ii->...i", own[..., i, j]) for i, j in self.squares])

    def seen_in(self, own: Array) -> tuple[Array, Array, Array]:
        """``E[u u]``, ``E[u u']`` and ``E[u' u']`` (..., n, h) of the displacements, in ``X``."""
        w, (d, v, _) = self.structures.frequency[:, None], self.parts
        return (
            _weighted(self.seen, own[..., d, d], self.seen),
            w * _weighted(self.seen, own[..., d, v], self.seen),
            w**2 * _weighted(self.seen, own[..., v, v], self.seen),
        )

    def latent(self, squares: Array) -> Array:
        """``(sv, sz, r)`` (3, ..., y) of the yielding storeys."""
        d_d, d_y, y_y, v_d, v_y, v_v = squares[..., self.yields]
        z_z, v_z = d_d - 2 * d_y + y_y, v_d - v_y
        sz = np.maximum(np.sqrt(np.maximum(z_z, 0)), LEAST_Z / self.unit)
        sv = np.maximum(np.sqrt(np.maximum(v_v, 0)), LEAST_RATE / self.unit)
        r = np.clip(v_z / (sv * sz), -LARGEST_CORRELATION, LARGEST_CORRELATION)
        return np.stack([sv * self.unit * self.frequency, sz * self.unit, r])


class Transient:
    """The equations of all structures and pairs; ``laws`` is None if all structures are elastic.

    In ``pairs`` (2, p), the numbers of structures are counted over all groups; the first of a pair is
    in the first group, and the second in the last one, which may be the same.
    """

    def __init__(
        self,
        groups: Sequence[ChainEquations],
        pairs: Array,
        laws: LawsInTime | None,
        envelope: Shaking,
    ) -> None:
        self.groups, self.laws, self.envelope = groups, laws, envelope
        self.nodes = groups[0].nodes
        before = sum(group.shapes[0][0] for group in groups[:-1])
        self.pairs = pairs[0], pairs[1] - before
        self.tolerance = RTOL if laws is None else RTOL_YIELDING
        self.yields = np.concatenate([group.yields.ravel() for group in groups])

    def solve(
        self, times: Array, kinks: Sequence[float] = (), progress: Progress | None = None
    ) -> tuple[Own, Difference]:
        """Moments at increasing ``times`` from 0 on, from rest at 0.

        Panels end at ``kinks``, the times at which the envelope is not smooth. ``progress`` is called
        with the share of the time that is done. An ArithmeticError is raised if panels become too short.
        """
        ends = (*sorted({kink for kink in kinks if 0 < kink < times[-1]}), times[-1])
        _, own, both, means = self._at_rest()
        seen = [Covariances([], [x[None] for x in own], both[None], means[None])]
        reached, moments = 1, []
        for begin, end, over in self._panels(ends):
            self._check_standing(over.own, end)
            until = int(np.searchsorted(times, end, side="right"))
            shares = (times[reached:until] - begin) / (end - begin)
            own = [self.nodes.interpolate(x, shares) for x in over.own]
            both, means = (self.nodes.interpolate(x, shares) for x in (over.both, over.means))
            seen.append(Covariances([], own, both, means))
            reached = until
            if progress is not None:
                progress(float(end / times[-1]))
            if sum(len(part.both) for part in seen) >= AT_ONCE or until == times.size:
                owns = zip(*(part.own for part in seen), strict=True)
                others = zip(*((part.both, part.means) for part in seen), strict=True)
                both, means = (np.concatenate(parts) for parts in others)
                moments.append(self._moments([*map(np.concatenate, owns)], both, means))
                seen = []
        structures, pairs = zip(*moments, strict=True)
        return (
            Own(*(np.concatenate(column) for column in zip(*structures, strict=True))),
            Difference(*(np.concatenate(column) for column in zip(*pairs, strict=True))),
        )

    def _check_standing(self, own: Sequence[Array], end: float) -> None:
        """Raise an ArithmeticError if drifts deviate so much that structures fall."""
        for group, x in zip(self.groups, own, strict=True):
            drift = _diagonal(x[-1])[:, group.parts[0]]
            if (drift > group.most).any():
                raise ArithmeticError(
                    "the linearized displacement of a structure exceeds the one at which it falls, at "
                    f"{end:.3g} s, since its stiffness after yielding is negative; give it more "
                    "hardening, or simulate"
                )

    def _at_rest(self) -> Covariances:
        """Covariances at rest, all zero."""
        soil, own = ([np.zeros(group.shapes[n]) for group in self.groups] for n in (0, 1))
        both = np.zeros((self.pairs[0].size, len(own[0][0]), len(own[-1][0])))
        states = 0 if self.laws is None else self.laws.states
        return Covariances(soil, own, both, np.zeros((states, int(self.yields.sum()))))

    def _panels(self, ends: Sequence[float]) -> Iterator[tuple[float, float, Covariances]]:
        """Start, end and covariances of successive panels, which also end at each of ``ends``.

        Their length is adapted to the tolerance, by the last terms of the Legendre series.
        """
        fastest = max(group.fastest() for group in self.groups)
        begin, length, now = 0.0, FIRST / fastest, self._at_rest()
        frames: Sequence[PanelMatrices] = ()
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
                frames = self._frames(length, now, frames)
                envelope = self.envelope(begin + length * self.nodes.at)
                paths, means = self._paths(frames, envelope, now)
                error = np.inf
                if paths:
                    own = [path.own() for path in paths]
                    error = self._over_tolerance(map(self.nodes.last_terms, own), own, (0, 2, 3))
                factor = MARGIN * max(error, ATOL) ** (-1 / self.nodes.at.size)
                if not error <= 1:
                    length, left = length * max(SHORTER, factor), 0
                    continue
                left -= 1
                both = self._pairs(paths, length, now.both)
                until = begin + length if left else end
                yield begin, until, Covariances([], own, both, means)
                soil = [path.soil_at_end(frame) for path, frame in zip(paths, frames, strict=True)]
                begin, now = until, Covariances(soil, [x[-1] for x in own], both[-1], means[-1])
                if factor > WORTH_IT:
                    length, left = length * min(factor, LONGER), 0

    def _frames(
        self, length: float, now: Covariances, old: Sequence[PanelMatrices]
    ) -> Sequence[PanelMatrices]:
        """Frames of all groups for a panel of this length, from ``now`` and those of the last one."""
        squares = [group.squares_of(x) for group, x in zip(self.groups, now.own, strict=True)]
        before: Sequence[PanelMatrices | None] = old or [None for _ in self.groups]
        parts = zip(self.groups, self.coefficients(squares, now.means)[0], before, strict=True)
        return [group.frame(length, held, frame) for group, held, frame in parts]

    @np.errstate(over="ignore", invalid="ignore")  # too long a panel may overflow, and is repeated
    def _paths(
        self, frames: Sequence[PanelMatrices], envelope: Array, now: Covariances
    ) -> tuple[Sequence[Path], Array]:
        """All structures over a panel from ``now`` on, none if the iteration does not converge.

        Beside them stand the means of the further states at the nodes.
        """
        grounds = [
            group.ground_motion(frame, envelope)
            for group, frame in zip(self.groups, frames, strict=True)
        ]
        parts = [*zip(self.groups, frames, grounds, now.soil, now.own, strict=True)]
        paths = [group.first(frame, ground, *begin) for group, frame, ground, *begin in parts]
        means = np.broadcast_to(now.means, (self.nodes.at.size, *now.means.shape))
        if self.laws is None:
            return paths, means
        for _ in range(SWEEPS):
            before, (held, rates) = paths, self.coefficients([path.squares for path in paths], means)
            means = self.nodes.integrate(rates, frames[0].length) + now.means
            try:
                paths = [
                    group.next(frame, ground, path, own, *begin)
                    for (group, frame, ground, *begin), path, own in zip(
                        parts, before, held, strict=True
                    )
                ]
            except np.linalg.LinAlgError:  # they have run away so far that V is singular by rounding
                break
            squares = [path.squares for path in paths]
            change = (newer - path.squares for newer, path in zip(squares, before, strict=True))
            if self._over_tolerance(change, squares, (0, 1, 3)) <= SETTLED:
                return paths, means
        return (), means

    def _over_tolerance(
        self, differences: Iterable[Array], moments: Iterable[Array], axes: tuple[int, ...]
    ) -> float:
        """Largest difference over its tolerance, which is relative to each structure's moments.

        ``axes`` are those of the arrays that are not over structures.
        """
        ratios = []
        for both in zip(differences, moments, strict=True):
            error, size = (np.abs(array).max(axis=axes) for array in both)
            ratios.append((error / (self.tolerance * size + ATOL)).max())
        return float(np.max(ratios))

    def _pairs(self, paths: Sequence[Path], length: float, both: Array) -> Array:
        """``X12`` of all pairs at the nodes, from ``both`` at the start of the panel on."""
        (i, j), first, second = self.pairs, paths[0], paths[-1]
        forced = first.push[:, i, :, None] * second.pull[:, j, None, :]
        forced += first.pull[:, i, :, None] * second.push[:, j, None, :]
        both = self.nodes.integrate(forced, length) + both
        covariances: Array = first.transition[:, i] @ both @ second.transition[:, j].swapaxes(-1, -2)
        return covariances

    @np.errstate(all="ignore")
    def coefficients(self, squares: Sequence[Array], means: Array) -> tuple[Sequence[Array], Array]:
        """``1 + c_e`` and ``k_e`` (2, ..., n, m) of each group by the laws, for `squares_of` it.

        Beside them stand the rates (..., states, y) of the ``means`` of the further states.
        """
        values = [np.zeros((2, *moments.shape[1:])) for moments in squares]
        if self.laws is None:
            return values, np.zeros_like(means)
        parts = [group.latent(moments) for group, moments in zip(self.groups, squares, strict=True)]
        latent = np.concatenate(parts, axis=-1)
        coefficients, rates = self.laws.closure(latent, np.moveaxis(means, -2, 0))
        ends = np.cumsum([group.unit.size for group in self.groups])
        for group, value, of_group in zip(
            self.groups, values, np.split(coefficients, ends[:-1], axis=-1), strict=True
        ):
            value[..., group.yields] = of_group
        return values, np.moveaxis(rates, 0, -2)

    def _moments(self, own: Sequence[Array], both: Array, means: Array) -> tuple[Own, Difference]:
        """Moments from ``X`` and ``X12`` and the means of the states, whose first dimension is time."""
        squares = [group.squares_of(x) for group, x in zip(self.groups, own, strict=True)]
        held, _ = self.coefficients(squares, means)
        sums = [group.seen_in(x) for group, x in zip(self.groups, own, strict=True)]
        structures = [
            (u_u, v_v, group.structures.scale**2 * (d_d - 2 * d_y + y_y), *coefficients)
            for group, (u_u, _, v_v), (d_d, d_y, y_y, *_), coefficients in zip(
                self.groups, sums, squares, held, strict=True
            )
        ]
        rows = (len(both), -1)
        u_u, v_v, z_z, slip, relaxation = (
            np.concatenate([part.reshape(rows) for part in parts], axis=1)
            for parts in zip(*structures, strict=True)
        )
        of_all = np.zeros((*means.shape[:-1], self.yields.size))
        of_all[..., self.yields] = means
        difference = self._difference(sums[0], sums[-1], both)
        moments = Own(u_u, v_v, z_z, slip, relaxation, of_all)
        return moments, Difference(*(part.reshape(rows) for part in difference))

    def _difference(
        self, first: Sequence[Array], second: Sequence[Array], both: Array
    ) -> tuple[Array, Array, Array, Array]:
        """Moments of ``u_1 - u_2`` (times, p, h), from those of the structures of each group."""
        (i, j), left, right = self.pairs, self.groups[0], self.groups[-1]
        seen, with_seen = left.seen[i], right.seen[j]
        rate, other = (
            group.structures.frequency[which, None] for group, which in ((left, i), (right, j))
        )
        (d_1, v_1, _), (d_2, v_2, _) = left.parts, right.parts
        product = _weighted(seen, both[..., d_1, d_2], with_seen)
        crossed = other * _weighted(seen, both[..., d_1, v_2], with_seen)
        crossed += rate * _weighted(seen, both[..., v_1, d_2], with_seen)
        velocities = rate * other * _weighted(seen, both[..., v_1, v_2], with_seen)
        squares, turning, moving = (a[:, i] + b[:, j] for a, b in zip(first, second, strict=True))
        d_d = squares - 2 * product
        d_d = np.where(d_d > ROUNDING * squares, d_d, 0.0)
        return d_d, turning - crossed, moving - 2 * velocities, product


def _weighted(left: Array, blocks: Array, right: Array) -> Array:
    """Covariances of weighted sums of drifts, from blocks of covariances of the drifts."""
    covariances: Array = ((left @ blocks) * right).sum(axis=-1)
    return covariances


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
