"""Exponentials, logarithms and powers against those of numpy."""

import numba
import numpy as np
import pytest

from stochlin.kernels.basics.powers import exponential, logarithm, power

pytestmark = pytest.mark.oracle

EPS = np.finfo(float).eps
RNG = np.random.default_rng(7)
NUMBERS = np.concatenate([10.0 ** RNG.uniform(-300, 300, 2000), RNG.uniform(0.5, 2.0, 2000), [1.0]])


def test_logarithms_are_exact_but_for_rounding():
    found = [logarithm(x) for x in NUMBERS]
    np.testing.assert_allclose(found, np.log(NUMBERS), rtol=2 * EPS, atol=0)


def test_exponentials_are_exact_but_for_rounding():
    x = np.concatenate([RNG.uniform(-700, 700, 2000), RNG.uniform(-1, 1, 2000), [0.0]])
    np.testing.assert_allclose([exponential(one) for one in x], np.exp(x), rtol=2 * EPS, atol=0)
    assert exponential(-1e4) < 1e-300
    assert 1e300 < exponential(1e4) < np.inf


def test_powers_are_exact_but_for_the_rounding_of_the_logarithm():
    x, exponent = RNG.uniform(0, 3, 4000), RNG.uniform(0, 6, 4000)
    found = np.array([power(*both) for both in zip(x, exponent, strict=True)])
    off = np.abs(found / x**exponent - 1)
    assert (off < EPS * (2 + np.abs(exponent * np.log(x)))).all()


@pytest.mark.parametrize(("exponent", "expected"), [(2.5, 0.0), (0.0, 1.0), (-1.0, np.inf)])
def test_powers_of_zero_are_their_limits(exponent, expected):
    assert power(0.0, exponent) == expected


def test_compiled_functions_give_the_same_numbers():
    @numba.njit(error_model="numpy")
    def all_of(x):
        return np.array([power(one, 1.7) for one in x])

    np.testing.assert_array_equal(all_of(NUMBERS), [power(one, 1.7) for one in NUMBERS])
