"""How code is compiled: the decorators of all kernels, and what they need.

================  ==================================================================================
`entry`           called from Python; `kept` on the disk
`elementwise`     called from Python, over arrays that broadcast; kept likewise
`not_kept`        called from Python, made from what a user gives
`compiled`        called from compiled code, as one of its `parts`; from Python it is plain Python
`called_often`    so short that handing over its arguments takes longer than the work: LLVM inlines it
`shared`          stays plain Python, of arrays, and is called from compiled code, of numbers
================  ==================================================================================
"""

from __future__ import annotations

from functools import partial
from typing import Any

import numba as nb
import numpy as np
from numba.extending import overload, register_jitable

from stochlin.kernels.basics.kept import NOT_COMPILED, kept, say_that_it_is_slow
from stochlin.kernels.basics.parts import Part, Parts

UNCOMPILED = bool(nb.config.DISABLE_JIT)  # type: ignore[attr-defined]
OPTIONS: dict[str, Any] = {"nogil": True, "error_model": "numpy"}
OF_OVERLOADS: Any = {"forceinline": True, "error_model": "numpy"}


def entry(function: Any, **more: Any) -> Any:
    """The decorator of what is called from Python."""
    if UNCOMPILED:
        return _uncompiled(function)
    made = nb.njit(**OPTIONS, **more)(function)
    made._cache = kept(function)
    return made


def elementwise(function: Any) -> Any:
    """The same, for arrays that broadcast."""
    if UNCOMPILED:
        return np.vectorize(_uncompiled(function), otypes=[float])
    made = nb.vectorize(function)  # type: ignore[no-untyped-call]
    made._dispatcher.cache = kept(function)
    return made


def _uncompiled(function: Any) -> Any:
    """The function itself, which as compiled code does says nothing of what overflows."""
    say_that_it_is_slow(NOT_COMPILED)
    return np.errstate(all="ignore")(function)


not_kept = nb.njit(**OPTIONS)


def compiled(function: Any, **more: Any) -> Any:
    """The decorator of a part."""
    if UNCOMPILED:
        return function
    return Part(function, targetoptions={"nopython": True, **OPTIONS, **more}, pipeline_class=Parts)


called_often = partial(compiled, forceinline=True)
shared: Any = register_jitable(**OF_OVERLOADS)


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
