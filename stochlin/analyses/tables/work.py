"""Limits for the memory and the time of a calculation, checked before it starts."""

from __future__ import annotations

import math
import os
from collections.abc import Hashable, Mapping

import xarray as xr

from stochlin.models.parameters import Model

SHARE = 0.5  # share of the memory of the machine that one calculation may take
MEMORY = 8e9  # assumed memory [bytes] if the system does not state it
MOST_SECONDS = 900.0  # longest estimated time [s]
SLOWER = 1000.0  # how much longer it takes what is not compiled


# What one unit of each kind of work takes, approximately: seconds of one core, or memory. The seconds
# are rounded, from 0.4 to some three times those that `benchmarks/work.py` measured on a server with two
# cores.
COSTS = {
    # Simulation of many structures: a time step of one motion.
    "steps of a ground": (8e-9, "s"),
    "steps of a bilinear structure": (1.2e-9, "s"),
    "steps of another law": (6e-8, "s"),
    "steps of a dashpot": (2.4e-7, "s"),  # whose force is a power of the velocity
    "steps of a pair of storeys": (2e-9, "s"),  # of one building, each with itself included
    "steps of a recorded distance": (1e-9, "s"),  # of two structures
    "steps of a distance to gaps": (6e-8, "s"),  # of two structures, each step compared with gaps
    # Responses to records.
    "sub-steps on a record": (3e-8, "s"),  # of one bilinear structure
    "steps of a floor on a record": (6e-7, "s"),  # of a building or a structure of another law
    # Pounding: a time step of a row of buildings.
    "steps of a row": (3e-6, "s"),  # of motions that are stepped together
    "operations in a row": (1e-9, "s"),  # of one motion
    # Linearization.
    "systems": (1e-3, "s"),  # ten iterations, without the next
    "cubes of states": (4e-9, "s"),  # the same, of the number of states, for each element
    "squares of states": (150, "bytes"),
    "instants of a motion": (1e-4, "s"),
    "cubes of states in motion": (8e-11, "s"),  # one evaluation of the rates of a structure or a pair
    # Tables, by their cells.
    "structures": (700, "bytes"),
    "structures with drift": (10_000, "bytes"),
    "pairs by linearization": (40, "bytes"),
    "pairs with drift": (100, "bytes"),
    "pairs by white_noise": (30, "bytes"),
    "pairs by effective": (40, "bytes"),
    "pairs by simulation": (80, "bytes"),
    "numbers": (8, "bytes"),
    "numbers of a sweep": (100, "bytes"),  # while it is made
}


def check_work(what: str, cure: str, work: Mapping[str, float], cores: int = 1) -> None:
    """Raise a ValueError if a calculation needs too much memory or time.

    The message starts with ``what``, a subject with its verb such as "the table would take", and ends
    with ``cure``, advice for a smaller calculation. ``work`` has the number of units of each kind in
    `COSTS`, and is done on this many ``cores``.
    """
    need = cost_of(work, cores)
    most = SHARE * _installed()
    if not need["bytes"] <= most:
        raise ValueError(f"{what} {need['bytes'] / 1e9:.1f} GB; allowed: {most / 1e9:.0f} GB; {cure}")
    if not need["s"]:
        return
    from stochlin.kernels.basics.compiled import UNCOMPILED  # which imports the compiler

    seconds = need["s"] * (SLOWER if UNCOMPILED else 1.0)
    cure += ", or unset NUMBA_DISABLE_JIT" if UNCOMPILED else ""
    if not seconds <= MOST_SECONDS:
        allowed = f"{MOST_SECONDS / 60:.0f} minutes on this machine"
        raise ValueError(f"{what} about {_in_words(seconds)}; allowed: {allowed}; {cure}")


def cost_of(work: Mapping[str, float], cores: int = 1) -> dict[str, float]:
    """Seconds on this many cores, and bytes, that all of the work takes."""
    need = {"s": 0.0, "bytes": 0.0}
    for kind, count in work.items():
        cost, unit = COSTS[kind]
        need[unit] += cost * count / (cores if unit == "s" else 1)
    return need


def count_cells(*models: Model) -> int:
    """Number of cells over all dimensions of the models."""
    sizes: dict[Hashable, int] = {}
    for model in models:
        for value in model.cells().values():
            if isinstance(value, xr.DataArray):
                sizes.update(value.sizes)
    return math.prod(sizes.values())


def check_table(kind: str, *models: Model) -> None:
    """`check_work` for a table over the dimensions of the models, with cells of this kind."""
    cells = count_cells(*models)
    if cells > 1:
        cure = "take fewer cells at a time, or arrays in chunks of dask"
        check_work("the table would take", cure, {kind: cells})


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
