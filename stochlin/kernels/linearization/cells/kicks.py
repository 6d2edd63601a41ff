"""The kicks of the drift, for each cell: variance of their sizes by order, and autocorrelations.

The equations, with the numbers of ``docs/drift.md``, are those of the module `drift`.
"""

from __future__ import annotations

import numpy as np

from stochlin.kernels.basics.compiled import compiled, entry
from stochlin.kernels.linearization.cells.tiles import LANES, fill, load, store

TERMS = 8  # of the Taylor series of a matrix exponential
SMALL = 0.125  # largest time of the series, times the bound of the eigenvalues


@entry
def variance_by_order(sz, growth, excess, weight, found):
    """Write ``c_j^2`` of eq. (2) to ``found`` (orders + 1, n), by quadrature over amplitudes.

    It is the variance of the kick sizes by Laguerre order ``j``, over the square of their mean; the last
    row has the rest. ``growth`` (n,) is ``exp(1/(2 sz^2))``; ``excess`` and ``weight`` are the nodes and
    weights of the quadrature for an exponential density.
    """
    orders = found.shape[0] - 1
    std, threshold = np.empty(LANES), np.empty(LANES)
    energy, weighted = np.empty(LANES), np.empty(LANES)
    polynomials = np.empty((orders + 1) * LANES)
    sums, square = np.empty((orders + 1) * LANES), np.empty(LANES)
    fill(std, 1.0)
    for start in range(0, sz.size, LANES):
        count = min(LANES, sz.size - start)
        for lane in range(count):
            std[lane] = sz[start + lane]
        fill(sums, 0.0)
        fill(square, 0.0)
        for lane in range(LANES):
            threshold[lane] = 0.5 / (std[lane] * std[lane])
        for node in range(excess.size):
            for lane in range(LANES):
                energy[lane] = threshold[lane] + excess[node]
                # The kick size a - 1 = sqrt(2 E) sz - 1, without cancellation.
                size = 2 * std[lane] * std[lane] * excess[node]
                size /= std[lane] * np.sqrt(2 * energy[lane]) + 1
                weighted[lane] = weight[node] * size
                square[lane] += weighted[lane] * size
            _add_polynomials(energy, weighted, polynomials, sums, orders)
        for lane in range(count):
            mean = sums[lane]
            left = square[lane] / (mean * mean) * growth[start + lane] - 1
            for order in range(1, orders + 1):
                share = sums[order * LANES + lane] / mean
                found[order - 1, start + lane] = share * share
                left -= share * share
            found[orders, start + lane] = np.maximum(left, 0.0)


@compiled
def _add_polynomials(energy, weighted, polynomials, sums, orders):
    """Add the weighted Laguerre polynomials of ``energy`` to ``sums``, by their recursion."""
    for lane in range(LANES):
        polynomials[lane], polynomials[LANES + lane] = 1.0, 1.0 - energy[lane]
        sums[lane] += weighted[lane]
        sums[LANES + lane] += weighted[lane] * polynomials[LANES + lane]
    for order in range(2, orders + 1):
        here, factor, share = order * LANES, 2.0 * order - 1, 1.0 / order
        for lane in range(LANES):
            value = (factor - energy[lane]) * polynomials[here - LANES + lane]
            value = (value - (order - 1) * polynomials[here - 2 * LANES + lane]) * share
            polynomials[here + lane] = value
            sums[here + lane] += weighted[lane] * value


@entry
def add_powers(memory, found):
    """Write ``S_j``, the sum of ``R_n^(2 j + 1)`` over all ``n``, eq. (3), to ``found`` (orders, n).

    A power of a correlation function is a correlation function, so that with Bartlett's window no sum is
    negative.
    """
    cycles, orders = memory.shape[0], found.shape[0]
    sums, given = np.empty(orders * LANES), np.empty(cycles * LANES)
    power, square = np.empty(LANES), np.empty(LANES)
    fill(given, 0.0)
    for start in range(0, memory.shape[1], LANES):
        load(memory, start, given, 0)
        fill(sums, 1.0)
        for n in range(cycles):
            window = 2 * (1 - (n + 1) / cycles)
            for lane in range(LANES):
                value = given[n * LANES + lane]
                power[lane], square[lane] = window * value, value * value
            for order in range(orders):
                for lane in range(LANES):
                    power[lane] *= square[lane]
                    sums[order * LANES + lane] += power[lane]
        for at in range(sums.size):
            sums[at] = max(sums[at], 0.0)
        store(sums, 0, found, start)


@entry
def follow(matrix, time, turns, states, found):
    """Write ``z`` at multiples of ``time`` (n,) in the free motion ``x' = A x`` to ``found``.

    The result is (cycles, n). The motion starts from ``states`` (k, n). ``matrix`` (k * k, n) is ``A``,
    and ``turns`` (n,) a bound of its eigenvalues times ``time``. ``z`` is the first state, the
    displacement, less the third, the slip.
    """
    size, cycles = states.shape[0], found.shape[0]
    part, step, other = (
        np.empty(size * size * LANES), np.empty(size * size * LANES), np.empty(size * size * LANES)
    )  # fmt: skip
    here, after = np.empty(size * LANES), np.empty(size * LANES)
    made, doublings = np.empty(cycles * LANES), np.empty(LANES)
    for tile in (part, here, doublings):
        fill(tile, 0.0)
    for start in range(0, time.size, LANES):
        count = min(LANES, time.size - start)
        load(matrix, start, part, 0)
        load(states, start, here, 0)
        for lane in range(count):
            here_turns = turns[start + lane]
            known = here_turns > SMALL and np.isfinite(here_turns)
            doublings[lane] = np.ceil(np.log2(here_turns / SMALL)) if known else 0.0
            share = time[start + lane] / 2.0 ** doublings[lane]
            for row in range(size * size):
                part[row * LANES + lane] *= share
        _exponential(part, doublings, size, step, other)
        for n in range(cycles):
            fill(after, 0.0)
            for i in range(size):
                for j in range(size):
                    for lane in range(LANES):
                        after[i * LANES + lane] += (
                            step[(i * size + j) * LANES + lane] * here[j * LANES + lane]
                        )
            for at in range(size * LANES):
                here[at] = after[at]
            for lane in range(LANES):
                made[n * LANES + lane] = here[lane] - here[2 * LANES + lane]
        store(made, 0, found, start)


@compiled
def _exponential(part, doublings, size, total, other):
    """Matrix exponential by scaling and squaring, with a number of squarings for each lane.

    ``part`` is the scaled matrix, ``doublings`` the numbers of squarings, ``total`` the result.
    """
    for i in range(size * size):
        one = 1.0 if i % (size + 1) == 0 else 0.0
        for lane in range(LANES):
            total[i * LANES + lane] = one + part[i * LANES + lane] / TERMS
    for order in range(TERMS - 1, 0, -1):
        _multiply(part, total, size, other)
        for i in range(size * size):
            one = 1.0 if i % (size + 1) == 0 else 0.0
            for lane in range(LANES):
                total[i * LANES + lane] = one + other[i * LANES + lane] / order
    most = 0.0
    for lane in range(LANES):
        most = max(most, doublings[lane])
    for doubling in range(int(most)):
        _multiply(total, total, size, other)
        for i in range(size * size):
            for lane in range(LANES):
                more = doubling < doublings[lane]
                kept = total[i * LANES + lane]
                total[i * LANES + lane] = other[i * LANES + lane] if more else kept


@compiled
def _multiply(left, right, size, product):
    """Matrix product of each lane."""
    fill(product, 0.0)
    for i in range(size):
        for j in range(size):
            for k in range(size):
                for lane in range(LANES):
                    product[(i * size + k) * LANES + lane] += (
                        left[(i * size + j) * LANES + lane] * right[(j * size + k) * LANES + lane]
                    )
