"""Relations between damping and coefficient of restitution, for arrays, of linear and Hertz elements.

Two free masses approach one another at ``v0`` and separate at ``e v0``. The relations of the linear
elements use ``A(xi) = acos(xi)/sqrt(1 - xi^2)``, which is ``acosh(xi)/sqrt(xi^2 - 1)`` for ``xi > 1``.
For the Hertz-damp force ``k d^n (1 + a v/v0)`` the energy balance ``a (1 + e) = ln[(1 + a)/(1 - a e)]``
has, for any exponent, a solution with one parameter ``x``. With Langevin's function
``L(x) = coth x - 1/x``,

    (1 - e)/(1 + e) = L(x),    a = x (1 + L(x)) = 2 x/(1 + e).

``xi`` and ``x`` are found as roots of monotonic functions whose curvature does not change sign.
Newton's method approaches such a root from one side and needs no bracket.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array

Form = Callable[[Array], Array]


class Relation(NamedTuple):
    """Damping and coefficient of restitution of a contact, either from the other."""

    restitution: Form
    damping: Form


NEWTON_STEPS = 6  # five steps reach machine precision for every restitution in (0, 1]
AT_ONE = 1e-6  # |xi - 1| below which the slope, there 0/0, is replaced by its limit
LARGEST = 700.0  # largest -log e: a restitution below 1e-304 is raised to it, else 1/e overflows
FRACTION = range(17, 3, -2)  # terms of Langevin's continued fraction, exact to rounding for x <= 1


def angle_ratio(xi: Array) -> Array:
    """``A(xi)`` by half angles, without cancellation and smooth at ``xi = 1``."""
    half = np.sqrt(np.abs(1 - xi) / 2)
    angle = np.where(xi < 1, np.arcsin(np.minimum(half, 1)), np.arcsinh(half))
    return np.sqrt(2 / (1 + xi)) * np.divide(angle, half, out=np.ones_like(half), where=half != 0)


def invert_angle_ratio(target: Array) -> Array:
    """``xi`` for which ``xi A(xi) = target >= 0``; ``xi A(xi)`` is a concave function."""
    target = np.minimum(target, LARGEST)
    xi = np.where(target < 1, 2 / np.pi * target, 0.5 * np.exp(target))
    for _ in range(NEWTON_STEPS):
        ratio = angle_ratio(xi)
        near = np.abs(xi - 1) < AT_ONE
        flat = np.where(near, 0.75, np.divide(xi - 1, xi - ratio, out=np.ones_like(xi), where=~near))
        xi = xi + (target - xi * ratio) * flat * (xi + 1)
    return xi


def kelvin_restitution(xi: Array) -> Array:
    """``e = exp(-pi xi/sqrt(1 - xi^2))`` of the Kelvin element with tension; 0 for ``xi >= 1``."""
    root = np.sqrt(np.maximum(1 - xi, 0) * (1 + xi))
    return np.exp(-np.divide(np.pi * xi, root, out=np.full_like(root, np.inf), where=root != 0))


def kelvin_damping(e: Array) -> Array:
    """Damping ratio of the Kelvin element by eq. (15), the inverse of `kelvin_restitution`."""
    loss = np.abs(np.log(e))
    return loss / np.hypot(np.pi, loss)


def langevin_fraction(x: Array) -> Array:
    """``L(x)/x`` for ``0 <= x <= 1``, by the continued fraction ``1/(3 + x^2/(5 + x^2/(7 + ...``."""
    below = np.full_like(x, FRACTION.start + 2)
    for odd in (*FRACTION, 3):
        below = odd + x * x / below
    return 1 / below


@np.errstate(over="ignore")  # where expm1 overflows, its reciprocal is zero
def coth_excess(x: Array) -> Array:
    """``coth x - 1`` for ``x > 0``."""
    return 2 / np.expm1(2 * x)


def hertz_damp_restitution(a: Array) -> Array:
    """Coefficient of restitution ``e`` of the Hertz-damp force with the damping factor ``a >= 0``."""
    x = np.minimum(a, 0.5 * (1 + a))  # above the root of a convex function
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
    """Damping factor ``a`` of the Hertz-damp force for ``e``; inverse of `hertz_damp_restitution`."""
    e = np.maximum(e, np.exp(-LARGEST))
    level, rest = (1 - e) / (1 + e), 2 * e / (1 + e)  # L and 1 - L
    x = level * (3 - level**2) * (1 + e) ** 2 / (4 * e)  # start by Cohen (1991), within 5 %
    for _ in range(NEWTON_STEPS):
        near, far = np.minimum(x, 1), np.maximum(x, 1)
        ratio = langevin_fraction(near)
        near_step = (level - near * ratio) / (1 - (near * ratio) ** 2 - 2 * ratio)
        excess = far * coth_excess(far)
        far_step = far * (1 - excess - rest * far) / (1 - excess * (excess + 2 * far))
        x = x + np.where(x < 1, near_step, far_step)
    return 2 * x / (1 + e)


KELVIN = Relation(kelvin_restitution, kelvin_damping)
NO_TENSION_KELVIN = Relation(
    lambda xi: np.exp(-2 * xi * angle_ratio(xi)),
    lambda e: invert_angle_ratio(0.5 * np.abs(np.log(e))),
)
IMPACT_KELVIN = Relation(
    lambda xi: np.exp(-xi * angle_ratio(xi)),
    lambda e: invert_angle_ratio(np.abs(np.log(e))),
)
LINEAR = np.sqrt(5) / 2  # xi of `Jankowski` over that of the `ImpactKelvin` with equal restitution
JANKOWSKI = Relation(
    lambda xi: IMPACT_KELVIN.restitution(xi / LINEAR), lambda e: LINEAR * IMPACT_KELVIN.damping(e)
)
HERTZ_DAMP = Relation(hertz_damp_restitution, hertz_damp_factor)
