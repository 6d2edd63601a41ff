"""Time steps of floors on storeys, and of links between them, for LANES independent motions; compiled.

The trapezoidal rule of `stepping`, for elements whose forces ``post d + couple z`` act on common floors.
With ``p = dd - dz``, what an element slips in a step, the step is linear: drifts move by

    ``dd = P [d', s] + g f - P_s couple p / 2``

with the drift rates ``d'`` and the element forces ``s`` at its beginning. Each law then gives its ``p``,
knowing how its own slip relieves it, and tells the others; passes go on until nothing slips any
further. For the bilinear law this is the projected Gauss-Seidel method of a complementarity problem
with a symmetric positive matrix, and converges.

A dashpot with an exponent, ``c |x|^a sign(x)`` at ``x = dd/dt``, is an element like these: a spring that
is there for a step alone, and slips by as much as makes its mean force, ``couple (dd - p) / 2``, that of
the dashpot. How stiff it is changes no answer, only the number of passes. Passes seek the least of a
convex energy, one element after the other, and converge.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import Any, NamedTuple

import numba as nb
import numpy as np
from numba.extending import overload

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.compiled import (
    OF_OVERLOADS,
    UNCOMPILED,
    called_often,
    compiled,
    entry,
    of_lane,
    smallest,
)
from stochlin.kernels.basics.lending import borrow
from stochlin.kernels.simulation.stepping import LANES, bouc_wen_middle

# OTHER and more: laws given as functions
KINDS = LINEAR, BILINEAR, SLACK, BOUC_WEN, VISCOUS, OTHER = range(6)
MOST_PASSES = 60
MOST_VISCOUS = 600  # passes, where dashpots with an exponent hold many floors fast
MOST_ROOTS = 60  # steps of Newton's method, of which four or five are the rule
NEARLY = 1e-5  # of a root, away from which Newton's method is right to its square
SOFT = 0.1  # of the stiffness with which floors resist a step: that of a dashpot's spring
HARDLY = 1e-6  # of the largest drift of a step: less of it in a dashpot with an exponent may be rounding
CLOSE = 1e-8  # of the strength of an element: where slips change by less, the next change is nothing
LEAST_SLACK = 0.01  # [m] that counts as the strength of an element with less slack
_NUMBER = nb.float64
LAW = _NUMBER(nb.int64, _NUMBER, _NUMBER, _NUMBER, _NUMBER, nb.types.Array(_NUMBER, 1, "C"))


class Elements(NamedTuple):
    """Storeys and links: the first ``n`` of the ``e`` elements are the storeys of the ``n`` floors.

    A VISCOUS one has neither ``post`` nor ``couple``, and as its own ``c`` [N (s/m)^a] and ``a``.
    """

    mass: Array  # (n,) [kg]
    damping: Array  # (n, n) [N s/m]
    drifts: Array  # (e, n): drift of each element of the displacements of the floors
    post: Array  # (e,) [N/m]
    couple: Array  # (e,) [N/m]
    strength: Array  # (e,) [m], infinite for a linear element; the slack of one that has slack
    kind: Array  # (e,)
    own: Array  # (e, k): parameters of the law

    def elastic(self) -> Array:
        """The matrix (2 n, 2 n) of displacements and velocities while all elements hold."""
        n = self.mass.size
        stiffness = (self.drifts.T * (self.post + self.couple)) @ self.drifts
        below = np.hstack([-stiffness, -self.damping]) / self.mass[:, None]
        return np.vstack([np.hstack([np.zeros((n, n)), np.eye(n)]), below])


class Steps(NamedTuple):
    """Elements in steps of one length.

    Where every lane has elements of its own, all arrays of numbers have a last axis of LANES.
    """

    dt: float
    move: Array  # (e, n + e): of drift rates and forces of elements
    push: Array  # (e,): of the forcing
    relief: Array  # (e, e): of the slips
    post: Array
    couple: Array
    strength: Array
    kind: Array
    own: Array
    lowest: Array  # (n,): whether it is the first storey of a structure
    passes: int  # at most


def steps_of(elements: Elements, dt: float) -> Steps:
    """From ``(2 M/dt + C + dt/2 K) du = 2 M v - dt B' s + dt M 1 f + dt/2 B' couple p``."""
    mass, b = np.diag(elements.mass), elements.drifts
    n = len(mass)
    floors = np.linalg.inv(b[:n])
    stiffness = (b.T * (elements.post + elements.couple)) @ b
    resisting = 2 / dt * mass + elements.damping + 0.5 * dt * stiffness
    couple, viscous = elements.couple, elements.kind == VISCOUS
    if viscous.any():
        own = np.einsum("en,nm,em->e", b, np.linalg.inv(resisting), b)
        couple = np.where(viscous, SOFT * 2 / (dt * own), couple)
        resisting += 0.5 * dt * (b.T * np.where(viscous, couple, 0.0)) @ b
    flexible = np.linalg.solve(resisting, np.eye(n))
    of_forces = dt * b @ flexible @ b.T
    return Steps(
        dt,
        np.ascontiguousarray(np.hstack([2 * b @ flexible @ mass @ floors, -of_forces])),
        dt * b @ flexible @ elements.mass,
        0.5 * of_forces * couple,
        elements.post,
        couple,
        elements.strength,
        elements.kind,
        elements.own,
        b[:n].sum(axis=1) > 0.5,
        MOST_VISCOUS if viscous.any() else MOST_PASSES,
    )


def sampled_steps(elements: Sequence[Elements], dt: float) -> Steps:
    """Of LANES elements that differ in their numbers alone, one set a lane."""
    each = [steps_of(one, dt) for one in elements]
    of_lanes = ("move", "push", "relief", "post", "couple", "strength", "own")
    columns: dict[str, Any] = {
        name: np.stack([getattr(steps, name) for steps in each], axis=-1) for name in of_lanes
    }
    return each[0]._replace(**columns)


@cache
def law_of(middles: tuple[Any, ...]) -> Any:
    """One function for elements of these laws, each given by a `law_middle`: kinds OTHER and on.

    The kernel takes it as an address: it is not compiled anew for every law.
    """
    law = _unknown
    for number, middle in enumerate(middles):
        law = _either(OTHER + number, middle, law)

    def end(kind, hyst, start, slope, half, own):
        return law(kind, hyst, start, slope, half, own)

    return end if UNCOMPILED else nb.cfunc(LAW)(end)


@compiled
def _unknown(kind, hyst, start, slope, half, own):
    return np.nan


def _either(number: int, middle: Any, others: Any) -> Any:
    @compiled
    def chosen(kind, hyst, start, slope, half, own):
        if kind == number:
            _, end = middle(hyst, start, slope, half, own)
            return end
        return others(kind, hyst, start, slope, half, own)

    return chosen


@called_often
def multiply(matrix, i, rows, out):
    """Add the products of row ``i`` of a matrix with the rows (m, LANES), four at a time."""
    m = matrix.shape[1]
    j = 0
    while j + 4 <= m:
        a, b, c, d = matrix[i, j], matrix[i, j + 1], matrix[i, j + 2], matrix[i, j + 3]
        for lane in range(LANES):
            out[i, lane] += (of_lane(a, lane) * rows[j, lane] + of_lane(b, lane) * rows[j + 1, lane]) + (
                of_lane(c, lane) * rows[j + 2, lane] + of_lane(d, lane) * rows[j + 3, lane]
            )
        j += 4
    for k in range(j, m):
        a = matrix[i, k]
        for lane in range(LANES):
            out[i, lane] += of_lane(a, lane) * rows[k, lane]


def _own(own: Any, lane: int) -> Any:
    """Parameters of the law of a lane."""
    return own if own.ndim == 1 else own[:, lane].copy()


@overload(_own, jit_options=OF_OVERLOADS)
def _own_of_lane(own, lane):
    if own.ndim == 1:
        return lambda own, lane: own
    return lambda own, lane: own[:, lane].copy()


@compiled
def _by_function(law, steps, i, z, change, slip, more):
    """`_more_slip` of a law that is no return map."""
    kind, of_all, half = steps.kind[i], steps.own[i], 0.5 * steps.dt
    for lane in range(LANES):
        g, uy = of_lane(steps.relief[i, i], lane), of_lane(steps.strength[i], lane)
        ease = 1.0 / (1.0 - g)
        rate, slope = ease / (steps.dt * uy), 2.0 * g * ease / steps.dt
        own = _own(of_all, lane)
        hyst, alone = z[i, lane] / uy, change[i, lane] - g * slip[i, lane]
        start = alone * rate + slope * hyst
        if kind == BOUC_WEN:
            _, end = bouc_wen_middle(hyst, start, slope, half, own[0], own[1], own[2])
        else:
            end = law(kind, hyst, start, slope, half, own)
        more[lane] = (alone - uy * (end - hyst)) * ease - slip[i, lane]


@compiled
def _dashpot(steps, i, change, slip, more):
    """`_more_slip` of a dashpot with an exponent.

    With ``x`` its rate, ``(1 - g) dt x + g y x^a = alone``, it slips ``dt x - y x^a``; solved for
    the one of ``x`` and ``x^a`` of which the other is a power above 1. Newton's method goes down to the
    root of this convex function from above.
    """
    for lane in range(LANES):
        g, own = of_lane(steps.relief[i, i], lane), steps.own[i]
        c, a = of_lane(own[0], lane), of_lane(own[1], lane)
        of_rate, of_force = steps.dt, 2.0 * c / of_lane(steps.couple[i], lane)
        slow = a <= 1.0
        power = 1.0 / a if slow else a
        first, second = g * of_force, (1.0 - g) * of_rate
        if not slow:
            first, second = second, first
        drift, before = change[i, lane], slip[i, lane]
        alone = drift - g * before
        size = abs(alone)
        x = 0.0
        if before != 0.0:  # as in the pass before, or in the step before
            x = abs(drift - before) / of_force if slow else abs(drift) / of_rate
        steep = x ** (power - 1.0)
        less = (first * x + second * x * steep - size) / (first + power * second * steep)
        if power * abs(less) < NEARLY * x:
            steep *= 1.0 - (power - 1.0) * less / x
            x -= less
        else:
            most = min(size / first, (size / second) ** (1.0 / power))
            x = min(x - less, most)
            for _ in range(MOST_ROOTS):
                steep = x ** (power - 1.0)
                less = (first * x + second * x * steep - size) / (first + power * second * steep)
                x = min(x - less, most)
                if not power * abs(less) > NEARLY * x:
                    break
            steep = x ** (power - 1.0)
        rate, force = (x * steep, x) if slow else (x, x * steep)
        total = of_rate * rate - of_force * force
        more[lane] = (total if alone > 0.0 else -total) - slip[i, lane]


@called_often
def _more_slip(law, steps, i, d, z, change, slip, more):
    """What element ``i`` slips beyond ``slip`` if the others stay as they are."""
    kind, relief, strength = steps.kind[i], steps.relief[i, i], steps.strength[i]
    if kind == BILINEAR:
        for lane in range(LANES):
            g, uy = of_lane(relief, lane), of_lane(strength, lane)
            ease = 1.0 / (1.0 - g)
            y = z[i, lane] + (change[i, lane] - g * slip[i, lane])
            more[lane] = (y - min(max(y, -uy), uy)) * ease - slip[i, lane]
    elif kind == SLACK:
        for lane in range(LANES):
            g, uy = of_lane(relief, lane), of_lane(strength, lane)
            ease = 1.0 / (1.0 - g)
            beyond = d[i, lane] - uy
            slack = beyond - z[i, lane]
            at_end = beyond + (change[i, lane] - g * slip[i, lane]) - g * slack
            more[lane] = min(at_end, 0.0) * ease - slack - slip[i, lane]
    elif kind == VISCOUS:
        _dashpot(steps, i, change, slip, more)
    else:
        _by_function(law, steps, i, z, change, slip, more)


@called_often
def _beyond(more, least):
    for lane in range(LANES):  # noqa: SIM110 - compiled
        if abs(more[lane]) > least:
            return True
    return False


@called_often
def _largest(change, slip, relief, most):
    """Drift of the lane that drifts most, if the element did not slip; at least ``most``."""
    for lane in range(LANES):
        most = max(most, abs(change[lane] - of_lane(relief, lane) * slip[lane]))
    return most


@called_often
def _slips(law, steps, d, z, change, slip, more):
    """All slips of a step; ``change`` are the increments of the drifts that go with them."""
    e = steps.kind.size
    widest = 0.0
    if steps.passes == MOST_VISCOUS:
        for i in range(e):
            widest = _largest(change[i], slip[i], 0.0, widest)
    for _ in range(steps.passes):
        moved = False
        for i in range(e):
            if steps.kind[i] == LINEAR:
                continue
            _more_slip(law, steps, i, d, z, change, slip, more)
            if not _beyond(more, 0.0):
                continue
            least = smallest(steps.strength[i])
            if steps.kind[i] == SLACK:
                least = max(least, LEAST_SLACK)
            elif steps.kind[i] == VISCOUS:
                least = _largest(change[i], slip[i], steps.relief[i, i], HARDLY * widest)
            moved = moved or _beyond(more, CLOSE * least)
            for lane in range(LANES):
                slip[i, lane] += more[lane]
            for k in range(e):
                a = steps.relief[k, i]
                for lane in range(LANES):
                    change[k, lane] += of_lane(a, lane) * more[lane]
        if not moved:
            return


@called_often
def _first_slips(steps, change, slip):
    """None; of dashpots with an exponent those of the step before."""
    for i in range(steps.kind.size):
        if steps.kind[i] != VISCOUS:
            for lane in range(LANES):
                slip[i, lane] = 0.0
            continue
        for k in range(steps.kind.size):
            a = steps.relief[k, i]
            for lane in range(LANES):
                change[k, lane] += of_lane(a, lane) * slip[i, lane]


@entry
def storey_block(f, owned, law, d, v, z, every, out):
    """Elements over the steps of ``f``; ``out`` (samples, e, LANES): floors, then links.

    ``d``, ``v`` and ``z`` (e, LANES): drifts, their rates and hysteretic drifts [m]. ``law`` is a
    `law_of`.
    """
    steps = borrow(owned)
    e, n = steps.kind.size, steps.lowest.size
    known, change, slip = np.empty((n + e, LANES)), np.empty((e, LANES)), np.zeros((e, LANES))
    new, twice = np.empty(LANES), 2.0 / steps.dt
    sample = 0
    for s in range(f.shape[0]):
        for i in range(n):
            for lane in range(LANES):
                known[i, lane] = v[i, lane]
        for i in range(e):
            post, couple, push = steps.post[i], steps.couple[i], steps.push[i]
            for lane in range(LANES):
                known[n + i, lane] = (
                    of_lane(post, lane) * d[i, lane] + of_lane(couple, lane) * z[i, lane]
                )
                change[i, lane] = of_lane(push, lane) * f[s, lane]
        for i in range(e):
            multiply(steps.move, i, known, change)
        _first_slips(steps, change, slip)
        _slips(law, steps, d, z, change, slip, new)
        for i in range(e):
            for lane in range(LANES):
                d[i, lane] += change[i, lane]
                v[i, lane] = twice * change[i, lane] - v[i, lane]
            if steps.kind[i] != VISCOUS:  # whose spring ends with the step
                for lane in range(LANES):
                    z[i, lane] += change[i, lane] - slip[i, lane]
        if (s + 1) % every == 0:
            _sample(steps.lowest, d, new, out, sample)
            sample += 1


@called_often
def _sample(lowest, d, total, out, sample):
    """Write the displacements of the floors, which are the drifts below them, and those of the links."""
    for i in range(d.shape[0]):
        if i >= lowest.size or lowest[i]:
            for lane in range(LANES):
                total[lane] = 0.0
        for lane in range(LANES):
            total[lane] += d[i, lane]
            out[sample, i, lane] = total[lane]
