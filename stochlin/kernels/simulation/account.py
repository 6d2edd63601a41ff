"""What is watched in a motion: peaks, forces and energies, taken from every time step in one way.

In a step the velocities are constant, ``dq/dt``, and forces have their means. The works of the
ground, of dashpots and of slips therefore have no error of quadrature: with the energies at both
ends, they balance to the tolerance of the passes. What a step does not account for is the missing
energy.

Forces and accelerations are watched at the ends of steps. Where an element begins to yield, the
accelerations of its floors have a corner, which can be their peak: there they are watched within
the step.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.borrowed import borrowed
from stochlin.kernels.basics.compiled import called_once, compiled
from stochlin.kernels.simulation.contacts import stored_in
from stochlin.kernels.simulation.laws import BILINEAR, VISCOUS
from stochlin.kernels.simulation.row_products import add_product, fill, products, times_row
from stochlin.kernels.simulation.stepping import turned
from stochlin.kernels.simulation.time_step import COUPLE, POST, STRENGTH

# elastic part of an extension, over that at yield, beyond which an element had been yielding before
NEARLY = 1.0 - 1e-6


@borrowed
class Parts(NamedTuple):
    """To which structure or link masses, elements and dashpots belong."""

    mass: Array  # (n,) [kg]
    elements: int  # number of the elements of structures, which come before those of links
    damping: Array  # (n, n) [N s/m]: the damping matrix of the structures, without links
    contacts: int  # number of contacts, also of steps without them
    # rows (2 f, e + n + c): accelerations of floors [1/kg], then storey shears [-], by forces of
    # elements, dashpots and contacts
    of_forces: Array
    carried: Array  # (f,): share by which a floor moves with the ground, as modes leave out mass
    watched: Array  # rows (f + e, n): displacements of floors, and extensions of elements
    limit: Array  # (e,) [m]: extension at which a structure falls; infinite where it cannot
    spring: Array  # (l,): number of the element that is the spring of each link
    dashpot: Array  # (l,): number of the element that is its dashpot with an exponent, or -1
    constant: Array  # (l,) [N s/m]: its linear dashpot


def add_works(steps, parts, state, lanes):
    """Add the energies of a time step: put in by the ground, dissipated by dashpots of structures.

    The mean forces of these dashpots in the step are the means of those at both ends. Structures
    without links have a function of their own, which is compiled in less time.
    """
    dq = state.coordinates.dq
    drag_after = state.products.v
    forcing = state.motions.forcing
    for i in range(parts.mass.size):
        fill(drag_after[i], 0.0, lanes)
    add_product(parts.damping, state.coordinates.v, drag_after, lanes)
    for i in range(parts.mass.size):
        mass = parts.mass[i]
        drag = state.coordinates.drag[i]
        input_energy = state.coordinates.input_energy[i]
        viscous_energy = state.coordinates.viscous_energy[i]
        for lane in range(lanes):
            moved = dq[i, lane]
            input_energy[lane] += mass * forcing[lane] * moved
            viscous_energy[lane] += 0.5 * (drag[lane] + drag_after[i, lane]) * moved
            drag[lane] = drag_after[i, lane]


@called_once
def _add_works_of_links(steps, parts, state, lanes):
    """Add the energies dissipated by links."""
    dt = steps.dt
    elements = state.elements
    links = state.links
    change = state.totals.change
    energy = state.totals.energy
    for link in range(parts.spring.size):
        i = parts.spring[link]
        c = parts.constant[link]
        couple = steps.spring[i, COUPLE]
        times_row(steps.extensions, i, state.coordinates.dq, change, lanes)
        for lane in range(lanes):
            slip = elements.slip[i, lane]
            elastic = couple * (elements.z[i, lane] - 0.5 * (change[lane] - slip))
            energy[lane] = c * change[lane] / dt * change[lane] + elastic * slip
        dashpot = parts.dashpot[link]
        if dashpot >= 0:
            couple = steps.spring[dashpot, COUPLE]
            for lane in range(lanes):
                drag = 0.5 * couple * (change[lane] - elements.slip[dashpot, lane])
                energy[lane] += drag * change[lane]
        for lane in range(lanes):
            links.dissipated[link, lane] += energy[lane]


_add_works = called_once(add_works)


def add_works_of_linked(steps, parts, state, lanes):
    """Add the energies of a time step of structures with links."""
    _add_works(steps, parts, state, lanes)
    _add_works_of_links(steps, parts, state, lanes)


@called_once
def _watch_displacements(steps, parts, state, lanes):
    """Largest and smallest displacements and extensions, also where they turn within the step."""
    dt = steps.dt
    rows = parts.watched
    of_rows = state.products
    products(rows, state.coordinates.q, of_rows.q, lanes)
    products(rows, state.coordinates.dq, of_rows.dq, lanes)
    products(rows, state.beginning, of_rows.v, lanes)
    for i in range(rows.shape[0]):
        highest = state.peaks.highest[i]
        lowest = state.peaks.lowest[i]
        for lane in range(lanes):
            end = of_rows.q[i, lane]
            turn, _ = turned(end - of_rows.dq[i, lane], end, dt * of_rows.v[i, lane])
            highest[lane] = max(highest[lane], end, turn)
            lowest[lane] = min(lowest[lane], end, turn)


@called_once
def _find_forces(steps, parts, extension, state, lanes):
    """Write the forces at the end of the step: of elements, dashpots of structures, contacts.

    Those of links have their dashpots with them. Update the largest forces of links.
    """
    contacts = steps.contacts
    elements = steps.kind.size
    force = state.products.force
    for i in range(elements):
        post = steps.spring[i, POST]
        couple = steps.spring[i, COUPLE]
        for lane in range(lanes):
            force[i, lane] = post * extension[i, lane] + couple * state.elements.z[i, lane]
    _add_dashpots_of_links(steps, parts, force, state, lanes)
    for i in range(parts.mass.size):
        drag = force[elements + i]
        for lane in range(lanes):
            drag[lane] = state.coordinates.drag[i, lane]
    first_push = elements + parts.mass.size
    for j in range(parts.contacts):
        fill(force[first_push + j], 0.0, lanes)
    for j in range(contacts.gap.size):  # none in steps without contacts
        push = force[first_push + j]
        for lane in range(lanes):
            if contacts.jumps:
                push[lane] = state.contacts.sticks[j, lane] * state.contacts.mean_force[j, lane]
            elif not np.isnan(state.impacts.begin[j, lane]):
                push[lane] = state.impacts.force[j, lane]


@called_once
def _add_dashpots_of_links(steps, parts, force, state, lanes):
    """Add the forces of the dashpots of links to those of their springs."""
    rate = state.totals.change
    for link in range(parts.spring.size):
        i = parts.spring[link]
        constant = parts.constant[link]
        dashpot = parts.dashpot[link]
        times_row(steps.extensions, i, state.coordinates.v, rate, lanes)
        for lane in range(lanes):
            force[i, lane] += constant * rate[lane]
        if dashpot >= 0:
            fill(force[dashpot], 0.0, lanes)
            for lane in range(lanes):
                c = state.parameters[dashpot, 0, lane]
                a = state.parameters[dashpot, 1, lane]
                force[i, lane] += np.copysign(c * abs(rate[lane]) ** a, rate[lane])
        largest = state.links.largest_force[link]
        for lane in range(lanes):
            largest[lane] = max(largest[lane], abs(force[i, lane]))


def watch(steps: Any, parts: Any, state: Any, lanes: int) -> None:
    """Largest displacements, storey shears, accelerations and forces of links, after impacts."""
    floors = steps.shapes.shape[0]
    forcing = state.motions.forcing
    at_end = state.products.q
    _watch_displacements(steps, parts, state, lanes)
    _find_forces(steps, parts, state.products.q[floors:], state, lanes)
    products(parts.of_forces, state.products.force, at_end, lanes)
    for i in range(floors):
        acceleration = at_end[i]
        shear = at_end[floors + i]
        largest = state.peaks.acceleration[i]
        largest_shear = state.peaks.shear[i]
        for lane in range(lanes):
            acceleration[lane] -= parts.carried[i] * forcing[lane]
            largest[lane] = max(largest[lane], abs(acceleration[lane]))
            largest_shear[lane] = max(largest_shear[lane], abs(shear[lane]))
    if not steps.contacts.jumps:
        for i in range(steps.kind.size):
            if steps.kind[i] == BILINEAR:
                change = state.products.dq[floors + i]
                _watch_yield(steps, parts, i, change, at_end, state, lanes)


@called_once
def _watch_yield(steps, parts, i, change, at_end, state, lanes):
    """Accelerations where element ``i``, extending by ``change``, begins to yield in the step."""
    strength = steps.spring[i, STRENGTH]
    for lane in range(lanes):
        slip = state.elements.slip[i, lane]
        if slip != 0.0:
            before = state.elements.z[i, lane] - (change[lane] - slip)
            if abs(before) < NEARLY * strength:
                share = (np.copysign(strength, slip) - before) / change[lane]
                beyond = share * steps.spring[i, COUPLE] * slip
                _watch_corner(steps, parts, i, share, beyond, at_end, state, lane)


@compiled
def _watch_corner(steps, parts, i, share, beyond, at_end, state, lane):
    """Accelerations at a ``share`` of the step, where the force of element ``i`` has a corner.

    The force is there ``beyond`` what it would be if it grew evenly in the step. All else grows
    evenly, and the means of the step are those of both ends.
    """
    dt = steps.dt
    for floor in range(steps.shapes.shape[0]):
        for place in range(parts.of_forces.shape[1]):
            weight = parts.of_forces[floor, place]["weight"]
            if parts.of_forces[floor, place]["column"] == i and weight != 0.0:
                begin = state.products.v[floor, lane]
                moved = state.products.dq[floor, lane]
                mean = 2.0 * (moved / dt - begin) / dt - state.motions.forcing[lane]
                corner = weight * beyond + 2.0 * (1.0 - share) * mean
                corner += (2.0 * share - 1.0) * at_end[floor, lane]
                largest = state.peaks.acceleration[floor]
                largest[lane] = max(largest[lane], abs(corner))


@called_once
def _subtract_stored(steps, state, energy, lanes):
    """Subtract the energies stored in springs and contacts from an ``energy``."""
    contacts = steps.contacts
    z = state.elements.z
    meets = state.motions.meets
    extension = state.products.q
    penetration = state.products.dq
    products(steps.extensions, state.coordinates.q, extension, lanes)
    for i in range(steps.kind.size):
        if steps.kind[i] != VISCOUS:
            post = steps.spring[i, POST]
            couple = steps.spring[i, COUPLE]
            for lane in range(lanes):
                elastic = post * extension[i, lane] * extension[i, lane]
                energy[lane] -= 0.5 * (elastic + couple * z[i, lane] * z[i, lane])
    if not contacts.jumps:
        products(contacts.rows, state.coordinates.q, penetration, lanes)
        for j in range(contacts.gap.size):
            for lane in range(lanes):
                stored = stored_in(contacts.law[j], penetration[j, lane] - contacts.gap[j])
                energy[lane] -= meets[lane] * stored


def balance(steps, parts, time, state, lanes):
    """Update the energy that is missing in the balance of all structures, and its largest share.

    End the motions in which an extension is beyond its limit, or not a number, at this ``time``
    [s].
    """
    motions = state.motions
    coordinates = state.coordinates
    energy = state.totals.energy
    fill(energy, 0.0, lanes)
    _add(coordinates.input_energy, 1.0, energy, lanes)
    for lane in range(lanes):
        motions.largest_input[lane] = max(motions.largest_input[lane], abs(energy[lane]))
    _add(coordinates.viscous_energy, -1.0, energy, lanes)
    _add(state.links.dissipated, -1.0, energy, lanes)
    _add(state.contacts.dissipated, -1.0, energy, lanes)
    _add(state.elements.dissipated[: parts.elements], -1.0, energy, lanes)
    for i in range(parts.mass.size):
        for lane in range(lanes):
            v = coordinates.v[i, lane]
            energy[lane] -= 0.5 * parts.mass[i] * v * v
    _subtract_stored(steps, state, energy, lanes)
    for lane in range(lanes):
        largest = motions.largest_input[lane]
        missing = energy[lane]
        motions.missing_energy[lane] = missing
        ratio = abs(missing) / largest if largest > 0.0 else 0.0
        motions.imbalance[lane] = max(motions.imbalance[lane], ratio)
    for i in range(parts.limit.size):
        for lane in range(lanes):
            reached = abs(state.products.q[i, lane])  # by `_subtract_stored`
            if not reached <= parts.limit[i] and motions.failed[lane] == np.inf:
                motions.failed[lane] = time


@compiled
def _add(energies, sign, total, lanes):
    """Add energies (n, lanes) with this sign to their total."""
    for number in range(energies.shape[0]):
        for lane in range(lanes):
            total[lane] += sign * energies[number, lane]
