"""Stationary response of linearized systems, and the moments of their springs.

For accuracy the Lyapunov equation is solved in other states than those of the state space.
Extensions of as many springs as there are coordinates, the stiffest ones that are independent,
replace the coordinates, so that small extensions are not differences of large displacements. The
slip ``y = d - z`` replaces ``z``, as for single oscillators: if a spring hardly yields, all
coefficients of its equation tend to zero together. In the limit ``z = -c_eq d``, and the difference
of both is a state that is zero.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
import scipy.linalg

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization.spectral_moments import (
    MOMENT_NODES,
    MOMENT_STEP,
    SpectralMoments,
)
from stochlin.kernels.linearization.systems.lyapunov import stationary_covariance
from stochlin.kernels.linearization.systems.state_space import StateSpace

Q, V, Z = 1, 2, 3  # blocks of states
# relaxation over the largest frequency below which z is proportional to the extension
SLOW_RELAXATION = 1e-13
# relaxation over the largest frequency from which z is a state in place of y
FAST_RELAXATION = 1e-2


class StationaryResponse:
    """The stationary response of linear systems (c,); NaN where there is none."""

    def __init__(self, system: StateSpace) -> None:
        self.system = system
        self._matrix, self._noise, self._back = _in_extensions(system)
        self._solution, self.stable = stationary_covariance(
            self._matrix, self._noise, system.intensity
        )

    @cached_property
    def covariance(self) -> Array:
        """Covariance matrix of the states (c, states, states)."""
        covariance = self._back @ self._solution @ self._back.swapaxes(1, 2)
        return 0.5 * (covariance + covariance.swapaxes(1, 2))

    @property
    def moments(self) -> Array:
        """Variances of the rate and z of yielding springs, and covariances of both (3, c, m)."""
        rate = self.rows(self.system.yielding, rates=True)
        z = self._back[:, self.system.blocks[Z]]
        return np.stack([self._covariances(*both) for both in ((rate, rate), (z, z), (rate, z))])

    def rows(self, weights: Array, *, rates: bool = False) -> Array:
        """Sums of coordinates, or of their rates, with weights (k, n), of the states solved for."""
        rows: Array = weights @ self._back[:, self.system.blocks[V if rates else Q]]
        return rows

    def std(self, weights: Array, *, rates: bool = False) -> Array:
        """Standard deviations (c, k) of sums of coordinates or their rates with weights (k, n)."""
        return self._std(self.rows(weights, rates=rates))

    def force_std(self, post: Array, couple: Array, dashpots: Array) -> Array:
        """Standard deviations (c, l) [N] of the forces of the last l springs and their dashpots.

        ``post`` is the post-yield stiffness, ``couple`` the elastic stiffness less this one, and
        ``dashpots`` the constants of the dashpots parallel to the springs, all (c, l).
        """
        first = len(self.system.extensions) - dashpots.shape[1]
        springs = self.system.springs
        extensions = self.system.extensions[first:]
        yields = springs >= first
        drift = self.rows(extensions)
        rate = self.rows(extensions, rates=True)
        z = drift.copy()
        z[:, springs[yields] - first] = self._back[:, self.system.blocks[Z]][:, yields]
        return self._std(
            post[..., None] * drift + couple[..., None] * z + dashpots[..., None] * rate
        )

    def spectral_moments(self, weights: Array) -> SpectralMoments:
        """Spectral moments (c, k) of sums ``c x`` of coordinates with these weights (k, n).

        They are integrals over positive frequencies of twice the two-sided PSD, as for oscillators,
        with the same integral for ``l1``: the correlation function ``R(t) = c e^(A t) X c'`` gives
        ``I(s) = -c A (s - A)^-1 X c'``.
        """
        c = self.rows(weights)
        rates = self.rows(weights, rates=True)
        l0 = self._covariances(c, c)
        l2 = self._covariances(rates, rates)
        with_c = self._solution @ c.swapaxes(1, 2)
        identity = np.eye(c.shape[-1])
        scale = np.sqrt(l2 / l0).max(axis=1)[:, None, None]
        decay = 0.0
        for s in (scale * node for node in MOMENT_NODES):
            decay = decay - s * rates @ np.linalg.solve(s * identity - self._matrix, with_c)
        l1 = (2 / np.pi) * MOMENT_STEP * np.diagonal(decay, axis1=1, axis2=2)
        return SpectralMoments(l0, l1, l2)

    def _std(self, rows: Array) -> Array:
        """Standard deviations of linear functions (c, k, states) of the states solved for."""
        return np.sqrt(np.maximum(self._covariances(rows, rows), 0.0))

    def _covariances(self, left: Array, right: Array) -> Array:
        """Covariances (c, k) of linear functions ``left[k]`` and ``right[k]`` of these states."""
        covariances: Array = ((left @ self._solution) * right).sum(axis=-1)
        return covariances


def _in_extensions(system: StateSpace) -> tuple[Array, Array, Array]:
    """State matrix and noise in the states that are solved for, and the matrix back from these."""
    matrix = system.matrix
    _, q, v, z = system.blocks
    yielding = system.yielding
    weighted = system.extensions.T * np.sqrt(system.stiffness.mean(axis=0))
    *_, stiffest = scipy.linalg.qr(weighted, mode="r", pivoting=True)
    extensions = system.extensions[np.sort(stiffest[: system.extensions.shape[1]])]
    coordinates = np.linalg.inv(extensions)
    into, back = np.tile(np.eye(matrix.shape[1]), (2, len(matrix), 1, 1))
    into[:, q, q] = into[:, v, v] = extensions
    back[:, q, q] = back[:, v, v] = coordinates
    fastest = np.sqrt(np.abs(matrix[:, v, q]).max(axis=(1, 2)))[:, None]
    diagonal = np.arange(z.start, z.stop)
    relaxation = -matrix[:, diagonal, diagonal]
    slow = np.abs(relaxation) <= SLOW_RELAXATION * fastest
    slips = relaxation < FAST_RELAXATION * fastest
    c_eq = -(matrix[:, z, v] * yielding).sum(axis=2) / (yielding**2).sum(axis=1)
    sign = np.where(slips & ~slow, -1.0, 1.0)
    of_drift = np.where(slow, -c_eq, slips)[..., None]
    into[:, diagonal, diagonal] = back[:, diagonal, diagonal] = sign
    into[:, z, q] = -sign[..., None] * of_drift * yielding
    back[:, z, q] = of_drift * (yielding @ coordinates)
    matrix = into @ matrix @ back
    matrix[:, z] *= ~slow[..., None]
    matrix[:, diagonal, diagonal] -= slow * fastest
    return matrix, (into @ system.noise[..., None])[..., 0], back
