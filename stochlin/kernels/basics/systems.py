"""The one numeric form of structures, which linearization, simulation and probability take.

    M q'' + C q' + E' (post e + couple z) = M 1 f,    e = E q,    u = S q

The generalized coordinates ``q`` [m] have masses ``M`` and a damping matrix ``C``. Elements are
springs with the extensions ``e``; ``z`` is the elastic part of an extension, by the element's
hysteresis law. ``u`` are the displacements of the floors, relative to the ground, and ``f`` [m/s^2]
is the forcing by the ground.

The coordinate of an oscillator is its displacement, which is also the extension of its one element.
The coordinates of a chain of storeys are the displacements of its floors, and the extensions are
their differences. Coordinates of modes have unit masses and the shapes times the participation
factors in S.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import scipy.linalg

from stochlin.kernels.basics.arrays import Array


class Modes(NamedTuple):
    """Modes of vibration while all elements are elastic, longest period first."""

    period: Array  # (n,) [s]
    damping: Array  # (n,) [-], ratios, without what a damping matrix makes modes do to one another
    moves: Array  # (f, n) [-], displacement of each floor over that of the oscillator of the mode


class System(NamedTuple):
    """Masses, elements and floors of structures.

    All arrays but ``extensions`` and ``shapes`` may have a leading axis of cells.
    """

    mass: Array  # (..., n) [kg]
    damping: Array  # (..., n, n) [N s/m]
    extensions: Array  # (s, n) E [-]
    shapes: Array  # (f, n) S [-], of f floors
    post: Array  # (..., s) [N/m], stiffness after yield
    couple: Array  # (..., s) [N/m], stiffness before yield less that after it
    strength: Array  # (..., s) [m], extension at yield; infinite where elastic

    @classmethod
    def beside(cls, parts: Sequence[System]) -> System:
        """Structures side by side."""
        if len(parts) == 1:
            return parts[0]
        cells = np.broadcast_shapes(*(part.mass.shape[:-1] for part in parts))
        sizes = [part.mass.shape[-1] for part in parts]
        damping = np.zeros((*cells, sum(sizes), sum(sizes)))
        for end, size, part in zip(np.cumsum(sizes), sizes, parts, strict=True):
            damping[..., end - size : end, end - size : end] = part.damping

        def joined(name: str) -> Array:
            columns = (getattr(part, name) for part in parts)
            wide = [np.broadcast_to(column, (*cells, column.shape[-1])) for column in columns]
            return np.concatenate(wide, axis=-1)

        extensions = scipy.linalg.block_diag(*(part.extensions for part in parts))
        shapes = scipy.linalg.block_diag(*(part.shapes for part in parts))
        springs = (joined(name) for name in ("post", "couple", "strength"))
        return cls(joined("mass"), damping, extensions, shapes, *springs)

    @property
    def elastic(self) -> Array:
        """Stiffness of the elements before yield (..., s) [N/m]."""
        return self.post + self.couple

    @property
    def stiffness(self) -> Array:
        """Elastic stiffness matrix (..., n, n) [N/m]."""
        stiffness: Array = (self.extensions.T * self.elastic[..., None, :]) @ self.extensions
        return stiffness

    @property
    def state_matrix(self) -> Array:
        """State matrix (..., 2 n, 2 n) of ``q`` and ``q'`` while all elements are elastic."""
        cells = self.mass.shape[:-1]
        n = self.mass.shape[-1]
        matrix = np.zeros((*cells, 2 * n, 2 * n))
        matrix[..., :n, n:] = np.eye(n)
        matrix[..., n:, :n] = -self.stiffness / self.mass[..., None]
        matrix[..., n:, n:] = -self.damping / self.mass[..., None]
        return matrix

    @property
    def slowest_decay(self) -> float:
        """The longest time in which an elastic vibration of one system decays to 1/e [s]."""
        return 1 / float(-np.linalg.eigvals(self.state_matrix).real.max())

    def modes(self) -> Modes:
        """Modes of one system, each with the displacement of floors by its participation factor."""
        root = np.sqrt(self.mass)
        squares, vectors = scipy.linalg.eigh(self.stiffness / np.outer(root, root))
        w = np.sqrt(squares)
        shapes = vectors / root[:, None]
        damping = np.einsum("in,ij,jn->n", shapes, self.damping, shapes) / (2 * w)
        return Modes(2 * np.pi / w, damping, (self.shapes @ shapes) * (self.mass @ shapes))

    def over_cells(self, count: int) -> System:
        """The structures with a leading axis of so many cells."""
        mass, damping, extensions, shapes, *springs = self
        rows = (np.broadcast_to(row, (count, row.shape[-1])) for row in (mass, *springs))
        wide = np.broadcast_to(damping, (count, *damping.shape[-2:]))
        mass, *springs = rows
        return System(mass, wide, extensions, shapes, *springs)

    def at(self, cells: Any) -> System:
        """The cells with these numbers."""
        mass, damping, extensions, shapes, *springs = self
        of_springs = (part[cells] for part in springs)
        return System(mass[cells], damping[cells], extensions, shapes, *of_springs)
