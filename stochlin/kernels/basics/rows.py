"""Matrices with few numbers in each row."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array


class Rows(NamedTuple):
    """A matrix (m, n) by the numbers in each row that are not zero; zeros fill the shorter rows."""

    column: Array  # (m, w)
    weight: Array  # (m, w)

    @classmethod
    def of(cls, matrix: Array) -> Rows:
        """The rows of a matrix."""
        width = max(1, int((matrix != 0).sum(axis=1).max(initial=1)))
        column = np.argsort(matrix == 0, axis=1, kind="stable")[:, :width]
        weight = np.take_along_axis(matrix, column, axis=1).astype(float)
        return cls(np.ascontiguousarray(column), np.ascontiguousarray(weight))
