"""Contacts as elements that only push: their forces, at an instant and as the mean over a time step.

``d`` is the penetration [m], positive in contact, ``v = d'`` its rate [m/s], and ``v0`` the approach
velocity, ``v`` at the beginning of this contact. A positive force pushes both sides apart; a negative
one pulls them together.

In a time step the penetration grows at a constant rate from ``before`` to ``before + change``. The mean
of the force over this way needs no separate treatment of a step in which contact begins or ends, and the
work of its elastic part is the change of the stored energy, to rounding.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.compiled import called_often, compiled

STILL = 1e-6  # change of a penetration, over its size, below which the mean is the value in the middle
CLOSE_FORCE = 1e-11  # residual of a mean force, over its bound, at which its search ends
MOST_TRIALS = 100  # of a search for a mean force


class ForceLaw(NamedTuple):
    """Parameters of the force ``k d^n + c d^p v`` of a contact element while ``d > 0``.

    The fields are numbers, or arrays that broadcast.
    """

    stiffness: Any = 1.0  # k [N/m^n]
    exponent: Any = 1.0  # n
    damping: Any = 0.0  # c [N s/m^(p+1)]; [-] if over_approach
    damping_exponent: Any = 0.0  # p
    approach_only: bool = False  # the dashpot acts only while v > 0
    over_approach: bool = False  # the dashpot's force is ``k d^n c v/v0``
    # The element can pull. If it cannot, contact ends where the force is zero; this requires p = n - 1,
    # unless approach_only is set.
    tension: bool = True


_FIELDS = [(name, type(value)) for name, value in ForceLaw()._asdict().items()]
LAW = np.dtype((np.record, np.dtype(_FIELDS, align=True)))  # a record: fields are also attributes


def law_table(laws: Iterable[ForceLaw]) -> Array:
    """The force laws of all contacts as a structured array, the type of ``Contacts.law``."""
    return np.array([tuple(law) for law in laws], LAW)


class Contacts(NamedTuple):
    """Contacts between floors, with the penetrations ``weights q - gap``."""

    weights: Array  # (c, n)
    gap: Array  # (c,) [m]
    law: Array  # (c,): a `law_table`
    jumps: bool  # impacts are stereomechanical: velocities jump, and ``law`` has no use
    restitution: float  # coefficient of restitution of stereomechanical impacts [-]


def no_contacts(coordinates: int) -> Contacts:
    """No contacts between so many coordinates."""
    return Contacts(np.zeros((0, coordinates)), np.zeros(0), law_table([]), False, 1.0)


@called_often
def _mean_power(p, before, change):
    """Mean of ``max(d, 0)^p`` over the way from ``before`` to ``before + change``."""
    after = before + change
    if before > 0.0 and after > 0.0:
        if p == 0.0:
            return 1.0
        middle = 0.5 * (before + after)
        if p == 1.0 or abs(change) < STILL * middle:
            return middle**p
    elif before <= 0.0 and after <= 0.0:
        return 0.0
    return (max(after, 0.0) ** (p + 1.0) - max(before, 0.0) ** (p + 1.0)) / ((p + 1.0) * change)


@compiled
def mean_force(law, v0, before, change, dt):
    """Mean force of a contact element over a step ``dt`` [s], and its elastic part [N]."""
    k, n, c, p, v = law.stiffness, law.exponent, law.damping, law.damping_exponent, change / dt
    elastic = k * _mean_power(n, before, change)
    if c == 0.0 or (law.approach_only and v <= 0.0):
        return elastic, elastic
    if law.over_approach:  # v0 is 0 if the contact began without an approach velocity
        return (elastic * (1.0 + c * v / v0) if v0 > 0.0 else elastic), elastic
    if law.tension or law.approach_only or v >= 0.0:
        return elastic + c * v * _mean_power(p, before, change), elastic
    least = -c * v / k  # the penetration at which the element lets go
    low, high = max(before, least), max(before + change, least)
    if low == high:
        return (0.0 if low == least else k * low**n + c * v * low**p), elastic
    work = k * (high ** (n + 1.0) - low ** (n + 1.0)) / (n + 1.0) + c * v * (high**n - low**n) / n
    return work / change, elastic


@compiled
def solve_force(law, v0, before, alone, g, dt):
    """Mean force of a contact [N] whose penetration changes by ``alone`` less ``g`` times this force.

    The force grows with the change, so that it lies between 0 and the force without its own effect. It
    is found by regula falsi, with halved weights for an end that is kept (the Illinois method).
    """
    bound = mean_force(law, v0, before, alone, dt)[0]
    low, high = 0.0, bound
    at_low, at_high = -bound, bound - mean_force(law, v0, before, alone - g * bound, dt)[0]
    force, kept = high, 0
    for _ in range(MOST_TRIALS):
        if abs(at_high) <= CLOSE_FORCE * abs(bound) or at_high == at_low:
            return high
        force = high - at_high * (high - low) / (at_high - at_low)
        off = force - mean_force(law, v0, before, alone - g * force, dt)[0]
        if abs(off) <= CLOSE_FORCE * abs(bound):
            return force
        if (off > 0.0) == (at_high > 0.0):
            high, at_high = force, off
            at_low *= 0.5 if kept == 1 else 1.0
            kept = 1
        else:
            low, at_low = force, off
            at_high *= 0.5 if kept == -1 else 1.0
            kept = -1
    return force
