"""A pair by numbers alone is that of tables."""

import numpy as np
import pytest

import stochlin as sl
from stochlin.kernels.correlation.bilinear_pair import linearized_pair

GROUNDS = (
    (sl.WhiteNoise(0.01), (0.01,)),
    (sl.KanaiTajimi(2.0, 0.3, 0.01), (0.01, 2.0, 0.3)),
    (sl.CloughPenzien(2.0, 0.3, 20.0, 0.6, 0.01), (0.01, 2.0, 0.3, 20.0, 0.6)),
)


@pytest.mark.filterwarnings("ignore::stochlin.messages.DoubtfulInput")  # hardly yields
@pytest.mark.oracle
@pytest.mark.parametrize(("ground", "numbers"), GROUNDS)
def test_a_pair_of_numbers_is_that_of_correlate(ground, numbers):
    """Owen's function of numbers is a quadrature, and that of tables is scipy's."""
    pairs = [
        ((1.0, 0.05, 0.05, 0.02), (0.7, 0.05, 0.1, 0.01)),
        ((0.2, 0.02, 0.5, 1e3), (3.0, 0.1, 0.02, 1e-3)),
    ]
    for first, second in pairs:
        table = sl.correlate(sl.Bilinear(*first), sl.Bilinear(*second), ground, bias=False)
        pair = linearized_pair(first, second, numbers)
        expected = [float(table[name]) for name in pair._fields]
        assert pair == pytest.approx(expected, rel=1e-11)


@pytest.mark.invariant
def test_a_pair_of_numbers_that_does_not_converge_is_nan():
    pair = linearized_pair((1.0, 0.05, 0.05, 1e-30), (0.7, 0.05, 0.05, 0.01), (0.01,))
    assert np.isnan([pair.rho, pair.displacement_std_1]).all()
    assert pair.displacement_std_2 > 0


@pytest.mark.parametrize("wrong", [np.nan, np.inf, 0.0])
def test_a_pair_of_numbers_that_are_none_is_nan(wrong):
    first = 1.0, 0.05, 0.05, wrong
    pair = linearized_pair(first, (0.7, 0.05, 0.05, 0.01), (0.01, 2.0, 0.3))
    assert np.isnan([pair.rho, pair.displacement_std_1]).all()
    assert pair.displacement_std_2 > 0
