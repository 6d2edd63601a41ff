"""The clipped closure against numerical integration."""

from itertools import pairwise

import cases
import numpy as np
import pytest
from scipy.integrate import quad

from stochlin.kernels.linearization import gaussian
from stochlin.kernels.linearization.balance import functions_of, interpolated

pytestmark = [pytest.mark.oracle, pytest.mark.extreme]

TAU = 2 * np.pi
NONE = np.empty((0, 1))


def clip(z):
    return np.clip(z, -1.0, 1.0)


def random_latent(count, seed):
    rng = np.random.default_rng(seed)
    sz = cases.log_uniform(rng, (0.25, 6.0), count)
    return np.stack(
        [cases.log_uniform(rng, (0.1, 10.0), count), sz, np.tanh(rng.uniform(-2, 2, count))], axis=1
    )


def clipped_moments(sv, sz, r):
    """``Var v, Var z, Cov(v, z)`` of ``z = clip(z~)``, by integration over ``t = z~/sz``."""

    def average(function):
        borders = np.unique([-cases.REACH, *np.clip([-1 / sz, 0, 1 / sz], -12, 12), cases.REACH])
        weighted = lambda t: function(t) * np.exp(-t * t / 2)  # noqa: E731
        accuracy = {"epsabs": 1e-15, "epsrel": 1e-12}
        return sum(quad(weighted, a, b, **accuracy)[0] for a, b in pairwise(borders)) / np.sqrt(TAU)

    return (
        sv * sv,
        average(lambda t: clip(sz * t) ** 2),
        average(lambda t: r * sv * t * clip(sz * t)),
    )


def integrated_clipped(latent):
    """Second moments and regressed coefficients of the clipped density."""
    moments = clipped_moments(*latent)
    slip = cases.slip_moments(cases.beyond_yield, latent, edges=(1,), seen=clip)
    return np.array(moments), cases.regressed(slip, *moments)


def test_clipped_moments_and_regression_agree_with_integration():
    for latent in random_latent(80, seed=50):
        value = gaussian.clipped(latent[:, None], NONE)
        moments, coefficients = integrated_clipped(latent)
        np.testing.assert_allclose(value.covariance[:, 0], moments, rtol=1e-11, atol=1e-13)
        # The regression divides by the share of Var z that v leaves unexplained.
        left = 1 - moments[2] ** 2 / (moments[0] * moments[1])
        np.testing.assert_allclose(
            value.coefficients[:, 0], coefficients, rtol=1e-10 / left, atol=1e-12
        )


@pytest.mark.parametrize("closure", [gaussian.gaussian, gaussian.clipped])
def test_functions_of_one_number_are_those_of_the_closure(closure):
    """For any velocity, and so that ``E[z z'] = 0``."""
    rng = np.random.default_rng(51)
    place = np.log(cases.log_uniform(rng, (0.25, 30.0), 80))
    sv = cases.log_uniform(rng, (1e-3, 1e3), 80)
    (slip, relaxation, z_z, correlated), _ = interpolated(functions_of(closure), place)
    value = closure(np.array([sv, np.exp(place), np.tanh(correlated)]), NONE)
    expected = np.exp([slip, relaxation + np.log(sv)])
    np.testing.assert_allclose(value.coefficients, expected, rtol=1e-9)
    np.testing.assert_allclose(value.covariance[1], np.exp(z_z), rtol=1e-12)
    _, variance, covariance = value.covariance
    kept = (1 - value.coefficients[0]) * covariance
    np.testing.assert_allclose(kept, value.coefficients[1] * variance, rtol=1e-8)
