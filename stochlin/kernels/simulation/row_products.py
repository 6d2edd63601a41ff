"""Products of matrices of few entries per row with values in all lanes, the last axis of arrays."""

from __future__ import annotations

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.compiled import called_often, compiled, of_lane


def rows_of(matrix: Array) -> Array:
    """A matrix (m, n) by the nonzero entries (m, w) in each row; zeros fill shorter rows."""
    width = max(1, int((matrix != 0).sum(axis=1).max(initial=1)))
    rows = np.zeros((len(matrix), width), [("column", np.int64), ("weight", float)])
    if matrix.shape[1] == 0:
        return rows
    rows["column"] = np.argsort(matrix == 0, axis=1, kind="stable")[:, :width]
    rows["weight"] = np.take_along_axis(matrix, rows["column"], axis=1)
    return rows


def times_rows(rows: Array, values: Array) -> Array:
    """The matrix of `rows_of` times a vector (n,)."""
    product: Array = (rows["weight"] * values[rows["column"]]).sum(axis=1)
    return product


@called_often
def times_row(rows, i, values, out, lanes):
    """Write row ``i`` of `rows_of` times the values (n, lanes) to ``out`` (lanes,)."""
    weight = rows[i, 0]["weight"]
    column = rows[i, 0]["column"]
    for lane in range(lanes):
        out[lane] = weight * values[column, lane]
    for place in range(1, rows.shape[1]):
        weight = rows[i, place]["weight"]
        column = rows[i, place]["column"]
        for lane in range(lanes):
            out[lane] += weight * values[column, lane]


@compiled
def products(rows, values, out, lanes):
    """Write `times_row` of each row to a row of ``out``."""
    for i in range(rows.shape[0]):
        times_row(rows, i, values, out[i], lanes)


@called_often
def row_product(rows, i, values, lane):
    """`times_row` in one lane."""
    total = 0.0
    for place in range(rows.shape[1]):
        total += rows[i, place]["weight"] * values[rows[i, place]["column"], lane]
    return total


@compiled
def add_product(matrix, values, out, lanes):
    """Add a matrix times the values (n, lanes) to ``out`` (m, lanes), by fours."""
    for i in range(matrix.shape[0]):
        row = matrix[i]
        for j in range(0, row.shape[0] - 3, 4):
            a, b, c, d = row[j], row[j + 1], row[j + 2], row[j + 3]
            for lane in range(lanes):
                first = of_lane(a, lane) * values[j, lane] + of_lane(b, lane) * values[j + 1, lane]
                out[i, lane] += first + (
                    of_lane(c, lane) * values[j + 2, lane] + of_lane(d, lane) * values[j + 3, lane]
                )
        for k in range(row.shape[0] // 4 * 4, row.shape[0]):
            a = row[k]
            for lane in range(lanes):
                out[i, lane] += of_lane(a, lane) * values[k, lane]


@called_often
def fill(values, value, lanes):
    """Set the values (lanes,) to a number."""
    for lane in range(lanes):
        values[lane] = value


@called_often
def any_of(values, lanes):
    """Whether one of the values (lanes,) is not zero."""
    for lane in range(lanes):  # noqa: SIM110 - compiled
        if values[lane] != 0.0:
            return True
    return False
