"""Anderson's mixing of an iteration ``y = g(y)`` for many cells, with safeguards.

Plain substitution takes ``g(y)`` as the next ``y``, which may cycle without end. Mixing takes it for the
linear combination of the last rounds that has the least mismatch ``g(y) - y`` (Anderson 1965, J. ACM 12;
Walker and Ni 2011, SIAM J. Numer. Anal. 49). With no round to combine it is plain substitution.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array

LARGEST_STEP = 1.0  # in the logarithms of standard deviations and atanh of correlations
DEPENDENT = 1e-12  # square of the share of a round that others do not determine, below which it is left


class Mixing(NamedTuple):
    """State of c cells, with differences (d, u, c) between their last rounds; 0 if there is none."""

    base: Array  # (u, c) the last unknowns that have a stationary response
    mismatch: Array  # (u, c) at these; NaN before the first
    step: Array  # (u, c) the next unknowns less base
    moves: Array  # (d, u, c) steps from base to base
    changes: Array  # (d, u, c) of the mismatch with these steps

    @classmethod
    def begin(cls, weak: Array, unknowns: Array, depth: int) -> Mixing:
        """Before the first round; ``weak`` (u, c) have a stationary response in any case."""
        none = np.zeros((depth, *unknowns.shape))
        return cls(weak, np.full_like(unknowns, np.nan), unknowns - weak, none, none)

    @property
    def unknowns(self) -> Array:
        """Those of the next round (u, c)."""
        moved: Array = self.base + self.step
        return moved

    def at(self, cells: Array) -> Mixing:
        """The cells with these numbers."""
        return Mixing(*(part[..., cells] for part in self))

    def next(self, mismatch: Array, relaxation: float) -> Mixing:
        """After a round with this mismatch (u, c); without a response a quarter of the step is tried."""
        good = np.isfinite(mismatch).all(axis=0)
        both = good & np.isfinite(self.mismatch).all(axis=0)
        pairs = (self.moves, self.step), (self.changes, mismatch - self.mismatch)
        moves, changes = (
            np.concatenate([old, np.where(both, new, 0.0)[None]])[1:] for old, new in pairs
        )
        size = np.sqrt((changes**2).sum(axis=1))
        size[size == 0] = 1.0
        rows = (changes / size[:, None]).transpose(2, 0, 1)
        square = rows @ rows.swapaxes(1, 2) + DEPENDENT * np.eye(len(moves))
        right = rows @ np.where(good, mismatch, 0.0).T[..., None]
        weights = np.linalg.solve(square, right)[..., 0].T / size
        step = relaxation * mismatch - (weights[:, None] * (moves + relaxation * changes)).sum(axis=0)
        step /= np.maximum(1.0, np.abs(step).max(axis=0) / LARGEST_STEP)
        return Mixing(
            np.where(good, self.base + self.step, self.base),
            np.where(good, mismatch, self.mismatch),
            np.where(good, step, 0.25 * self.step),
            moves,
            changes,
        )
