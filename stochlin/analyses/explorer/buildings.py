"""Storeys of a building from a case file, as plain numbers of a scene, which can be compared."""

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
    """Parameters of the storeys from a case file; those that sliders change are in the scene."""

    period: float  # period of the first mode without P-delta effects [s]
    columns: tuple[tuple[str, Column], ...]  # those of `OF_STOREYS` that are given
    law: str
    law_parameters: tuple[tuple[str, Column], ...]
    p_delta: bool

    @classmethod
    def of(cls, building: ShearBuilding) -> Self:
        """Parameters of the storeys of a building."""
        values = {name: getattr(building, name) for name in OF_STOREYS}
        own = building.law_parameters or {}
        return cls(
            float(dataclasses.replace(building, p_delta=False).periods()[0]),
            tuple((name, _plain(value)) for name, value in values.items() if value is not None),
            str(building.law),
            tuple((name, _plain(value)) for name, value in own.items()),
            building.p_delta,
        )

    @property
    def given(self) -> dict[str, Column]:
        """Parameters of the storeys by name."""
        return dict(self.columns)

    def building(
        self, period: float, damping: float, hardening: float | None, strength_factor: float
    ) -> ShearBuilding:
        """Building with stiffnesses scaled to a period, and with scaled yield shears.

        The yield shears are those of the file times ``strength_factor`` for any period, and the yield
        drifts follow from them. Without hardening the building is elastic.
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
    """Dataset with the parameters of the storeys of a building."""
    arrays, table = building.arrays(), xr.Dataset()
    for name in OF_STOREYS:
        if name in arrays:
            about = building.__dataclass_fields__[name].metadata
            attrs = {key: about[key] for key in ("units", "long_name")}
            table[name] = arrays[name].broadcast_like(arrays["masses"]).assign_attrs(attrs)
    return table


def _plain(value: Any) -> Column:
    array = np.asarray(value, float)
    return tuple(array.tolist()) if array.ndim else float(array)
