"""Stationary covariances of linear and linearized oscillators, block by block and in closed form.

All functions broadcast. The state of one structure is ``(mu, mu', y)``: displacement over ``uy``,
velocity over ``uy``, and the slip ``y = mu - z`` in place of the hysteretic displacement ``z``. If a
structure hardly yields, ``y`` and all coefficients of its equation tend to zero together, and there is
no division by a small difference of large numbers. In these variables the linearized law
``z' = -c_e mu' - k_e z`` and the equation of motion are

    mu'' = -stiffness mu - damping mu' + coupling y + f
    y'   = relaxation mu + slip mu' - relaxation y,

with ``stiffness = w^2``, ``damping = 2 xi w``, ``coupling = (1 - alpha) w^2``,
``slip = 1 + c_e`` and ``relaxation = k_e``.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array, choose, solve_3x3

MEMORYLESS = 1e-12  # largest positive real pole, over w, that is rounding error of a pole at 0
FAST = 30.0  # relaxation over w above which the third state is z in place of y


class EquivalentSystem(NamedTuple):
    """Coefficients of the equations of one linearized oscillator, see the module's docstring."""

    stiffness: Array  # w^2 [1/s^2]
    damping: Array  # 2 xi w [1/s]
    coupling: Array  # (1 - alpha) w^2 [1/s^2]
    slip: Array  # 1 + c_e [-]
    relaxation: Array  # k_e [1/s]


def characteristic(w2: Array, d: Array, h: Array, p: Array, k: Array) -> tuple[Array, Array, Array]:
    """Characteristic polynomial ``(a2, a1, a0)`` of an `EquivalentSystem` with these coefficients.

    This function and the two below take numbers too, and are called from compiled code.
    """
    return d + k, w2 + d * k - h * p, (w2 - h) * k


def hurwitz(w2: Array, d: Array, h: Array, p: Array, k: Array) -> Array:
    """``a2 a1 - a0`` of an `EquivalentSystem` with these coefficients, without cancellation."""
    return d * (w2 + d * k + k * k - h * p) + (1 - p) * h * k


def stable(w2: Array, d: Array, h: Array, p: Array, k: Array) -> Array:
    """Whether an `EquivalentSystem` with these coefficients is stable, by Routh and Hurwitz.

    A pole at 0, within rounding, counts as stable. It belongs to a law without hysteresis, where ``z``
    is a function of ``mu``, no energy is dissipated, and the forcing does not excite this pole.
    """
    a2, a1, a0 = characteristic(w2, d, h, p, k)
    memory = a0 + MEMORYLESS * np.sqrt(w2) * a1
    return (a2 > 0) & (a1 > 0) & (memory > 0) & (hurwitz(w2, d, h, p, k) > 0)


class Forcing(NamedTuple):
    """Stationary covariances of the forcing ``f`` with the states ``mu``, ``mu'`` and ``y``.

    The stationary covariances of a structure depend on the ground through these three numbers alone. For
    white noise they are ``0, pi S0, 0``: half its intensity in time, with the velocity.
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

    The result is also exact in the elastic limit ``slip = relaxation = 0``, where the Lyapunov equation
    is singular. Without hardening (``coupling = stiffness``) the displacement has no stationary
    variance, and the result is infinite or NaN.
    """
    w2, d, h, p, k = system
    c = 1 - p
    f_z = forcing.mu - forcing.slip
    mu_z = (c * forcing.velocity + d * f_z) / hurwitz(w2, d, h, p, k)
    v_v = (forcing.velocity - h * k * mu_z) / d
    mu_mu = (v_v - h * mu_z + forcing.mu) / (w2 - h)
    return OwnCovariance(mu_mu, v_v, c * mu_z, k * mu_z, mu_z)


def pair_covariance(
    first: EquivalentSystem,
    forcing_1: Forcing,
    second: EquivalentSystem,
    forcing_2: Forcing,
) -> Array:
    """``E[mu_1 mu_2]`` of two structures on one ground, by elimination.

    In each cell the stiffer structure is taken as the first. The error of rho is then at most 2e-13 for
    periods that differ by a factor of up to 900 and hardening down to 0.001; in the other order it is up
    to 5e-9.
    """
    stiffer = first.stiffness >= second.stiffness
    stiff, soft = choose(stiffer, first, second), choose(stiffer, second, first)
    of_stiff, of_soft = choose(stiffer, forcing_1, forcing_2), choose(stiffer, forcing_2, forcing_1)
    return pair_row(stiff, of_stiff, soft, of_soft)[0]


class Coordinates(NamedTuple):
    """State matrix of a structure with the third state ``y`` or ``z``, see `coordinates`.

    The matrix has the rows ``(0, 1, 0)``, ``(-soft, -damping, coupling)`` and ``(back, slip, -fade)``.
    """

    soft: Array
    damping: Array
    coupling: Array
    back: Array
    slip: Array
    fade: Array
    third: Array  # covariance of the forcing with the third state
    fast: Array  # whether the third state is z


def coordinates(system: EquivalentSystem, forcing: Forcing) -> Coordinates:
    """The state matrix with the third state ``z`` where relaxation is fast, otherwise ``y``.

    With fast relaxation ``y`` is nearly equal to ``mu``, and their difference ``z`` would lose its
    digits by subtraction.
    """
    w2, d, h, p, k = system
    fast = k > FAST * np.sqrt(w2)
    return Coordinates(
        choose(fast, w2 - h, w2),
        d,
        choose(fast, -h, h),
        choose(fast, 0.0, k),
        choose(fast, 1 - p, p),
        k,
        choose(fast, forcing.mu - forcing.slip, forcing.slip),
        fast,
    )


def at_poles(first: EquivalentSystem, second: EquivalentSystem, matrix: Coordinates) -> Any:
    """``D1(-A2)``: characteristic polynomial of the first structure at minus the matrix of the second.

    By the theorem of Cayley and Hamilton ``A^3 = -a2 A^2 - a1 A - a0``, so that with the coefficients
    ``'`` of the first structure it is ``(a2' + a2) A^2 + (a1 - a1') A + (a0' + a0)``.
    """
    w, d, h, back, p, k, _, _ = matrix
    a2, a1, a0 = characteristic(*first)
    b2, b1, b0 = characteristic(*second)
    e, f, g = a2 + b2, b1 - a1, a0 + b0
    second_1, second_2, second_3 = d * w + h * back, d * d + h * p - w, -h * (d + k)  # rows of A^2
    third_1, third_2, third_3 = -p * w - k * back, back - p * (d + k), p * h + k * k
    return (
        (g - e * w, f - e * d, e * h),
        (e * second_1 - f * w, e * second_2 - f * d + g, e * second_3 + f * h),
        (e * third_1 + f * back, e * third_2 + f * p, e * third_3 - f * k + g),
    )


def pair_row(
    first: EquivalentSystem, forcing_1: Forcing, second: EquivalentSystem, forcing_2: Forcing
) -> tuple[Array, ...]:
    """First row of the pair's covariance: ``E[mu_1 mu_2]``, ``E[mu_1 mu_2']``, ``E[mu_1 y_2]``.

    The first row ``x`` of the solution ``X`` of ``A1 X + X A2' + b1 C2' + C1 b2' = 0`` satisfies the
    3 x 3 system ``D1(-A2) x = r``, where ``D1`` is the characteristic polynomial of ``A1``. It is solved
    by Cramer's rule. No eigenvalues are computed, so that equal eigenvalues cause no errors.
    """
    matrix = coordinates(second, forcing_2)
    w, d, h, back, p, k, third, fast = matrix
    p1, k1, h1, d1 = first.slip, first.relaxation, first.coupling, first.damping
    # r = (k1 - A2) [C2 f + e_v E(f v1) - (A2 - d1) e_v E(f mu1)] + h1 (E(f y1) - p1 E(f mu1)) e_v
    inner_1 = forcing_2.mu - forcing_1.mu
    inner_2 = forcing_2.velocity + forcing_1.velocity + (d + d1) * forcing_1.mu
    inner_3 = third - p * forcing_1.mu
    kick = h1 * (forcing_1.slip - p1 * forcing_1.mu)
    right = (
        k1 * inner_1 - inner_2,
        k1 * inner_2 + w * inner_1 + d * inner_2 - h * inner_3 + kick,
        k1 * inner_3 - back * inner_1 - p * inner_2 + k * inner_3,
    )
    displacement, velocity, last = solve_3x3(at_poles(first, second, matrix), right)
    return displacement, velocity, choose(fast, displacement - last, last)


# Of numbers and of arrays: where each pair depends on the last one, they are compiled.
FORMULAS = (
    characteristic,
    hurwitz,
    stable,
    linear_system,
    own_covariance,
    pair_covariance,
    coordinates,
    at_poles,
    pair_row,
)
