"""Collocation in time: polynomials through Lobatto's nodes of a panel, and matrix exponentials there."""

from __future__ import annotations

from functools import cache
from math import prod
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre

from stochlin.kernels.basics.arrays import Array

TERMS = 10  # of the series of an exponential, accurate to 1e-15
SMALL = 0.25  # for matrices of this norm at most


class Nodes(NamedTuple):
    """Lobatto's nodes of a panel of unit length, both ends among them."""

    at: Array  # (q,) from 0 to 1
    integrals: Array  # (q, q): from 0 to each node, of the polynomial through values at the nodes
    series: Array  # (q, q): its coefficients in Legendre's polynomials

    def integrate(self, values: Array, length: float) -> Array:
        """Integrals from the start of a panel to each node, of values (q, ...) at the nodes."""
        return self._apply(length * self.integrals, values)

    def interpolate(self, values: Array, shares: Array) -> Array:
        """Values (q, ...) at the nodes, at these shares (t,) of the panel."""
        basis = legendre.legvander(2 * shares - 1, self.at.size - 1)
        return self._apply(basis @ self.series, values)

    def last_terms(self, values: Array) -> Array:
        """The last two coefficients (2, ...) of the series, which tell how well nodes resolve values."""
        return self._apply(self.series[-2:], values)

    @staticmethod
    def _apply(rows: Array, values: Array) -> Array:
        shape = values.shape[1:]
        found: Array = rows @ values.reshape(len(values), prod(shape))
        return found.reshape(len(rows), *shape)


@cache
def lobatto(count: int) -> Nodes:
    """So many nodes, exact for polynomials up to the degree ``2 count - 3``."""
    inner = legendre.legroots(legendre.legder(np.eye(count)[-1]))
    x = np.concatenate([[-1.0], inner, [1.0]])
    series = np.linalg.inv(legendre.legvander(x, count - 1))
    terms = [legendre.legval(x, legendre.legint(term, lbnd=-1)) for term in np.eye(count)]
    return Nodes(0.5 * (1 + x), 0.5 * np.stack(terms, axis=1) @ series, series)


def exponentials(matrices: Array, times: Array) -> Array:
    """``exp(A t)`` (times, n, s, s) of matrices (n, s, s), by its series and repeated squares."""
    scaled = matrices * times[:, None, None, None]
    norm = np.abs(scaled).sum(axis=-1).max(initial=SMALL)
    halvings = int(np.ceil(np.log2(norm / SMALL)))
    scaled /= 2.0**halvings
    one = np.eye(matrices.shape[-1])
    found = one + scaled / TERMS
    for term in range(TERMS - 1, 0, -1):
        found = one + scaled @ found / term
    for _ in range(halvings):
        found = found @ found
    return found
