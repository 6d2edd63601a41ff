"""Probabilities of pounding by crossing theory, from the second moments over a finite motion."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.optimize import elementwise

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress
from stochlin.kernels.linearization.systems.response import StationaryResponse
from stochlin.kernels.linearization.systems.state_space import state_space
from stochlin.kernels.linearization.transient import TransientMoments
from stochlin.kernels.probability.crossings import accumulated, exceeding, hazards
from stochlin.solver.linearization.systems.state_space import Equations
from stochlin.solver.linearization.transient_systems import TimeGrid

WIDEST, NARROWEST = 14.0, 1e-3  # bounds of a gap in a search, over the largest standard deviation
CLOSE = 1e-5  # relative tolerance of the search
LEAST_LEVEL = 1e-6  # least share of the gap that remains if the drift alone closes it
INSTANTS = 13  # instants at which the bandwidth of yielding structures is computed
# Gauss-Hermite quadrature over the drift; with 31 nodes probabilities change by 0.04 at most.
_NODES, _WEIGHTS = np.polynomial.hermite_e.hermegauss(5)
_WEIGHTS = _WEIGHTS / _WEIGHTS.sum()


class Chances(NamedTuple):
    """Probabilities over (instants of the result, cells)."""

    now: Array  # probability that u_1 - u_2 exceeds the gap at the instant
    vanmarcke: Array  # confidence of no pounding until the instant, for crossings in clumps
    poisson: Array  # confidence of no pounding until the instant, for independent crossings


class Difference(NamedTuple):
    """Second moments of ``d = u_1 - u_2`` over time, each (times, k p)."""

    d_d: Array  # [m^2]
    d_v: Array  # [m^2/s], E[d d']
    v_v: Array  # [m^2/s^2]
    product: Array  # [m^2], E[u_1 u_2]


class RelativeMotion(NamedTuple):
    """Motion ``u_1 - u_2`` of p pairs, in k strengths of the motion, strength by strength.

    The ``drift`` is the difference of the plastic drifts, which the second moments ``both`` lack. In a
    motion, this slow part is its growing standard deviation times one Gaussian random number. It reduces
    the gap, and the probabilities of no pounding are averaged over it.
    """

    both: Difference
    bandwidth: Array  # (times, k p) [-]
    drift: Array  # (times, k p) variance [m^2]
    course: TimeGrid
    weights: Array  # (k,) of the strengths of the motion, with the sum 1, for mean probabilities

    def mean(self, moments: Array) -> Array:
        """Mean (instants of the result, p) of moments (times, k p) over the strengths."""
        shown = moments[self.course.shown]
        mean: Array = np.einsum(
            "k,tkp->tp", self.weights, shown.reshape(len(shown), self.weights.size, -1)
        )
        return mean

    def chances(self, gap: Array, pair: Array) -> Chances:
        """Probabilities (instants of the result, c) of exceeding gaps, and of no pounding.

        ``gap`` and ``pair`` are gaps (c,) [m] and the number of the pair (c,) of each.
        """
        both, bandwidth, drift, course, weights = self
        result = Chances(*np.zeros((3, course.shown.size, gap.size)))
        for strength, share in enumerate(weights):
            which = strength * (drift.shape[1] // weights.size) + pair
            moments = both.d_d[:, which], both.d_v[:, which], both.v_v[:, which]
            slow = drift[:, which]
            result.now[:] += share * exceeding(gap, (moments[0] + slow)[course.shown])
            nodes = zip(_NODES, share * _WEIGHTS, strict=True) if slow.any() else ((0.0, share),)
            for number, weight in nodes:
                level = np.maximum(gap - number * np.sqrt(slow), LEAST_LEVEL * gap)
                rates = hazards(level, *moments, bandwidth[:, which])
                with np.errstate(under="ignore"):
                    for target, rate in zip((result.poisson, result.vanmarcke), rates, strict=True):
                        target[:] += weight * np.exp(-accumulated(rate, course.times)[course.shown])
            unknown = ~np.isfinite(slow).all(axis=0)
            for target in result:
                target[:, unknown] = np.nan
        return result

    def gap_for(self, confidence: float) -> Array:
        """Gap (p,) [m] for a confidence of no pounding in the motion; 0 without relative displacement.

        The crossings come in clumps.
        """
        both, _, drift, course, weights = self
        known = np.isfinite(drift).all(axis=0).reshape(weights.size, -1).all(axis=0)
        largest = np.sqrt(np.max(both.d_d + np.nan_to_num(drift), axis=0)).reshape(weights.size, -1)
        least, widest = largest.min(axis=0), largest.max(axis=0)
        moving = np.flatnonzero((widest > 0) & known)
        required = np.where(known, 0.0, np.nan)
        at_end = self._replace(course=course._replace(shown=course.shown[-1:]))

        def off(level: Array, pair: Array) -> Array:
            which = pair.astype(int)
            gap = (level * widest[which]).ravel()
            vanmarcke: Array = at_end.chances(gap, which.ravel()).vanmarcke[0]
            return (vanmarcke - confidence).reshape(level.shape)

        narrowest = NARROWEST * (least / np.where(widest > 0, widest, 1.0))[moving]
        root = elementwise.find_root(
            off,
            (narrowest, np.full(moving.size, WIDEST)),
            args=(moving.astype(float),),
            tolerances={"xrtol": CLOSE},
        )
        required[moving] = np.where(root.success, root.x * widest[moving], np.nan)
        return required


def bandwidths(
    moments: TransientMoments,
    equations: Equations,
    rows: Array,
    times: Array,
    progress: Progress | None = None,
) -> Array:
    """Bandwidth [-] over (times, k h) of h sums of coordinates with these weights, in k cells.

    At each instant it is that of the stationary response of the equivalent linear systems at this
    instant, since their spectrum develops within a few periods.
    """
    elastic = not moments.relaxation.any() and not moments.slip.any()
    chosen = np.unique(np.linspace(0, times.size - 1, 1 if elastic else INSTANTS).astype(int))
    mechanics, table = equations.mechanics(equations.yields), []
    for number, instant in enumerate(chosen, start=1):
        coefficients = moments.slip[instant] - 1, moments.relaxation[instant]
        space = state_space(mechanics, *coefficients, equations.dashpots)
        l0, l1, l2 = StationaryResponse(space).spectral_moments(rows)
        with np.errstate(invalid="ignore", divide="ignore"):
            narrow = 1 - l1**2 / (l0 * l2)
        # NaN, for structures that move together, becomes 1: crossings are then independent.
        table.append(np.sqrt(np.clip(np.nan_to_num(narrow, nan=1.0), 0, 1)).ravel())
        if progress is not None:
            progress(number / chosen.size)
    return np.stack([np.interp(times, times[chosen], column) for column in np.transpose(table)], axis=1)
