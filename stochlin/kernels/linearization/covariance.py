"""Stationary covariances of linear and linearized oscillators, block by block and in closed form.

All functions broadcast. The state of one structure is ``(mu, mu', y)``: displacement over ``uy``,
velocity over ``uy``, and the slip ``y = mu - z`` in place of the hysteretic displacement ``z``. If
a structure hardly yields, ``y`` and all coefficients of its equation tend to zero together, and
there is no division by a small difference of large numbers. In these variables the linearized law
``z' = -c_e mu' - k_e z`` and the equation of motion are

    mu'' = -stiffness mu - damping mu' + coupling y + f
    y'   = relaxation mu + slip mu' - relaxation y,

with ``stiffness = w^2``, ``damping = 2 xi w``, ``coupling = (1 - alpha) w^2``,
``slip = 1 + c_e`` and ``relaxation = k_e``.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array

MEMORYLESS = 1e-12  # largest positive real pole, over w, that is rounding error of a pole at 0


class EquivalentSystem(NamedTuple):
    """Coefficients of the equations of one linearized oscillator, see the module's docstring."""

    stiffness: Array  # w^2 [1/s^2]
    damping: Array  # 2 xi w [1/s]
    coupling: Array  # (1 - alpha) w^2 [1/s^2]
    slip: Array  # 1 + c_e [-]
    relaxation: Array  # k_e [1/s]


def characteristic(w2: Array, d: Array, h: Array, p: Array, k: Array) -> tuple[Array, Array, Array]:
    """Characteristic polynomial ``(a2, a1, a0)`` of an `EquivalentSystem` with these coefficients.

    This function and the next one take numbers too, and are called from compiled code.
    """
    return d + k, w2 + d * k - h * p, (w2 - h) * k


def hurwitz(w2: Array, d: Array, h: Array, p: Array, k: Array) -> Array:
    """``a2 a1 - a0`` of an `EquivalentSystem` with these coefficients, without cancellation."""
    return d * (w2 + d * k + k * k - h * p) + (1 - p) * h * k


def stable(w2: Array, d: Array, h: Array, p: Array, k: Array) -> Array:
    """Whether an `EquivalentSystem` with these coefficients is stable, by Routh and Hurwitz.

    A pole at 0, within rounding, counts as stable. It belongs to a law without hysteresis, where
    ``z`` is a function of ``mu``, no energy is dissipated, and the forcing does not excite this
    pole.
    """
    a2, a1, a0 = characteristic(w2, d, h, p, k)
    memory = a0 + MEMORYLESS * np.sqrt(w2) * a1
    return (a2 > 0) & (a1 > 0) & (memory > 0) & (hurwitz(w2, d, h, p, k) > 0)


class Forcing(NamedTuple):
    """Stationary covariances of the forcing ``f`` with the states ``mu``, ``mu'`` and ``y``.

    The stationary covariances of a structure depend on the ground through these three numbers
    alone. For white noise they are ``0, pi S0, 0``: half its intensity in time, with the velocity.
    """

    mu: Array
    velocity: Array
    slip: Array


class OwnCovariance(NamedTuple):
    """Stationary second moments of one structure; ``E[mu mu'] = 0``."""

    mu_mu: Array
    v_v: Array
    z_z: Array
    v_z: Array
    mu_z: Array


def linear_system(frequency: Array, damping_ratio: Array) -> EquivalentSystem:
    """Linear oscillator as an `EquivalentSystem`, whose third state is uncoupled and stable."""
    zero = np.zeros_like(frequency * damping_ratio)
    return EquivalentSystem(
        frequency**2 + zero, 2 * damping_ratio * frequency, zero, zero, frequency + zero
    )


def own_covariance(system: EquivalentSystem, forcing: Forcing) -> OwnCovariance:
    """Second moments of one structure, from ``A X + X A' + B C' + C B' = 0`` by elimination.

    The result is also exact in the elastic limit ``slip = relaxation = 0``, where the Lyapunov
    equation is singular. Without hardening (``coupling = stiffness``) the displacement has no
    stationary variance, and the result is infinite or NaN.
    """
    w2, d, h, p, k = system
    c = 1 - p
    f_z = forcing.mu - forcing.slip
    mu_z = (c * forcing.velocity + d * f_z) / hurwitz(w2, d, h, p, k)
    v_v = (forcing.velocity - h * k * mu_z) / d
    mu_mu = (v_v - h * mu_z + forcing.mu) / (w2 - h)
    return OwnCovariance(mu_mu, v_v, c * mu_z, k * mu_z, mu_z)


class Motion(NamedTuple):
    """Laplace transforms of what the covariance of two structures takes of each.

    The displacement after an impulse is ``(s + relaxation)/D(s)``, with the characteristic
    polynomial ``D(s) = s^3 + pole_2 s^2 + pole_1 s + pole_0``. The free motion from the present
    covariances of the states with the forcing has the displacement ``(free_2 s^2 + free_1 s +
    free_0)/D(s)``.
    """

    relaxation: Array
    pole_2: Array
    pole_1: Array
    pole_0: Array
    free_2: Array
    free_1: Array
    free_0: Array


def motion_of(system: EquivalentSystem, forcing: Forcing) -> Motion:
    """The motion of an equivalent system under this forcing."""
    _, d, h, p, k = system
    a2, a1, a0 = characteristic(*system)
    free_0 = (d * k - h * p) * forcing.mu + k * forcing.velocity + h * forcing.slip
    return Motion(k, a2, a1, a0, forcing.mu, a2 * forcing.mu + forcing.velocity, free_0)


class Residues(NamedTuple):
    """Integrals of ``s^m/(D1(s) D2(-s))`` along the imaginary axis, over ``2 pi i``.

    With the ``determinant``, which is positive, they are ``even_0/determinant``,
    ``-odd_1/determinant``, ``-even_2/determinant``, ``-odd_3/determinant`` and
    ``even_4/determinant`` for ``m`` from 0 to 4. The odd ones change their sign with the order of
    the structures.
    """

    even_0: Array
    odd_1: Array
    even_2: Array
    odd_3: Array
    even_4: Array
    determinant: Array


def residues(first: Motion, second: Motion) -> Residues:
    """The integrals of a pair.

    For ``U`` and ``W`` with ``s^m = U(s) (D1(s) + D2(-s)) + W(s) D1(s)``, the integral follows from
    the highest coefficient of ``U``. As ``D1(s) + D2(-s)`` is of second order, two equations remain
    for it. No eigenvalues are computed, so that equal ones cause no errors.
    """
    _, a2, a1, a0, _, _, _ = first
    _, b2, b1, b0, _, _, _ = second
    last = a0 + b0
    total = a2 + b2
    change = (b1 - a1) / total
    rest = last / total
    product = a1 * b2 + a2 * b1
    across = a0 * b1 + a1 * b0
    apart = a0 * b2 - a2 * b0
    even_0 = product - last + change * (b1 - a1)
    odd_1 = apart - change * last
    even_2 = across - rest * last
    odd_3 = change * across - rest * apart
    even_4 = (product * even_2 + apart * odd_1) / total
    return Residues(even_0, odd_1, even_2, odd_3, even_4, even_0 * even_2 + odd_1 * odd_1)


def displacement_covariance(first: Motion, second: Motion, terms: Residues) -> Array:
    """``E[mu_1 mu_2]`` of a pair with these `residues`.

    The solution of ``A1 X + X A2' + b C2' + C1 b' = 0`` is the integral over time of impulse
    responses times free motions. By Parseval's theorem, its first entry is that of ``h_1(s) m_2(-s)
    + m_1(s) h_2(-s)`` with their transforms.
    """
    k1, _, _, _, m2, m1, m0 = first
    k2, _, _, _, n2, n1, n0 = second
    joint = (k1 * n0 + k2 * m0) * terms.even_0
    joint -= ((n0 - m0) + (k2 * m1 - k1 * n1)) * terms.odd_1
    joint -= (k1 * n2 + k2 * m2 - (m1 + n1)) * terms.even_2
    joint -= (n2 - m2) * terms.odd_3
    return joint / terms.determinant


def velocity_covariance(first: Motion, second: Motion, terms: Residues) -> Array:
    """``E[mu_1' mu_2']`` of a pair with these `residues`, under white noise of the intensity 1."""
    k1 = first.relaxation
    k2 = second.relaxation
    joint = terms.even_4 + (k2 - k1) * terms.odd_3 + k1 * k2 * terms.even_2
    return 2 * joint / terms.determinant


def pair_covariance(first: Motion, second: Motion) -> Array:
    """``E[mu_1 mu_2]`` of two structures on one ground.

    Divided by the root of the product of the same of each structure with itself, it is a
    correlation with an error of at most 1e-14, also where structures are nearly equal, hardly
    yield, or have periods that differ by a factor of a thousand. It is exactly 1 for equal
    structures, and does not change with their order.
    """
    return displacement_covariance(first, second, residues(first, second))


# The formulas that are also compiled for numbers.
FORMULAS = (
    characteristic,
    hurwitz,
    stable,
    linear_system,
    own_covariance,
    motion_of,
    residues,
    displacement_covariance,
    velocity_covariance,
    pair_covariance,
)
