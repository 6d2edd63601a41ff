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
ENTRIES = AXES * (AXES + 1) // 2  # of a symmetric matrix over these axes
MIDDLE = 2 / 3  # q at which the weight w of eq. (13) is a half
WEIGHT = 0.5  # weight of eq. (12) beside eq. (11), whose errors are equal and independent
SAFE = 0.12  # margin on ln(1 - rho), up to twice this for structures independent of the references


class Nearness(NamedTuple):
    """The quantities of a structure in eqs. (12) and (13)."""

    place: Array  # (AXES, ...) logarithms of its properties
    matrix: Array  # (ENTRIES, ...) lower triangle of the matrix G of eq. (12), row by row
    trust: Array  # factor from 0 to 1 on the weight of eq. (13)


def by_nearness(rho: Array, first: Nearness, second: Nearness, unseen: Array) -> tuple[Array, Array]:
    """Correlation of pairs by eq. (13), which changes ``rho`` of nearly equal structures only.

    Also returned is the weight ``w`` of eq. (12) in it. ``unseen`` is the share of the variances of both
    structures that is independent of the references, ``f`` in eq. (13).
    """
    q, n = 0.0 * first.trust, 0
    for i in range(AXES):
        apart = first.place[i] - second.place[i]
        for j in range(i + 1):
            entry = (first.matrix[n] + second.matrix[n]) / 2
            q = q + (1.0 if i == j else 2.0) * entry * apart * (first.place[j] - second.place[j])
            n += 1
    share = first.trust * second.trust / (1 + (q / MIDDLE) ** 2)
    left = 1 - rho
    apart = np.log(q / (1 + q) / left)
    known = np.isfinite(apart) & (share > 0)
    mixed = 1 - left * np.exp(share * (WEIGHT * apart + SAFE * (1 + unseen)))
    return np.where(known, mixed, rho), np.where(known, share, 0.0)
