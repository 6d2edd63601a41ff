"""Fixed points of cells whose closure and ground are compiled: all iterations of a cell in one go."""

import math

from stochlin.kernels.basics.compiled import called_often, compiled, entry
from stochlin.kernels.linearization.cells.grounds import forcing_of
from stochlin.kernels.linearization.cells.slip import closure_of
from stochlin.kernels.linearization.cells.steps import advance, moments_of

OF_GROUND = 5  # at most; intensity, and stiffness and damping of each oscillator
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
def settle_cells(cells, ground, start, clipped, oscillators, pace, rtol, atol, most, out, iterations):
    """Write what `settle` finds for all cells to ``out`` (FOUND, n) and ``iterations`` (n,).

    ``cells`` are (4, n), ``ground`` (OF_GROUND, n) and ``start`` (3, n).
    """
    for n in range(iterations.size):
        cell = cells[0][n], cells[1][n], cells[2][n], cells[3][n]
        soil = ground[0][n], ground[1][n], ground[2][n], ground[3][n], ground[4][n]
        begin = start[0][n], start[1][n], start[2][n]
        problem = clipped, oscillators, cell, soil, begin
        result, iterations[n] = settle(*problem, pace, rtol, atol, most)
        for row in range(FOUND):
            out[row, n] = result[row]
