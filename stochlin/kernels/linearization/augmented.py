"""Floors on springs, linearized, with their ground: covariance, and the moments of each spring.

The states ``x`` are those of the ground, displacements and velocities of the floors, and for each spring
that yields its ``z`` [m], with ``z' = -c_e d' - k_e z`` for its extension ``d``. Solved in others: the
extensions of as many springs as there are floors, the stiffest, so that small ones are no differences of
large numbers; and the slip ``y = d - z``, as for single oscillators, since its whole row of equations
vanishes as yielding dies out.
"""

from __future__ import annotations

from functools import cached_property
from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization.lyapunov import Lyapunov
from stochlin.kernels.linearization.spectral_moments import SpectralMoments

SLOW = 1e-13  # relaxation over the fastest rate below which z follows the extension at once
FAST = 1e-2  # over the frequency of the spring, from which z is followed in place of y


class Augmented(NamedTuple):
    """``x' = matrix x + noise n(t)``, and which states are what."""

    matrix: Array
    noise: Array
    intensity: float  # of n in time, 2 pi S0
    displacements: Array  # states (n,)
    velocities: Array  # (n,)
    z: Array  # (m,)
    springs: Array  # (m,): the spring of each z
    extensions: Array  # (s, n): of all springs by the displacements, 1 and -1
    stiffness: Array  # (s,): of the springs before yield

    @property
    def tree(self) -> Array:
        """The stiffest springs that lead from the ground to all floors (n,)."""
        group, chosen = np.arange(self.displacements.size + 1), []  # the ground comes last
        for spring in np.argsort(-self.stiffness, kind="stable"):
            ends = np.flatnonzero(self.extensions[spring])
            one, two = group[ends[0]], group[ends[1] if ends.size > 1 else -1]
            if one != two:
                chosen.append(spring)
                group[group == two] = one
        return np.sort(chosen)


class SpringMoments(NamedTuple):
    """Of springs that yield (m,), in m and s."""

    drift: Array  # variances
    velocity: Array
    z: Array
    velocity_z: Array  # covariance


class Turn(NamedTuple):
    """From the states to those that are solved for, and back."""

    into: Array  # (k, states)
    back: Array  # (states, k)
    drifts: Array  # of the springs that yield (m, k)
    velocities: Array
    z: Array
    beyond: (
        Array  # what z has beyond the extension at that instant, with which its rate is not correlated
    )
    moves: Array  # (m,): where z is more than a share of the extension


def turn(system: Augmented) -> Turn:
    """See the head of this file."""
    matrix, u, v, z = system.matrix, system.displacements, system.velocities, system.z
    own, tree = system.extensions[system.springs], system.extensions[system.tree]
    floors = np.rint(np.linalg.inv(tree))
    follows = (matrix[np.ix_(z, v)] * own).sum(axis=1) / (own**2).sum(axis=1)  # -c_eq
    relaxation = -matrix[z, z]
    rate = np.sqrt(np.abs(matrix[np.ix_(v, u)]).max())
    moves = np.abs(relaxation) > SLOW * rate
    by_y = moves & (relaxation < FAST * rate)
    sign = np.where(by_y, -1.0, 1.0)
    kept = np.delete(np.arange(len(matrix)), z[~moves])
    where = np.searchsorted(kept, np.arange(len(matrix)))
    e, rate_of_e, third = where[u], where[v], where[z[moves]]

    identity = np.eye(len(matrix))
    into, back = identity[kept], identity[:, kept]
    into[np.ix_(e, u)], back[np.ix_(u, e)] = tree, floors
    into[np.ix_(rate_of_e, v)], back[np.ix_(v, rate_of_e)] = tree, floors
    into[third, z[moves]] = back[z[moves], third] = sign[moves]
    into[np.ix_(third, u)] = np.where(by_y, 1.0, 0.0)[moves, None] * own[moves]
    drifts, velocities = np.zeros((2, z.size, kept.size))
    drifts[:, e] = velocities[:, rate_of_e] = own @ floors
    beyond = np.where(moves[:, None], back[z], 0.0)
    back[z] = beyond + np.where(moves, np.where(by_y, 1.0, 0.0), follows)[:, None] * drifts
    return Turn(into, back, drifts, velocities, back[z], beyond, moves)


class Solved:
    """The stationary motion of an augmented system.

    Raises
    ------
    UnsolvableError
        If there is none.
    """

    def __init__(self, system: Augmented) -> None:
        self.system, self.turn = system, turn(system)
        self._equation = Lyapunov(self.turn.into @ system.matrix @ self.turn.back)
        self._turned = self._equation.covariance(self.turn.into @ system.noise, system.intensity)

    @cached_property
    def covariance(self) -> Array:
        """Of the states."""
        found = self.turn.back @ self._turned @ self.turn.back.T
        return 0.5 * (found + found.T)

    @cached_property
    def moments(self) -> SpringMoments:
        """Of the springs that yield."""
        _, _, d, v, z, beyond, _ = self.turn
        return SpringMoments(*_products(self._turned, (d, d), (v, v), (z, z), (v, beyond)))

    def std(self, weights: Array, *, rates: bool = False) -> Array:
        """Standard deviations of sums of displacements, or of velocities, with these weights (k, n)."""
        states = self.system.velocities if rates else self.system.displacements
        return self._std(weights @ self.turn.back[states])

    def force_std(self, springs: Array, post: Array, couple: Array, dashpot: Array) -> Array:
        """Of the forces in some springs and the dashpots beside them."""
        system, back = self.system, self.turn.back
        extensions = system.extensions[springs]
        z = extensions @ back[system.displacements]  # where the spring does not yield
        for row, spring in enumerate(springs):
            mine = np.flatnonzero(system.springs == spring)
            z[row] = back[system.z[mine[0]]] if mine.size else z[row]
        rows = post[:, None] * (extensions @ back[system.displacements]) + couple[:, None] * z
        return self._std(rows + dashpot[:, None] * (extensions @ back[system.velocities]))

    def spectral_moments(self, weights: Array) -> SpectralMoments:
        """Of sums of displacements with these weights (k, n): one-sided, as for single oscillators."""
        rows = weights @ self.turn.back[self.system.displacements]
        return SpectralMoments(*self._equation.spectral_moments(rows, self._turned))

    def spectral_density(self, weights: Array, frequency: Array) -> Array:
        """Of such sums (k, f) [m^2 s], two-sided."""
        rows, noise = weights @ self.turn.back[self.system.displacements], self.system.noise
        transfer = self._equation.transfer(rows, self.turn.into @ noise, frequency)
        density: Array = self.system.intensity / (2 * np.pi) * np.abs(transfer) ** 2
        return density

    def _std(self, rows: Array) -> Array:
        found: Array = np.sqrt(np.maximum(((rows @ self._turned) * rows).sum(axis=1), 0.0))
        return found

    def slopes(self, dashpots: Array, mass: Array) -> Array:
        """Of the last three of the moments (3 m), and the variances of rates beside ``dashpots`` (l).

        By ``c_eq`` and ``k_eq`` (2 m), and by the constants of dashpots beside these springs (l). The
        floors have the masses (n,).
        """
        z, m, turn, velocities = self.system.z, self.system.z.size, self.turn, self.system.velocities
        extensions = self.system.extensions[dashpots]
        rates = extensions @ turn.back[velocities]
        seen = (self._equation.schur_rows(r) for r in (turn.velocities, turn.z, turn.beyond, rates))
        v, own, beyond, rate = seen
        pairs = (v, v), (own, own), (v, beyond)
        slopes = np.zeros((3 * m + dashpots.size, 2 * m + dashpots.size))

        def add(which: int, column: Array, row: Array) -> None:
            change = self._equation.slope(column, row, self._turned)
            slopes[: 3 * m, which] += _products(change, *pairs).ravel()
            slopes[3 * m :, which] += _products(change, (rate, rate))[0]

        for spring in range(m):
            if turn.moves[spring]:
                column = turn.into[:, z[spring]]
                rows = [-turn.velocities[spring], -turn.z[spring]]
            else:  # z = -c_eq d
                column = turn.into @ self.system.matrix[:, z[spring]]
                rows = [-turn.drifts[spring]]
                slopes[m + spring, spring] = 2 * rows[0] @ self._turned @ turn.z[spring]
            for which, row in enumerate(rows):
                add(which * m + spring, column, row)
        for which, extension in enumerate(extensions):
            add(2 * m + which, turn.into[:, velocities] @ (extension / mass), -rates[which])
        return slopes


def _products(matrix: Array, *pairs: tuple[Array, Array]) -> Array:
    """Of rows (m, n) with each other through a matrix (n, n)."""
    return np.stack([np.einsum("mi,ij,mj->m", one, matrix, two) for one, two in pairs])
