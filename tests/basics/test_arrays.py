"""Arrays for vector registers, and small equations cell by cell."""

import numpy as np
import pytest

from stochlin.kernels.basics.arrays import CACHE_LINE, solve_3x3, zeros_on_a_line

pytestmark = pytest.mark.invariant


@pytest.mark.parametrize("shape", [(0, 32), (3,), (2, 5, 32), (4, 1000)])
def test_zeros_begin_at_a_cache_line(shape):
    many = [zeros_on_a_line(*shape) for _ in range(8)]
    for number, one in enumerate(many):
        assert (one.shape, one.dtype) == (shape, float)
        assert one.flags.c_contiguous
        assert one.ctypes.data % CACHE_LINE == 0 or not one.size
        assert not one.any()
        many[number] += 1  # each has memory of its own


def test_cramers_rule_solves_every_cell():
    rng = np.random.default_rng(1)
    matrix, right = rng.normal(size=(3, 3, 50)), rng.normal(size=(3, 50))
    expected = np.linalg.solve(matrix.transpose(2, 0, 1), right.T[..., None])[..., 0].T
    np.testing.assert_allclose(solve_3x3(matrix, right), expected, rtol=1e-9)
