"""Memory and time of a calculation: refused before the work where they are too large."""

from __future__ import annotations

import math
import os

import xarray as xr

from stochlin.models.parameters import Model

SHARE = 0.5  # of the machine's memory that one question may take
MEMORY = 8e9  # bytes of a machine that does not say how much it has
MOST_SECONDS = 900.0  # by rough estimates: a quarter of an hour


def check_work(what: str, cure: str, *, memory: float = 0.0, seconds: float = 0.0) -> None:
    """Raise a ValueError if so much memory [bytes] or time [s] is too much for this machine.

    ``what`` says what needs it, with its verb; ``cure`` what to do instead.
    """
    most = SHARE * _installed()
    if not memory <= most:
        raise ValueError(f"{what} {memory / 1e9:.1f} GB; allowed: {most / 1e9:.0f} GB; {cure}")
    if not seconds <= MOST_SECONDS:
        allowed = f"{MOST_SECONDS / 60:.0f} minutes on this machine"
        raise ValueError(f"{what} about {_in_words(seconds)}; allowed: {allowed}; {cure}")


def count_cells(*models: Model) -> int:
    """Cells of the table over all dimensions of these models; 0 where dask holds it in chunks."""
    values = [value for model in models for value in model.cells().values()]
    arrays = [value for value in values if isinstance(value, xr.DataArray)]
    sizes = {dim: size for array in arrays for dim, size in array.sizes.items()}
    return 0 if any(array.chunks is not None for array in arrays) else math.prod(sizes.values())


def _installed() -> float:
    """Memory of this machine [bytes]."""
    try:
        return float(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES"))
    except (AttributeError, ValueError, OSError):
        return MEMORY


def _in_words(seconds: float) -> str:
    """A time, to two digits."""
    for unit, size in (("minutes", 60.0), ("hours", 3600.0), ("days", 86400.0)):
        if seconds < 100 * size:
            return f"{seconds / size:.2g} {unit}"
    return f"{seconds / (365.25 * 86400):.2g} years"
