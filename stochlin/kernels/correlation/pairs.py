"""Correlation of structures that were solved one by one, with its errors, for many pairs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array, on_arrays, where_finite
from stochlin.kernels.basics.slabs import in_slabs
from stochlin.kernels.correlation.corrections import Nearness, Signature, by_nearness, by_signatures
from stochlin.kernels.correlation.errors import (
    ERROR_OF_OTHERS,
    ERRORS_OF_NEARLY_EQUAL,
    ROUNDING_OF_DIFFERENCES,
    bias_of_difference,
    error_of_difference,
    std_of_difference,
)
from stochlin.kernels.linearization.covariance import Motion, pair_covariance
from stochlin.kernels.linearization.drift import DriftingSide, drifting_correlation

EQUAL_CORRELATIONS = 1e-12  # difference of two correlations that is a rounding error
# by which |rho| may exceed 1 by rounding; beyond it the covariance is invalid
ROUNDING_OF_CORRELATION = 1e-9
# Logarithm of the ratio of the periods from which the margin of eq. (13) counts in the caution. Of
# pairs with more similar periods, the difference comes from strength, hardening and damping alone,
# and its estimate is less certain.
DISTINCT_PERIODS = 0.015


class Linear(NamedTuple):
    """Structures by linearization."""

    motion: Motion
    variance: Array  # covariance of the displacement with itself by `pair_covariance`
    std: Array

    @classmethod
    @np.errstate(all="ignore")  # failed structures are NaN
    def of(cls, motion: Motion, std: Array) -> Linear:
        """Structures with this motion and this standard deviation of the displacement."""
        return cls(motion, pair_covariance(motion, motion), std)


class Drifting(NamedTuple):
    """Structures by the drift closure, with the corrections by simulations."""

    side: DriftingSide
    std: Array  # corrected
    error: Array  # its expected relative error
    strength_class: Array  # number of BOUNDS of `errors` up to its R/p
    period: Array  # its logarithm
    covered: Array  # whether the structure and the ground are within the simulated ranges
    elastic: Array
    signature: Signature
    nearness: Nearness


class Compared(NamedTuple):
    """Structures by linearization, and by the drift closure."""

    linear: Linear
    bias: Array  # of the standard deviation
    true: Drifting


def linear_pair(first: Linear, second: Linear) -> Array:
    """The correlation by linearization."""
    joint = pair_covariance(first.motion, second.motion)
    return _bounded(joint / np.sqrt(first.variance * second.variance))


def drifting_pair(errors: Array, first: Drifting, second: Drifting) -> tuple[Array, ...]:
    """The correlation by the drift closure; ``errors`` are those of ``rho`` on this ground.

    The results are ``rho`` and its expected error, the standard deviation of ``u_1 - u_2`` with its
    expected relative error and its bias, and the error of the deviation that counts in its caution.
    This is less half of the bias to the safe side, if the periods differ. The error is 0 if both
    structures are elastic.
    """
    rho, error, rest, share = _drifting(errors, first, second)
    apart, lean = error_of_difference(
        first.std, first.error, second.std, second.error, rho, rest, share
    )
    apart = np.where(error == 0, 0.0, where_finite(apart, error))
    lean = where_finite(lean, apart)
    unlike = np.abs(first.period - second.period) >= DISTINCT_PERIODS
    counted = apart - np.where(unlike, lean / 2, 0.0)
    return rho, error, std_of_difference(first.std, second.std, rho), apart, lean, counted


def compared_pair(errors: Array, first: Compared, second: Compared) -> tuple[Array, ...]:
    """Correlation by linearization with its bias; the truth of two elastic structures is itself.

    The results are ``rho``, its bias and the expected error of that, and the standard deviation of
    ``u_1 - u_2`` with its bias.
    """
    stds = first.linear.std, second.linear.std
    rho = linear_pair(first.linear, second.linear)
    true, error, _, _ = _drifting(errors, first.true, second.true)
    elastic = first.true.elastic & second.true.elastic
    bias = np.where(elastic | (np.abs(rho - true) < EQUAL_CORRELATIONS), 0.0, rho - true)
    bias = where_finite(bias, rho, error)
    difference = std_of_difference(*stds, rho)
    off = bias_of_difference(difference, *stds, first.bias, second.bias, rho, bias)
    return rho, bias, where_finite(error, bias), difference, off


def _drifting(errors: Array, first: Drifting, second: Drifting) -> tuple[Array, ...]:
    """``rho``, the expected error of it and of ``1 - rho``, and the weight of eq. (13)."""
    rho = by_signatures(
        drifting_correlation(first.side, second.side), first.signature, second.signature
    )
    unseen = first.signature.left * second.signature.left
    rho, share = by_nearness(rho, first.nearness, second.nearness, unseen)
    weaker = np.minimum(first.strength_class, second.strength_class)
    positive = np.maximum(rho, 0.0)
    rest = share * ERRORS_OF_NEARLY_EQUAL[weaker] + (1 - share) * ERROR_OF_OTHERS * positive
    error = np.where(first.covered & second.covered, errors[weaker], np.nan)
    rho = _bounded(rho)
    error = np.where(first.elastic & second.elastic, 0.0, error)
    return rho, where_finite(error, rho), rest, share


def _bounded(rho: Array) -> Array:
    """``rho`` from -1 to 1, where it is so but for rounding errors, and otherwise NaN."""
    bounded = np.where(1 - rho < ROUNDING_OF_DIFFERENCES, 1.0, np.maximum(rho, -1.0))
    return np.where(np.abs(rho) <= 1 + ROUNDING_OF_CORRELATION, bounded, np.nan)


@np.errstate(all="ignore")  # pairs with extreme parameters are NaN
def over_pairs(
    function: Callable[[Any, Any], Any],
    first: Any,
    second: Any,
    places: Sequence[Array],
    results: int = 1,
) -> tuple[Array, ...]:
    """The ``results`` of a function of two structures, for pairs by their places.

    The places are two arrays of whole numbers, which broadcast: structures of a table of all
    combinations are read once for its rows and once for its columns.
    """

    def of_places(at_1: Array, at_2: Array) -> Any:
        return function(taken(first, at_1), taken(second, at_2))

    return in_slabs(of_places, *places, kinds=(float,) * results)


def taken(structures: Any, places: Array) -> Any:
    """The structures at these places."""
    return on_arrays(lambda row: row.take(places, -1), structures)
