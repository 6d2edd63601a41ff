"""What a closure computes; closures of the bilinear law, and of dashpots with an exponent.

The closures of the bilinear law consist of the moments of a bivariate Gaussian over the quadrant
``v > 0, z > 1``, where the law slips (Rosenbaum 1961, J. R. Stat. Soc. B 23). For a correlation ``r
>= 0`` all their terms are positive, so that the relative error remains small if slip is rare.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.special import gamma, ndtr, owens_t

from stochlin.kernels.basics.arrays import SQRT_2PI, Array

# Series of E[x^2; |x| < h]/(h^3 phi(h)) in h^2/2 for h < 1, the highest term first.
NARROW_SERIES = tuple(math.gamma(2.5) / (1.5 * math.gamma(2.5 + n)) for n in range(14, -1, -1))


class ClosureValue(NamedTuple):
    """The results of a closure for moments ``(sv, sz, r)``.

    The moments (called latent) are those of the Gaussian density behind the assumed density of
    ``(v, z)``; for the Gaussian closure both are the same.
    """

    coefficients: Array  # (2, n): 1 + c_e and k_e
    covariance: Array  # (3, n): Var v, Var z, Cov(v, z) of the assumed density


Closure = Callable[[Array, Array], ClosureValue]  # of the latent moments and the law's parameters


def gaussian_covariance(latent: Array) -> Array:
    """``(Var v, Var z, Cov(v, z))`` of a Gaussian density with these ``(sv, sz, r)``."""
    sv, sz, r = latent
    return np.array([sv * sv, sz * sz, r * sv * sz])


class SlipQuadrant(NamedTuple):
    """Moments of ``x = v/sv`` over the quadrant ``v > 0, z > 1``, where the bilinear law slips.

    They consist of such moments along the edge ``z = 1``, of which ``flow`` is that of ``x``.
    """

    probability: Array  # P(v > 0, z > 1)
    first: Array  # E[x; v > 0, z > 1]
    second: Array  # E[x^2; v > 0, z > 1]
    h: Array  # 1/sz
    flow: Array  # E[x; v > 0 | z = 1] times the density phi(h)


def absolute_moment(power: Array, std: Array) -> Array:
    """``E |v|^power = std^power 2^(power/2) Gamma((power + 1)/2)/sqrt(pi)`` of a Gaussian ``v``."""
    moment: Array = std**power * 2 ** (power / 2) * gamma((power + 1) / 2) / np.sqrt(np.pi)
    return moment


def equivalent_dashpot(constant: Array, exponent: Array, std: Array) -> Array:
    """Linear dashpot of least mean square error to ``c |v|^a sign(v)``: ``c E|v|^(a+1)/E v^2``."""
    return constant * absolute_moment(exponent + 1, std) / std**2


def regress_slip(by_v: Array, by_z: Array, covariance: Array) -> Array:
    """Regression coefficients ``(1 + c_e, k_e)`` of the slip rate ``v - G(v, z)`` on ``(v, z)``.

    ``by_v`` and ``by_z`` are ``E[(v - G) v]`` and ``E[(v - G) z]``; ``covariance`` (3, n) are ``Var
    v``, ``Var z`` and ``Cov(v, z)``.
    """
    vv, zz, vz = covariance
    return np.array([by_v * zz - by_z * vz, by_z * vv - by_v * vz]) / (vv * zz - vz * vz)


def slip_quadrant(sz: Array, r: Array) -> SlipQuadrant:
    """The moments for a standard deviation ``sz`` of ``z`` and the correlation ``r``."""
    h = 1 / sz
    q = np.sqrt((1 - r) * (1 + r))
    probability = 0.5 * ndtr(-h) + owens_t(h, r / q)
    edge = np.exp(-0.5 * h * h) / SQRT_2PI * ndtr(r / q * h)
    corner = np.exp(-0.5 * (h / q) * (h / q)) / (2 * math.pi)
    first = ndtr(-h / q) / SQRT_2PI + r * edge
    flow = r * h * edge + q * corner
    second = probability + r * flow
    return SlipQuadrant(probability, first, second, h, flow)


def within_yield(h: Array) -> tuple[Array, Array, Array]:
    """``P(|x| < h)``, ``E[x^2; |x| < h]`` and ``P(|x| > h)`` of a standard Gaussian ``x``."""
    half = 0.5 * h * h
    tail = ndtr(-h)
    between = 2 * h * np.exp(-half) / SQRT_2PI
    series = 0.0 * h
    for coefficient in NARROW_SERIES:
        series = series * half + coefficient
    square = np.where(h < 1, half * between * series, 1 - 2 * tail - between)
    return square + between, square, 2 * tail


def gaussian(latent: Array, parameters: Array) -> ClosureValue:
    """Gaussian closure: the equivalent coefficients of eqs. (9) and (10) in closed form.

    ``1 + c_e = 2 P(v > 0, z > 1)`` and ``k_e = 2 sv h (r h B + q E)``, where ``sv`` and ``sz`` are
    the standard deviations, ``r`` their correlation, ``h = 1/sz``, ``q = sqrt(1 - r^2)``, and ``r h
    B + q E`` is the ``flow`` of `SlipQuadrant`.
    """
    sv, sz, r = latent
    probability, _, _, h, flow = slip_quadrant(sz, r)
    return ClosureValue(np.array([2 * probability, 2 * sv * h * flow]), gaussian_covariance(latent))


def clipped(latent: Array, parameters: Array) -> ClosureValue:
    """Clipped closure (Asano & Iwan 1984; Hurtado & Barbat 1996): ``z = clip(z~, -1, 1)``.

    ``(v, z~)`` is Gaussian with the latent moments, so that ``|z| <= 1`` always holds. The
    equivalent coefficients are those of the linear regression of the slip rate ``v - G`` on ``(v,
    z)``.
    """
    sv, sz, r = latent
    _, first, second, h, _ = slip_quadrant(sz, r)
    inside, inside_square, outside = within_yield(h)
    covariance = np.array([sv * sv, sz * sz * inside_square + outside, r * sv * sz * inside])
    return ClosureValue(regress_slip(2 * sv * sv * second, 2 * sv * first, covariance), covariance)
