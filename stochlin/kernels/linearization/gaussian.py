"""Closures, and Gaussian expectations: of ``(v, z)`` where a bilinear law slips, and of powers."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.special import gamma, ndtr, owens_t

from stochlin.kernels.basics.arrays import Array

SQRT_2PI = np.sqrt(2 * np.pi)


class ClosureValue(NamedTuple):
    """A closure at latent moments ``(sv, sz, r)``, and its derivatives by them.

    ``coefficients`` are ``(1 + c_e, k_e)``, ``covariance`` is ``(Var v, Var z, Cov(v, z))``
    under the density assumed. Shapes (2, n), (2, 3, n), (3, n), (3, 3, n).
    """

    coefficients: Array
    coefficients_jacobian: Array
    covariance: Array
    covariance_jacobian: Array


Closure = Callable[[Array, Array], ClosureValue]  # latent moments, law parameters


def gaussian_covariance(latent: Array) -> tuple[Array, Array]:
    """Covariance and its Jacobian of the Gaussian density with moments ``(sv, sz, r)``."""
    sv, sz, r = latent
    jacobian = np.zeros((3, *latent.shape))
    jacobian[0, 0], jacobian[1, 1] = 2 * sv, 2 * sz
    jacobian[2, 0], jacobian[2, 1], jacobian[2, 2] = r * sz, r * sv, sv * sz
    return np.array([sv * sv, sz * sz, r * sv * sz]), jacobian


class SlipQuadrant(NamedTuple):
    """Partial moments over ``{v > 0, z > 1}`` of ``x = v / sv``, and what their derivatives need.

    With ``h = 1 / sz``, ``q = sqrt(1 - r^2)``, ``a = r / q``:
    ``edge = phi(h) Phi(a h)`` and ``corner = exp(-h^2 / (2 q^2)) / (2 pi)``.
    """

    probability: Array  # P(v > 0, z > 1) = Q(h)/2 + T(h, a)
    first: Array  # E[x; v > 0, z > 1]
    second: Array  # E[x^2; v > 0, z > 1]
    h: Array
    q: Array
    edge: Array
    corner: Array


def slip_quadrant(sz: Array, r: Array) -> SlipQuadrant:
    """Rosenbaum's truncated moments (1961, J. R. Stat. Soc. B 23), with Owen's T.

    The tail is summed from positive terms for ``r >= 0``: its relative accuracy survives
    where slip becomes rare.
    """
    h = 1 / sz
    q = np.sqrt((1 - r) * (1 + r))
    a = r / q
    with np.errstate(under="ignore"):
        edge = np.exp(-0.5 * h * h) / SQRT_2PI * ndtr(a * h)
        corner = np.exp(-0.5 * (h / q) ** 2) / (2 * np.pi)
        probability = 0.5 * ndtr(-h) + owens_t(h, a)
        first = ndtr(-h / q) / SQRT_2PI + r * edge
    second = probability + r * (r * h * edge + q * corner)
    return SlipQuadrant(probability, first, second, h, q, edge, corner)


def absolute_moment(power: Array, std: Array) -> Array:
    """``E |v|^power`` of a Gaussian rate: ``std^power 2^(power/2) Gamma((power + 1)/2) / sqrt(pi)``."""
    found: Array = std**power * 2 ** (power / 2) * gamma((power + 1) / 2) / np.sqrt(np.pi)
    return found


def equivalent_dashpot(constant: Array, exponent: Array, std: Array) -> Array:
    """The linear dashpot nearest to ``c |v|^a sign(v)`` in the mean square: ``c E|v|^(a+1) / E v^2``."""
    return constant * absolute_moment(exponent + 1, std) / std**2


def regress_slip(
    slip: Array, slip_jacobian: Array, covariance: Array, covariance_jacobian: Array
) -> tuple[Array, Array]:
    """Least-squares ``(1 + c_e, k_e)`` of the slip rate ``v - G(v, z)`` on ``(v, z)``, with Jacobian.

    ``slip`` (2, n) is ``E[(v - G) v]`` and ``E[(v - G) z]``, ``covariance`` (3, n) ``Var v``, ``Var z``
    and ``Cov(v, z)``; their Jacobians are by the latent moments.
    """

    def solve(by_v: Array, by_z: Array) -> Array:
        return np.array([by_v * zz - by_z * vz, by_z * vv - by_v * vz]) / (vv * zz - vz * vz)

    vv, zz, vz = covariance
    coefficients = solve(*slip)
    p, k = coefficients
    d_vv, d_zz, d_vz = covariance_jacobian
    jacobian = solve(slip_jacobian[0] - p * d_vv - k * d_vz, slip_jacobian[1] - p * d_vz - k * d_zz)
    return coefficients, jacobian
