"""Probabilities of pounding by crossing theory, from the second moments over a finite motion."""

from __future__ import annotations

import itertools
from typing import NamedTuple

import numpy as np
from scipy.optimize import elementwise

from stochlin.analyses.linearization.transient_systems import TimeGrid
from stochlin.analyses.probability.strengths import ALONE
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization.transient import Difference
from stochlin.kernels.probability.crossings import accumulated, exceeding, hazards

AT_ONCE = 400_000  # cells times instants that are computed at once
WIDEST, NARROWEST = 14.0, 1e-3  # bounds of a gap in a search, over the largest standard deviation
CLOSE = 1e-5  # relative tolerance of the search
LEAST_LEVEL = 1e-6  # least share of the gap that remains if the drift alone closes it
# Gauss-Hermite quadrature over the drift; with 31 nodes probabilities change by 0.04 at most.
_NODES, _WEIGHTS = np.polynomial.hermite_e.hermegauss(5)
_WEIGHTS = _WEIGHTS / _WEIGHTS.sum()


class Chances(NamedTuple):
    """Probabilities over (instants of the result, cells)."""

    now: Array  # probability that u_1 - u_2 exceeds the gap at the instant
    poisson: Array  # confidence of no pounding until the instant, for independent crossings
    vanmarcke: Array  # confidence of no pounding until the instant, for crossings in clumps


def chances(
    both: Difference,
    bandwidth: Array,
    drift: Array,
    gap: Array,
    pair: Array,
    course: TimeGrid,
    weights: Array = ALONE,
) -> Chances:
    """Probabilities of exceeding gaps, and of no pounding.

    Parameters
    ----------
    both : Difference
        Second moments of ``u_1 - u_2`` (times, k p), for p pairs and k strengths of the motion, strength
        by strength.
    bandwidth : Array
        Bandwidth (times, k p) [-] of ``u_1 - u_2``.
    drift : Array
        Variance (times, k p) [m^2] of the difference of the plastic drifts, which ``both`` lacks. In a
        motion, this slow part is its growing standard deviation times one Gaussian random number. It
        reduces the gap, and the probabilities of no pounding are averaged over it.
    gap, pair : Array
        Gaps (c,) [m] and the number of the pair (c,) of each.
    course : TimeGrid
        Instants of the motion.
    weights : Array
        Weights (k,) of the strengths of the motion, with the sum 1, for the mean probabilities.

    Returns
    -------
    Chances
        Probabilities (instants of the result, c).
    """
    shape = (course.shown.size, gap.size)
    result = Chances(*np.zeros((3, *shape)))
    step, pairs = max(1, AT_ONCE // course.times.size), drift.shape[1] // weights.size
    parts = itertools.product(range(0, gap.size, step), enumerate(weights))
    for begin, (strength, share) in parts:
        cells = slice(begin, begin + step)
        which = strength * pairs + pair[cells]
        moments = (both.d_d[:, which], both.d_v[:, which], both.v_v[:, which])
        slow = drift[:, which]
        result.now[:, cells] += share * exceeding(gap[cells], (moments[0] + slow)[course.shown])
        nodes = zip(_NODES, share * _WEIGHTS, strict=True) if slow.any() else ((0.0, share),)
        for number, weight in nodes:
            level = np.maximum(gap[cells] - number * np.sqrt(slow), LEAST_LEVEL * gap[cells])
            rates = hazards(level, *moments, bandwidth[:, which])
            with np.errstate(under="ignore"):
                for target, rate in zip((result.poisson, result.vanmarcke), rates, strict=True):
                    so_far = np.exp(-accumulated(rate, course.times)[course.shown])
                    target[:, cells] += weight * so_far
        unknown = ~np.isfinite(slow).all(axis=0)
        for target in result:
            target[:, cells] = np.where(unknown, np.nan, target[:, cells])
    return result


def gap_for(
    both: Difference,
    bandwidth: Array,
    drift: Array,
    confidence: float,
    course: TimeGrid,
    weights: Array = ALONE,
) -> Array:
    """Gap (p,) [m] for a confidence of no pounding in the motion; 0 without relative displacement.

    The crossings come in clumps. The other arguments are those of `chances`.
    """
    known = np.isfinite(drift).all(axis=0).reshape(weights.size, -1).all(axis=0)
    largest = np.sqrt(np.max(both.d_d + np.nan_to_num(drift), axis=0)).reshape(weights.size, -1)
    least, widest = largest.min(axis=0), largest.max(axis=0)
    moving = np.flatnonzero((widest > 0) & known)
    required = np.where(known, 0.0, np.nan)
    last = course._replace(shown=course.shown[-1:])

    def off(level: Array, pair: Array) -> Array:
        which = pair.astype(int)
        gap = (level * widest[which]).ravel()
        probabilities = chances(both, bandwidth, drift, gap, which.ravel(), last, weights)
        return (probabilities.vanmarcke[0] - confidence).reshape(level.shape)

    root = elementwise.find_root(
        off,
        (NARROWEST * (least / np.where(widest > 0, widest, 1.0))[moving], np.full(moving.size, WIDEST)),
        args=(moving.astype(float),),
        tolerances={"xrtol": CLOSE},
    )
    required[moving] = np.where(root.success, root.x * widest[moving], np.nan)
    return required
