"""Checks of several arguments together, of packages and work, and the stop rule."""

from __future__ import annotations

import importlib
import math
import os
from collections.abc import Hashable, Mapping
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np

from stochlin.models.arguments import DURATION_IN_SECONDS, Number, Whole, check_fields
from stochlin.models.parameters import Model, Range
from stochlin.models.structures import AnyStructure


def check_scalars(model: Model, role: str, allowed: str) -> None:
    """Raise a ValueError if a parameter of the model is an array."""
    if arrays := [name for name, value in model.over_cells().items() if value.ndim]:
        raise ValueError(f"{role}: {', '.join(arrays)} is an array; allowed: {allowed}")


def check_duration(duration: Any, structures: Mapping[str, AnyStructure] | None = None) -> float:
    """The duration of a motion [s]; raises a ValueError if it is not positive or too short.

    It must be at least the period of each of the ``structures``, which are by their roles. Arrays
    of periods are not checked.
    """
    DURATION_IN_SECONDS("duration", duration)
    for role, structure in (structures or {}).items():
        period = structure.first_period()
        if period.ndim == 0 and float(period) > duration:
            what = (
                f"duration = {duration:g} s is shorter than the period of {role}, "
                f"{float(period):g} s"
            )
            raise ValueError(f"{what}; allowed: one period or more")
    return float(duration)


def standing(first: object, second: object) -> dict[str, Any]:
    """Structures by their roles; if ``second`` is None, one structure beside its property line."""
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


SHARE_OF_MEMORY = 0.5  # share of the memory of the machine that one calculation may take
BYTES = 8  # of a number
ASSUMED_MEMORY = 8e9  # assumed memory [bytes] if the system does not state it
MOST_SECONDS = 900.0  # longest estimated time [s]


def check_work(
    what: str, cure: str, *, numbers: float = 0.0, seconds: float = 0.0, cores: int = 1
) -> None:
    """Raise a ValueError if a calculation needs too much memory or time.

    The message starts with ``what``, a subject with its verb such as "the table would take", and
    ends with ``cure``, advice for a smaller calculation. ``numbers`` is how many are in memory at
    once, and ``seconds`` what one core would take, within a factor of three; the work is spread
    over ``cores``.
    """
    gigabytes = BYTES * numbers / 1e9
    most = SHARE_OF_MEMORY * _installed() / 1e9
    if not gigabytes <= most:
        raise ValueError(f"{what} {gigabytes:.1f} GB; allowed: {most:.0f} GB; {cure}")
    if not seconds:
        return
    from stochlin.kernels.basics.compiled import UNCOMPILED  # which imports the compiler

    seconds *= (1000.0 if UNCOMPILED else 1.0) / cores
    cure += ", or unset NUMBA_DISABLE_JIT" if UNCOMPILED else ""
    if not seconds <= MOST_SECONDS:
        allowed = f"{MOST_SECONDS / 60:.0f} minutes on this machine"
        raise ValueError(f"{what} about {seconds / 3600:.2g} hours; allowed: {allowed}; {cure}")


def count_cells(*models: Model) -> int:
    """Number of cells over all dimensions of the models."""
    sizes: dict[Hashable, int] = {}
    for model in models:
        for value in model.cells().values():
            sizes.update(getattr(value, "sizes", {}))
    return math.prod(sizes.values())


def check_table(numbers: float, *models: Model) -> None:
    """`check_work` for a table over the dimensions of the models, with so many numbers a cell."""
    cells = count_cells(*models)
    if cells > 1:
        cure = "take fewer cells at a time, or arrays in chunks of dask"
        check_work("the table would take", cure, numbers=numbers * cells)


def _installed() -> float:
    """Memory of this machine [bytes]."""
    try:
        return float(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES"))
    except (AttributeError, ValueError, OSError):
        return ASSUMED_MEMORY


EPSILON = float(np.finfo(float).eps)
RANGE_OF_RTOL = Range(EPSILON, include_lower=True)


@dataclass(frozen=True)
class Tolerance:
    """Stop rule of an iteration, checked; `linearize` describes its parameters."""

    rtol: Annotated[float, Number(RANGE_OF_RTOL, f"a finite number of at least {EPSILON:.2g}")]
    max_iterations: Annotated[int, Whole(1)]

    def __post_init__(self) -> None:
        check_fields(self)


USUAL_TOLERANCE = Tolerance(1e-10, 200)  # the defaults of `linearize`
