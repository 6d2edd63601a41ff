"""Panels of Lobatto's nodes: against polynomials, and exponentials against those of scipy."""

import numpy as np
import pytest
import scipy.linalg

from stochlin.kernels.basics.collocation import exponentials, lobatto

pytestmark = pytest.mark.oracle


@pytest.mark.parametrize("count", [2, 5, 24])
def test_polynomials_of_the_nodes_degree_are_exact(count):
    nodes, length = lobatto(count), 1.7
    random = np.random.default_rng(3)
    polynomials = [np.polynomial.Polynomial(random.normal(size=count)) for _ in range(3)]
    at = length * nodes.at
    values = np.stack([one(at) for one in polynomials], axis=1)
    integrals = np.stack([one.integ()(at) - one.integ()(0) for one in polynomials], axis=1)
    shares = random.random(9)
    between = np.stack([one(length * shares) for one in polynomials], axis=1)
    scale = np.abs(values).max()
    np.testing.assert_allclose(nodes.integrate(values, length), integrals, atol=1e-13 * scale)
    np.testing.assert_allclose(nodes.interpolate(values, shares), between, atol=1e-13 * scale)


def test_integrals_over_the_whole_panel_are_exact_to_twice_the_degree():
    nodes = lobatto(6)
    assert nodes.integrate(nodes.at**9, 1.0)[-1] == pytest.approx(0.1, rel=1e-13)
    assert nodes.integrate(nodes.at**10, 1.0)[-1] != pytest.approx(1 / 11, rel=1e-8)


def test_last_terms_vanish_where_nodes_resolve():
    nodes = lobatto(6)
    assert np.abs(nodes.last_terms(nodes.at**3)).max() < 1e-14
    assert np.abs(nodes.last_terms(nodes.at**5)).max() > 1e-4


def test_exponentials_are_those_of_scipy():
    matrices = np.random.default_rng(5).normal(size=(3, 4, 4))
    times = np.array([0.0, 0.01, 1.0, -2.5])
    found = exponentials(matrices * times[:, None, None, None])
    for time, row in zip(times, found, strict=True):
        expected = np.stack([scipy.linalg.expm(time * matrix) for matrix in matrices])
        np.testing.assert_allclose(row, expected, rtol=0, atol=1e-12 * np.abs(expected).max())
    assert exponentials(np.empty((4, 2, 0, 0))).shape == (4, 2, 0, 0)
