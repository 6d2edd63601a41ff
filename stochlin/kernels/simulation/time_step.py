"""One time step of a `System` of masses, springs and contacts, in any number of independent motions.

Each motion is a lane: the last axis of all arrays. The rule is the trapezoidal one. With the masses
``M``, the damping ``C``, springs with the extensions ``e = E q`` and the forces
``s = post e + couple z``, the increment ``dq`` of the coordinates in a step ``dt`` is

    ``(2 M/dt + C + dt/2 K) dq = 2 M q' - dt E' s + dt M 1 f + dt/2 E' couple p - dt W' F``

with the elastic stiffness ``K``, ``q'`` and ``s`` at the beginning of the step, the mean forcing ``f``,
the slips ``p`` of the springs, which are the parts of their extensions that ``z`` does not follow, and
the mean forces ``F`` of the contacts between floors, with the penetrations ``W q - gap``.

A step first finds ``dq`` without slips and contact forces. It then passes over the springs and contacts.
The law of each gives its slip or force, if those of the others are known, and the passes are repeated
until none changes. For the bilinear law this is the projected Gauss-Seidel method for a complementarity
problem with a symmetric positive matrix, and converges.

A dashpot with an exponent, with the force ``c |x|^a sign(x)`` at the rate ``x`` of its extension, is
treated as a spring that exists during one step. It slips so much that its mean force, ``couple (de -
p)/2``, is that of the dashpot. Its stiffness has no effect on the result, only on the number of passes.
The passes minimize a convex energy, element by element, and converge.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from itertools import pairwise
from typing import Annotated, Any, NamedTuple, get_type_hints

import numpy as np

from stochlin.kernels.basics.arrays import Array, zeros_on_a_line
from stochlin.kernels.basics.compiled import called_often, compiled, entry, of_lane, variant
from stochlin.kernels.basics.rows import Rows
from stochlin.kernels.basics.systems import System
from stochlin.kernels.simulation.contacts import Contacts, solve_force
from stochlin.kernels.simulation.laws import BILINEAR, LINEAR, VISCOUS

MOST_PASSES = 60  # largest number of passes of a step
MOST_VISCOUS = 600  # the same with dashpots with an exponent, whose forces can tie many floors together
MOST_ROOTS = 60  # largest number of steps of Newton's method, which mostly needs four or five
NEARLY = 1e-5  # relative change of a root after which the error of Newton's method is about its square
SOFT = 0.1  # stiffness of a dashpot's spring over that with which the floors resist a step
HARDLY = 1e-6  # increment of a dashpot's extension, over the largest of the step, that may be rounding
CLOSE = 1e-8  # change of a slip, over the strength of the element, at which the passes end
CLOSE_BY_LAW = 1e-5  # the same for laws with rates; extensions change by less than 1e-7 of theirs
POST, COUPLE, STRENGTH, RELIEF = range(4)  # columns of `Steps.spring`
KIND, STATES, MEMORY, OWN = range(4)  # columns of `Steps.info`


class Elements(NamedTuple):
    """The masses and springs of a system, and the laws of the springs.

    A dashpot with an exponent (VISCOUS) has zeros in ``post`` and ``couple``, and as parameters ``own``
    its constant ``c`` [N (s/m)^a] and its exponent ``a``.
    """

    system: System  # its strength is infinite for a linear element
    kind: Array  # (e,): one of `laws.KINDS`, or a larger number
    states: Array  # (e,): number of states of the law, of which the first is z
    own: Array  # (e, k): parameters of the law


class Places(NamedTuple):
    """The rows of the array ``x`` (rows, lanes), where the numbers of every motion stand.

    Each field is the first row of as many as its annotation says: n coordinates, e elements with m
    further states, k states of a law at most, c contacts. The state comes first. What follows ``work``
    is of one step only.
    """

    q: Annotated[int, "n"]  # coordinates [m]
    v: Annotated[int, "n"]  # their rates [m/s]
    z: Annotated[int, "e"]  # elastic parts of the extensions [m], first states of the laws
    memory: Annotated[int, "m"]  # further states of the laws
    own: Annotated[int, "parameters"]  # parameters of the laws
    slip: Annotated[int, "e"]  # slips in the step [m]
    force: Annotated[int, "c"]  # mean forces in the step [N]
    approach: Annotated[int, "c"]  # rate of penetration at the beginning of the present contact [m/s]
    held: Annotated[int, "c"]  # 1 if both sides move together, after a stereomechanical impact; else 0
    slow: Annotated[int, 1]  # rate of approach below which a contact is elastic [m/s]
    meets: Annotated[int, 1]  # 1 if contacts act in this motion; 0 if each structure moves alone
    spent: Annotated[int, "e"]  # energies dissipated by slips so far [J]
    f: Annotated[int, 1]  # mean forcing of the step [m/s^2]
    work: Annotated[int, 0]
    known: Annotated[int, "n + e"]  # velocities and element forces at the beginning
    dq: Annotated[int, "n"]  # increments of the coordinates [m]
    extension: Annotated[int, "e"]  # at the beginning [m]
    remembered: Annotated[int, "m"]  # further states of the laws at the end
    depth: Annotated[int, "c"]  # penetrations at the beginning [m]
    rate: Annotated[int, "c"]  # rates of penetration at the beginning [m/s]
    least: Annotated[int, "e"]  # change of a slip at which the passes of a lane end [m]
    change: Annotated[int, 1]  # increment of an extension [m]
    pace: Annotated[int, 1]  # its rate, over the yield extension [1/s]
    before: Annotated[int, "k"]  # states of a law at the beginning
    after: Annotated[int, "k"]  # states of a law at the end
    more: Annotated[int, 1]  # change of a slip in a pass [m]
    widest: Annotated[int, 1]  # largest increment of an extension [m]
    moving: Annotated[int, 1]  # 1 if the passes of the lane go on, else 0; no lane depends on another
    still: Annotated[int, 1]  # the same for the next pass
    rows: Annotated[int, 0]  # number of rows

    @classmethod
    def of(cls, elements: Elements, contacts: int = 0) -> Places:
        """The rows for these elements and so many contacts."""
        states, n, e = elements.states, elements.system.mass.size, elements.kind.size
        counts = {"n": n, "e": e, "n + e": n + e, "c": contacts, "parameters": elements.own.size}
        counts |= {"m": int((states - 1).sum()), "k": int(states.max(initial=1))}
        return cls(*first_rows(cls, 0, counts))


def first_rows(kind: Any, first: int, counts: Mapping[str, int]) -> list[int]:
    """The first row of each field of ``kind``, from the row ``first`` on, by its annotated number."""
    sizes = [counts.get(size, size) for size in _annotated(kind)]
    rows: list[int] = np.cumsum([first, *sizes])[:-1].tolist()
    return rows


@cache
def _annotated(kind: Any) -> list[Any]:
    return [hint.__metadata__[0] for hint in get_type_hints(kind, include_extras=True).values()]


def named_rows(*kinds: Any) -> dict[str, slice]:
    """The rows of each field of some `Places` and of what follows them."""
    firsts = [pair for kind in kinds for pair in zip(kind._fields, kind, strict=True)]
    return {name: slice(first, end) for (name, first), (_, end) in pairwise(firsts)}


class Steps(NamedTuple):
    """The elements for time steps of one length, and the matrices of the module's docstring.

    If every lane has other elements, ``move``, ``push``, ``ease`` and ``spring`` have a last axis of
    lanes.
    """

    dt: float  # [s]
    move: Array  # (n, n + e): the effect of velocities and element forces on the increments dq
    push: Array  # (n,): the effect of the forcing
    ease: Array  # (n, e): the effect of the slips
    # (e, 4): post, couple (of a dashpot with an exponent that of its spring), strength, and the effect
    # of the slip on the extension of its own element
    spring: Array
    info: Array  # (e, 4): kind, number of states, and rows of its memory and parameters after the first
    extensions: Rows
    shapes: Rows
    passes: int  # largest number of passes
    contacts: Contacts
    apart: Array  # (n, c): the effect of the mean forces of contacts
    parting: Array  # (c,): by how much each lessens the penetration of its own contact


def steps_of(elements: Elements, dt: float, contacts: Contacts | None = None) -> Steps:
    """The elements for time steps ``dt`` [s]."""
    system, kind, states, own = elements
    contacts = Contacts.of([], system.mass.size) if contacts is None else contacts
    mass, b, w = np.diag(system.mass), system.extensions, contacts.weights
    resisting = 2 / dt * mass + system.damping + 0.5 * dt * system.stiffness
    couple, viscous = system.couple, kind == VISCOUS
    if viscous.any():
        soft = np.einsum("en,nm,em->e", b, np.linalg.inv(resisting), b)
        couple = np.where(viscous, SOFT * 2 / (dt * soft), couple)
        resisting += 0.5 * dt * (b.T * np.where(viscous, couple, 0.0)) @ b
    flexible = np.linalg.inv(resisting)
    of_forces, apart = dt * flexible @ b.T, -dt * flexible @ w.T
    ease = 0.5 * of_forces * couple
    relief = np.einsum("en,ne->e", b, ease)
    memory, parameters = np.cumsum(states - 1) - (states - 1), own.shape[1] * np.arange(kind.size)
    return Steps(
        dt,
        np.hstack([2 * flexible @ mass, -of_forces]),
        dt * flexible @ system.mass,
        ease,
        np.stack([system.post, couple, system.strength, relief], axis=1),
        np.stack([kind, states, memory, parameters], axis=1),
        Rows.of(b),
        Rows.of(system.shapes),
        MOST_VISCOUS if viscous.any() else MOST_PASSES,
        contacts,
        apart,
        -np.einsum("cn,nc->c", w, apart),
    )


def sampled_steps(elements: Sequence[Elements], dt: float) -> Steps:
    """Steps of sets of elements that differ only in their properties, one for each lane."""
    each = [steps_of(sample, dt) for sample in elements]
    columns: dict[str, Any] = {
        name: np.stack([getattr(steps, name) for steps in each], axis=-1)
        for name in ("move", "push", "ease", "spring")
    }
    return each[0]._replace(**columns)


def lanes_at_rest(places: Places, elements: Sequence[Elements], lanes: int) -> Array:
    """The array ``x`` (rows, lanes) before a motion.

    ``elements`` are those of each lane, or one set of all lanes.
    """
    x = zeros_on_a_line(places.rows, lanes)
    own = np.stack([each.own.ravel() for each in elements], axis=1)
    x[places.own : places.own + len(own)] = own
    return x


# The functions below take arrays one by one: of a tuple of arrays that is passed on, numba would count
# the references in every call and loop, which takes most of the time of a step.


@called_often
def times_row(column, weight, i, x, of, out, lanes):
    """Write row ``i`` of `Rows` times the rows of ``x`` from ``of`` on to row ``out``."""
    first, row = weight[i, 0], of + column[i, 0]
    for lane in range(lanes):
        x[out, lane] = first * x[row, lane]
    for place in range(1, column.shape[1]):
        more, row = weight[i, place], of + column[i, place]
        for lane in range(lanes):
            x[out, lane] += more * x[row, lane]


@called_often
def multiply(matrix, i, x, of, out, lanes):
    """Add row ``i`` of a matrix times the rows of ``x`` from ``of`` on to row ``out``, by fours."""
    m = matrix.shape[1]
    j = 0
    while j + 4 <= m:
        a, b, c, d = matrix[i, j], matrix[i, j + 1], matrix[i, j + 2], matrix[i, j + 3]
        r = of + j
        for lane in range(lanes):
            x[out, lane] += (of_lane(a, lane) * x[r, lane] + of_lane(b, lane) * x[r + 1, lane]) + (
                of_lane(c, lane) * x[r + 2, lane] + of_lane(d, lane) * x[r + 3, lane]
            )
        j += 4
    for k in range(j, m):
        a, r = matrix[i, k], of + k
        for lane in range(lanes):
            x[out, lane] += of_lane(a, lane) * x[r, lane]


@called_often
def fill(x, row, value, lanes):
    """Set a row to a number in all lanes."""
    for lane in range(lanes):
        x[row, lane] = value


@called_often
def copy(x, row, to, lanes):
    """Copy a row to another in all lanes."""
    for lane in range(lanes):
        x[to, lane] = x[row, lane]


@called_often
def any_of(x, row, lanes):
    """Whether a number of the row is not zero."""
    for lane in range(lanes):  # noqa: SIM110 - compiled
        if x[row, lane] != 0.0:
            return True
    return False


@called_often
def _add_slip(ease, i, row, at, x, lanes):
    """Add the effect of a slip of element ``i``, or of a change of it, to the increments."""
    for k in range(ease.shape[0]):
        of_slip, dq = ease[k, i], at.dq + k
        for lane in range(lanes):
            x[dq, lane] += of_lane(of_slip, lane) * x[row, lane]


@called_often
def _bilinear(strength, relief, i, at, x, lanes):
    """Write `_more_slip` of the bilinear law."""
    z, slip, change, more = at.z + i, at.slip + i, at.change, at.more
    for lane in range(lanes):
        g, uy = of_lane(relief, lane), of_lane(strength, lane)
        y = x[z, lane] + (x[change, lane] - g * x[slip, lane])
        x[more, lane] = (y - min(max(y, -uy), uy)) * (1.0 / (1.0 - g)) - x[slip, lane]


@compiled
def _by_law(law, info, strength, relief, dt, i, at, x, lanes):
    """Write `_more_slip` of an element whose law has rates.

    The slip that belongs to the increment of the extension changes that increment, by ``g``. With the
    share of the increment that slips for a derivative, the next slip is that of Newton's method.
    """
    change, pace, before, after, more = at.change, at.pace, at.before, at.after, at.more
    memory, remembered = at.memory + info[i, MEMORY], at.remembered + info[i, MEMORY]
    for lane in range(lanes):
        x[pace, lane] = x[change, lane] / (dt * of_lane(strength, lane))
    for lane in range(lanes):
        x[before, lane] = x[at.z + i, lane] / of_lane(strength, lane)
    for k in range(1, info[i, STATES]):
        copy(x, memory + k - 1, before + k, lanes)
    law(info[i, KIND], lanes, x, pace, before, at.own + info[i, OWN], dt, after)
    for lane in range(lanes):
        x[more, lane] = x[change, lane] - of_lane(strength, lane) * (x[after, lane] - x[before, lane])
    for lane in range(lanes):
        moved = x[change, lane]
        share = min(max(x[more, lane] / moved if moved != 0.0 else 0.0, 0.0), 1.0)
        x[pace, lane] = 1.0 / (1.0 - of_lane(relief, lane) * share)
    for lane in range(lanes):
        x[more, lane] = (x[more, lane] - x[at.slip + i, lane]) * x[pace, lane]
    for k in range(1, info[i, STATES]):
        for lane in range(lanes):
            new, old = x[after + k, lane], x[remembered + k - 1, lane]
            x[remembered + k - 1, lane] = new if x[at.moving, lane] != 0.0 else old


@compiled
def _dashpot(couple, relief, dt, i, own, at, x, lanes):
    """Write `_more_slip` of a dashpot with an exponent, with its parameters from the row ``own`` on.

    Its rate ``r`` solves ``(1 - g) dt r + g y r^a = alone``, with ``y = 2 c/couple``, the relief ``g``
    by its own slip, and the increment ``alone`` of the extension without slip. It slips by
    ``dt r - y r^a``. The unknown is the one of ``r`` and ``r^a`` of which the other is a power of at
    least 1; Newton's method then approaches the root of a convex function from above.
    """
    for lane in range(lanes):
        g, c, a = of_lane(relief, lane), x[own, lane], x[own + 1, lane]
        of_rate, of_force = dt, 2.0 * c / of_lane(couple, lane)
        slow = a <= 1.0
        power = 1.0 / a if slow else a
        first, second = g * of_force, (1.0 - g) * of_rate
        if not slow:
            first, second = second, first
        moved, before = x[at.change, lane], x[at.slip + i, lane]
        alone = moved - g * before
        size = abs(alone)
        root = 0.0
        if before != 0.0:  # start from the root of the pass before, or of the step before
            root = abs(moved - before) / of_force if slow else abs(moved) / of_rate
        steep = root ** (power - 1.0)
        less = (first * root + second * root * steep - size) / (first + power * second * steep)
        if power * abs(less) < NEARLY * root:
            steep *= 1.0 - (power - 1.0) * less / root
            root -= less
        else:
            most = min(size / first, (size / second) ** (1.0 / power))
            root = max(min(root - less, most), 0.0)
            for _ in range(MOST_ROOTS):
                steep = root ** (power - 1.0)
                less = (first * root + second * root * steep - size) / (first + power * second * steep)
                root = max(min(root - less, most), 0.0)
                if not power * abs(less) > NEARLY * root:
                    break
            steep = root ** (power - 1.0)
        rate, force = (root * steep, root) if slow else (root, root * steep)
        total = of_rate * rate - of_force * force
        x[at.more, lane] = (total if alone > 0.0 else -total) - before
        x[at.least + i, lane] = CLOSE * max(HARDLY * x[at.widest, lane], size)


@called_often
def _more_slip(law, spring, info, dt, i, at, x, lanes):
    """Find how much element ``i`` slips beyond its slip, for given slips and forces of all others.

    It is written to the row ``at.more``. The increment of its extension is in the row ``at.change``.
    """
    kind, strength, relief = info[i, KIND], spring[i, STRENGTH], spring[i, RELIEF]
    if kind == BILINEAR:
        _bilinear(strength, relief, i, at, x, lanes)
    elif kind == VISCOUS:
        _dashpot(spring[i, COUPLE], relief, dt, i, at.own + info[i, OWN], at, x, lanes)
    else:
        _by_law(law, info, strength, relief, dt, i, at, x, lanes)


@compiled
def _pass_springs(law, column, weight, spring, ease, info, dt, at, x, lanes):
    """One pass over all elements that can slip."""
    more, moving, still = at.more, at.moving, at.still
    for i in range(info.shape[0]):
        if info[i, KIND] == LINEAR:
            continue
        times_row(column, weight, i, x, at.dq, at.change, lanes)
        _more_slip(law, spring, info, dt, i, at, x, lanes)
        for lane in range(lanes):
            x[more, lane] *= x[moving, lane]
        if not any_of(x, more, lanes):
            continue
        for lane in range(lanes):
            beyond = 1.0 if abs(x[more, lane]) > x[at.least + i, lane] else 0.0
            x[still, lane] = max(x[still, lane], beyond)
        for lane in range(lanes):
            x[at.slip + i, lane] += x[more, lane]
        _add_slip(ease, i, more, at, x, lanes)


@compiled
def _find_widest(column, weight, at, x, lanes):
    """Write the largest increment of all extensions, which dashpots with an exponent need."""
    fill(x, at.widest, 0.0, lanes)
    for i in range(column.shape[0]):
        times_row(column, weight, i, x, at.dq, at.change, lanes)
        for lane in range(lanes):
            x[at.widest, lane] = max(x[at.widest, lane], abs(x[at.change, lane]))


@compiled
def _pass_contacts(law, jumps, column, weight, apart, parting, dt, at, x, lanes):
    """One pass over all contacts, lane by lane: most have no force."""
    for j in range(parting.size):
        times_row(column, weight, j, x, at.dq, at.change, lanes)
        for lane in range(lanes):
            if x[at.moving, lane] == 0.0:
                continue
            force, depth, g = x[at.force + j, lane], x[at.depth + j, lane], parting[j]
            alone = x[at.change, lane] + g * force
            new = 0.0
            if jumps:
                if x[at.held + j, lane] != 0.0:  # the rate at the end is 0
                    new = max((alone - 0.5 * dt * x[at.rate + j, lane]) / g, 0.0)
            elif depth > 0.0 or depth + alone > 0.0:
                if depth <= 0.0:  # the contact begins; in a step the rate changes linearly
                    rate = x[at.rate + j, lane]
                    touch = rate - depth / alone * 2.0 * (alone / dt - rate)
                    x[at.approach + j, lane] = max(touch, 0.0)
                v0 = x[at.approach + j, lane]
                v0 = v0 if v0 > x[at.slow, lane] else 0.0
                new = solve_force(law[j], v0, depth, alone, g, dt)
            if new != force:
                more = new - force
                if g * abs(more) > CLOSE * (abs(depth) + abs(alone)):
                    x[at.still, lane] = 1.0
                x[at.force + j, lane] = new
                for k in range(apart.shape[0]):
                    x[at.dq + k, lane] += apart[k, j] * more


@compiled
def _begin_contacts(gap, column, weight, apart, at, x, lanes):
    """Penetrations and their rates at the beginning.

    Forces start from those of the last step.
    """
    for j in range(gap.size):
        times_row(column, weight, j, x, at.q, at.depth + j, lanes)
        times_row(column, weight, j, x, at.v, at.rate + j, lanes)
        for lane in range(lanes):
            x[at.depth + j, lane] -= gap[j]
    for j in range(gap.size):
        for lane in range(lanes):
            force = x[at.force + j, lane]
            if force != 0.0:
                for k in range(apart.shape[0]):
                    x[at.dq + k, lane] += apart[k, j] * force


@compiled
def _begin(column, weight, move, push, spring, ease, info, at, x, lanes):
    """Find the increments without slips and contact forces, but for slips that start from the last step.

    These are the slips of dashpots and of laws with rates.
    """
    n = push.shape[0]
    for i in range(n):
        of_forcing = push[i]
        copy(x, at.v + i, at.known + i, lanes)
        for lane in range(lanes):
            x[at.dq + i, lane] = of_lane(of_forcing, lane) * x[at.f, lane]
    for i in range(info.shape[0]):
        post, couple, extension = spring[i, POST], spring[i, COUPLE], at.extension + i
        times_row(column, weight, i, x, at.q, extension, lanes)
        for lane in range(lanes):
            x[at.known + n + i, lane] = (
                of_lane(post, lane) * x[extension, lane] + of_lane(couple, lane) * x[at.z + i, lane]
            )
    for i in range(n):
        multiply(move, i, x, at.known, at.dq + i, lanes)
    for i in range(info.shape[0]):
        if info[i, KIND] < VISCOUS:
            fill(x, at.slip + i, 0.0, lanes)
        else:
            _add_slip(ease, i, at.slip + i, at, x, lanes)


@compiled
def _end(column, weight, spring, info, n, dt, at, x, lanes):
    """Change the state by the increments and slips, and add the energies that the slips dissipate."""
    twice = 2.0 / dt
    for i in range(n):
        for lane in range(lanes):
            x[at.q + i, lane] += x[at.dq + i, lane]
        for lane in range(lanes):
            x[at.v + i, lane] = twice * x[at.dq + i, lane] - x[at.v + i, lane]
    for i in range(info.shape[0]):
        kind, couple, z, slip = info[i, KIND], spring[i, COUPLE], at.z + i, at.slip + i
        if kind == VISCOUS:  # the spring of a dashpot exists for one step only
            continue
        times_row(column, weight, i, x, at.dq, at.change, lanes)
        if kind != LINEAR:
            spent = at.spent + i
            for lane in range(lanes):
                middle = x[z, lane] + 0.5 * (x[at.change, lane] - x[slip, lane])
                x[spent, lane] += of_lane(couple, lane) * middle * x[slip, lane]
        for lane in range(lanes):
            x[z, lane] += x[at.change, lane] - x[slip, lane]
    for k in range(at.own - at.memory):
        copy(x, at.remembered + k, at.memory + k, lanes)


@compiled
def take_step(law, steps, at, x, lanes):
    """One time step of all lanes, under the mean forcing in the row ``at.f``; changes the state.

    ``law`` is the result of `by_number`. The increments, slips and mean forces of contacts, and the
    extensions and penetrations at the beginning of the step, can be read afterwards.
    """
    dt, contacts = steps.dt, steps.contacts
    (column, weight), (facing, share) = steps.extensions, contacts.rows
    spring, info, ease, parting = steps.spring, steps.info, steps.ease, steps.parting
    _begin(column, weight, steps.move, steps.push, spring, ease, info, at, x, lanes)
    if parting.size > 0:
        _begin_contacts(contacts.gap, facing, share, steps.apart, at, x, lanes)
    if steps.passes == MOST_VISCOUS:
        _find_widest(column, weight, at, x, lanes)
    fill(x, at.moving, 1.0, lanes)
    for _ in range(steps.passes):
        fill(x, at.still, 0.0, lanes)
        _pass_springs(law, column, weight, spring, ease, info, dt, at, x, lanes)
        if parting.size > 0:
            _pass_contacts(
                contacts.law, contacts.jumps, facing, share, steps.apart, parting, dt, at, x, lanes
            )
        if not any_of(x, at.still, lanes):
            break
        copy(x, at.still, at.moving, lanes)
    _end(column, weight, spring, info, ease.shape[0], dt, at, x, lanes)


@compiled
def tolerances(spring, info, at, x, lanes):
    """Write the changes of the slips at which the passes of a lane end."""
    for i in range(info.shape[0]):
        kind, strength = info[i, KIND], spring[i, STRENGTH]
        close = CLOSE if kind <= VISCOUS else CLOSE_BY_LAW
        for lane in range(lanes):
            x[at.least + i, lane] = close * of_lane(strength, lane)


def _system_block(f, law, steps, at, x, every, out, first):
    """Steps of a system under the forcing ``f`` (steps, lanes), from its state in ``x``; see `Places`.

    The displacements of the floors after every ``every``-th step [m] are written to the rows of ``out``
    (samples, rows, lanes) from ``first`` on.
    """
    lanes, (column, weight) = f.shape[1], steps.shapes
    tolerances(steps.spring, steps.info, at, x, lanes)
    for i in range(steps.info.shape[0]):
        fill(x, at.slip + i, 0.0, lanes)
    sample = 0
    for s in range(f.shape[0]):
        for lane in range(lanes):
            x[at.f, lane] = f[s, lane]
        take_step(law, steps, at, x, lanes)
        if (s + 1) % every == 0:
            for i in range(column.shape[0]):
                times_row(column, weight, i, x, at.q, at.change, lanes)
                for lane in range(lanes):
                    out[sample, first + i, lane] = x[at.change, lane]
            sample += 1


system_block, sampled_block = entry(_system_block), entry(variant(_system_block, "sampled_block"))
