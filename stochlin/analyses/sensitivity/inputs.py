"""What a separation depends on: the numbers by which structures and ground are described."""

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

WITHOUT = ("peak_factor", "mass")  # of an oscillator: a definition, and what nothing here hangs on
STEP = 0.1  # by which an input is changed for its slope, to either side; an example of what is known
RANGE = 0.16, 0.84  # shares of the values of an uncertain input below its ends


class Input(NamedTuple):
    """One number of a model, or the common factor of several."""

    role: str
    key: str
    value: float  # its median; 1 of a common factor
    units: str
    given: Uncertain  # without spread where it is known exactly

    @property
    def name(self) -> str:
        """As in the samples of `separation`."""
        return f"{self.role}.{self.key}"

    @property
    def uncertain(self) -> bool:
        """Whether it is not known exactly."""
        return self.given.spread > 0

    def ends(self) -> tuple[float, ...]:
        """A low and a high value over the median: of 16 and 84 %, or an example to either side."""
        if not self.uncertain:
            return 1 - STEP, 1 + STEP
        return tuple(float(self.given.factor(share)) for share in RANGE)


class Inputs(NamedTuple):
    """All of them, and the models in which they can be changed."""

    given: tuple[Sequence[Any], Any]  # structures and ground, of which samples are drawn
    models: Mapping[str, UncertainModel]
    inputs: Sequence[Input]

    @classmethod
    def of(cls, structures: Sequence[AnyStructure], ground: Ground) -> Inputs:
        """Those of structures, whose strength is that on the usual ground, and of the ground."""
        usual = median_of(ground)
        roles = {f"structure_{n}": each for n, each in enumerate(structures, start=1)}
        models, inputs = dict[str, UncertainModel](), list[Input]()
        for role, model in [*roles.items(), (GROUND, ground)]:
            described = _described(model)
            own = [one for one in _inputs(role, described) if one.value]
            inputs += own
            arguments = {**described.arguments, **{one.key: one.given for one in own}}
            models[role] = dataclasses.replace(described, arguments=arguments)
            if role != GROUND:
                models[role] = models[role].changed(lambda s: strength_in_metres(s, usual))
        return cls((structures, ground), models, inputs)

    @property
    def uncertain(self) -> list[Input]:
        """Those that are not known exactly."""
        return [one for one in self.inputs if one.uncertain]

    def sampled(self, paths: int, seed: int, number: int) -> dict[str, Array]:
        """Samples of the uncertain ones over their medians, by name, one for every motion."""
        factors = draw(*self.given, paths, seed, number).factors
        return {one.name: factors[one.role][one.key] for one in self.uncertain}

    def at(self, samples: Mapping[str, Array], changes: Mapping[str, float], motions: int) -> Draw:
        """The models with these samples, some inputs multiplied by a number."""
        found, factors = dict[str, Any](), dict[str, dict[str, Array]]()
        for role, model in self.models.items():
            own = [one for one in self.inputs if one.role == role]
            drawn = {one.key: samples[one.name] for one in own if one.name in samples}
            fixed = {one.key: changes.get(one.name, 1.0) for one in own}
            if drawn:
                each = {key: factor * drawn.get(key, np.ones(motions)) for key, factor in fixed.items()}
                found[role], factors[role] = model, each
            else:
                found[role] = model.at(fixed)
        *structures, ground = found.values()
        return Draw(structures, ground, motions, factors)

    def possible(self, one: Input, samples: Mapping[str, Array], factor: float) -> bool:
        """Whether the model takes all samples of an input that is multiplied by this."""
        drawn = samples.get(one.name, np.ones(1))
        try:
            for end in (drawn.min(), drawn.max()):
                self.models[one.role].at({one.key: factor * float(end)})
        except ValueError:
            return False
        return True


def _described(model: Any) -> UncertainModel:
    if isinstance(model, UncertainModel):
        return model
    fields = [field.name for field in dataclasses.fields(model) if field.init]
    return UncertainModel(type(model), {name: getattr(model, name) for name in fields})


def _inputs(role: str, described: UncertainModel) -> list[Input]:
    """The numbers among the arguments, by the units that models declare; arrays by a common factor."""
    median = described.median()
    kinds = (type(median), RegularBuilding)
    found = []
    for key, value in described.arguments.items():
        kind = next((kind for kind in kinds if key in kind.parameter_names()), None)
        if kind is None or value is None or (key in WITHOUT and not hasattr(median, "masses")):
            continue
        given = value if isinstance(value, Uncertain) else Uncertain(np.asarray(value, float), 0.0)
        usual = getattr(median, key) if kind is type(median) else given.median
        one_number = np.ndim(usual) == 0
        size = float(np.asarray(usual)) if one_number else float(np.any(usual))
        found.append(Input(role, key, size, kind.units(key) if one_number else "1", given))
    return found
