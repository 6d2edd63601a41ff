"""The array type of the kernels, and broadcasting to one shape."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

# Usually real; complex where a derivative is taken by the complex-step method.
Array = npt.NDArray[Any]


def in_one_shape(*arrays: Array) -> Sequence[Array]:
    """The arrays, broadcast to one shape; returned as they are if they have one, which is faster."""
    alike = all(array.shape == arrays[0].shape for array in arrays)
    return arrays if alike else np.broadcast_arrays(*arrays)
