"""Correlation of two structures from their correlations with a few reference structures.

The displacements of the reference structures on the same ground span a space of random variables. The
*signature* of a structure is the vector of coordinates of its displacement, over the standard deviation,
in an orthonormal basis of this space; the basis follows from the Cholesky factor of the correlations of
the references. The correlation of two structures is the scalar product of their signatures, plus a part
that is independent of the references. These are eqs. (9) to (11) of ``docs/drift.md``.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array

OWN = 0.01  # share of the unit matrix in the correlations of references, against ill-conditioning
LEFT = 1e-3  # added to the variance that is independent of the references, against division by zero
BLUR = 0.1  # share of the square of a correction, over which the limit of eq. (10) is rounded


class Insight(NamedTuple):
    """The quantities of one structure in eq. (11), for the correlation of pairs."""

    known: Array  # (k, n) simulated signature c
    derived: Array  # (k, n) derived signature d times ``unseen``
    unseen: Array  # (n,) f: ratio of simulated to derived std of the part independent of references

    @property
    def left(self) -> Array:
        """Share of the standard deviation that is independent of the references."""
        return np.sqrt(_left(self.known))


def signature(joint: Array, gram: Array) -> Array:
    """Signatures (..., k), eq. (9).

    ``joint`` (..., k) are the correlations with the references, ``gram`` (..., k, k) those among them.
    """
    return np.asarray((basis_of(gram) @ joint[..., None])[..., 0])


def basis_of(gram: Array) -> Array:
    """Matrix (..., k, k) of which a signature is the product with the correlations; NaN if one is."""
    good = np.isfinite(gram).all(axis=(-2, -1), keepdims=True)
    size = np.eye(gram.shape[-1])
    factor = np.linalg.cholesky((1 - OWN) * np.where(good, gram, size) + OWN * size)
    return np.where(good, np.sqrt(1 - OWN) * np.linalg.inv(factor), np.nan)


def insight(derived: Array, correction: Array) -> Insight:
    """The `Insight` of structures from their derived signatures (k, n) and the corrections, eq. (10)."""
    known = derived + correction
    # A signature has a length of at most 1, since it is the projection of a unit vector.
    square, blur = (known**2).sum(axis=0), BLUR * (correction**2).sum(axis=0)
    known = known / np.sqrt((square + 1 + np.hypot(square - 1, 2 * blur)) / 2)
    unseen = np.sqrt((_left(known) + LEFT) / (_left(derived) + LEFT))
    return Insight(known, unseen * derived, unseen)


def _left(coordinates: Array) -> Array:
    """Share of the variance that is independent of the references, ``1 - |c|^2``, for ``c`` (k, n)."""
    return np.asarray(np.maximum(1 - (coordinates**2).sum(axis=0), 0))


def informed_correlation(derived: Array, first: Insight, second: Insight) -> Array:
    """Correlation of pairs from the derived one, eq. (11); at most 1, and 1 for equal structures.

    For structures without a correction it is equal to the derived correlation.
    """
    vector_1 = np.concatenate([first.known, first.derived])
    vector_2 = np.concatenate([second.known, -second.derived])
    rho = first.unseen * second.unseen * (derived + LEFT) - LEFT + _products(vector_1, vector_2)
    return np.asarray(np.where(np.isnan(rho), derived, np.clip(rho, -1, 1)))


def _products(left: Array, right: Array) -> Array:
    """Sums over the first axis of ``left * right``, which broadcast; for sides of a table by BLAS."""
    shape = np.broadcast_shapes(left.shape[1:], right.shape[1:])
    terms: list[Any] = []  # arguments of einsum, without the axes of length 1
    for x in (left, right):
        axes = [n for n, size in enumerate(x.shape) if n == 0 or size > 1]
        terms += [x.reshape([x.shape[n] for n in axes]), axes]
    wanted = sorted({*terms[1], *terms[3]} - {0})
    return np.einsum(*terms, wanted, optimize=True).reshape(shape)
