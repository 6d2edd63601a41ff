"""The array type of the kernels, arrays for vector registers, and broadcasting to one shape."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

# Usually real; complex where a derivative is taken by the complex-step method.
Array = npt.NDArray[Any]
CACHE_LINE = 64  # [bytes]


def in_one_shape(*arrays: Array) -> Sequence[Array]:
    """The arrays, broadcast to one shape; returned as they are if they have one, which is faster."""
    alike = all(array.shape == arrays[0].shape for array in arrays)
    return arrays if alike else np.broadcast_arrays(*arrays)


def zeros_on_a_line(*shape: int) -> Array:
    """Zeros of this shape that begin at a cache line, as numpy's own need not.

    Numbers for one vector register are then never on two lines, which saves a tenth to a third of the
    time of a kernel that does little with each number.
    """
    size = 8 * math.prod(shape)
    memory = np.zeros(size + CACHE_LINE, np.uint8)
    begin = -memory.ctypes.data % CACHE_LINE
    return memory[begin : begin + size].view(float).reshape(shape)
