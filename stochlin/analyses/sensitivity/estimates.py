"""Shares of a variance and changes of a quantile from the same motions, with their errors."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array

GROUPS = 32  # of motions, each of which is left out once
DEGREE = 8  # of polynomials in the share of values below
FEW = 8  # motions for each coefficient, at least
NEAR = 0.25  # share of the motions that tell of a quantile: those of the nearest responses


class Estimate(NamedTuple):
    """Estimates, and their standard errors."""

    value: Array
    error: Array


def jackknifed(estimate: Callable[[int], Array], groups: int, unbiased: bool = False) -> Estimate:
    """An estimate without a group of motions, -1 for none: of all, and its error by leaving out each.

    ``unbiased`` takes off what chance adds to squares (Quenouille 1956).
    """
    whole = estimate(-1)
    parts = np.array([estimate(left) for left in range(groups)])
    value = groups * whole - (groups - 1) * parts.mean(axis=0) if unbiased else whole
    error: Array = np.sqrt((groups - 1) * parts.var(axis=0))
    return Estimate(value, error)


def variance_shares(response: Array, usual: Array, shares: Array) -> Estimate:
    """First-order Sobol indices: of each input, then of the motion, then of what is left.

    Parameters
    ----------
    response : (samples, motions)
        The same motions with several independent samples of the inputs.
    usual : (motions,)
        The response with all inputs at their medians.
    shares : (samples, motions, inputs)
        Of each input, the share of all its values that lie below: evenly between 0 and 1.

    Notes
    -----
    ``Var(E[Y | x])/Var(Y)``. The conditional mean is a polynomial by least squares (given-data
    estimates: Plischke, Borgonovo and Smith 2013). The response to the same motion at the medians stands
    beside the polynomials: it depends on no input, and would be noise. The motion's own index is the
    covariance of two responses to it (Sobol 1993).
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
        found = np.linalg.lstsq(moments[:-1, :-1], moments[:-1, -1], rcond=None)[0]
        own = found[1:].reshape(inputs, degree)
        each = moments[1:-1, 1:-1].reshape(inputs, degree, inputs, degree)
        of_inputs = np.einsum("ij,ijik,ik->i", own, each, own)
        of_motion = (square - sums[-1, -1]) / (count * (samples - 1)) - mean[-1] ** 2
        parts = np.append(of_inputs, of_motion) / variance
        return np.append(parts, 1 - parts.sum())

    return jackknifed(estimate, groups, unbiased=True)


def changed_quantiles(response: Array, more: Array, less: Array, level: float) -> Estimate:
    """Quantiles of responses less those of others (k, motions), all to the same motions (k,).

    The ordered differences, by a straight line through those where the response itself is nearest to its
    quantile (Cleveland 1979): less noise than two quantiles have, and exact where the responses are
    multiples of each other.
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
        found: Array = (changes * (weight * (1 - (beyond - mean) * mean / spread))).sum(axis=1)
        return found

    return jackknifed(estimate, groups)


def _legendre(shares: Array, degree: int) -> Array:
    """Legendre polynomials of an even distribution between 0 and 1 (..., inputs, degree)."""
    orders = np.arange(1, degree + 1)
    basis: Array = np.polynomial.legendre.legvander(2 * shares - 1, degree)[..., 1:]
    return basis * np.sqrt(2 * orders + 1)
