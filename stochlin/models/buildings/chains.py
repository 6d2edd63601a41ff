"""Modes of a chain of storeys, and the chain whose modes are nearest to given ones."""

from __future__ import annotations

import numpy as np
import scipy.linalg
import scipy.optimize

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


def fitted_stiffnesses(
    start: Array, masses: Array, frequencies: Array, shapes: Array, weights: Array
) -> Array:
    """Storey stiffnesses [N/m] by least squares, beginning with those of ``start``.

    Of each mode, the first ones of the chain in their order, the residuals are the difference of the
    logarithms of the circular frequencies [rad/s], and that of the shapes (modes, floors) of unit modal
    mass, times the root of the masses. Their squares are multiplied by the weight of the mode.
    """
    count, root = frequencies.size, np.sqrt(masses)
    wanted, factors = (shapes * root).T, np.sqrt(weights)

    def modes(logarithms: Array) -> tuple[Array, Array, Array]:
        stiffnesses = start * np.exp(logarithms)
        w, columns = chain_modes(masses, stiffnesses)
        columns = columns * root[:, None]
        columns[:, :count] *= np.where((columns[:, :count] * wanted).sum(axis=0) < 0, -1.0, 1.0)
        return stiffnesses, w, columns

    def residuals(logarithms: Array) -> Array:
        _, w, columns = modes(logarithms)
        of_shapes = factors * (columns[:, :count] - wanted)
        return np.append(factors * np.log(w[:count] / frequencies), of_shapes.T)

    def slopes(logarithms: Array) -> Array:
        """Derivatives of simple eigenvalues and their vectors, which those of a chain always are."""
        stiffnesses, w, columns = modes(logarithms)
        drifts = np.diff(columns / root[:, None], axis=0, prepend=0.0)
        of_frequencies, of_shapes = [], []
        for n in range(count):
            apart = w[n] ** 2 - w**2
            apart[n] = np.inf
            pull = stiffnesses * drifts[:, n]
            of_frequencies.append(factors[n] * 0.5 * pull * drifts[:, n] / w[n] ** 2)
            of_shapes.append(factors[n] * (columns / apart) @ (drifts * pull[:, None]).T)
        return np.concatenate([of_frequencies, *of_shapes])

    solution = scipy.optimize.least_squares(residuals, np.zeros(start.size), jac=slopes, xtol=1e-12)
    found: Array = start * np.exp(solution.x)
    return found
