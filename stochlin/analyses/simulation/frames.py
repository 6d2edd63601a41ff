"""Structures that are simulated as masses with storeys between them: buildings and linked structures."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import scipy.linalg
import scipy.sparse.csgraph

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.simulation.ensemble import SampledStoreys, Storeys
from stochlin.kernels.simulation.storey_stepping import (
    BILINEAR,
    LINEAR,
    OTHER,
    SLACK,
    VISCOUS,
    Elements,
    law_of,
)
from stochlin.models.links import Link
from stochlin.models.structures import Structure
from stochlin.models.systems import Stack, System

# Least share of the mass in a mode that determines the time step. Higher modes are integrated stably.
LEAST_SHARE = 0.01


class Frame(NamedTuple):
    """Structures that are linked to each other, or one building."""

    part: Storeys
    floors: Array  # (n,) numbers of the floors in the system
    shortest: float  # [s], shortest elastic period that determines the time step
    slowest: float  # [s], longest decay time of the elastic vibrations
    period: float  # [s], longest elastic period
    samples: SampledStoreys | None = None  # with uncertain parameters: a sample for each motion


def frames_of(system: System) -> tuple[list[Frame], list[int]]:
    """Frames of a system, and the numbers of the oscillators without links."""
    frames, alone = [], []
    with_device = {tie.one for tie in system.ties if tie.link.within_one}
    for members in _tied(system):
        one = members[0]
        lone = members.size == 1 and system.stacks[one].is_oscillator
        if lone and int(system.first[one]) not in with_device:
            alone.append(int(one))
        else:
            frames.append(_frame(system, members))
    return frames, alone


def all_frames(system: System) -> list[Frame]:
    """Frames of a system, with oscillators without links as buildings of one storey."""
    return [_frame(system, members) for members in _tied(system)]


def sampled_frames(system: System, samples: Sequence[Sequence[Stack]]) -> list[Frame]:
    """Frames of a system with uncertain parameters; ``samples`` are the structures of each motion.

    The time step is short enough for the stiffest sample of each structure.
    """
    count = len(system.stacks)
    stiffest = [max((sample[s] for sample in samples), key=_stiffness) for s in range(count)]
    found = []
    for members in _tied(system):
        frame = _frame(system, members)
        usual, stacks = frame.part.elements, [system.stacks[m] for m in members]
        of_links = usual.damping - _damping(stacks)
        elements = _with_stacks(usual, of_links, [[sample[m] for m in members] for sample in samples])
        shortest = _frame(system._replace(stacks=tuple(stiffest)), members).shortest
        own = SampledStoreys(elements, frame.part.law)
        found.append(frame._replace(samples=own, shortest=shortest))
    return found


def _damping(stacks: Sequence[Stack]) -> Array:
    """Damping matrix of structures without links [N s/m]."""
    own = [stack.damping for stack in stacks]
    whole: Array = scipy.linalg.block_diag(*own) if own[1:] else own[0]
    return whole


def _stiffness(stack: Stack) -> float:
    return float((stack.elastic / stack.mass).max())


def _with_stacks(usual: Elements, of_links: Array, samples: Sequence[Sequence[Stack]]) -> list[Elements]:
    """Elements with the same links and other storeys, those of each sample."""
    n, count = usual.mass.size, len(samples)
    structures = list(zip(*samples, strict=True))

    def of_storeys(name: str) -> Array:
        return np.hstack([[getattr(stack, name) for stack in own] for own in structures])

    def column(name: str) -> Array:
        of_springs = getattr(usual, name)[n:]
        return np.hstack([of_storeys(name), np.broadcast_to(of_springs, (count, of_springs.size))])

    damping, own = (np.repeat(each[None], count, axis=0) for each in (of_links, usual.own))
    first = 0
    for each in structures:
        rows = slice(first, first := first + each[0].mass.size)
        damping[:, rows, rows] += np.array([stack.damping for stack in each])
        width = each[0].law_parameters.shape[1]
        if width:
            own[:, rows, :width] = [stack.law_parameters for stack in each]
    columns = {name: column(name) for name in ("post", "couple", "strength")}
    columns |= {"mass": of_storeys("mass"), "damping": damping, "own": own}
    return [
        usual._replace(**dict(zip(columns, row, strict=True)))
        for row in zip(*columns.values(), strict=True)
    ]


def _tied(system: System) -> list[Array]:
    """Groups of linked structures, by their numbers from 0."""
    count = len(system.stacks)
    tied = np.zeros((count, count))
    owner = np.repeat(np.arange(count), np.diff(system.first))
    for tie in system.ties:
        tied[owner[tie.one], owner[tie.one if tie.two < 0 else tie.two]] = 1
    _, group = scipy.sparse.csgraph.connected_components(tied, directed=False)
    return [np.flatnonzero(group == number) for number in dict.fromkeys(group)]


def _frame(system: System, members: Array) -> Frame:
    """Frame of the structures ``members`` (numbers from 0) and of the links between them."""
    first = system.first
    floors = np.concatenate([np.arange(first[m], first[m + 1]) for m in members])
    springs = np.flatnonzero(np.abs(system.extensions[:, floors]).any(axis=1))
    drifts = system.extensions[np.ix_(springs, floors)]
    ties = [system.ties[spring - int(first[-1])] for spring in springs[floors.size :]]
    damping = system.damping[np.ix_(floors, floors)].copy()
    stacks = [system.stacks[m] for m in members]
    laws = _Laws()
    kinds = [laws.kind(stack.law, yields) for stack in stacks for yields in stack.couple > 0]
    force = [
        [stack.post[i], stack.couple[i], stack.strength[i]]
        for stack in stacks
        for i in range(stack.mass.size)
    ]
    own = [row for stack in stacks for row in stack.law_parameters]
    for along, tie in zip(drifts[floors.size :], ties, strict=True):
        force.append(list(tie.link.spring))
        if not tie.link.is_power_law:
            damping += tie.link.number("damping_constant") * np.outer(along, along)
        kinds.append(_kind(tie.link))
        own.append(np.empty(0))
    drifts[np.array(kinds) == SLACK] *= -1  # a link with slack pulls when the floors move apart
    for along, tie in zip(drifts[floors.size :], ties, strict=True):
        if tie.link.is_power_law:
            drifts = np.vstack([drifts, along])
            force.append([0.0, 0.0, np.inf])
            kinds.append(VISCOUS)
            own.append(np.array([tie.link.number("damping_constant"), tie.link.exponent]))
    widest = max(row.size for row in own)
    post, couple, strength = np.array(force, float).T.copy()
    elements = Elements(
        np.concatenate([stack.mass for stack in stacks]),
        damping,
        np.ascontiguousarray(drifts),
        post,
        couple,
        strength,
        np.array(kinds),
        np.array([np.pad(row, (0, widest - row.size), constant_values=np.nan) for row in own]),
    )
    stiffness = (elements.drifts.T * (elements.post + elements.couple)) @ elements.drifts
    modes = [_modes(elements.mass, stiffness)]
    for stack in stacks:
        chain = System((stack,), ()).extensions
        modes.append(_modes(stack.mass, (chain.T * stack.elastic) @ chain))
    return Frame(
        Storeys(elements, law_of(tuple(laws.middles))),
        floors,
        shortest=min(float(periods[shares >= LEAST_SHARE].min()) for periods, shares in modes),
        slowest=1 / float(-np.linalg.eigvals(elements.elastic()).real.max()),
        period=float(modes[0][0].max()),
    )


def _modes(mass: Array, stiffness: Array) -> tuple[Array, Array]:
    """Periods [s] and effective modal masses, as shares of the mass, of all modes."""
    squares, shapes = scipy.linalg.eigh(stiffness, np.diag(mass))
    if squares[0] <= 0:
        raise ValueError(
            "the stiffnesses of storeys and links differ so much that the longest period is lost by "
            f"rounding errors; the largest one is {stiffness.max():.3g} N/m: reduce it"
        )
    shares = (mass @ shapes) ** 2 / mass.sum()
    return 2 * np.pi / np.sqrt(squares), shares


def _kind(link: Link) -> int:
    return BILINEAR if link.yields else LINEAR if link.slack is None else SLACK


class _Laws:
    """Laws of a frame that are not built into the kernel, each with its `law_middle`."""

    def __init__(self) -> None:
        self.middles: list[Any] = []

    def kind(self, law: Structure, yields: bool) -> int:
        """Number by which the kernel selects the law of an element."""
        steps = law.in_storeys() if yields else LINEAR
        if isinstance(steps, int):
            return steps
        if steps not in self.middles:
            self.middles.append(steps)
        return OTHER + self.middles.index(steps)


def relaxation_times(system: System, k_eq: Array) -> Array:
    """Relaxation times [s] of the plastic drifts of the storeys by linearization; 0 if elastic."""
    share = system.all("post") / system.all("elastic")
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(k_eq > 0, 1 / (share * k_eq), 0.0)
