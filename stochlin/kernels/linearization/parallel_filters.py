"""Independent grounds that act together, written as one filter of one white noise."""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce

import numpy as np
from numpy.polynomial import polynomial
from scipy.linalg import block_diag

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization.filters import Filter, resolvent

_ZERO = 1e-12  # coefficients of one ground below this share of the largest are rounding errors


def in_parallel(filters: Sequence[Filter]) -> Filter:
    """One filter of intensity 1, whose PSD is the sum of those of ``filters``.

    A stationary Gaussian motion is determined by its PSD. One white noise through a filter whose
    transfer function is the spectral factor of the sum therefore replaces several independent
    noises through filters of their own. The states are those of all filters, driven by the same
    noise; only the output has to be found.

    Parameters
    ----------
    filters : sequence of Filter
        With numbers as coefficients, and at least one state each.

    Returns
    -------
    Filter
        Its transfer function has no zero with a positive real part.

    Raises
    ------
    ValueError
        If a filter is white noise, without states.
    """
    parts = [component.arrays for component in filters]
    if not all(component.states for component in filters):
        raise ValueError("white noise in parallel with another ground; allowed: filtered grounds")
    logarithms = [np.log(np.abs(np.linalg.eigvals(part.matrix))).mean() for part in parts]
    scale = np.exp(np.mean(logarithms))
    poles = [
        polynomial.polyfromroots(np.linalg.eigvals(part.matrix) / scale).real for part in parts
    ]
    total: Array = np.zeros(1)
    for i, (component, part) in enumerate(zip(filters, parts, strict=True)):
        numerator = _numerator(part.matrix / scale, part.noise, part.output, poles[i]) / scale
        both = reduce(polynomial.polymul, [numerator, *poles[:i], *poles[i + 1 :]])
        square = polynomial.polymul(both, both * (-1.0) ** np.arange(both.size))[::2]  # in s^2
        total = polynomial.polyadd(total, float(component.intensity) * square)
    matrix = block_diag(*(part.matrix for part in parts))
    noise = np.concatenate([part.noise for part in parts])
    denominator = reduce(polynomial.polymul, poles)
    output = _output(matrix / scale, noise, _factor(total), denominator) * scale
    states = tuple(
        f"{name}_{i}" for i, component in enumerate(filters, 1) for name in component.states
    )
    return Filter(1.0, states, matrix.tolist(), noise.tolist(), output.tolist())


def _numerator(matrix: Array, noise: Array, output: Array, poles: Array) -> Array:
    """Numerator of ``output (s - matrix)^-1 noise`` over the polynomial ``poles``.

    It is found from the Markov parameters ``output matrix^k noise``.
    """
    size = len(noise)
    markov = np.array([output @ np.linalg.matrix_power(matrix, k) @ noise for k in range(size)])
    # The numerator is poles(s) (m0/s + m1/s^2 + ...) with the Markov parameters m; here the power
    # s^k.
    coefficients = np.array([poles[k + 1 :] @ markov[: size - k] for k in range(size)])
    return np.where(np.abs(coefficients) > _ZERO * np.abs(coefficients).max(), coefficients, 0.0)


def _factor(square: Array) -> Array:
    """Spectral factor ``p(s)`` without zeros of positive real part, from ``p(s) p(-s)`` in ``s^2``.

    Coefficients beyond the ends are exactly 0, as those of `_numerator` are. Small ones are none of
    rounding: they differ by more than digits have where the frequencies of grounds are far apart.
    """
    used = np.flatnonzero(square)
    low, high = used[0], used[-1]
    roots = -np.sqrt(polynomial.polyroots(square[low : high + 1]).astype(complex))
    factor = polynomial.polyfromroots(roots).real
    coefficients = np.sqrt(np.abs(square[high])) * factor
    return np.concatenate([np.zeros(low), coefficients])


def _output(matrix: Array, noise: Array, numerator: Array, denominator: Array) -> Array:
    """Output row of a filter of this transfer function, by least squares on the imaginary axis."""
    s = 1j * np.geomspace(1e-2, 1e2, 8 * len(noise))
    states = resolvent(s, matrix, noise)
    target = polynomial.polyval(s, numerator) / polynomial.polyval(s, denominator)
    weight = 1 / np.abs(target)
    left, right = states * weight[:, None], target * weight
    column = np.linalg.norm(left, axis=0)
    both = np.concatenate([left.real, left.imag]) / column
    solution, *_ = np.linalg.lstsq(both, np.concatenate([right.real, right.imag]), rcond=None)
    return solution / column
