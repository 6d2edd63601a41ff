"""What is watched in a motion: peaks, forces and energies, taken from every time step in one way.

In a step the velocities are constant, ``dq/dt``, and forces have their means. The works of the ground,
of dashpots and of slips therefore have no error of quadrature: with the energies at both ends, they
balance to the tolerance of the passes. What a step does not account for is kept as ``missing``.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array, Rows, zeros_on_a_line
from stochlin.kernels.basics.compiled import called_often, compiled
from stochlin.kernels.simulation.contacts import stored_in
from stochlin.kernels.simulation.laws import VISCOUS
from stochlin.kernels.simulation.stepping import turned
from stochlin.kernels.simulation.time_step import (
    COUPLE,
    DISSIPATED,
    DQ,
    EXTENSION,
    MEETS,
    POST,
    SLIP,
    SPENT,
    F,
    Q,
    V,
    Z,
    copy,
    fill,
    multiply,
    times_row,
)

# Columns of the arrays of `Account`, see there.
HIGHEST, LOWEST = range(2)
ACCELERATION, SHEAR = range(2)
PULL, DRAINED = range(2)
ENTERING, VISCOUS_LOSS = range(2)
COUNTS, MISSING, MOST, IMBALANCE, FAILED, FIRST, SECOND, THIRD = range(8)


class Parts(NamedTuple):
    """To which structure or link masses, elements and dashpots belong."""

    mass: Array  # (n,) [kg]
    structure: Array  # (n,): number of the structure of each coordinate
    elements: int  # number of the elements of structures, which come before those of links
    damping: Array  # (n, n) [N s/m]: the damping matrix of the structures, without links
    shear: tuple[Rows, Rows]  # (f, n), (f, e) [N/m]: storey shears from coordinates, and from each z
    watched: Rows  # (f + e, n): displacements of floors, and extensions of elements
    limit: Array  # (e,) [m]: extension at which a structure falls; infinite where it cannot
    spring: Array  # (l,): number of the element that is the spring of each link
    dashpot: Array  # (l,): number of the element that is its dashpot with an exponent, or -1
    constant: Array  # (l,) [N s/m]: its linear dashpot


class Account(NamedTuple):
    """What is watched in every motion (the last axis).

    =============  ============================================================================
    displacements  of floors, then extensions of elements: the ``HIGHEST`` and ``LOWEST`` [m]
    floors         largest absolute ``ACCELERATION`` [m/s^2], as means of steps; largest ``SHEAR``
                   of the storey below [N]
    links          largest force ``PULL`` [N], as means of steps; energy ``DRAINED`` so far [J]
    structures     energy ``ENTERING`` from the ground so far [J]; energy dissipated by dashpots of
                   the structure, ``VISCOUS_LOSS`` [J]
    motions        (rows, lanes): ``COUNTS``, 1 if the step counts, 0 if it is taken again or the
                   motion has ended; energy ``MISSING`` in the balance [J]; the ``MOST`` energy put in so
                   far [J]; ``IMBALANCE``, the largest ratio of both; the time ``FAILED`` at which
                   the motion was ended before its end [s], else infinite; and three for one
                   floor, element or link at a time
    =============  ============================================================================
    """

    displacements: Array  # (f + e, columns, lanes)
    floors: Array  # (f, columns, lanes)
    links: Array  # (l, columns, lanes)
    structures: Array  # (s, columns, lanes)
    motions: Array

    @classmethod
    def of(cls, parts: Parts, lanes: int) -> Account:
        """The account of motions before their beginning."""
        floors, structures = len(parts.shear[0].column), int(parts.structure.max()) + 1
        counts = len(parts.watched.column), floors, parts.spring.size, structures
        sizes: Any = *((count, 2) for count in counts), (THIRD + 1,)
        account = cls(*(zeros_on_a_line(*size, lanes) for size in sizes))
        account.motions[FAILED] = np.inf
        return account

    @property
    def largest(self) -> Array:
        """Largest absolute displacements of floors, then extensions of elements [m]."""
        return np.maximum(self.displacements[:, HIGHEST], -self.displacements[:, LOWEST])


@compiled
def copy_account(account, of, other, to, count):
    """Copy what is watched in motions, but for the numbers of one step."""
    copy(account.displacements, of, other.displacements, to, count, 2)
    copy(account.floors, of, other.floors, to, count, 2)
    copy(account.links, of, other.links, to, count, 2)
    copy(account.structures, of, other.structures, to, count, 2)
    for row in (MISSING, MOST):
        for k in range(count):
            other.motions[row, to[k]] = account.motions[row, of[k]]


@compiled
def watch_displacements(dt, parts, moving, account, lanes):
    """Largest and smallest displacements and extensions, also where they turn within the step."""
    (column, weight), coordinates, motions = parts.watched, moving.coordinates, account.motions
    for i in range(column.shape[0]):
        extremes = account.displacements[i]
        times_row(column, weight, i, coordinates, Q, motions, FIRST, lanes)
        times_row(column, weight, i, coordinates, DQ, motions, SECOND, lanes)
        times_row(column, weight, i, moving.known, 0, motions, THIRD, lanes)  # velocity at the beginning
        for lane in range(lanes):
            end, way = motions[FIRST, lane], dt * motions[THIRD, lane]
            motions[SECOND, lane], _ = turned(end - motions[SECOND, lane], end, way)
        for lane in range(lanes):
            most = max(motions[FIRST, lane], motions[SECOND, lane])
            most = most if motions[COUNTS, lane] > 0.0 else 0.0
            extremes[HIGHEST, lane] = max(extremes[HIGHEST, lane], most)
        for lane in range(lanes):
            least = min(motions[FIRST, lane], motions[SECOND, lane])
            least = least if motions[COUNTS, lane] > 0.0 else 0.0
            extremes[LOWEST, lane] = min(extremes[LOWEST, lane], least)


@called_often
def _watch_floors(steps, shear, moving, floors, motions, lanes):
    """Largest absolute accelerations, from the change of the velocities in the step, and shears."""
    (column, weight), dt, ((of_q, share_q), (of_z, share_z)) = steps.shapes, steps.dt, shear
    coordinates, elements, forcing = moving.coordinates, moving.elements, moving.motions
    for i in range(column.shape[0]):
        floor = floors[i]
        times_row(column, weight, i, coordinates, DQ, motions, FIRST, lanes)
        times_row(column, weight, i, coordinates, V, motions, SECOND, lanes)
        for lane in range(lanes):
            change = motions[SECOND, lane] - motions[FIRST, lane] / dt
            mean = abs(2.0 * change / dt - forcing[F, lane])
            floor[ACCELERATION, lane] = max(floor[ACCELERATION, lane], motions[COUNTS, lane] * mean)
        times_row(of_q, share_q, i, coordinates, Q, motions, FIRST, lanes)
        times_row(of_z, share_z, i, elements, Z, motions, SECOND, lanes)
        for lane in range(lanes):
            largest = motions[COUNTS, lane] * abs(motions[FIRST, lane] + motions[SECOND, lane])
            floor[SHEAR, lane] = max(floor[SHEAR, lane], largest)


@called_often
def _watch_masses(dt, parts, coordinates, forcing, structures, motions, lanes):
    """Energies put in by the ground, and dissipated by the dashpots of the structures."""
    for i in range(parts.mass.size):
        mass, energies = parts.mass[i], structures[parts.structure[i]]
        fill(motions, FIRST, 0.0, lanes)
        multiply(parts.damping, i, coordinates, DQ, motions, FIRST, lanes)
        for lane in range(lanes):
            counts, moved = motions[COUNTS, lane], coordinates[i, DQ, lane]
            energies[ENTERING, lane] += counts * (mass * forcing[F, lane] * moved)
            energies[VISCOUS_LOSS, lane] += counts * (motions[FIRST, lane] * moved / dt)


@called_often
def _watch_links(steps, parts, moving, links, motions, lanes):
    """Largest forces of links, as means of steps, and energies dissipated."""
    (column, weight), spring, dt = steps.extensions, steps.spring, steps.dt
    coordinates, elements = moving.coordinates, moving.elements
    for tie in range(parts.spring.size):
        i, other, c, link = parts.spring[tie], parts.dashpot[tie], parts.constant[tie], links[tie]
        post, couple, element = spring[i, POST], spring[i, COUPLE], elements[i]
        times_row(column, weight, i, coordinates, DQ, motions, FIRST, lanes)
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
            largest = motions[COUNTS, lane] * abs(motions[SECOND, lane])
            link[PULL, lane] = max(link[PULL, lane], largest)
            link[DRAINED, lane] += motions[COUNTS, lane] * motions[THIRD, lane]


@compiled
def watch(steps, parts, moving, account, lanes):
    """Update forces, accelerations and energies by a time step that has been taken, where it counts."""
    coordinates, forcing, motions = moving.coordinates, moving.motions, account.motions
    _watch_floors(steps, parts.shear, moving, account.floors, motions, lanes)
    _watch_masses(steps.dt, parts, coordinates, forcing, account.structures, motions, lanes)
    _watch_links(steps, parts, moving, account.links, motions, lanes)


@compiled
def _take_stored(steps, contacts, moving, motions, lanes):
    """Subtract the energies stored in springs and contacts from the row ``FIRST``."""
    (column, weight), (facing, share) = steps.extensions, contacts.rows
    coordinates, elements, meets = moving.coordinates, moving.elements, moving.motions
    for i in range(column.shape[0]):
        if steps.kind[i] != VISCOUS:
            post, couple = steps.spring[i, POST], steps.spring[i, COUPLE]
            times_row(column, weight, i, coordinates, Q, motions, SECOND, lanes)
            for lane in range(lanes):
                extension, z = motions[SECOND, lane], elements[i, Z, lane]
                motions[FIRST, lane] -= 0.5 * (post * extension * extension + couple * z * z)
    if not contacts.jumps:
        for j in range(contacts.gap.size):
            times_row(facing, share, j, coordinates, Q, motions, SECOND, lanes)
            for lane in range(lanes):
                energy = stored_in(contacts.law[j], motions[SECOND, lane] - contacts.gap[j])
                motions[FIRST, lane] -= meets[MEETS, lane] * energy


@compiled
def balance(steps, contacts, parts, moving, account, lanes):
    """Update the energy that is missing in the balance of all structures, and its largest share."""
    motions, coordinates = account.motions, moving.coordinates
    fill(motions, FIRST, 0.0, lanes)
    for number in range(account.structures.shape[0]):
        for lane in range(lanes):
            motions[FIRST, lane] += account.structures[number, ENTERING, lane]
    for lane in range(lanes):
        motions[MOST, lane] = max(motions[MOST, lane], abs(motions[FIRST, lane]))
    _subtract(account.structures, VISCOUS_LOSS, motions, lanes)
    _subtract(account.links, DRAINED, motions, lanes)
    _subtract(moving.contacts, DISSIPATED, motions, lanes)
    _subtract(moving.elements[: parts.elements], SPENT, motions, lanes)
    for i in range(parts.mass.size):
        for lane in range(lanes):
            v = coordinates[i, V, lane]
            motions[FIRST, lane] -= 0.5 * parts.mass[i] * v * v
    _take_stored(steps, contacts, moving, motions, lanes)
    for lane in range(lanes):
        most = motions[MOST, lane]
        if motions[COUNTS, lane] > 0.0:
            motions[MISSING, lane] = motions[FIRST, lane]
            ratio = abs(motions[FIRST, lane]) / most if most > 0.0 else 0.0
            motions[IMBALANCE, lane] = max(motions[IMBALANCE, lane], ratio)


@compiled
def _subtract(energies, column, motions, lanes):
    """Subtract a column of energies from the row ``FIRST``."""
    for number in range(energies.shape[0]):
        for lane in range(lanes):
            motions[FIRST, lane] -= energies[number, column, lane]
