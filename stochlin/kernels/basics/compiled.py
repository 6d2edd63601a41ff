"""How code is compiled: the decorators of all kernels, and what they need.

PLACE FOR FIGURES
"""

from __future__ import annotations

import hashlib
from pathlib import Path
from types import ModuleType
from typing import Any

import numba as nb
import numpy as np
from numba.extending import intrinsic

from stochlin.kernels.basics.arrays import Array

OPTIONS: dict[str, Any] = {"nogil": True, "error_model": "numpy"}

entry = nb.njit(cache=True, **OPTIONS)
entry_of_sums = nb.njit(cache=True, fastmath={"reassoc"}, **OPTIONS)
compiled = nb.njit(**OPTIONS)
called_often = nb.njit(forceinline=True, **OPTIONS)
inlined = nb.njit(inline="always", **OPTIONS)


def version_of(*modules: ModuleType) -> Array:
    """An empty array whose type is named after the sources, to be one more argument of an entry.

    numba takes a compiled function from its cache as long as that function's own file is unchanged,
    whatever became of those that it calls. The types of the arguments are part of the key. ``modules``
    have to be all whose functions the entry calls; this one always counts.
    """
    files = (__file__, *(str(module.__file__) for module in modules))
    sources = b"".join(Path(file).read_bytes() for file in files)
    return np.empty(0, [(hashlib.sha256(sources).hexdigest()[:16], "i1")])


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


borrow: Any = intrinsic(_borrow)
