"""Bandwidth of the relative displacement of two structures over time in a finite motion."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from stochlin.analyses.linearization.systems.state_space import Equations
from stochlin.analyses.linearization.transient_systems import (
    TransientMoments,
    ground_of,
    grounds_of,
    oscillators_of,
)
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress
from stochlin.kernels.linearization.covariance import EquivalentSystem, Forcing, linear_system
from stochlin.kernels.linearization.spectral_moments import SpectralMoments, difference_moments
from stochlin.kernels.linearization.systems.response import StationaryResponse
from stochlin.models.grounds import Ground
from stochlin.models.systems import Arrangement

INSTANTS = 13  # instants at which the bandwidth of yielding structures is computed
NO_SLIP = 1e-12  # equivalent coefficients below which a structure counts as elastic


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
    of_pairs = _of_storeys if any(side.has_storeys for side in moments.sides) else _of_oscillators
    spectrum = of_pairs(moments, pairs, ground)
    widths = []
    for done, instant in enumerate(chosen, start=1):
        with np.errstate(invalid="ignore", divide="ignore"):
            l0, l1, l2 = spectrum(own.slip[instant], own.relaxation[instant])
            narrow = 1 - l1**2 / (l0 * l2)
        # NaN, for structures that move together, becomes 1: crossings are then independent.
        widths.append(np.sqrt(np.clip(np.nan_to_num(narrow, nan=1.0), 0, 1)))
        if progress is not None:
            progress(done / chosen.size)
    at = times[chosen]
    if at.size == 1:
        return np.broadcast_to(widths[0], (times.size, widths[0].size))
    place = np.clip(np.searchsorted(at, times, side="right") - 1, 0, at.size - 2)
    share = ((times - at[place]) / (at[place + 1] - at[place]))[:, None]
    table = np.stack(widths)
    return (1 - share) * table[place] + share * table[place + 1]


# Spectral moments of u_1 - u_2 as a function of the coefficients 1 + c_eq and k_eq.
Spectrum = Callable[[Array, Array], SpectralMoments]


def _of_oscillators(moments: TransientMoments, pairs: Array, ground: Ground) -> Spectrum:
    """Spectral moments of all pairs of oscillators at once; NaN without a stationary response."""
    period, damping, hardening, uy = oscillators_of(moments.sides)
    below = ground.filter(grounds_of(moments.sides))
    below_pair = below.at(pairs[0])
    w = 2 * np.pi / period
    still = linear_system(w, damping)
    coupling = np.where(np.isinf(uy), 0.0, (1 - hardening) * w**2)
    drift_away = (hardening <= 0)[pairs].any(axis=0)

    def spectrum(slip: Array, relaxation: Array) -> SpectralMoments:
        yielding = EquivalentSystem(w**2, still.damping, coupling, slip, relaxation)
        slips = (slip > NO_SLIP) & (relaxation > NO_SLIP * w)
        system = EquivalentSystem(*(np.where(slips, y, s) for y, s in zip(yielding, still, strict=True)))
        forcing = below.forcing(system)
        (first, force_1), (second, force_2) = (
            (EquivalentSystem(*(x[side] for x in system)), Forcing(*(x[side] for x in forcing)))
            for side in pairs
        )
        found = difference_moments(first, force_1, second, force_2, below_pair)
        return SpectralMoments(*(np.where(drift_away, np.nan, moment) for moment in found))

    return spectrum


def _of_storeys(moments: TransientMoments, pairs: Array, ground: Ground) -> Spectrum:
    """Spectral moments of pairs with storeys, at all heights; NaN without a stationary response."""
    first, second = moments.sides
    seen, cells = np.hstack([first.seen, -second.seen]), first.period.size
    systems = []
    for i, j in pairs.T:
        stacks = first.stack_at(int(i)), second.stack_at(int(j) - cells)
        begins = i * first.elements, cells * first.elements + (j - cells) * second.elements
        storeys = [b + np.arange(s.coordinates) for b, s in zip(begins, stacks, strict=True)]
        equations = Equations(Arrangement(stacks, ()), ground_of(ground, first.ground, int(i)))
        systems.append((equations, np.concatenate(storeys)))

    def spectrum(slip: Array, relaxation: Array) -> SpectralMoments:
        spectral = np.full((3, pairs.shape[1], len(seen)), np.nan)
        for number, (equations, storeys) in enumerate(systems):
            c, k = slip[storeys], relaxation[storeys]
            response = StationaryResponse(equations.state_space(c - 1, k, equations.yields))
            spectral[:, number] = np.stack(response.spectral_moments(seen))[:, 0]
        return SpectralMoments(*spectral.reshape(3, -1))

    return spectrum
