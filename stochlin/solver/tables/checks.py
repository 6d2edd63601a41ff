"""Checks of several arguments together, of paths, and of optional packages."""

from __future__ import annotations

import importlib
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from stochlin.messages import brief
from stochlin.models.arguments import DURATION
from stochlin.models.parameters import Model
from stochlin.models.systems import AnyStructure, first_period

LONGEST_PATH = 4096


def as_path(name: str, value: object) -> Path:
    """The path; raises a TypeError or ValueError if ``value`` cannot be one."""
    if not isinstance(value, (str, os.PathLike)):
        raise TypeError(f"{name} = {brief(value)}; allowed: the name of a file, as text or a path")
    if len(os.fspath(value)) > LONGEST_PATH:
        raise ValueError(f"{name} = {brief(value)} is too long; allowed: {LONGEST_PATH} characters")
    return Path(value)


def check_scalars(model: Model, role: str, allowed: str) -> None:
    """Raise a ValueError if a parameter of the model is an array."""
    if arrays := [name for name, value in model.over_cells().items() if value.ndim]:
        raise ValueError(f"{role}: {', '.join(arrays)} is an array; allowed: {allowed}")


def check_duration(duration: Any, structures: Mapping[str, AnyStructure] | None = None) -> float:
    """The duration of a motion [s]; raises a ValueError if it is not positive or too short.

    It must be at least the period of each of the ``structures``, which are by their roles. Arrays of
    periods are not checked.
    """
    DURATION("duration", duration)
    for role, structure in (structures or {}).items():
        period = first_period(structure)
        if period.ndim == 0 and float(period) > duration:
            raise ValueError(
                f"duration = {duration:g} s is shorter than the period of {role}, {float(period):g} s; "
                "allowed: one period or more"
            )
    return float(duration)


def standing(first: object, second: object) -> dict[str, Any]:
    """The structures by their roles; if ``second`` is None, one structure beside its property line."""
    return {"first": first} | ({} if second is None else {"second": second})


def needed(module: str, what: str, extra: str, otherwise: str = "") -> Any:
    """An optional package; an ImportError with the command that installs it if it is missing.

    ``otherwise`` is what can be done without it.
    """
    try:
        return importlib.import_module(module)
    except ImportError as error:
        cure = "; or ".join(filter(None, (f"pip install 'stochlin[{extra}]'", otherwise)))
        raise ImportError(f"{what} needs {module}: {cure}") from error
