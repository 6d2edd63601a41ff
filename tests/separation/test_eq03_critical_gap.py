"""Eq. (3): the double difference combination, its three exact cases, and what it stands for."""

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import stochlin as sl
from stochlin.kernels.correlation.closed_forms import double_difference

pytestmark = pytest.mark.paper

peaks = st.floats(1e-4, 10)
correlations = st.floats(-1, 1)


def gap(*arguments):
    return float(sl.critical_gap(*arguments).gap)


@given(peaks, peaks)
def test_the_three_exact_cases(one, two):
    """To the last bit: a difference, a hypotenuse, a sum."""
    assert gap(one, two, 1.0) == abs(one - two)
    assert gap(one, two, 0.0) == np.hypot(one, two)
    assert gap(one, two, -1.0) == one + two


@given(peaks, peaks, correlations)
def test_formula_everywhere_and_in_any_order(one, two, rho):
    with mpmath.workdps(40):
        p, q, r = (mpmath.mpf(x) for x in (one, two, rho))
        exact = float(mpmath.sqrt(p * p + q * q - 2 * r * p * q))
    assert gap(one, two, rho) == pytest.approx(exact, rel=2e-15)
    assert gap(two, one, rho) == gap(one, two, rho) == double_difference(one, two, rho)


def test_it_is_the_standard_deviation_of_the_difference():
    """Standard deviations for peaks, the variance of u1 - u2 by the augmented Lyapunov equation."""
    pair = [sl.Bilinear(T, 0.05) for T in (0.7, 1.0)]
    ground = sl.KanaiTajimi(0.8, 0.2)
    covariance = sl.stationary_covariance(sl.statespace(pair, ground))
    pick = covariance.sel(state=["u_1", "u_2"], state_2=["u_1", "u_2"]).values
    table = sl.correlate(*pair, ground)
    combined = gap(table.displacement_std_1, table.displacement_std_2, table.rho)
    assert combined == pytest.approx(np.sqrt([1, -1] @ pick @ [1, -1]), rel=1e-10)
