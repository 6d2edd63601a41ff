"""The drift of the plastic displacement, which linearization does not have.

In ``mu = z + y`` the plastic displacement ``y`` changes by one kick in every half-cycle whose amplitude
exceeds the yield displacement. Linearization keeps the mean of the kicks for a given amplitude, which
alternates in sign and cancels. It loses their scatter, which makes ``y`` a random walk that only the
hardening draws back. The derivation is in ``docs/drift.md``, to whose equations the numbers (1) to (8)
refer.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.polynomial.laguerre import laggauss
from scipy.special import erf

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.elementary import solve_3x3
from stochlin.kernels.basics.exponentials import exponentials
from stochlin.kernels.basics.slabs import in_ranges
from stochlin.kernels.linearization.covariance import (
    EquivalentSystem,
    Forcing,
    at_poles,
    coordinates,
    own_covariance,
    pair_covariance,
)
from stochlin.kernels.linearization.filters import Filter
from stochlin.kernels.linearization.gaussian import SlipQuadrant, slip_quadrant

ORDERS = 12  # orders of the Laguerre series; the rest counts as one more order
NODES = 40  # nodes of the quadrature over amplitudes
HALF_CYCLES = 40  # summed in eq. (3); even, so that with Bartlett's window (-1)^n has a zero sum
MOTION = 1e6  # time over which the drift can grow from rest, in elastic periods
CELLS = 512  # cells computed together, on all cores

NOISE = Forcing(np.zeros(()), np.ones(()), np.zeros(()))  # white noise of the intensity 1

_EXCESS, _WEIGHT = laggauss(NODES)


class Drift(NamedTuple):
    """Drift of the plastic displacement, in units of the yield displacement."""

    variance: Array  # (n,) variance of its part (1 - alpha) y of the displacement
    rate: Array  # (n,) relaxation rate [1/s], lambda of eq. (4)
    shares: Array  # (ORDERS + 1, n) shares of the orders in D; their sum is 1, or 0 without yielding


class HalfCycles(NamedTuple):
    """Half-cycles of ``z`` in the linearized response."""

    time: Array  # (n,) mean duration t1 of a half-cycle [s]
    memory: Array  # (HALF_CYCLES, n) autocorrelation R_n of z after n = 1, 2, 3... half-cycles


def drift_of(system: EquivalentSystem, latent: Array, cycles: HalfCycles) -> Drift:
    """Drift of structures linearized by the clipped closure, eqs. (1) to (5).

    ``latent`` (3, n) are the standard deviations and the correlation of the Gaussian ``(v, z~)`` that
    the closure clips, in units of the yield displacement.
    """
    sv, sz, r = latent
    slip = slip_quadrant(sz, r)
    kick = 2 * sv * slip.first * cycles.time  # mean size over all half-cycles, also without yielding
    orders = np.empty((ORDERS + 1, sz.size))

    @np.errstate(all="ignore")
    def part(cells: slice) -> None:
        orders[:, cells] = kick[cells] ** 2 * _orders(sz[cells])
        orders[:-1, cells] *= _sums_of_powers(cycles.memory[:, cells])

    in_ranges(part, sz.size, CELLS)
    with np.errstate(all="ignore"):
        total = _total(orders)
        intensity = total / cycles.time
        rate = _relaxation(system, latent, slip)
        grown = -np.expm1(-2 * rate * MOTION * 2 * np.pi / np.sqrt(system.stiffness))
        variance = grown * (system.coupling / system.stiffness) ** 2 * intensity / (2 * rate)
        still = variance == 0
        shares = np.where(still, 0.0, orders / total)
    return Drift(variance, np.where(still, 1.0, rate), shares)


def _relaxation(system: EquivalentSystem, latent: Array, slip: SlipQuadrant) -> Array:
    """Relaxation rate of the drift [1/s], eq. (4), from the derivatives of the mean slip rate."""
    sv, _, r = latent
    h, q = slip.h, slip.q
    by_velocity = 2 * slip.probability
    by_z = 2 * sv * h * (r * h * slip.edge + q * slip.corner) / erf(h / np.sqrt(2))
    w2, d, coupling = system.stiffness, system.damping, system.coupling
    return (w2 - coupling) * by_z / (w2 - coupling * by_velocity + d * by_z)


def _orders(sz: Array) -> Array:
    """Variance of the kick sizes by Laguerre order, over the square of their mean: ``c_j^2`` of eq. (2).

    The amplitudes ``a`` are Rayleigh distributed, so that ``a^2/(2 sz^2)`` is exponentially distributed.
    Its part above the threshold of yielding has the same exponential distribution.
    """
    nodes, weights = _EXCESS[:, None], _WEIGHT[:, None]
    energy = 0.5 / sz**2 + nodes
    size = 2 * sz**2 * nodes / (sz * np.sqrt(2 * energy) + 1)  # sqrt(2 E) sz - 1, without cancellation
    weighted = weights * size
    mean, square = _total(weighted), _total(weighted * size)
    before, polynomial = np.ones_like(energy), 1 - energy
    variances = []
    for order in range(1, ORDERS + 1):
        variances.append((_total(weighted * polynomial) / mean) ** 2)
        following = ((2 * order + 1 - energy) * polynomial - order * before) / (order + 1)
        before, polynomial = polynomial, following
    left = square / mean**2 * np.exp(0.5 / sz**2) - 1
    return np.stack([*variances, np.maximum(left - sum(variances), 0.0)])


def _sums_of_powers(memory: Array) -> Array:
    """``S_j`` (ORDERS, n) of eq. (3).

    A power of a correlation function is a correlation function, so that with Bartlett's window no sum is
    negative.
    """
    cycles, square, sums = len(memory), memory**2, []
    power = 2 * (1 - np.arange(1, cycles + 1)[:, None] / cycles) * memory
    for _ in range(ORDERS):
        power = power * square
        sums.append(np.maximum(1 + _total(power), 0.0))
    return np.stack(sums)


def _total(rows: Array) -> Array:
    """Sum of the rows, one after the other, so that rounding does not depend on the number of cells."""
    # numpy adds a lone column in pairs, but several columns row by row.
    total: Array = np.cumsum(rows)[-1:] if rows.shape[1] == 1 else rows.sum(axis=0)
    return total


def half_cycles(system: EquivalentSystem, ground: Filter) -> HalfCycles:
    """Mean time between zero crossings of ``z`` (Rice 1945), and the autocorrelation of ``z`` there."""
    n = system.stiffness.size
    time, memory = np.empty(n), np.empty((HALF_CYCLES, n))

    @np.errstate(all="ignore")  # NaN in cells without stationary motion
    def part(cells: slice) -> None:
        own = EquivalentSystem(*(row[cells] for row in system))
        time[cells], memory[:, cells] = _half_cycles(own, ground.at(cells))

    in_ranges(part, n, CELLS)
    return HalfCycles(time, memory)


def _half_cycles(system: EquivalentSystem, ground: Filter) -> tuple[Array, Array]:
    """The fields of `HalfCycles` for a range of cells.

    The autocorrelation follows from the free motion of structure and filter together, which starts from
    the covariances of their states with ``z``.
    """
    w2, d, h, p, k = system
    (forcing, with_soil), soil = ground.forcing_and_z(system), ground.arrays
    own = own_covariance(system, forcing)
    size = 3 + with_soil.shape[1]
    a = np.zeros((w2.size, size, size))
    a[:, 0, 1] = 1
    a[:, 1, :3] = np.stack([-w2, -d, h], axis=-1)
    a[:, 2, :3] = np.stack([k, p, -k], axis=-1)
    a[:, 1, 3:], a[:, 3:, 3:] = soil.output, soil.matrix
    with_z = np.column_stack([own.mu_z, own.v_z, own.mu_z - own.z_z, with_soil])
    # The variance of z' = (1 - p) v - k z follows with E[z z'] = 0.
    time = np.pi * np.sqrt(own.z_z / ((1 - p) ** 2 * own.v_v - k**2 * own.z_z))
    step = exponentials(a * time[:, None, None])
    states = step @ with_z[..., None]  # after 1 half-cycle; then after 1 and 2, 1 to 4, and so on
    while states.shape[-1] < HALF_CYCLES:
        states = np.concatenate([states, step @ states], axis=-1)
        step = step @ step
    later = (states[:, 0] - states[:, 2]).T[:HALF_CYCLES]
    return time, np.clip(later / own.z_z, -1, 1)


class DriftingSide(NamedTuple):
    """What the correlation of two drifting structures takes of each; all arrays (n,)."""

    system: EquivalentSystem
    forcing: Forcing
    std: Array  # of the displacement with its drift
    unit: Array  # std of the velocity under white noise of the intensity 1
    rate: Array  # relaxation rate of the drift [1/s]
    kicks: Sequence[Array]  # ORDERS + 1 square roots of the intensities of the drift by order

    @classmethod
    def of(
        cls, system: EquivalentSystem, forcing: Forcing, std: Array, rate: Array, shares: Sequence[Array]
    ) -> DriftingSide:
        """A structure whose drift has this standard deviation, relaxation rate, and shares of orders."""
        total = np.sqrt(own_covariance(system, forcing).mu_mu + std**2)
        unit = np.sqrt(own_covariance(system, NOISE).v_v)
        return cls(system, forcing, total, unit, rate, [std * np.sqrt(2 * rate * s) for s in shares])


def innovation_coherence(first: DriftingSide, second: DriftingSide) -> Array:
    """Correlation of the velocities of two equivalent systems under one white noise, eq. (7).

    It is a measure of what is new and common to both responses in every half-cycle, without a spectral
    line of the ground that both follow.
    """
    matrix = coordinates(first.system, NOISE)
    right = -np.ones(()), second.system.relaxation + matrix.damping, -matrix.slip  # as in `pair_row`
    row = solve_3x3(at_poles(second.system, first.system, matrix), right)
    joint = 2 * (matrix.soft * row[0] + matrix.damping * row[1] - matrix.coupling * row[2])
    return np.clip(joint / (first.unit * second.unit), -1, 1)


def drift_covariance(coherence: Array, first: DriftingSide, second: DriftingSide) -> Array:
    """Covariance of two drifts, eqs. (6) and (8).

    ``coherence`` is ``r_v`` of eq. (7). Kicks of order ``j`` have the correlation ``r_v |r_v|^(2 j -
    2)``, of which the factor ``2 sqrt(l1 l2)/(l1 + l2)`` remains for drifts that relax at the rates
    ``l1`` and ``l2``.
    """
    square, total = coherence**2, first.kicks[-1] * second.kicks[-1]
    for kick_1, kick_2 in zip(first.kicks[-2::-1], second.kicks[-2::-1], strict=True):
        total = total * square + kick_1 * kick_2
    return coherence * total / (first.rate + second.rate)


def drifting_correlation(first: DriftingSide, second: DriftingSide) -> Array:
    """Correlation of two displacements with their drifts: at most 1, and 1 for equal structures."""
    joint = pair_covariance(first.system, first.forcing, second.system, second.forcing)
    joint = joint + drift_covariance(innovation_coherence(first, second), first, second)
    return joint / (first.std * second.std)
