"""The criterion of stability of an equivalent system, against eigenvalues of its state matrix."""

import numpy as np
import pytest

from stochlin.kernels.linearization.covariance import stable

pytestmark = pytest.mark.oracle


def test_stability_is_that_of_the_eigenvalues():
    """Of ``u'' + d u' + (1 - h) u + h z = f`` and ``z' = (1 - p) u' - k z``."""
    rng, count = np.random.default_rng(5), 4000
    lowest, highest = [-0.5, 0.0, -3.0, -0.5], [2.0, 1.5, 3.0, 3.0]
    d, h, p, k = rng.uniform(lowest, highest, (count, 4)).T
    matrix = np.zeros((count, 3, 3))
    matrix[:, 0, 1] = 1.0
    matrix[:, 1] = np.stack([h - 1, -d, -h], axis=1)
    matrix[:, 2, 1:] = np.stack([1 - p, -k], axis=1)
    growth = np.linalg.eigvals(matrix).real.max(axis=1)
    clear = np.abs(growth) > 1e-6
    assert (stable(np.ones(count), d, h, p, k) == (growth < 0))[clear].all()
    assert 0.2 < (growth < 0).mean() < 0.8
