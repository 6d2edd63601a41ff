"""Modes of a chain of storeys."""

from __future__ import annotations

import numpy as np
import scipy.linalg

from stochlin.kernels.basics.arrays import Array


def chain_modes(masses: Array, stiffnesses: Array) -> tuple[Array, Array]:
    """Circular frequencies [rad/s], and shapes of unit modal mass as columns (storeys, modes).

    A ValueError tells of stiffnesses over masses that are beyond all numbers.
    """
    root = np.sqrt(masses)
    with np.errstate(all="ignore"):
        diagonal = (stiffnesses + np.append(stiffnesses[1:], 0.0)) / root**2
        beside = -stiffnesses[1:] / (root[:-1] * root[1:])
    if not (np.isfinite(diagonal).all() and np.isfinite(beside).all()):
        raise ValueError(
            "stiffness over mass is beyond all numbers; check the units of masses and stiffnesses"
        )
    squares, vectors = scipy.linalg.eigh_tridiagonal(diagonal, beside)
    return np.sqrt(squares), vectors / root[:, None]
