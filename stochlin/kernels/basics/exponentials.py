"""Exponentials of matrices."""

from __future__ import annotations

import numpy as np

from stochlin.kernels.basics.arrays import Array

TERMS = 10  # of the Taylor series of the matrix exponential, accurate to 1e-15 up to the norm SMALL
SMALL = 0.25  # largest norm of a matrix to which the series is applied


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
