"""Correlation of structures that were solved one by one, with its errors, for many pairs.

The functions of two structures take and return arrays. Large tables call the same functions compiled
for numbers, pair by pair; see `on_numbers`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array, on_arrays
from stochlin.kernels.basics.elementary import choose
from stochlin.kernels.basics.slabs import in_ranges
from stochlin.kernels.correlation.errors import (
    OF_NEARLY_EQUAL,
    OF_OTHERS,
    bias_of_difference,
    error_of_difference,
    std_of_difference,
)
from stochlin.kernels.correlation.nearness import Nearness, by_nearness
from stochlin.kernels.correlation.signatures import Signature, by_signatures
from stochlin.kernels.linearization.covariance import EquivalentSystem, Forcing, pair_covariance
from stochlin.kernels.linearization.drift import DriftingSide, drifting_correlation

EQUAL = 1e-12  # difference of two correlations that is a rounding error
ROUNDING = 1e-9  # by which |rho| may exceed 1 by rounding; beyond it the covariance is invalid
# Logarithm of the ratio of the periods from which the margin of eq. (13) counts in the caution. Of pairs
# with more similar periods, the difference comes from strength, hardening and damping alone, and its
# estimate is less certain.
ALIKE = 0.015
CELLS = 8192  # pairs that are computed together
NONE = np.full(4, np.nan)  # unknown errors
MANY = 200_000  # pairs from which it is worth to wait for the compiler, once on each machine


class Linear(NamedTuple):
    """Structures by linearization."""

    system: EquivalentSystem
    forcing: Forcing
    std: Array


class Drifting(NamedTuple):
    """Structures by the drift closure, with the corrections by simulations."""

    side: DriftingSide
    std: Array  # corrected
    error: Array  # its expected relative error
    strength_class: Array  # number of BOUNDS of `errors` up to its R/p
    period: Array  # its logarithm
    known: Array  # whether the structure and the ground are within the simulated ranges
    elastic: Array
    signature: Signature
    nearness: Nearness


class Compared(NamedTuple):
    """Structures by linearization, and by the drift closure."""

    linear: Linear
    bias: Array  # of the standard deviation
    true: Drifting


class LinearPair(NamedTuple):
    """Results for two structures `Linear` or `DriftingSide`."""

    rho: Array


class DriftingPair(NamedTuple):
    """Results for two structures `Drifting`."""

    rho: Array
    difference: Array  # standard deviation of u_1 - u_2
    error: Array  # expected error of rho
    difference_error: Array  # expected relative error
    difference_bias: Array
    counted: Array  # the error of the difference that counts in its caution


class ComparedPair(NamedTuple):
    """Results for two structures `Compared`."""

    rho: Array
    difference: Array
    bias: Array  # of rho
    error: Array  # expected error of the bias
    difference_bias: Array


def linear_pair(first: Linear, second: Linear, errors: Array) -> LinearPair:
    """The correlation by linearization."""
    joint = pair_covariance(first.system, first.forcing, second.system, second.forcing)
    return LinearPair(_bounded(joint / (first.std * second.std)))


def drifting_pair(first: Drifting, second: Drifting, errors: Array) -> DriftingPair:
    """The correlation by the drift closure; ``errors`` are those of ``rho`` on this ground.

    The caution of ``u_1 - u_2`` is that of its error less half of the bias to the safe side, if the
    periods differ. Its error is 0 if both structures are elastic.
    """
    rho, error, rest, share = _drifting(first, second, errors)
    apart, lean = error_of_difference(first.std, first.error, second.std, second.error, rho, rest, share)
    apart = choose(error == 0, 0.0, apart + 0 * error)
    lean = lean + 0 * apart
    unlike = np.abs(first.period - second.period) >= ALIKE
    counted = apart - choose(unlike, lean / 2, 0.0)
    return DriftingPair(rho, std_of_difference(first.std, second.std, rho), error, apart, lean, counted)


def compared_pair(first: Compared, second: Compared, errors: Array) -> ComparedPair:
    """The correlation by linearization with its bias; the truth of two elastic structures is itself."""
    stds = first.linear.std, second.linear.std
    (rho,) = linear_pair(first.linear, second.linear, errors)
    true, error, _, _ = _drifting(first.true, second.true, errors)
    elastic = first.true.elastic & second.true.elastic
    bias = choose(elastic | (np.abs(rho - true) < EQUAL), 0.0, rho - true) + 0 * (rho + error)
    difference = std_of_difference(*stds, rho)
    off = bias_of_difference(difference, *stds, first.bias, second.bias, rho, bias)
    return ComparedPair(rho, difference, bias, error + 0 * bias, off)


def _drifting(first: Drifting, second: Drifting, errors: Array) -> tuple[Array, ...]:
    """``rho``, the expected error of it and of ``1 - rho``, and the weight of eq. (13)."""
    rho = by_signatures(drifting_correlation(first.side, second.side), first.signature, second.signature)
    unseen = first.signature.left * second.signature.left
    rho, share = by_nearness(rho, first.nearness, second.nearness, unseen)
    weaker = np.minimum(first.strength_class, second.strength_class)
    rest = share * OF_NEARLY_EQUAL[weaker] + (1 - share) * OF_OTHERS * np.maximum(rho, 0.0)
    error = choose(first.known & second.known, errors[weaker], np.nan)
    rho = _bounded(rho)
    return rho, choose(first.elastic & second.elastic, 0.0, error) + 0 * rho, rest, share


def _bounded(rho: Array) -> Array:
    """``rho`` within -1 and 1; NaN where it is beyond by more than rounding."""
    return choose(np.abs(rho) <= 1 + ROUNDING, np.minimum(np.maximum(rho, -1.0), 1.0), np.nan)


def drifting_rho(first: DriftingSide, second: DriftingSide, errors: Array) -> LinearPair:
    """The derived correlation of two structures with drift."""
    return LinearPair(drifting_correlation(first, second))


# By the kind of both structures: function, and kind of its results.
PAIRS: dict[type[Any], tuple[Callable[[Any, Any, Array], Any], Any]] = {
    Linear: (linear_pair, LinearPair),
    Drifting: (drifting_pair, DriftingPair),
    Compared: (compared_pair, ComparedPair),
    DriftingSide: (drifting_rho, LinearPair),
}


def results(first: Any, second: Any, errors: Array) -> Any:
    """Results for structures of one kind."""
    return PAIRS[type(first)][0](first, second, errors)


def cell(structures: Any, place: Any) -> Any:
    """Some of the structures; one of them by numbers in compiled code."""
    return on_arrays(lambda x: np.take(x, place, axis=-1), structures)


def over_pairs(first: Any, second: Any, places: Sequence[Array], errors: Array = NONE) -> Any:
    """Results of the function in `PAIRS` for pairs of structures by their places, two arrays (n,)."""
    kind, count = PAIRS[type(first)][1], places[0].size
    out, write = np.empty((len(kind._fields), count)), None
    if count >= MANY:
        from stochlin.kernels.correlation.on_numbers import WRITERS

        write = WRITERS.get(type(first))
        first, second = (on_arrays(np.asfortranarray, each) for each in (first, second))

    @np.errstate(all="ignore")  # pairs with extreme parameters are NaN
    def part(cells: slice) -> None:
        at_1, at_2 = (each[cells] for each in places)
        if write:
            write(first, second, at_1, at_2, errors, out[:, cells])
        else:
            out[:, cells] = results(cell(first, at_1), cell(second, at_2), errors)

    in_ranges(part, count, CELLS)
    return kind(*out)
