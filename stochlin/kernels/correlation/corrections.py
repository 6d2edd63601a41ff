"""Corrections of the correlation by drift, from simulations: signatures and nearness.

Signatures: the displacements of a few reference structures on the same ground span a space of
random variables. The *signature* of a structure is the vector of coordinates of its displacement,
over the standard deviation, in an orthonormal basis of this space; the basis follows from the
Cholesky factor of the correlations of the references. The correlation of two structures is the
scalar product of their signatures, plus a part that is independent of the references. These are
eqs. (9) to (11) of ``docs/drift.md``.

Nearness: for two structures that differ little, ``1 - rho`` is a small difference of large numbers
in any theory of their covariance, but it can be simulated directly. By eq. (12), ``1 - rho = q/(1 +
q)``, where ``q`` is a quadratic form in the differences of the logarithms of period, strength,
hardening and damping. Its matrix belongs to one structure. Eq. (13) combines this with the
correlation by signatures.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array

# added to the variance that is independent of the references, against division by zero
ADDED_VARIANCE = 1e-3
PARAMETER_AXES = 4  # period, strength, hardening, damping
ENTRIES = PARAMETER_AXES * (PARAMETER_AXES + 1) // 2  # of a symmetric matrix over these axes
HALF_WEIGHT_DISTANCE = 2 / 3  # q at which the weight w of eq. (13) is a half
WEIGHT_OF_EQ_12 = 0.5  # weight of eq. (12) beside eq. (11), whose errors are equal and independent
# margin on ln(1 - rho), up to twice this for structures independent of the references
SAFETY_MARGIN = 0.12


class Signature(NamedTuple):
    """Quantities of a structure in eq. (11); the signatures have an axis (k, ...) of references."""

    simulated: Array  # c
    derived: Array  # d times ``ratio``
    ratio: Array  # f: of simulated to derived std of the part that is independent of the references
    left: Array  # share of the standard deviation that is independent of the references


def by_signatures(derived: Array, first: Signature, second: Signature) -> Array:
    """Correlation of pairs from the derived one, eq. (11); at most 1, and 1 for equal structures.

    For structures without a correction it is equal to the derived correlation.
    """
    rho = first.ratio * second.ratio * (derived + ADDED_VARIANCE) - ADDED_VARIANCE
    rho = rho + product(first.simulated, second.simulated) - product(first.derived, second.derived)
    return np.where(np.isnan(rho), derived, np.clip(rho, -1.0, 1.0))


def product(left: Array, right: Array) -> Array:
    """Scalar products of vectors (k, ...); those of a column and a row are a matrix product."""
    if left.ndim == right.ndim == 3 and left.shape[2] == right.shape[1] == 1:
        return left[:, :, 0].T @ right[:, 0]
    total = left[0] * right[0]
    for n in range(1, len(left)):
        total = total + left[n] * right[n]
    return total


class Nearness(NamedTuple):
    """The quantities of a structure in eqs. (12) and (13)."""

    place: Array  # (PARAMETER_AXES, ...) logarithms of its properties
    matrix: Array  # (ENTRIES, ...) lower triangle of the matrix G of eq. (12), row by row
    trust: Array  # factor from 0 to 1 on the weight of eq. (13)


def by_nearness(
    rho: Array, first: Nearness, second: Nearness, unseen: Array
) -> tuple[Array, Array]:
    """Correlation of pairs by eq. (13), which changes ``rho`` of nearly equal structures only.

    Also returned is the weight ``w`` of eq. (12) in it. ``unseen`` is the share of the variances of
    both structures that is independent of the references, ``f`` in eq. (13).
    """
    apart = [place - other for place, other in zip(first.place, second.place, strict=True)]
    q: Array | float = 0.0
    rows = zip(first.matrix, second.matrix, strict=True)
    for i in range(PARAMETER_AXES):
        along: Array | float = 0.0
        for j in range(i + 1):
            entry, other = next(rows)
            # entries off the diagonal count twice in the mean of both
            share = 0.5 if i == j else 1.0
            along += (share * entry + share * other) * apart[j]
        q += along * apart[i]
    weight = first.trust * second.trust / (1 + (q / HALF_WEIGHT_DISTANCE) ** 2)
    left = 1 - rho
    ratio = np.log(q / (1 + q) / left)
    corrected = np.isfinite(ratio) & (weight > 0)
    mixed = 1 - left * np.exp(weight * (WEIGHT_OF_EQ_12 * ratio + SAFETY_MARGIN * (1 + unseen)))
    return np.where(corrected, mixed, rho), np.where(corrected, weight, 0.0)
