"""Structures of a simulation, where they can meet, what is watched, and samples of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.simulation.stepping import whole_groups
from stochlin.models.buildings.base import FLOOR
from stochlin.models.grounds import Ground
from stochlin.models.links import Link
from stochlin.models.start import Start
from stochlin.models.structures import Structure
from stochlin.models.systems import (
    Assembly,
    StickModel,
    assembly_of,
    check_links,
    check_stationary,
    shares_at,
    stick_model_of,
    stick_models_of,
)
from stochlin.models.uncertain import UncertainModel, median_of
from stochlin.solver.linearization.strength import strength_in_metres
from stochlin.solver.linearization.systems.systems import linearize_system
from stochlin.solver.simulation.connected_structures import (
    SteppedGroup,
    connected_groups,
    numbers_of,
    stepped_groups,
    unlinked_oscillators,
)
from stochlin.solver.simulation.ensembles import SimulationRun, drift_time_of, prepare
from stochlin.solver.simulation.start_values import start_values
from stochlin.solver.tables.labels import (
    ELEMENT,
    element_coordinates,
    floor_coordinates,
    named_models,
)

STRUCTURE = "structure"
PATH = "path"
INPUT = "input"
GROUND = "ground"
HEIGHT = "height"
Samples = Mapping[str, Sequence[Any]]  # by uncertain model: stacks or grounds, one for each motion
NO_SAMPLES: Samples = {}
# stream of random numbers for samples of parameters, unlike those of motions with the same seed
PARAMETER_STREAM = 2


class Pair(NamedTuple):
    """Two structures, by their numbers from 0, and a height of contact [m]; NaN for oscillators."""

    first: int
    second: int
    height: float


def meeting_heights(first: StickModel, second: StickModel) -> Array:
    """Heights [m] at which the relative displacement of two structures can be largest.

    Displacements are linear between floors, so that these are the levels of all floors of both, up
    to the lower roof. An oscillator has no height. Beside a building it is at the roof of the
    building; the height for two oscillators is NaN.
    """
    if first.is_oscillator or second.is_oscillator:
        other = second if first.is_oscillator else first
        return other.levels[-1:]
    both = np.unique(np.concatenate([first.levels, second.levels]))
    return both[both <= min(first.levels[-1], second.levels[-1])]


def pairs_of(system: Assembly) -> list[Pair]:
    """All pairs of structures, at all heights at which they could meet."""
    count = len(system.sticks)
    return [
        Pair(i, j, float(height))
        for i in range(count)
        for j in range(i + 1, count)
        for height in meeting_heights(system.sticks[i], system.sticks[j])
    ]


def at_height(system: Assembly, number: int, height: float) -> Array:
    """Displacement of structure ``number`` at a height [m], by shares (f,) of all floors."""
    shares = np.zeros(int(system.first[-1]))
    first = system.first
    shares[first[number] : first[number + 1]] = shares_at(system.sticks[number].levels, height)
    return shares


def apart(system: Assembly, pair: Pair) -> Array:
    """Relative displacement ``u_1 - u_2`` of a pair, by shares (f,) of all floors."""
    first = at_height(system, pair.first, pair.height)
    second = at_height(system, pair.second, pair.height)
    return first - second


class StructuresInMotion(NamedTuple):
    """All structures that are simulated under the same motions."""

    system: Assembly
    groups: list[SteppedGroup]
    links: tuple[Link | None, ...]
    # (w,) or (motions, w) [m], drifts at which structures fall; see `StickModel.limits`
    limits: Array
    run: SimulationRun  # whose duration is still open
    # by model and parameter: samples (motions,) over the median
    factors: Mapping[str, Mapping[str, Array]]
    samples: Samples
    assemblies: Sequence[Assembly]  # the system alone, or its samples, one for each motion

    @property
    def dimensions(self) -> tuple[str, str]:
        """Dimensions of displacements and of drifts: ``structure`` if all are oscillators."""
        return (FLOOR, ELEMENT) if self.system.has_storeys else (STRUCTURE, STRUCTURE)

    @property
    def floors(self) -> Array:
        """The displacements of all floors, as functions (f, w) of all that is `watched`."""
        return np.eye(len(self.system.floors), len(self.system.watched))

    @property
    def drifts(self) -> Array:
        """Drifts of all storeys and modes that yield, as `floors`; none of oscillators alone."""
        drifts = self.system.drifts
        return drifts if self.system.has_storeys else drifts[:0]

    @property
    def places(self) -> list[tuple[int, float]]:
        """Structures, each with heights [m] at which it could meet another; none of oscillators."""
        pairs = [pair for pair in pairs_of(self.system) if not np.isnan(pair.height)]
        return sorted({(n, pair.height) for pair in pairs for n in (pair.first, pair.second)})

    @property
    def heights(self) -> Array:
        """Heights [m] at which structures could meet, in increasing order; none of oscillators."""
        return np.unique([height for _, height in self.places])

    @property
    def functions(self) -> dict[str, Array]:
        """All that has a peak in a finite motion, as functions (m, w) of all that is `watched`."""
        system = self.system
        floors = self.floors
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
        """Coordinates along the `dimensions`."""
        if not self.system.has_storeys:
            return {STRUCTURE: self.system.floors}
        return {**floor_coordinates(self.system), **element_coordinates(self.system)}

    def starting(self, start: Start | None) -> StructuresInMotion:
        """The same structures in motions that begin with these values, or from rest."""
        if start is None:
            return self
        values = start_values(self.system, start)
        owners = [np.unique(self.system.owners[group.watched]) for group in self.groups]
        starts = [
            values[:, numbers_of(self.system.first_coordinate, members)] / group.scale
            for group, members in zip(self.groups, owners, strict=True)
        ]
        run = self.run._replace(ensemble=self.run.ensemble._replace(starts=starts))
        return self._replace(run=run)

    def input_factors(self) -> dict[str, xr.DataArray]:
        """Variable ``input_factor`` of a dataset with all samples."""
        if not self.factors:
            return {}
        columns = {
            f"{role}.{name}": column
            for role, factors in self.factors.items()
            for name, column in factors.items()
        }
        values = np.stack(list(columns.values()), axis=1)
        inputs = (INPUT, list(columns), {"long_name": "uncertain parameter"})
        return {"input_factor": xr.DataArray(values, dims=(PATH, INPUT), coords={INPUT: inputs})}


def structures_in_motion(
    structures: Sequence[Any],
    ground: Any,
    link: Link | Sequence[Link | None] | None,
    stationary: bool,
    *,
    paths: int,
    seed: int,
    made: Samples = NO_SAMPLES,
    **options: Any,
) -> StructuresInMotion:
    """Structures of a simulation; for a stationary one with relaxation times by linearization.

    Of uncertain models, the system has the medians, and each motion a sample by Latin hypercube
    sampling (McKay, Beckman and Conover 1979). A reduction factor refers to the median ground.
    Models whose samples were ``made`` before have these. The ``options`` are those of `prepare`.
    """
    models = named_models(structures, ground)
    factors = _factors(models, whole_groups(paths), seed)
    if stationary and factors:
        role, names = next(iter(factors.items()))
        what = f"{role}: {', '.join(names)} is uncertain, and duration is missing"
        raise ValueError(f"{what}; give a duration, or the median()")
    *medians, usual = map(median_of, models.values())
    links = check_links("link", link, len(medians))
    system = assembly_of([strength_in_metres(median, usual) for median in medians], links)
    drift_times = np.zeros(len(system.watched))
    limits = system.limits
    if stationary:
        check_stationary(system)
        for n, stick in enumerate(system.sticks, start=1):
            stick.law.check_stationary(f"structures, number {n}")
        drift_times = _drift_times(medians, usual, system, links)
    samples = {
        role: made.get(role) or _samples(models[role], factors_of_role, usual)
        for role, factors_of_role in factors.items()
    }
    rows: list[Any] = []  # structures of each motion
    assemblies = [system]
    if samples:
        named = zip(models, system.sticks, strict=False)  # without the ground
        columns = [samples.get(role, [stick] * whole_groups(paths)) for role, stick in named]
        rows = [*zip(*columns, strict=True)]
        assemblies = [system._replace(sticks=row) for row in rows]
        limits = np.array([assembly.limits for assembly in assemblies])
    groups = connected_groups(system, rows) if samples else stepped_groups(system)
    options |= {"drift_times": drift_times, "grounds": samples.get(GROUND, [])}
    run = prepare(groups, usual, paths=paths, seed=seed, **options)
    return StructuresInMotion(system, groups, links, limits, run, factors, samples, assemblies)


def _drift_times(
    structures: Sequence[Any],
    ground: Ground,
    system: Assembly,
    links: Sequence[Link | None],
) -> Array:
    """Relaxation times [s] of all that is `watched` by linearization; 0 if elastic."""
    alone = unlinked_oscillators(system)
    times = np.zeros(len(system.watched))
    # Without a linearization, a run that is too short shows it by its change of variance.
    with suppress(ArithmeticError), np.errstate(divide="ignore", invalid="ignore"):
        if len(alone) < len(structures):
            k_eq = linearize_system(structures, ground, links).k_eq.values[: times.size]
            hardening = system.of_elements(system.storeys.post / system.storeys.elastic, 1.0, 1.0)
            times = np.where(k_eq > 0, 1 / (hardening * k_eq), 0.0)
    for number in alone:
        times[system.first[number]] = drift_time_of(structures[number], ground)
    return times


def _factors(models: Mapping[str, Any], motions: int, seed: int) -> dict[str, dict[str, Array]]:
    random = np.random.default_rng([seed, PARAMETER_STREAM])
    return {
        role: {
            name: parameter.factor(_stratified(random, motions))
            for name, parameter in model.uncertain.items()
        }
        for role, model in models.items()
        if isinstance(model, UncertainModel)
    }


def _samples(model: UncertainModel, factors: Mapping[str, Array], ground: Ground) -> list[Any]:
    """Samples of a model for all motions: grounds or stacks of a structure on the median ground."""
    median = model.median()
    motions = len(next(iter(factors.values())))
    if isinstance(median, Structure) and "mass" not in factors:
        along = {name: xr.DataArray(column, dims=PATH) for name, column in factors.items()}
        return stick_models_of(strength_in_metres(model.at(along), ground), PATH, motions)
    rows = zip(*factors.values(), strict=True)
    sampled = (model.at(dict(zip(factors, map(float, row), strict=True))) for row in rows)
    if isinstance(median, Ground):
        return [*sampled]
    return [stick_model_of(strength_in_metres(sample, ground)) for sample in sampled]


def _stratified(random: np.random.Generator, count: int) -> Array:
    """Random numbers, one in each of ``count`` equal intervals between 0 and 1, in random order."""
    return (random.permutation(count) + random.random(count)) / count
