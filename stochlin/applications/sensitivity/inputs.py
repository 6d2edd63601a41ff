"""Inputs of a separation: the numbers that describe the structures and the ground."""

from __future__ import annotations

import dataclasses
from typing import Any, NamedTuple

import numpy as np

from stochlin.models.buildings import RegularBuilding
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


def changed(model: UncertainModel, key: str, factor: float) -> UncertainModel:
    """The model with an input known to be ``factor`` times its median; other samples stay.

    Raises a ValueError if that is no value of the input.
    """
    value = model.arguments[key]
    known: Any = factor * np.asarray(median_of(value))
    if isinstance(value, Uncertain):
        known = Uncertain(known, 0.0)
    new = dataclasses.replace(model, arguments={**model.arguments, key: known})
    new.median()
    return new


def described(model: Any) -> UncertainModel:
    """The model as one with uncertain parameters, of which there may be none."""
    if isinstance(model, UncertainModel):
        return model
    fields = [field.name for field in dataclasses.fields(model) if field.init]
    return UncertainModel(type(model), {name: getattr(model, name) for name in fields})


def inputs_of(role: str, model: UncertainModel) -> list[Input]:
    """The inputs of a model: its declared parameters that are not 0, arrays as a common factor."""
    median = model.median()
    kinds = (type(median), RegularBuilding)
    inputs = []
    for key, value in model.arguments.items():
        kind = next((kind for kind in kinds if key in kind.parameter_names()), None)
        if kind is None or value is None or (key in WITHOUT and not hasattr(median, "masses")):
            continue
        quantity = value if isinstance(value, Uncertain) else Uncertain(np.asarray(value, float), 0.0)
        usual = getattr(median, key) if kind is type(median) else quantity.median
        one_number = np.ndim(usual) == 0
        size = float(np.asarray(usual)) if one_number else float(np.any(usual))
        if size:
            inputs.append(Input(role, key, size, kind.units(key) if one_number else "1", quantity))
    return inputs
