"""Stationary covariances of many linear systems ``x' = A x + b n(t)``, to nearly full precision.

The method of Bartels and Stewart (1972) alone is inaccurate for slow states beside fast ones, since its
error is relative to the largest rates of the matrix. Two measures restore the accuracy: the matrix is
balanced first, and the solution is refined by its residual, computed with the balanced matrix, until it
no longer changes. The leading dimension of all arrays is that of the systems, called cells (c).
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import lapack

from stochlin.kernels.basics.arrays import Array

REFINEMENTS = 20  # largest number of solutions for a residual
STILL = 1e-14  # correction of a correlation that is rounding error
WORSE = 0.5  # ratio of a correction to the last one above which it is rounding error
ACCURATE = 1e-8  # largest last correction over the largest covariance; above it the result is refused
BLOCK = 32  # columns that LAPACK reduces together
HALVED = 48  # states above which a triangular equation is halved

UNSTABLE = "the state matrix is not stable; allowed: eigenvalues with negative real parts"
INACCURATE = "the system is too near to one without a stationary covariance"


def stationary_covariance(matrix: Array, noise: Array, intensity: Array) -> tuple[Array, Array]:
    """``X`` (c, n, n) of ``A X + X A' + intensity b b' = 0``, and whether each ``A`` is stable.

    ``X`` is NaN where the matrix is not stable, or so close to instability that rounding errors decide.
    """
    count, n = noise.shape
    balanced, scale = matrix.copy(), np.ones((count, n))
    triangle, vectors = np.tile(-np.eye(n), (2, count, 1, 1))
    # With rates whose squares overflow, variances would be too small for a number.
    stable = np.asarray(np.isfinite(matrix * matrix).all(axis=(1, 2)))
    resolved = stable.copy()  # whether rounding leaves the slowest decay
    for cell in np.flatnonzero(stable).tolist():
        balanced[cell], _, _, scale[cell], _ = lapack.dgebal(matrix[cell], scale=1)
        triangle[cell], _, _, _, vectors[cell], _, failed = lapack.dgees(
            _any_order, balanced[cell], lwork=(3 + BLOCK) * n
        )
        rates = triangle[cell].diagonal()  # the real parts of the eigenvalues
        stable[cell] = not failed and rates.max() < 0
        resolved[cell] = rates.max() < np.finfo(float).eps * rates.min()
    b, units = noise / scale, scale[:, :, None] * scale[:, None]
    drive = intensity[:, None, None] * b[:, :, None] * b[:, None]
    x, last = np.zeros_like(drive), np.full(drive.shape, np.inf)
    cells, before = np.flatnonzero(stable), np.inf
    for _ in range(REFINEMENTS):
        flow = balanced[cells] @ x[cells]
        right = drive[cells] + flow + flow.swapaxes(1, 2)
        last[cells] = _solution(triangle[cells], vectors[cells], right)
        x[cells] += last[cells]
        std = np.sqrt(np.abs(np.diagonal(x[cells], axis1=1, axis2=2)))
        std[std == 0] = 1.0
        change = np.abs(last[cells] / (std[:, :, None] * std[:, None])).max(axis=(1, 2))
        left = (change > STILL) & (change <= WORSE * before)
        cells, before = cells[left], change[left]
        if not cells.size:
            break
    accurate = np.abs(last).max(axis=(1, 2)) < ACCURATE * np.abs(x).max(axis=(1, 2))
    covariance = x * units
    accurate &= stable & resolved & np.isfinite(covariance).all(axis=(1, 2))
    return np.where(accurate[:, None, None], covariance, np.nan), stable


def _solution(triangle: Array, vectors: Array, right: Array) -> Array:
    """``X`` of ``A X + X A' + right = 0`` for the Schur forms of ``A``."""
    turned = vectors.swapaxes(1, 2) @ right @ vectors
    solved = [_triangular(t, t, r) for t, r in zip(triangle, turned, strict=True)]
    x = vectors @ np.reshape(solved, right.shape) @ vectors.swapaxes(1, 2)
    return np.asarray(0.5 * (x + x.swapaxes(1, 2)))


def _triangular(t_1: Array, t_2: Array, right: Array) -> Array:
    """``X`` of ``T1 X + X T2' + right = 0`` for quasi-triangular matrices.

    Larger ones are solved by halves, so that nearly all of the work is products of matrices (Jonsson and
    Kågström 2002, ACM Trans. Math. Softw. 28).
    """
    if max(len(t_1), len(t_2)) <= HALVED:
        x, factor, _ = lapack.dtrsyl(t_1, t_2, right, tranb="T")
        return np.asarray(x / -factor)
    if len(t_1) < len(t_2):
        return _triangular(t_2, t_1, right.T).T
    middle = len(t_1) // 2
    middle += t_1[middle, middle - 1] != 0  # a block of two rows is not cut
    upper, lower = slice(0, middle), slice(middle, None)
    x = _triangular(t_1[lower, lower], t_2, right[lower])
    y = _triangular(t_1[upper, upper], t_2, right[upper] + t_1[upper, lower] @ x)
    return np.concatenate([y, x])


def _any_order(_real: float, _imaginary: float) -> None:
    """The order of the eigenvalues, in which LAPACK asks for this function, is not changed."""
