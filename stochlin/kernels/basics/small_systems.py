"""Many 3 x 3 linear systems at once, by Cramer's rule.

``numpy.linalg.solve`` raises an error for all cells if one is singular; here only this cell becomes NaN
or infinite. Cramer's rule does not depend on the scaling of rows, which differ here by orders of
magnitude.
"""

from __future__ import annotations

from collections.abc import Sequence

from stochlin.kernels.basics.arrays import Array


def solve_3x3(matrix: Sequence[Sequence[Array]], right: Sequence[Array]) -> tuple[Array, ...]:
    """The three components of ``x`` in ``matrix @ x = right``, cell by cell; all entries broadcast."""
    (a, b, c), (d, e, f), (g, h, i) = matrix
    x, y, z = right
    cofactor_1, cofactor_2, cofactor_3 = e * i - f * h, c * h - b * i, b * f - c * e
    determinant = a * cofactor_1 + d * cofactor_2 + g * cofactor_3
    return (
        (cofactor_1 * x + cofactor_2 * y + cofactor_3 * z) / determinant,
        ((f * g - d * i) * x + (a * i - c * g) * y + (c * d - a * f) * z) / determinant,
        ((d * h - e * g) * x + (b * g - a * h) * y + (a * e - b * d) * z) / determinant,
    )
