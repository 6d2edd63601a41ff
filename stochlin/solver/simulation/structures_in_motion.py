"""Structures of a simulation: oscillators without links, buildings and linked structures."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.models.grounds import Ground
from stochlin.models.links import Link
from stochlin.models.structures import Structure
from stochlin.models.systems import (
    AnyStructure,
    Arrangement,
    Stack,
    arrangement_of,
    check_links,
    check_stationary,
)
from stochlin.solver.linearization.strength import strength_in_metres
from stochlin.solver.linearization.systems.systems import linearize_system
from stochlin.solver.simulation.connected_structures import (
    SteppedGroup,
    connected_of,
    sampled_connected,
)
from stochlin.solver.simulation.ensembles import SimulationCells, SimulationRun, cells_of_all, prepare
from stochlin.solver.simulation.views import pairs_of
from stochlin.solver.tables.floors import ELEMENT, FLOOR, floor_coordinates

STRUCTURE = "structure"


class StructuresInMotion(NamedTuple):
    """All structures that are simulated under the same motions."""

    system: Arrangement
    cells: SimulationCells | None  # oscillators without links
    alone: list[int]  # numbers of their floors
    connected: list[SteppedGroup]
    links: tuple[Link | None, ...]
    strength: Array  # (w,) [m], of all that is watched
    limits: Array  # (w,) or (motions, w) [m], drifts at which structures fall; see `Stack.limits`
    drift_times: Array  # (w,) relaxation time [s] of its plastic drift; 0 for finite motions

    @property
    def has_storeys(self) -> bool:
        """Whether there is a building with storeys."""
        return not all(stack.is_oscillator for stack in self.system.stacks)

    @property
    def floor(self) -> str:
        """Dimension of displacements: ``structure`` if all are oscillators, else ``floor``."""
        return FLOOR if self.has_storeys else STRUCTURE

    @property
    def element(self) -> str:
        """Dimension of drifts: ``structure`` if all are oscillators, else ``element``."""
        return ELEMENT if self.has_storeys else STRUCTURE

    @property
    def functions(self) -> int:
        """Number of displacements, drifts and relative displacements with a peak in a finite motion."""
        storeys = self.strength.size if self.has_storeys else 0
        return len(self.system.floors) + storeys + len(pairs_of(self.system))

    def floor_coords(self) -> dict[str, Any]:
        """Coordinates of both dimensions of a table over pairs of floors."""
        if not self.has_storeys:
            names = [f"{n}" for n in range(1, self.strength.size + 1)]
            return {STRUCTURE: names, f"{STRUCTURE}_2": names}
        coords: dict[str, Any] = floor_coordinates(self.system)
        return coords | {f"{FLOOR}_2": coords[FLOOR][1]}

    def run(self, ground: Ground, **options: Any) -> SimulationRun:
        """Ensemble of the structures, without a duration; the options are those of `prepare`."""
        options |= {"connected": self.connected, "floors": self.alone}
        return prepare(self.cells, ground, drift_times=self.drift_times, **options)


def structures_in_motion(
    structures: Sequence[AnyStructure],
    ground: Ground,
    link: Link | Sequence[Link | None] | None,
    stationary: bool,
    samples: Sequence[Sequence[Stack]] | None = None,
) -> StructuresInMotion:
    """Structures of a simulation; for a stationary one with relaxation times by linearization.

    ``samples`` are the structures of each motion if parameters are uncertain; then ``structures`` are
    the medians.
    """
    links = check_links("link", link, len(structures))
    tied = {s for n, tie in enumerate(links, 1) if tie is not None for s in tie.structures or (n, n + 1)}
    sampled = samples is not None
    in_metres: list[AnyStructure] = [
        strength_in_metres(s, ground)
        if sampled or (isinstance(s, Structure) and (n in tied or not s.settles()))
        else s
        for n, s in enumerate(structures, start=1)
    ]
    system = arrangement_of(in_metres, links)
    if stationary:
        check_stationary(system)
        for n, stack in enumerate(system.stacks, start=1):
            stack.law.check_stationary(f"structures, number {n}")
    connected, alone = (
        connected_of(system) if samples is None else (sampled_connected(system, samples), [])
    )
    floors = [int(system.first[n]) for n in alone]
    strength = system.watched_strength
    drift_times = np.zeros(strength.size)
    cells = None
    if alone:
        oscillators: list[Any] = [structures[n] for n in alone]
        cells = cells_of_all(oscillators, ground, stationary)
        strength[floors], drift_times[floors] = cells.yield_displacement, cells.drift_time
    if stationary and connected:
        among = np.concatenate([group.watched for group in connected])
        drift_times[among] = _drift_times(structures, ground, links, system)[among]
    limits = system.limits
    if samples is not None:
        limits = np.array([system._replace(stacks=tuple(stacks)).limits for stacks in samples])
    return StructuresInMotion(system, cells, floors, connected, links, strength, limits, drift_times)


def _drift_times(
    structures: Sequence[AnyStructure],
    ground: Ground,
    links: Sequence[Link | None],
    system: Arrangement,
) -> Array:
    """Relaxation times [s] of all that is `watched` by linearization; 0 if elastic."""
    storeys, count = system.storeys, len(system.watched)
    try:
        k_eq = linearize_system(structures, ground, links).k_eq.values[:count]
    except ArithmeticError:  # a run that is too short shows it by its change of variance
        return np.zeros(count)
    hardening = system.of_elements(storeys.post / storeys.elastic, 1.0, 1.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(k_eq > 0, 1 / (hardening * k_eq), 0.0)
