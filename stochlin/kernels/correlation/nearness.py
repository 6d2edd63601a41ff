"""Correlation of structures that are nearly equal: how fast it falls with what they differ in.

Of two structures that differ little, what they do not share is small, and a small difference of large
numbers in any theory of both. It can be simulated for itself: ``1 - rho`` is a quadratic form in the
differences of the logarithms of period, strength, hardening and damping, and its matrix belongs to one
structure. ``docs/drift.md`` has the equations, (12) and (13).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array

AXES = 4  # period, strength, hardening, damping
PAIRS = tuple((i, j) for i in range(AXES) for j in range(i))
ENTRIES = AXES + len(PAIRS)
LEAST = 1e-3  # eigenvalue of the correlations of the slopes
NEAR, FAR = 0.3, 1.5  # the form up to which it counts in full, and from which on it does not
WEIGHT = 0.5  # beside the other estimate, in the logarithm: both err alike, and independently
SAFE = 0.12  # and so far on the safe side, once more where references see nothing of both


class Nearness(NamedTuple):
    """What is known of one structure, for the correlation with others like it."""

    place: Array  # (AXES, n) logarithms of its properties
    form: Array  # (ENTRIES, n) logarithms of the slopes, and the correlations of these: eq. (12)
    trust: Array  # (n,) share of what it says that counts, 0 to 1


def form_of(share: Array, steps: Array) -> Array:
    """Slopes and their correlations (ENTRIES, n) from ``1 - rho`` (AXES + 1, AXES + 1, n) of neighbours.

    The first of them is without any of the ``steps``, the others with one each.
    """
    share = np.clip(share, 0, 0.95)
    form = share / (1 - share)
    matrix = (form[0, 1:, None] + form[0, None, 1:] - form[1:, 1:]) / 2
    matrix = np.moveaxis(matrix, -1, 0)
    slopes, across = _parted(matrix)
    values, vectors = np.linalg.eigh(across)
    # Noise may have made it no form.
    _, across = _parted((vectors * np.maximum(values, LEAST)[:, None]) @ np.swapaxes(vectors, 1, 2))
    return np.stack([*np.log(slopes.T / steps[:, None]), *(across[:, i, j] for i, j in PAIRS)])


def _parted(matrix: Array) -> tuple[Array, Array]:
    """Square roots of the diagonals (n, k), and the matrices (n, k, k) without them."""
    slopes = np.sqrt(np.diagonal(matrix, axis1=1, axis2=2))
    return slopes, matrix / (slopes[:, :, None] * slopes[:, None])


def with_nearness(
    rho: Array, first: Nearness, second: Nearness, unseen: Array | float
) -> tuple[Array, Array, Array]:
    """``rho`` of pairs, nearly equal ones by their own forms too, eq. (13).

    Also the share of the forms in it, and by how much they would move the logarithm of ``1 - rho`` of
    those that are nearest. ``unseen`` is the share of the variances of both that no reference sees.
    """
    form: Array = (_form(first, second, first) + _form(first, second, second)) / 2
    share = np.clip(np.log(FAR / form) / np.log(FAR / NEAR), 0, 1) * first.trust * second.trust
    left = 1 - rho
    apart = np.log(form / (1 + form) / left)
    known = np.isfinite(apart) & (share > 0)
    share, apart = np.where(known, share, 0.0), np.where(known, apart, 0.0)
    mixed = 1 - left * np.exp(share * (WEIGHT * apart + SAFE * (1 + unseen)))
    return np.where(known, mixed, rho), share, share * apart


def _form(first: Nearness, second: Nearness, told: Nearness) -> Array:
    """The quadratic form of the difference, by what one of both tells."""
    apart = [
        np.exp(slope) * (one - other)
        for slope, one, other in zip(told.form, first.place, second.place, strict=False)
    ]
    own: Array = sum(x * x for x in apart)
    return own + 2 * sum(
        across * apart[i] * apart[j] for across, (i, j) in zip(told.form[AXES:], PAIRS, strict=True)
    )
