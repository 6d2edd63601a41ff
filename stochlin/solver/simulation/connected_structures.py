"""Structures as the compiled time steps take them: oscillators, buildings and linked structures."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import scipy.linalg
import scipy.sparse.csgraph

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.systems import System
from stochlin.kernels.pounding.run import BuildingRow
from stochlin.kernels.simulation.account import Parts
from stochlin.kernels.simulation.contacts import Contacts
from stochlin.kernels.simulation.ensemble import SteppedOscillators, SteppedStructures
from stochlin.kernels.simulation.laws import (
    BILINEAR,
    LINEAR,
    OTHER_LAW,
    VISCOUS,
    RateLaw,
    by_number,
)
from stochlin.kernels.simulation.row_products import rows_of
from stochlin.kernels.simulation.state import Elements
from stochlin.models.systems import Assembly, StickModel

# Least share of the mass in a mode that determines the time step. Higher modes are integrated
# stably.
LEAST_MASS_SHARE = 0.01
# Least static displacement of a mode that stays elastic, over the largest of a mode.
LEAST_DISPLACEMENT = 1e-3
ROUNDING_OF_STRAINS = 1e-9  # of the strain of an element in a mode, relative to the largest


class SteppedGroup(NamedTuple):
    """Structures that are stepped together: oscillators, linked structures, or one building."""

    part: SteppedOscillators | SteppedStructures
    watched: Array  # (w,) numbers of the displacements in the system, as `Assembly.displacements`
    shortest: float  # [s], shortest elastic period that determines the time step
    slowest: float  # [s], longest decay time of the elastic vibrations
    period: Any  # [s], longest elastic period, or (n,) that of each oscillator
    scale: Any = 1.0  # the unit in which displacements are computed [m], or (w,) that of each


def stepped_groups(system: Assembly) -> list[SteppedGroup]:
    """All structures of a system, with the links between them."""
    alone = unlinked_oscillators(system)
    groups = oscillator_groups([system.sticks[n] for n in alone], system.first[alone])
    linked = (members for members in _tied(system) if members[0] not in alone)
    return [*groups, *(_connected(system, members) for members in linked)]


def unlinked_oscillators(system: Assembly) -> list[int]:
    """Numbers of the oscillators that no link ties, from 0."""
    tied = {floor for placed in system.placed_links for floor in (placed.floor, placed.other)}
    floors = zip(system.sticks, system.first[:-1], strict=True)
    return [
        n for n, (stick, floor) in enumerate(floors) if stick.is_oscillator and floor not in tied
    ]


def oscillator_groups(sticks: Sequence[StickModel], watched: Array) -> list[SteppedGroup]:
    """Oscillators without links; bilinear and elastic ones are stepped together."""
    simple = [bool(stick.law.step() == BILINEAR or not stick.yields.any()) for stick in sticks]
    groups = []
    if any(simple):
        together = [stick for stick, is_simple in zip(sticks, simple, strict=True) if is_simple]
        groups.append(_simple_oscillators(together, watched[simple]))
    for n, stick in enumerate(sticks):
        if not simple[n]:
            alone = _connected(Assembly((stick,), ()), np.zeros(1, int))
            groups.append(alone._replace(watched=watched[[n]]))
    return groups


def connected_groups(
    system: Assembly, samples: Sequence[Sequence[StickModel]] = ()
) -> list[SteppedGroup]:
    """All structures of a system as masses with springs between them, also oscillators.

    With uncertain parameters, ``samples`` are the structures of each motion. The time step is then
    short enough for the stiffest sample of each structure.
    """
    if samples:
        stiffest = (max(several, key=_stiffness) for several in zip(*samples, strict=True))
        system = system._replace(sticks=tuple(stiffest))
    systems = [system._replace(sticks=tuple(sample)) for sample in samples]
    return [_connected(system, members, systems) for members in _tied(system)]


def _stiffness(stick: StickModel) -> float:
    return float((stick.system.elastic / stick.system.mass).max())


def _simple_oscillators(sticks: Sequence[StickModel], watched: Array) -> SteppedGroup:
    """Bilinear and elastic oscillators, in units of their yield displacements."""
    systems = [stick.system for stick in sticks]
    mass, damping, post, couple, strength = (
        np.concatenate([getattr(system, name).ravel() for system in systems])
        for name in ("mass", "damping", "post", "couple", "strength")
    )
    yields = np.isfinite(strength)
    post = np.where(yields, post, post + couple)
    couple = np.where(yields, couple, 0.0)
    scale = np.where(yields, strength, 1.0)
    period = 2 * np.pi * np.sqrt(mass / (post + couple))
    columns = np.stack([damping / mass, post / mass, couple / mass, 1 / scale], axis=1)
    slowest = float((2 * mass / damping).max())
    return SteppedGroup(
        SteppedOscillators(columns), watched, float(period.min()), slowest, period, scale
    )


def _tied(system: Assembly) -> list[Array]:
    """Groups of linked structures, by their numbers from 0."""
    count = len(system.sticks)
    tied = np.zeros((count, count))
    owner = np.repeat(np.arange(count), np.diff(system.first))
    for placed in system.placed_links:
        tied[owner[placed.floor], owner[placed.floor if placed.other < 0 else placed.other]] = 1
    _, group = scipy.sparse.csgraph.connected_components(tied, directed=False)
    return [np.flatnonzero(group == number) for number in dict.fromkeys(group)]


def _connected(system: Assembly, members: Array, samples: Sequence[Assembly] = ()) -> SteppedGroup:
    """The structures ``members`` (numbers from 0) and the links between them."""
    elements, law = elements_of(system, members)
    whole = elements.system
    watched = _watched(system, members)
    coordinates = numbers_of(system.first_coordinate, members)

    def with_watched(elements: Elements) -> Elements:
        """The elements with the displacements that are watched."""
        shapes = system.displacements[np.ix_(watched, coordinates)]
        return elements._replace(system=elements.system._replace(shapes=shapes))

    systems = [whole, *(system.sticks[number].system for number in members)]
    incidence = system.of_watched[watched][:, None] == coordinates
    sampled = [with_watched(elements_of(sample, members)[0]) for sample in samples]
    return SteppedGroup(
        SteppedStructures(with_watched(elements), law, sampled, incidence.astype(float)),
        watched,
        shortest=min(shortest_mode(part, of_displacements=True) for part in systems),
        slowest=whole.slowest_decay,
        period=float(modes_of(whole)[0].max()),
    )


def numbers_of(first: Array, members: Array) -> Array:
    """Numbers of floors or coordinates of the structures ``members``; ``first`` is that of each."""
    return np.concatenate([np.arange(first[m], first[m + 1]) for m in members])


def _watched(system: Assembly, members: Array) -> Array:
    """Numbers of displacements of the structures ``members``: their floors and yielding modes."""
    floors = numbers_of(system.first, members)
    modes = np.isin(system.yielding_modes, numbers_of(system.first_coordinate, members))
    return np.append(floors, int(system.first[-1]) + np.flatnonzero(modes))


def elements_of(system: Assembly, members: Array, all_states: bool = False) -> tuple[Elements, Any]:
    """Masses and springs of structures ``members`` (numbers from 0), and their laws in time steps.

    The elements are those of the structures, the springs of the links, and then the dashpots with
    an exponent. An element whose force does not depend on ``z``, since its hardening ratio is 1, is
    stepped as a linear one, which is faster, but for ``all_states``: its ``z`` then follows its
    law.
    """
    first = system.first_coordinate
    coordinates = numbers_of(first, members)
    n = coordinates.size
    springs = np.flatnonzero(np.abs(system.extensions[:, coordinates]).any(axis=1))
    drifts = system.extensions[np.ix_(springs, coordinates)]
    placed_links = [system.placed_links[spring - int(first[-1])] for spring in springs[n:]]
    sticks = [system.sticks[m] for m in members]
    mass, damping, _, shapes, *storeys = System.beside([stick.system for stick in sticks])
    damping = damping.copy()
    kinds: list[int | RateLaw] = []
    for stick in sticks:
        depends = np.isfinite(stick.system.strength) if all_states else stick.system.couple > 0
        kinds.extend(stick.law.step() if by_law else LINEAR for by_law in depends)
    force = np.transpose(storeys).tolist()
    parameters = [row for stick in sticks for row in stick.law_parameters]
    for extension, placed in zip(drifts[n:], placed_links, strict=True):
        *spring, constant, _ = placed.link.numbers
        force.append(spring)
        if not placed.link.is_power_law:
            damping += constant * np.outer(extension, extension)
        kinds.append(BILINEAR if placed.link.yields else LINEAR)
        parameters.append(np.empty(0))
    for extension, placed in zip(drifts[n:], placed_links, strict=True):
        if placed.link.is_power_law:
            drifts = np.vstack([drifts, extension])
            force.append([0.0, 0.0, np.inf])
            kinds.append(VISCOUS)
            parameters.append(np.array(placed.link.numbers[3:]))
    widest = max(row.size for row in parameters)
    post, couple, strength = np.array(force, float).T.copy()
    whole = System(mass, damping, np.ascontiguousarray(drifts), shapes, post, couple, strength)
    rows = [np.pad(row, (0, widest - row.size), constant_values=np.nan) for row in parameters]
    numbers, states, law = laws_of(kinds)
    return Elements(whole, numbers, states, np.array(rows)), law


def modes_of(system: System) -> tuple[Array, Array, Array]:
    """Periods [s], effective masses as shares of the mass, and shapes (n, modes), of all modes."""
    mass = system.mass
    stiffness = system.stiffness
    squares, shapes = scipy.linalg.eigh(stiffness, np.diag(mass))
    if squares[0] <= 0:
        what = "the longest period is lost by rounding errors beside the largest stiffness"
        raise ValueError(f"{what}, {stiffness.max():.3g} N/m: reduce it")
    shares = (mass @ shapes) ** 2 / mass.sum()
    return 2 * np.pi / np.sqrt(squares), shares, shapes


def shortest_mode(system: System, of_displacements: bool = False) -> float:
    """Shortest period of all modes that matter [s], which are those with a share of the mass.

    Where only displacements are asked for, and no accelerations or forces of contacts, a mode that
    strains no element that can yield also needs a share of the static displacement.
    """
    periods, shares, shapes = modes_of(system)
    matter = shares >= LEAST_MASS_SHARE
    if of_displacements:
        static = shares * periods**2
        strained = np.abs(system.extensions @ shapes)
        largest = strained.max(axis=0)
        yielding = strained[system.couple > 0].max(axis=0, initial=0.0)
        strains_yielding = yielding > ROUNDING_OF_STRAINS * largest
        matter &= strains_yielding | (static >= LEAST_DISPLACEMENT * static.max())
    return float(periods[matter].min())


def laws_of(steps: Sequence[int | RateLaw]) -> tuple[Array, Array, Any]:
    """Kinds and numbers of states of elements with these laws, and the function of all their laws.

    Each law is what `Structure.step` gives.
    """
    rate_laws = list(dict.fromkeys(law for law in steps if isinstance(law, RateLaw)))
    kinds = [OTHER_LAW + rate_laws.index(law) if isinstance(law, RateLaw) else law for law in steps]
    states = [law.states if isinstance(law, RateLaw) else 1 for law in steps]
    return np.array(kinds), np.array(states), by_number(tuple(rate_laws))


def row_of(system: Assembly, contacts: Contacts, all_states: bool = False) -> BuildingRow:
    """Structures with their links and these contacts, and what is watched in their motions.

    ``all_states`` is that of `elements_of`.
    """
    elements, law = elements_of(system, np.arange(len(system.sticks)), all_states)
    storeys = system.storeys
    placed_links = system.placed_links
    n = system.storeys.mass.size
    others = elements.kind.size - n
    powers = np.array([placed.link.is_power_law for placed in placed_links], bool)
    dashpot = np.where(powers, n + len(placed_links) + np.cumsum(powers) - 1, -1)
    constant = [
        0.0 if placed.link.is_power_law else placed.link.numbers[3] for placed in placed_links
    ]
    mobility = elements.system.shapes / storeys.mass  # accelerations of floors by unit forces
    forces = [elements.system.extensions.T, np.eye(n), contacts.weights[:, :n].T]
    accelerations = -mobility @ np.hstack(forces)
    shears = np.zeros_like(accelerations)
    # Shears that are not known are left out later.
    shears[:, : system.shear_shares.shape[1]] = np.nan_to_num(system.shear_shares)
    parts = Parts(
        mass=storeys.mass,
        elements=n,
        damping=storeys.damping,
        contacts=contacts.gap.size,
        of_forces=rows_of(np.concatenate([accelerations, shears])),
        carried=1.0 - elements.system.shapes.sum(axis=1),
        watched=rows_of(np.concatenate([elements.system.shapes, elements.system.extensions])),
        limit=np.concatenate([*(s.limits for s in system.sticks), np.full(others, np.inf)]),
        spring=n + np.arange(len(placed_links)),
        dashpot=dashpot.astype(np.int64),
        constant=np.array(constant, float),
    )
    return BuildingRow(elements, law, contacts, parts)
