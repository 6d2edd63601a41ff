"""Functions of arrays, which `correlation.bilinear_pair` also compiles for numbers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from stochlin.kernels.basics.arrays import Array


def choose(condition: Any, yes: Any, no: Any) -> Any:
    """``yes`` where the condition holds, otherwise ``no``; arrays, or named tuples of arrays.

    In compiled code it is one of two numbers, or of two tuples of numbers.
    """
    if isinstance(yes, tuple):
        return type(yes)(*(choose(condition, *parts) for parts in zip(yes, no, strict=True)))
    return np.where(condition, yes, no)


def solve_3x3(matrix: Sequence[Sequence[Array]], right: Sequence[Array]) -> tuple[Array, ...]:
    """The three components of ``x`` in ``matrix @ x = right``, cell by cell; all entries broadcast.

    A singular cell becomes NaN or infinite. Cramer's rule does not depend on the scaling of rows, which
    differ here by orders of magnitude.
    """
    (a, b, c), (d, e, f), (g, h, i) = matrix
    x, y, z = right
    cofactor_1, cofactor_2, cofactor_3 = e * i - f * h, c * h - b * i, b * f - c * e
    determinant = a * cofactor_1 + d * cofactor_2 + g * cofactor_3
    return (
        (cofactor_1 * x + cofactor_2 * y + cofactor_3 * z) / determinant,
        ((f * g - d * i) * x + (a * i - c * g) * y + (c * d - a * f) * z) / determinant,
        ((d * h - e * g) * x + (b * g - a * h) * y + (a * e - b * d) * z) / determinant,
    )
