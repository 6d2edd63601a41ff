"""The random numbers of the simulation against their definition, exact moments and statistics."""

import numpy as np
import pytest
import scipy.stats
from numpy.polynomial import polynomial

from stochlin.kernels.simulation.normal_numbers import POLYNOMIAL, fill_normal, generator_state

pytestmark = pytest.mark.oracle

WORD = 2**64


def drawn(seed, stream, steps, lanes=32):
    out = np.empty((steps, lanes))
    fill_normal(generator_state(seed, stream, lanes), out)
    return out


def words(state, count):
    """xoshiro256+ of Blackman and Vigna in Python's whole numbers."""
    a, b, c, d = state
    for _ in range(count):
        yield (a + d) % WORD
        shifted = (b << 17) % WORD
        c ^= a
        d ^= b
        b ^= c
        a ^= d
        c ^= shifted
        d = ((d << 45) | (d >> 19)) % WORD


def test_numbers_are_the_polynomial_of_the_sum_of_four_fields():
    state = generator_state(7, 3, 5)
    numbers = drawn(7, 3, 40, 5)
    unit = np.sqrt(4 * (2.0**32 - 1) / 12)
    for lane in range(5):
        for step, word in enumerate(words([int(s) for s in state[:, lane]], 40)):
            total = sum((word >> shift) % 2**16 for shift in (0, 16, 32, 48))
            x = (total - 2 * 65535) / unit
            value = x * polynomial.polyval(x * x, POLYNOMIAL)
            assert numbers[step, lane] == pytest.approx(value, rel=1e-13, abs=1e-15)


def test_sample_moments_and_correlations_are_within_their_errors():
    sample = drawn(11, 0, 200_000)
    count = sample.size
    for order, moment, variance in ((1, 0, 1), (2, 1, 2), (3, 0, 15), (4, 3, 96)):
        assert abs((sample**order).mean() - moment) < 4 * np.sqrt(variance / count)
    for lag in (1, 2, 3, 7, 32):
        assert abs((sample[lag:] * sample[:-lag]).mean()) < 4 / np.sqrt(count)
        squares = (sample[lag:] ** 2 - 1) * (sample[:-lag] ** 2 - 1)
        assert abs(squares.mean()) < 4 * 2 / np.sqrt(count)
    between = np.corrcoef(sample.T)[np.triu_indices(32, 1)] * np.sqrt(len(sample))
    # 496 correlations between lanes, each nearly standard normal
    assert np.abs(between).max() < 4.5
    assert scipy.stats.kstest(between, "norm").pvalue > 1e-3


def test_seed_and_stream_decide_the_numbers():
    assert np.array_equal(drawn(1, 2, 10), drawn(1, 2, 10))
    assert not np.array_equal(drawn(1, 2, 10), drawn(1, 3, 10))
    assert not np.array_equal(drawn(1, 2, 10), drawn(2, 2, 10))


def test_numbers_go_on_where_they_stopped():
    state = generator_state(5, 0, 32)
    first, second = np.empty((3, 32)), np.empty((4, 32))
    fill_normal(state, first)
    fill_normal(state, second)
    assert np.array_equal(np.concatenate([first, second]), drawn(5, 0, 7))
