"""Limits for the memory and the time of a calculation, checked before it starts."""

from __future__ import annotations

import math
import os
from collections.abc import Hashable

import xarray as xr

from stochlin.kernels.basics.compiled import UNCOMPILED
from stochlin.models.parameters import Model

SHARE = 0.5  # share of the memory of the machine that one calculation may take
MEMORY = 8e9  # assumed memory [bytes] if the system does not state it
MOST_SECONDS = 900.0  # longest estimated time [s]
SLOWER = 1000.0 if UNCOMPILED else 1.0  # estimates are those of compiled code


def check_work(what: str, cure: str, *, memory: float = 0.0, seconds: float = 0.0) -> None:
    """Raise a ValueError if a calculation needs too much memory [bytes] or time [s].

    The message starts with ``what``, a subject with its verb such as "the table would take", and ends
    with ``cure``, advice for a smaller calculation.
    """
    most = SHARE * _installed()
    if not memory <= most:
        raise ValueError(f"{what} {memory / 1e9:.1f} GB; allowed: {most / 1e9:.0f} GB; {cure}")
    seconds *= SLOWER
    if UNCOMPILED:
        cure += ", or unset NUMBA_DISABLE_JIT"
    if not seconds <= MOST_SECONDS:
        allowed = f"{MOST_SECONDS / 60:.0f} minutes on this machine"
        raise ValueError(f"{what} about {_in_words(seconds)}; allowed: {allowed}; {cure}")


def count_cells(*models: Model) -> int:
    """Number of cells over all dimensions of the models; 0 with dask arrays, which need no check."""
    sizes: dict[Hashable, int] = {}
    for model in models:
        for value in model.cells().values():
            if isinstance(value, xr.DataArray):
                if value.chunks is not None:
                    return 0
                sizes.update(value.sizes)
    return math.prod(sizes.values())


def check_table(memory: float, *models: Model) -> None:
    """`check_work` for a table over the dimensions of the models, with ``memory`` [bytes] for a cell."""
    cells = count_cells(*models)
    if cells > 1:
        cure = "take fewer cells at a time, or arrays in chunks of dask"
        check_work("the table would take", cure, memory=memory * cells)


def _installed() -> float:
    """Memory of this machine [bytes]."""
    try:
        return float(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES"))
    except (AttributeError, ValueError, OSError):
        return MEMORY


def _in_words(seconds: float) -> str:
    """A time in words, with two digits."""
    for unit, size in (("minutes", 60.0), ("hours", 3600.0), ("days", 86400.0)):
        if seconds < 100 * size:
            return f"{seconds / size:.2g} {unit}"
    return f"{seconds / (365.25 * 86400):.2g} years"
