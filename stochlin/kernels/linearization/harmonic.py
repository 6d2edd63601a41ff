"""Amplitudes of two yielding structures under a slow harmonic load, by harmonic balance.

A stiff structure on a narrow band follows the ground and yields in few large cycles. Its
displacement is far from Gaussian, while the load is not: a level of ``u_1 - u_2`` is crossed as
often as the level of the load that causes it. Equation (20) of ``docs/drift.md``.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array

LOADS = np.linspace(0.02, 6, 150)  # amplitudes of the load over its standard deviation
RAYLEIGH = LOADS * np.exp(-0.5 * LOADS**2)
SIZES = np.geomspace(1e-3, 3e3, 500)  # amplitudes of a structure over its yield displacement
LEAST_INCREASE = 1e-9  # share by which amplitudes increase at least from each to the next
SLOPE_BEYOND_LOADS = 0.5  # slope of the levels of the load above the largest amplitude of the load
LEAST_LOAD_LEVEL = 1e-3  # of a level
# Shares of the load's level, over the damping ratio of the ground and over the smaller frequency of
# the structures, over that of the ground.
NARROW_DAMPING = (0.1, 0.2)
RATIOS_ABOVE = (1.0, 1.6)
RATIOS_FAR_ABOVE = (1.5, 3.0)


class Harmonic(NamedTuple):
    """A bilinear structure in harmonic motions of the amplitudes `SIZES`."""

    load: Array  # amplitude of the load [m/s^2]
    displacement: Array  # complex amplitude, with the phase against the load [m]

    @classmethod
    def of(
        cls, w: float, damping: float, hardening: float, yields_at: float, load_w: float
    ) -> Harmonic:
        """A structure with the frequency ``w`` at that of the load [rad/s]."""
        ratio = load_w / w
        yielding = SIZES > 1
        angle = np.arccos(1 - 2 / np.where(yielding, SIZES, 1.0))
        softer = (1 - hardening) / np.pi
        stiffness = np.where(yielding, hardening + softer * (angle - 0.5 * np.sin(2 * angle)), 1.0)
        loss = np.where(yielding, softer * np.sin(angle) ** 2, 0.0)
        dynamic = stiffness - ratio**2 + 1j * (2 * damping * ratio + loss)
        load = _rising(SIZES * np.abs(dynamic)) * w**2 * yields_at
        return cls(load, yields_at * SIZES * np.exp(-1j * np.angle(dynamic)))

    def at(self, load: Array) -> Array:
        """Complex amplitude of the displacement [m] at amplitudes of the load [m/s^2]."""
        real = np.interp(load, self.load, self.displacement.real)
        return real + 1j * np.interp(load, self.load, self.displacement.imag)


def share_of_load(frequencies: Array, ground: float, damping: float) -> float:
    """Share of the load's level; the structures have these frequencies, the ground this damping."""
    ratio = float(np.min(frequencies)) / ground
    rises = np.interp(ratio, RATIOS_ABOVE, (0, 1)) * np.interp(damping, NARROW_DAMPING, (1, 0))
    return float(max(rises, np.interp(ratio, RATIOS_FAR_ABOVE, (0, 1))))


def load_levels(structures: Sequence[Harmonic], std: float, share: float, levels: Array) -> Array:
    """Levels of a Gaussian process that is crossed as ``u_1 - u_2`` is at these ``levels``.

    ``std`` [m/s^2] is the standard deviation of the load. Only the shape of the relation between
    load and displacement is used: the standard deviation of the displacement is that of the
    closure.
    """
    moves = [structure.at(LOADS * std) for structure in structures]
    sizes = _rising(np.abs(moves[0] - sum(moves[1:])))
    sizes = sizes / np.sqrt((sizes**2 * RAYLEIGH).sum() / (2 * RAYLEIGH.sum()))
    beyond = LOADS[-1] + SLOPE_BEYOND_LOADS * (levels - sizes[-1])
    levels_of_load = np.where(levels > sizes[-1], beyond, np.interp(levels, sizes, LOADS, left=0.0))
    mixed: Array = levels ** (1 - share) * np.maximum(levels_of_load, LEAST_LOAD_LEVEL) ** share
    return mixed


def _rising(values: Array) -> Array:
    """The values as far as they rise, and otherwise almost constant."""
    rising: Array = np.maximum.accumulate(values) * (1 + LEAST_INCREASE * np.arange(values.size))
    return rising
