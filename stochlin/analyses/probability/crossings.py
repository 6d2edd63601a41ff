"""Probabilities of pounding from the moments of a finite motion, cell by cell."""

from __future__ import annotations

import itertools
from typing import NamedTuple

import numpy as np
from scipy.optimize import elementwise

from stochlin.analyses.linearization.transient_systems import Course
from stochlin.analyses.probability.strengths import ALONE
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization.transient import Difference
from stochlin.kernels.probability.crossings import accumulated, exceeding, hazards

AT_ONCE = 400_000  # cells times instants
WIDEST, NARROWEST = 14.0, 1e-3  # gaps searched, over the largest standard deviation
CLOSE = 1e-5  # relative, of the gap that is searched
LEAST_LEVEL = 1e-6  # of the gap: what is left of it where the drift alone takes it up
_NODES, _WEIGHTS = np.polynomial.hermite_e.hermegauss(5)  # of the drift; 31 change 0.04 at most
_WEIGHTS = _WEIGHTS / _WEIGHTS.sum()


class Chances(NamedTuple):
    """Over (instants of the result, cells)."""

    now: Array  # probability of being beyond the gap
    poisson: Array  # confidence of no pounding so far
    vanmarcke: Array


def chances(
    both: Difference,
    bandwidth: Array,
    drift: Array,
    gap: Array,
    pair: Array,
    course: Course,
    weights: Array = ALONE,
) -> Chances:
    """Probabilities for gaps (c,) [m] and the pair of each.

    ``drift`` (times, pairs) is the variance [m^2] of a slow part that ``both`` lacks. Within one motion
    it is one Gaussian number times its growing standard deviation: it moves the gap, and the
    probabilities of no pounding are averaged over it. With several ``weights``, which add up to 1, the
    moments are those of as many strengths of the motion, all pairs of one after those of the other, and
    the probabilities are averaged over these, too.
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
    course: Course,
    weights: Array = ALONE,
) -> Array:
    """Gap (p,) [m] that keeps the confidence to the end, crossings in clumps; 0 where nothing moves."""
    known = np.isfinite(drift).all(axis=0).reshape(weights.size, -1).all(axis=0)
    largest = np.sqrt(np.max(both.d_d + np.nan_to_num(drift), axis=0)).reshape(weights.size, -1)
    least, widest = largest.min(axis=0), largest.max(axis=0)
    moving = np.flatnonzero((widest > 0) & known)
    required = np.where(known, 0.0, np.nan)
    last = course._replace(shown=course.shown[-1:])

    def off(level: Array, pair: Array) -> Array:
        which = pair.astype(int)
        gap = (level * widest[which]).ravel()
        found = chances(both, bandwidth, drift, gap, which.ravel(), last, weights)
        return (found.vanmarcke[0] - confidence).reshape(level.shape)

    root = elementwise.find_root(
        off,
        (NARROWEST * (least / np.where(widest > 0, widest, 1.0))[moving], np.full(moving.size, WIDEST)),
        args=(moving.astype(float),),
        tolerances={"xrtol": CLOSE},
    )
    required[moving] = np.where(root.success, root.x * widest[moving], np.nan)
    return required
