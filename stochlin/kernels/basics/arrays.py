"""The array type of the kernels."""

from typing import Any

import numpy.typing as npt

# Real as a rule; complex where a derivative is taken by a complex step.
Array = npt.NDArray[Any]
