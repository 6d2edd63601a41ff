"""Fixed points of cells whose closure and ground are compiled: all iterations of a cell in one go.

A table is solved in tiles. A lane whose cell is done takes up the next cell, so that no lane waits for
the slowest one.
"""

import math

import numpy as np

from stochlin.kernels.basics.compiled import called_often, compiled, entry
from stochlin.kernels.linearization.cells.grounds import forcing_of
from stochlin.kernels.linearization.cells.slip import (
    COEFFICIENTS,
    MOMENTS,
    close,
    closure_of,
    read_values,
)
from stochlin.kernels.linearization.cells.steps import (
    BASE,
    CELL,
    DELTA,
    DONE,
    FORCED,
    NORM,
    STATED,
    STEP,
    STEPPED,
    advance,
    advance_lanes,
    moments_of,
    read_state,
)
from stochlin.kernels.linearization.cells.tiles import LANES, fill, read3, write3

OF_GROUND = 5  # at most; intensity, and stiffness and damping of each oscillator
GROUND = STEPPED
ROWS = GROUND + OF_GROUND
# Results of a cell: coefficients (2), unknowns (3), norm of the mismatch, and 1 if converged.
FOUND = 7


@called_often
def _result(moments, value, state):
    """The results of a cell, after the last step.

    The closure was evaluated before this step. It is so small in a converged cell that the slopes give
    the coefficients to rounding error.
    """
    base, norm, step, _, done = state
    unknowns = base[0] + step[0], base[1] + step[1], base[2] + step[2]
    after = moments_of(state)
    change = after[0] - moments[0], after[1] - moments[1], after[2] - moments[2]
    (slip, relaxation), of_slip, of_relaxation, _, _ = value
    slip += of_slip[0] * change[0] + of_slip[1] * change[1] + of_slip[2] * change[2]
    relaxation += of_relaxation[0] * change[0] + of_relaxation[1] * change[1]
    relaxation += of_relaxation[2] * change[2]
    return slip, relaxation, *unknowns, norm, done


@compiled
def settle(clipped, oscillators, cell, ground, start, pace, rtol, atol, most):
    """The fixed point of one cell from the unknowns ``start``, in at most ``most`` iterations.

    ``cell`` has stiffness, damping, coupling and level of shaking. ``ground`` has the intensity, then
    stiffness and damping of its ``oscillators``, and is filled up to `OF_GROUND`. The results are those
    of `_result`, and the number of iterations.
    """
    state, count = (start, math.inf, (0.0, 0.0, 0.0), pace.first, 0.0), 0
    while True:
        count += 1
        moments = moments_of(state)
        value = closure_of(clipped, moments)
        forcings = forcing_of(oscillators, (cell[0], cell[1], cell[2], *value[0]), ground)
        state = advance(cell, moments, value, forcings, state, pace, rtol, atol)
        if state[4] > 0 or count == most:
            return _result(moments, value, state), count


@entry
def settle_cells(clipped, oscillators, cells, ground, start, pace, rtol, atol, most, out, iterations):
    """Write what `settle` finds for all cells to ``out`` (FOUND, n) and ``iterations`` (n,).

    ``cells`` are (4, n), ``ground`` (OF_GROUND, n) and ``start`` (3, n).
    """
    tile = np.empty(ROWS * LANES)
    fill(tile, 1.0)
    at, count, taken, busy = np.full(LANES, -1), np.zeros(LANES, np.int64), 0, 0
    for lane in range(min(LANES, iterations.size)):
        _take_up(tile, lane, cells[:, taken], ground[:, taken], start[:, taken], pace)
        at[lane], taken, busy = taken, taken + 1, busy + 1
    while busy:
        for lane in range(LANES):
            write3(tile, MOMENTS, lane, moments_of(read_state(tile, lane)))
        close(tile, clipped)
        _force(tile, oscillators)
        advance_lanes(tile, pace, rtol, atol)
        for lane in range(LANES):
            count[lane] += 1
            here = at[lane]
            if here < 0 or (tile[(STATED + DONE) * LANES + lane] == 0 and count[lane] < most):
                continue
            value, state = read_values(tile, lane), read_state(tile, lane)
            result = _result(read3(tile, MOMENTS, lane), value, state)
            for row in range(FOUND):
                out[row, here] = result[row]
            iterations[here] = count[lane]
            at[lane], count[lane] = -1, 0
            if taken < iterations.size:
                _take_up(tile, lane, cells[:, taken], ground[:, taken], start[:, taken], pace)
                at[lane], taken = taken, taken + 1
            else:
                busy -= 1


@compiled
def _take_up(tile, lane, cell, ground, start, pace):
    """Begin a cell in a lane."""
    for row in range(cell.size):
        tile[(CELL + row) * LANES + lane] = cell[row]
    for row in range(ground.size):
        tile[(GROUND + row) * LANES + lane] = ground[row]
    for row in range(3):
        tile[(STATED + BASE + row) * LANES + lane] = start[row]
        tile[(STATED + STEP + row) * LANES + lane] = 0.0
    tile[(STATED + NORM) * LANES + lane] = math.inf
    tile[(STATED + DELTA) * LANES + lane] = pace.first
    tile[(STATED + DONE) * LANES + lane] = 0.0


@compiled
def _force(tile, oscillators):
    """Forcing and its derivatives for all lanes of a tile."""
    if oscillators == 0:
        for lane in range(LANES):
            _force_lane(tile, lane, 0)
    elif oscillators == 1:
        for lane in range(LANES):
            _force_lane(tile, lane, 1)
    else:
        for lane in range(LANES):
            _force_lane(tile, lane, 2)


@called_often
def _force_lane(tile, lane, oscillators):
    """`forcing_of` for a lane."""
    p, k = tile[COEFFICIENTS * LANES + lane], tile[(COEFFICIENTS + 1) * LANES + lane]
    ground = (
        *read3(tile, GROUND, lane), tile[(GROUND + 3) * LANES + lane], tile[(GROUND + 4) * LANES + lane]
    )  # fmt: skip
    forcing, by_slip, by_relaxation = forcing_of(oscillators, (*read3(tile, CELL, lane), p, k), ground)
    write3(tile, FORCED, lane, forcing)
    write3(tile, FORCED + 3, lane, by_slip)
    write3(tile, FORCED + 6, lane, by_relaxation)
