"""The array type of the kernels, named tuples of arrays, and arrays for vector registers."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

# Usually real; complex where a derivative is taken by the complex-step method.
Array = npt.NDArray[Any]
CACHE_LINE = 64  # [bytes]


def on_arrays(function: Callable[[Array], Array], parts: Any) -> Any:
    """The function of an array, or of all arrays in named tuples; None stays None."""
    if isinstance(parts, tuple):
        return type(parts)(*(on_arrays(function, part) for part in parts))
    return None if parts is None else function(parts)


def zeros_on_a_line(*shape: int) -> Array:
    """Zeros of this shape that begin at a cache line, as numpy's own need not.

    Numbers for one vector register are then never on two lines, which saves a tenth to a third of the
    time of a kernel that does little with each number.
    """
    size = 8 * math.prod(shape)
    memory = np.zeros(size + CACHE_LINE, np.uint8)
    begin = -memory.ctypes.data % CACHE_LINE
    return memory[begin : begin + size].view(float).reshape(shape)
