"""Inputs of a separation: the numbers that describe the structures and the ground."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from stochlin.analyses.linearization.strength import strength_in_metres
from stochlin.analyses.simulation.draws import GROUND, Draw, draw
from stochlin.kernels.basics.arrays import Array
from stochlin.models.buildings import RegularBuilding
from stochlin.models.grounds import Ground
from stochlin.models.systems import AnyStructure
from stochlin.models.uncertain import Uncertain, UncertainModel, median_of

WITHOUT = ("peak_factor", "mass")  # of an oscillator: part of a definition, and without influence
STEP = 0.1  # relative change of a known input, to either side
RANGE = 0.16, 0.84  # probabilities at the ends of the range of an uncertain input


class Input(NamedTuple):
    """An input: one number of a model, or the common factor of several numbers."""

    role: str
    key: str
    value: float  # median; 1 for a common factor
    units: str
    quantity: Uncertain  # with spread 0 if the input is known exactly

    @property
    def name(self) -> str:
        """Name of the input, as for the samples of `separation`."""
        return f"{self.role}.{self.key}"

    @property
    def uncertain(self) -> bool:
        """Whether the input has a spread."""
        return self.quantity.spread > 0

    def ends(self) -> tuple[float, ...]:
        """Ends of the range over the median: quantiles of 16 and 84 %, or 10 % to either side."""
        if not self.uncertain:
            return 1 - STEP, 1 + STEP
        return tuple(float(self.quantity.factor(share)) for share in RANGE)


class Inputs(NamedTuple):
    """All inputs, and the models in which they can be changed."""

    sources: tuple[Sequence[Any], Any]  # structures and ground, from which samples are drawn
    models: Mapping[str, UncertainModel]
    inputs: Sequence[Input]

    @classmethod
    def of(cls, structures: Sequence[AnyStructure], ground: Ground) -> Inputs:
        """The inputs of structures and ground; reduction factors refer to the median ground."""
        usual = median_of(ground)
        roles = {f"structure_{n}": each for n, each in enumerate(structures, start=1)}
        models, inputs = dict[str, UncertainModel](), list[Input]()
        for role, model in [*roles.items(), (GROUND, ground)]:
            described = _described(model)
            own = [entry for entry in _inputs(role, described) if entry.value]
            inputs += own
            arguments = {**described.arguments, **{entry.key: entry.quantity for entry in own}}
            models[role] = dataclasses.replace(described, arguments=arguments)
            if role != GROUND:
                models[role] = models[role].changed(lambda s: strength_in_metres(s, usual))
        return cls((structures, ground), models, inputs)

    @property
    def uncertain(self) -> list[Input]:
        """The inputs that have a spread."""
        return [entry for entry in self.inputs if entry.uncertain]

    def sampled(self, paths: int, seed: int) -> dict[str, Array]:
        """Samples of the uncertain inputs over their medians, by name, one for each motion."""
        factors = draw(*self.sources, paths, seed).factors
        return {entry.name: factors[entry.role][entry.key] for entry in self.uncertain}

    def at(self, samples: Mapping[str, Array], changes: Mapping[str, float], motions: int) -> Draw:
        """The models with these samples of their inputs, some of which are multiplied by a factor."""
        models, factors = dict[str, Any](), dict[str, dict[str, Array]]()
        for role, model in self.models.items():
            own = [entry for entry in self.inputs if entry.role == role]
            drawn = {entry.key: samples[entry.name] for entry in own if entry.name in samples}
            fixed = {entry.key: changes.get(entry.name, 1.0) for entry in own}
            if drawn:
                each = {key: factor * drawn.get(key, np.ones(motions)) for key, factor in fixed.items()}
                models[role], factors[role] = model, each
            else:
                models[role] = model.at(fixed)
        *structures, ground = models.values()
        return Draw(structures, ground, motions, factors)

    def possible(self, entry: Input, factor: float) -> bool:
        """Whether an input times ``factor`` is an allowed value."""
        try:
            self.models[entry.role].at({entry.key: factor})
        except ValueError:
            return False
        return True


def _described(model: Any) -> UncertainModel:
    if isinstance(model, UncertainModel):
        return model
    fields = [field.name for field in dataclasses.fields(model) if field.init]
    return UncertainModel(type(model), {name: getattr(model, name) for name in fields})


def _inputs(role: str, described: UncertainModel) -> list[Input]:
    """The inputs of a model: its declared parameters that are given, arrays as a common factor."""
    median = described.median()
    kinds = (type(median), RegularBuilding)
    inputs = []
    for key, value in described.arguments.items():
        kind = next((kind for kind in kinds if key in kind.parameter_names()), None)
        if kind is None or value is None or (key in WITHOUT and not hasattr(median, "masses")):
            continue
        quantity = value if isinstance(value, Uncertain) else Uncertain(np.asarray(value, float), 0.0)
        usual = getattr(median, key) if kind is type(median) else quantity.median
        one_number = np.ndim(usual) == 0
        size = float(np.asarray(usual)) if one_number else float(np.any(usual))
        inputs.append(Input(role, key, size, kind.units(key) if one_number else "1", quantity))
    return inputs
