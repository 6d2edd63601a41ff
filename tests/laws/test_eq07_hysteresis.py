"""Eqs. (7), (9), (10): the bilinear law and Gaussian coefficients; the Bouc-Wen law beside it."""

import cases
import mpmath
import numpy as np
import pytest

from stochlin.models.laws import bilinear, bouc_wen

pytestmark = pytest.mark.paper


def coefficients(law, latent, *parameters):
    """``(c_e, k_e)`` of one cell."""
    column = np.array(latent, dtype=float)[:, None]
    value = law(column, np.array(parameters, dtype=float).reshape(-1, 1))
    slip, k_e = value.coefficients[:, 0]
    return slip - 1, k_e


def random_latent(count, seed):
    """Moments with z from far below yield to far beyond, and correlations up to 0.99."""
    rng = np.random.default_rng(seed)
    return np.stack(
        [
            cases.log_uniform(rng, (0.05, 20.0), count),
            cases.log_uniform(rng, (0.2, 5.0), count),
            np.tanh(rng.uniform(-2.6, 2.6, count)),
        ],
        axis=1,
    )


def test_bilinear_coefficients_agree_with_quadrature():
    for latent in random_latent(150, seed=7):
        sv, sz, r = latent
        slip = cases.slip_moments(cases.beyond_yield, latent, edges=(1,))
        expected = cases.regressed(slip, sv * sv, sz * sz, r * sv * sz)
        c_e, k_e = coefficients(bilinear.gaussian, latent)
        # The regression divides by 1 - r^2: that much of the quadrature's accuracy is lost.
        tolerance = 1e-11 / (1 - r * r)
        np.testing.assert_allclose([1 + c_e, k_e], expected, rtol=1e-10, atol=tolerance)


@pytest.mark.parametrize("exponent", [1, 1.5, 2, 3, 5])
def test_bouc_wen_coefficients_agree_with_quadrature(exponent):
    rng = np.random.default_rng(int(10 * exponent))
    for latent in random_latent(40, seed=8):
        beta = rng.uniform(0.1, 1)
        gamma = rng.uniform(-beta, beta)
        sv, sz, r = latent

        def share(z, beta=beta, gamma=gamma):
            return beta * np.abs(z) ** (exponent - 1) * z + gamma * np.abs(z) ** exponent

        slip = cases.slip_moments(share, latent)
        expected = cases.regressed(slip, sv * sv, sz * sz, r * sv * sz)
        c_e, k_e = coefficients(bouc_wen.gaussian, latent, beta, gamma, exponent)
        scale = np.array([1, sv / sz]) * sz**exponent / (1 - r * r)
        np.testing.assert_array_less(np.abs([1 + c_e, k_e] - expected), 1e-10 * scale)


def test_far_below_yield_the_tail_keeps_its_relative_accuracy():
    """Slip of 1e-30 is right to a dozen digits, where ``1 + c_e`` by subtraction would be zero."""
    for sz, r in ((0.15, 0.2), (0.1, 0.6), (0.09, 0.05)):
        value = bilinear.gaussian(np.array([[1.0], [sz], [r]]), np.empty((0, 1)))
        with mpmath.workdps(40):
            h, a = 1 / mpmath.mpf(sz), mpmath.mpf(r) / mpmath.sqrt(1 - mpmath.mpf(r) ** 2)
            tail = mpmath.quad(
                lambda t, a=a: mpmath.npdf(t) * mpmath.ncdf(a * t), [h, h + 1, h + 10]
            )
        assert value.coefficients[0, 0] == pytest.approx(float(2 * tail), rel=1e-12)
