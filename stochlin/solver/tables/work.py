"""Limits for the memory and the time of a calculation, checked before it starts."""

from __future__ import annotations

import math
import os
from collections.abc import Hashable

from stochlin.models.parameters import Model

SHARE = 0.5  # share of the memory of the machine that one calculation may take
BYTES = 8  # of a number
MEMORY = 8e9  # assumed memory [bytes] if the system does not state it
MOST_SECONDS = 900.0  # longest estimated time [s]


def check_work(
    what: str, cure: str, *, numbers: float = 0.0, seconds: float = 0.0, cores: int = 1
) -> None:
    """Raise a ValueError if a calculation needs too much memory or time.

    The message starts with ``what``, a subject with its verb such as "the table would take", and ends
    with ``cure``, advice for a smaller calculation. ``numbers`` is how many are in memory at once, and
    ``seconds`` what one core would take, within a factor of three; the work is spread over ``cores``.
    """
    gigabytes, most = BYTES * numbers / 1e9, SHARE * _installed() / 1e9
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
    """`check_work` for a table over the dimensions of the models, with so many numbers for a cell."""
    cells = count_cells(*models)
    if cells > 1:
        cure = "take fewer cells at a time, or arrays in chunks of dask"
        check_work("the table would take", cure, numbers=numbers * cells)


def _installed() -> float:
    """Memory of this machine [bytes]."""
    try:
        return float(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES"))
    except (AttributeError, ValueError, OSError):
        return MEMORY
