"""Stationary covariances of many linear systems ``x' = A x + b n(t)``, to nearly full precision.

The method of Bartels and Stewart (1972) alone is inaccurate for slow states beside fast ones, since
its error is relative to the largest rates of the matrix. Two measures restore the accuracy: the
matrix is balanced first, and the solution is refined by its residual, computed with the balanced
matrix, until it no longer changes. The leading dimension of all arrays is that of the systems,
called cells (c).
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import lapack

from stochlin.kernels.basics.arrays import Array

REFINEMENTS = 20  # largest number of solutions for a residual
# correction of a correlation after which the error that is left is rounding
LEAST_CORRECTION = 1e-11
WORSE = 0.5  # ratio of a correction to the last one above which it is rounding error
# largest last correction over the largest covariance; above it the result is refused
ACCURATE = 1e-8
LAPACK_BLOCK = 32  # columns that LAPACK reduces together

UNSTABLE = "the state matrix is not stable; allowed: eigenvalues with negative real parts"
INACCURATE = "the system is too near to one without a stationary covariance"


def stationary_covariance(matrix: Array, noise: Array, intensity: Array) -> tuple[Array, Array]:
    """``X`` (c, n, n) of ``A X + X A' + intensity b b' = 0``, and whether each ``A`` is stable.

    ``X`` is NaN where the matrix is not stable, or so close to instability that rounding errors
    decide.
    """
    covariance = np.full(matrix.shape, np.nan)
    stable = np.zeros(len(matrix), bool)
    drives = np.sqrt(intensity)[:, None] * noise
    lwork = (3 + LAPACK_BLOCK) * noise.shape[1]
    # With rates whose squares overflow, variances would be too small for a number.
    for cell in np.flatnonzero(np.isfinite(matrix * matrix).all(axis=(1, 2))).tolist():
        balanced, _, _, scale, _ = lapack.dgebal(matrix[cell], scale=1)
        # LAPACK asks for an order of the eigenvalues, which is not changed.
        triangle, *_, vectors, _, failed = lapack.dgees(lambda *_: None, balanced, lwork=lwork)
        rates = triangle.diagonal()  # the real parts of the eigenvalues
        stable[cell] = not failed and rates.max() < 0
        if stable[cell] and rates.max() < np.finfo(float).eps * rates.min():
            solved = _refined(balanced, triangle, vectors, drives[cell] / scale)
            covariance[cell] = solved * np.outer(scale, scale)
    covariance[~np.isfinite(covariance).all(axis=(1, 2))] = np.nan
    return covariance, stable


def _refined(matrix: Array, triangle: Array, vectors: Array, drive: Array) -> Array:
    """``X`` of ``A X + X A' + b b' = 0`` for the Schur form of ``A``; NaN if it is not accurate."""
    x = np.zeros_like(matrix)
    before = np.inf
    for _ in range(REFINEMENTS):
        flow = matrix @ x
        turned = vectors.T @ (np.outer(drive, drive) + flow + flow.T) @ vectors
        solved, factor, _ = lapack.dtrsyl(triangle, triangle, turned, tranb="T")
        step = vectors @ (solved / -factor) @ vectors.T
        step = 0.5 * (step + step.T)
        x += step
        std = np.sqrt(np.abs(x.diagonal()))
        std[std == 0] = 1.0
        change = np.abs(step / np.outer(std, std)).max()
        if not LEAST_CORRECTION < change <= WORSE * before:
            break
        before = change
    accurate = np.abs(step).max() < ACCURATE * np.abs(x).max()
    return x if accurate else np.full_like(x, np.nan)
