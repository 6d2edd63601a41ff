"""Displacements of floors, storey drifts and relative displacements, as functions of the floors."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.simulation.ensemble import View
from stochlin.models.systems import Arrangement, Stack, shares_at

# Linear function of displacements: numbers of floors, or after them of modes that yield, and factors.
Terms = dict[int, float]


class Pair(NamedTuple):
    """Two structures, by their numbers from 0, and a height of contact [m]; NaN for oscillators."""

    first: int
    second: int
    height: float


def meeting_heights(first: Stack, second: Stack) -> Array:
    """Heights [m] at which the relative displacement of two structures can be largest.

    Displacements are linear between floors, so that these are the levels of all floors of both, up to
    the lower roof. An oscillator has no height. Beside a building it is at the roof of the building; the
    height for two oscillators is NaN.
    """
    if first.is_oscillator or second.is_oscillator:
        other = second if first.is_oscillator else first
        return other.levels[-1:]
    both = np.unique(np.concatenate([first.levels, second.levels]))
    return both[both <= min(first.levels[-1], second.levels[-1])]


def displacement_at(stack: Stack, height: float) -> Terms:
    """Displacement of a structure at a height, linear between its floors and the ground."""
    if stack.is_oscillator:
        return {0: 1.0}
    return shares_at(stack.levels, height)


def pairs_of(system: Arrangement) -> list[Pair]:
    """All pairs of structures, at all heights at which they could meet."""
    count = len(system.stacks)
    return [
        Pair(i, j, float(height))
        for i in range(count)
        for j in range(i + 1, count)
        for height in meeting_heights(system.stacks[i], system.stacks[j])
    ]


def at_height(system: Arrangement, number: int, height: float) -> Terms:
    """Displacement of a structure of the system at a height."""
    first = int(system.first[number])
    terms = displacement_at(system.stacks[number], height)
    return {first + floor: share for floor, share in terms.items()}


def displacements(system: Arrangement, pair: Pair) -> tuple[Terms, Terms]:
    """Displacements of both structures of a pair."""
    first, second = (at_height(system, number, pair.height) for number in (pair.first, pair.second))
    return first, second


def apart(system: Arrangement, pair: Pair) -> Terms:
    """Relative displacement ``u_1 - u_2`` of a pair."""
    first, second = displacements(system, pair)
    return first | {floor: -share for floor, share in second.items()}


def at_heights(system: Arrangement) -> list[tuple[int, float, Terms]]:
    """Structures with the heights at which they could meet others, and their displacements there.

    Pairs of oscillators, whose height is NaN, are left out.
    """
    known = [pair for pair in pairs_of(system) if not np.isnan(pair.height)]
    places = {(n, pair.height) for pair in known for n in (pair.first, pair.second)}
    return [(n, h, at_height(system, n, h)) for n, h in sorted(places)]


def drifts_of(system: Arrangement) -> list[Terms]:
    """Drifts of all storeys of a system, and displacements of the modes that yield."""
    return [{int(i): float(row[i]) for i in np.flatnonzero(row)} for row in system.drifts]


def view_of(functions: list[Terms], rows: Array, scale: Array) -> View:
    """Linear functions of floor displacements for an ensemble.

    ``rows`` has the row of each floor in the crowd, and ``scale`` its unit of displacement [m].
    """
    widest = max(len(terms) for terms in functions)
    row = np.zeros((len(functions), widest), np.int64)
    weight = np.zeros((len(functions), widest))
    for number, terms in enumerate(functions):
        for k, (floor, share) in enumerate(terms.items()):
            row[number, k], weight[number, k] = rows[floor], share * scale[floor]
    return View(row, weight)
