"""The state of masses, springs and contacts that move in time steps, in independent motions.

Each motion is a lane: the last axis of all arrays.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import accumulate
from typing import Any, NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array, zeros_on_a_line
from stochlin.kernels.basics.borrowed import Columns, borrowed
from stochlin.kernels.basics.compiled import compiled
from stochlin.kernels.basics.systems import System
from stochlin.kernels.simulation.laws import VISCOUS

# change of a slip, over the strength of the element, at which the passes of a step end
CLOSE_SLIP = 1e-8
CLOSE_BY_LAW = 1e-5  # the same for laws with rates; extensions change by less than 1e-7 of theirs


class Elements(NamedTuple):
    """The masses and springs of a system, and the laws of the springs.

    A dashpot with an exponent (VISCOUS) has zeros in ``post`` and ``couple``, and as ``parameters``
    its constant ``c`` [N (s/m)^a] and its exponent ``a``.
    """

    system: System  # its strength is infinite for a linear element
    kind: Array  # (e,): one of `laws.KINDS_OF_ELEMENTS`, or a larger number
    states: Array  # (e,): number of states of the law, of which the first is z
    parameters: Array  # (e, k): parameters of the law


class Coordinates(Columns):
    """Of each coordinate, with energies since the beginning of the motion."""

    q: Array  # [m]
    v: Array  # its rate [m/s]
    dq: Array  # its increment in the step [m]
    drag: Array  # of the dashpots of the structure, at the end of the step [N]
    input_energy: Array  # from the ground [J]
    viscous_energy: Array  # dissipated in dashpots of the structure [J]


class ElementStates(Columns):
    """Of each element."""

    z: Array  # the elastic part of the extension [m]
    slip: Array  # in the step [m]
    dissipated: Array  # by slips so far [J]
    extension: Array  # at the beginning of the step [m]
    tolerance: Array  # change of a slip at which the passes end [m]


class ContactStates(Columns):
    """Of each contact."""

    mean_force: Array  # in the step [N]
    speed: Array  # rate of penetration at the beginning of the contact [m/s]
    sticks: Array  # 1 if both sides move together after a blow, else 0
    dissipated: Array  # so far [J]
    penetration: Array  # at the beginning of the step [m]
    rate: Array  # of the penetration, at the beginning of the step [m/s]


class PresentImpacts(Columns):
    """Of each contact the impact that goes on; see `pounding.impacts`."""

    begin: Array  # [s]; NaN if there is none
    approach_velocity: Array  # [m/s]
    largest_force: Array  # [N]
    end: Array  # of its force, so far [s]
    dissipated: Array  # [J]
    work_on_right: Array  # on the structure on the right [J]
    largest_penetration: Array  # [m]
    force: Array  # at the end of the last step [N]
    force_rise: Array  # its rate in that step [N/s]
    time_in_contact: Array  # in that step [s]


class Peaks(Columns):
    """Of each floor, then of each element."""

    highest: Array  # displacement of the floor, or extension of the element [m]
    lowest: Array  # the same [m]
    acceleration: Array  # largest absolute one of the floor [m/s^2]
    shear: Array  # largest absolute one of the storey below the floor [N]


class LinkStates(Columns):
    """Of each link."""

    largest_force: Array  # [N]
    dissipated: Array  # so far [J]


class Motions(Columns):
    """Of each motion as a whole."""

    forcing: Array  # mean of the step [m/s^2]
    least_approach: Array  # rate of approach below which a contact is elastic [m/s]
    meets: Array  # 1 if contacts act, else 0
    active: Array  # 1 until the motion ends, else 0
    failed: Array  # time at which it was ended before its end [s], else infinite
    missing_energy: Array  # in the balance [J]
    largest_input: Array  # the most energy put in so far [J]
    imbalance: Array  # the largest ratio of both


class Iteration(Columns):
    """Of each motion, while the passes of a step are repeated."""

    change: Array  # of the extension or penetration of the present element or contact [m]
    slip_change: Array  # of the present element in this pass [m]
    largest_change: Array  # of an extension, without slips [m]
    active: Array  # 1 if the passes go on, else 0
    active_next: Array  # the same for the next pass


class Totals(Columns):
    """Of each motion, for sums over one thing after the other."""

    change: Array  # of the extension of a link [m]
    force: Array  # of a link [N]
    energy: Array  # [J]
    reach: Array  # largest penetration of a contact in the step [m]


class Products(Columns):
    """Products of rows with coordinates, and the forces at the end of a step [N]."""

    q: Array
    dq: Array
    v: Array
    force: Array  # of elements, dashpots of structures and contacts


class Blows(Columns):
    """Of each coordinate at a stereomechanical blow."""

    acceleration: Array  # without the blow [m/s^2]
    shift: Array  # of the coordinate by the blow, to the end of the step [m]


class LawStates(Columns):
    """The states (k, lanes) of one law, over the strength of its element."""

    rate: Array  # of the extension, in the first row [1/s]
    before: Array
    after: Array


@borrowed
class State(NamedTuple):
    """The state of all motions, one block of memory, and what is of one step only."""

    block: Array  # (rows, lanes): all arrays down to ``memory``
    coordinates: Coordinates  # (n, lanes)
    elements: ElementStates  # (e, lanes)
    contacts: ContactStates  # (c, lanes)
    impacts: PresentImpacts  # (c, lanes)
    peaks: Peaks  # (f + e, lanes)
    links: LinkStates  # (l, lanes)
    motions: Motions  # (lanes,)
    memory: Array  # (e, k - 1, lanes): further states of the laws, with k states at most
    # What is of one step only:
    memory_after: Array  # memory at its end
    beginning: Array  # (n + e, lanes): velocities and element forces at the beginning
    iteration: Iteration  # (lanes,)
    totals: Totals  # (lanes,)
    products: Products  # (rows, lanes)
    blows: Blows  # (n, lanes)
    law: LawStates  # (k, lanes)
    parameters: Array  # (e, parameters, lanes): of the laws

    @classmethod
    def at_rest(
        cls,
        elements: Sequence[Elements],
        lanes: int,
        contacts: int = 0,
        watched: int = 0,
        links: int = 0,
    ) -> State:
        """Motions from rest; the ``elements`` are those of each lane, or one set of all lanes."""
        like = elements[0]
        n = like.system.mass.size
        e = like.kind.size
        states = int(like.states.max(initial=1))
        shapes = [
            Coordinates.shape(n, lanes),
            ElementStates.shape(e, lanes),
            ContactStates.shape(contacts, lanes),
            PresentImpacts.shape(contacts, lanes),
            Peaks.shape(watched, lanes),
            LinkStates.shape(links, lanes),
            Motions.shape(lanes),
            (e, states - 1, lanes),
        ]
        ends = list(accumulate(math.prod(shape[:-1]) for shape in shapes))
        block = zeros_on_a_line(ends[-1], lanes)
        parts = [
            rows.reshape(shape)
            for rows, shape in zip(np.split(block, ends[:-1]), shapes, strict=True)
        ]
        state = cls(
            block=block,
            coordinates=Coordinates(parts[0]),
            elements=ElementStates(parts[1]),
            contacts=ContactStates(parts[2]),
            impacts=PresentImpacts(parts[3]),
            peaks=Peaks(parts[4]),
            links=LinkStates(parts[5]),
            motions=Motions(parts[6]),
            memory=parts[7],
            memory_after=zeros_on_a_line(e, states - 1, lanes),
            beginning=zeros_on_a_line(n + e, lanes),
            iteration=Iteration.zeros(lanes),
            totals=Totals.zeros(lanes),
            products=Products.zeros(max(e + n + contacts, 2 * watched), lanes),
            blows=Blows.zeros(n, lanes),
            law=LawStates.zeros(states, lanes),
            parameters=zeros_on_a_line(*like.parameters.shape, lanes),
        )
        state.parameters[:] = np.stack([sample.parameters for sample in elements], axis=-1)
        strength = np.stack([sample.system.strength for sample in elements], axis=-1)
        close = np.where(like.kind <= VISCOUS, CLOSE_SLIP, CLOSE_BY_LAW)
        state.elements.tolerance[:] = close[:, None] * strength
        state.impacts.begin[:] = np.nan
        state.motions.failed[:] = np.inf
        return state

    def of_lane(self, lane: int) -> State:
        """The state of one motion."""
        parts: Any = [
            part.of_lane(lane) if isinstance(part, Columns) else part[..., lane] for part in self
        ]
        return State._make(parts)

    @property
    def largest(self) -> Array:
        """Largest absolute displacements of floors, then extensions of elements [m]."""
        return np.maximum(self.peaks.highest, -self.peaks.lowest)


@compiled
def copy(source, source_lanes, target, target_lanes, count):
    """Copy states (rows, lanes) from some lanes to others."""
    for row in range(source.shape[0]):
        for k in range(count):
            target[row, target_lanes[k]] = source[row, source_lanes[k]]


@compiled
def copy_all(source, target):
    """Copy all states."""
    flat_source = source.ravel()
    flat_target = target.ravel()
    for i in range(flat_source.size):
        flat_target[i] = flat_source[i]
