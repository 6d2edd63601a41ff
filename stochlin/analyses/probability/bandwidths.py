"""Bandwidth of the relative displacement of two structures in a finite motion, instant by instant."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from stochlin.analyses.linearization.systems.state_space import Equations
from stochlin.analyses.linearization.transient_systems import (
    Moments,
    ground_of,
    grounds_of,
    oscillators_of,
)
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization.augmented import Solved
from stochlin.kernels.linearization.covariance import EquivalentSystem, Forcing, linear_system
from stochlin.kernels.linearization.lyapunov import UnsolvableError
from stochlin.kernels.linearization.spectral_moments import SpectralMoments, difference_moments
from stochlin.models.grounds import Ground
from stochlin.models.systems import System

INSTANTS = 13  # at which the bandwidth of yielding structures is found
NO_SLIP = 1e-12  # coefficients below are those of an elastic structure


def bandwidths(moments: Moments, pairs: Array, ground: Ground) -> Array:
    """Bandwidth of ``u_1 - u_2`` over (times, pairs h).

    That of the stationary response of the systems that hold at the instant: their spectrum forms
    within a few periods.
    """
    times, own = moments.course.times, moments.own
    elastic = not own.relaxation.any() and not own.slip.any()
    chosen = np.unique(np.linspace(0, times.size - 1, 1 if elastic else INSTANTS).astype(int))
    of_pairs = _of_storeys if any(side.has_storeys for side in moments.sides) else _of_oscillators
    spectrum = of_pairs(moments, pairs, ground)
    found = []
    for instant in chosen:
        with np.errstate(invalid="ignore", divide="ignore"):
            l0, l1, l2 = spectrum(own.slip[instant], own.relaxation[instant])
            narrow = 1 - l1**2 / (l0 * l2)
        # Structures that move as one have no bandwidth of their difference: independent crossings.
        found.append(np.sqrt(np.clip(np.nan_to_num(narrow, nan=1.0), 0, 1)))
    at = times[chosen]
    if at.size == 1:
        return np.broadcast_to(found[0], (times.size, found[0].size))
    place = np.clip(np.searchsorted(at, times, side="right") - 1, 0, at.size - 2)
    share = ((times - at[place]) / (at[place + 1] - at[place]))[:, None]
    table = np.stack(found)
    return (1 - share) * table[place] + share * table[place + 1]


Spectrum = Callable[[Array, Array], SpectralMoments]  # of the differences, by slip and relaxation


def _of_oscillators(moments: Moments, pairs: Array, ground: Ground) -> Spectrum:
    """In closed form, all pairs at once."""
    period, damping, hardening, uy, _ = oscillators_of(moments.sides)
    below = ground.filter(grounds_of(moments.sides))
    below_pair = below.at(pairs[0])
    w = 2 * np.pi / period
    still = linear_system(w, damping)
    coupling = np.where(np.isinf(uy), 0.0, (1 - hardening) * w**2)

    def spectrum(slip: Array, relaxation: Array) -> SpectralMoments:
        yielding = EquivalentSystem(w**2, still.damping, coupling, slip, relaxation)
        slips = (slip > NO_SLIP) & (relaxation > NO_SLIP * w)
        system = EquivalentSystem(*(np.where(slips, y, s) for y, s in zip(yielding, still, strict=True)))
        forcing = below.forcing(system)
        (first, force_1), (second, force_2) = (
            (EquivalentSystem(*(x[side] for x in system)), Forcing(*(x[side] for x in forcing)))
            for side in pairs
        )
        return difference_moments(first, force_1, second, force_2, below_pair)

    return spectrum


def _of_storeys(moments: Moments, pairs: Array, ground: Ground) -> Spectrum:
    """Pair by pair, at all heights; nothing where the weight leaves no stationary motion."""
    one, two = moments.sides
    seen, cells = np.hstack([one.seen, -two.seen]), one.cells.period.size
    widest = max(one.seen.shape[1], two.seen.shape[1])
    systems = []
    for i, j in pairs.T:
        stacks = one.stack(int(i)), two.stack(int(j) - cells)
        storeys = [n * widest + np.arange(s.mass.size) for n, s in zip((i, j), stacks, strict=True)]
        equations = Equations(System(stacks, ()), ground_of(ground, one.ground, int(i)))
        rate = np.sqrt(np.concatenate([stack.elastic / stack.mass for stack in stacks]))
        systems.append((equations, np.concatenate(storeys), NO_SLIP * rate))

    def spectrum(slip: Array, relaxation: Array) -> SpectralMoments:
        found = np.full((3, pairs.shape[1], len(seen)), np.nan)
        for number, (equations, storeys, least) in enumerate(systems):
            c, k = slip[storeys], relaxation[storeys]
            try:
                solved = Solved(equations.augmented(c - 1, k, (c > NO_SLIP) & (k > least)))
            except UnsolvableError:
                continue
            found[:, number] = solved.spectral_moments(seen)
        return SpectralMoments(*found.reshape(3, -1))

    return spectrum
