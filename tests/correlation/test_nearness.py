"""The quadratic form of nearly equal structures: a form that is known is found again."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stochlin.kernels.correlation.nearness import AXES, PAIRS, form_of

pytestmark = pytest.mark.oracle


@given(st.integers(0, 2**32 - 1))
def test_a_form_is_found_from_the_correlations_of_its_neighbours(seed):
    """``1 - rho = q/(1 + q)`` with ``q = d' M d``, for the differences ``d`` of five structures."""
    draw = np.random.default_rng(seed)
    roots, steps = draw.uniform(0.5, 3.0, (AXES, AXES)), draw.uniform(0.02, 0.2, AXES)
    matrix = roots @ roots.T + np.eye(AXES)
    places = np.concatenate([np.zeros((1, AXES)), np.diag(steps)])
    apart = places[:, None] - places
    form = np.einsum("ijk,kl,ijl->ij", apart, matrix, apart)
    found = form_of((form / (1 + form))[..., None], steps)[:, 0]
    slopes = np.sqrt(np.diag(matrix))
    np.testing.assert_allclose(found[:AXES], np.log(slopes), rtol=0, atol=1e-10)
    across = [matrix[pair] / (slopes[pair[0]] * slopes[pair[1]]) for pair in PAIRS]
    np.testing.assert_allclose(found[AXES:], across, rtol=0, atol=1e-9)
