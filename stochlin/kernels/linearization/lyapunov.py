"""Stationary covariances of linear systems of any size, with all their digits.

``x' = A x + b n(t)``. A solver of Bartels and Stewart (1972) loses the digits of what relaxes slowly:
its error is that of the fastest motion. Two things keep them. The matrix is balanced first, so that slow
states are small beside the others in rows and columns alike; and the solution is refined by its own
residual, computed with the matrix as it stands, until it stands still.
"""

from __future__ import annotations

import warnings

import numpy as np
import scipy.linalg

from stochlin.kernels.basics.arrays import Array

REFINEMENTS = 20
STILL = 1e-14  # of a correlation: rounding
WORSE = 0.5  # a correction that is not smaller than this share of the last one is rounding, too
ACCURATE = 1e-8  # of a last correction, over the largest covariance: digits are lost beyond


UNSTABLE = "the state matrix is not stable; allowed: eigenvalues with negative real parts"


class UnsolvableError(ArithmeticError):
    """There is no stationary covariance, or none that can be computed."""


class Lyapunov:
    """``A X + X A' + R = 0`` for one stable matrix and any symmetric ``R``."""

    def __init__(self, matrix: Array) -> None:
        if not np.isfinite(matrix).all():
            raise UnsolvableError("the state matrix is not finite")
        _, (self.scale, _) = scipy.linalg.matrix_balance(matrix, permute=False, separate=True)
        self.matrix = matrix * self.scale / self.scale[:, None]
        try:
            self.triangle, self.turn = scipy.linalg.schur(self.matrix)
        except scipy.linalg.LinAlgError as error:
            raise UnsolvableError("the eigenvalues of the state matrix are not found") from error
        if np.diag(self.triangle).max() >= 0:  # the real parts: blocks have equal diagonals
            raise UnsolvableError(UNSTABLE)

    def covariance(self, noise: Array, intensity: float) -> Array:
        """``X`` for ``R = intensity b b'``, refined."""
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
        """Of the covariance, as the matrix gains a multiple of this product; seen by `schur_rows`."""
        one = self.turn.T @ (column / self.scale)
        two = self.turn.T @ (covariance @ row / self.scale)
        right = np.outer(one, two)
        return self._triangular(right + right.T)

    def schur_rows(self, rows: Array) -> Array:
        """Rows (k, n) that see slopes as they see the covariance."""
        return (rows * self.scale) @ self.turn

    def spectral_moments(self, rows: Array, covariance: Array) -> tuple[Array, Array, Array]:
        """``l0, l1, l2`` of ``c x`` for ``rows`` of ``c`` (k, n) that the noise does not enter at once.

        ``l_m = 2 Int_0^inf w^m S(w) dw`` with ``S(w) = Re c (i w - A)^-1 X c' / pi``, two-sided. ``l1 =
        -(2/pi) Int_0^inf R'(t)/t dt`` of the correlation function ``R(t) = c e^(A t) X c'``: a sum over
        eigenvalues of their logarithms, and with that of the matrix, which minds no equal ones,
        ``(2/pi) c A log(-A) X c'``.
        """
        c = rows * self.scale
        x = covariance / np.outer(self.scale, self.scale)
        rates = c @ self.matrix
        with_c = x @ c.T
        with warnings.catch_warnings():  # of a last digit or two
            warnings.filterwarnings("ignore", "logm result may be inaccurate", RuntimeWarning)
            logarithm = np.real(scipy.linalg.logm(-self.matrix))
        l1 = (2 / np.pi) * np.einsum("ki,ik->k", rates, logarithm @ with_c)
        return np.einsum("ki,ik->k", c, with_c), l1, np.einsum("ki,ij,kj->k", rates, x, rates)

    def transfer(self, rows: Array, noise: Array, frequency: Array) -> Array:
        """``c (i w - A)^-1 b`` for ``rows`` of ``c`` (k, n) and circular frequencies (f,)."""
        c, b, one = rows * self.scale, noise / self.scale, np.eye(noise.size)
        return np.stack([c @ np.linalg.solve(1j * w * one - self.matrix, b) for w in frequency], axis=1)

    def _solve(self, right: Array) -> Array:
        x = self.turn @ self._triangular(self.turn.T @ right @ self.turn) @ self.turn.T
        return 0.5 * (x + x.T)

    def _triangular(self, right: Array) -> Array:
        found, factor, _ = scipy.linalg.lapack.dtrsyl(self.triangle, self.triangle, -right, tranb="T")
        return found / factor
