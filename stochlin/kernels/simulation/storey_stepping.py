"""Time steps of buildings with storeys and links between them, for `LANES` independent motions.

The rule is the trapezoidal one of `stepping`, for elements (storeys and links) whose forces
``post d + couple z`` act on common floors. In one step the drift of an element increases by ``dd``, its
hysteretic drift by ``dz``, and its slip by ``p = dd - dz``. For given slips the step is linear:

    ``dd = P [d', s] + g f - P_s couple p/2``

with the drift rates ``d'`` and the element forces ``s`` at the beginning of the step, the forcing ``f``,
and the part ``P_s`` of ``P`` that belongs to ``s``. The law of each element gives its slip, if those of
the others are known, and this is repeated over the elements, in passes, until no slip changes. For the
bilinear law it is the projected Gauss-Seidel method for a complementarity problem with a symmetric
positive matrix, and converges.

A dashpot with an exponent, with the force ``c |x|^a sign(x)`` at the rate ``x = dd/dt``, is treated as a
spring that exists during one step. It slips so much that its mean force, ``couple (dd - p)/2``, is that
of the dashpot. Its stiffness has no effect on the result, only on the number of passes. The passes
minimize a convex energy, element by element, and converge.
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
    OFTEN,
    UNCOMPILED,
    called_often,
    compiled,
    entry,
    of_lane,
    smallest,
)
from stochlin.kernels.basics.systems import System
from stochlin.kernels.simulation.stepping import LANES, bouc_wen_middle

# Kinds of elements; numbers from OTHER on are laws given as functions.
KINDS = LINEAR, BILINEAR, SLACK, BOUC_WEN, VISCOUS, OTHER = range(6)
MOST_PASSES = 60  # largest number of passes of a step
MOST_VISCOUS = 600  # the same with dashpots with an exponent, whose forces can tie many floors together
MOST_ROOTS = 60  # largest number of steps of Newton's method, which mostly needs four or five
NEARLY = 1e-5  # relative change of a root after which the error of Newton's method is about its square
SOFT = 0.1  # stiffness of a dashpot's spring over that with which the floors resist a step
HARDLY = 1e-6  # drift of a dashpot, over the largest drift of the step, that may be rounding error
CLOSE = 1e-8  # change of a slip, over the strength of the element, at which the passes end
LEAST_SLACK = 0.01  # [m]: smallest strength of an element with slack for this criterion
_NUMBER = nb.float64
LAW = _NUMBER(nb.int64, _NUMBER, _NUMBER, _NUMBER, _NUMBER, nb.types.Array(_NUMBER, 1, "C"))


class Elements(NamedTuple):
    """Storeys and links: the first ``n`` of the ``e`` elements are the storeys of the ``n`` floors.

    A dashpot with an exponent (VISCOUS) has zeros in ``post`` and ``couple``, and as parameters ``own``
    its constant ``c`` [N (s/m)^a] and its exponent ``a``.
    """

    system: System  # its strength is infinite for a linear element, and the slack of a SLACK one
    kind: Array  # (e,): one of KINDS, or a larger number
    own: Array  # (e, k): parameters of the law


class Steps(NamedTuple):
    """The elements for time steps of one length, and the matrices of the module's docstring.

    If every lane has other elements, all arrays of real numbers have a last axis of `LANES`.
    """

    dt: float  # [s]
    move: Array  # (e, n + e): P, the effect of drift rates and element forces on the increments dd
    push: Array  # (e,): g, the effect of the forcing
    relief: Array  # (e, e): the effect of the slips
    post: Array
    couple: Array  # as in `Elements`; of dashpots with an exponent, that of their springs
    strength: Array
    kind: Array
    own: Array
    lowest: Array  # (n,): whether the storey is the lowest of a structure
    passes: int  # largest number of passes


def steps_of(elements: Elements, dt: float) -> Steps:
    """The elements for time steps ``dt`` [s].

    The increments ``du`` of the displacements follow from
    ``(2 M/dt + C + dt/2 K) du = 2 M v - dt B' s + dt M 1 f + dt/2 B' couple p``. The matrix ``B``
    has the extensions.
    """
    system, kind, own = elements
    mass, b, n = np.diag(system.mass), system.extensions, system.mass.size
    floors = np.linalg.inv(b[:n])
    resisting = 2 / dt * mass + system.damping + 0.5 * dt * system.stiffness
    couple, viscous = system.couple, kind == VISCOUS
    if viscous.any():
        ease = np.einsum("en,nm,em->e", b, np.linalg.inv(resisting), b)
        couple = np.where(viscous, SOFT * 2 / (dt * ease), couple)
        resisting += 0.5 * dt * (b.T * np.where(viscous, couple, 0.0)) @ b
    flexible = np.linalg.solve(resisting, np.eye(n))
    of_forces = dt * b @ flexible @ b.T
    return Steps(
        dt,
        np.ascontiguousarray(np.hstack([2 * b @ flexible @ mass @ floors, -of_forces])),
        dt * b @ flexible @ system.mass,
        0.5 * of_forces * couple,
        system.post,
        couple,
        system.strength,
        kind,
        own,
        b[:n].sum(axis=1) > 0.5,
        MOST_VISCOUS if viscous.any() else MOST_PASSES,
    )


def sampled_steps(elements: Sequence[Elements], dt: float) -> Steps:
    """Steps of `LANES` sets of elements that differ only in their properties, one for each lane."""
    each = [steps_of(one, dt) for one in elements]
    of_lanes = ("move", "push", "relief", "post", "couple", "strength", "own")
    columns: dict[str, Any] = {
        name: np.stack([getattr(steps, name) for steps in each], axis=-1) for name in of_lanes
    }
    return each[0]._replace(**columns)


@cache
def law_of(middles: tuple[Any, ...]) -> Any:
    """One function for elements with any of these laws, each given by its `law_middle`.

    The laws are those of the kinds OTHER, OTHER + 1 and so on. The result is the address of a C
    function, so that `storey_block` is not compiled again for other laws.
    """
    law = _unknown
    for number, middle in enumerate(middles):
        law = _either(OTHER + number, middle, law)

    def end(kind, hyst, start, slope, half, own):
        return law(kind, hyst, start, slope, half, own)

    return end if UNCOMPILED else nb.cfunc(LAW)(end)


@compiled
def _unknown(kind, hyst, start, slope, half, own):
    """The law of an unknown kind: NaN."""
    return np.nan


def _either(number: int, middle: Any, others: Any) -> Any:
    """The function that takes ``middle`` for the kind ``number``, and ``others`` for other kinds."""

    @compiled
    def chosen(kind, hyst, start, slope, half, own):
        if kind == number:
            _, end = middle(hyst, start, slope, half, own)
            return end
        return others(kind, hyst, start, slope, half, own)

    return chosen


@called_often
def multiply(matrix, i, rows, out):
    """Add row ``i`` of a matrix times ``rows`` (m, LANES) to ``out[i]``, four columns at a time."""
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
    """Parameters of the law in a lane."""
    return own if own.ndim == 1 else own[:, lane].copy()


@overload(_own, jit_options=OFTEN)
def _own_of_lane(own, lane):
    if own.ndim == 1:
        return lambda own, lane: own
    return lambda own, lane: own[:, lane].copy()


@compiled
def _by_function(law, steps, i, z, change, slip, more):
    """`_more_slip` for the Bouc-Wen law and for laws given as functions."""
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
    """`_more_slip` for a dashpot with an exponent.

    Its rate ``x`` solves ``(1 - g) dt x + g y x^a = alone``, with ``y = 2 c/couple``, the relief ``g``
    by its own slip, and the increment ``alone`` of the drift without slip. It slips by
    ``dt x - y x^a``. The unknown is the one of ``x`` and ``x^a`` of which the other is a power of at
    least 1; Newton's method then approaches the root of a convex function from above.
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
        if before != 0.0:  # start from the root of the pass before, or of the step before
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
    """Write to ``more`` (LANES,) how much element ``i`` slips beyond ``slip``, for given other slips.

    The element is not a bilinear one.
    """
    kind, relief, strength = steps.kind[i], steps.relief[i, i], steps.strength[i]
    if kind == SLACK:
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
    """Whether the slip changes by more than ``least`` in any lane."""
    for lane in range(LANES):  # noqa: SIM110 - compiled
        if abs(more[lane]) > least:
            return True
    return False


@called_often
def _largest(change, slip, relief, most):
    """Largest drift increment of any lane, if the element did not slip; at least ``most``."""
    for lane in range(LANES):
        most = max(most, abs(change[lane] - of_lane(relief, lane) * slip[lane]))
    return most


@called_often
def _widest(steps, change, slip):
    """Largest drift increment of all elements; 0 if no dashpot needs it."""
    widest = 0.0
    if steps.passes == MOST_VISCOUS:
        for i in range(steps.kind.size):
            widest = _largest(change[i], slip[i], 0.0, widest)
    return widest


@called_often
def _slips(law, steps, d, z, change, slip, more):
    """Find the slips (e, LANES) of a step in passes over all elements.

    ``change`` (e, LANES), the increments of the drifts, is updated with the slips.
    """
    e, widest = steps.kind.size, _widest(steps, change, slip)
    for _ in range(steps.passes):
        moved = False
        for i in range(e):
            if steps.kind[i] == LINEAR:
                continue
            relief, strength = steps.relief[i, i], steps.strength[i]
            if steps.kind[i] == BILINEAR:  # not in a function, for which references would be counted
                for lane in range(LANES):
                    g, uy = of_lane(relief, lane), of_lane(strength, lane)
                    ease = 1.0 / (1.0 - g)
                    y = z[i, lane] + (change[i, lane] - g * slip[i, lane])
                    more[lane] = (y - min(max(y, -uy), uy)) * ease - slip[i, lane]
            else:
                _more_slip(law, steps, i, d, z, change, slip, more)
            if not _beyond(more, 0.0):
                continue
            least = max(smallest(strength), LEAST_SLACK if steps.kind[i] == SLACK else 0.0)
            if steps.kind[i] == VISCOUS:
                least = _largest(change[i], slip[i], relief, HARDLY * widest)
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
    """Set the slips at the start of the passes: zero; for dashpots with an exponent, the last ones."""
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
def storey_block(f, steps, law, d, v, z, every, out, first):
    """Steps of the elements ``steps``, a `Steps`, under the forcing ``f`` (steps, LANES).

    ``d``, ``v`` and ``z`` (e, LANES) are the drifts [m], their rates [m/s] and the hysteretic drifts
    [m]; they are updated. The displacements of the floors and the drifts of the links after every
    ``every``-th step [m] are written to the rows of ``out`` (samples, e or more, LANES) from ``first``
    on. ``law`` is the result of `law_of`.
    """
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
            if steps.kind[i] != VISCOUS:  # the spring of a dashpot exists for one step only
                for lane in range(LANES):
                    z[i, lane] += change[i, lane] - slip[i, lane]
        if (s + 1) % every == 0:
            _sample(steps.lowest, d, new, out[sample], first)
            sample += 1


@called_often
def _sample(lowest, d, total, out, first):
    """Write the displacements of the floors, sums of the drifts below them, and the drifts of links."""
    for i in range(d.shape[0]):
        if i >= lowest.size or lowest[i]:
            for lane in range(LANES):
                total[lane] = 0.0
        for lane in range(LANES):
            total[lane] += d[i, lane]
            out[first + i, lane] = total[lane]
