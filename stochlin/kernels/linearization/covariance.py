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

from collections.abc import Sequence
from typing import NamedTuple, TypeVar

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.small_systems import solve_3x3

MEMORYLESS = 1e-12  # largest positive real pole, over w, that is rounding error of a pole at 0
FAST = 30.0  # relaxation over w above which the third state is z in place of y

Rows3 = tuple[tuple[Array, Array, Array], ...]


class EquivalentSystem(NamedTuple):
    """Coefficients of the equations of one linearized oscillator, see the module's docstring."""

    stiffness: Array  # w^2 [1/s^2]
    damping: Array  # 2 xi w [1/s]
    coupling: Array  # (1 - alpha) w^2 [1/s^2]
    slip: Array  # 1 + c_e [-]
    relaxation: Array  # k_e [1/s]

    @property
    def characteristic(self) -> tuple[Array, Array, Array]:
        """Coefficients ``(a2, a1, a0)`` of ``det(sI - A) = s^3 + a2 s^2 + a1 s + a0``."""
        return characteristic(*self)

    @property
    def hurwitz(self) -> Array:
        """``a2 a1 - a0`` of the characteristic polynomial, computed without cancellation."""
        return hurwitz(*self)

    @property
    def stable(self) -> Array:
        """Whether the system is stable, by the criterion of Routh and Hurwitz."""
        return stable(*self)

    def transfer_squared(self, frequency: Array) -> Array:
        """``|mu/f|^2 = (w^2 + k^2)/|det(i w I - A)|^2`` at circular frequencies [rad/s], in s^4."""
        a2, a1, a0 = self.characteristic
        square = frequency**2
        real, imaginary = a0 - a2 * square, frequency * (a1 - square)
        return (square + self.relaxation**2) / (real**2 + imaginary**2)


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


Rows = TypeVar("Rows", EquivalentSystem, Forcing)


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
    stiffer = np.asarray(first.stiffness >= second.stiffness)
    if stiffer.all():
        return pair_row(first, forcing_1, second, forcing_2)[0]
    if not stiffer.any():
        return pair_row(second, forcing_2, first, forcing_1)[0]

    def choose(yes: Rows, no: Rows) -> Rows:
        return type(yes)(*(np.where(stiffer, a, b) for a, b in zip(yes, no, strict=True)))

    stiff, force_stiff = choose(first, second), choose(forcing_1, forcing_2)
    return pair_row(stiff, force_stiff, choose(second, first), choose(forcing_2, forcing_1))[0]


def coordinates(system: EquivalentSystem, forcing: Forcing) -> tuple[Rows3, Array, Array]:
    """Rows of the state matrix ``A``, covariance of the forcing with the third state, and which it is.

    The third state is ``z`` where the last result is true, otherwise ``y``. With fast relaxation ``y``
    is nearly equal to ``mu``, and their difference ``z`` would lose its digits by subtraction.
    """
    w2, d, h, p, k = system
    fast = np.asarray(k > FAST * np.sqrt(w2))
    zeros, ones = np.zeros_like(w2), np.ones_like(w2)
    rows = (
        (zeros, ones, zeros),
        (np.where(fast, h - w2, -w2), -d, np.where(fast, -h, h)),
        (np.where(fast, 0, k), np.where(fast, 1 - p, p), -k),
    )
    return rows, np.where(fast, forcing.mu - forcing.slip, forcing.slip), fast


def at_poles(first: EquivalentSystem, rows: Rows3) -> list[list[Array]]:
    """``D1(-A2)``: characteristic polynomial of the first structure at minus the matrix of the second.

    ``rows`` are those of the matrix ``A2``.
    """
    a2, a1, a0 = first.characteristic
    columns = tuple(zip(*rows, strict=True))
    squares = [_times(rows, column) for column in columns]
    cubes = [_times(rows, column) for column in squares]
    return [
        [a2 * squares[j][i] - cubes[j][i] - a1 * rows[i][j] + (a0 if i == j else 0) for j in range(3)]
        for i in range(3)
    ]


def _times(rows: Rows3, column: Sequence[Array]) -> tuple[Array, ...]:
    """A 3 x 3 matrix, given by its rows, times a column."""
    return tuple(row[0] * column[0] + row[1] * column[1] + row[2] * column[2] for row in rows)


def pair_row(
    first: EquivalentSystem, forcing_1: Forcing, second: EquivalentSystem, forcing_2: Forcing
) -> tuple[Array, ...]:
    """First row of the pair's covariance: ``E[mu_1 mu_2]``, ``E[mu_1 mu_2']``, ``E[mu_1 y_2]``.

    The first row ``x`` of the solution ``X`` of ``A1 X + X A2' + b1 C2' + C1 b2' = 0`` satisfies the
    3 x 3 system ``D1(-A2) x = r``, where ``D1`` is the characteristic polynomial of ``A1``. It is solved
    by Cramer's rule. No eigenvalues are computed, so that equal eigenvalues cause no errors.
    """
    rows, third, fast = coordinates(second, forcing_2)
    p1, k1, h1, d1 = first.slip, first.relaxation, first.coupling, first.damping
    # r = (k1 - A2) [C2 f + e_v E(f v1) - (A2 - d1) e_v E(f mu1)] + h1 (E(f y1) - p1 E(f mu1)) e_v
    inner = (
        forcing_2.mu - forcing_1.mu,
        forcing_2.velocity + forcing_1.velocity + (second.damping + d1) * forcing_1.mu,
        third - rows[2][1] * forcing_1.mu,
    )
    right = [k1 * u - v for u, v in zip(inner, _times(rows, inner), strict=True)]
    right[1] = right[1] + h1 * (forcing_1.slip - p1 * forcing_1.mu)
    displacement, velocity, last = solve_3x3(at_poles(first, rows), right)
    return displacement, velocity, np.where(fast, displacement - last, last)
