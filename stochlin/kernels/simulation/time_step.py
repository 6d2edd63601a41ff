"""One time step of a `System` of masses, springs and contacts in any number of independent motions.

Each motion is a lane: the last axis of all arrays. The rule is the trapezoidal one. With the masses
``M``, the damping ``C``, springs with the extensions ``e = E q`` and the forces
``s = post e + couple z``, the increment ``dq`` of the coordinates in a step ``dt`` is

    ``(2 M/dt + C + dt/2 K) dq = 2 M q' - dt E' s + dt M 1 f + dt/2 E' couple p - dt W' F``

with the elastic stiffness ``K``, ``q'`` and ``s`` at the beginning of the step, the mean forcing
``f``, the slips ``p`` of the springs, which are the parts of their extensions that ``z`` does not
follow, and the mean forces ``F`` of the contacts between floors, with the penetrations ``W q -
gap``.

A step first finds ``dq`` without slips and contact forces. It then passes over the springs and
contacts. The law of each gives its slip or force, if those of the others are known, and the passes
are repeated until none changes. For the bilinear law this is the projected Gauss-Seidel method for
a complementarity problem with a symmetric positive matrix, and converges.

A dashpot with an exponent, with the force ``c |x|^a sign(x)`` at the rate ``x`` of its extension,
is treated as a spring that exists during one step. It slips so much that its mean force, ``couple
(de - p)/2``, is that of the dashpot. Its stiffness has no effect on the result, only on the number
of passes. The passes minimize a convex energy, element by element, and converge.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.borrowed import borrowed
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
from stochlin.kernels.simulation.row_products import (
    add_product,
    any_of,
    fill,
    products,
    rows_of,
    times_row,
)
from stochlin.kernels.simulation.state import CLOSE_SLIP, Elements, State

MOST_PASSES = 60  # largest number of passes of a step
# the same with dashpots with an exponent, whose forces can tie many floors together
MOST_VISCOUS_PASSES = 600
MOST_NEWTON_STEPS = 60  # largest number for a dashpot, which mostly takes four or five
# relative change of a root after which the error of Newton's method is about its square
CLOSE_ROOT = 1e-5
# stiffness of a dashpot's spring, over that with which the floors resist a step
DASHPOT_STIFFNESS = 0.1
# increment of a dashpot's extension, over the largest of the step, that may be rounding
ROUNDING_OF_INCREMENTS = 1e-6
POST, COUPLE, STRENGTH, RELIEF = range(4)  # columns of `Steps.spring`


@borrowed
class Steps(NamedTuple):
    """The elements for time steps of one length, and the matrices of the module's docstring.

    If every lane has other elements, ``spring`` and the effects of what is known at the beginning,
    of the forcing and of the slips have a last axis of lanes.
    """

    dt: float  # [s]
    # (n, n + e): the effect of velocities and element forces on the increments dq
    beginning_effect: Array
    forcing_effect: Array  # (n,): the effect of the forcing
    slip_effects: Array  # (n, e): the effect of the slips
    # (e, 4): post, couple (of a dashpot with an exponent that of its spring), strength, and the
    # effect of the slip on the extension of its own element
    spring: Array
    kind: Array  # (e,): kinds of the elements
    states: Array  # (e,): numbers of states of their laws
    extensions: Array  # as by `rows_of`
    shapes: Array  # the same
    passes: int  # largest number of passes
    contacts: Contacts
    contact_effects: Array  # (n, c): the effect of the mean forces of contacts
    contact_relief: Array  # (c,): by how much each lessens the penetration of its own contact


def steps_of(elements: Elements, dt: float, contacts: Contacts | None = None) -> Steps:
    """The elements for time steps ``dt`` [s]."""
    system = elements.system
    contacts = Contacts.of([], system.mass.size) if contacts is None else contacts
    mass = np.diag(system.mass)
    b = system.extensions
    w = contacts.weights.copy()
    w[:, -1] -= contacts.of_wall
    resisting = 2 / dt * mass + system.damping + 0.5 * dt * system.stiffness
    couple = system.couple
    viscous = elements.kind == VISCOUS
    if viscous.any():
        soft = np.einsum("en,nm,em->e", b, np.linalg.inv(resisting), b)
        couple = np.where(viscous, DASHPOT_STIFFNESS * 2 / (dt * soft), couple)
        resisting += 0.5 * dt * (b.T * np.where(viscous, couple, 0.0)) @ b
    flexible = np.linalg.inv(resisting)
    force_effects = dt * flexible @ b.T
    slip_effects = 0.5 * force_effects * couple
    contact_effects = -dt * flexible @ w.T
    relief = np.einsum("en,ne->e", b, slip_effects)
    return Steps(
        dt=dt,
        beginning_effect=np.hstack([2 * flexible @ mass, -force_effects]),
        forcing_effect=dt * flexible @ system.mass,
        slip_effects=slip_effects,
        spring=np.stack([system.post, couple, system.strength, relief], axis=1),
        kind=elements.kind,
        states=elements.states,
        extensions=rows_of(b),
        shapes=rows_of(system.shapes),
        passes=MOST_VISCOUS_PASSES if viscous.any() else MOST_PASSES,
        contacts=contacts,
        contact_effects=contact_effects,
        contact_relief=-np.einsum("cn,nc->c", w, contact_effects),
    )


def sampled_steps(elements: Sequence[Elements], dt: float) -> Steps:
    """Steps of sets of elements that differ only in their properties, one for each lane."""
    samples = [steps_of(sample, dt) for sample in elements]
    return samples[0]._replace(
        beginning_effect=np.stack([steps.beginning_effect for steps in samples], axis=-1),
        forcing_effect=np.stack([steps.forcing_effect for steps in samples], axis=-1),
        slip_effects=np.stack([steps.slip_effects for steps in samples], axis=-1),
        spring=np.stack([steps.spring for steps in samples], axis=-1),
    )


@called_often
def _add_slip(effect, i, slip, dq, lanes):
    """Add the effect of a slip (lanes,) of element ``i``, or of its change, to the increments."""
    for k in range(effect.shape[0]):
        slip_effect = effect[k, i]
        for lane in range(lanes):
            dq[k, lane] += of_lane(slip_effect, lane) * slip[lane]


@called_once
def _bilinear_slip(strength, relief, i, elements, iteration, lanes):
    """Write the change of a slip of the bilinear law."""
    z = elements.z[i]
    slip = elements.slip[i]
    for lane in range(lanes):
        g = of_lane(relief, lane)
        uy = of_lane(strength, lane)
        y = z[lane] + (iteration.change[lane] - g * slip[lane])
        new = (y - min(max(y, -uy), uy)) * (1.0 / (1.0 - g))
        iteration.slip_change[lane] = new - slip[lane]


@called_once
def _rate_law_slip(law, steps, state, i, lanes):
    """Write the change of a slip of an element whose law has rates.

    The slip that belongs to the increment of the extension changes that increment, by ``g``. With
    the share of the increment that slips for a derivative, the next slip is that of Newton's
    method.
    """
    dt = steps.dt
    count = steps.states[i]
    strength = steps.spring[i, STRENGTH]
    relief = steps.spring[i, RELIEF]
    iteration = state.iteration
    z = state.elements.z[i]
    slip = state.elements.slip[i]
    rate = state.law.rate[0]
    before = state.law.before[:count]
    after = state.law.after[:count]
    for lane in range(lanes):
        rate[lane] = iteration.change[lane] / (dt * of_lane(strength, lane))
    for lane in range(lanes):
        before[0, lane] = z[lane] / of_lane(strength, lane)
    for k in range(1, count):
        for lane in range(lanes):
            before[k, lane] = state.memory[i, k - 1, lane]
    advance(law, steps.kind[i], lanes, rate, before, state.parameters[i], dt, after)
    for lane in range(lanes):
        change = iteration.change[lane]
        g = of_lane(relief, lane)
        new = change - of_lane(strength, lane) * (after[0, lane] - before[0, lane])
        share = min(max(new / change if change != 0.0 else 0.0, 0.0), 1.0)
        iteration.slip_change[lane] = (new - slip[lane]) * (1.0 / (1.0 - g * share))
    for k in range(1, count):
        remembered = state.memory_after[i, k - 1]
        for lane in range(lanes):
            active = iteration.active[lane] != 0.0
            remembered[lane] = after[k, lane] if active else remembered[lane]


@called_once
def _dashpot_slip(couple, relief, dt, i, elements, parameters, iteration, lanes):
    """Write the change of a slip of a dashpot with an exponent.

    Its ``parameters`` are its constant and the exponent. Its rate ``r`` solves ``(1 - g) dt r + g y
    r^a = alone``, with ``y = 2 c/couple``, the relief ``g`` by its own slip, and the increment
    ``alone`` of the extension without slip. It slips by ``dt r - y r^a``. The unknown is the one of
    ``r`` and ``r^a`` of which the other is a power of at least 1; Newton's method then approaches
    the root of a convex function from above.
    """
    for lane in range(lanes):
        g = of_lane(relief, lane)
        c = parameters[i, 0, lane]
        a = parameters[i, 1, lane]
        rate_factor = dt
        force_factor = 2.0 * c / of_lane(couple, lane)
        slow = a <= 1.0
        power = 1.0 / a if slow else a
        first = g * force_factor
        second = (1.0 - g) * rate_factor
        if not slow:
            first, second = second, first
        change = iteration.change[lane]
        before = elements.slip[i, lane]
        alone = change - g * before
        size = abs(alone)
        root = 0.0
        if before != 0.0:  # start from the root of the pass before, or of the step before
            root = abs(change - before) / force_factor if slow else abs(change) / rate_factor
        steep = root ** (power - 1.0)
        decrement = (first * root + second * root * steep - size) / (first + power * second * steep)
        if power * abs(decrement) < CLOSE_ROOT * root:
            steep *= 1.0 - (power - 1.0) * decrement / root
            root -= decrement
        else:
            bound = min(size / first, (size / second) ** (1.0 / power))
            root = max(min(root - decrement, bound), 0.0)
            for _ in range(MOST_NEWTON_STEPS):
                steep = root ** (power - 1.0)
                decrement = (first * root + second * root * steep - size) / (
                    first + power * second * steep
                )
                root = max(min(root - decrement, bound), 0.0)
                if not power * abs(decrement) > CLOSE_ROOT * root:
                    break
            steep = root ** (power - 1.0)
        rate = root * steep if slow else root
        force = root if slow else root * steep
        total = rate_factor * rate - force_factor * force
        iteration.slip_change[lane] = (total if alone > 0.0 else -total) - before
        least = ROUNDING_OF_INCREMENTS * iteration.largest_change[lane]
        elements.tolerance[i, lane] = CLOSE_SLIP * max(least, size)


def _no_slip(law, steps, state, i, lanes):
    """`_other_slip` if all elements are linear or bilinear; it takes no time to compile."""


def _other_slip(law, steps, state, i, lanes):
    """Write the change of a slip of an element that is neither linear nor bilinear."""
    if steps.kind[i] == VISCOUS:
        couple = steps.spring[i, COUPLE]
        relief = steps.spring[i, RELIEF]
        _dashpot_slip(
            couple, relief, steps.dt, i, state.elements, state.parameters, state.iteration, lanes
        )
    else:
        _rate_law_slip(law, steps, state, i, lanes)


@called_once
def _pass_springs(other, law, steps, state, lanes):
    """One pass over all elements that can slip."""
    spring = steps.spring
    elements = state.elements
    iteration = state.iteration
    dq = state.coordinates.dq
    slip_change = iteration.slip_change
    active_next = iteration.active_next
    for i in range(steps.kind.size):
        if steps.kind[i] == LINEAR:
            continue
        times_row(steps.extensions, i, dq, iteration.change, lanes)
        if steps.kind[i] == BILINEAR:
            _bilinear_slip(spring[i, STRENGTH], spring[i, RELIEF], i, elements, iteration, lanes)
        else:
            other(law, steps, state, i, lanes)
        for lane in range(lanes):
            slip_change[lane] *= iteration.active[lane]
        if not any_of(slip_change, lanes):
            continue
        tolerance = elements.tolerance[i]
        for lane in range(lanes):
            beyond = 1.0 if abs(slip_change[lane]) > tolerance[lane] else 0.0
            active_next[lane] = max(active_next[lane], beyond)
        slip = elements.slip[i]
        for lane in range(lanes):
            slip[lane] += slip_change[lane]
        _add_slip(steps.slip_effects, i, slip_change, dq, lanes)


@called_once
def _pass_contacts(steps, state, lanes):
    """One pass over all contacts, lane by lane: most have no force."""
    dt = steps.dt
    effect = steps.contact_effects
    iteration = state.iteration
    contacts = state.contacts
    dq = state.coordinates.dq
    for j in range(steps.contact_relief.size):
        law = steps.contacts.law[j]
        g = steps.contact_relief[j]
        times_row(steps.contacts.rows, j, dq, iteration.change, lanes)
        for lane in range(lanes):
            if iteration.active[lane] == 0.0:
                continue
            force = contacts.mean_force[j, lane]
            depth = contacts.penetration[j, lane]
            rate = contacts.rate[j, lane]
            alone = iteration.change[lane] + g * force
            new = 0.0
            if steps.contacts.jumps:
                if contacts.sticks[j, lane] != 0.0:  # the rate at the end is 0
                    new = max((alone - 0.5 * dt * rate) / g, 0.0)
            elif depth > 0.0 or depth + alone > 0.0:
                if depth <= 0.0:  # the contact begins; in a step the rate changes linearly
                    touch = rate - depth / alone * 2.0 * (alone / dt - rate)
                    contacts.speed[j, lane] = max(touch, 0.0)
                v0 = contacts.speed[j, lane]
                v0 = v0 if v0 > state.motions.least_approach[lane] else 0.0
                new = solve_force(law, v0, depth, alone, g, dt)
            if new != force:
                force_change = new - force
                if g * abs(force_change) > CLOSE_SLIP * (abs(depth) + abs(alone)):
                    iteration.active_next[lane] = 1.0
                contacts.mean_force[j, lane] = new
                for k in range(effect.shape[0]):
                    dq[k, lane] += effect[k, j] * force_change


@called_once
def _begin_contacts(steps, state, lanes):
    """Penetrations and their rates at the beginning.

    Forces start from those of the last step.
    """
    gap = steps.contacts.gap
    effect = steps.contact_effects
    contacts = state.contacts
    dq = state.coordinates.dq
    products(steps.contacts.rows, state.coordinates.q, contacts.penetration, lanes)
    products(steps.contacts.rows, state.coordinates.v, contacts.rate, lanes)
    for j in range(gap.size):
        for lane in range(lanes):
            contacts.penetration[j, lane] -= gap[j]
            force = contacts.mean_force[j, lane]
            if force != 0.0:
                for k in range(effect.shape[0]):
                    dq[k, lane] += effect[k, j] * force


@called_once
def _begin(steps, state, lanes):
    """Find increments without slips or contact forces, but for slips that start from the last step.

    These are the slips of dashpots and of laws with rates.
    """
    n = steps.forcing_effect.shape[0]
    v = state.coordinates.v
    dq = state.coordinates.dq
    elements = state.elements
    beginning = state.beginning
    forcing = state.motions.forcing
    for i in range(n):
        effect = steps.forcing_effect[i]
        for lane in range(lanes):
            beginning[i, lane] = v[i, lane]
        for lane in range(lanes):
            dq[i, lane] = of_lane(effect, lane) * forcing[lane]
    products(steps.extensions, state.coordinates.q, elements.extension, lanes)
    for i in range(steps.kind.size):
        post = steps.spring[i, POST]
        couple = steps.spring[i, COUPLE]
        extension = elements.extension[i]
        z = elements.z[i]
        for lane in range(lanes):
            elastic = of_lane(post, lane) * extension[lane]
            beginning[n + i, lane] = elastic + of_lane(couple, lane) * z[lane]
    add_product(steps.beginning_effect, beginning, dq, lanes)
    for i in range(steps.kind.size):
        if steps.kind[i] < VISCOUS:
            fill(elements.slip[i], 0.0, lanes)
        else:
            _add_slip(steps.slip_effects, i, elements.slip[i], dq, lanes)


@called_once
def _end(steps, state, lanes):
    """Change the state by the increments and slips, and add the energies that slips dissipate."""
    twice = 2.0 / steps.dt
    q = state.coordinates.q
    v = state.coordinates.v
    dq = state.coordinates.dq
    products(steps.extensions, dq, state.products.dq, lanes)
    for i in range(q.shape[0]):
        for lane in range(lanes):
            q[i, lane] += dq[i, lane]
        for lane in range(lanes):
            v[i, lane] = twice * dq[i, lane] - v[i, lane]
    for i in range(steps.kind.size):
        if steps.kind[i] == VISCOUS:  # the spring of a dashpot exists for one step only
            continue
        couple = steps.spring[i, COUPLE]
        z = state.elements.z[i]
        slip = state.elements.slip[i]
        dissipated = state.elements.dissipated[i]
        change = state.products.dq[i]
        for lane in range(lanes):
            middle = z[lane] + 0.5 * (change[lane] - slip[lane])
            dissipated[lane] += of_lane(couple, lane) * middle * slip[lane]
            z[lane] += change[lane] - slip[lane]
        for k in range(1, steps.states[i]):
            for lane in range(lanes):
                state.memory[i, k - 1, lane] = state.memory_after[i, k - 1, lane]


@called_once
def _find_largest_change(steps, state, lanes):
    """Write the largest change of an extension without slips."""
    largest = state.iteration.largest_change
    products(steps.extensions, state.coordinates.dq, state.products.dq, lanes)
    fill(largest, 0.0, lanes)
    for i in range(steps.kind.size):
        for lane in range(lanes):
            largest[lane] = max(largest[lane], abs(state.products.dq[i, lane]))


@compiled
def take_step(other, law, steps, state, lanes):
    """One time step of all lanes, under the mean forcing of the motions; changes the state.

    ``other`` is that of `step_of`, and ``law`` the result of `by_number`. The increments, slips and
    mean forces of contacts, and the extensions and penetrations at the beginning of the step, can
    be read afterwards.
    """
    active = state.iteration.active
    active_next = state.iteration.active_next
    _begin(steps, state, lanes)
    if steps.contact_relief.size > 0:
        _begin_contacts(steps, state, lanes)
    if steps.passes == MOST_VISCOUS_PASSES:
        _find_largest_change(steps, state, lanes)
    fill(active, 1.0, lanes)
    for _ in range(steps.passes):
        fill(active_next, 0.0, lanes)
        _pass_springs(other, law, steps, state, lanes)
        if steps.contact_relief.size > 0:
            _pass_contacts(steps, state, lanes)
        if not any_of(active_next, lanes):
            break
        for lane in range(lanes):
            active[lane] = active_next[lane]
    _end(steps, state, lanes)


sampled_step = variant(take_step, "sampled_step")
sampled_slip = variant(_other_slip, "sampled_slip")


def step_of(law: Any, steps: Steps, state: State, lanes: int) -> tuple[Any, Any]:
    """`take_step` and its ``other`` for such arguments, by their pointers."""
    other = _other_slip if (steps.kind >= VISCOUS).any() else _no_slip
    step = take_step
    if steps.spring.ndim > 2:
        other = sampled_slip
        step = sampled_step
    pointer = by_pointer(other, law, steps, state, 1, lanes)
    return by_pointer(step, pointer, law, steps, state, lanes), pointer


def _system_block(f, step, other, law, steps, state, every, out, first):
    """Steps of a system under the forcing ``f`` (steps, lanes), which change its state.

    ``step`` and ``other`` are those of `step_of`.

    The displacements of the floors after every ``every``-th step [m] are written to the rows of
    ``out`` (samples, rows, lanes) from ``first`` on.
    """
    lanes = f.shape[1]
    for i in range(steps.kind.size):
        fill(state.elements.slip[i], 0.0, lanes)
    sample = 0
    for s in range(f.shape[0]):
        for lane in range(lanes):
            state.motions.forcing[lane] = f[s, lane]
        step(other, law, steps, state, lanes)
        if (s + 1) % every == 0:
            for i in range(steps.shapes.shape[0]):
                times_row(steps.shapes, i, state.coordinates.q, out[sample, first + i], lanes)
            sample += 1


system_block = entry(_system_block)
sampled_block = entry(variant(_system_block, "sampled_block"))
