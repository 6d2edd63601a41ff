"""What is watched in a motion: peaks, forces and energies, taken from every time step in one way.

In a step the velocities are constant, ``dq/dt``, and forces have their means. The works of the ground,
of dashpots and of slips therefore have no error of quadrature: with the energies at both ends, they
balance to the tolerance of the passes. What a step does not account for is kept as ``missing``.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.compiled import compiled
from stochlin.kernels.basics.rows import Rows
from stochlin.kernels.simulation.contacts import stored_in
from stochlin.kernels.simulation.laws import VISCOUS
from stochlin.kernels.simulation.stepping import turned
from stochlin.kernels.simulation.time_step import (
    COUPLE,
    KIND,
    POST,
    Elements,
    Places,
    fill,
    first_rows,
    multiply,
    times_row,
)


class Parts(NamedTuple):
    """To which structure or link masses, elements and dashpots belong."""

    mass: Array  # (n,) [kg]
    structure: Array  # (n,): number of the structure of each coordinate
    owner: Array  # (e,): number of the structure of each element; -1 for those of links
    damping: Array  # (n, n) [N s/m]: the damping matrix of the structures, without links
    shear: tuple[Rows, Rows]  # (f, n), (f, e) [N/m]: storey shears from coordinates, and from each z
    limit: Array  # (e,) [m]: extension at which a structure falls; infinite where it cannot
    spring: Array  # (l,): number of the element that is the spring of each link
    dashpot: Array  # (l,): number of the element that is its dashpot with an exponent, or -1
    constant: Array  # (l,) [N s/m]: its linear dashpot


class Account(NamedTuple):
    """The rows of ``x``, after those of `Places`, where what is watched stands.

    As there, for f floors, s structures, e elements, l links, c contacts and n coordinates.
    """

    first: Annotated[int, 0]
    highest: Annotated[int, "f"]  # largest displacement [m]
    lowest: Annotated[int, "f"]  # smallest displacement [m]
    acceleration: Annotated[int, "f"]  # largest absolute acceleration [m/s^2], as means of steps
    shear: Annotated[int, "f"]  # largest shear of the storey below each floor [N]
    pull: Annotated[int, "l"]  # largest force of each link [N], as means of steps
    stretch: Annotated[int, "e"]  # largest absolute extension of each element [m]
    entering: Annotated[int, "s"]  # energy put in by the ground so far [J]
    viscous: Annotated[int, "s"]  # energy dissipated by the dashpots of the structure so far [J]
    drained: Annotated[int, "l"]  # energy dissipated in each link so far [J]
    lost: Annotated[int, "c"]  # energy dissipated in each contact so far [J]
    missing: Annotated[int, 1]  # energy that the steps did not account for [J]
    most: Annotated[int, 1]  # largest energy put in so far [J]
    imbalance: Annotated[int, 1]  # largest ratio of both
    failed: Annotated[int, 1]  # time at which the motion was ended, before its end [s]; else infinite
    begin: Annotated[int, "c"]  # time at which the present impact began [s]; NaN if there is none
    end: Annotated[int, "c"]  # time at which its force ended [s]
    speed: Annotated[int, "c"]  # rate of penetration at its beginning [m/s]
    largest: Annotated[int, "c"]  # its largest force [N]
    last: Annotated[int, "c"]  # its force at the end of the last step [N]
    rise: Annotated[int, "c"]  # rate at which the force grew in that step [N/s]
    span: Annotated[int, "c"]  # duration of contact in that step [s]
    before: Annotated[int, "c"]  # energy dissipated in the contact before it [J]
    handed: Annotated[int, "c"]  # its work on the structure on its right [J]
    deepest: Annotated[int, "c"]  # its largest penetration [m]
    work: Annotated[int, 0]
    way: Annotated[int, "n"]  # displacements by a blow within a step [m]
    gain: Annotated[int, "n"]  # accelerations in the step without blows [m/s^2]
    # 1 if the step counts in this lane; 0 if it is taken again, or the motion has ended
    counts: Annotated[int, 1]
    scratch_1: Annotated[int, 1]
    scratch_2: Annotated[int, 1]
    scratch_3: Annotated[int, 1]  # work of one floor, element or link
    rows: Annotated[int, 0]  # number of rows of ``x``

    @classmethod
    def of(
        cls, places: Places, elements: Elements, structures: int, links: int, contacts: int
    ) -> Account:
        """The rows after ``places``."""
        n, e = elements.system.mass.size, elements.kind.size
        counts = {"f": len(elements.system.shapes), "s": structures, "l": links, "c": contacts}
        return cls(*first_rows(cls, places.rows, counts | {"n": n, "e": e}))


@compiled
def _watch_accelerations(column, weight, dt, at, to, x, lanes):
    """Largest absolute accelerations, from the change of the velocities in the step."""
    most, change, v = to.acceleration, to.scratch_1, to.scratch_2
    for i in range(column.shape[0]):
        times_row(column, weight, i, x, at.dq, change, lanes)
        times_row(column, weight, i, x, at.v, v, lanes)
        for lane in range(lanes):
            mean = abs(2.0 * (x[v, lane] - x[change, lane] / dt) / dt - x[at.f, lane])
            x[most + i, lane] = max(x[most + i, lane], x[to.counts, lane] * mean)


@compiled
def _farthest(column, weight, i, dt, at, to, x, lanes):
    """Write a weighted sum of displacements at the end of the step, and where it turns within it."""
    end, turn, change = to.scratch_1, to.scratch_2, to.scratch_3
    times_row(column, weight, i, x, at.q, end, lanes)
    times_row(column, weight, i, x, at.dq, change, lanes)
    times_row(column, weight, i, x, at.known, turn, lanes)  # the velocity at the beginning
    for lane in range(lanes):
        begin, way = x[end, lane] - x[change, lane], dt * x[turn, lane]
        x[turn, lane], _ = turned(begin, x[end, lane], way)


@compiled
def watch_displacements(steps, at, to, x, lanes):
    """Largest and smallest displacements."""
    column, weight = steps.shapes
    u, turn = to.scratch_1, to.scratch_2
    for i in range(column.shape[0]):
        highest, lowest = to.highest + i, to.lowest + i
        _farthest(column, weight, i, steps.dt, at, to, x, lanes)
        for lane in range(lanes):
            most = max(x[u, lane], x[turn, lane]) if x[to.counts, lane] > 0.0 else 0.0
            x[highest, lane] = max(x[highest, lane], most)
        for lane in range(lanes):
            least = min(x[u, lane], x[turn, lane]) if x[to.counts, lane] > 0.0 else 0.0
            x[lowest, lane] = min(x[lowest, lane], least)


@compiled
def _watch_shears(column, weight, column_z, weight_z, at, to, x, lanes):
    """Largest storey shears at the ends of steps."""
    most, of_q, of_z = to.shear, to.scratch_1, to.scratch_2
    for i in range(column.shape[0]):
        times_row(column, weight, i, x, at.q, of_q, lanes)
        times_row(column_z, weight_z, i, x, at.z, of_z, lanes)
        for lane in range(lanes):
            shear = abs(x[of_q, lane] + x[of_z, lane])
            x[most + i, lane] = max(x[most + i, lane], x[to.counts, lane] * shear)


@compiled
def _watch_extensions(column, weight, dt, at, to, x, lanes):
    """Largest absolute extensions."""
    most, end, turn = to.stretch, to.scratch_1, to.scratch_2
    for i in range(column.shape[0]):
        _farthest(column, weight, i, dt, at, to, x, lanes)
        for lane in range(lanes):
            farthest = max(abs(x[end, lane]), abs(x[turn, lane]))
            x[most + i, lane] = max(x[most + i, lane], x[to.counts, lane] * farthest)


@compiled
def _watch_masses(damping, mass, structure, dt, at, to, x, lanes):
    """Energies put in by the ground, and dissipated by the dashpots of the structures."""
    drag = to.scratch_1
    for i in range(mass.size):
        dq, entering, viscous = at.dq + i, to.entering + structure[i], to.viscous + structure[i]
        for lane in range(lanes):
            put_in = mass[i] * x[at.f, lane] * x[dq, lane]
            x[entering, lane] += x[to.counts, lane] * put_in
        fill(x, drag, 0.0, lanes)
        multiply(damping, i, x, at.dq, drag, lanes)
        for lane in range(lanes):
            x[viscous, lane] += x[to.counts, lane] * (x[drag, lane] * x[dq, lane] / dt)


@compiled
def _watch_links(column, weight, spring, ties, dashpot, constant, dt, at, to, x, lanes):
    """Largest forces of links, as means of steps, and energies dissipated."""
    change, force, lost = to.scratch_1, to.scratch_2, to.scratch_3
    for tie in range(ties.size):
        i, other, c = ties[tie], dashpot[tie], constant[tie]
        post, couple, z, slip = spring[i, POST], spring[i, COUPLE], at.z + i, at.slip + i
        times_row(column, weight, i, x, at.dq, change, lanes)
        for lane in range(lanes):
            held = couple * (x[z, lane] - 0.5 * (x[change, lane] - x[slip, lane]))
            mean = post * (x[at.extension + i, lane] + 0.5 * x[change, lane]) + held
            drag = c * x[change, lane] / dt
            x[force, lane] = mean + drag
            x[lost, lane] = drag * x[change, lane] + held * x[slip, lane]
        if other >= 0:
            own, slip = spring[other, COUPLE], at.slip + other
            times_row(column, weight, other, x, at.dq, change, lanes)
            for lane in range(lanes):
                drag = 0.5 * own * (x[change, lane] - x[slip, lane])
                x[force, lane] += drag
                x[lost, lane] += drag * x[change, lane]
        for lane in range(lanes):
            most = max(x[to.pull + tie, lane], x[to.counts, lane] * abs(x[force, lane]))
            x[to.pull + tie, lane] = most
        for lane in range(lanes):
            x[to.drained + tie, lane] += x[to.counts, lane] * x[lost, lane]


@compiled
def watch(steps, parts, at, to, x, lanes):
    """Update forces, accelerations and energies by a time step that has been taken, where it counts."""
    dt, (column, weight) = steps.dt, steps.extensions
    of_floor, share = steps.shapes
    _watch_accelerations(of_floor, share, dt, at, to, x, lanes)
    (of_q, share_q), (of_z, share_z) = parts.shear
    _watch_shears(of_q, share_q, of_z, share_z, at, to, x, lanes)
    _watch_extensions(column, weight, dt, at, to, x, lanes)
    _watch_masses(parts.damping, parts.mass, parts.structure, dt, at, to, x, lanes)
    if parts.spring.size > 0:
        spring, ties, dashpot, constant = steps.spring, parts.spring, parts.dashpot, parts.constant
        _watch_links(column, weight, spring, ties, dashpot, constant, dt, at, to, x, lanes)


@compiled
def _take_stored(steps, contacts, at, to, x, lanes):
    """Subtract the energies stored in springs and contacts from the row ``to.scratch_1``."""
    (column, weight), (facing, share), stored = steps.extensions, contacts.rows, to.scratch_2
    for i in range(column.shape[0]):
        if steps.info[i, KIND] != VISCOUS:
            post, couple, z = steps.spring[i, POST], steps.spring[i, COUPLE], at.z + i
            times_row(column, weight, i, x, at.q, stored, lanes)
            for lane in range(lanes):
                elastic = post * x[stored, lane] * x[stored, lane] + couple * x[z, lane] * x[z, lane]
                x[to.scratch_1, lane] -= 0.5 * elastic
    if not contacts.jumps:
        for j in range(contacts.gap.size):
            times_row(facing, share, j, x, at.q, stored, lanes)
            for lane in range(lanes):
                energy = stored_in(contacts.law[j], x[stored, lane] - contacts.gap[j])
                x[to.scratch_1, lane] -= x[at.meets, lane] * energy


@compiled
def balance(steps, contacts, parts, at, to, x, lanes):
    """Update the energy that is missing in the balance of all structures, and its largest share."""
    whole = to.scratch_1
    fill(x, whole, 0.0, lanes)
    for row in range(to.entering, to.viscous):
        for lane in range(lanes):
            x[whole, lane] += x[row, lane]
    for lane in range(lanes):
        x[to.most, lane] = max(x[to.most, lane], abs(x[whole, lane]))
    for row in range(to.viscous, to.missing):
        for lane in range(lanes):
            x[whole, lane] -= x[row, lane]
    for i in range(parts.owner.size):
        if parts.owner[i] >= 0:
            for lane in range(lanes):
                x[whole, lane] -= x[at.spent + i, lane]
    for i in range(parts.mass.size):
        for lane in range(lanes):
            x[whole, lane] -= 0.5 * parts.mass[i] * x[at.v + i, lane] * x[at.v + i, lane]
    _take_stored(steps, contacts, at, to, x, lanes)
    for lane in range(lanes):
        most = x[to.most, lane]
        if x[to.counts, lane] > 0.0:
            x[to.missing, lane] = x[whole, lane]
            ratio = abs(x[whole, lane]) / most if most > 0.0 else 0.0
            x[to.imbalance, lane] = max(x[to.imbalance, lane], ratio)
