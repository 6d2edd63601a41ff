"""Two structures in a motion of finite length, by tables of their stationary response.

The equations (15) to (19) are those of ``docs/drift.md``.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization.covariance import (
    EquivalentSystem,
    Forcing,
    Motion,
    OwnCovariance,
    Residues,
    displacement_covariance,
    residues,
)
from stochlin.kernels.linearization.drift import DriftingSide, coherence_of, drift_covariance
from stochlin.kernels.linearization.levels import StructureInTime, StructureRows, grown
from stochlin.kernels.linearization.spectral_moments import bandwidth_of

# Nodes of the integral for l1 over ln s [1/s], with errors e^(-pi^2/h) by their step, and of 2
# e^-10 by their range for frequencies of 0.06 to 600 rad/s.
L1_STEP = 0.7
L1_NODES = np.exp(L1_STEP * np.arange(-18, 24))[:, None]
LEAST_EASE = 0.3  # factor of eq. (6) by which a correction of rho is divided at least
LEAST_MEMORY = 1e-6  # correlation of the offset from an instant to the next
LEAST_VARIANCE = 1e-10  # variance of a difference over those of both, below which it is 0
MOST_BEHIND = 1e4  # squared level of a motion over that of the structures in it

Polynomial = tuple[Any, Any, Any]  # coefficients of 1, s and s^2


class PairRows(NamedTuple):
    """What tables hold of a pair; of a motion, arrays over (instants, c)."""

    displacement: Array  # correlation of the fast displacements
    ahead: Array  # E[u_1 v_2] over the standard deviations of both displacements and velocities
    velocity: Array  # correlation of the velocities
    increment: Array  # correlation of the increments, eq. (8)
    bandwidth: Array  # of the fast part of u_1 - u_2


class AtLevels(NamedTuple):
    """Structures in their stationary states at all levels; arrays (..., n)."""

    system: EquivalentSystem
    forcing: Forcing
    covariance: OwnCovariance
    side: DriftingSide
    rows: StructureRows
    level: Array
    # (nodes, n) transform of the covariance of the later forcing with the displacement
    later: Array


def pair_rows(first: AtLevels, second: AtLevels, added: Array) -> PairRows:
    """Rows of pairs (n,); ``added`` is what simulations add to the correlation of both drifts."""
    motion_1 = first.side.motion
    motion_2 = second.side.motion
    terms = residues(motion_1, motion_2)
    joint = displacement_covariance(motion_1, motion_2, terms)
    ahead, velocity = covariances_with_rates(motion_1, motion_2, terms)
    unrelaxed = (side._replace(rate=np.array(0.5)) for side in (first.side, second.side))
    increments = drift_covariance(coherence_of(first.side, second.side, terms), *unrelaxed)
    both = first.rows.increment * second.rows.increment
    rate_1 = first.side.rate
    rate_2 = second.side.rate
    ease = 2 * np.sqrt(rate_1 * rate_2) / (rate_1 + rate_2)
    kappa = np.where(both > 0, increments / np.where(both > 0, both, 1.0), 0.0)
    rows_1 = first.rows
    rows_2 = second.rows
    level = first.level
    shared = rows_1.slow_push * rows_2.slow_push / (rows_1.slow_rate + rows_2.slow_rate)
    decays = L1_NODES * decay(first, second, joint, ahead, velocity)
    l1 = (2 / np.pi) * L1_STEP * decays.sum(axis=0)
    displacements = rows_1.displacement * rows_2.displacement
    l2 = first.covariance.v_v + second.covariance.v_v - 2 * velocity
    l0 = first.covariance.mu_mu + second.covariance.mu_mu - 2 * joint
    return PairRows(
        (joint / level**2 - shared) / displacements,
        ahead / (level**2 * np.sqrt(displacements * rows_1.velocity * rows_2.velocity)),
        velocity / (level**2 * rows_1.velocity * rows_2.velocity),
        np.clip(kappa + added / np.fmax(ease, LEAST_EASE), -1, 1),
        np.nan_to_num(bandwidth_of(l0, l1, l2), nan=1.0),
    )


def covariances_with_rates(first: Motion, second: Motion, terms: Residues) -> tuple[Array, Array]:
    """``E[u_1 v_2]`` and ``E[v_1 v_2]`` of a pair, by integrals of `displacement_covariance`."""
    kick_1 = (0.0, first.relaxation, 1.0)
    kick_2 = (0.0, second.relaxation, 1.0)
    free_1 = _free_rate(first)
    free_2 = _free_rate(second)
    place = (first.relaxation, 1.0, 0.0), (first.free_0, first.free_1, first.free_2)
    ahead = _integral(terms, place[0], free_2) + _integral(terms, place[1], kick_2)
    return ahead, _integral(terms, kick_1, free_2) + _integral(terms, free_1, kick_2)


def _free_rate(motion: Motion) -> Polynomial:
    """The velocity of the free motion, times ``D(s)``."""
    _, a2, a1, a0, m2, m1, m0 = motion
    return -a0 * m2, m0 - a1 * m2, m1 - a2 * m2


def _integral(terms: Residues, p: Polynomial, q: Polynomial) -> Array:
    """Integral of ``p(s) q(-s)/(D1(s) D2(-s))``, as those of `Residues`."""
    total = p[0] * q[0] * terms.even_0
    total = total - (p[1] * q[0] - p[0] * q[1]) * terms.odd_1
    total = total - (p[2] * q[0] - p[1] * q[1] + p[0] * q[2]) * terms.even_2
    total = total - (p[1] * q[2] - p[2] * q[1]) * terms.odd_3
    total = total + p[2] * q[2] * terms.even_4
    integral: Array = total / terms.determinant
    return integral


def decay(first: AtLevels, second: AtLevels, joint: Array, ahead: Array, velocity: Array) -> Array:
    """``-Int_0^inf R'(tau) e^(-s tau) dtau`` at `L1_NODES`.

    ``R`` is the correlation of ``u_1 - u_2``. The covariances of both structures are ``joint``,
    ``E[u_1 v_2] = ahead`` and ``velocity``. It is as in `spectral_moments`, for two structures
    whose states have covariances with ``u_1 - u_2``.
    """
    drive = first.later - second.later
    forcing = first.forcing.mu - second.forcing.mu
    place_1 = first.covariance.mu_mu - joint
    place_2 = joint - second.covariance.mu_mu
    rate_1 = first.covariance.v_v - velocity
    rate_2 = velocity - second.covariance.v_v
    decay_of_first = _decay(first.system, place_1, ahead, rate_1, forcing, drive)
    return decay_of_first - _decay(second.system, place_2, ahead, rate_2, forcing, drive)


def _decay(
    system: EquivalentSystem,
    place: Array,
    rate: Array,
    rates: Array,
    forcing: Array,
    drive: Array,
) -> Array:
    """The part of `decay` by one structure, from its equations of motion solved for the velocity.

    ``place`` and ``rate`` are the covariances of its displacement and its velocity with ``u_1 -
    u_2``, ``rates`` that of both velocities, and ``forcing`` and ``drive`` those of the forcing,
    now and later.
    """
    w2, d, h, p, k = system
    s = L1_NODES
    slip = w2 * place + d * rate - forcing - rates  # h times the covariance of the slip
    right = (s + k) * (w2 * place - s * (drive + rate)) - (s * slip + h * k * place)
    decays: Array = right / ((s + k) * ((s + d) * s + w2) - h * (k + p * s))
    return decays


class Difference(NamedTuple):
    """The motion of ``u_1 - u_2`` over (instants, c): a fast part, and a slow offset."""

    displacement: Array  # standard deviation of the fast part [m]
    velocity: Array  # standard deviation [m/s]
    bandwidth: Array  # of the fast part
    offset: Array  # standard deviation of the slow offset [m]
    memory: Array  # (instants - 1, c) correlation of the offset from each instant to the next


def alone(structure: StructureInTime, bandwidth: Array, step: float) -> Difference:
    """The motion of one structure beside a line that does not move."""
    rows = structure.rows
    offset = structure.offset
    both = np.sqrt(offset[:-1] * offset[1:])
    memory = _share(offset[:-1] * _stays(rows, step), both)
    return Difference(rows.displacement, rows.velocity, bandwidth, np.sqrt(offset), memory)


def difference(
    first: StructureInTime, second: StructureInTime, pair: PairRows, envelope: Array, step: float
) -> tuple[Difference, Array]:
    """The motion of ``u_1 - u_2``, eqs. (17) to (19), and the covariance of ``u_1`` and ``u_2``."""
    rows_1 = first.rows
    rows_2 = second.rows
    drift = grown(
        pair.increment * rows_1.increment * rows_2.increment,
        rows_1.relaxation + rows_2.relaxation,
        step,
    )
    slow = grown(rows_1.slow_push * rows_2.slow_push, rows_1.slow_rate + rows_2.slow_rate, step)
    level = np.sqrt(first.square * second.square)
    ahead = np.minimum(envelope**2 / level, MOST_BEHIND)
    turn = 1j * (rows_1.velocity / rows_1.displacement - rows_2.velocity / rows_2.displacement)
    growth = 0.5 * (rows_1.growth + rows_2.growth)
    stationary = pair.displacement + 1j * pair.ahead
    source = (growth - turn) * stationary * ahead
    follows = grown(source, growth * ahead - turn, step, stationary[0]).real
    rho = np.clip(follows, -1, 1)
    rho_velocity = np.clip(pair.velocity + follows - pair.displacement, -1, 1)
    joint = rho * rows_1.displacement * rows_2.displacement
    fast = _but_rounding(rows_1.displacement**2, rows_2.displacement**2, joint)
    velocity = (
        rows_1.velocity**2
        + rows_2.velocity**2
        - 2 * rho_velocity * rows_1.velocity * rows_2.velocity
    )
    offset = _but_rounding(first.offset, second.offset, drift + slow)
    stays_1 = _stays(rows_1, step)
    stays_2 = _stays(rows_2, step)
    lagged = first.offset[:-1] * stays_1 + second.offset[:-1] * stays_2
    lagged = lagged - (drift + slow)[:-1] * (stays_1 + stays_2)
    memory = _share(lagged, np.sqrt(offset[:-1] * offset[1:]))
    velocity = np.maximum(velocity, 0.0)
    stds = np.sqrt(fast), np.sqrt(velocity), pair.bandwidth, np.sqrt(offset)
    moves = Difference(*stds, memory)
    return moves, joint + drift + slow


def _stays(rows: StructureRows, step: float) -> Array:
    """Share of a drift (instants - 1, c) that is left at the next instant."""
    stays: Array = np.exp(-0.5 * (rows.relaxation[:-1] + rows.relaxation[1:]) * step)
    return stays


def _but_rounding(first: Array, second: Array, joint: Array) -> Array:
    """Variance of a difference; 0 where it is a rounding error of structures that move together."""
    variance = first + second - 2 * joint
    return np.where(variance > LEAST_VARIANCE * (first + second), variance, 0.0)


def _share(part: Array, whole: Array) -> Array:
    """``part/whole`` between almost 0 and 1; 1 where there is no whole."""
    share = np.clip(part / np.where(whole > 0, whole, 1.0), LEAST_MEMORY, 1.0)
    return np.where(whole > 0, share, 1.0)
