"""What a few reference structures on the same ground tell of a response, and of two together.

The displacements of the references span a space of random variables. The *signature* of a structure
holds the coordinates of its unit displacement in it, with respect to the orthonormal basis that the
Cholesky factor of the references' correlations gives. The correlation of two structures is the product
of their signatures and that of what the references do not see. ``docs/drift.md`` has the equations,
(9) to (11).
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array

OWN = 0.01  # share of each reference that is taken as its own: no small differences of references
LEFT = 1e-3  # of every variance, on top of what the references do not see: no division by zero


class Insight(NamedTuple):
    """What is known of one structure, for the correlation of pairs: eq. (11)."""

    known: Array  # (k, n) simulated signature
    derived: Array  # (k, n) derived signature times `unseen`
    unseen: Array  # (n,) ratio of the standard deviations that no reference sees, simulated to derived

    @property
    def left(self) -> Array:
        """Share of the standard deviation that no reference sees."""
        return np.sqrt(_left(self.known))


def signature(joint: Array, gram: Array) -> Array:
    """Signatures (..., k) from correlations with the references (..., k) and among them (..., k, k)."""
    size = gram.shape[-1]
    basis = np.linalg.inv(np.linalg.cholesky((1 - OWN) * gram + OWN * np.eye(size)))
    return np.sqrt(1 - OWN) * (basis @ joint[..., None])[..., 0]


def insight(derived: Array, correction: Array) -> Insight:
    """Of structures whose derived signatures (k, n) and their corrections are known."""
    known = derived + correction
    # A displacement has no larger part in the space of the references than itself.
    known = known / np.maximum(np.sqrt((known**2).sum(axis=0)), 1.0)
    unseen = np.sqrt((_left(known) + LEFT) / (_left(derived) + LEFT))
    return Insight(known, unseen * derived, unseen)


def _left(coordinates: Array) -> Array:
    return np.asarray(np.maximum(1 - (coordinates**2).sum(axis=0), 0))


def informed_correlation(derived: Array, first: Insight, second: Insight) -> Array:
    """Correlation of pairs from the derived one, eq. (11); at most 1, and 1 for equal structures.

    Where nothing is corrected it is the derived one.
    """
    one = np.concatenate([first.known, first.derived])
    other = np.concatenate([second.known, -second.derived])
    rho = first.unseen * second.unseen * (derived + LEFT) - LEFT + _products(one, other)
    return np.asarray(np.where(np.isnan(rho), derived, np.clip(rho, -1, 1)))


def _products(one: Array, other: Array) -> Array:
    """Sums over the first axis of products that broadcast; of a table's two sides a matrix product."""
    shape = np.broadcast_shapes(one.shape[1:], other.shape[1:])
    terms: list[Any] = []  # without the axes along which they are broadcast
    for x in (one, other):
        axes = [n for n, size in enumerate(x.shape) if n == 0 or size > 1]
        terms += [x.reshape([x.shape[n] for n in axes]), axes]
    wanted = sorted({*terms[1], *terms[3]} - {0})
    return np.einsum(*terms, wanted, optimize=True).reshape(shape)
