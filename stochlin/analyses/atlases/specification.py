"""Specification of an atlas, a TOML file with data only, which is checked before any computation.

::

    title = "Lake beds"             # optional
    ground = "kanai_tajimi"         # or another kind of ground
    closure = "gaussian"            # optional
    block_cells = 1000000           # optional: cells that are computed and written at a time

    [parameters]                    # a number is fixed; a list or a sweep is an axis
    period_1 = { start = 0.1, stop = 10, count = 400, spacing = "log" }     # over the ground period
    period_2 = { start = 0.1, stop = 10, count = 400, spacing = "log" }
    ground_damping = [0.05, 0.2, 0.6]
    damping = 0.05                  # of both structures; or damping_1 and damping_2
    hardening = [0.02, 0.1]
    reduction_factor = { start = 1, stop = 6, count = 11 }
"""

from __future__ import annotations

import itertools
import json
import math
import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from stochlin.analyses.tables.toml import read_toml
from stochlin.messages import brief, listed
from stochlin.models.arguments import Whole, check_label, is_number, is_whole
from stochlin.models.grounds import GROUNDS, Ground
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.parameters import Model
from stochlin.models.structures import STATIONARY_HARDENING

KEYS = ("title", "ground", "closure", "block_cells", "parameters")
SWEEP = ("start", "stop", "count", "spacing")
OF_STRUCTURES = ("damping", "hardening", "reduction_factor")
UNITS = {"ground_period": 1.0, "intensity": 1.0}  # values [s], [m^2/s^3] to which results are scaled
LONGEST_AXIS = 1_000_000
BLOCK_CELLS = 1_000_000


@dataclass(frozen=True)
class AtlasSpecification:
    """A checked specification."""

    title: str
    ground: str
    closure: str
    block_cells: int
    parameters: Mapping[str, float | tuple[float, ...]]

    @property
    def axes(self) -> dict[str, tuple[float, ...]]:
        """The parameters that are swept."""
        return {name: value for name, value in self.parameters.items() if isinstance(value, tuple)}

    @property
    def cells(self) -> int:
        """Number of cells of the table."""
        return math.prod(len(values) for values in self.axes.values())

    def as_json(self) -> str:
        """The specification as JSON, for comparison with that of an existing atlas."""
        return json.dumps(vars(self), sort_keys=True)

    def models(self) -> tuple[Bilinear, Bilinear, Ground]:
        """The two structures and the ground, whose period is 1 s and intensity 1 m^2/s^3."""
        pair = []
        for n in (1, 2):
            values = {"period": self._value(f"period_{n}")}
            for name in OF_STRUCTURES:
                own = f"{name}_{n}" if f"{name}_{n}" in self.parameters else name
                if own in self.parameters:
                    values[name] = self._value(own)
            pair.append(Bilinear(**values))
        kind = GROUNDS[self.ground]
        soil: dict[str, Any] = {
            own: self._value(name) if name in self.parameters else UNITS[name]
            for name, own in kind.beside_structures().items()
        }
        return pair[0], pair[1], kind(**soil)

    def _value(self, name: str) -> Any:
        value = self.parameters[name]
        if isinstance(value, float):
            return value
        return xr.DataArray(np.array(value), dims=name, coords={name: np.array(value)})


def read_specification(path: str | os.PathLike[str]) -> AtlasSpecification:
    """Read a specification from a TOML file; a ValueError if it is not valid."""
    _, data = read_toml(Path(path))
    return specification(data)


def specification(data: Mapping[str, Any]) -> AtlasSpecification:
    """The checked specification from nested mappings; raises as `read_specification`."""
    _only(data, KEYS, "the specification")
    ground = _one_of(data.get("ground", "kanai_tajimi"), tuple(GROUNDS), "ground")
    closure = _one_of(data.get("closure", "gaussian"), Bilinear.closure_names(), "closure")
    title = data.get("title", "Correlation of two structures")
    check_label("title", title)
    block = data.get("block_cells", BLOCK_CELLS)
    Whole(1)("block_cells", block)
    parameters = data.get("parameters")
    if not isinstance(parameters, Mapping):
        raise ValueError("[parameters] is missing; it needs period_1, period_2 and damping at least")
    _check_names(parameters, ground)
    values = {name: _parameter(name, value) for name, value in parameters.items()}
    chosen = AtlasSpecification(title, ground, closure, block, values)
    if not chosen.axes:
        raise ValueError("no parameter is swept: an atlas needs a list or a sweep; see `correlate`")
    try:
        models = chosen.models()
    except (TypeError, ValueError) as error:
        raise ValueError(f"[parameters]: {error}") from error
    for role, model in zip(("first", "second", "ground"), models, strict=True):
        _check_ranges(role, model)
    return chosen


def _check_names(parameters: Mapping[str, Any], ground: str) -> None:
    of_ground = [name for name in GROUNDS[ground].beside_structures() if name not in UNITS]
    numbered = [f"{name}_{n}" for name in OF_STRUCTURES for n in (1, 2)]
    _only(parameters, ("period_1", "period_2", *OF_STRUCTURES, *numbered, *of_ground), "[parameters]")
    for name in OF_STRUCTURES:
        own = [f"{name}_{n}" for n in (1, 2) if f"{name}_{n}" in parameters]
        if own and name in parameters:
            raise ValueError(
                f"{name} and {' and '.join(own)} are given; allowed: {name} for both structures, or "
                f"{name}_1 and {name}_2"
            )
    missing = [name for name in ("period_1", "period_2", *of_ground) if name not in parameters]
    if "damping" not in parameters:
        missing += [f"damping_{n}" for n in (1, 2) if f"damping_{n}" not in parameters]
    if missing:
        raise ValueError(f"[parameters]: {', '.join(missing)} missing")


def _only(data: Mapping[str, Any], allowed: tuple[str, ...], where: str) -> None:
    unknown = [key for key in data if key not in allowed]
    if unknown:
        raise ValueError(f"{listed(unknown)} unknown in {where}; allowed: {', '.join(allowed)}")


def _one_of(value: Any, allowed: tuple[str, ...], name: str) -> str:
    if value not in allowed:
        raise ValueError(f"{name} = {brief(value)} is not known; allowed: {', '.join(allowed)}")
    return str(value)


def _parameter(name: str, value: Any) -> float | tuple[float, ...]:
    """A fixed number, or the increasing values of an axis."""
    if _is_number(value):
        return float(value)
    if isinstance(value, Mapping):
        value = _sweep(name, value)
    if not isinstance(value, list) or not all(_is_number(item) for item in value):
        raise ValueError(
            f"{name} = {brief(value)}; allowed: a number, a list of numbers, or a sweep "
            '{ start = 0.1, stop = 10, count = 50, spacing = "log" }'
        )
    if not value:
        raise ValueError(f"{name} is an empty axis; allowed: at least one value")
    values = tuple(float(item) for item in value)
    if any(b <= a for a, b in itertools.pairwise(values)):
        raise ValueError(f"{name}: its values must increase, or they cannot be looked up")
    return values


def _sweep(name: str, value: Mapping[str, Any]) -> list[float]:
    _only(value, SWEEP, name)
    missing = [key for key in SWEEP[:3] if key not in value]
    if missing:
        raise ValueError(f"{name}: {', '.join(missing)} missing; a sweep has {', '.join(SWEEP)}")
    count, spacing = value["count"], value.get("spacing", "linear")
    if not is_whole(count) or not 1 <= count <= LONGEST_AXIS:
        empty = " is an empty axis" if count == 0 else ""
        raise ValueError(f"{name}: count = {brief(count)}{empty}; allowed: 1 to {LONGEST_AXIS}")
    _one_of(spacing, ("linear", "log"), f"{name}: spacing")
    start, stop = value["start"], value["stop"]
    if not (_is_number(start) and _is_number(stop) and 0 < start <= stop):
        raise ValueError(
            f"{name}: start = {brief(start)}, stop = {brief(stop)}; allowed: 0 < start <= stop"
        )
    spread = np.geomspace if spacing == "log" else np.linspace
    return [float(x) for x in spread(start, stop, count)]


def _is_number(value: Any) -> bool:
    return is_number(value) and math.isfinite(value)


def _check_ranges(role: str, model: Model) -> None:
    """Raise a ValueError if an axis has values out of range."""
    for name, values in model.arrays().items():
        allowed = STATIONARY_HARDENING if name == "hardening" else model.allowed(name)
        if not bool(allowed.contains(values).all()):
            low, high = float(values.min()), float(values.max())
            raise ValueError(f"{role}: {name} from {low:g} to {high:g}; allowed: {allowed}")
