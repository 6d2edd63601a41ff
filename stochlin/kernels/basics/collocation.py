"""Collocation in time: polynomials through Gauss-Lobatto nodes of a panel, and matrix exponentials."""

from __future__ import annotations

from functools import cache
from math import prod
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre

from stochlin.kernels.basics.arrays import Array

TERMS = 10  # of the Taylor series of the matrix exponential, accurate to 1e-15 up to the norm SMALL
SMALL = 0.25  # largest norm of a matrix to which the series is applied


class Nodes(NamedTuple):
    """Gauss-Lobatto nodes of a panel of unit length, and the matrices that act on values there."""

    at: Array  # (q,) nodes, from 0 to 1, including both ends
    integrals: Array  # (q, q): nodal values to integrals of their polynomial from 0 to each node
    series: Array  # (q, q): nodal values to the coefficients of their polynomial in a Legendre series

    def integrate(self, values: Array, length: float) -> Array:
        """Integrals (q, ...) from the start of a panel to each node, of values (q, ...) at the nodes."""
        return self._apply(length * self.integrals, values)

    def interpolate(self, values: Array, shares: Array) -> Array:
        """Interpolated values (t, ...) at positions ``shares`` (t,) from 0 to 1 in the panel."""
        basis = legendre.legvander(2 * shares - 1, self.at.size - 1)
        return self._apply(basis @ self.series, values)

    def last_terms(self, values: Array) -> Array:
        """Last two Legendre coefficients (2, ...) of the values: small if the nodes resolve them."""
        return self._apply(self.series[-2:], values)

    @staticmethod
    def _apply(rows: Array, values: Array) -> Array:
        """The matrix ``rows`` times values (q, ...), along their first axis."""
        shape = values.shape[1:]
        product: Array = rows @ values.reshape(len(values), prod(shape))
        return product.reshape(len(rows), *shape)


@cache
def lobatto(count: int) -> Nodes:
    """The ``count`` Gauss-Lobatto nodes of a panel.

    The integral over the whole panel is exact for polynomials up to the degree ``2 count - 3``.
    """
    inner = legendre.legroots(legendre.legder(np.eye(count)[-1])).real  # numpy 2.5: complex type
    x = np.concatenate([[-1.0], inner, [1.0]])
    series = np.linalg.inv(legendre.legvander(x, count - 1))
    terms = [legendre.legval(x, legendre.legint(term, lbnd=-1)) for term in np.eye(count)]
    return Nodes(0.5 * (1 + x), 0.5 * np.stack(terms, axis=1) @ series, series)


def exponentials(matrices: Array) -> Array:
    """Exponentials of matrices (..., s, s), each by scaling and squaring as its norm asks for."""
    norm = np.abs(matrices).sum(axis=-1).max(axis=-1, initial=SMALL)[..., None, None]
    halvings = np.where(np.isfinite(norm), np.ceil(np.log2(norm / SMALL)), 0.0)
    scaled, identity = matrices / 2.0**halvings, np.eye(matrices.shape[-1])
    exponential = identity + scaled / TERMS
    for term in range(TERMS - 1, 0, -1):
        exponential = identity + scaled @ exponential / term
    for halving in range(int(halvings.max(initial=0))):
        left = halving < halvings[..., 0, 0]
        exponential[left] = exponential[left] @ exponential[left]
    return exponential
