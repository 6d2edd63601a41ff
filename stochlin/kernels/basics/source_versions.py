"""A version of compiled code that tells numba's cache of changes in the files that it calls."""

from __future__ import annotations

import hashlib
from pathlib import Path
from types import ModuleType

import numpy as np

from stochlin.kernels.basics.arrays import Array


def version_of(*modules: ModuleType) -> Array:
    """An empty array whose type is named after the sources, to be one more argument of an entry.

    numba takes a compiled function from its cache as long as that function's own file is unchanged,
    whatever became of those that it calls. The types of the arguments are part of the key.
    """
    sources = b"".join(Path(str(module.__file__)).read_bytes() for module in modules)
    return np.empty(0, [(hashlib.sha256(sources).hexdigest()[:16], "i1")])
