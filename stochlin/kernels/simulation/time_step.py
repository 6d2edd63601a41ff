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

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.compiled import (
    by_pointer,
    called_often,
    called_once,
    compiled,
    entry,
    of_lane,
    variant,
)
from stochlin.kernels.simulation.contacts import Contacts, solve_force
from stochlin.kernels.simulation.laws import BILINEAR, LINEAR, VISCOUS, advance
from stochlin.kernels.simulation.moving import (
    CHANGE,
    CLOSE,
    DEPTH,
    DQ,
    EXTENSION,
    FORCE,
    HELD,
    LEAST,
    MORE,
    MOVING,
    OF_DQ,
    RATE,
    SLIP,
    SLOW,
    SPEED,
    SPENT,
    STILL,
    WIDEST,
    Elements,
    F,
    Q,
    V,
    Z,
    any_of,
    fill,
    multiply,
    products,
    rows_of,
    times_row,
)

MOST_PASSES = 60  # largest number of passes of a step
MOST_VISCOUS = 600  # the same with dashpots with an exponent, whose forces can tie many floors together
MOST_ROOTS = 60  # largest number of steps of Newton's method, which mostly needs four or five
NEARLY = 1e-5  # relative change of a root after which the error of Newton's method is about its square
SOFT = 0.1  # stiffness of a dashpot's spring over that with which the floors resist a step
HARDLY = 1e-6  # increment of a dashpot's extension, over the largest of the step, that may be rounding
POST, COUPLE, STRENGTH, RELIEF = range(4)  # columns of `Steps.spring`


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
    kind: Array  # (e,): kinds of the elements
    states: Array  # (e,): numbers of states of their laws
    extensions: Array  # as by `rows_of`
    shapes: Array  # the same
    passes: int  # largest number of passes
    contacts: Contacts
    apart: Array  # (n, c): the effect of the mean forces of contacts
    parting: Array  # (c,): by how much each lessens the penetration of its own contact


def steps_of(elements: Elements, dt: float, contacts: Contacts | None = None) -> Steps:
    """The elements for time steps ``dt`` [s]."""
    system, kind, states, _ = elements
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
    return Steps(
        dt,
        np.hstack([2 * flexible @ mass, -of_forces]),
        dt * flexible @ system.mass,
        ease,
        np.stack([system.post, couple, system.strength, relief], axis=1),
        kind,
        states,
        rows_of(b),
        rows_of(system.shapes),
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


@called_often
def _add_slip(ease, i, slip, row, coordinates, lanes):
    """Add the effect of a slip of element ``i``, or of a change of it, to the increments."""
    for k in range(ease.shape[0]):
        of_slip = ease[k, i]
        for lane in range(lanes):
            coordinates[k, DQ, lane] += of_lane(of_slip, lane) * slip[row, lane]


@called_once
def _bilinear(strength, relief, i, elements, motions, lanes):
    """Write the change ``MORE`` of a slip of the bilinear law."""
    for lane in range(lanes):
        g, uy = of_lane(relief, lane), of_lane(strength, lane)
        y = elements[i, Z, lane] + (motions[CHANGE, lane] - g * elements[i, SLIP, lane])
        slip = (y - min(max(y, -uy), uy)) * (1.0 / (1.0 - g))
        motions[MORE, lane] = slip - elements[i, SLIP, lane]


@called_once
def _by_law(law, kind, count, spring, dt, i, elements, memory, after, own, states, motions, lanes):
    """Write the change of a slip of an element whose law has rates and a ``count`` of states.

    The slip that belongs to the increment of the extension changes that increment, by ``g``. With the
    share of the increment that slips for a derivative, the next slip is that of Newton's method.
    """
    pace, old, new = states[0, 0], states[1][:count], states[2][:count]
    strength, relief = spring[STRENGTH], spring[RELIEF]
    for lane in range(lanes):
        pace[lane] = motions[CHANGE, lane] / (dt * of_lane(strength, lane))
    for lane in range(lanes):
        old[0, lane] = elements[i, Z, lane] / of_lane(strength, lane)
    for k in range(1, count):
        for lane in range(lanes):
            old[k, lane] = memory[i, k - 1, lane]
    advance(law, kind, lanes, pace, old, own[i], dt, new)
    for lane in range(lanes):
        moved, g = motions[CHANGE, lane], of_lane(relief, lane)
        slip = moved - of_lane(strength, lane) * (new[0, lane] - old[0, lane])
        share = min(max(slip / moved if moved != 0.0 else 0.0, 0.0), 1.0)
        motions[MORE, lane] = (slip - elements[i, SLIP, lane]) * (1.0 / (1.0 - g * share))
    for k in range(1, count):
        for lane in range(lanes):
            going = motions[MOVING, lane] != 0.0
            after[i, k - 1, lane] = new[k, lane] if going else after[i, k - 1, lane]


@called_once
def _dashpot(couple, relief, dt, i, elements, own, motions, lanes):
    """Write the change of a slip of a dashpot with an exponent.

    ``own`` are its constant and the exponent. Its rate ``r`` solves
    ``(1 - g) dt r + g y r^a = alone``, with ``y = 2 c/couple``, the relief ``g`` by its own slip, and
    the increment ``alone`` of the extension without slip. It slips by ``dt r - y r^a``. The unknown is
    the one of ``r`` and ``r^a`` of which the other is a power of at least 1; Newton's method then
    approaches the root of a convex function from above.
    """
    for lane in range(lanes):
        g, c, a = of_lane(relief, lane), own[i, 0, lane], own[i, 1, lane]
        of_rate, of_force = dt, 2.0 * c / of_lane(couple, lane)
        slow = a <= 1.0
        power = 1.0 / a if slow else a
        first, second = g * of_force, (1.0 - g) * of_rate
        if not slow:
            first, second = second, first
        moved, before = motions[CHANGE, lane], elements[i, SLIP, lane]
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
        motions[MORE, lane] = (total if alone > 0.0 else -total) - before
        elements[i, LEAST, lane] = CLOSE * max(HARDLY * motions[WIDEST, lane], size)


def _no_slip(law, kind, count, spring, dt, i, elements, memory, after, own, states, motions, lanes):
    """`_other_slip` where all elements are linear or bilinear, which takes no time to compile."""


def _other_slip(law, kind, count, spring, dt, i, elements, memory, after, own, states, motions, lanes):
    """Write the change of a slip of an element that is neither linear nor bilinear."""
    if kind == VISCOUS:
        _dashpot(spring[COUPLE], spring[RELIEF], dt, i, elements, own, motions, lanes)
    else:
        _by_law(law, kind, count, spring, dt, i, elements, memory, after, own, states, motions, lanes)


@called_once
def _pass_springs(other, law, steps, moving, lanes):
    """One pass over all elements that can slip."""
    rows, ease, dt, own = steps.extensions, steps.ease, steps.dt, moving.own
    coordinates, elements, motions = moving.coordinates, moving.elements, moving.motions
    memory, after, states = moving.memory, moving.remembered, moving.states
    for i in range(steps.kind.size):
        kind, count, spring = steps.kind[i], steps.states[i], steps.spring[i]
        if kind == LINEAR:
            continue
        times_row(rows, i, coordinates, DQ, motions, CHANGE, lanes)
        if kind == BILINEAR:
            _bilinear(spring[STRENGTH], spring[RELIEF], i, elements, motions, lanes)
        else:
            other(law, kind, count, spring, dt, i, elements, memory, after, own, states, motions, lanes)
        for lane in range(lanes):
            motions[MORE, lane] *= motions[MOVING, lane]
        if not any_of(motions, MORE, lanes):
            continue
        for lane in range(lanes):
            beyond = 1.0 if abs(motions[MORE, lane]) > elements[i, LEAST, lane] else 0.0
            motions[STILL, lane] = max(motions[STILL, lane], beyond)
        for lane in range(lanes):
            elements[i, SLIP, lane] += motions[MORE, lane]
        _add_slip(ease, i, motions, MORE, coordinates, lanes)


@called_once
def _pass_contacts(steps, moving, lanes):
    """One pass over all contacts, lane by lane: most have no force."""
    rows, jumps, apart, dt = steps.contacts.rows, steps.contacts.jumps, steps.apart, steps.dt
    coordinates, motions = moving.coordinates, moving.motions
    for j in range(steps.parting.size):
        contact, law, g = moving.contacts[j], steps.contacts.law[j], steps.parting[j]
        times_row(rows, j, coordinates, DQ, motions, CHANGE, lanes)
        for lane in range(lanes):
            if motions[MOVING, lane] == 0.0:
                continue
            force, depth, rate = contact[FORCE, lane], contact[DEPTH, lane], contact[RATE, lane]
            alone = motions[CHANGE, lane] + g * force
            new = 0.0
            if jumps:
                if contact[HELD, lane] != 0.0:  # the rate at the end is 0
                    new = max((alone - 0.5 * dt * rate) / g, 0.0)
            elif depth > 0.0 or depth + alone > 0.0:
                if depth <= 0.0:  # the contact begins; in a step the rate changes linearly
                    touch = rate - depth / alone * 2.0 * (alone / dt - rate)
                    contact[SPEED, lane] = max(touch, 0.0)
                v0 = contact[SPEED, lane]
                v0 = v0 if v0 > motions[SLOW, lane] else 0.0
                new = solve_force(law, v0, depth, alone, g, dt)
            if new != force:
                more = new - force
                if g * abs(more) > CLOSE * (abs(depth) + abs(alone)):
                    motions[STILL, lane] = 1.0
                contact[FORCE, lane] = new
                for k in range(apart.shape[0]):
                    coordinates[k, DQ, lane] += apart[k, j] * more


@called_once
def _begin_contacts(gap, rows, apart, coordinates, contacts, lanes):
    """Penetrations and their rates at the beginning.

    Forces start from those of the last step.
    """
    products(rows, coordinates, Q, contacts, DEPTH, lanes)
    products(rows, coordinates, V, contacts, RATE, lanes)
    for j in range(gap.size):
        for lane in range(lanes):
            contacts[j, DEPTH, lane] -= gap[j]
            force = contacts[j, FORCE, lane]
            if force != 0.0:
                for k in range(apart.shape[0]):
                    coordinates[k, DQ, lane] += apart[k, j] * force


@called_once
def _begin(steps, moving, lanes):
    """Find the increments without slips and contact forces, but for slips that start from the last step.

    These are the slips of dashpots and of laws with rates.
    """
    spring, n = steps.spring, steps.push.shape[0]
    coordinates, elements, known = moving.coordinates, moving.elements, moving.known
    for i in range(n):
        of_forcing = steps.push[i]
        for lane in range(lanes):
            known[i, 0, lane] = coordinates[i, V, lane]
        for lane in range(lanes):
            coordinates[i, DQ, lane] = of_lane(of_forcing, lane) * moving.motions[F, lane]
    products(steps.extensions, coordinates, Q, elements, EXTENSION, lanes)
    for i in range(steps.kind.size):
        post, couple = spring[i, POST], spring[i, COUPLE]
        for lane in range(lanes):
            elastic = of_lane(post, lane) * elements[i, EXTENSION, lane]
            known[n + i, 0, lane] = elastic + of_lane(couple, lane) * elements[i, Z, lane]
    multiply(steps.move, known, 0, coordinates, DQ, lanes)
    for i in range(steps.kind.size):
        if steps.kind[i] < VISCOUS:
            fill(elements[i], SLIP, 0.0, lanes)
        else:
            _add_slip(steps.ease, i, elements[i], SLIP, coordinates, lanes)


@called_once
def _end(steps, moving, lanes):
    """Change the state by the increments and slips, and add the energies that the slips dissipate."""
    twice, coordinates, elements = 2.0 / steps.dt, moving.coordinates, moving.elements
    products(steps.extensions, coordinates, DQ, moving.products, OF_DQ, lanes)
    for i in range(coordinates.shape[0]):
        for lane in range(lanes):
            coordinates[i, Q, lane] += coordinates[i, DQ, lane]
        for lane in range(lanes):
            coordinates[i, V, lane] = twice * coordinates[i, DQ, lane] - coordinates[i, V, lane]
    for i in range(elements.shape[0]):
        kind, couple, element = steps.kind[i], steps.spring[i, COUPLE], elements[i]
        if kind == VISCOUS:  # the spring of a dashpot exists for one step only
            continue
        for lane in range(lanes):
            slip, change = element[SLIP, lane], moving.products[i, OF_DQ, lane]
            middle = element[Z, lane] + 0.5 * (change - slip)
            element[SPENT, lane] += of_lane(couple, lane) * middle * slip
            element[Z, lane] += change - slip
        for k in range(1, steps.states[i]):
            for lane in range(lanes):
                moving.memory[i, k - 1, lane] = moving.remembered[i, k - 1, lane]


@compiled
def take_step(other, law, steps, moving, lanes):
    """One time step of all lanes, under the mean forcing in the row ``F``; changes the state.

    ``other`` is that of `step_of`, and ``law`` the result of `by_number`. The increments, slips and mean
    forces of contacts, and the extensions and penetrations at the beginning of the step, can be read
    afterwards.
    """
    coordinates, contacts, motions = moving.coordinates, moving.contacts, moving.motions
    _begin(steps, moving, lanes)
    if steps.parting.size > 0:
        rows, apart = steps.contacts.rows, steps.apart
        _begin_contacts(steps.contacts.gap, rows, apart, coordinates, contacts, lanes)
    if steps.passes == MOST_VISCOUS:
        products(steps.extensions, coordinates, DQ, moving.products, OF_DQ, lanes)
        fill(motions, WIDEST, 0.0, lanes)
        for i in range(steps.kind.size):
            for lane in range(lanes):
                change = abs(moving.products[i, OF_DQ, lane])
                motions[WIDEST, lane] = max(motions[WIDEST, lane], change)
    fill(motions, MOVING, 1.0, lanes)
    for _ in range(steps.passes):
        fill(motions, STILL, 0.0, lanes)
        _pass_springs(other, law, steps, moving, lanes)
        if steps.parting.size > 0:
            _pass_contacts(steps, moving, lanes)
        if not any_of(motions, STILL, lanes):
            break
        for lane in range(lanes):
            motions[MOVING, lane] = motions[STILL, lane]
    _end(steps, moving, lanes)


sampled_step, sampled_slip = variant(take_step, "sampled_step"), variant(_other_slip, "sampled_slip")


def step_of(law: Any, steps: Steps, moving: Any, lanes: int) -> tuple[Any, Any]:
    """`take_step` and its ``other`` for such arguments, by their pointers."""
    other, step = _other_slip if (steps.kind >= VISCOUS).any() else _no_slip, take_step
    if steps.spring.ndim > 2:
        other, step = sampled_slip, sampled_step
    arrays = moving.elements, moving.memory, moving.remembered, moving.own, moving.states, moving.motions
    pointer = by_pointer(other, law, 1, 1, steps.spring[0], 0.1, 1, *arrays, lanes)
    return by_pointer(step, pointer, law, steps, moving, lanes), pointer


def _system_block(f, step, other, law, steps, moving, every, out, first):
    """Steps of a system under the forcing ``f`` (steps, lanes), which change its state.

    ``step`` and ``other`` are those of `step_of`.

    The displacements of the floors after every ``every``-th step [m] are written to the rows of ``out``
    (samples, rows, lanes) from ``first`` on.
    """
    lanes, rows = f.shape[1], steps.shapes
    for i in range(steps.kind.size):
        fill(moving.elements[i], SLIP, 0.0, lanes)
    sample = 0
    for s in range(f.shape[0]):
        for lane in range(lanes):
            moving.motions[F, lane] = f[s, lane]
        step(other, law, steps, moving, lanes)
        if (s + 1) % every == 0:
            for i in range(rows.shape[0]):
                times_row(rows, i, moving.coordinates, Q, out[sample], first + i, lanes)
            sample += 1


system_block, sampled_block = entry(_system_block), entry(variant(_system_block, "sampled_block"))
