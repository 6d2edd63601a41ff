"""Bandwidth of the relative displacement of two structures over time in a finite motion."""

from __future__ import annotations

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress
from stochlin.kernels.linearization.systems.response import StationaryResponse
from stochlin.models.grounds import Ground
from stochlin.models.systems import Arrangement
from stochlin.solver.linearization.systems.state_space import Equations
from stochlin.solver.linearization.transient_systems import TransientMoments, ground_of

INSTANTS = 13  # instants at which the bandwidth of yielding structures is computed


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
