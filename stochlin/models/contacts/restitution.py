"""Closed forms between damping and restitution, on arrays: linear elements and the Hertz-damp one.

Two free masses meet at ``v0`` and part at ``e v0``. For the linear elements everything hangs on
``A(xi) = acos(xi)/sqrt(1 - xi^2)``, which beyond ``xi = 1`` is ``acosh(xi)/sqrt(xi^2 - 1)``. For the
Hertz-damp force ``k d^n (1 + a v/v0)`` the energy balance ``a (1 + e) = ln[(1 + a)/(1 - a e)]`` is
solved by one parameter ``x``: with Langevin's function ``L(x) = coth x - 1/x``,

    (1 - e)/(1 + e) = L(x),    a = x (1 + L(x)) = 2 x/(1 + e),

whatever the exponent. Both unknowns are roots of functions that are monotonic and of one curvature, on
which Newton's method goes to the root from one side: it needs no bracket.
"""

from __future__ import annotations

import numpy as np

from stochlin.kernels.basics.arrays import Array

NEWTON_STEPS = 6  # five reach the last digit from these starts, over all of (0, 1]
AT_ONE = 1e-6  # of xi: slopes are 0/0 there, and their limit is good to this order
LARGEST = 700.0  # of -log e: a restitution below 1e-304 counts as that, or 1/e would overflow
FRACTION = range(17, 3, -2)  # of Langevin's continued fraction: the last digit for x <= 1


def angle_ratio(xi: Array) -> Array:
    """``A(xi)``, from half angles: without cancellation, and smooth through ``xi = 1``."""
    half = np.sqrt(np.abs(1 - xi) / 2)
    angle = np.where(xi < 1, np.arcsin(np.minimum(half, 1)), np.arcsinh(half))
    return np.sqrt(2 / (1 + xi)) * np.divide(angle, half, out=np.ones_like(half), where=half != 0)


def invert_angle_ratio(target: Array) -> Array:
    """The ``xi`` at which ``xi A(xi)`` is ``target >= 0``; the function is concave."""
    target = np.minimum(target, LARGEST)
    xi = np.where(target < 1, 2 / np.pi * target, 0.5 * np.exp(target))
    for _ in range(NEWTON_STEPS):
        ratio = angle_ratio(xi)
        near = np.abs(xi - 1) < AT_ONE
        flat = np.where(near, 0.75, np.divide(xi - 1, xi - ratio, out=np.ones_like(xi), where=~near))
        xi = xi + (target - xi * ratio) * flat * (xi + 1)
    return xi


def kelvin_restitution(xi: Array) -> Array:
    """Kelvin element that may pull: ``exp(-pi xi/sqrt(1 - xi^2))``; 0 from ``xi = 1`` on."""
    return np.exp(-xi * kelvin_time(xi))


def kelvin_time(xi: Array) -> Array:
    """Contact time ``pi/sqrt(1 - xi^2)`` over ``sqrt(m/k)``; infinite from ``xi = 1`` on."""
    root = np.sqrt(np.maximum(1 - xi, 0) * (1 + xi))
    return np.divide(np.pi, root, out=np.full_like(root, np.inf), where=root != 0)


def kelvin_damping(e: Array) -> Array:
    """Eq. (15): inverse of `kelvin_restitution`."""
    loss = np.abs(np.log(e))
    return loss / np.hypot(np.pi, loss)


def langevin_fraction(x: Array) -> Array:
    """``L(x)/x`` for ``0 <= x <= 1``, by the continued fraction ``1/(3 + x^2/(5 + x^2/(7 + ...``."""
    below = np.full_like(x, FRACTION.start + 2)
    for odd in (*FRACTION, 3):
        below = odd + x * x / below
    return 1 / below


@np.errstate(over="ignore")  # of expm1, where its reciprocal is zero
def coth_excess(x: Array) -> Array:
    """``coth x - 1`` for ``x > 0``."""
    return 2 / np.expm1(2 * x)


def hertz_damp_restitution(a: Array) -> Array:
    """The ``e`` that the Hertz-damp force with the factor ``a >= 0`` delivers."""
    x = np.minimum(a, 0.5 * (1 + a))  # right of the root of a convex function
    for _ in range(NEWTON_STEPS):
        near, far = np.minimum(x, 1), np.maximum(x, 1)
        ratio, excess = langevin_fraction(near), coth_excess(far)
        small = near * ratio
        value = np.where(x < 1, near + near * small, 2 * far - 1 + far * excess)
        near_slope = 1 + small + near * (1 - small**2 - 2 * ratio)
        slope = np.where(x < 1, near_slope, 2 + excess - far * excess * (2 + excess))
        x = x - (value - a) / slope
    near, far = np.minimum(x, 1), np.maximum(x, 1)
    small, rest = near * langevin_fraction(near), far * coth_excess(far)  # L and x (coth x - 1)
    return np.where(x < 1, (1 - small) / (1 + small), (1 - rest) / (2 * far - 1 + rest))


def hertz_damp_factor(e: Array) -> Array:
    """Inverse of `hertz_damp_restitution`: the factor ``a`` that delivers ``e``."""
    e = np.maximum(e, np.exp(-LARGEST))
    level, rest = (1 - e) / (1 + e), 2 * e / (1 + e)  # L and 1 - L
    x = level * (3 - level**2) * (1 + e) ** 2 / (4 * e)  # Cohen (1991), within 5 %
    for _ in range(NEWTON_STEPS):
        near, far = np.minimum(x, 1), np.maximum(x, 1)
        ratio = langevin_fraction(near)
        near_step = (level - near * ratio) / (1 - (near * ratio) ** 2 - 2 * ratio)
        excess = far * coth_excess(far)
        far_step = far * (1 - excess - rest * far) / (1 - excess * (excess + 2 * far))
        x = x + np.where(x < 1, near_step, far_step)
    return 2 * x / (1 + e)
