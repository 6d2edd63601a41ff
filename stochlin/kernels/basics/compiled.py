"""How code is compiled: the decorators of all kernels, and what they need.

================  ==================================================================================
`entry`           called from Python; `kept` on the disk
`elementwise`     called from Python, over arrays that broadcast; kept likewise
`not_kept`        called from Python, made from what a user gives
`compiled`        called from compiled code, as one of its `parts`
`called_often`    so short that handing over its arguments takes longer than the work: LLVM inlines it
================  ==================================================================================
"""

from __future__ import annotations

from typing import Any

import numba as nb
import numpy as np
from numba.extending import overload

from stochlin.kernels.basics.kept import kept
from stochlin.kernels.basics.parts import Parts

OPTIONS: dict[str, Any] = {"nogil": True, "error_model": "numpy"}
OF_OVERLOADS: Any = {"forceinline": True, "error_model": "numpy"}


def entry(function: Any, **more: Any) -> Any:
    """The decorator of what is called from Python."""
    made = nb.njit(**OPTIONS, **more)(function)
    if made is not function:  # as it is under NUMBA_DISABLE_JIT
        made._cache = kept(function)
    return made


def elementwise(function: Any) -> Any:
    """The same, for arrays that broadcast."""
    made = nb.vectorize(function)  # type: ignore[no-untyped-call]
    made._dispatcher.cache = kept(function)
    return made


not_kept = nb.njit(**OPTIONS)
compiled = nb.njit(pipeline_class=Parts, **OPTIONS)
called_often = nb.njit(pipeline_class=Parts, forceinline=True, **OPTIONS)


def of_lane(value: Any, lane: int) -> Any:
    """A number that all lanes share, or, of an array, that of this lane."""
    return value[lane] if np.ndim(value) else value


@overload(of_lane, jit_options=OF_OVERLOADS)
def _of_lane(value, lane):  # type: ignore[no-untyped-def]
    if isinstance(value, nb.types.Array):
        return lambda value, lane: value[lane]
    return lambda value, lane: value


def smallest(value: Any) -> Any:
    """That number, or the smallest of all lanes."""
    return np.min(value)


@overload(smallest, jit_options=OF_OVERLOADS)
def _smallest(value):  # type: ignore[no-untyped-def]
    if isinstance(value, nb.types.Array):
        return lambda value: value.min()
    return lambda value: value
