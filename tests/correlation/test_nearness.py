"""The quadratic form of nearly equal structures: a form that is known is found again."""

import numpy as np
import pytest

from stochlin.kernels.correlation.corrections import (
    ENTRIES,
    HALF_WEIGHT_DISTANCE,
    PARAMETER_AXES,
    Nearness,
    by_nearness,
)
from stochlin.solver.correlation.signatures import matrix_of

pytestmark = pytest.mark.oracle


def test_the_weight_of_the_form_falls_from_one_to_nothing():
    """Half at ``HALF_WEIGHT_DISTANCE``, the same share of it at a multiple; times both trusts."""
    ends = HALF_WEIGHT_DISTANCE * np.array([0.0, 1 / 3, 1.0, 3.0, 1e9])
    nothing = np.zeros((ENTRIES, ends.size))
    one = Nearness(nothing[:PARAMETER_AXES], matrix_of(nothing), np.full(ends.size, 0.5))
    place = one.place.copy()
    place[0] = np.sqrt(ends)  # so that q, with a unit matrix, is this distance
    rho = np.full(ends.size, 0.4)
    other = one._replace(place=place, trust=2 * one.trust)
    with np.errstate(divide="ignore"):  # ln q of equal structures
        mixed, share = by_nearness(rho, one, other, 0.0)
    np.testing.assert_allclose(share, [0.0, 0.45, 0.25, 0.05, 0.0], rtol=0, atol=1e-14)
    np.testing.assert_allclose(mixed[[0, -1]], 0.4, rtol=0, atol=1e-14)


def test_the_form_is_that_of_the_mean_of_both_matrices():
    """``q`` follows from the weight; the matrices are given by lower triangles, row by row."""
    rng = np.random.default_rng(4)
    roots = rng.normal(size=(2, PARAMETER_AXES, PARAMETER_AXES))
    matrices = roots @ roots.swapaxes(1, 2)
    triangles = [matrix[np.tril_indices(PARAMETER_AXES)] for matrix in matrices]
    places = rng.normal(size=(2, PARAMETER_AXES)) / 2
    near = [
        Nearness(place, triangle, np.array(1.0))
        for place, triangle in zip(places, triangles, strict=True)
    ]
    _, share = by_nearness(np.array(0.4), *near, 0.0)
    apart = places[0] - places[1]
    q = apart @ matrices.mean(axis=0) @ apart
    np.testing.assert_allclose(HALF_WEIGHT_DISTANCE * np.sqrt(1 / share - 1), q, rtol=1e-12)
