"""The augmented state space of linearized structures and their ground, eqs. (5), (6), (8), (11), (12).

With displacements ``u`` of the floors and extensions ``d = E u`` of the springs, the equation of motion
is ``M u'' + C u' + E' (post d + couple z + c d') = M 1 f`` with the forcing ``f`` by the ground. In a
spring that yields, ``z' = -c_eq d' - k_eq z``; in any other one ``z = d``. The leading dimension of all
arrays is that of the systems, called cells (c), which have the same floors and springs.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.systems import System
from stochlin.kernels.linearization.filters import Matrices


class Order(NamedTuple):
    """Numbers of the states."""

    ground: Array  # (q,) states of the ground's filter
    displacements: Array  # (n,) of the floors
    velocities: Array  # (n,)
    z: Array  # (m,) hysteretic extensions


class Mechanics(NamedTuple):
    """Masses, springs and dashpots of the structures and their links, and the ground's filter."""

    order: Order
    springs: Array  # (m,) numbers of the springs with a state z
    system: System  # of c cells, without the dashpots of links
    soil: Matrices  # (c, ...) state matrix, noise and output of the ground's filter
    intensity: Array  # (c,) of the white noise in time, 2 pi S0 [m^2/s^3]

    @property
    def frequency(self) -> Array:
        """Frequencies (c, m) [rad/s] of the springs that yield, with the masses at their ends."""
        own = self.system.extensions[self.springs]
        square: Array = self.system.elastic[:, self.springs] * ((1 / self.system.mass) @ (own**2).T)
        return np.sqrt(square)

    def at(self, cells: Array) -> Mechanics:
        """The cells with these numbers."""
        return self._replace(
            system=self.system.at(cells),
            soil=Matrices(*(part[cells] for part in self.soil)),
            intensity=self.intensity[cells],
        )


class StateSpace(NamedTuple):
    """The linear systems ``x' = matrix x + noise n(t)``, and the meaning of their states."""

    matrix: Array  # (c, states, states)
    noise: Array  # (c, states)
    intensity: Array  # (c,) of the white noise n in time, 2 pi S0 [m^2/s^3]
    order: Order
    springs: Array  # (m,) number of the spring of each z
    extensions: Array  # (s, n)
    stiffness: Array  # (c, s) [N/m], elastic

    def at(self, cells: Array) -> StateSpace:
        """The systems with these numbers."""
        return self._replace(
            matrix=self.matrix[cells],
            noise=self.noise[cells],
            intensity=self.intensity[cells],
            stiffness=self.stiffness[cells],
        )


def state_space(mechanics: Mechanics, c_eq: Array, k_eq: Array, dashpots: Array) -> StateSpace:
    """State matrix and noise vector for equivalent coefficients (c, m) and dashpots of links (c, l).

    The links are the last springs.
    """
    order, springs, system, soil, intensity = mechanics
    mass, structural, extensions, post, couple, _ = system
    q, u, v, z = order
    links = extensions[len(extensions) - dashpots.shape[1] :]
    damping = structural + (links.T * dashpots[:, None]) @ links
    stiffness = system.elastic
    stiffness[:, springs] = post[:, springs]
    states = q.size + u.size + v.size + z.size
    matrix, noise = np.zeros((len(mass), states, states)), np.zeros((len(mass), states))

    def write(rows: Array, columns: Array, block: Array) -> None:
        matrix[:, rows[:, None], columns] = block

    write(q, q, soil.matrix)
    write(u, v, np.eye(u.size))
    write(v, q, np.broadcast_to(soil.output[:, None], (len(mass), v.size, q.size)))
    write(v, u, -((extensions.T * stiffness[:, None]) @ extensions) / mass[..., None])
    write(v, v, -damping / mass[..., None])
    write(v, z, -(extensions.T * couple[:, None])[..., springs] / mass[..., None])
    write(z, v, -c_eq[..., None] * extensions[springs])
    matrix[:, z, z] = -k_eq
    noise[:, q] = soil.noise
    if not q.size:
        noise[:, v] = 1.0
    matrix += 0.0  # turns negative zeros, which a table would show, into 0
    return StateSpace(matrix, noise, intensity, order, springs, extensions, system.elastic)
