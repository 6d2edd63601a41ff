"""Rows of a table, tile by tile: of a fixed number of lanes, so that loops over them are vector code."""

from stochlin.kernels.basics.compiled import called_often

LANES = 64  # the rows of a tile stay in the first-level cache


@called_often
def fill(tile, value):
    """The same value everywhere."""
    for at in range(tile.size):
        tile[at] = value


@called_often
def load(rows, start, tile, first):
    """Columns from ``start`` of ``rows`` into a tile, from its row ``first`` on."""
    count = min(LANES, rows.shape[1] - start)
    for row in range(rows.shape[0]):
        for lane in range(count):
            tile[(first + row) * LANES + lane] = rows[row, start + lane]


@called_often
def read3(tile, row, lane):
    """Three rows of a lane."""
    return tile[row * LANES + lane], tile[(row + 1) * LANES + lane], tile[(row + 2) * LANES + lane]


@called_often
def write3(tile, row, lane, values):
    """The reverse."""
    tile[row * LANES + lane] = values[0]
    tile[(row + 1) * LANES + lane] = values[1]
    tile[(row + 2) * LANES + lane] = values[2]


@called_often
def store(tile, first, rows, start):
    """The reverse."""
    count = min(LANES, rows.shape[1] - start)
    for row in range(rows.shape[0]):
        for lane in range(count):
            rows[row, start + lane] = tile[(first + row) * LANES + lane]
