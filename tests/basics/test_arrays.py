"""Arrays for vector registers."""

import pytest

from stochlin.kernels.basics.arrays import CACHE_LINE, zeros_on_a_line

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
