"""Changes of a quantile, against distributions whose quantiles are known."""

import numpy as np
import pytest
from scipy.special import ndtri

from stochlin.applications.sensitivity.sensitivity import changed_quantiles

pytestmark = pytest.mark.oracle
TWO = 2.04  # standard errors of a 95 % interval from 32 groups


def test_changes_of_a_quantile():
    """Exact where one response is a multiple of the other, else within the exact one's error."""
    random = np.random.default_rng(3)
    response = np.exp(0.4 * random.standard_normal(512))
    of_multiple = changed_quantiles(response, 1.1 * response[None], 0.9)
    assert of_multiple[0][0] == pytest.approx(0.1 * np.quantile(response, 0.9), rel=1e-12)
    exact = np.exp(0.42 * ndtri(0.9)) - np.exp(0.38 * ndtri(0.9))
    inside = []
    for _ in range(40):
        normal, noise = random.standard_normal((2, 512))
        up, down = (np.exp(s * normal + 0.05 * sign * noise) for s, sign in ((0.42, 1), (0.38, -1)))
        found = changed_quantiles(down, up[None], 0.9)
        inside.append(abs(found[0][0] - exact) < TWO * found[1][0])
    assert np.mean(inside) > 0.84


def test_changes_of_a_quantile_have_the_moments_of_tricube_weights():
    """Of uniform responses, the nearest quarter: 35/243 and 1/22 of its even powers.

    The second and fourth moment of the tricube kernel on -1 to 1 are known (Cleveland 1979); the
    local line through an even power has no slope, and a cube has the mean zero.
    """
    n, reach = 4096, 0.125
    response = (np.arange(n) + 0.5) / n
    beyond = response - 0.5
    more = np.array(
        [response + beyond**power for power in (2, 4)] + [response + beyond + beyond**3]
    )
    found = changed_quantiles(response, more, 0.5)
    exact = np.array([35 / 243 * reach**2, 1 / 22 * reach**4, 0.0])
    np.testing.assert_allclose(found[0], exact, rtol=4 / n / reach, atol=1e-9)
