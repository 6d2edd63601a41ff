"""What is watched in a motion: peaks, forces and energies, taken from every time step in one way.

In a step the velocities are constant, ``dq/dt``, and forces have their means. The works of the ground,
of dashpots and of slips therefore have no error of quadrature: with the energies at both ends, they
balance to the tolerance of the passes. What a step does not account for is kept as ``MISSING``.
"""

from __future__ import annotations

from typing import NamedTuple

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
    FIRST,
    HIGHEST,
    IMBALANCE,
    LOWEST,
    MEETS,
    MISSING,
    MOST,
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


def watch_displacements(steps, parts, moving, lanes):
    """Largest and smallest displacements and extensions, also where they turn within the step."""
    rows, dt, coordinates, motions = parts.watched, steps.dt, moving.coordinates, moving.motions
    for i in range(rows.shape[0]):
        extremes = moving.watched[i]
        times_row(rows, i, coordinates, Q, motions, FIRST, lanes)
        times_row(rows, i, coordinates, DQ, motions, SECOND, lanes)
        times_row(rows, i, moving.known, 0, motions, THIRD, lanes)  # velocity at the beginning
        for lane in range(lanes):
            end, way = motions[FIRST, lane], dt * motions[THIRD, lane]
            motions[SECOND, lane], _ = turned(end - motions[SECOND, lane], end, way)
        for lane in range(lanes):
            most = max(motions[FIRST, lane], motions[SECOND, lane])
            extremes[HIGHEST, lane] = max(extremes[HIGHEST, lane], most)
        for lane in range(lanes):
            least = min(motions[FIRST, lane], motions[SECOND, lane])
            extremes[LOWEST, lane] = min(extremes[LOWEST, lane], least)


@called_once
def _watch_floors(steps, parts, moving, lanes):
    """Largest absolute accelerations, from the change of the velocities in the step, and shears."""
    rows, of_q, of_z, dt = steps.shapes, parts.shear_of_q, parts.shear_of_z, steps.dt
    coordinates, elements, motions = moving.coordinates, moving.elements, moving.motions
    for i in range(rows.shape[0]):
        floor = moving.watched[i]
        times_row(rows, i, coordinates, DQ, motions, FIRST, lanes)
        times_row(rows, i, coordinates, V, motions, SECOND, lanes)
        for lane in range(lanes):
            change = motions[SECOND, lane] - motions[FIRST, lane] / dt
            mean = abs(2.0 * change / dt - motions[F, lane])
            floor[ACCELERATION, lane] = max(floor[ACCELERATION, lane], mean)
        times_row(of_q, i, coordinates, Q, motions, FIRST, lanes)
        times_row(of_z, i, elements, Z, motions, SECOND, lanes)
        for lane in range(lanes):
            largest = abs(motions[FIRST, lane] + motions[SECOND, lane])
            floor[SHEAR, lane] = max(floor[SHEAR, lane], largest)


@called_once
def _watch_masses(dt, parts, coordinates, motions, lanes):
    """Energies put in by the ground, and dissipated by the dashpots of the structures."""
    for i in range(parts.mass.size):
        mass = parts.mass[i]
        fill(motions, FIRST, 0.0, lanes)
        multiply(parts.damping, i, coordinates, DQ, motions, FIRST, lanes)
        for lane in range(lanes):
            moved = coordinates[i, DQ, lane]
            coordinates[i, ENTERING, lane] += mass * motions[F, lane] * moved
            coordinates[i, VISCOUS_LOSS, lane] += motions[FIRST, lane] * moved / dt


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
    """Update forces, accelerations and energies by a time step that has been taken."""
    _watch_floors(steps, parts, moving, lanes)
    _watch_masses(steps.dt, parts, moving.coordinates, moving.motions, lanes)
    _watch_links(steps, parts, moving, lanes)


@called_once
def _take_stored(steps, contacts, moving, lanes):
    """Subtract the energies stored in springs and contacts from the row ``FIRST``."""
    coordinates, elements, motions = moving.coordinates, moving.elements, moving.motions
    for i in range(steps.kind.size):
        if steps.kind[i] != VISCOUS:
            post, couple = steps.spring[i, POST], steps.spring[i, COUPLE]
            times_row(steps.extensions, i, coordinates, Q, motions, SECOND, lanes)
            for lane in range(lanes):
                extension, z = motions[SECOND, lane], elements[i, Z, lane]
                motions[FIRST, lane] -= 0.5 * (post * extension * extension + couple * z * z)
    if not contacts.jumps:
        for j in range(contacts.gap.size):
            times_row(contacts.rows, j, coordinates, Q, motions, SECOND, lanes)
            for lane in range(lanes):
                energy = stored_in(contacts.law[j], motions[SECOND, lane] - contacts.gap[j])
                motions[FIRST, lane] -= motions[MEETS, lane] * energy


def balance(steps, contacts, parts, moving, lanes):
    """Update the energy that is missing in the balance of all structures, and its largest share."""
    motions, coordinates = moving.motions, moving.coordinates
    fill(motions, FIRST, 0.0, lanes)
    for i in range(parts.mass.size):
        for lane in range(lanes):
            motions[FIRST, lane] += coordinates[i, ENTERING, lane]
    for lane in range(lanes):
        motions[MOST, lane] = max(motions[MOST, lane], abs(motions[FIRST, lane]))
    _subtract(coordinates, VISCOUS_LOSS, motions, lanes)
    _subtract(moving.links, DRAINED, motions, lanes)
    _subtract(moving.contacts, DISSIPATED, motions, lanes)
    _subtract(moving.elements[: parts.elements], SPENT, motions, lanes)
    for i in range(parts.mass.size):
        for lane in range(lanes):
            v = coordinates[i, V, lane]
            motions[FIRST, lane] -= 0.5 * parts.mass[i] * v * v
    _take_stored(steps, contacts, moving, lanes)
    for lane in range(lanes):
        most, missing = motions[MOST, lane], motions[FIRST, lane]
        motions[MISSING, lane] = missing
        ratio = abs(missing) / most if most > 0.0 else 0.0
        motions[IMBALANCE, lane] = max(motions[IMBALANCE, lane], ratio)


@compiled
def _subtract(energies, column, motions, lanes):
    """Subtract a column of energies from the row ``FIRST``."""
    for number in range(energies.shape[0]):
        for lane in range(lanes):
            motions[FIRST, lane] -= energies[number, column, lane]
