"""Structures that are simulated as masses with storeys between them: buildings and linked structures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import scipy.linalg
import scipy.sparse.csgraph

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.systems import System
from stochlin.kernels.simulation.ensemble import Oscillators, SteppedStructures
from stochlin.kernels.simulation.laws import (
    BILINEAR,
    LINEAR,
    OTHER,
    VISCOUS,
    RateLaw,
    by_number,
)
from stochlin.kernels.simulation.time_step import Elements
from stochlin.models.systems import Arrangement, Stack

# Least share of the mass in a mode that determines the time step. Higher modes are integrated stably.
LEAST_SHARE = 0.01
# Least static displacement of a mode that stays elastic, over the largest of a mode.
LEAST_DISPLACEMENT = 1e-3
ROUNDING = 1e-9  # of the strain of an element in a mode, relative to the largest


class SteppedGroup(NamedTuple):
    """Structures that are stepped together: oscillators, linked structures, or one building."""

    part: Oscillators | SteppedStructures
    watched: Array  # (w,) numbers of the displacements in the system, as `Arrangement.displacements`
    shortest: float  # [s], shortest elastic period that determines the time step
    slowest: float  # [s], longest decay time of the elastic vibrations
    period: Any  # [s], longest elastic period, or (n,) that of each oscillator
    scale: Any = 1.0  # the unit in which displacements are computed [m], or (w,) that of each


def connected_of(system: Arrangement) -> tuple[list[SteppedGroup], list[int]]:
    """Connected structures of a system, and the numbers of the oscillators without links."""
    connected, alone = [], []
    with_device = {tie.floor for tie in system.ties if tie.link.within_one}
    for members in _tied(system):
        number = members[0]
        lone = members.size == 1 and system.stacks[number].is_oscillator
        if lone and int(system.first[number]) not in with_device:
            alone.append(int(number))
        else:
            connected.append(_connected(system, members))
    return connected, alone


def all_connected(system: Arrangement) -> list[SteppedGroup]:
    """Connected structures of a system, with oscillators without links as buildings of one storey."""
    return [_connected(system, members) for members in _tied(system)]


def sampled_connected(system: Arrangement, samples: Sequence[Sequence[Stack]]) -> list[SteppedGroup]:
    """Those of a system with uncertain parameters; ``samples`` are the structures of each motion.

    The time step is short enough for the stiffest sample of each structure.
    """
    count = len(system.stacks)
    stiffest = [max((sample[s] for sample in samples), key=_stiffness) for s in range(count)]
    sampled = []
    for members in _tied(system):
        group = _connected(system, members)
        assert isinstance(group.part, SteppedStructures)
        usual, stacks = group.part.elements, [system.stacks[m] for m in members]
        of_links = usual.system.damping - System.beside([stack.system for stack in stacks]).damping
        elements = _with_stacks(usual, of_links, [[sample[m] for m in members] for sample in samples])
        shortest = _connected(system._replace(stacks=tuple(stiffest)), members).shortest
        part = replace(group.part, samples=elements)
        sampled.append(group._replace(part=part, shortest=shortest))
    return sampled


def _stiffness(stack: Stack) -> float:
    return float((stack.system.elastic / stack.system.mass).max())


def _with_stacks(usual: Elements, of_links: Array, samples: Sequence[Sequence[Stack]]) -> list[Elements]:
    """Elements with the same links and other storeys, those of each sample."""
    elements = []
    for stacks in samples:
        mass, damping, _, _, *storeys = System.beside([stack.system for stack in stacks])
        own, first = usual.own.copy(), 0
        for stack in stacks:
            parameters = stack.law_parameters
            own[first : first + len(parameters), : parameters.shape[1]] = parameters
            first += len(parameters)
        pairs = zip(storeys, usual.system[4:], strict=True)
        springs = (np.concatenate([part, whole[mass.size :]]) for part, whole in pairs)
        same = usual.system.extensions, usual.system.shapes
        system = System(mass, damping + of_links, *same, *springs)
        elements.append(usual._replace(system=system, own=own))
    return elements


def _tied(system: Arrangement) -> list[Array]:
    """Groups of linked structures, by their numbers from 0."""
    count = len(system.stacks)
    tied = np.zeros((count, count))
    owner = np.repeat(np.arange(count), np.diff(system.first))
    for tie in system.ties:
        tied[owner[tie.floor], owner[tie.floor if tie.other < 0 else tie.other]] = 1
    _, group = scipy.sparse.csgraph.connected_components(tied, directed=False)
    return [np.flatnonzero(group == number) for number in dict.fromkeys(group)]


def _connected(system: Arrangement, members: Array) -> SteppedGroup:
    """The structures ``members`` (numbers from 0) and the links between them."""
    elements, law = elements_of(system, members)
    whole, stacks = elements.system, [system.stacks[m] for m in members]
    systems = [whole, *(stack.system for stack in stacks)]
    watched, coordinates = _watched(system, members), _numbers(system.first_coordinate, members)
    seen = whole._replace(shapes=system.displacements[np.ix_(watched, coordinates)])
    element = system.of_watched[watched][:, None] == coordinates
    return SteppedGroup(
        SteppedStructures(elements._replace(system=seen), law, (), element.astype(float)),
        watched,
        shortest=min(shortest_mode(each, of_displacements=True) for each in systems),
        slowest=whole.slowest_decay,
        period=float(modes_of(whole)[0].max()),
    )


def _numbers(first: Array, members: Array) -> Array:
    """Numbers of the floors or coordinates of the structures ``members``; ``first`` is that of each."""
    return np.concatenate([np.arange(first[m], first[m + 1]) for m in members])


def _watched(system: Arrangement, members: Array) -> Array:
    """Numbers of the displacements of the structures ``members``: their floors and yielding modes."""
    own = np.isin(system.yielding_modes, _numbers(system.first_coordinate, members))
    return np.append(_numbers(system.first, members), int(system.first[-1]) + np.flatnonzero(own))


def elements_of(system: Arrangement, members: Array) -> tuple[Elements, Any]:
    """Masses and springs of the structures ``members`` (numbers from 0), and their laws in time steps.

    The elements are those of the structures, the springs of the links, and then the dashpots with an
    exponent.
    """
    first = system.first_coordinate
    coordinates = _numbers(first, members)
    n, springs = coordinates.size, np.flatnonzero(np.abs(system.extensions[:, coordinates]).any(axis=1))
    drifts = system.extensions[np.ix_(springs, coordinates)]
    ties = [system.ties[spring - int(first[-1])] for spring in springs[n:]]
    stacks = [system.stacks[m] for m in members]
    mass, damping, _, shapes, *storeys = System.beside([stack.system for stack in stacks])
    damping = damping.copy()
    yields = ((stack.law, couple > 0) for stack in stacks for couple in stack.system.couple)
    kinds = [law.step() if yielding else LINEAR for law, yielding in yields]
    force = np.transpose(storeys).tolist()
    own = [row for stack in stacks for row in stack.law_parameters]
    for along, tie in zip(drifts[n:], ties, strict=True):
        force.append(list(tie.link.spring))
        if not tie.link.is_power_law:
            damping += tie.link.number("damping_constant") * np.outer(along, along)
        kinds.append(BILINEAR if tie.link.yields else LINEAR)
        own.append(np.empty(0))
    for along, tie in zip(drifts[n:], ties, strict=True):
        if tie.link.is_power_law:
            drifts = np.vstack([drifts, along])
            force.append([0.0, 0.0, np.inf])
            kinds.append(VISCOUS)
            own.append(np.array([tie.link.number("damping_constant"), tie.link.exponent]))
    widest = max(row.size for row in own)
    post, couple, strength = np.array(force, float).T.copy()
    whole = System(mass, damping, np.ascontiguousarray(drifts), shapes, post, couple, strength)
    rows = [np.pad(row, (0, widest - row.size), constant_values=np.nan) for row in own]
    numbers, states, law = laws_of(kinds)
    return Elements(whole, numbers, states, np.array(rows)), law


def modes_of(system: System) -> tuple[Array, Array, Array]:
    """Periods [s], effective masses as shares of the mass, and shapes (n, modes), of all modes."""
    mass, stiffness = system.mass, system.stiffness
    squares, shapes = scipy.linalg.eigh(stiffness, np.diag(mass))
    if squares[0] <= 0:
        raise ValueError(
            "the stiffnesses of storeys and links differ so much that the longest period is lost by "
            f"rounding errors; the largest one is {stiffness.max():.3g} N/m: reduce it"
        )
    shares = (mass @ shapes) ** 2 / mass.sum()
    return 2 * np.pi / np.sqrt(squares), shares, shapes


def shortest_mode(system: System, of_displacements: bool = False) -> float:
    """Shortest period of all modes that matter [s], which are those with a share of the mass.

    Where only displacements are asked for, and no accelerations or forces of contacts, a mode that
    strains no element that can yield also needs a share of the static displacement.
    """
    periods, shares, shapes = modes_of(system)
    matter = shares >= LEAST_SHARE
    if of_displacements:
        static, strained = shares * periods**2, np.abs(system.extensions @ shapes)
        yields = strained[system.couple > 0].max(axis=0, initial=0.0) > ROUNDING * strained.max(axis=0)
        matter &= yields | (static >= LEAST_DISPLACEMENT * static.max())
    return float(periods[matter].min())


def laws_of(steps: Sequence[int | RateLaw]) -> tuple[Array, Array, Any]:
    """Kinds and numbers of states of elements with these laws, and the function of all their laws.

    Each law is what `Structure.step` gives.
    """
    of_users = list(dict.fromkeys(law for law in steps if isinstance(law, RateLaw)))
    kinds = [OTHER + of_users.index(law) if isinstance(law, RateLaw) else law for law in steps]
    states = [law.states if isinstance(law, RateLaw) else 1 for law in steps]
    return np.array(kinds), np.array(states), by_number(tuple(of_users))
