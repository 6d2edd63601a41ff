"""Structures of a simulation, where they can meet, what is watched, and samples of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.simulation.stepping import whole_groups
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
    shares_at,
    stack_of,
    stacks_of,
)
from stochlin.models.uncertain import UncertainModel, median_of
from stochlin.solver.linearization.strength import strength_in_metres
from stochlin.solver.linearization.systems.systems import linearize_system
from stochlin.solver.simulation.connected_structures import (
    SteppedGroup,
    connected_groups,
    stepped_groups,
    unlinked_oscillators,
)
from stochlin.solver.simulation.ensembles import SimulationRun, drift_time_of, prepare
from stochlin.solver.tables.labels import (
    ELEMENT,
    FLOOR,
    element_coordinates,
    floor_coordinates,
)

STRUCTURE = "structure"
PATH, INPUT, GROUND = "path", "input", "ground"
STREAM = 2  # stream of random numbers, different from those of the motions with the same seed


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


def pairs_of(system: Arrangement) -> list[Pair]:
    """All pairs of structures, at all heights at which they could meet."""
    count = len(system.stacks)
    return [
        Pair(i, j, float(height))
        for i in range(count)
        for j in range(i + 1, count)
        for height in meeting_heights(system.stacks[i], system.stacks[j])
    ]


def at_height(system: Arrangement, number: int, height: float) -> Array:
    """Displacement of structure ``number`` at a height [m], by shares (f,) of all floors."""
    shares, first = np.zeros(int(system.first[-1])), system.first
    shares[first[number] : first[number + 1]] = shares_at(system.stacks[number].levels, height)
    return shares


def apart(system: Arrangement, pair: Pair) -> Array:
    """Relative displacement ``u_1 - u_2`` of a pair, by shares (f,) of all floors."""
    first, second = (at_height(system, number, pair.height) for number in (pair.first, pair.second))
    return first - second


class StructuresInMotion(NamedTuple):
    """All structures that are simulated under the same motions."""

    system: Arrangement
    groups: list[SteppedGroup]
    links: tuple[Link | None, ...]
    limits: Array  # (w,) or (motions, w) [m], drifts at which structures fall; see `Stack.limits`
    drift_times: Array  # (w,) relaxation time [s] of the plastic drifts; 0 for finite motions

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
    def floors(self) -> Array:
        """The displacements of all floors, as functions (f, w) of all that is `watched`."""
        return np.eye(len(self.system.floors), len(self.system.watched))

    @property
    def drifts(self) -> Array:
        """The drifts of all storeys and modes that yield, as `floors`; none of oscillators alone."""
        drifts = self.system.drifts
        return drifts if self.has_storeys else drifts[:0]

    @property
    def places(self) -> list[tuple[int, float]]:
        """Structures, each with the heights [m] at which it could meet another; none of oscillators."""
        known = [pair for pair in pairs_of(self.system) if not np.isnan(pair.height)]
        return sorted({(n, pair.height) for pair in known for n in (pair.first, pair.second)})

    @property
    def functions(self) -> dict[str, Array]:
        """All that has a peak in a finite motion, as functions (m, w) of all that is `watched`."""
        system, floors = self.system, self.floors
        at_heights = [at_height(system, *place) for place in self.places]
        relative = [apart(system, pair) for pair in pairs_of(system)]
        return {
            "floors": floors,
            "drifts": self.drifts,
            "places": np.reshape(at_heights, (-1, len(floors))) @ floors,
            "pairs": np.reshape(relative, (-1, len(floors))) @ floors,
        }

    @property
    def coords(self) -> dict[str, Any]:
        """Coordinates along `floor` and `element`."""
        if not self.has_storeys:
            return {STRUCTURE: self.system.floors}
        return {**floor_coordinates(self.system), **element_coordinates(self.system)}

    def run(self, ground: Ground, **options: Any) -> SimulationRun:
        """Ensemble of the structures, without a duration; the options are those of `prepare`."""
        return prepare(self.groups, ground, drift_times=self.drift_times, **options)


def structures_in_motion(
    structures: Sequence[AnyStructure],
    ground: Ground,
    link: Link | Sequence[Link | None] | None,
    stationary: bool,
    samples: Sequence[Sequence[Stack]] = (),
) -> StructuresInMotion:
    """Structures of a simulation; for a stationary one with relaxation times by linearization.

    ``samples`` are the structures of each motion if parameters are uncertain; then ``structures`` are
    the medians.
    """
    links = check_links("link", link, len(structures))
    system = arrangement_of([strength_in_metres(each, ground) for each in structures], links)
    drift_times, limits = np.zeros(len(system.watched)), system.limits
    if stationary:
        check_stationary(system)
        for n, stack in enumerate(system.stacks, start=1):
            stack.law.check_stationary(f"structures, number {n}")
        drift_times = _drift_times(structures, ground, system, links)
    if samples:
        limits = np.array([system._replace(stacks=tuple(stacks)).limits for stacks in samples])
    groups = connected_groups(system, samples) if samples else stepped_groups(system)
    return StructuresInMotion(system, groups, links, limits, drift_times)


def _drift_times(
    structures: Sequence[Any],
    ground: Ground,
    system: Arrangement,
    links: Sequence[Link | None],
) -> Array:
    """Relaxation times [s] of all that is `watched` by linearization; 0 if elastic."""
    alone, times = unlinked_oscillators(system), np.zeros(len(system.watched))
    if len(alone) < len(structures):
        times = _joint_drift_times(structures, ground, system, links)
    for number in alone:
        times[system.first[number]] = drift_time_of(structures[number], ground)
    return times


def _joint_drift_times(
    structures: Sequence[AnyStructure],
    ground: Ground,
    system: Arrangement,
    links: Sequence[Link | None],
) -> Array:
    storeys, count = system.storeys, len(system.watched)
    try:
        k_eq = linearize_system(structures, ground, links).k_eq.values[:count]
    except ArithmeticError:  # a run that is too short shows it by its change of variance
        return np.zeros(count)
    hardening = system.of_elements(storeys.post / storeys.elastic, 1.0, 1.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(k_eq > 0, 1 / (hardening * k_eq), 0.0)


class Draw(NamedTuple):
    """Structures and ground as given, and samples of their uncertain parameters."""

    structures: Sequence[Any]
    ground: Any
    motions: int
    factors: Mapping[str, Mapping[str, Array]]  # by model and parameter: samples (motions,) over median
    made: Mapping[str, list[Any]] = MappingProxyType({})  # by model: samples that were made before

    @property
    def models(self) -> dict[str, Any]:
        """Structures and ground by their names in the attributes of a dataset."""
        named = {f"structure_{n}": each for n, each in enumerate(self.structures, start=1)}
        return named | {GROUND: self.ground}

    @property
    def medians(self) -> tuple[list[Any], Any]:
        """Structures and ground at the medians of their parameters."""
        return [median_of(each) for each in self.structures], median_of(self.ground)

    def stacks(self) -> list[list[Stack]]:
        """Structures of each motion (motions, structures); none without uncertain parameters.

        A reduction factor refers to the median ground.
        """
        if not self.factors:
            return []
        columns = [self.samples_of(name) for name in self.models if name != GROUND]
        return [list(row) for row in zip(*columns, strict=True)]

    def samples_of(self, name: str) -> list[Any]:
        """Samples of a model for all motions: stacks of a structure, or grounds.

        The list is empty for a ground without uncertain parameters.
        """
        if name in self.made:
            return self.made[name]
        factors = self.factors.get(name, {})
        if name != GROUND:
            return self._stacks(self.models[name], factors, self.medians[1])
        rows = zip(*factors.values(), strict=True)
        return [self.ground.at(dict(zip(factors, map(float, row), strict=True))) for row in rows]

    def _stacks(self, model: Any, factors: Mapping[str, Array], ground: Any) -> list[Stack]:
        if not factors:
            return [stack_of(strength_in_metres(model, ground))] * self.motions
        if isinstance(model.median(), Structure) and "mass" not in factors:
            along = {name: xr.DataArray(column, dims=PATH) for name, column in factors.items()}
            sampled = strength_in_metres(model.at(along), ground)
            return stacks_of(sampled, PATH, self.motions)
        rows = zip(*factors.values(), strict=True)
        each = (dict(zip(factors, map(float, row), strict=True)) for row in rows)
        return [stack_of(strength_in_metres(model.at(sample), ground)) for sample in each]

    def table(self) -> dict[str, xr.DataArray]:
        """Variable ``input_factor`` of a dataset with all samples."""
        if not self.factors:
            return {}
        columns = {f"{m}.{name}": c for m, own in self.factors.items() for name, c in own.items()}
        values = np.stack(list(columns.values()), axis=1)
        inputs = (INPUT, list(columns), {"long_name": "uncertain parameter"})
        return {"input_factor": xr.DataArray(values, dims=(PATH, INPUT), coords={INPUT: inputs})}


def draw(structures: Sequence[Any], ground: Any, paths: int, seed: int) -> Draw:
    """Samples of uncertain parameters by Latin hypercube sampling (McKay, Beckman and Conover 1979).

    The number of motions is ``paths``, rounded up to whole groups.
    """
    motions = whole_groups(paths)
    listed = structures if isinstance(structures, Sequence) else ()  # other types are refused later
    drawn = Draw(listed, ground, motions, {})
    random = np.random.default_rng([seed, STREAM])
    factors = {
        role: {name: own.factor(_stratified(random, motions)) for name, own in model.uncertain.items()}
        for role, model in drawn.models.items()
        if isinstance(model, UncertainModel)
    }
    return drawn._replace(factors=factors)


def _stratified(random: np.random.Generator, count: int) -> Array:
    """Random numbers, one in each of ``count`` equal intervals between 0 and 1, in random order."""
    return (random.permutation(count) + random.random(count)) / count
