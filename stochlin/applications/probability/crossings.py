"""Probabilities of pounding by crossing theory, from the second moments over a finite motion."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.optimize import elementwise

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress
from stochlin.kernels.linearization.systems.response import StationaryResponse
from stochlin.kernels.linearization.transient import Difference
from stochlin.kernels.probability.crossings import accumulated, exceeding, hazards
from stochlin.models.grounds import Ground
from stochlin.models.systems import Arrangement
from stochlin.solver.linearization.systems.state_space import Equations
from stochlin.solver.linearization.transient_systems import TimeGrid, TransientMoments, ground_of

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


class RelativeMotion(NamedTuple):
    """Motion ``u_1 - u_2`` of p pairs, in k strengths of the motion, strength by strength.

    The ``drift`` is the difference of the plastic drifts, which the second moments ``both`` lack. In a
    motion, this slow part is its growing standard deviation times one Gaussian random number. It reduces
    the gap, and the probabilities of no pounding are averaged over it.
    """

    both: Difference  # second moments (times, k p)
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
    moments: TransientMoments, pairs: Array, ground: Ground, progress: Progress | None = None
) -> Array:
    """Bandwidth [-] of ``u_1 - u_2`` over (times, pairs h), with h heights.

    At each instant it is that of the stationary response of the equivalent linear systems at this
    instant, since their spectrum develops within a few periods.
    """
    times, own = moments.course.times, moments.own
    elastic = not own.relaxation.any() and not own.slip.any()
    chosen = np.unique(np.linspace(0, times.size - 1, 1 if elastic else INSTANTS).astype(int))
    first, second = moments.sides
    seen, count = np.hstack([first.seen, -second.seen]), pairs.shape[1]
    spectral = np.full((3, chosen.size, count, len(seen)), np.nan)
    for number in range(count):
        stacks = first.stack_at(number), second.stack_at(number)
        begins = number * first.elements, count * first.elements + number * second.elements
        storeys = [b + np.arange(s.coordinates) for b, s in zip(begins, stacks, strict=True)]
        at = np.concatenate(storeys)
        equations = Equations(Arrangement(stacks, ()), ground_of(ground, first.ground, number))
        for place, instant in enumerate(chosen):
            slip, relaxation = own.slip[instant, at], own.relaxation[instant, at]
            space = equations.state_space(slip - 1, relaxation, equations.yields)
            of_space = StationaryResponse(space).spectral_moments(seen)
            spectral[:, place, number] = np.stack(of_space)[:, 0]
        if progress is not None:
            progress((number + 1) / count)
    with np.errstate(invalid="ignore", divide="ignore"):
        l0, l1, l2 = spectral.reshape(3, chosen.size, -1)
        narrow = 1 - l1**2 / (l0 * l2)
    # NaN, for structures that move together, becomes 1: crossings are then independent.
    table = np.sqrt(np.clip(np.nan_to_num(narrow, nan=1.0), 0, 1))
    if elastic:
        return np.broadcast_to(table, (times.size, table.shape[1]))
    return np.stack([np.interp(times, times[chosen], column) for column in table.T], axis=1)
