"""Samples of what is not known exactly, one for every motion."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from stochlin.analyses.linearization.strength import strength_in_metres
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.simulation.stepping import LANES
from stochlin.models.structures import Structure
from stochlin.models.systems import Stack, stack_of, stacks_of
from stochlin.models.uncertain import UncertainModel, median_of

PATH, INPUT, GROUND = "path", "input", "ground"
STREAM = 2  # of the seed, beside those of the motions


class Draw(NamedTuple):
    """Structures and ground as they were given, and samples of what is not known of them."""

    structures: Sequence[Any]
    ground: Any
    motions: int
    factors: Mapping[str, Mapping[str, Array]]  # by model and parameter: (motions,), over the median
    made: Mapping[str, list[Any]] = MappingProxyType({})  # by model: samples that are there already

    @property
    def models(self) -> dict[str, Any]:
        """All of them, by their names in a dataset."""
        named = {f"structure_{n}": each for n, each in enumerate(self.structures, start=1)}
        return named | {GROUND: self.ground}

    @property
    def medians(self) -> tuple[list[Any], Any]:
        """Structures and ground at the medians of their parameters."""
        return [median_of(each) for each in self.structures], median_of(self.ground)

    def stacks(self) -> list[list[Stack]] | None:
        """The structures of every motion (motions, structures); None if all are known exactly.

        Strengths by reduction factor refer to the ground at its median.
        """
        if not self.factors:
            return None
        columns = [self.samples_of(name) for name in self.models if name != GROUND]
        return [list(row) for row in zip(*columns, strict=True)]

    def samples_of(self, name: str) -> list[Any]:
        """A model in every motion: stacks of a structure, or grounds, none if there is but one."""
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
        return [stack_of(strength_in_metres(model.at(one), ground)) for one in each]

    def grounds(self) -> list[Any]:
        """The grounds of every motion; none if there is but one."""
        return self.samples_of(GROUND)

    def table(self) -> dict[str, xr.DataArray]:
        """The samples, as a variable of a dataset."""
        if not self.factors:
            return {}
        columns = {f"{m}.{name}": c for m, own in self.factors.items() for name, c in own.items()}
        values = np.stack(list(columns.values()), axis=1)
        told = (INPUT, list(columns), {"long_name": "parameter that is not known exactly"})
        return {"input_factor": xr.DataArray(values, dims=(PATH, INPUT), coords={INPUT: told})}


def draw(structures: Sequence[Any], ground: Any, paths: int, seed: int, number: int = 0) -> Draw:
    """Samples for so many paths, in whole groups; those of other numbers are independent.

    A Latin hypercube (McKay, Beckman and Conover 1979): each parameter takes all of its range.
    """
    motions = -(-paths // LANES) * LANES
    listed = structures if isinstance(structures, Sequence) else ()  # what else it is, is told later
    found = Draw(listed, ground, motions, {})
    random = np.random.default_rng([seed, STREAM, *([number] if number else [])])
    factors = {
        role: {name: one.factor(_stratified(random, motions)) for name, one in model.uncertain.items()}
        for role, model in found.models.items()
        if isinstance(model, UncertainModel)
    }
    return found._replace(factors=factors)


def _stratified(random: np.random.Generator, count: int) -> Array:
    """Numbers between 0 and 1, one in each of as many equal parts, in any order."""
    return (random.permutation(count) + random.random(count)) / count
