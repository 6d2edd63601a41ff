"""Augmented state space of linearized structures and their ground, eqs. (5), (6), (8), (11), (12).

`state_space` is the one place where the state matrix is put together. The structures are a `System`
of coordinates ``q`` and springs with the extensions ``e = E q``, and the ground is a filter of
white noise ``n`` with the states ``g``. The states of the whole are ``g``, ``q``, ``v = q'``, and a
``z`` for each spring that yields:

    g' = A g + b n
    q' = v
    v' = o . g - M^-1 (C v + E' (post e + couple z + c e'))
    z' = -c_eq e' - k_eq z

In a spring that stays elastic, ``z = e``. The dashpots ``c`` are those of links between structures.
If the ground is white noise itself, it has no states, and ``n`` takes the place of ``o . g``. The
leading dimension of all arrays is that of the systems, called cells (c), which have the same floors
and springs.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization.systems.springs import Springs


class StateSpace(NamedTuple):
    """The linear systems ``x' = matrix x + noise n``, and the meaning of their states."""

    matrix: Array  # (c, states, states)
    noise: Array  # (c, states)
    intensity: Array  # (c,) of the white noise n in time, 2 pi S0 [m^2/s^3]
    springs: Array  # (m,) number of the spring of each z
    extensions: Array  # (s, n)
    stiffness: Array  # (c, s) [N/m], elastic

    @property
    def blocks(self) -> tuple[slice, slice, slice, slice]:
        """Where the states of the ground, ``q``, ``v`` and ``z`` stand in the state vector."""
        states = self.noise.shape[1]
        n = self.extensions.shape[1]
        m = self.springs.size
        q = states - m - 2 * n
        v = states - m - n
        z = states - m
        return slice(0, q), slice(q, v), slice(v, z), slice(z, states)

    @property
    def yielding(self) -> Array:
        """Rows (m, n) that give the extensions of the springs that yield."""
        rows: Array = self.extensions[self.springs]
        return rows


def state_space(problem: Springs, c_eq: Array, k_eq: Array, dashpots: Array) -> StateSpace:
    """State matrix and noise vector for coefficients (c, m) and link dashpots (c, l) [N s/m]."""
    springs = problem.yielding
    filtered = problem.soil
    mass, structural, extensions, _, post, couple, _ = problem.system
    links = extensions[problem.links]
    damping = structural + (links.T * dashpots[:, None]) @ links
    yields = np.isin(np.arange(len(extensions)), springs)
    by_extension = np.where(yields, post, problem.system.elastic)
    count = len(mass)
    soil = filtered.arrays
    states = len(filtered.states) + 2 * extensions.shape[1] + springs.size
    matrix = np.zeros((count, states, states))
    noise = np.zeros((count, states))
    intensity = np.broadcast_to(2 * np.pi * np.asarray(filtered.intensity), count)
    space = StateSpace(matrix, noise, intensity, springs, extensions, problem.system.elastic)
    g, q, v, z = space.blocks
    matrix[:, g, g] = soil.matrix
    noise[:, g] = soil.noise
    matrix[:, q, v] = np.eye(extensions.shape[1])
    matrix[:, v, g] = soil.output[..., None, :]
    matrix[:, v, q] = -((extensions.T * by_extension[:, None]) @ extensions) / mass[..., None]
    matrix[:, v, v] = -damping / mass[..., None]
    matrix[:, v, z] = -(extensions.T * couple[:, None])[..., springs] / mass[..., None]
    matrix[:, z, v] = -c_eq[..., None] * extensions[springs]
    diagonal = np.arange(z.start, z.stop)
    matrix[:, diagonal, diagonal] = -k_eq
    if not filtered.states:
        noise[:, v] = 1.0
    matrix += 0.0  # turns negative zeros, which a table would show, into 0
    return space
