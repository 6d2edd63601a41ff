"""Shares of a variance and changes of a quantile, against functions whose shares are known."""

import numpy as np
import pytest
from scipy.special import ndtri

from stochlin.analyses.sensitivity.estimates import changed_quantiles, jackknifed, variance_shares

pytestmark = pytest.mark.oracle
TWO = 2.04  # standard errors of a 95 % interval from 32 groups


def stratified(random, samples, motions, inputs):
    """A Latin hypercube for every sample of the inputs."""
    order = [[random.permutation(motions) for _ in range(inputs)] for _ in range(samples)]
    return np.moveaxis((np.array(order) + 0.5) / motions, 1, 2)


def ishigami(share):
    x = np.pi * (2 * share - 1)
    first, second, third = np.moveaxis(x, -1, 0)
    return np.sin(first) + 7 * np.sin(second) ** 2 + 0.1 * third**4 * np.sin(first)


def test_shares_of_the_ishigami_function():
    """Ishigami and Homma (1990): the third input acts through the first alone."""
    variance = 0.5 + 7**2 / 8 + 0.1 * np.pi**4 / 5 + 0.1**2 * np.pi**8 / 18
    exact = np.array([0.5 * (1 + 0.1 * np.pi**4 / 5) ** 2, 7**2 / 8, 0.0, 0.0]) / variance
    share = stratified(np.random.default_rng(1), 4, 512, 3)
    found = variance_shares(ishigami(share), np.zeros(512), share)
    exact = np.append(exact, 1 - exact.sum())
    assert (np.abs(found.value - exact) < 3.5 * found.error).all()
    assert found.error.max() < 0.03


@pytest.mark.parametrize("motions", [128, 512])
def test_shares_of_a_product_are_unbiased_and_their_errors_hold(motions):
    """Lognormal factors, one of them that of the motion and the largest, one without effect."""
    spread, of_motion, times = np.array([0.2, 0.1, 0.0]), 0.5, 40
    all_of_it = np.expm1((spread**2).sum() + of_motion**2)
    exact = np.append(np.expm1(spread**2), np.expm1(of_motion**2)) / all_of_it
    random, found = np.random.default_rng(2), []
    for _ in range(times):
        share = stratified(random, 2, motions, 3)
        motion = np.exp(of_motion * random.standard_normal(motions))
        found.append(variance_shares(np.exp(ndtri(share) @ spread) * motion, motion, share))
    value, error = (np.array(each)[:, :4] for each in zip(*found, strict=True))
    assert (np.abs(value.mean(axis=0) - exact) < 4 * value.std(axis=0) / np.sqrt(times)).all()
    inside = (np.abs(value - exact) < TWO * error).mean(axis=0)
    assert (inside > 0.84).all()  # 95 % but three standard errors of 60 trials and skewness


def test_changes_of_a_quantile():
    """Exact where one response is a multiple of the other; else within the error of the exact one."""
    random = np.random.default_rng(3)
    response = np.exp(0.4 * random.standard_normal(512))
    of_multiple = changed_quantiles(response, 1.1 * response[None], 0.9 * response[None], 0.9)
    assert of_multiple.value[0] == pytest.approx(0.2 * np.quantile(response, 0.9), rel=1e-12)
    exact = np.exp(0.42 * ndtri(0.9)) - np.exp(0.38 * ndtri(0.9))
    inside = []
    for _ in range(40):
        normal, noise = random.standard_normal((2, 512))
        up, down = (np.exp(s * normal + 0.05 * sign * noise) for s, sign in ((0.42, 1), (0.38, -1)))
        found = changed_quantiles(np.exp(0.4 * normal), up[None], down[None], 0.9)
        inside.append(abs(found.value[0] - exact) < TWO * found.error[0])
    assert np.mean(inside) > 0.84


def test_changes_of_a_quantile_have_the_moments_of_tricube_weights():
    """Of uniform responses, the nearest quarter: 35/243 and 1/22 of its even powers.

    The second and fourth moment of the tricube kernel on -1 to 1 are known (Cleveland 1979); the local
    line through an even power has no slope, and a cube has the mean zero.
    """
    n, reach = 4096, 0.125
    response = (np.arange(n) + 0.5) / n
    beyond = response - 0.5
    more = np.array([response + beyond**power for power in (2, 4)] + [response + beyond + beyond**3])
    found = changed_quantiles(response, more, np.tile(response, (3, 1)), 0.5)
    exact = np.array([35 / 243 * reach**2, 1 / 22 * reach**4, 0.0])
    np.testing.assert_allclose(found.value, exact, rtol=4 / n / reach, atol=1e-9)


def test_a_jackknife_of_a_mean_is_its_standard_error():
    samples = np.random.default_rng(4).standard_normal(320)
    groups = np.arange(320) % 32
    found = jackknifed(lambda left: samples[groups != left].mean(), 32)
    assert found.value == samples.mean()
    assert found.error == pytest.approx(samples.std() / np.sqrt(320), rel=0.3)
    square = jackknifed(lambda left: samples[groups != left].mean() ** 2, 32, unbiased=True)
    assert square.value == pytest.approx(samples.mean() ** 2 - float(found.error) ** 2, rel=1e-9)
