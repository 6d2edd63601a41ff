"""Estimates of variance shares and of changes of a quantile from common motions, with their errors."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array

GROUPS = 32  # groups of motions for the jackknife, each of which is left out once
DEGREE = 8  # highest degree of the polynomials in the probability of an input
FEW = 8  # smallest number of motions for each coefficient
NEAR = 0.25  # share of the motions, with responses nearest to the quantile, in the local regression


class Estimate(NamedTuple):
    """Estimates and their standard errors."""

    value: Array
    error: Array


def jackknifed(estimate: Callable[[int], Array], groups: int, unbiased: bool = False) -> Estimate:
    """An estimate from all motions, with its standard error by the jackknife.

    ``estimate`` is a function of the group of motions that is left out, -1 for none. ``unbiased``
    subtracts the jackknife estimate of the bias (Quenouille 1956).
    """
    whole = estimate(-1)
    parts = np.array([estimate(left) for left in range(groups)])
    value = groups * whole - (groups - 1) * parts.mean(axis=0) if unbiased else whole
    error: Array = np.sqrt((groups - 1) * parts.var(axis=0))
    return Estimate(value, error)


def variance_shares(response: Array, usual: Array, shares: Array) -> Estimate:
    """First-order Sobol indices of each input and of the motion, followed by the interaction share.

    Parameters
    ----------
    response : (samples, motions)
        Responses to the same motions with several independent samples of the inputs.
    usual : (motions,)
        Responses with all inputs at their medians.
    shares : (samples, motions, inputs)
        Cumulative probability of each sample of an input, uniform between 0 and 1.

    Notes
    -----
    The index is ``Var(E[Y | x])/Var(Y)``. The conditional mean is a least-squares polynomial in the
    cumulative probability (estimates from given data, Plischke, Borgonovo and Smith 2013). The response
    to the same motion at the medians is a further regressor, which reduces the noise since it depends on
    no input. The index of the motion is the covariance of two responses to it (Sobol 1993).
    """
    samples, motions, inputs = shares.shape
    degree = int(np.clip(samples * motions // (FEW * inputs), 1, DEGREE))
    basis = _legendre(shares, degree).reshape(samples, motions, inputs * degree)
    ones = np.ones_like(response)[..., None]
    columns = np.concatenate([ones, usual[:, None] * ones, basis, response[..., None]], axis=2)
    groups = min(GROUPS, motions)
    apart = [columns[:, left::groups].reshape(-1, columns.shape[2]) for left in range(groups)]
    products = np.array([np.einsum("ni,nj->ij", own, own) for own in apart])
    squares = np.array([(response[:, n::groups].sum(axis=0) ** 2).sum() for n in range(groups)])

    def estimate(left: int) -> Array:
        kept = np.arange(groups) != left
        sums, square = products[kept].sum(axis=0), squares[kept].sum()
        count, mean = sums[0, 0], sums[0] / sums[0, 0]
        moments = (sums / count - np.outer(mean, mean))[1:, 1:]
        variance = moments[-1, -1]
        coefficients = np.linalg.lstsq(moments[:-1, :-1], moments[:-1, -1], rcond=None)[0]
        own = coefficients[1:].reshape(inputs, degree)
        each = moments[1:-1, 1:-1].reshape(inputs, degree, inputs, degree)
        of_inputs = np.einsum("ij,ijik,ik->i", own, each, own)
        of_motion = (square - sums[-1, -1]) / (count * (samples - 1)) - mean[-1] ** 2
        parts = np.append(of_inputs, of_motion) / variance
        return np.append(parts, 1 - parts.sum())

    return jackknifed(estimate, groups, unbiased=True)


def changed_quantiles(response: Array, more: Array, less: Array, level: float) -> Estimate:
    """Quantiles of responses ``more`` minus those of ``less`` (k, motions), in the same motions (k,).

    The differences of the sorted responses are interpolated at the quantile by a local linear regression
    over ``response`` (Cleveland 1979). This has less noise than the difference of two quantiles, and is
    exact if the responses are multiples of each other.
    """
    number = np.arange(response.size)
    groups = min(GROUPS, response.size)

    def estimate(left: int) -> Array:
        kept = number % groups != left
        y = np.sort(response[kept])
        changes = np.sort(more[:, kept], axis=1) - np.sort(less[:, kept], axis=1)
        beyond = y - np.quantile(y, level)
        far = np.abs(beyond)
        width = np.sort(far)[int(np.ceil(NEAR * y.size)) - 1] or 1.0
        weight = np.clip(1 - (far / width) ** 3, 0, None) ** 3
        weight /= weight.sum()
        mean = (weight * beyond).sum()
        spread = (weight * (beyond - mean) ** 2).sum() or 1.0
        estimates: Array = (changes * (weight * (1 - (beyond - mean) * mean / spread))).sum(axis=1)
        return estimates

    return jackknifed(estimate, groups)


def _legendre(shares: Array, degree: int) -> Array:
    """Legendre polynomials, orthonormal for a uniform distribution in 0 to 1 (..., inputs, degree)."""
    orders = np.arange(1, degree + 1)
    basis: Array = np.polynomial.legendre.legvander(2 * shares - 1, degree)[..., 1:]
    return basis * np.sqrt(2 * orders + 1)
