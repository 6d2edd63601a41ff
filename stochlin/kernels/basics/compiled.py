"""The decorators that compile kernels with numba, one for each way in which a function is called.

================  ==================================================================================
`entry`           for functions called from Python; the compiled code is cached on disk (`kept`)
`elementwise`     for scalar functions called from Python with arrays that broadcast; also cached
`not_kept`        for functions called from Python and made from a user's formula; not cached
`compiled`        for functions called from compiled code (`parts`); from Python they are plain Python
`called_often`    as `compiled`, for functions so short that a call takes longer than their work: inlined
`shared`          for functions called from Python with arrays and from compiled code with numbers
================  ==================================================================================
"""

from __future__ import annotations

from functools import partial
from typing import Any

import numba as nb
import numpy as np
from numba.extending import overload, register_jitable

from stochlin.kernels.basics.kept import NOT_COMPILED, kept, warn_once
from stochlin.kernels.basics.parts import Part, Parts

UNCOMPILED = bool(nb.config.DISABLE_JIT)  # type: ignore[attr-defined]
OPTIONS: dict[str, Any] = {"nogil": True, "error_model": "numpy"}
FEW = 256  # cells that take less time in plain Python than to load compiled code, or to compile it
_met: dict[Any, int] = {}
OF_OVERLOADS: Any = {"forceinline": True, "error_model": "numpy"}


def entry(function: Any, **more: Any) -> Any:
    """Compile a function that Python calls, and cache it on disk; ``more`` are numba's options."""
    if UNCOMPILED:
        return _uncompiled(function)
    made = nb.njit(**OPTIONS, **more)(function)
    made._cache = kept(function)
    return made


def elementwise(function: Any) -> Any:
    """Compile a function of numbers into one of arrays that broadcast, and cache it on disk."""
    if UNCOMPILED:
        return np.vectorize(_uncompiled(function), otypes=[float])
    made = nb.vectorize(function)  # type: ignore[no-untyped-call]
    made._dispatcher.cache = kept(function)
    return made


def _uncompiled(function: Any) -> Any:
    """The Python function, without numpy's warnings of overflow, as in compiled code."""
    warn_once(NOT_COMPILED)
    return np.errstate(all="ignore")(function)


def worth_compiling(function: Any, cells: int, few: int = FEW) -> bool:
    """Whether to use an `entry` for so many more cells, rather than plain Python with the same result.

    Plain Python is taken for the first ``few`` cells of a process, unless the entry is already at hand.
    """
    _met[function] = _met.get(function, 0) + cells
    return not UNCOMPILED and (bool(function.signatures) or _met[function] > few)


not_kept = nb.njit(**OPTIONS)


def compiled(function: Any, **more: Any) -> Any:
    """Compile a function that only compiled code calls; ``more`` are numba's options."""
    if UNCOMPILED:
        return function
    return Part(function, targetoptions={"nopython": True, **OPTIONS, **more}, pipeline_class=Parts)


called_often = partial(compiled, forceinline=True)
shared: Any = register_jitable(**OF_OVERLOADS)


def of_lane(value: Any, lane: int) -> Any:
    """Element ``lane`` of an array over lanes, or the number itself if all lanes share one."""
    return value[lane] if np.ndim(value) else value


@overload(of_lane, jit_options=OF_OVERLOADS)
def _of_lane(value, lane):  # type: ignore[no-untyped-def]
    if isinstance(value, nb.types.Array):
        return lambda value, lane: value[lane]
    return lambda value, lane: value


def smallest(value: Any) -> Any:
    """Smallest element of an array over lanes, or the number itself if all lanes share one."""
    return np.min(value)


@overload(smallest, jit_options=OF_OVERLOADS)
def _smallest(value):  # type: ignore[no-untyped-def]
    if isinstance(value, nb.types.Array):
        return lambda value: value.min()
    return lambda value: value
