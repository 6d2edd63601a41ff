"""Correlation of nearly equal structures, by a quadratic form in the differences of their properties.

For two structures that differ little, ``1 - rho`` is a small difference of large numbers in any theory
of their covariance, but it can be simulated directly. By eq. (12) of ``docs/drift.md``,
``1 - rho = q/(1 + q)``, where ``q`` is a quadratic form in the differences of the logarithms of period,
strength, hardening and damping. Its matrix belongs to one structure. Eq. (13) combines this with the
correlation by signatures.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array

AXES = 4  # period, strength, hardening, damping
PAIRS = tuple((i, j) for i in range(AXES) for j in range(i))
ENTRIES = AXES + len(PAIRS)  # of a symmetric matrix over these axes
LEAST = 1e-3  # smallest eigenvalue of the correlations, to which smaller ones are raised
MIDDLE = 2 / 3  # q at which the weight w of eq. (13) is a half
WEIGHT = 0.5  # weight of eq. (12) beside eq. (11), whose errors are equal and independent
SAFE = 0.12  # margin on ln(1 - rho), up to twice this for structures independent of the references


class Nearness(NamedTuple):
    """The quantities of one structure in eqs. (12) and (13)."""

    place: Array  # (AXES, n) logarithms of its properties
    # (ENTRIES, n): the matrix G of eq. (12), as logarithms of the square roots of its diagonal (slopes),
    # and the correlations that remain
    form: Array
    trust: Array  # (n,) factor from 0 to 1 on the weight of eq. (13)


def form_of(share: Array, steps: Array) -> Array:
    """``Nearness.form`` (ENTRIES, n) from simulated groups of five nearly equal structures.

    ``share`` (AXES + 1, AXES + 1, n) is ``1 - rho`` of the pairs in each group. The first structure is
    that of the form; each of the others differs from it by one of the ``steps`` (AXES,) of the
    logarithms.
    """
    share = np.clip(share, 0, 0.95)
    form = share / (1 - share)
    matrix = (form[0, 1:, None] + form[0, None, 1:] - form[1:, 1:]) / 2
    matrix = np.moveaxis(matrix, -1, 0)
    slopes, across = _parted(matrix)
    values, vectors = np.linalg.eigh(across)
    # By statistical errors the matrix may not be positive definite.
    _, across = _parted((vectors * np.maximum(values, LEAST)[:, None]) @ np.swapaxes(vectors, 1, 2))
    return np.stack([*np.log(slopes.T / steps[:, None]), *(across[:, i, j] for i, j in PAIRS)])


def _parted(matrix: Array) -> tuple[Array, Array]:
    """Square roots of the diagonals (n, k) of matrices (n, k, k), and the matrices scaled by them."""
    slopes = np.sqrt(np.diagonal(matrix, axis1=1, axis2=2))
    return slopes, matrix / (slopes[:, :, None] * slopes[:, None])


def with_nearness(
    rho: Array, first: Nearness, second: Nearness, unseen: Array | float
) -> tuple[Array, Array]:
    """Correlation of pairs by eq. (13), which changes ``rho`` of nearly equal structures only.

    Also returned is the weight ``w`` of eq. (12) in it. ``unseen`` is the share of the variances of both
    structures that is independent of the references, ``f`` in eq. (13).
    """
    form: Array = (_form(first, second, first) + _form(first, second, second)) / 2
    share = first.trust * second.trust / (1 + (form / MIDDLE) ** 2)
    left = 1 - rho
    apart = np.log(form / (1 + form) / left)
    known = np.isfinite(apart) & (share > 0)
    share, apart = np.where(known, share, 0.0), np.where(known, apart, 0.0)
    mixed = 1 - left * np.exp(share * (WEIGHT * apart + SAFE * (1 + unseen)))
    return np.where(known, mixed, rho), share


def eased(share: Array) -> Array:
    """A share that rises smoothly from 0 to 1 where ``share`` does; 0 or 1 beyond."""
    share = np.clip(share, 0, 1)
    return share * share * (3 - 2 * share)


def _form(first: Nearness, second: Nearness, reference: Nearness) -> Array:
    """``q`` of eq. (12) for two structures, with the matrix ``G`` of the structure ``reference``."""
    apart = [
        np.exp(slope) * (place_1 - place_2)
        for slope, place_1, place_2 in zip(reference.form, first.place, second.place, strict=False)
    ]
    own: Array = sum(x * x for x in apart)
    return own + 2 * sum(
        across * apart[i] * apart[j] for across, (i, j) in zip(reference.form[AXES:], PAIRS, strict=True)
    )
