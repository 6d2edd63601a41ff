"""Growth of the plastic drift: exact under steady shaking, and its differential equation."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from stochlin.kernels.probability.drift_growth import drift_variances

pytestmark = pytest.mark.oracle
HARDENING, BIAS = np.array([0.05, 0.1]), np.array([-0.3, -0.2])
RHO_BIAS = np.array([0.1])
TIMES = np.linspace(0, 20, 401)


def drifts(variance, product, relaxation):
    """Of one pair, from moments (times, 2) of both structures and their covariance (times,)."""
    variances, pace = variance.T[..., None], (HARDENING * relaxation).T[..., None]
    own, apart = drift_variances(variances, product[:, None], pace, TIMES, BIAS[:, None], RHO_BIAS)
    return own[..., 0].T, apart[:, 0]


def test_under_steady_shaking_the_drift_grows_to_the_known_size_by_an_exponential():
    """V [(1 + b)^-2 - 1], at the rate 2 * 3 alpha k_e of `docs/probability.md`."""
    ones = np.ones_like(TIMES)
    variance, relaxation = np.array([0.02, 0.03]), np.array([0.7, 0.4])
    product = 0.3 * np.sqrt(variance.prod())
    own, apart = drifts(ones[:, None] * variance, ones * product, ones[:, None] * relaxation)
    pace = 2 * 3 * HARDENING * relaxation
    grown = -np.expm1(-TIMES[:, None] * [*pace, pace.mean()])
    target = variance * ((1 + BIAS) ** -2 - 1)
    np.testing.assert_allclose(own, target * grown[:, :2], rtol=1e-12)
    # The true correlation is the linearized one less its bias, that of the true displacements.
    shared = (0.3 - 0.1) * np.sqrt(variance.prod()) / np.prod(1 + BIAS) - product
    np.testing.assert_allclose(apart, (target * grown[:, :2]).sum(axis=1) - 2 * shared * grown[:, 2])


def test_the_drift_follows_its_differential_equation_and_remains_after_yielding():
    def shaking(t):
        return np.exp(-(((t - 6) / 3) ** 2))

    def relaxation(t):
        return np.where(t < 12, 1.5 * np.sin(np.pi * t / 12) ** 2, 0.0)

    variance = shaking(TIMES)[:, None] * [0.02, 0.03]
    both = np.stack([relaxation(TIMES)] * 2, axis=1)
    own, _ = drifts(variance, 0.3 * np.sqrt(variance.prod(axis=1)), both)
    size = np.array([0.02, 0.03]) * ((1 + BIAS) ** -2 - 1)
    exact = solve_ivp(
        lambda t, x: 6 * HARDENING * relaxation(t) * (size * shaking(t) - x),
        (0, TIMES[-1]),
        np.zeros(2),
        t_eval=TIMES,
        rtol=1e-9,
        atol=1e-12,
        max_step=0.1,
    )
    # The steps are of second order: a twentieth of a second of the three that the shaking takes to rise.
    np.testing.assert_allclose(own, exact.y.T, atol=1e-3 * size.max())
    np.testing.assert_allclose(own[TIMES >= 12], own[[-1]].repeat(161, axis=0), rtol=1e-12)
    assert (own[-1] > 0.1 * size).all()
