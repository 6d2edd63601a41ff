"""The array type of the kernels, and functions of arrays and small matrices."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

# Usually real; complex where a derivative is taken by the complex-step method.
Array = npt.NDArray[Any]
CACHE_LINE = 64  # [bytes]
SQRT_2PI = math.sqrt(2 * math.pi)


def on_arrays(function: Callable[[Array], Array], parts: Any) -> Any:
    """The function of an array, or of all arrays in named tuples; None stays None."""
    if isinstance(parts, tuple):
        return type(parts)(*(on_arrays(function, part) for part in parts))
    return None if parts is None else function(parts)


def zeros_on_a_line(*shape: int) -> Array:
    """Zeros of this shape that begin at a cache line, as numpy's own need not.

    Numbers for one vector register are then never on two lines, which saves a tenth to a third of
    the time of a kernel that does little with each number.
    """
    size = 8 * math.prod(shape)
    memory = np.zeros(size + CACHE_LINE, np.uint8)
    begin = -memory.ctypes.data % CACHE_LINE
    return memory[begin : begin + size].view(float).reshape(shape)


def choose(condition: Any, yes: Any, no: Any) -> Any:
    """``yes`` where the condition holds, otherwise ``no``; arrays, or named tuples of arrays."""
    if isinstance(yes, tuple):
        return type(yes)(*(choose(condition, *parts) for parts in zip(yes, no, strict=True)))
    return np.where(condition, yes, no)


def where_finite(values: Any, *others: Any) -> Any:
    """The values, and NaN where one of the others is not finite; all broadcast."""
    for other in others:
        values = np.where(np.isfinite(other), values, np.nan)
    return values


def matrix_products(values: Array, matrix: Array) -> Array:
    """Products (times, m) of a matrix (m, n) with each row of the values (times, n).

    BLAS is not used: its last bits depend on the number of rows, and its threads would take the
    time of those in which motions are stepped.
    """
    products: Array = np.einsum("tn,mn->tm", values, matrix)
    return products


def solve_3x3(matrix: Sequence[Sequence[Array]], right: Sequence[Array]) -> tuple[Array, ...]:
    """The three components of ``x`` in ``matrix @ x = right``, cell by cell; all entries broadcast.

    A singular cell becomes NaN or infinite. Cramer's rule does not depend on the scaling of rows,
    which differ here by orders of magnitude.
    """
    (a, b, c), (d, e, f), (g, h, i) = matrix
    x, y, z = right
    cofactor_1 = e * i - f * h
    cofactor_2 = c * h - b * i
    cofactor_3 = b * f - c * e
    determinant = a * cofactor_1 + d * cofactor_2 + g * cofactor_3
    return (
        (cofactor_1 * x + cofactor_2 * y + cofactor_3 * z) / determinant,
        ((f * g - d * i) * x + (a * i - c * g) * y + (c * d - a * f) * z) / determinant,
        ((d * h - e * g) * x + (b * g - a * h) * y + (a * e - b * d) * z) / determinant,
    )
