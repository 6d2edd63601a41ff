"""Relations of damping and coefficient of restitution, for arrays, of linear and Hertz elements.

Two free masses approach one another at ``v0`` and separate at ``e v0``. The relations of the linear
elements use ``A(xi) = acos(xi)/sqrt(1 - xi^2)``, which is ``acosh(xi)/sqrt(xi^2 - 1)`` for ``xi >
1``. For the Hertz-damp force ``k d^n (1 + a v/v0)`` the energy balance ``a (1 + e) = ln[(1 + a)/(1
- a e)]`` has, for any exponent, a solution with one parameter ``x``. With Langevin's function
``L(x) = coth x - 1/x``,

    (1 - e)/(1 + e) = L(x),    a = x (1 + L(x)) = 2 x/(1 + e).

Where a relation has no closed form, the argument of an increasing function is found by
Chandrupatla's method, for its logarithm.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.optimize.elementwise import find_root
from scipy.special import ive

from stochlin.kernels.basics.arrays import Array

Form = Callable[[Array], Array]


class Relation(NamedTuple):
    """Damping and coefficient of restitution of a contact, either from the other."""

    restitution: Form
    damping: Form


LEAST_VALUE = 1e-100  # smaller values of a function are raised to it
# largest -log e: a restitution below 1e-304 is raised to it, else 1/e overflows
LARGEST_LOG = 700.0


def inverse(function: Form, values: Array) -> Array:
    """Arguments at which an increasing function, which is 0 at 0, has these values.

    The logarithm of an argument lies between that of the value less 1 and the larger of that plus 2
    and the value itself, for all functions of this module.
    """
    log = np.log(np.maximum(values, LEAST_VALUE))
    ends = log - 1, np.maximum(log + 2, np.minimum(values, LARGEST_LOG))
    root = find_root(lambda x, log: np.log(function(np.exp(x))) - log, ends, args=(log,))
    return np.where(values == 0, 0.0, np.exp(root.x))


def angle_ratio(xi: Array) -> Array:
    """``A(xi)`` by half angles, without cancellation and smooth at ``xi = 1``."""
    half = np.sqrt(np.abs(1 - xi) / 2)
    angle = np.where(xi < 1, np.arcsin(np.minimum(half, 1)), np.arcsinh(half))
    return np.sqrt(2 / (1 + xi)) * np.divide(angle, half, out=np.ones_like(half), where=half != 0)


def log_loss(xi: Array) -> Array:
    """``-log e = xi A(xi)`` of the `ImpactKelvin`."""
    return xi * angle_ratio(xi)


def kelvin_restitution(xi: Array) -> Array:
    """``e = exp(-pi xi/sqrt(1 - xi^2))`` of the Kelvin element with tension; 0 for ``xi >= 1``."""
    root = np.sqrt(np.maximum(1 - xi, 0) * (1 + xi))
    return np.exp(-np.divide(np.pi * xi, root, out=np.full_like(root, np.inf), where=root != 0))


def kelvin_damping(e: Array) -> Array:
    """Damping ratio of the Kelvin element by eq. (15), the inverse of `kelvin_restitution`."""
    loss = np.abs(np.log(e))
    return loss / np.hypot(np.pi, loss)


@np.errstate(over="ignore")  # where expm1 overflows, its reciprocal is zero
def langevin_odds(x: Array) -> Array:
    """``L/(1 - L)`` of Langevin's function, below 1 a ratio of Bessel functions."""
    near = np.minimum(x, 1)
    far = np.maximum(x, 1)
    small = ive(1.5, near) / ive(0.5, near)
    return np.where(x < 1, small / (1 - small), 1 / (1 / far - 2 / np.expm1(2 * far)) - 1)


def hertz_damp_restitution(a: Array) -> Array:
    """Coefficient of restitution ``e`` of the Hertz-damp force with damping factor ``a >= 0``."""

    def factor(x: Array) -> Array:
        odds = langevin_odds(x)
        return x * (1 + odds / (1 + odds))

    x = inverse(factor, a)
    return np.where(a == 0, 1.0, 1 / (1 + 2 * langevin_odds(np.maximum(x, LEAST_VALUE))))


def hertz_damp_factor(e: Array) -> Array:
    """Damping factor ``a`` of a Hertz-damp force for ``e``; inverse of `hertz_damp_restitution`."""
    e = np.maximum(e, np.exp(-LARGEST_LOG))
    return 2 * inverse(langevin_odds, (1 - e) / (2 * e)) / (1 + e)


def _linear(power: float, scale: float = 1.0) -> Relation:
    """``e = exp(-power z A(z))`` with the damping ratio ``scale z``."""
    return Relation(
        lambda xi: np.exp(-power * log_loss(xi / scale)),
        lambda e: scale * inverse(log_loss, np.minimum(np.abs(np.log(e)) / power, LARGEST_LOG)),
    )


KELVIN = Relation(kelvin_restitution, kelvin_damping)
NO_TENSION_KELVIN = _linear(2.0)
IMPACT_KELVIN = _linear(1.0)
JANKOWSKI = _linear(1.0, scale=np.sqrt(5) / 2)
HERTZ_DAMP = Relation(hertz_damp_restitution, hertz_damp_factor)
