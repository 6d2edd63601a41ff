"""Tables computed in tiles of `LANES` cells each, called lanes, by loops compiled to vector code."""

from __future__ import annotations

from typing import Any

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.compiled import called_often, worth_compiling

LANES = 64  # cells of a tile, so that its rows stay in the first-level cache
FEW = 32  # cells that take a tenth of the time uncompiled that it takes to compile their kernels


def in_tiles(kernel: Any, cells: int, *arrays: Array) -> None:
    """Call an `entry` that takes its number of lanes last; with one, uncompiled, for few cells."""
    if worth_compiling(kernel, cells, FEW):
        kernel(*arrays)
    else:
        with np.errstate(all="ignore"):  # as in compiled code
            getattr(kernel, "py_func", kernel)(*arrays, 1)


@called_often
def fill(tile, value):
    """Set all entries of a tile to ``value``."""
    for at in range(tile.size):
        tile[at] = value


@called_often
def load(rows, start, tile, first, lanes=LANES):
    """Copy columns of ``rows`` (m, n) from ``start`` on into a tile, from its row ``first`` on."""
    count = min(lanes, rows.shape[1] - start)
    for row in range(rows.shape[0]):
        for lane in range(count):
            tile[(first + row) * lanes + lane] = rows[row, start + lane]


@called_often
def read3(tile, row, lane):
    """Values of a lane in three rows of a tile, from ``row`` on."""
    return tile[row * LANES + lane], tile[(row + 1) * LANES + lane], tile[(row + 2) * LANES + lane]


@called_often
def write3(tile, row, lane, values):
    """Write values of a lane to three rows of a tile, from ``row`` on."""
    tile[row * LANES + lane] = values[0]
    tile[(row + 1) * LANES + lane] = values[1]
    tile[(row + 2) * LANES + lane] = values[2]


@called_often
def store(tile, first, rows, start, lanes=LANES):
    """Copy rows of a tile, from ``first`` on, into columns of ``rows`` (m, n) from ``start`` on."""
    count = min(lanes, rows.shape[1] - start)
    for row in range(rows.shape[0]):
        for lane in range(count):
            rows[row, start + lane] = tile[(first + row) * lanes + lane]
