"""The array type of the kernels."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

# Real as a rule; complex where a derivative is taken by a complex step.
Array = npt.NDArray[Any]


def in_one_shape(*arrays: Array) -> Sequence[Array]:
    """`numpy.broadcast_arrays`, which takes its time even where all have one shape, as lone cells do."""
    alike = all(array.shape == arrays[0].shape for array in arrays)
    return arrays if alike else np.broadcast_arrays(*arrays)
