"""Many 3 x 3 linear systems at once, by Cramer's rule.

``numpy.linalg.solve`` raises for all cells when one is singular; here only that cell
turns to NaN or infinity. Cramer's rule is unaffected by the scaling of rows, which is
what the graded systems of this package need.
"""

from __future__ import annotations

from collections.abc import Sequence

from stochlin.kernels.basics.arrays import Array


def solve_3x3(matrix: Sequence[Sequence[Array]], right: Sequence[Array]) -> tuple[Array, ...]:
    """Solve ``matrix @ x = right`` cell by cell; entries broadcast."""
    (a, b, c), (d, e, f), (g, h, i) = matrix
    adjugate = (
        (e * i - f * h, c * h - b * i, b * f - c * e),
        (f * g - d * i, a * i - c * g, c * d - a * f),
        (d * h - e * g, b * g - a * h, a * e - b * d),
    )
    determinant = a * adjugate[0][0] + d * adjugate[0][1] + g * adjugate[0][2]
    return tuple(
        (row[0] * right[0] + row[1] * right[1] + row[2] * right[2]) / determinant for row in adjugate
    )
