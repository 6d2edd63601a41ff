"""Probabilities of pounding from the moments of a finite motion, cell by cell."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.optimize import elementwise

from stochlin.analyses.linearization.transient_systems import (
    Course,
    Moments,
    grounds_of,
    oscillators_of,
)
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization.covariance import EquivalentSystem, Forcing, linear_system
from stochlin.kernels.linearization.spectral_moments import difference_moments
from stochlin.kernels.linearization.transient import Difference
from stochlin.kernels.probability.crossings import accumulated, exceeding, hazards
from stochlin.models.grounds import Ground

INSTANTS = 13  # at which the bandwidth of yielding structures is found
NO_SLIP = 1e-12  # coefficients below are those of an elastic structure
AT_ONCE = 400_000  # cells times instants
WIDEST, NARROWEST = 14.0, 1e-3  # gaps searched, over the largest standard deviation
CLOSE = 1e-5  # relative, of the gap that is searched
LEAST_LEVEL = 1e-6  # of the gap: what is left of it where the drift alone takes it up
_NODES, _WEIGHTS = np.polynomial.hermite_e.hermegauss(5)  # of the drift; 31 change .04 at most
_WEIGHTS = _WEIGHTS / _WEIGHTS.sum()


class Chances(NamedTuple):
    """Over (instants of the result, cells)."""

    now: Array  # probability of being beyond the gap
    poisson: Array  # confidence of no pounding so far
    vanmarcke: Array


def bandwidths(moments: Moments, pairs: Array, ground: Ground) -> Array:
    """Bandwidth of ``u_1 - u_2`` over (times, pairs).

    That of the stationary response of the systems that hold at the instant: their spectrum forms
    within a few periods.
    """
    times = moments.course.times
    own = moments.own
    elastic = not own.relaxation.any() and not own.slip.any()
    chosen = np.unique(np.linspace(0, times.size - 1, 1 if elastic else INSTANTS).astype(int))
    period, damping, hardening, uy, _ = oscillators_of(moments.sides)
    below = ground.filter(grounds_of(moments.sides))
    below_pair = below.at(pairs[0])
    w = 2 * np.pi / period
    still = linear_system(w, damping)
    coupling = np.where(np.isinf(uy), 0.0, (1 - hardening) * w**2)
    found = []
    for instant in chosen:
        slip, relaxation = own.slip[instant], own.relaxation[instant]
        yielding = EquivalentSystem(w**2, still.damping, coupling, slip, relaxation)
        slips = (slip > NO_SLIP) & (relaxation > NO_SLIP * w)
        system = EquivalentSystem(*(np.where(slips, y, s) for y, s in zip(yielding, still, strict=True)))
        forcing = below.forcing(system)
        (first, force_1), (second, force_2) = (
            (EquivalentSystem(*(x[side] for x in system)), Forcing(*(x[side] for x in forcing)))
            for side in pairs
        )
        with np.errstate(invalid="ignore", divide="ignore"):
            l0, l1, l2 = difference_moments(first, force_1, second, force_2, below_pair)
            narrow = 1 - l1**2 / (l0 * l2)
        # Structures that move as one have no bandwidth of their difference: independent crossings.
        found.append(np.sqrt(np.clip(np.nan_to_num(narrow, nan=1.0), 0, 1)))
    at = times[chosen]
    if at.size == 1:
        return np.broadcast_to(found[0], (times.size, pairs.shape[1]))
    place = np.clip(np.searchsorted(at, times, side="right") - 1, 0, at.size - 2)
    share = ((times - at[place]) / (at[place + 1] - at[place]))[:, None]
    table = np.stack(found)
    return (1 - share) * table[place] + share * table[place + 1]


def chances(
    both: Difference, bandwidth: Array, drift: Array, gap: Array, pair: Array, course: Course
) -> Chances:
    """Probabilities for gaps (c,) [m] and the pair of each.

    ``drift`` (times, pairs) is the variance [m^2] of a slow part that ``both`` lacks. Within one motion
    it is one Gaussian number times its growing standard deviation: it moves the gap, and the
    probabilities of no pounding are averaged over it.
    """
    shape = (course.shown.size, gap.size)
    result = Chances(np.empty(shape), np.zeros(shape), np.zeros(shape))
    step = max(1, AT_ONCE // course.times.size)
    for begin in range(0, gap.size, step):
        cells = slice(begin, begin + step)
        which = pair[cells]
        moments = (both.d_d[:, which], both.d_v[:, which], both.v_v[:, which])
        slow = drift[:, which]
        result.now[:, cells] = exceeding(gap[cells], (moments[0] + slow)[course.shown])
        nodes = zip(_NODES, _WEIGHTS, strict=True) if slow.any() else ((0.0, 1.0),)
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
    both: Difference, bandwidth: Array, drift: Array, confidence: float, course: Course
) -> Array:
    """Gap (p,) [m] that keeps the confidence to the end, crossings in clumps; 0 where nothing moves."""
    known = np.isfinite(drift).all(axis=0)
    widest = np.sqrt(np.max(both.d_d + np.nan_to_num(drift), axis=0))
    moving = np.flatnonzero((widest > 0) & known)
    required = np.where(known, 0.0, np.nan)
    last = course._replace(shown=course.shown[-1:])

    def off(level: Array, pair: Array) -> Array:
        which = pair.astype(int)
        gap = (level * widest[which]).ravel()
        found = chances(both, bandwidth, drift, gap, which.ravel(), last)
        return (found.vanmarcke[0] - confidence).reshape(level.shape)

    root = elementwise.find_root(
        off,
        (np.full(moving.size, NARROWEST), np.full(moving.size, WIDEST)),
        args=(moving.astype(float),),
        tolerances={"xrtol": CLOSE},
    )
    required[moving] = np.where(root.success, root.x * widest[moving], np.nan)
    return required
