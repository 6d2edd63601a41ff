"""The storeys of a file's building in a scene: plain numbers, by which scenes are told apart."""

from __future__ import annotations

import dataclasses
from typing import Any, NamedTuple, Self

import numpy as np
import xarray as xr

from stochlin.models.buildings import OF_STOREYS, ShearBuilding

OSCILLATOR, REGULAR, OF_FILE = "oscillator", "regular storeys", "storeys of the file"
DESCRIPTIONS = (OSCILLATOR, REGULAR, OF_FILE)

Column = float | tuple[float, ...]


class StoreysOfFile(NamedTuple):
    """What the file says of each storey, and of all of them; what sliders change of it is elsewhere."""

    period: float  # of the first mode, without the effect of the weight [s]
    columns: tuple[tuple[str, Column], ...]  # of `OF_STOREYS` those that are given
    law: str
    law_parameters: tuple[tuple[str, Column], ...]
    p_delta: bool

    @classmethod
    def of(cls, building: ShearBuilding) -> Self:
        """Those of a building."""
        given = {name: getattr(building, name) for name in OF_STOREYS}
        own = building.law_parameters or {}
        return cls(
            float(dataclasses.replace(building, p_delta=False).periods()[0]),
            tuple((name, _plain(value)) for name, value in given.items() if value is not None),
            str(building.law),
            tuple((name, _plain(value)) for name, value in own.items()),
            building.p_delta,
        )

    @property
    def given(self) -> dict[str, Column]:
        """The columns by their names."""
        return dict(self.columns)

    def building(
        self, period: float, damping: float, hardening: float | None, strength_factor: float
    ) -> ShearBuilding:
        """With all stiffnesses in one proportion, that of this period, and so the shears at yield.

        These are the file's times the factor, whatever the period: the drifts at yield follow. Elastic
        without hardening.
        """
        values: dict[str, Any] = self.given
        stiffer = (self.period / period) ** 2
        values["stiffnesses"] = np.multiply(values["stiffnesses"], stiffer)
        drifts = values.pop("yield_drifts", None)
        if hardening is not None and drifts is not None:
            values["hardening"] = hardening
            values["yield_drifts"] = np.multiply(drifts, strength_factor / stiffer).tolist()
        return ShearBuilding(
            **values,
            damping=damping,
            law=self.law,
            law_parameters=dict(self.law_parameters),
            p_delta=self.p_delta,
        )


def storeys_table(building: ShearBuilding) -> xr.Dataset:
    """What it has of each storey."""
    given, table = building.arrays(), xr.Dataset()
    for name in OF_STOREYS:
        if name in given:
            about = building.__dataclass_fields__[name].metadata
            told = {key: about[key] for key in ("units", "long_name")}
            table[name] = given[name].broadcast_like(given["masses"]).assign_attrs(told)
    return table


def _plain(value: Any) -> Column:
    array = np.asarray(value, float)
    return tuple(array.tolist()) if array.ndim else float(array)
