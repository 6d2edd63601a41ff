"""Structures that are stepped as floors on storeys: buildings, and all that links tie to one another."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import scipy.linalg
import scipy.sparse.csgraph

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.simulation.ensemble import Storeys
from stochlin.kernels.simulation.storey_stepping import (
    BILINEAR,
    LINEAR,
    OTHER,
    SLACK,
    Elements,
    law_of,
)
from stochlin.models.links import Link
from stochlin.models.structures import Structure
from stochlin.models.systems import Stack, System

LEAST_SHARE = 0.01  # of the mass, in a mode that steps are to follow closely; all are followed stably


class Frame(NamedTuple):
    """Structures that act on one another, or one building alone."""

    part: Storeys
    floors: Array  # (n,): their numbers in the system
    shortest: float  # [s], of the modes while all elements hold that matter for the length of steps
    slowest: float  # [s], in which the slowest one dies out
    period: float  # [s], the longest


def frames_of(system: System) -> tuple[list[Frame], list[int]]:
    """The frames of a system, and the structures that are oscillators on their own."""
    frames, alone = [], []
    for members in _tied(system):
        if members.size == 1 and system.stacks[members[0]].is_oscillator:
            alone.append(int(members[0]))
        else:
            frames.append(_frame(system, members))
    return frames, alone


def all_frames(system: System) -> list[Frame]:
    """The frames of a system, oscillators on their own as buildings of one storey among them."""
    return [_frame(system, members) for members in _tied(system)]


def _tied(system: System) -> list[Array]:
    """Structures, counted from 0, that links tie to one another."""
    count = len(system.stacks)
    tied = np.zeros((count, count))
    owner = np.repeat(np.arange(count), np.diff(system.first))
    for tie in system.ties:
        tied[owner[tie.one], owner[tie.two]] = 1
    _, group = scipy.sparse.csgraph.connected_components(tied, directed=False)
    return [np.flatnonzero(group == number) for number in dict.fromkeys(group)]


def _frame(system: System, members: Array) -> Frame:
    first = system.first
    floors = np.concatenate([np.arange(first[m], first[m + 1]) for m in members])
    ties = [tie for tie in system.ties if tie.one in floors]
    position = {int(floor): i for i, floor in enumerate(floors)}
    n = floors.size
    drifts = np.eye(n)
    for i, floor in enumerate(floors):
        below = int(system.below[floor])
        if below >= 0:
            drifts[i, position[below]] = -1.0
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
    for tie in ties:
        along = np.zeros(n)
        along[position[tie.one]], along[position[tie.two]] = 1.0, -1.0
        kind, *spring = _spring(tie.link)
        force.append(spring)
        damping += tie.link.number("damping_constant") * np.outer(along, along)
        drifts = np.vstack([drifts, -along if kind == SLACK else along])
        kinds.append(kind)
        own.append(np.empty(0))
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
    modes = [_modes(stack.mass, _chain(stack)) for stack in stacks]
    modes.append(_modes(elements.mass, stiffness))
    return Frame(
        Storeys(elements, law_of(tuple(laws.middles))),
        floors,
        shortest=min(float(periods[shares >= LEAST_SHARE].min()) for periods, shares in modes),
        slowest=1 / float(-np.linalg.eigvals(elements.elastic()).real.max()),
        period=float(modes[-1][0].max()),
    )


def _chain(stack: Stack) -> Array:
    """Elastic stiffness of the floors of one structure."""
    k = stack.elastic
    return np.diag(k + np.append(k[1:], 0.0)) - np.diag(k[1:], 1) - np.diag(k[1:], -1)


def _modes(mass: Array, stiffness: Array) -> tuple[Array, Array]:
    """Periods [s], and the shares of the mass that the ground moves in each mode."""
    squares, shapes = scipy.linalg.eigh(stiffness, np.diag(mass))
    shares = (mass @ shapes) ** 2 / mass.sum()
    return 2 * np.pi / np.sqrt(squares), shares


def _spring(link: Link) -> tuple[int, float, float, float]:
    """Kind, ``post``, ``couple`` and strength of the spring of a link."""
    k = link.number("stiffness")
    if link.slack is not None:
        return SLACK, 0.0, k, link.number("slack")
    if not link.yields:
        return LINEAR, k, 0.0, np.inf
    alpha = link.number("hardening")
    return BILINEAR, alpha * k, (1 - alpha) * k, link.number("yield_displacement")


class _Laws:
    """The laws of a frame that the kernel does not have built in, each a `law_middle`."""

    def __init__(self) -> None:
        self.middles: list[Any] = []

    def kind(self, law: Structure, yields: bool) -> int:
        """By which number the kernel knows an element of this law."""
        steps = law.in_storeys() if yields else LINEAR
        if isinstance(steps, int):
            return steps
        if steps not in self.middles:
            self.middles.append(steps)
        return OTHER + self.middles.index(steps)


def relaxation_times(system: System, k_eq: Array) -> Array:
    """How slowly plastic drifts of the storeys relax by linearization [s]; 0 where they hold."""
    share = system.all("post") / system.all("elastic")
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(k_eq > 0, 1 / (share * k_eq), 0.0)
