"""Covariance of a linearized system of floors, springs and ground, and the moments of each spring.

The states ``x`` are those of the ground filter, displacements and velocities of the floors, and the
hysteretic extension ``z`` [m] of each yielding spring, with ``z' = -c_e d' - k_e z`` for its extension
``d``. For accuracy the Lyapunov equation is solved in other states. Extensions of as many springs as
there are floors, the stiffest ones, replace the displacements, so that small extensions are not
differences of large displacements. The slip ``y = d - z`` replaces ``z``, as for single oscillators: if
a spring hardly yields, all coefficients of its equation tend to zero together.
"""

from __future__ import annotations

from functools import cached_property
from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization.lyapunov import Lyapunov
from stochlin.kernels.linearization.spectral_moments import SpectralMoments

SLOW = 1e-13  # relaxation over the largest frequency below which z is proportional to the extension
FAST = 1e-2  # relaxation over the largest frequency from which z is a state in place of y


class Augmented(NamedTuple):
    """The linear system ``x' = matrix x + noise n(t)``, and the meaning of its states."""

    matrix: Array  # (states, states)
    noise: Array  # (states,)
    intensity: float  # of the white noise n in time, 2 pi S0 [m^2/s^3]
    displacements: Array  # (n,): indices of the displacements of the floors
    velocities: Array  # (n,): indices of their velocities
    z: Array  # (m,): indices of the hysteretic extensions
    springs: Array  # (m,): number of the spring of each z
    extensions: Array  # (s, n): extensions of all springs as sums of displacements, entries 1 and -1
    stiffness: Array  # (s,): elastic stiffness of the springs [N/m]

    @property
    def tree(self) -> Array:
        """Numbers (n,) of the stiffest springs that connect all floors with the ground, as a tree."""
        group, chosen = np.arange(self.displacements.size + 1), []  # the ground comes last
        for spring in np.argsort(-self.stiffness, kind="stable"):
            ends = np.flatnonzero(self.extensions[spring])
            one, two = group[ends[0]], group[ends[1] if ends.size > 1 else -1]
            if one != two:
                chosen.append(spring)
                group[group == two] = one
        return np.sort(chosen)


class SpringMoments(NamedTuple):
    """Second moments of the yielding springs, each (m,)."""

    drift: Array  # variance of the extension [m^2]
    velocity: Array  # variance of its rate [m^2/s^2]
    z: Array  # variance of z [m^2]
    velocity_z: Array  # covariance of the rate and z [m^2/s]


class Transformation(NamedTuple):
    """The transformation from the states to those that are solved for, and back."""

    into: Array  # (k, states): matrix to the ``k`` states that are solved for
    back: Array  # (states, k): matrix back
    drifts: Array  # (m, k): rows of the extensions of the yielding springs
    velocities: Array  # (m, k): rows of their rates
    z: Array  # (m, k): rows of z
    beyond: Array  # (m, k): rows of z less its part proportional to d, which has E[d d'] = 0
    moves: Array  # (m,): z is a state of its own; elsewhere it is proportional to the extension


def transformation(system: Augmented) -> Transformation:
    """The transformation that the module's docstring describes."""
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
    return Transformation(into, back, drifts, velocities, back[z], beyond, moves)


class Solved:
    """The stationary response of an augmented system.

    Raises
    ------
    UnsolvableError
        If the system has no stationary response.
    """

    def __init__(self, system: Augmented) -> None:
        self.system, self.transformation = system, transformation(system)
        self._equation = Lyapunov(self.transformation.into @ system.matrix @ self.transformation.back)
        self._solution = self._equation.covariance(
            self.transformation.into @ system.noise, system.intensity
        )

    @cached_property
    def covariance(self) -> Array:
        """Covariance matrix of the states."""
        found = self.transformation.back @ self._solution @ self.transformation.back.T
        return 0.5 * (found + found.T)

    @cached_property
    def moments(self) -> SpringMoments:
        """Second moments of the yielding springs."""
        _, _, d, v, z, beyond, _ = self.transformation
        found = _products(self._solution, (d, d), (v, v), (z, z), (v, beyond))
        return SpringMoments(*found.reshape(4, -1))

    def std(self, weights: Array, *, rates: bool = False) -> Array:
        """Standard deviations of sums of displacements, or of velocities, with these weights (k, n)."""
        states = self.system.velocities if rates else self.system.displacements
        return self._std(weights @ self.transformation.back[states])

    def force_std(self, springs: Array, post: Array, couple: Array, dashpot: Array) -> Array:
        """Standard deviations of the forces [N] of some springs and the dashpots parallel to them.

        ``post`` is the post-yield stiffness, ``couple`` the elastic stiffness less this one, and
        ``dashpot`` the constant of the dashpot of each spring.
        """
        system, back = self.system, self.transformation.back
        extensions = system.extensions[springs]
        z = extensions @ back[system.displacements]  # of springs that do not yield
        for row, spring in enumerate(springs):
            mine = np.flatnonzero(system.springs == spring)
            z[row] = back[system.z[mine[0]]] if mine.size else z[row]
        rows = post[:, None] * (extensions @ back[system.displacements]) + couple[:, None] * z
        return self._std(rows + dashpot[:, None] * (extensions @ back[system.velocities]))

    def spectral_moments(self, weights: Array) -> SpectralMoments:
        """Spectral moments of sums of displacements with these weights (k, n).

        They are integrals over positive frequencies of twice the two-sided PSD, as for oscillators.
        """
        rows = weights @ self.transformation.back[self.system.displacements]
        return SpectralMoments(*self._equation.spectral_moments(rows, self._solution))

    def spectral_density(self, weights: Array, frequency: Array) -> Array:
        """Two-sided PSD (k, f) [m^2 s] of sums of displacements, at circular frequencies (f,)."""
        rows, noise = weights @ self.transformation.back[self.system.displacements], self.system.noise
        transfer = self._equation.transfer(rows, self.transformation.into @ noise, frequency)
        density: Array = self.system.intensity / (2 * np.pi) * np.abs(transfer) ** 2
        return density

    def _std(self, rows: Array) -> Array:
        """Standard deviations of linear functions of the states that are solved for."""
        found: Array = np.sqrt(np.maximum(((rows @ self._solution) * rows).sum(axis=1), 0.0))
        return found

    def slopes(self, dashpots: Array, mass: Array) -> Array:
        """Derivatives (3 m + l, 2 m + l) of the moments by the equivalent coefficients.

        The rows are the last three moments of the yielding springs (3 m) and the variances of the rates
        of the springs ``dashpots`` (l). The columns are ``c_eq`` and ``k_eq`` of the yielding springs
        (2 m) and the constants of the dashpots parallel to the springs ``dashpots`` (l). ``mass`` (n,)
        are the masses of the floors.
        """
        z, velocities, basis = self.system.z, self.system.velocities, self.transformation
        m = z.size
        extensions = self.system.extensions[dashpots]
        rates = extensions @ basis.back[velocities]
        seen = (self._equation.schur_rows(r) for r in (basis.velocities, basis.z, basis.beyond, rates))
        v, own, beyond, rate = seen
        pairs = (v, v), (own, own), (v, beyond), (rate, rate)
        slopes = np.zeros((3 * m + dashpots.size, 2 * m + dashpots.size))

        def add(which: int, column: Array, row: Array) -> None:
            """Add the derivative for a change ``column row'`` of the state matrix to a column."""
            change = self._equation.slope(column, row, self._solution)
            slopes[:, which] += _products(change, *pairs)

        for spring in range(m):
            if basis.moves[spring]:
                column = basis.into[:, z[spring]]
                rows = [-basis.velocities[spring], -basis.z[spring]]
            else:  # z = -c_eq d
                column = basis.into @ self.system.matrix[:, z[spring]]
                rows = [-basis.drifts[spring]]
                slopes[m + spring, spring] = 2 * rows[0] @ self._solution @ basis.z[spring]
            for which, row in enumerate(rows):
                add(which * m + spring, column, row)
        for which, extension in enumerate(extensions):
            add(2 * m + which, basis.into[:, velocities] @ (extension / mass), -rates[which])
        return slopes


def _products(matrix: Array, *pairs: tuple[Array, Array]) -> Array:
    """Bilinear forms ``one[i] matrix two[i]`` of rows (m, n) with a matrix (n, n), pair after pair."""
    return np.concatenate([((one @ matrix) * two).sum(axis=1) for one, two in pairs])
