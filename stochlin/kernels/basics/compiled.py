"""How code is compiled: the decorators of all kernels, and what they need.

================  ==================================================================================
`entry`           called from Python; `kept` on the disk
`elementwise`     called from Python, over arrays that broadcast; kept likewise
`compiled`        called from compiled code
`called_often`    so short that handing over its arguments takes longer than the work: LLVM inlines it
`inlined`         called in one place only: numba inlines it, and LLVM need not go over it at each level
`shared`          stays plain Python, of arrays, and is called from compiled code, of numbers
================  ==================================================================================

`borrow` takes away the counting. numba counts a reference whenever an array is taken out of a tuple,
which in a function of a microsecond is most of the time.

Each of the three strange ones is worth it: `pound` takes 3.7 times as long without `borrow`, 1.5 times
without `called_often`, and without `inlined` 1.7 times, and 1.4 times as long to compile.
"""

from __future__ import annotations

from typing import Any

import numba as nb
import numpy as np
from numba.extending import intrinsic, overload, register_jitable

from stochlin.kernels.basics.kept import NOT_COMPILED, kept, say_that_it_is_slow

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


compiled = nb.njit(**OPTIONS)
called_often = nb.njit(forceinline=True, **OPTIONS)
inlined = nb.njit(inline="always", **OPTIONS)
shared: Any = register_jitable(**OF_OVERLOADS)


def _borrow(context: Any, owned: Any) -> Any:
    """A named tuple with its arrays, not counted; who owns them has to keep them while they are used."""

    def generate(target: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        parts = []
        for n, kind in enumerate(owned.types):
            part = builder.extract_value(arguments[0], n)
            if isinstance(kind, nb.types.Array):
                view = target.make_array(kind)(target, builder, part)
                view.meminfo = view.meminfo.type(None)
                view.parent = view.parent.type(None)
                part = view._getvalue()
            parts.append(part)
        return target.make_tuple(builder, owned, parts)

    return owned(owned), generate


borrow: Any = (lambda owned: owned) if UNCOMPILED else intrinsic(_borrow)


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
