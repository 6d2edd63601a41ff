"""A structure in a motion of finite length, by tables of its response over levels of shaking.

Stationary ground of the intensity ``q S0`` is said to have the level ``sqrt(q)``. In a motion with
the envelope ``m(t)`` a structure has at each instant the stationary response of a level of its own,
which follows the envelope with a lag. The derivation is in ``docs/drift.md``, to whose equations
the numbers (14) to (17) refer.
"""

from __future__ import annotations

from typing import NamedTuple, TypeVar

import numpy as np
from scipy.interpolate import PchipInterpolator

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization.covariance import (
    EquivalentSystem,
    Forcing,
    OwnCovariance,
    characteristic,
    own_covariance,
)
from stochlin.kernels.linearization.filters import Filter
from stochlin.kernels.linearization.grounds import followed

LOWEST_LEVEL = 0.02  # lowest level for motions of one size
STEPS_OF_LEVELS = 15  # from it to 1
STEPS_BETWEEN_LEVELS = 8  # steps of a table between two levels
AT_REST = 1e-12  # squared level of a motion that has not begun
STEPS_TO_SLOW_MODE = 5  # of the iteration for the slow mode
# The slow mode counts as part of the slow offset up to the first rate, over the frequency of the
# structure, and as part of the fast response from the second one on.
SLOW_RATE = 0.1
FAST_RATE = 0.2
LARGEST_SLOW = 0.9  # share of the slow mode in the variance

Rows = TypeVar("Rows", bound=tuple[Array, ...])


def levels_for(spread: float) -> Array:
    """Levels up to 1 for motions of which the largest is so many times the smallest."""
    steps = STEPS_OF_LEVELS * np.log(spread / LOWEST_LEVEL) / np.log(1 / LOWEST_LEVEL)
    return np.geomspace(LOWEST_LEVEL / spread, 1.0, 1 + int(np.ceil(steps)))


class Tables(NamedTuple):
    """Rows over the logarithm of the squared level: linear between points, constant beyond them."""

    points: Array  # (p,) logarithms, in equal steps
    rows: Array  # (rows, n, p)

    @classmethod
    def of(cls, levels: Array, values: Array) -> Tables:
        """Tables of values (rows, n levels), interpolated without overshoot; NaN counts as 0."""
        at = 2 * np.log(levels)
        values = np.nan_to_num(values).reshape(len(values), -1, levels.size)
        points = np.linspace(at[0], at[-1], STEPS_BETWEEN_LEVELS * (levels.size - 1) + 1)
        return cls(points, PchipInterpolator(at, values, axis=-1)(points))

    def at(self, square: Array, columns: Array) -> Array:
        """Rows (rows, ..., c) at squared levels (..., c), of structures with these numbers (c,)."""
        first = self.points[0]
        step = self.points[1] - self.points[0]
        place = np.clip((np.log(square) - first) / step, 0, self.points.size - 1)
        whole = np.minimum(place.astype(int), self.points.size - 2)
        before = self.rows[:, columns, whole]
        after = self.rows[:, columns, whole + 1]
        between: Array = before + (place - whole) * (after - before)
        return between


class StructureRows(NamedTuple):
    """What tables hold of a structure; of a motion, arrays over (instants, c)."""

    displacement: Array  # standard deviation of the fast part [m]; in tables over the level
    velocity: Array  # standard deviation [m/s]; in tables over the level
    increment: Array  # root of the intensity of the drift, eq. (3) [m/s^0.5]
    relaxation: Array  # rate of the drift, eq. (4) [1/s]
    correction: Array  # factor on displacements, from the map of simulations
    growth: Array  # rate at which the squared level follows that of the motion, eq. (14) [1/s]
    resonant: Array  # share of the variance that belongs to the modes of the structure itself
    slow_rate: Array  # of the slow mode, eq. (16) [1/s]
    slow_push: Array  # root of the intensity of the noise that drives it [m/s^0.5]; over the level


def structure_rows(
    system: EquivalentSystem,
    forcing: Forcing,
    soil: Filter,
    drift: tuple[Array, Array],
    std: Array,
    levels: Array,
) -> StructureRows:
    """Rows (n levels,) of structures whose stationary response is known at all levels.

    ``drift`` is the standard deviation of the drift and its rate, and ``std`` that of the
    displacement with the drift, corrected by the map of simulations.
    """
    covariance = own_covariance(system, forcing)
    drift_std, rate = drift
    level = np.tile(levels, std.size // levels.size)
    slow_rate, push = slow_mode(system, soil, covariance.mu_mu)
    return StructureRows(
        np.sqrt(covariance.mu_mu - push**2 / (2 * slow_rate)) / level,
        np.sqrt(covariance.v_v) / level,
        drift_std * np.sqrt(2 * rate),
        np.where(drift_std > 0, rate, 0.0),
        std / np.hypot(np.sqrt(covariance.mu_mu), drift_std),
        _growth(system, forcing, covariance, levels),
        _resonant(system, soil, covariance),
        slow_rate,
        push / level,
    )


def _growth(
    system: EquivalentSystem, forcing: Forcing, covariance: OwnCovariance, levels: Array
) -> Array:
    """Rate [1/s] of eq. (14), ``E[f v]/(Var v  d ln E/d ln q)`` with the energy ``E``, (n levels,).

    ``E = Var v + alpha w^2 Var u + (1 - alpha) w^2 Var z``. For a linear structure on white noise
    the rate is ``2 xi w``.
    """
    post = system.stiffness - system.coupling
    energy = covariance.v_v + post * covariance.mu_mu + system.coupling * covariance.z_z
    logarithms = np.log(energy).reshape(-1, levels.size)
    slope = np.gradient(logarithms, 2 * np.log(levels), axis=1).ravel()
    rate: Array = forcing.velocity / (covariance.v_v * slope)
    return rate


def _resonant(system: EquivalentSystem, soil: Filter, covariance: OwnCovariance) -> Array:
    """Share of the variance not due to motions which follow the oscillators of the ground."""
    if not soil.oscillators or not soil.in_closed_form:
        return np.ones_like(covariance.z_z)
    with_mu, _, with_slip = soil.correlations(system)
    parts = followed(system, soil.oscillators, (with_mu - with_slip).T / covariance.z_z)
    share: Array = np.clip(1 - sum(value for _, _, value, _ in parts), 0, 1)
    return share


def slow_mode(system: EquivalentSystem, soil: Filter, variance: Array) -> tuple[Array, Array]:
    """Rate ``a`` [1/s] of the slow mode, and root ``p`` of the intensity of its noise, eq. (16).

    ``-a`` is the smallest pole of the equivalent system, and ``variance`` that of its displacement.
    The noise is 0 where the mode is not slow.
    """
    a2, a1, a0 = characteristic(*system)
    rate = a0 / a1
    for _ in range(STEPS_TO_SLOW_MODE):
        value = ((a2 - rate) * rate - a1) * rate + a0
        rate = rate - value / ((2 * a2 - 3 * rate) * rate - a1)
    residue = (system.relaxation - rate) / ((3 * rate - 2 * a2) * rate + a1)
    weight = np.clip((FAST_RATE - rate / np.sqrt(system.stiffness)) / (FAST_RATE - SLOW_RATE), 0, 1)
    power = weight * residue**2 * 2 * np.pi * soil.intensity * soil.transmission(rate)
    slow = (rate > 0) & np.isfinite(power)
    power = np.minimum(power, LARGEST_SLOW * 2 * rate * variance)
    return np.where(slow, rate, 1.0), np.sqrt(np.where(slow, power, 0.0))


def lagged(tables: Tables, growth: int, squares: Array, step: float) -> Array:
    """Squared levels (steps + 1, n, m) of structures in m motions, eq. (14), from rest.

    ``growth`` is the number of the row of its rate, and ``squares`` (steps, m) are the squared
    envelopes in the middle of each step [s].
    """
    structures = tables.rows.shape[1]
    motions = squares.shape[1]
    rates = Tables(tables.points, tables.rows[[growth]])
    columns = np.repeat(np.arange(structures), motions)
    level = np.full((len(squares) + 1, columns.size), AT_REST)
    for number, square in enumerate(np.tile(squares, structures)):
        rate = rates.at(level[number], columns)[0]
        moved = level[number] - (square - level[number]) * np.expm1(-rate * step)
        level[number + 1] = np.maximum(moved, AT_REST)
    return level.reshape(-1, structures, motions)


def grown(source: Array, rate: Array, step: float, start: Array | float = 0.0) -> Array:
    """``x`` (instants, ...) of ``x' = source - rate x`` from a start, by means in each step [s]."""
    mean = 0.5 * (rate[:-1] + rate[1:]) * step
    decays = mean != 0
    share = np.where(decays, -np.expm1(-mean) / np.where(decays, mean, 1.0), 1.0)
    added = 0.5 * (source[:-1] + source[1:]) * step * share
    stays = np.exp(-mean)
    state = np.empty(source.shape, added.dtype)
    state[0] = start
    for number in range(len(added)):
        state[number + 1] = state[number] * stays[number] + added[number]
    return state


class StructureInTime(NamedTuple):
    """A structure in a motion of finite length, over (instants, c)."""

    square: Array  # squared level of the structure
    rows: StructureRows  # at this level
    drift: Array  # variance of the drift, eq. (15) [m^2]
    slow: Array  # variance of the slow mode, eq. (16) [m^2]

    @property
    def offset(self) -> Array:
        """Variance of the slow part of the displacement [m^2]."""
        return self.drift + self.slow

    @property
    def variance(self) -> Array:
        """Variance of the displacement [m^2]."""
        return self.rows.displacement**2 + self.offset


def moving(
    tables: Tables, square: Array, envelope: Array, columns: Array, step: float
) -> StructureInTime:
    """Structures with these numbers ``columns`` (c,) in tables, at squared levels (instants, c)."""
    rows = StructureRows(*tables.at(square, columns))
    size = np.sqrt(square) * rows.correction
    rows = rows._replace(
        displacement=size * rows.displacement,
        velocity=size * rows.velocity,
        increment=rows.correction * rows.increment,
        slow_push=envelope * rows.correction * rows.slow_push,
    )
    drift = grown(rows.increment**2, 2 * rows.relaxation, step)
    return StructureInTime(square, rows, drift, grown(rows.slow_push**2, 2 * rows.slow_rate, step))
