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

REFINEMENTS = 20  # largest number of refinements
STILL = 1e-14  # correction of a correlation that is rounding error
WORSE = 0.5  # ratio of a correction to the last one above which it is rounding error
ACCURATE = 1e-8  # largest last correction over the largest covariance; above it the result is refused
BLOCK = 32  # columns that LAPACK reduces together

UNSTABLE = "the state matrix is not stable; allowed: eigenvalues with negative real parts"
INACCURATE = "the system is too near to one without a stationary covariance"


class Lyapunov:
    """Solver of ``A X + X A' + R = 0`` for stable matrices ``A`` (c, n, n) and any symmetric ``R``.

    ``stable`` (c,) tells which matrices are stable; results for the others are NaN.
    """

    def __init__(self, matrix: Array) -> None:
        count, n, _ = matrix.shape
        self.scale = np.ones((count, n))
        self.matrix, self.triangle, self.vectors = (np.empty_like(matrix) for _ in range(3))
        self.stable = np.asarray(np.isfinite(matrix).all(axis=(1, 2)))
        for cell in range(count):
            if self.stable[cell]:
                balanced, _, _, self.scale[cell], _ = lapack.dgebal(matrix[cell], scale=1)
                self.matrix[cell] = balanced
                triangle, _, _, _, self.vectors[cell], _, failed = lapack.dgees(
                    _any_order, balanced, lwork=(3 + BLOCK) * n
                )
                # The diagonal has the real parts of the eigenvalues.
                self.stable[cell] = not failed and triangle.diagonal().max() < 0
                self.triangle[cell] = triangle
            if not self.stable[cell]:
                self.matrix[cell] = self.triangle[cell] = -np.eye(n)
                self.vectors[cell] = np.eye(n)

    def covariance(self, noise: Array, intensity: Array) -> Array:
        """Covariances (c, n, n) for ``R = intensity b b'``, with ``b`` the columns ``noise`` (c, n)."""
        b = noise / self.scale
        drive = intensity[:, None, None] * b[:, :, None] * b[:, None, :]
        x, last = np.zeros_like(drive), np.full(drive.shape, np.inf)
        before, cells = np.full(len(x), np.inf), np.flatnonzero(self.stable)
        for _ in range(REFINEMENTS):
            if not cells.size:
                break
            flow = self.matrix[cells] @ x[cells]
            last[cells] = self._solve(cells, drive[cells] + flow + flow.swapaxes(1, 2))
            x[cells] += last[cells]
            std = np.sqrt(np.abs(np.diagonal(x[cells], axis1=1, axis2=2)))
            std = np.where(std == 0, 1.0, std)
            change = np.abs(last[cells] / (std[:, :, None] * std[:, None, :])).max(axis=(1, 2))
            left = (change > STILL) & (change <= WORSE * before[cells])
            before[cells] = change
            cells = cells[left]
        accurate = np.abs(last).max(axis=(1, 2)) < ACCURATE * np.abs(x).max(axis=(1, 2))
        found = x * self.scale[:, :, None] * self.scale[:, None, :]
        accurate &= self.stable & np.isfinite(found).all(axis=(1, 2))
        return np.where(accurate[:, None, None], found, np.nan)

    def slopes(self, columns: Array, rows: Array, covariance: Array) -> Array:
        """Derivatives of the covariance by ``e`` if the matrix changes by ``e column row'``.

        There are r changes, ``columns`` and ``rows`` (c, r, n). The derivatives (c, r, n, n) are in the
        Schur basis; `schur_rows` gives rows to multiply them with.
        """
        one = (columns / self.scale[:, None]) @ self.vectors
        two = (rows @ covariance / self.scale[:, None]) @ self.vectors
        right = one[..., :, None] * two[..., None, :]
        return self._triangular(np.arange(len(right)), right + right.swapaxes(2, 3))

    def schur_rows(self, rows: Array) -> Array:
        """Rows ``c`` (c, k, n) in the Schur basis, to be multiplied with the `slopes`."""
        return (rows * self.scale[:, None]) @ self.vectors

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
            warnings.filterwarnings("ignore", "logm result may be inaccurate", RuntimeWarning)
            logarithm = np.stack([np.real(scipy.linalg.logm(-matrix)) for matrix in self.matrix])
        l0 = np.einsum("aki,aik->ak", c, with_c)
        l1 = (2 / np.pi) * np.einsum("aki,aik->ak", rates, logarithm @ with_c)
        return l0, l1, np.einsum("aki,aij,akj->ak", rates, x, rates)

    def transfer(self, rows: Array, noise: Array, frequency: Array) -> Array:
        """Transfer functions ``c (i w - A)^-1 b`` (c, k, f) for ``rows`` (c, k, n), at ``w`` (f,)."""
        c, b, one = rows * self.scale[:, None], noise / self.scale, np.eye(noise.shape[1])
        answers = [c @ np.linalg.solve(1j * w * one - self.matrix, b[..., None]) for w in frequency]
        return np.concatenate(answers, axis=2)

    def _solve(self, cells: Array, right: Array) -> Array:
        """``X`` of ``A X + X A' + right = 0`` for some cells, with balanced matrices; symmetric."""
        vectors = self.vectors[cells]
        turned = vectors.swapaxes(1, 2) @ right @ vectors
        x = vectors @ self._triangular(cells, turned[:, None])[:, 0] @ vectors.swapaxes(1, 2)
        return 0.5 * (x + x.swapaxes(1, 2))

    def _triangular(self, cells: Array, right: Array) -> Array:
        """The same in the Schur basis, where the matrix is quasi-triangular.

        ``right`` (c, r, n, n) has r symmetric matrices for each cell.
        """
        found = np.empty_like(right)
        for number, cell in enumerate(cells):
            triangle = np.asfortranarray(self.triangle[cell])
            for change, given in enumerate(right[number]):
                x, factor, _ = lapack.dtrsyl(triangle, triangle, given.T, tranb="T")
                found[number, change] = x / -factor
        return found


def _any_order(_real: float, _imaginary: float) -> None:
    """The order of the eigenvalues, in which LAPACK asks for this function, is not changed."""
