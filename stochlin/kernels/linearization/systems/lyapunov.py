"""Stationary covariances of many linear systems ``x' = A x + b n(t)``, to nearly full precision.

The method of Bartels and Stewart (1972) alone is inaccurate for slow states beside fast ones, since its
error is relative to the largest rates of the matrix. Two measures restore the accuracy: the matrix is
balanced first, and the solution is refined by its residual, computed with the balanced matrix, until it
no longer changes. The leading dimension of all arrays is that of the systems, called cells (c).
"""

from __future__ import annotations

import warnings

import numpy as np
import scipy.linalg
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


class Lyapunov:
    """Solver of ``A X + X A' + R = 0`` for stable matrices ``A`` (c, n, n) and any symmetric ``R``.

    ``stable`` (c,) says which matrices are stable; results for the others are NaN.
    """

    def __init__(self, matrix: Array) -> None:
        count, n, _ = matrix.shape
        self.matrix, self.scale = matrix.copy(), np.ones((count, n))
        self.triangle, self.vectors = np.tile(-np.eye(n), (2, count, 1, 1))
        # With rates whose squares overflow, variances would be too small for a number.
        self.stable = np.asarray(np.isfinite(matrix * matrix).all(axis=(1, 2)))
        self.matrix[~self.stable] = -np.eye(n)
        self.resolved = self.stable.copy()  # whether rounding leaves the slowest decay
        for cell in np.flatnonzero(self.stable).tolist():
            balanced, _, _, self.scale[cell], _ = lapack.dgebal(matrix[cell], scale=1)
            triangle, _, _, _, self.vectors[cell], _, failed = lapack.dgees(
                _any_order, balanced, lwork=(3 + BLOCK) * n
            )
            self.matrix[cell], self.triangle[cell] = balanced, triangle
            rates = triangle.diagonal()  # the real parts of the eigenvalues
            self.stable[cell] = not failed and rates.max() < 0
            self.resolved[cell] = rates.max() < np.finfo(float).eps * rates.min()

    def covariance(self, noise: Array, intensity: Array) -> Array:
        """Covariances (c, n, n) for ``R = intensity b b'``, with ``b`` the columns ``noise`` (c, n)."""
        b = noise / self.scale
        drive = intensity[:, None, None] * b[:, :, None] * b[:, None, :]
        x, last = np.zeros_like(drive), np.full(drive.shape, np.inf)
        cells, before = np.flatnonzero(self.stable), np.inf
        for _ in range(REFINEMENTS):
            flow = self.matrix[cells] @ x[cells]
            last[cells] = self._solve(cells, drive[cells] + flow + flow.swapaxes(1, 2))
            x[cells] += last[cells]
            std = np.sqrt(np.abs(np.diagonal(x[cells], axis1=1, axis2=2)))
            std[std == 0] = 1.0
            change = np.abs(last[cells] / (std[:, :, None] * std[:, None, :])).max(axis=(1, 2))
            left = (change > STILL) & (change <= WORSE * before)
            cells, before = cells[left], change[left]
            if not cells.size:
                break
        accurate = np.abs(last).max(axis=(1, 2)) < ACCURATE * np.abs(x).max(axis=(1, 2))
        covariance = x * self.scale[:, :, None] * self.scale[:, None, :]
        accurate &= self.stable & self.resolved & np.isfinite(covariance).all(axis=(1, 2))
        return np.where(accurate[:, None, None], covariance, np.nan)

    def spectral_moments(self, rows: Array, covariance: Array) -> tuple[Array, Array, Array]:
        """Spectral moments ``l0, l1, l2`` (c, k) of outputs ``c x``, for ``rows`` (c, k, n) of ``c``.

        ``l_m = 2 Int_0^inf w^m S(w) dw`` with the two-sided PSD ``S(w) = Re c (i w - A)^-1 X c' / pi``.
        The noise must not enter the outputs directly: ``c b = 0``. With the correlation function
        ``R(t) = c e^(A t) X c'``, ``l1 = -(2/pi) Int_0^inf R'(t)/t dt = (2/pi) c A log(-A) X c'``. The
        logarithm of the matrix also exists for equal eigenvalues.
        """
        c = rows * self.scale[:, None]
        x = covariance / (self.scale[:, :, None] * self.scale[:, None])
        rates, with_c = c @ self.matrix, x @ c.swapaxes(1, 2)
        with warnings.catch_warnings():  # scipy warns when only the last digits are lost
            warnings.simplefilter("ignore")
            logarithm = np.stack([np.real(scipy.linalg.logm(-matrix)) for matrix in self.matrix])
        l0 = np.einsum("aki,aik->ak", c, with_c)
        l1 = (2 / np.pi) * np.einsum("aki,aik->ak", rates, logarithm @ with_c)
        return l0, l1, np.einsum("aki,aij,akj->ak", rates, x, rates)

    def transfer(self, rows: Array, noise: Array, frequency: Array) -> Array:
        """Transfer functions ``c (i w - A)^-1 b`` (c, k, f) for ``rows`` (c, k, n), at ``w`` (f,)."""
        c, b, identity = rows * self.scale[:, None], noise / self.scale, np.eye(noise.shape[1])
        answers = [c @ np.linalg.solve(1j * w * identity - self.matrix, b[..., None]) for w in frequency]
        return np.concatenate(answers, axis=2)

    def _solve(self, cells: Array, right: Array) -> Array:
        """``X`` of ``A X + X A' + right = 0`` for some cells, with the balanced matrices."""
        vectors, x = self.vectors[cells], np.empty_like(right)
        turned = vectors.swapaxes(1, 2) @ right @ vectors
        for place, cell in enumerate(cells.tolist()):
            x[place] = _triangular(self.triangle[cell], self.triangle[cell], turned[place])
        x = vectors @ x @ vectors.swapaxes(1, 2)
        return 0.5 * (x + x.swapaxes(1, 2))


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
