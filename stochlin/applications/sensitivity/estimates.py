"""Estimates of changes of a quantile from common motions, with their errors."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array

GROUPS = 32  # groups of motions for the jackknife, each of which is left out once
NEAR = 0.25  # share of the motions, with responses nearest to the quantile, in the local regression


class Estimate(NamedTuple):
    """Estimates and their standard errors."""

    value: Array
    error: Array


def jackknifed(estimate: Callable[[int], Array], groups: int) -> Estimate:
    """An estimate from all motions, with its standard error by the jackknife.

    ``estimate`` is a function of the group of motions that is left out, -1 for none.
    """
    parts = np.array([estimate(left) for left in range(groups)])
    error: Array = np.sqrt((groups - 1) * parts.var(axis=0))
    return Estimate(estimate(-1), error)


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
