"""The quadratic form of nearly equal structures: a form that is known is found again."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stochlin.kernels.correlation.nearness import (
    AXES,
    ENTRIES,
    FAR,
    NEAR,
    PAIRS,
    Nearness,
    form_of,
    with_nearness,
)

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


def test_the_weight_of_the_form_falls_from_one_to_nothing_between_two_distances():
    """Linearly in ``ln q``: a half at the geometric mean of both ends, times the trust of each."""
    ends = np.array([NEAR / 2, NEAR, np.sqrt(NEAR * FAR), FAR, 2 * FAR])
    one = Nearness(np.zeros((AXES, ends.size)), np.zeros((ENTRIES, ends.size)), np.full(ends.size, 0.5))
    place = one.place.copy()
    place[0] = np.sqrt(ends)  # so that q, with a unit matrix, is this distance
    rho = np.full(ends.size, 0.4)
    mixed, share, _ = with_nearness(rho, one, one._replace(place=place, trust=2 * one.trust), 0.0)
    np.testing.assert_allclose(share, [0.5, 0.5, 0.25, 0.0, 0.0], rtol=0, atol=1e-14)
    np.testing.assert_array_equal(mixed[share == 0], 0.4)
