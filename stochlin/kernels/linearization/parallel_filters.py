"""Independent grounds that act together, as one filter of one white noise."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.polynomial import polynomial
from scipy.linalg import block_diag

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization.filters import Filter

_ZERO = 1e-12  # of the largest: a coefficient that rounding alone has left


def in_parallel(filters: Sequence[Filter]) -> Filter:
    """One filter of the intensity 1, whose PSD is the sum of those of ``filters``.

    Gaussian motions are known by their PSD, so that one white noise through the spectral factor of the
    sum does for several independent ones through filters of their own. The states are those of all
    filters, driven by the same noise; what is sought is the output.

    Parameters
    ----------
    filters : sequence of Filter
        In numbers, of one state at least each.

    Returns
    -------
    Filter
        Its output has no zero with a positive real part.

    Raises
    ------
    ValueError
        If a filter has no states: with white noise itself the sum is no such filter.
    """
    parts = [one.arrays for one in filters]
    if not all(one.states for one in filters):
        raise ValueError("white noise in parallel with another ground; allowed: filtered grounds")
    scale = np.exp(np.mean([np.log(np.abs(np.linalg.eigvals(part.matrix))).mean() for part in parts]))
    poles = [polynomial.polyfromroots(np.linalg.eigvals(part.matrix) / scale).real for part in parts]
    total: Array = np.zeros(1)
    for i, (one, part) in enumerate(zip(filters, parts, strict=True)):
        own = _numerator(part.matrix / scale, part.noise, part.output, poles[i]) / scale
        both = _product([own, *poles[:i], *poles[i + 1 :]])
        total = polynomial.polyadd(total, float(one.intensity) * _square(both))
    matrix = block_diag(*(part.matrix for part in parts))
    noise = np.concatenate([part.noise for part in parts])
    output = _output(matrix / scale, noise, _factor(total), _product(poles)) * scale
    states = tuple(f"{name}_{i}" for i, one in enumerate(filters, 1) for name in one.states)
    return Filter(1.0, states, matrix.tolist(), noise.tolist(), output.tolist())


def _numerator(matrix: Array, noise: Array, output: Array, poles: Array) -> Array:
    """Of ``output (s - matrix)^-1 noise`` over ``poles``, by its Markov parameters."""
    size = len(noise)
    markov, moved = [], noise
    for _ in range(size):
        markov.append(output @ moved)
        moved = matrix @ moved
    # poles(s) (m0/s + m1/s^2 + ...) has no negative powers: the coefficient of s^k
    found = np.array([poles[k + 1 :] @ np.array(markov)[: size - k] for k in range(size)])
    return np.where(np.abs(found) > _ZERO * np.abs(found).max(), found, 0.0)


def _product(factors: Iterable[Array]) -> Array:
    total: Array = np.ones(1)
    for factor in factors:
        total = polynomial.polymul(total, factor)
    return total


def _square(values: Array) -> Array:
    """``p(s) p(-s)`` as a polynomial in ``s^2``."""
    mirrored = values * (-1.0) ** np.arange(values.size)
    return polynomial.polymul(values, mirrored)[::2]


def _factor(square: Array) -> Array:
    """``p(s)`` without zeros to the right, of ``p(s) p(-s)`` in ``s^2``."""
    used = np.flatnonzero(np.abs(square) > _ZERO * np.abs(square).max())
    low, high = used[0], used[-1]
    roots = -np.sqrt(polynomial.polyroots(square[low : high + 1]).astype(complex))
    factor = polynomial.polyfromroots(roots).real
    own = np.sqrt(np.abs(square[high])) * factor
    return np.concatenate([np.zeros(low), own])


def _output(matrix: Array, noise: Array, numerator: Array, denominator: Array) -> Array:
    """Output row that gives this transfer function, from its values on the imaginary axis."""
    size = len(noise)
    s = 1j * np.geomspace(1e-2, 1e2, 8 * size)
    states = np.linalg.solve(
        s[:, None, None] * np.eye(size) - matrix, np.broadcast_to(noise, (s.size, size))[..., None]
    )[..., 0]
    target = polynomial.polyval(s, numerator) / polynomial.polyval(s, denominator)
    weight = 1 / np.abs(target)
    left, right = states * weight[:, None], target * weight
    column = np.linalg.norm(left, axis=0)
    both = np.concatenate([left.real, left.imag]) / column
    found, *_ = np.linalg.lstsq(both, np.concatenate([right.real, right.imag]), rcond=None)
    return found / column
