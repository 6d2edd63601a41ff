"""Samples of uncertain parameters, one for each motion."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.simulation.stepping import whole_groups
from stochlin.models.structures import Structure
from stochlin.models.systems import Stack, stack_of, stacks_of
from stochlin.models.uncertain import UncertainModel, median_of
from stochlin.solver.linearization.strength import strength_in_metres

PATH, INPUT, GROUND = "path", "input", "ground"
STREAM = 2  # stream of random numbers, different from those of the motions with the same seed


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
