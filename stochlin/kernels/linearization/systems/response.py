"""Stationary response of linearized systems, and the moments of their springs.

For accuracy the Lyapunov equation is solved in other states than those of the state space. Extensions of
as many springs as there are coordinates, the stiffest ones that are independent, replace the
coordinates, so that small extensions are not differences of large displacements. The slip ``y = d - z``
replaces ``z``, as for single oscillators: if a spring hardly yields, all coefficients of its equation
tend to zero together.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization.spectral_moments import SpectralMoments
from stochlin.kernels.linearization.systems.lyapunov import Lyapunov
from stochlin.kernels.linearization.systems.state_space import StateSpace

SLOW = 1e-13  # relaxation over the largest frequency below which z is proportional to the extension
AT_ONCE = 1024  # cells that are solved together
DEPENDENT = 1e-8  # part of an extension, as a share, that other extensions do not determine
FAST = 1e-2  # relaxation over the largest frequency from which z is a state in place of y


class SpringMoments(NamedTuple):
    """Second moments of the yielding springs, each (c, m)."""

    drift: Array  # variance of the extension [m^2]
    velocity: Array  # variance of its rate [m^2/s^2]
    z: Array  # variance of z [m^2]
    velocity_z: Array  # covariance of the rate and z [m^2/s]


class Basis(NamedTuple):
    """The transformation from the states to those that are solved for, and back."""

    into: Array  # (c, k, states): matrix to the ``k`` states that are solved for
    back: Array  # (c, states, k): matrix back
    drifts: Array  # (m, k): rows of the extensions of the yielding springs
    velocities: Array  # (m, k): rows of their rates
    z: Array  # (c, m, k): rows of z
    beyond: Array  # (c, m, k): rows of z less its part proportional to d, which has E[d d'] = 0


def alike(system: StateSpace) -> Iterator[tuple[Array, StateSpace]]:
    """Groups of systems that are solved for the same states: numbers of their cells, and the systems.

    A group has at most `AT_ONCE` cells, which limits the memory for intermediate results.
    """
    shape = np.concatenate([_stiffest(system), _moves(system)], axis=1)
    _, group = np.unique(shape, axis=0, return_inverse=True)
    for number in range(group.max(initial=-1) + 1):
        cells = np.flatnonzero(group.ravel() == number)
        for begin in range(0, cells.size, AT_ONCE):
            part = cells[begin : begin + AT_ONCE]
            yield part, system.at(part)


class StationaryResponse:
    """The stationary response of systems that are `alike`; NaN where there is none."""

    def __init__(self, system: StateSpace) -> None:
        self.system, self.basis = system, _basis(system)
        into, back = self.basis.into, self.basis.back
        self._equation = Lyapunov(into @ system.matrix @ back)
        self._noise = (into @ system.noise[..., None])[..., 0]
        self._solution = self._equation.covariance(self._noise, system.intensity)

    @property
    def stable(self) -> Array:
        """Whether the state matrix of each cell (c,) is stable."""
        return self._equation.stable

    @cached_property
    def covariance(self) -> Array:
        """Covariance matrix of the states (c, states, states)."""
        covariance = self.basis.back @ self._solution @ self.basis.back.swapaxes(1, 2)
        return 0.5 * (covariance + covariance.swapaxes(1, 2))

    @property
    def residual(self) -> Array:
        """Largest residual (c,) of the Lyapunov equation ``A X + X A' + 2 pi S0 b b' = 0``.

        It is in units of the standard deviations of the states, over the largest entry of ``A``.
        """
        matrix, noise, intensity, *_ = self.system
        std = np.sqrt(np.diagonal(self.covariance, axis1=1, axis2=2))
        std = np.where(std == 0, 1.0, std)
        rates = matrix * std[:, None] / std[:, :, None]
        flow = rates @ (self.covariance / (std[:, :, None] * std[:, None]))
        b = noise / std
        off = flow + flow.swapaxes(1, 2) + intensity[:, None, None] * b[:, :, None] * b[:, None]
        largest: Array = np.abs(off).max(axis=(1, 2)) / np.abs(rates).max(axis=(1, 2))
        return largest

    @cached_property
    def moments(self) -> SpringMoments:
        """Second moments of the yielding springs."""
        _, _, d, v, z, beyond = self.basis
        pairs = (d, d), (v, v), (z, z), (v, beyond)
        return SpringMoments(*(self._product(left, right) for left, right in pairs))

    def std(self, weights: Array, *, rates: bool = False) -> Array:
        """Standard deviations (c, k) of sums of coordinates, or of their rates, with weights (k, n)."""
        order = self.system.order
        return self._std(weights @ self.basis.back[:, order.velocities if rates else order.coordinates])

    def force_std(self, post: Array, couple: Array, dashpots: Array) -> Array:
        """Standard deviations (c, l) [N] of the forces of the last l springs and their dashpots.

        ``post`` is the post-yield stiffness, ``couple`` the elastic stiffness less this one, and
        ``dashpots`` the constants of the dashpots parallel to the springs, all (c, l).
        """
        order, back = self.system.order, self.basis.back
        numbers = len(self.system.extensions) - dashpots.shape[1] + np.arange(dashpots.shape[1])
        extensions = self.system.extensions[numbers]
        drift, rate = extensions @ back[:, order.coordinates], extensions @ back[:, order.velocities]
        z = drift.copy()
        own = np.isin(self.system.springs, numbers)
        z[:, np.searchsorted(numbers, self.system.springs[own])] = back[:, order.z[own]]
        return self._std(post[..., None] * drift + couple[..., None] * z + dashpots[..., None] * rate)

    def spectral_moments(self, weights: Array) -> SpectralMoments:
        """Spectral moments (c, k) of sums of coordinates with these weights (k, n).

        They are integrals over positive frequencies of twice the two-sided PSD, as for oscillators.
        """
        rows = weights @ self.basis.back[:, self.system.order.coordinates]
        return SpectralMoments(*self._equation.spectral_moments(rows, self._solution))

    def spectral_density(self, weights: Array, frequency: Array) -> Array:
        """Two-sided PSD (c, k, f) [m^2 s] of sums of coordinates, at circular frequencies (f,)."""
        rows = weights @ self.basis.back[:, self.system.order.coordinates]
        transfer = self._equation.transfer(rows, self._noise, frequency)
        density: Array = self.system.intensity[:, None, None] / (2 * np.pi) * np.abs(transfer) ** 2
        return density

    def _std(self, rows: Array) -> Array:
        """Standard deviations of linear functions (c, k, states) of the states that are solved for."""
        return np.sqrt(np.maximum(self._product(rows, rows), 0.0))

    def _product(self, left: Array, right: Array) -> Array:
        """Covariances (c, k) of linear functions ``left[k]`` and ``right[k]`` of these states."""
        covariances: Array = ((left @ self._solution) * right).sum(axis=-1)
        return covariances


def _stiffest(system: StateSpace) -> Array:
    """Numbers (c, n) of the stiffest springs whose extensions determine all coordinates."""
    springs, n = system.extensions.shape
    if springs == n:
        return np.broadcast_to(np.arange(n), (len(system.matrix), n))
    orders, which = np.unique(
        np.argsort(-system.stiffness, axis=1, kind="stable"), axis=0, return_inverse=True
    )
    return np.array([_independent(system.extensions, order) for order in orders])[which.ravel()]


def _independent(extensions: Array, order: Array) -> Array:
    """The first springs in this order whose extensions are linearly independent, by Gram and Schmidt."""
    chosen, directions = [], np.empty((0, extensions.shape[1]))
    for spring in order:
        row = extensions[spring] / np.linalg.norm(extensions[spring])
        rest = row - directions.T @ (directions @ row)
        if np.linalg.norm(rest) > DEPENDENT:
            chosen.append(spring)
            rest -= directions.T @ (directions @ rest)
            directions = np.vstack([directions, rest / np.linalg.norm(rest)])
    return np.sort(chosen)


def _fastest(system: StateSpace) -> Array:
    """Largest frequency (c, 1) [rad/s] of the coordinates, about."""
    _, q, v, _ = system.order
    return np.sqrt(np.abs(system.matrix[:, v[:, None], q]).max(axis=(1, 2)))[:, None]


def _moves(system: StateSpace) -> Array:
    """Whether z of each spring (c, m) is a state of its own; else it is a multiple of the extension."""
    relaxation = -system.matrix[:, system.order.z, system.order.z]
    return np.abs(relaxation) > SLOW * _fastest(system)


def _inverse(extensions: Array) -> Array:
    """Inverse (n, n) of extensions; without rounding errors if all its entries are whole numbers."""
    inverse = np.linalg.inv(extensions)
    whole: Array = np.rint(inverse)
    return whole if np.array_equal(extensions @ whole, np.eye(len(whole))) else inverse


def _basis(system: StateSpace) -> Basis:
    """The transformation that the module's docstring describes."""
    matrix, (_, q, v, z) = system.matrix, system.order
    own, stiff = system.extensions[system.springs], system.extensions[_stiffest(system)[0]]
    moves, coordinates = _moves(system)[0], _inverse(stiff)
    follows = (matrix[:, z[:, None], v] * own).sum(axis=2) / (own**2).sum(axis=1)  # -c_eq
    by_y = moves & (-matrix[:, z, z] < FAST * _fastest(system))
    states = matrix.shape[1]
    kept = np.delete(np.arange(states), z[~moves])
    where = np.searchsorted(kept, np.arange(states))
    e, rate_of_e, third = where[q], where[v], where[z[moves]]

    identity, cells = np.eye(states), len(matrix)
    into = np.tile(identity[kept], (cells, 1, 1))
    back = np.tile(identity[:, kept], (cells, 1, 1))
    for here, there in ((e, q), (rate_of_e, v)):
        into[:, here[:, None], there], back[:, there[:, None], here] = stiff, coordinates
    sign = np.where(by_y, -1.0, 1.0)[:, moves]
    into[:, third, z[moves]] = back[:, z[moves], third] = sign
    into[:, third[:, None], q] = by_y[:, moves, None] * own[moves]
    drifts, velocities = np.zeros((2, z.size, kept.size))
    drifts[:, e] = velocities[:, rate_of_e] = own @ coordinates
    beyond = np.where(moves[:, None], back[:, z], 0.0)
    of_drift = np.where(moves, by_y, follows)
    back[:, z] = beyond + of_drift[..., None] * drifts
    return Basis(into, back, drifts, velocities, back[:, z], beyond)
