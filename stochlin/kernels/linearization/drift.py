"""The drift of the plastic displacement, which linearization does not have.

In ``mu = z + y`` the plastic displacement ``y`` changes by one increment in every half-cycle whose
amplitude exceeds the yield displacement. Linearization keeps the mean of the increments for a given
amplitude, which alternates in sign and cancels. It loses their scatter, which makes ``y`` a random
walk that only the hardening draws back. The derivation is in ``docs/drift.md``, to whose equations
the numbers (1) to (8) refer.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial.laguerre import laggauss, lagvander
from scipy.special import erf, factorial

from stochlin.kernels.basics.arrays import Array, on_arrays
from stochlin.kernels.linearization.covariance import (
    EquivalentSystem,
    Motion,
    Residues,
    characteristic,
    displacement_covariance,
    own_covariance,
    residues,
    velocity_covariance,
)
from stochlin.kernels.linearization.filters import Filter
from stochlin.kernels.linearization.gaussian import SlipQuadrant, slip_quadrant
from stochlin.kernels.linearization.grounds import followed

ORDERS = 12  # orders of the Laguerre series; the rest counts as one more order
AMPLITUDE_NODES = 40  # nodes of the quadrature over amplitudes
HALF_CYCLES = 40  # summed in eq. (3); even, so that with Bartlett's window (-1)^n has a zero sum
PERIODS_OF_GROWTH = 1e6  # time over which the drift can grow from rest, in elastic periods
DOUBLINGS = 3  # half-cycles are followed one by one up to 2^3, and then by steps of these
TAYLOR = 1 / factorial(np.arange(13))  # coefficients of the series of an exponential
LARGEST_MODE = 1e4  # over the variance of z, up to which modes are summed
SERIES_RATE = 0.5  # largest rate of a matrix to which the series is applied

_NODE, _WEIGHT = laggauss(AMPLITUDE_NODES)
_POLYNOMIALS = _WEIGHT * lagvander(_NODE, ORDERS).T  # (orders + 1, nodes), times the weights
_EXCESS = _NODE[:, None]


class Drift(NamedTuple):
    """Drift of the plastic displacement, in units of the yield displacement."""

    variance: Array  # (n,) variance of its part (1 - alpha) y of the displacement
    rate: Array  # (n,) relaxation rate [1/s], lambda of eq. (4)
    # (ORDERS + 1, n) shares of the orders in D; their sum is 1, or 0 without yielding
    shares: Array


def no_drift(cells: int) -> Drift:
    """That of structures that do not yield."""
    return Drift(np.zeros(cells), np.ones(cells), np.zeros((ORDERS + 1, cells)))


class HalfCycles(NamedTuple):
    """Half-cycles of ``z`` in the linearized response."""

    time: Array  # (n,) mean duration t1 of a half-cycle [s]
    memory: Array  # (HALF_CYCLES, n) autocorrelation R_n of z after n = 1, 2, 3... half-cycles


@np.errstate(all="ignore")  # NaN in cells without stationary motion
def drift_of(system: EquivalentSystem, latent: Array, ground: Filter) -> Drift:
    """Drift of structures linearized by the clipped closure, eqs. (1) to (5).

    ``latent`` (3, n) are the standard deviations and the correlation of the Gaussian ``(v, z~)``
    that the closure clips, in units of the yield displacement.
    """
    cycles = half_cycles(system, ground)
    sv, sz, r = latent
    slip = slip_quadrant(sz, r)
    # mean size over all half-cycles, also without yielding
    increment = 2 * sv * slip.first * cycles.time
    orders = increment**2 * _orders(sz)
    orders[:-1] *= _sums_of_powers(cycles.memory)
    total = sum(orders)  # row by row, so that rounding does not depend on the number of cells
    intensity = total / cycles.time
    rate = _relaxation(system, latent, slip)
    grown = -np.expm1(-2 * rate * PERIODS_OF_GROWTH * 2 * np.pi / np.sqrt(system.stiffness))
    variance = grown * (system.coupling / system.stiffness) ** 2 * intensity / (2 * rate)
    without_drift = variance == 0
    shares = np.where(without_drift, 0.0, orders / total)
    return Drift(variance, np.where(without_drift, 1.0, rate), shares)


def _relaxation(system: EquivalentSystem, latent: Array, slip: SlipQuadrant) -> Array:
    """Relaxation rate of the drift [1/s], eq. (4), from the derivatives of the mean slip rate."""
    by_velocity = 2 * slip.probability
    by_z = 2 * latent[0] * slip.h * slip.flow / erf(slip.h / np.sqrt(2))
    w2 = system.stiffness
    d = system.damping
    coupling = system.coupling
    return (w2 - coupling) * by_z / (w2 - coupling * by_velocity + d * by_z)


def _orders(sz: Array) -> Array:
    """Variance of the sizes of increments by Laguerre order, over their squared mean: eq. (2).

    The amplitudes ``a`` are Rayleigh distributed, so that ``E = a^2/(2 sz^2)`` is exponentially
    distributed. Its part above the threshold of yielding has the same exponential distribution, and
    the polynomials of ``E`` follow from those of both parts: ``L_j(x + y) = sum_k L_k(x)
    L_(j-k)^(-1)(y)``.
    """
    threshold = 0.5 / sz**2
    # The sizes sqrt(2 E) sz - 1 at the nodes, without cancellation.
    sizes = np.sqrt(2 * (threshold + _EXCESS))
    sizes = 2 * sz**2 * _EXCESS / (sz * sizes + 1)
    of_excess = _POLYNOMIALS @ sizes
    square = _WEIGHT @ (sizes * sizes)
    moments = of_excess.copy()
    before = np.ones_like(sz)
    polynomial = -threshold
    for order in range(1, ORDERS + 1):
        moments[order:] += polynomial * of_excess[: ORDERS + 1 - order]
        following = ((2 * order - threshold) * polynomial - (order - 1) * before) / (order + 1)
        before = polynomial
        polynomial = following
    mean, *others = moments
    variances = [(moment / mean) ** 2 for moment in others]
    left = square / mean**2 * np.exp(threshold) - 1
    return np.stack([*variances, np.maximum(left - sum(variances), 0.0)])


def _sums_of_powers(memory: Array) -> Array:
    """``S_j`` (ORDERS, n) of eq. (3).

    A power of a correlation function is a correlation function, so that with Bartlett's window no
    sum is negative.
    """
    window = 2 * (1 - np.arange(1, len(memory) + 1) / len(memory))
    power = memory * window[:, None]
    square = memory**2
    sums = []
    for _ in range(ORDERS):
        power *= square
        sums.append(power.sum(axis=0))
    return np.maximum(1 + np.array(sums), 0.0)


@np.errstate(all="ignore")  # NaN in cells without stationary motion
def half_cycles(system: EquivalentSystem, ground: Filter) -> HalfCycles:
    """Mean time between zero crossings of ``z`` (Rice 1945), and autocorrelation of ``z`` there.

    The autocorrelation follows from the free motion of structure and filter together, which starts
    from the covariances of their states with ``z``. It is a sum of modes, or follows from the
    exponential of the matrix where modes nearly cancel, as the poles of structure and ground nearly
    agree.
    """
    _, _, _, p, k = system
    covariance = own_covariance(system, ground.forcing(system))
    with_mu, _, with_slip = ground.correlations(system)
    with_soil = with_mu - with_slip
    # The variance of z' = (1 - p) v - k z follows with E[z z'] = 0.
    time = np.pi * np.sqrt(covariance.z_z / ((1 - p) ** 2 * covariance.v_v - k**2 * covariance.z_z))
    memory = np.empty((HALF_CYCLES, time.size))
    largest = np.full(time.size, np.inf)
    if ground.in_closed_form:
        memory, largest = _by_modes(system, ground.oscillators, with_soil.T / covariance.z_z, time)
    left = np.flatnonzero(~(largest < LARGEST_MODE))
    if left.size:
        selected = on_arrays(lambda row: row[left], system)
        moments = on_arrays(lambda row: row[left], covariance)
        states_of_structure = moments.mu_z, moments.v_z, moments.mu_z - moments.z_z
        with_z = np.column_stack([*states_of_structure, with_soil[left]])
        after_z = _by_exponentials(selected, ground.at(left), with_z, time[left])
        memory[:, left] = after_z / moments.z_z
    return HalfCycles(time, np.clip(memory, -1, 1))


def _by_modes(
    system: EquivalentSystem, oscillators: Any, with_soil: Any, time: Array
) -> tuple[Array, Array]:
    """Autocorrelation of ``z`` after each half-cycle, and the largest mode it consists of.

    One mode follows each oscillator of the ground, and those of the structure take what is left of
    the value 1, the rate 0 and the curvature at first.
    """
    parts = followed(system, oscillators, with_soil)
    value = np.ones_like(time)
    rate = np.zeros_like(time)
    bend = -((np.pi / time) ** 2)
    for stiffness, damping, of_value, of_rate in parts:
        value = value - of_value
        rate = rate - of_rate
        bend = bend + stiffness * of_value + damping * of_rate
    root, b1, b0 = factors(*characteristic(*system))
    single = (bend + b1 * rate + b0 * value) / (root * root + b1 * root + b0)
    parts.append((b0, b1, value - single, rate - root * single))
    table = np.empty((4, len(parts), time.size))
    for number, part in enumerate(parts):
        for row, entry in zip(table[:, number], part, strict=True):
            row[:] = entry
    stiffness, damping, value, rate = table
    half = 0.5 * damping * time
    beyond = half * half - stiffness * time * time
    angle = np.sqrt(np.abs(beyond))
    decays = beyond > 0
    growth = np.where(decays, angle, 0.0)
    least = np.expm1(-2 * growth)
    slower = np.exp(growth - half)
    cosine = slower * np.where(decays, 1 + 0.5 * least, np.cos(angle))
    sine = slower * np.where(decays, -0.5 * least, np.sin(angle))
    after = value * cosine + (rate * time + half * value) * np.where(
        angle > 0, sine / angle, slower
    )
    # x(n + 1) = twice x(n) - square x(n - 1); the last mode is that of the single root.
    factor = np.exp(root * time)
    twice = np.vstack([2 * cosine, factor])
    square = np.vstack([np.exp(-2 * half), np.zeros_like(factor)])
    before = np.vstack([value, single])
    now = np.vstack([after, single * factor])
    largest = np.abs([*before, *(rate * time)]).max(axis=0)
    memory = np.empty((HALF_CYCLES, time.size))
    for row in memory:
        np.add.reduce(now, axis=0, out=row)
        before *= -square
        before += twice * now
        before, now = now, before
    return memory, largest


def factors(a2: Array, a1: Array, a0: Array) -> tuple[Array, Array, Array]:
    """Real ``r``, ``b1``, ``b0`` of ``s^3 + a2 s^2 + a1 s + a0 = (s - r)(s^2 + b1 s + b0)``.

    By Cardano it is the root farthest from the others, which two of Newton's steps then make exact.
    """
    third = a2 / 3
    p = a1 / 3 - third * third
    q = 0.5 * (a0 - third * a1) + third**3
    beyond = q * q + p**3
    m = np.sqrt(np.abs(p))
    u = np.cbrt(np.abs(q) + np.sqrt(np.maximum(beyond, 0)))
    angle = np.arccos(np.minimum(np.abs(q) / m**3, 1)) / 3
    root = -np.copysign(np.where(beyond < 0, 2 * m * np.cos(angle), u - p / u), q) - third
    for _ in range(2):
        root = root - (((root + a2) * root + a1) * root + a0) / ((3 * root + 2 * a2) * root + a1)
    # Division by the root from the constant on where it is large, and otherwise from the cube on.
    large = np.abs(root) ** 3 > np.abs(a0)
    b0 = np.where(large, -a0 / root, a1 + root * (a2 + root))
    return root, np.where(large, (b0 - a1) / root, a2 + root), b0


def _by_exponentials(system: EquivalentSystem, ground: Filter, with_z: Array, time: Array) -> Array:
    """Covariance of ``z`` after each half-cycle, by those of all states ``with_z`` (n, states)."""
    w2, d, h, p, k = system
    soil = ground.arrays
    size = with_z.shape[1]
    a = np.zeros((w2.size, size, size))
    a[:, 0, 1] = 1
    a[:, 1, 0] = -w2
    a[:, 1, 1] = -d
    a[:, 1, 2] = h
    a[:, 2, 0] = k
    a[:, 2, 1] = p
    a[:, 2, 2] = -k
    a[:, 1, 3:] = soil.output
    a[:, 3:, 3:] = soil.matrix
    both_ways = np.abs(soil.matrix * soil.matrix.swapaxes(-2, -1))
    rates = np.sqrt(w2) + d + k + np.sqrt(h * p) + np.sqrt(both_ways).sum(axis=(-2, -1))
    step = _exponentials(a * time[:, None, None], rates * time)
    rows = step[:, :1] - step[:, 2:3]
    columns = [with_z[..., None]]
    for _ in range(DOUBLINGS):  # z after 1 half-cycle; then after 1 and 2, 1 to 4, and so on
        rows = np.concatenate([rows, rows @ step], axis=1)
        step = step @ step
    while rows.shape[1] * len(columns) < HALF_CYCLES:  # the states before, and after all of these
        columns.append(step @ columns[-1])
    return (rows @ np.concatenate(columns, axis=2)).transpose(2, 1, 0).reshape(HALF_CYCLES, w2.size)


def _exponentials(matrices: Array, rates: Array) -> Array:
    """Exponentials of matrices (n, s, s), by scaling and squaring as their largest ``rates`` need.

    The Taylor series is summed by powers of the fourth power.
    """
    halvings = np.where(
        np.isfinite(rates),
        np.ceil(np.log2(np.maximum(rates, SERIES_RATE) / SERIES_RATE)),
        0.0,
    )
    first = matrices * 0.5 ** halvings[:, None, None]
    second = first @ first
    third = second @ first
    fourth = second @ second
    identity = np.eye(matrices.shape[1])
    exponential = TAYLOR[12] * fourth
    for n in (8, 4, 0):
        exponential += TAYLOR[n + 3] * third + TAYLOR[n + 2] * second + TAYLOR[n + 1] * first
        exponential += TAYLOR[n] * identity
        if n:
            exponential = exponential @ fourth
    for halving in range(int(halvings.max(initial=0))):
        left = np.flatnonzero(halving < halvings)
        part = exponential[left]
        exponential[left] = part @ part
    return exponential


class DriftingSide(NamedTuple):
    """What the correlation of two drifting structures takes of each; all arrays (n,)."""

    motion: Motion
    rate: Array  # relaxation rate of the drift [1/s]
    increments: Array  # (ORDERS + 1, n) square roots of the intensities of the drift by order
    noisy: Any = 1.0  # variance of the velocity under white noise of the intensity 1
    variance: Any = 1.0  # of the displacement with its drift

    @classmethod
    def of(cls, motion: Motion, rate: Array, increments: Array) -> DriftingSide:
        """A structure, whose variances are its covariances with itself by the formulas of pairs."""
        noisy = velocity_covariance(motion, motion, residues(motion, motion))
        side = cls(motion, rate, increments, noisy)
        return side._replace(variance=drifting_correlation(side, side))


def at_unit_intensity(side: DriftingSide, intensity: Array) -> DriftingSide:
    """The structure on ground of intensity 1 instead of this one, its strength in proportion."""
    motion = side.motion
    size = np.sqrt(intensity)
    free = {name: getattr(motion, name) / intensity for name in ("free_2", "free_1", "free_0")}
    return DriftingSide(
        motion._replace(**free),
        side.rate,
        side.increments / size,
        side.noisy,
        side.variance / intensity,
    )


def drift_covariance(coherence: Array, first: DriftingSide, second: DriftingSide) -> Array:
    """Covariance of two drifts, eqs. (6) and (8).

    ``coherence`` is ``r_v`` of eq. (7). Kicks of order ``j`` have the correlation ``r_v |r_v|^(2 j
    - 2)``, of which the factor ``2 sqrt(l1 l2)/(l1 + l2)`` remains for drifts that relax at the
    rates ``l1`` and ``l2``.
    """
    square = coherence * coherence
    total = np.zeros_like(coherence)
    for order in range(ORDERS, -1, -1):
        total *= square
        total += first.increments[order] * second.increments[order]
    return coherence * total / (first.rate + second.rate)


def coherence_of(first: DriftingSide, second: DriftingSide, terms: Residues) -> Array:
    """``r_v`` of eq. (7): correlation of velocities of equivalent systems under one white noise.

    It measures what is new and common to both responses in every half-cycle, without a spectral
    line of the ground that both follow.
    """
    joint = velocity_covariance(first.motion, second.motion, terms)
    return np.clip(joint / np.sqrt(first.noisy * second.noisy), -1.0, 1.0)


def drifting_correlation(first: DriftingSide, second: DriftingSide) -> Array:
    """Correlation of two displacements with their drifts: at most 1, and 1 for equal structures."""
    terms = residues(first.motion, second.motion)
    coherence = coherence_of(first, second, terms)
    joint = displacement_covariance(first.motion, second.motion, terms)
    joint = joint + drift_covariance(coherence, first, second)
    return joint / np.sqrt(first.variance * second.variance)
