"""What is watched in a motion: peaks, forces and energies, taken from every time step in one way.

In a step the velocities are constant, ``dq/dt``, and forces have their means. The works of the ground,
of dashpots and of slips therefore have no error of quadrature: with the energies at both ends, they
balance to the tolerance of the passes. What a step does not account for is kept as ``MISSING``.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.compiled import called_once, compiled
from stochlin.kernels.simulation.contacts import stored_in
from stochlin.kernels.simulation.laws import VISCOUS
from stochlin.kernels.simulation.moving import (
    ACCELERATION,
    DISSIPATED,
    DQ,
    DRAINED,
    ENTERING,
    EXTENSION,
    FAILED,
    FIRST,
    HIGHEST,
    IMBALANCE,
    LOWEST,
    MEETS,
    MISSING,
    MOST,
    OF_DQ,
    OF_Q,
    OF_V,
    OF_Z,
    PULL,
    SECOND,
    SHEAR,
    SLIP,
    SPENT,
    THIRD,
    VISCOUS_LOSS,
    F,
    Q,
    V,
    Z,
    fill,
    multiply,
    products,
    times_row,
)
from stochlin.kernels.simulation.stepping import turned
from stochlin.kernels.simulation.time_step import COUPLE, POST


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
def watch_displacements(steps, parts, moving, lanes):
    """Largest and smallest displacements and extensions, also where they turn within the step."""
    rows, dt, coordinates, of_rows = parts.watched, steps.dt, moving.coordinates, moving.products
    products(rows, coordinates, Q, of_rows, OF_Q, lanes)
    products(rows, coordinates, DQ, of_rows, OF_DQ, lanes)
    products(rows, moving.known, 0, of_rows, OF_V, lanes)  # velocity at the beginning
    for i in range(rows.shape[0]):
        extremes, row = moving.watched[i], of_rows[i]
        for lane in range(lanes):
            end = row[OF_Q, lane]
            turn, _ = turned(end - row[OF_DQ, lane], end, dt * row[OF_V, lane])
            extremes[HIGHEST, lane] = max(extremes[HIGHEST, lane], end, turn)
            extremes[LOWEST, lane] = min(extremes[LOWEST, lane], end, turn)


@called_once
def _watch_floors(steps, parts, moving, lanes):
    """Largest absolute accelerations, from the change of the velocities in the step, and shears."""
    rows, of_q, of_z, dt = steps.shapes, parts.shear_of_q, parts.shear_of_z, steps.dt
    coordinates, motions, of_rows = moving.coordinates, moving.motions, moving.products
    products(rows, coordinates, DQ, of_rows, OF_DQ, lanes)
    products(rows, coordinates, V, of_rows, OF_V, lanes)
    products(of_q, coordinates, Q, of_rows, OF_Q, lanes)
    products(of_z, moving.elements, Z, of_rows, OF_Z, lanes)
    for i in range(rows.shape[0]):
        floor = moving.watched[i]
        for lane in range(lanes):
            change = of_rows[i, OF_V, lane] - of_rows[i, OF_DQ, lane] / dt
            mean = abs(2.0 * change / dt - motions[F, lane])
            floor[ACCELERATION, lane] = max(floor[ACCELERATION, lane], mean)
            largest = abs(of_rows[i, OF_Q, lane] + of_rows[i, OF_Z, lane])
            floor[SHEAR, lane] = max(floor[SHEAR, lane], largest)


@called_once
def _watch_masses(dt, parts, coordinates, drags, motions, lanes):
    """Energies put in by the ground, and dissipated by the dashpots of the structures."""
    for i in range(parts.mass.size):
        fill(drags[i], 0, 0.0, lanes)
    multiply(parts.damping, coordinates, DQ, drags, 0, lanes)
    for i in range(parts.mass.size):
        mass = parts.mass[i]
        for lane in range(lanes):
            moved = coordinates[i, DQ, lane]
            coordinates[i, ENTERING, lane] += mass * motions[F, lane] * moved
            coordinates[i, VISCOUS_LOSS, lane] += drags[i, 0, lane] * moved / dt


@called_once
def _watch_links(steps, parts, moving, lanes):
    """Largest forces of links, as means of steps, and energies dissipated."""
    spring, dt, elements, motions = steps.spring, steps.dt, moving.elements, moving.motions
    for tie in range(parts.spring.size):
        i, other, c, link = parts.spring[tie], parts.dashpot[tie], parts.constant[tie], moving.links[tie]
        post, couple, element = spring[i, POST], spring[i, COUPLE], elements[i]
        times_row(steps.extensions, i, moving.coordinates, DQ, motions, FIRST, lanes)
        for lane in range(lanes):
            change, slip = motions[FIRST, lane], element[SLIP, lane]
            held = couple * (element[Z, lane] - 0.5 * (change - slip))
            drag = c * change / dt
            motions[SECOND, lane] = post * (element[EXTENSION, lane] + 0.5 * change) + held + drag
            motions[THIRD, lane] = drag * change + held * slip
        if other >= 0:
            own, element = spring[other, COUPLE], elements[other]
            for lane in range(lanes):
                change = motions[FIRST, lane]
                drag = 0.5 * own * (change - element[SLIP, lane])
                motions[SECOND, lane] += drag
                motions[THIRD, lane] += drag * change
        for lane in range(lanes):
            link[PULL, lane] = max(link[PULL, lane], abs(motions[SECOND, lane]))
            link[DRAINED, lane] += motions[THIRD, lane]


def watch(steps, parts, moving, lanes):
    """`watch_linked` of structures without links, which is compiled in less time."""
    _watch_floors(steps, parts, moving, lanes)
    _watch_masses(steps.dt, parts, moving.coordinates, moving.products, moving.motions, lanes)
    if not steps.contacts.jumps:
        watch_displacements(steps, parts, moving, lanes)


_watch = called_once(watch)


def watch_linked(steps, parts, moving, lanes):
    """Update all but impacts by a time step; displacements only where there are no blows."""
    _watch(steps, parts, moving, lanes)
    _watch_links(steps, parts, moving, lanes)


@called_once
def _take_stored(steps, moving, lanes):
    """Subtract the energies stored in springs and contacts from the row ``FIRST``."""
    contacts, coordinates, elements = steps.contacts, moving.coordinates, moving.elements
    motions, of_rows = moving.motions, moving.products
    products(steps.extensions, coordinates, Q, of_rows, OF_Q, lanes)
    for i in range(steps.kind.size):
        if steps.kind[i] != VISCOUS:
            post, couple = steps.spring[i, POST], steps.spring[i, COUPLE]
            for lane in range(lanes):
                extension, z = of_rows[i, OF_Q, lane], elements[i, Z, lane]
                motions[FIRST, lane] -= 0.5 * (post * extension * extension + couple * z * z)
    if not contacts.jumps:
        products(contacts.rows, coordinates, Q, of_rows, OF_DQ, lanes)
        for j in range(contacts.gap.size):
            for lane in range(lanes):
                energy = stored_in(contacts.law[j], of_rows[j, OF_DQ, lane] - contacts.gap[j])
                motions[FIRST, lane] -= motions[MEETS, lane] * energy


def balance(steps, parts, time, moving, lanes):
    """Update the energy that is missing in the balance of all structures, and its largest share.

    End the motions in which an extension is beyond its limit, or not a number, at this ``time`` [s].
    """
    motions, coordinates = moving.motions, moving.coordinates
    fill(motions, FIRST, 0.0, lanes)
    _add(coordinates, ENTERING, 1.0, motions, lanes)
    for lane in range(lanes):
        motions[MOST, lane] = max(motions[MOST, lane], abs(motions[FIRST, lane]))
    _add(coordinates, VISCOUS_LOSS, -1.0, motions, lanes)
    _add(moving.links, DRAINED, -1.0, motions, lanes)
    _add(moving.contacts, DISSIPATED, -1.0, motions, lanes)
    _add(moving.elements[: parts.elements], SPENT, -1.0, motions, lanes)
    for i in range(parts.mass.size):
        for lane in range(lanes):
            v = coordinates[i, V, lane]
            motions[FIRST, lane] -= 0.5 * parts.mass[i] * v * v
    _take_stored(steps, moving, lanes)
    for lane in range(lanes):
        most, missing = motions[MOST, lane], motions[FIRST, lane]
        motions[MISSING, lane] = missing
        ratio = abs(missing) / most if most > 0.0 else 0.0
        motions[IMBALANCE, lane] = max(motions[IMBALANCE, lane], ratio)
    for i in range(parts.limit.size):
        for lane in range(lanes):
            reached = abs(moving.products[i, OF_Q, lane])  # by `_take_stored`
            if not reached <= parts.limit[i] and motions[FAILED, lane] == np.inf:
                motions[FAILED, lane] = time


@compiled
def _add(energies, column, sign, motions, lanes):
    """Add a column of energies with this sign to the row ``FIRST``."""
    for number in range(energies.shape[0]):
        for lane in range(lanes):
            motions[FIRST, lane] += sign * energies[number, column, lane]
