"""What a closure computes, and Gaussian expectations for the bilinear law and for dashpots."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.special import gamma, ndtr, owens_t

from stochlin.kernels.basics.arrays import Array

SQRT_2PI = np.sqrt(2 * np.pi)


class ClosureValue(NamedTuple):
    """The results of a closure for moments ``(sv, sz, r)``, and their derivatives by these.

    The moments (called latent) are those of the Gaussian density behind the assumed density of
    ``(v, z)``; for the Gaussian closure both are the same.
    """

    coefficients: Array  # (2, n): 1 + c_e and k_e
    coefficients_jacobian: Array  # (2, 3, n)
    covariance: Array  # (3, n): Var v, Var z, Cov(v, z) of the assumed density
    covariance_jacobian: Array  # (3, 3, n)


Closure = Callable[[Array, Array], ClosureValue]  # of the latent moments and the law's parameters


def gaussian_covariance(latent: Array) -> tuple[Array, Array]:
    """``(Var v, Var z, Cov(v, z))`` of a Gaussian density, and the Jacobian by ``(sv, sz, r)``."""
    sv, sz, r = latent
    jacobian = np.zeros((3, *latent.shape))
    jacobian[0, 0], jacobian[1, 1] = 2 * sv, 2 * sz
    jacobian[2, 0], jacobian[2, 1], jacobian[2, 2] = r * sz, r * sv, sv * sz
    return np.array([sv * sv, sz * sz, r * sv * sz]), jacobian


class SlipQuadrant(NamedTuple):
    """Moments of ``x = v/sv`` over the quadrant ``v > 0, z > 1``, where the bilinear law slips.

    The last four fields are the terms of which the moments and their derivatives consist, with
    ``a = r/q``.
    """

    probability: Array  # P(v > 0, z > 1) = Q(h)/2 + T(h, a)
    first: Array  # E[x; v > 0, z > 1]
    second: Array  # E[x^2; v > 0, z > 1]
    h: Array  # 1/sz
    q: Array  # sqrt(1 - r^2)
    edge: Array  # phi(h) Phi(a h)
    corner: Array  # exp(-h^2/(2 q^2))/(2 pi)


def slip_quadrant(sz: Array, r: Array) -> SlipQuadrant:
    """Truncated moments of a bivariate Gaussian (Rosenbaum 1961, J. R. Stat. Soc. B 23).

    For ``r >= 0`` all terms of the probability, with Owen's function ``T``, are positive, so that its
    relative error remains small if slip is rare.
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
    """``E |v|^power = std^power 2^(power/2) Gamma((power + 1)/2)/sqrt(pi)`` of a Gaussian ``v``."""
    found: Array = std**power * 2 ** (power / 2) * gamma((power + 1) / 2) / np.sqrt(np.pi)
    return found


def equivalent_dashpot(constant: Array, exponent: Array, std: Array) -> Array:
    """Linear dashpot with the least mean square error to ``c |v|^a sign(v)``: ``c E|v|^(a+1)/E v^2``."""
    return constant * absolute_moment(exponent + 1, std) / std**2


def regress_slip(
    slip: Array, slip_jacobian: Array, covariance: Array, covariance_jacobian: Array
) -> tuple[Array, Array]:
    """Regression coefficients ``(1 + c_e, k_e)`` of the slip rate ``v - G(v, z)`` on ``(v, z)``.

    ``slip`` (2, n) are ``E[(v - G) v]`` and ``E[(v - G) z]``, ``covariance`` (3, n) are ``Var v``,
    ``Var z`` and ``Cov(v, z)``. The Jacobians, also that of the result, are by the latent moments.
    """

    def solve(by_v: Array, by_z: Array) -> Array:
        """Solution of the normal equations with the right-hand sides ``by_v`` and ``by_z``."""
        return np.array([by_v * zz - by_z * vz, by_z * vv - by_v * vz]) / (vv * zz - vz * vz)

    vv, zz, vz = covariance
    coefficients = solve(*slip)
    p, k = coefficients
    d_vv, d_zz, d_vz = covariance_jacobian
    jacobian = solve(slip_jacobian[0] - p * d_vv - k * d_vz, slip_jacobian[1] - p * d_vz - k * d_zz)
    return coefficients, jacobian
