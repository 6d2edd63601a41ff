"""Eq. (4): exact for two linear oscillators under one white noise, for which it was derived."""

import cases
import numpy as np
import pytest

import stochlin as sl

pytestmark = pytest.mark.paper

PAIRS = 500


def random_pairs():
    rng = np.random.default_rng(4)
    periods = cases.log_uniform(rng, (0.05, 10.0), (2, PAIRS))
    dampings = cases.log_uniform(rng, (0.005, 0.5), (2, PAIRS))
    return periods, dampings


def covariances(periods, dampings):
    for period, damping in zip(periods.T, dampings.T, strict=True):
        w = 2 * np.pi / period
        pair = [
            (frequency**2, 2 * xi * frequency) for frequency, xi in zip(w, damping, strict=True)
        ]
        yield cases.lyapunov(cases.augmented_system(pair), 0.7)


@pytest.mark.parametrize(
    ("ratio", "rho"), [(0.5, 0.018486), (0.8, 0.165635), (0.9, 0.473028), (0.95, 0.791406)]
)
def test_known_values_at_five_per_cent_damping(ratio, rho):
    # Known to the six digits printed: half a unit of the last one.
    assert float(sl.rho_white_noise(ratio, 1.0, 0.05, 0.05).rho) == pytest.approx(rho, abs=5e-7)


def test_formula_is_the_exact_solution_of_the_lyapunov_equation():
    periods, dampings = random_pairs()
    rho = sl.rho_white_noise(*periods, *dampings).rho.values
    exact = [x[0, 2] / np.sqrt(x[0, 0] * x[2, 2]) for x in covariances(periods, dampings)]
    # The Lyapunov solver works to some 1e-13 of the variances over this domain.
    np.testing.assert_allclose(rho, exact, rtol=0, atol=1e-12)


def test_correlate_reaches_eq_4_by_method_and_by_ground():
    periods, dampings = random_pairs()
    pair = [sl.Bilinear(period=t, damping=xi) for t, xi in zip(periods, dampings, strict=True)]
    formula = sl.rho_white_noise(*periods, *dampings).rho
    ground = sl.KanaiTajimi(period=1.0, damping=0.1)
    by_method = sl.correlate(*pair, ground, method="white_noise").rho
    by_ground = sl.correlate(*pair, sl.WhiteNoise(0.3)).rho
    np.testing.assert_array_equal(by_method, formula)
    np.testing.assert_allclose(by_ground, formula, rtol=0, atol=1e-12)  # another road: elimination
