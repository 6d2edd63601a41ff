"""Stationary covariances of many linear systems ``x' = A x + b n(t)``, to nearly full precision.

The method of Bartels and Stewart (1972) alone is inaccurate for slow states beside fast ones, since its
error is relative to the largest rates of the matrix. Two measures restore the accuracy: the matrix is
balanced first, and the solution is refined by its residual, computed with the balanced matrix, until it
no longer changes. The leading dimension of all arrays is that of the systems, called cells (c).
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence

import numpy as np
import scipy.linalg
from scipy.linalg import lapack

from stochlin.kernels.basics.arrays import Array

REFINEMENTS = 20  # largest number of refinements
STILL = 1e-14  # correction of a correlation that is rounding error
WORSE = 0.5  # ratio of a correction to the last one above which it is rounding error
ACCURATE = 1e-8  # largest last correction over the largest covariance; above it the result is refused
BLOCK = 32  # columns that LAPACK reduces together
HALVED = 32  # states above which a triangular equation is halved

UNSTABLE = "the state matrix is not stable; allowed: eigenvalues with negative real parts"
INACCURATE = "the system is too near to one without a stationary covariance"


class Lyapunov:
    """Solver of ``A X + X A' + R = 0`` for stable matrices ``A`` (c, n, n) and any symmetric ``R``.

    The states come in ``parts``, arrays of their numbers, which do not act on one another, except that
    those of the last part act on all, as the ground does on structures without links. The Schur form of
    the whole consists of those of the parts.

    ``stable`` (c,) tells which matrices are stable; results for the others are NaN.
    """

    def __init__(self, matrix: Array, parts: Sequence[Array]) -> None:
        count, n, _ = matrix.shape
        self.matrix, self.scale = matrix.copy(), np.ones((count, n))
        self.triangle, self.vectors = np.zeros((2, count, n, n))
        self.parts, ends = parts, np.cumsum([part.size for part in parts])
        self.places = np.split(np.arange(n), ends[:-1])  # the parts in the Schur basis
        # With rates whose squares overflow, variances would be too small for a number.
        self.stable = np.asarray(np.isfinite(matrix * matrix).all(axis=(1, 2)))
        self.resolved = self.stable.copy()  # whether rounding leaves the slowest decay
        for cell in np.flatnonzero(self.stable).tolist():
            self.matrix[cell], _, _, self.scale[cell], _ = lapack.dgebal(matrix[cell], scale=1)
            for part, place in zip(parts, self.places, strict=True):
                if part.size:
                    self._reduce(cell, part[:, None], place)
        self.matrix[~self.stable] = self.triangle[~self.stable] = -np.eye(n)
        self.vectors[~self.stable] = np.eye(n)
        own, last = np.split(self.vectors, [n - parts[-1].size], axis=2)
        self.triangle[:, : own.shape[2], own.shape[2] :] = own.swapaxes(1, 2) @ (self.matrix @ last)

    def _reduce(self, cell: int, part: Array, place: Array) -> None:
        """Write the Schur form of one part (k, 1) of a cell, and see whether it is stable."""
        triangle, _, _, _, vectors, _, failed = lapack.dgees(
            _any_order, self.matrix[cell, part, part.T], lwork=(3 + BLOCK) * part.size
        )
        self.triangle[cell, place[:, None], place] = triangle
        self.vectors[cell, part, place] = vectors
        slowest = triangle.diagonal().max()  # the diagonal has the real parts of the eigenvalues
        self.stable[cell] &= not failed and slowest < 0
        self.resolved[cell] &= slowest < np.finfo(float).eps * triangle.diagonal().min()

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
        covariance = x * self.scale[:, :, None] * self.scale[:, None, :]
        accurate &= self.stable & self.resolved & np.isfinite(covariance).all(axis=(1, 2))
        return np.where(accurate[:, None, None], covariance, np.nan)

    def slopes(
        self, columns: Array, rows: Array, covariance: Array, out_1: Array, out_2: Array
    ) -> Array:
        """Derivatives (c, s, r) of ``out_1 X out_2'`` by ``e`` if the matrix gains ``e column row'``.

        There are r changes, ``columns`` and ``rows`` (c, r, n), and s pairs of outputs, ``out_1`` and
        ``out_2`` (c, s, n). None is of the last part: a change in one part moves outputs of this part
        only, so that it is solved for in the Schur basis of this part and the last.
        """
        slopes = np.zeros((len(rows), out_1.shape[1], rows.shape[1]))
        drive = (columns / self.scale[:, None], rows @ covariance / self.scale[:, None])
        seen = (out_1 * self.scale[:, None], out_2 * self.scale[:, None])
        for part, place in zip(self.parts[:-1], self.places, strict=False):
            changes = np.flatnonzero(columns[..., part].any(axis=(0, 2)))
            outputs = np.flatnonzero(out_1[..., part].any(axis=(0, 2)))
            states = np.concatenate([place, self.places[-1]])
            vectors, triangles = self.vectors[..., states], self.triangle[:, states[:, None], states]
            a, b = (factor[:, changes] @ vectors for factor in drive)
            c, d = (factor[:, None, outputs] @ vectors[:, None] for factor in seen)
            right = a[..., :, None] * b[..., None, :]
            x = _triangular(triangles, right + right.swapaxes(2, 3))
            slopes[:, outputs[:, None], changes] = ((c @ x) * d).sum(axis=-1).swapaxes(1, 2)
        return slopes

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
        """``X`` of ``A X + X A' + right = 0`` for some cells, with balanced matrices; symmetric."""
        vectors = self.vectors[cells]
        turned = vectors.swapaxes(1, 2) @ right @ vectors
        x = vectors @ _triangular(self.triangle[cells], turned[:, None])[:, 0] @ vectors.swapaxes(1, 2)
        return 0.5 * (x + x.swapaxes(1, 2))


def _triangular(triangles: Array, right: Array) -> Array:
    """Solutions (c, r, n, n) of ``T X + X T' + R = 0`` for r symmetric ``R`` of each cell."""
    solutions = np.empty_like(right)
    for x, triangle, right_side in zip(solutions, triangles, right, strict=True):
        x[:] = _symmetric(triangle, right_side)
    return solutions


def _symmetric(triangle: Array, right: Array) -> Array:
    """Solutions of ``T X + X T' + R = 0`` for a quasi-triangular ``T`` and symmetric ``R`` (r, n, n).

    They are solved by halves, down to what LAPACK solves from the cache, so that nearly all of the work
    is products of matrices (Jonsson and Kågström 2002, ACM Trans. Math. Softw. 28).
    """
    if len(triangle) <= HALVED:
        return _sylvester(triangle, triangle, right)
    (upper, lower), solutions = _halves(triangle), np.empty_like(right)
    across = triangle[upper, lower]
    solutions[:, lower, lower] = x = _symmetric(triangle[lower, lower], right[:, lower, lower])
    mixed = right[:, upper, lower] + across @ x
    y = _sylvester(triangle[upper, upper], triangle[lower, lower], mixed)
    solutions[:, upper, lower], solutions[:, lower, upper] = y, y.swapaxes(1, 2)
    more = y @ across.T
    more = right[:, upper, upper] + more + more.swapaxes(1, 2)
    solutions[:, upper, upper] = _symmetric(triangle[upper, upper], more)
    return solutions


def _sylvester(t_1: Array, t_2: Array, right: Array) -> Array:
    """Solutions of ``T1 X + X T2' + R = 0`` for quasi-triangular matrices and any ``R`` (r, n, m)."""
    if max(len(t_1), len(t_2)) <= HALVED:
        first, second, solutions = np.asfortranarray(t_1), np.asfortranarray(t_2), np.empty_like(right)
        for number, right_side in enumerate(right):
            x, factor, _ = lapack.dtrsyl(second, first, right_side.T, tranb="T")
            solutions[number] = x.T / -factor
        return solutions
    if len(t_1) < len(t_2):
        return _sylvester(t_2, t_1, right.swapaxes(1, 2)).swapaxes(1, 2)
    upper, lower = _halves(t_1)
    x = _sylvester(t_1[lower, lower], t_2, right[:, lower])
    y = _sylvester(t_1[upper, upper], t_2, right[:, upper] + t_1[upper, lower] @ x)
    return np.concatenate([y, x], axis=1)


def _halves(triangle: Array) -> tuple[slice, slice]:
    """Both halves of the states of a quasi-triangular matrix; a block of two rows is not cut."""
    middle = len(triangle) // 2
    middle += triangle[middle, middle - 1] != 0
    return slice(0, middle), slice(middle, None)


def _any_order(_real: float, _imaginary: float) -> None:
    """The order of the eigenvalues, in which LAPACK asks for this function, is not changed."""
