"""What is watched in a motion: peaks, forces and energies, taken from every time step in one way.

In a step the velocities are constant, ``dq/dt``, and forces have their means. The works of the
ground, of dashpots and of slips therefore have no error of quadrature: with the energies at both
ends, they balance to the tolerance of the passes. What a step does not account for is the missing
energy.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.borrowed import borrowed
from stochlin.kernels.basics.compiled import called_once, compiled
from stochlin.kernels.simulation.contacts import stored_in
from stochlin.kernels.simulation.laws import VISCOUS
from stochlin.kernels.simulation.links import spring_in_step
from stochlin.kernels.simulation.row_products import add_product, fill, products, times_row
from stochlin.kernels.simulation.stepping import turned
from stochlin.kernels.simulation.time_step import COUPLE, POST


@borrowed
class Parts(NamedTuple):
    """To which structure or link masses, elements and dashpots belong."""

    mass: Array  # (n,) [kg]
    elements: int  # number of the elements of structures, which come before those of links
    damping: Array  # (n, n) [N s/m]: the damping matrix of the structures, without links
    shear_of_q: Array  # rows (f, n) [N/m]: storey shears from coordinates
    shear_of_z: Array  # rows (f, e) [N/m]: the same from each z
    watched: Array  # rows (f + e, n): displacements of floors, and extensions of elements
    limit: Array  # (e,) [m]: extension at which a structure falls; infinite where it cannot
    spring: Array  # (l,): number of the element that is the spring of each link
    dashpot: Array  # (l,): number of the element that is its dashpot with an exponent, or -1
    constant: Array  # (l,) [N s/m]: its linear dashpot


@called_once
def watch_displacements(steps, parts, state, lanes):
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
def _watch_floors(steps, parts, state, lanes):
    """Largest absolute accelerations, from the change of the velocities in the step, and shears."""
    dt = steps.dt
    of_rows = state.products
    forcing = state.motions.forcing
    products(steps.shapes, state.coordinates.dq, of_rows.dq, lanes)
    products(steps.shapes, state.coordinates.v, of_rows.v, lanes)
    products(parts.shear_of_q, state.coordinates.q, of_rows.q, lanes)
    products(parts.shear_of_z, state.elements.z, of_rows.z, lanes)
    for i in range(steps.shapes.shape[0]):
        acceleration = state.peaks.acceleration[i]
        shear = state.peaks.shear[i]
        for lane in range(lanes):
            change = of_rows.v[i, lane] - of_rows.dq[i, lane] / dt
            mean = abs(2.0 * change / dt - forcing[lane])
            acceleration[lane] = max(acceleration[lane], mean)
            shear[lane] = max(shear[lane], abs(of_rows.q[i, lane] + of_rows.z[i, lane]))


@called_once
def _watch_masses(steps, parts, state, lanes):
    """Energies put in by the ground, and dissipated by the dashpots of the structures."""
    dt = steps.dt
    dq = state.coordinates.dq
    drag = state.products.v
    forcing = state.motions.forcing
    for i in range(parts.mass.size):
        fill(drag[i], 0.0, lanes)
    add_product(parts.damping, dq, drag, lanes)
    for i in range(parts.mass.size):
        mass = parts.mass[i]
        input_energy = state.coordinates.input_energy[i]
        viscous_energy = state.coordinates.viscous_energy[i]
        for lane in range(lanes):
            moved = dq[i, lane]
            input_energy[lane] += mass * forcing[lane] * moved
            viscous_energy[lane] += drag[i, lane] * moved / dt


@called_once
def _watch_links(steps, parts, state, lanes):
    """Largest forces of links, as means of steps, and energies dissipated."""
    dt = steps.dt
    elements = state.elements
    links = state.links
    change = state.totals.change
    force = state.totals.force
    energy = state.totals.energy
    for link in range(parts.spring.size):
        i = parts.spring[link]
        c = parts.constant[link]
        post = steps.spring[i, POST]
        couple = steps.spring[i, COUPLE]
        times_row(steps.extensions, i, state.coordinates.dq, change, lanes)
        for lane in range(lanes):
            begin = elements.extension[i, lane]
            end = begin + change[lane]
            z_end = elements.z[i, lane]
            z_begin = z_end - (change[lane] - elements.slip[i, lane])
            spring, lost = spring_in_step(post, couple, begin, end, z_begin, z_end)
            drag = c * change[lane] / dt
            force[lane] = spring + drag
            energy[lane] = drag * change[lane] + lost
        dashpot = parts.dashpot[link]
        if dashpot >= 0:
            couple = steps.spring[dashpot, COUPLE]
            for lane in range(lanes):
                drag = 0.5 * couple * (change[lane] - elements.slip[dashpot, lane])
                force[lane] += drag
                energy[lane] += drag * change[lane]
        for lane in range(lanes):
            links.largest_force[link, lane] = max(links.largest_force[link, lane], abs(force[lane]))
            links.dissipated[link, lane] += energy[lane]


def watch(steps, parts, state, lanes):
    """`watch_linked` of structures without links, which is compiled in less time."""
    _watch_floors(steps, parts, state, lanes)
    _watch_masses(steps, parts, state, lanes)
    if not steps.contacts.jumps:
        watch_displacements(steps, parts, state, lanes)


_watch = called_once(watch)


def watch_linked(steps, parts, state, lanes):
    """Update all but impacts by a time step; displacements only where there are no blows."""
    _watch(steps, parts, state, lanes)
    _watch_links(steps, parts, state, lanes)


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
