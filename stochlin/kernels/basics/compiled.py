"""The decorators that compile kernels with numba, one for each way in which a function is called.

================  ==================================================================================
`entry`           for functions called from Python; the compiled code is kept on the disk
`not_kept`        for functions called from Python and made from a user's formula; not kept
`compiled`        for functions called from compiled code; from Python they are plain Python
`called_often`    as `compiled`, for functions so short that a call takes longer than their work: inlined
================  ==================================================================================
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numba as nb
import numpy as np
from numba.extending import overload, register_jitable

from stochlin.kernels.basics.kept import Kept, warn_once

UNCOMPILED = bool(nb.config.DISABLE_JIT)  # type: ignore[attr-defined]
NOT_COMPILED = (
    "the environment variable NUMBA_DISABLE_JIT is set: nothing is compiled, and simulations take a "
    "thousand times as long, hours for what takes seconds; unset it, unless that is wanted"
)
OPTIONS: dict[str, Any] = {"nogil": True, "error_model": "numpy"}
# Functions that only compiled code calls need no code to be called from elsewhere, a third of the time.
INNER: Any = {"error_model": "numpy", "no_cpython_wrapper": True, "no_cfunc_wrapper": True}
OFTEN: Any = INNER | {"forceinline": True}

not_kept = nb.njit(**OPTIONS)
compiled: Callable[[Any], Any] = register_jitable(**INNER)
called_often: Callable[[Any], Any] = register_jitable(**OFTEN)


def entry(function: Any, **more: Any) -> Any:
    """Compile a function that Python calls, and keep it on the disk; ``more`` are numba's options."""
    if not UNCOMPILED:
        return Kept(function, OPTIONS | more)
    warn_once(NOT_COMPILED)
    return np.errstate(all="ignore")(function)  # no warnings of overflow, as in compiled code


def of_lane(value: Any, lane: int) -> Any:
    """Element ``lane`` of an array over lanes, or the number itself if all lanes share one."""
    return value[lane] if np.ndim(value) else value


@overload(of_lane, jit_options=OFTEN)
def _of_lane(value, lane):  # type: ignore[no-untyped-def]
    if isinstance(value, nb.types.Array):
        return lambda value, lane: value[lane]
    return lambda value, lane: value
