"""Exponentials of matrices, against those of scipy."""

import numpy as np
import pytest
import scipy.linalg

from stochlin.kernels.basics.exponentials import exponentials

pytestmark = pytest.mark.oracle


def test_exponentials_are_those_of_scipy():
    matrices = np.random.default_rng(5).normal(size=(3, 4, 4))
    times = np.array([0.0, 0.01, 1.0, -2.5])
    found = exponentials(matrices * times[:, None, None, None])
    for time, row in zip(times, found, strict=True):
        expected = np.stack([scipy.linalg.expm(time * matrix) for matrix in matrices])
        np.testing.assert_allclose(row, expected, rtol=0, atol=1e-12 * np.abs(expected).max())
    assert exponentials(np.empty((4, 2, 0, 0))).shape == (4, 2, 0, 0)
