"""The kicks of the drift, for each cell: variance of their sizes by order, and autocorrelations.

The equations, with the numbers of ``docs/drift.md``, are those of the module `drift`. The number of
``lanes`` is the number of cells of a tile; plain Python takes them one by one (`in_tiles`).
"""

from __future__ import annotations

import numpy as np

from stochlin.kernels.basics.compiled import compiled, entry
from stochlin.kernels.linearization.cells.tiles import LANES, fill, load, store

TERMS = 8  # of the Taylor series of a matrix exponential
SMALL = 0.125  # largest time of the series, times the bound of the eigenvalues


@entry
def variance_by_order(sz, growth, excess, weight, out, lanes=LANES):
    """Write ``c_j^2`` of eq. (2) to ``out`` (orders + 1, n), by quadrature over amplitudes.

    It is the variance of the kick sizes by Laguerre order ``j``, over the square of their mean; the last
    row has the rest. ``growth`` (n,) is ``exp(1/(2 sz^2))``; ``excess`` and ``weight`` are the nodes and
    weights of the quadrature for an exponential density.
    """
    orders = out.shape[0] - 1
    std, threshold = np.empty(lanes), np.empty(lanes)
    energy, weighted = np.empty(lanes), np.empty(lanes)
    before, last = np.empty(lanes), np.empty(lanes)
    sums, square = np.empty((orders + 1) * lanes), np.empty(lanes)
    fill(std, 1.0)
    for start in range(0, sz.size, lanes):
        count = min(lanes, sz.size - start)
        for lane in range(count):
            std[lane] = sz[start + lane]
        fill(sums, 0.0)
        fill(square, 0.0)
        for lane in range(lanes):
            threshold[lane] = 0.5 / (std[lane] * std[lane])
        for node in range(excess.size):
            for lane in range(lanes):
                energy[lane] = threshold[lane] + excess[node]
                # The kick size a - 1 = sqrt(2 E) sz - 1, without cancellation.
                size = 2 * std[lane] * std[lane] * excess[node]
                size /= std[lane] * np.sqrt(2 * energy[lane]) + 1
                weighted[lane] = weight[node] * size
                square[lane] += weighted[lane] * size
            _add_polynomials(energy, weighted, before, last, sums, orders, lanes)
        for lane in range(count):
            mean = sums[lane]
            left = square[lane] / (mean * mean) * growth[start + lane] - 1
            for order in range(1, orders + 1):
                share = sums[order * lanes + lane] / mean
                out[order - 1, start + lane] = share * share
                left -= share * share
            out[orders, start + lane] = np.maximum(left, 0.0)


@compiled
def _add_polynomials(energy, weighted, before, last, sums, orders, lanes):
    """Add the weighted Laguerre polynomials of ``energy`` to ``sums``, by their recursion."""
    for lane in range(lanes):
        before[lane], last[lane] = 1.0, 1.0 - energy[lane]
        sums[lane] += weighted[lane]
        sums[lanes + lane] += weighted[lane] * last[lane]
    for order in range(2, orders + 1):
        here, factor, share = order * lanes, 2.0 * order - 1, 1.0 / order
        for lane in range(lanes):
            value = (factor - energy[lane]) * last[lane]
            value = (value - (order - 1) * before[lane]) * share
            before[lane], last[lane] = last[lane], value
            sums[here + lane] += weighted[lane] * value


@entry
def add_powers(memory, out, lanes=LANES):
    """Write ``S_j``, the sum of ``R_n^(2 j + 1)`` over all ``n``, eq. (3), to ``out`` (orders, n).

    A power of a correlation function is a correlation function, so that with Bartlett's window no sum is
    negative.
    """
    cycles, orders = memory.shape[0], out.shape[0]
    sums, tile = np.empty(orders * lanes), np.empty(cycles * lanes)
    power, square = np.empty(lanes), np.empty(lanes)
    fill(tile, 0.0)
    for start in range(0, memory.shape[1], lanes):
        load(memory, start, tile, 0, lanes)
        fill(sums, 1.0)
        for n in range(cycles):
            window = 2 * (1 - (n + 1) / cycles)
            for lane in range(lanes):
                value = tile[n * lanes + lane]
                power[lane], square[lane] = window * value, value * value
            for order in range(orders):
                for lane in range(lanes):
                    power[lane] *= square[lane]
                    sums[order * lanes + lane] += power[lane]
        for at in range(sums.size):
            sums[at] = max(sums[at], 0.0)
        store(sums, 0, out, start, lanes)


@entry
def follow(matrix, time, turns, states, out, lanes=LANES):
    """Write ``z`` at multiples of ``time`` (n,) in the free motion ``x' = A x`` to ``out``.

    The result is (cycles, n). The motion starts from ``states`` (k, n). ``matrix`` (k * k, n) is ``A``,
    and ``turns`` (n,) a bound of its eigenvalues times ``time``. ``z`` is the first state, the
    displacement, less the third, the slip.
    """
    size, cycles = states.shape[0], out.shape[0]
    part, step, other = (
        np.empty(size * size * lanes), np.empty(size * size * lanes), np.empty(size * size * lanes)
    )  # fmt: skip
    here, after = np.empty(size * lanes), np.empty(size * lanes)
    made, doublings = np.empty(cycles * lanes), np.empty(lanes)
    for tile in (part, here, doublings):
        fill(tile, 0.0)
    for start in range(0, time.size, lanes):
        count = min(lanes, time.size - start)
        load(matrix, start, part, 0, lanes)
        load(states, start, here, 0, lanes)
        for lane in range(count):
            here_turns = turns[start + lane]
            known = here_turns > SMALL and np.isfinite(here_turns)
            doublings[lane] = np.ceil(np.log2(here_turns / SMALL)) if known else 0.0
            share = time[start + lane] / 2.0 ** doublings[lane]
            for row in range(size * size):
                part[row * lanes + lane] *= share
        _exponential(part, doublings, size, step, other, lanes)
        for n in range(cycles):
            fill(after, 0.0)
            for i in range(size):
                for j in range(size):
                    for lane in range(lanes):
                        after[i * lanes + lane] += (
                            step[(i * size + j) * lanes + lane] * here[j * lanes + lane]
                        )
            for at in range(size * lanes):
                here[at] = after[at]
            for lane in range(lanes):
                made[n * lanes + lane] = here[lane] - here[2 * lanes + lane]
        store(made, 0, out, start, lanes)


@compiled
def _exponential(part, doublings, size, total, other, lanes):
    """Matrix exponential by scaling and squaring, with a number of squarings for each lane.

    ``part`` is the scaled matrix, ``doublings`` the numbers of squarings, ``total`` the result.
    """
    for i in range(size * size):
        identity = 1.0 if i % (size + 1) == 0 else 0.0
        for lane in range(lanes):
            total[i * lanes + lane] = identity + part[i * lanes + lane] / TERMS
    for order in range(TERMS - 1, 0, -1):
        _multiply(part, total, size, other, lanes)
        for i in range(size * size):
            identity = 1.0 if i % (size + 1) == 0 else 0.0
            for lane in range(lanes):
                total[i * lanes + lane] = identity + other[i * lanes + lane] / order
    most = 0.0
    for lane in range(lanes):
        most = max(most, doublings[lane])
    for doubling in range(int(most)):
        _multiply(total, total, size, other, lanes)
        for i in range(size * size):
            for lane in range(lanes):
                more = doubling < doublings[lane]
                kept = total[i * lanes + lane]
                total[i * lanes + lane] = other[i * lanes + lane] if more else kept


@compiled
def _multiply(left, right, size, product, lanes):
    """Matrix product of each lane."""
    fill(product, 0.0)
    for i in range(size):
        for j in range(size):
            for k in range(size):
                for lane in range(lanes):
                    product[(i * size + k) * lanes + lane] += (
                        left[(i * size + j) * lanes + lane] * right[(j * size + k) * lanes + lane]
                    )
