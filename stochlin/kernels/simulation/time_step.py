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
from typing import Any, NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.compiled import called_often, compiled, entry, of_lane
from stochlin.kernels.basics.systems import System
from stochlin.kernels.simulation.laws import BILINEAR, LINEAR, SLACK, VISCOUS, advance
from stochlin.kernels.simulation.stepping import LANES

MOST_PASSES = 60  # largest number of passes of a step
MOST_VISCOUS = 600  # the same with dashpots with an exponent, whose forces can tie many floors together
MOST_ROOTS = 60  # largest number of steps of Newton's method, which mostly needs four or five
NEARLY = 1e-5  # relative change of a root after which the error of Newton's method is about its square
SOFT = 0.1  # stiffness of a dashpot's spring over that with which the floors resist a step
HARDLY = 1e-6  # drift of a dashpot, over the largest drift of the step, that may be rounding error
CLOSE = 1e-8  # change of a slip, over the strength of the element, at which the passes end
CLOSE_BY_LAW = 1e-5  # the same for laws with rates: drifts then change by less than 1e-7 of their size
LEAST_SLACK = 0.01  # [m]: smallest strength of an element with slack for this criterion


class Elements(NamedTuple):
    """Storeys and links: the first ``n`` of the ``e`` elements are the storeys of the ``n`` floors.

    A dashpot with an exponent (VISCOUS) has zeros in ``post`` and ``couple``, and as parameters ``own``
    its constant ``c`` [N (s/m)^a] and its exponent ``a``.
    """

    system: System  # its strength is infinite for a linear element, and the slack of a SLACK one
    kind: Array  # (e,): one of `laws.KINDS`, or a larger number
    own: Array  # (e, k): parameters of the law


class Work(NamedTuple):
    """Arrays for work with one element in one step."""

    rate: Array  # (LANES,) of the extension, over the yield extension [1/s]
    states: Array  # (1, LANES) at the beginning of the step
    new_states: Array  # (1, LANES) at its end
    more: Array  # (LANES,): change of the slip in a pass [m]
    least: Array  # (e, LANES): the change at which the passes of a lane end [m]
    widest: Array  # (LANES,): largest drift increment of all elements [m]
    moving: Array  # (LANES,): 1 if the passes of the lane go on, else 0; no lane depends on another
    still: Array  # (LANES,): the same for the next pass


class Steps(NamedTuple):
    """The elements for time steps of one length, and the matrices of the module's docstring.

    If every lane has other elements, all arrays of real numbers have a last axis of `LANES`; the
    parameters of laws always have it.
    """

    dt: float  # [s]
    move: Array  # (e, n + e): P, the effect of drift rates and element forces on the increments dd
    push: Array  # (e,): g, the effect of the forcing
    relief: Array  # (e, e): the effect of the slips
    post: Array
    couple: Array  # as in `Elements`; of dashpots with an exponent, that of their springs
    strength: Array
    kind: Array
    own: Array  # (e, k, LANES)
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
        np.repeat(own[..., None], LANES, axis=2),
        b[:n].sum(axis=1) > 0.5,
        MOST_VISCOUS if viscous.any() else MOST_PASSES,
    )


def sampled_steps(elements: Sequence[Elements], dt: float) -> Steps:
    """Steps of `LANES` sets of elements that differ only in their properties, one for each lane."""
    each = [steps_of(one, dt) for one in elements]
    of_lanes = ("move", "push", "relief", "post", "couple", "strength")
    columns: dict[str, Any] = {
        name: np.stack([getattr(steps, name) for steps in each], axis=-1) for name in of_lanes
    }
    own = np.stack([one.own for one in elements], axis=-1)
    return each[0]._replace(**columns, own=own)


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


@compiled
def _by_law(law, steps, i, z, change, slip, work, more):
    """Write `_more_slip` of an element whose law has rates to ``more``.

    The slip that belongs to the increment of the drift changes that increment, by ``g``. With the share
    of the increment that slips for a derivative, the next slip is that of Newton's method.
    """
    rate, before, new = work.rate, work.states, work.new_states
    of_strength, own = steps.strength[i], steps.own[i]
    for lane in range(LANES):
        uy = of_lane(of_strength, lane)
        rate[lane] = change[i, lane] / (steps.dt * uy)
        before[0, lane] = z[i, lane] / uy
    advance(law, steps.kind[i], rate, before, own, steps.dt, new)
    relief = steps.relief[i, i]
    for lane in range(LANES):
        g, uy = of_lane(relief, lane), of_lane(of_strength, lane)
        moved = change[i, lane]
        slipped = moved - uy * (new[0, lane] - before[0, lane])
        share = min(max(slipped / moved if moved != 0.0 else 0.0, 0.0), 1.0)
        more[lane] = (slipped - slip[i, lane]) / (1.0 - g * share)


@compiled
def _dashpot(steps, i, change, slip, more):
    """Write `_more_slip` of a dashpot with an exponent to ``more``.

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
def _more_slip(law, steps, i, d, z, change, slip, work, moving):
    """Find how much element ``i``, not a bilinear one, slips beyond ``slip`` for given other slips.

    It is written to ``work.more``, and is zero where ``moving`` is.
    """
    kind, relief, strength, more = steps.kind[i], steps.relief[i, i], steps.strength[i], work.more
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
        for lane in range(LANES):
            alone = abs(change[i, lane] - of_lane(relief, lane) * slip[i, lane])
            work.least[i, lane] = CLOSE * max(HARDLY * work.widest[lane], alone)
    else:
        _by_law(law, steps, i, z, change, slip, work, more)
    for lane in range(LANES):
        more[lane] *= moving[lane]


@called_often
def _widest(steps, change, widest):
    """Write the largest drift increment of all elements to ``widest``, if a dashpot needs it."""
    if steps.passes == MOST_VISCOUS:
        for lane in range(LANES):
            widest[lane] = 0.0
        for i in range(steps.kind.size):
            for lane in range(LANES):
                widest[lane] = max(widest[lane], abs(change[i, lane]))


@called_often
def _any(row):
    """Whether a number of the row is not zero."""
    for lane in range(LANES):  # noqa: SIM110 - compiled
        if row[lane] != 0.0:
            return True
    return False


@called_often
def _fill(row, value):
    """Set all lanes to a number."""
    for lane in range(LANES):
        row[lane] = value


@called_often
def _slips(law, steps, d, z, change, slip, work):
    """Find the slips (e, LANES) of a step in passes over all elements.

    ``change`` (e, LANES), the increments of the drifts, is updated with the slips.
    """
    e, more, least, moving, still = steps.kind.size, work.more, work.least, work.moving, work.still
    _widest(steps, change, work.widest)
    _fill(moving, 1.0)
    for _ in range(steps.passes):
        _fill(still, 0.0)
        for i in range(e):
            if steps.kind[i] == LINEAR:
                continue
            relief, strength = steps.relief[i, i], steps.strength[i]
            if steps.kind[i] == BILINEAR:  # not in a function, for which references would be counted
                for lane in range(LANES):
                    g, uy = of_lane(relief, lane), of_lane(strength, lane)
                    ease = 1.0 / (1.0 - g)
                    y = z[i, lane] + (change[i, lane] - g * slip[i, lane])
                    more[lane] = moving[lane] * ((y - min(max(y, -uy), uy)) * ease - slip[i, lane])
            else:
                _more_slip(law, steps, i, d, z, change, slip, work, moving)
            if not _any(more):
                continue
            for lane in range(LANES):
                beyond = 1.0 if abs(more[lane]) > least[i, lane] else 0.0
                still[lane] = max(still[lane], beyond)
            for lane in range(LANES):
                slip[i, lane] += more[lane]
            for k in range(e):
                a = steps.relief[k, i]
                for lane in range(LANES):
                    change[k, lane] += of_lane(a, lane) * more[lane]
        if not _any(still):
            return
        moving, still = still, moving


@called_often
def _tolerances(steps, least):
    """Write the changes of the slips at which the passes end to ``least`` (e, LANES)."""
    for i in range(steps.kind.size):
        close = CLOSE if steps.kind[i] <= VISCOUS else CLOSE_BY_LAW
        slack = LEAST_SLACK if steps.kind[i] == SLACK else 0.0
        for lane in range(LANES):
            least[i, lane] = close * max(of_lane(steps.strength[i], lane), slack)


@called_often
def _first_slips(steps, change, slip):
    """Set the slips at the start of the passes: zero; of dashpots and laws with rates the last ones."""
    for i in range(steps.kind.size):
        if steps.kind[i] < VISCOUS:
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
    on. ``law`` is the result of `by_number`.
    """
    e, n = steps.kind.size, steps.lowest.size
    known, change, slip = np.empty((n + e, LANES)), np.empty((e, LANES)), np.zeros((e, LANES))
    total, twice, state = np.empty(LANES), 2.0 / steps.dt, (1, LANES)
    work = Work(
        np.empty(LANES),
        np.empty(state),
        np.empty(state),
        *(np.empty(LANES), np.empty((e, LANES)), np.empty(LANES)),
        *(np.empty(LANES), np.empty(LANES)),
    )
    _tolerances(steps, work.least)
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
        _slips(law, steps, d, z, change, slip, work)
        for i in range(e):
            for lane in range(LANES):
                d[i, lane] += change[i, lane]
                v[i, lane] = twice * change[i, lane] - v[i, lane]
            if steps.kind[i] != VISCOUS:  # the spring of a dashpot exists for one step only
                for lane in range(LANES):
                    z[i, lane] += change[i, lane] - slip[i, lane]
        if (s + 1) % every == 0:
            _sample(steps.lowest, d, total, out[sample], first)
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
