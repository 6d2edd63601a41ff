"""Signatures of structures, from their correlations with a few reference structures.

The displacements of the reference structures on the same ground span a space of random variables. The
*signature* of a structure is the vector of coordinates of its displacement, over the standard deviation,
in an orthonormal basis of this space; the basis follows from the Cholesky factor of the correlations of
the references. The correlation of two structures is the scalar product of their signatures, plus a part
that is independent of the references. These are eqs. (9) to (11) of ``docs/drift.md``.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array

LEFT = 1e-3  # added to the variance that is independent of the references, against division by zero


class Signature(NamedTuple):
    """The quantities of a structure in eq. (11); the signatures have an axis (k, ...) of references."""

    simulated: Array  # c
    derived: Array  # d times ``ratio``
    ratio: Array  # f: of simulated to derived std of the part that is independent of the references
    left: Array  # share of the standard deviation that is independent of the references


def by_signatures(derived: Array, first: Signature, second: Signature) -> Array:
    """Correlation of pairs from the derived one, eq. (11); at most 1, and 1 for equal structures.

    For structures without a correction it is equal to the derived correlation.
    """
    rho = first.ratio * second.ratio * (derived + LEFT) - LEFT
    rho = rho + product(first.simulated, second.simulated) - product(first.derived, second.derived)
    return np.where(np.isnan(rho), derived, np.minimum(np.maximum(rho, -1.0), 1.0))


def product(left: Array, right: Array) -> Array:
    """Scalar products of vectors (k, ...)."""
    total = left[0] * right[0]
    for n in range(1, len(left)):
        total = total + left[n] * right[n]
    return total
