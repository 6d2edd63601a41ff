"""Stationary covariances of linear systems ``x' = A x + b n(t)`` of any size, to nearly full precision.

The method of Bartels and Stewart (1972) alone is inaccurate for slow states beside fast ones, since its
error is relative to the largest rates of the matrix. Two measures restore the accuracy: the matrix is
balanced first, and the solution is refined by its residual, computed with the balanced matrix, until it
no longer changes.
"""

from __future__ import annotations

import warnings

import numpy as np
import scipy.linalg

from stochlin.kernels.basics.arrays import Array

REFINEMENTS = 20  # largest number of refinements
STILL = 1e-14  # correction of a correlation that is rounding error
WORSE = 0.5  # ratio of a correction to the last one above which it is rounding error
ACCURATE = 1e-8  # largest last correction over the largest covariance; above it the result is refused


UNSTABLE = "the state matrix is not stable; allowed: eigenvalues with negative real parts"


class UnsolvableError(ArithmeticError):
    """The system has no stationary covariance, or its covariance cannot be computed accurately."""


class Lyapunov:
    """Solver of ``A X + X A' + R = 0`` for one stable matrix ``A`` and any symmetric ``R``."""

    def __init__(self, matrix: Array) -> None:
        if not np.isfinite(matrix).all():
            raise UnsolvableError("the state matrix is not finite")
        _, (self.scale, _) = scipy.linalg.matrix_balance(matrix, permute=False, separate=True)
        self.matrix = matrix * self.scale / self.scale[:, None]
        try:
            self.triangle, self.vectors = scipy.linalg.schur(self.matrix)
        except scipy.linalg.LinAlgError as error:
            raise UnsolvableError("the eigenvalues of the state matrix are not found") from error
        if np.diag(self.triangle).max() >= 0:  # the diagonal has the real parts of the eigenvalues
            raise UnsolvableError(UNSTABLE)

    def covariance(self, noise: Array, intensity: float) -> Array:
        """Covariance ``X`` (n, n) for ``R = intensity b b'``, with ``b`` the column ``noise`` (n,)."""
        b = noise / self.scale
        drive = intensity * np.outer(b, b)
        x, before = np.zeros_like(drive), np.inf
        for _ in range(REFINEMENTS):
            flow = self.matrix @ x
            correction = self._solve(drive + flow + flow.T)
            x += correction
            std = np.sqrt(np.abs(np.diag(x)))
            std[std == 0] = 1.0
            change = np.abs(correction / np.outer(std, std)).max()
            if change <= STILL or change > WORSE * before:
                break
            before = change
        if not np.abs(correction).max() < ACCURATE * np.abs(x).max():
            raise UnsolvableError("the system is too near to one without a stationary covariance")
        found = x * np.outer(self.scale, self.scale)
        if not np.isfinite(found).all():
            raise UnsolvableError("the covariance is beyond what can be computed")
        return found

    def slope(self, column: Array, row: Array, covariance: Array) -> Array:
        """Derivative of the covariance by ``e`` if the matrix changes by ``e column row'``.

        It is in the Schur basis, (n, n); `schur_rows` gives rows to multiply it with.
        """
        one = self.vectors.T @ (column / self.scale)
        two = self.vectors.T @ (covariance @ row / self.scale)
        right = np.outer(one, two)
        return self._triangular(right + right.T)

    def schur_rows(self, rows: Array) -> Array:
        """Rows ``c`` (k, n) in the Schur basis, to be multiplied with a `slope`."""
        return (rows * self.scale) @ self.vectors

    def spectral_moments(self, rows: Array, covariance: Array) -> tuple[Array, Array, Array]:
        """Spectral moments ``l0, l1, l2`` (k,) of the outputs ``c x``, for ``rows`` (k, n) of ``c``.

        ``l_m = 2 Int_0^inf w^m S(w) dw`` with the two-sided PSD ``S(w) = Re c (i w - A)^-1 X c' / pi``.
        The noise must not enter the outputs directly: ``c b = 0``. With the correlation function
        ``R(t) = c e^(A t) X c'``, ``l1 = -(2/pi) Int_0^inf R'(t)/t dt = (2/pi) c A log(-A) X c'``. The
        logarithm of the matrix also exists for equal eigenvalues.
        """
        c = rows * self.scale
        x = covariance / np.outer(self.scale, self.scale)
        rates = c @ self.matrix
        with_c = x @ c.T
        with warnings.catch_warnings():  # scipy warns when only the last digits are lost
            warnings.filterwarnings("ignore", "logm result may be inaccurate", RuntimeWarning)
            logarithm = np.real(scipy.linalg.logm(-self.matrix))
        l1 = (2 / np.pi) * np.einsum("ki,ik->k", rates, logarithm @ with_c)
        return np.einsum("ki,ik->k", c, with_c), l1, np.einsum("ki,ij,kj->k", rates, x, rates)

    def transfer(self, rows: Array, noise: Array, frequency: Array) -> Array:
        """Transfer functions ``c (i w - A)^-1 b`` (k, f) for ``rows`` (k, n) of ``c``, at ``w`` (f,)."""
        c, b, one = rows * self.scale, noise / self.scale, np.eye(noise.size)
        return np.stack([c @ np.linalg.solve(1j * w * one - self.matrix, b) for w in frequency], axis=1)

    def _solve(self, right: Array) -> Array:
        """``X`` of ``A X + X A' + right = 0`` with the balanced matrix, made symmetric."""
        x = self.vectors @ self._triangular(self.vectors.T @ right @ self.vectors) @ self.vectors.T
        return 0.5 * (x + x.T)

    def _triangular(self, right: Array) -> Array:
        """The same in the Schur basis, where the matrix is quasi-triangular."""
        found, factor, _ = scipy.linalg.lapack.dtrsyl(self.triangle, self.triangle, -right, tranb="T")
        return found / factor
