"""Contacts as elements that only push: their forces, at an instant and as the mean of a time step.

``d`` is the penetration [m], positive in contact, ``v = d'`` its rate [m/s], and ``v0`` the
approach velocity, ``v`` at the beginning of this contact. A positive force pushes both sides apart;
a negative one pulls them together.

In a time step the penetration grows at a constant rate from ``before`` to ``before + change``. The
mean of the force over this way needs no separate treatment of a step in which contact begins or
ends, and the work of its elastic part is the change of the stored energy, to rounding.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.borrowed import borrowed
from stochlin.kernels.basics.compiled import called_often, called_once, compiled
from stochlin.kernels.simulation.row_products import rows_of

# change of a penetration, over its size, below which the mean is the value in the middle
NEARLY_CONSTANT = 1e-6
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
    # The element can pull. If it cannot, contact ends where the force is zero; this requires p = n
    # - 1, unless approach_only is set.
    tension: bool = True


_FIELDS_OF_LAW = [(name, type(value)) for name, value in ForceLaw()._asdict().items()]
# a record: fields are also attributes
LAW = np.dtype((np.record, np.dtype(_FIELDS_OF_LAW, align=True)))


def law_table(laws: Iterable[ForceLaw]) -> Array:
    """The force laws of all contacts as a structured array, the type of ``Contacts.law``."""
    return np.array([tuple(law) for law in laws], LAW)


@borrowed
class Contacts(NamedTuple):
    """Contacts between floors, with the penetrations ``weights q - gap``."""

    weights: Array  # (c, n)
    rows: Array  # the same, by `rows_of`
    right: Array  # that part of it which belongs to the structure on the right
    # (c,): that of the last coordinate if it is a wall, which no force moves; else 0
    of_wall: Array
    gap: Array  # (c,) [m]
    law: Array  # (c,): a `law_table`
    jumps: bool  # impacts are stereomechanical: velocities jump, and ``law`` has no use
    restitution: float  # coefficient of restitution of stereomechanical impacts [-]

    @classmethod
    def of(
        cls,
        laws: Sequence[ForceLaw],
        coordinates: int,
        left: Array | None = None,
        right: Array | None = None,
        gap: Array | None = None,
        restitution: float | None = None,
        wall: bool = False,
    ) -> Contacts:
        """Contacts with these laws, or stereomechanical ones, between so many coordinates.

        ``left`` and ``right`` (c, n) are the parts of the weights that belong to either side. The
        last coordinate may be that of a ``wall``.
        """
        no_weights = np.zeros((len(laws), coordinates))
        on_left = no_weights if left is None else left
        on_right = no_weights if right is None else right
        weights = on_left + on_right
        return cls(
            weights=weights,
            rows=rows_of(weights),
            right=rows_of(on_right),
            of_wall=weights[:, -1].copy() if wall else np.zeros(len(laws)),
            gap=np.zeros(len(laws)) if gap is None else gap,
            law=law_table(laws),
            jumps=restitution is not None,
            restitution=1.0 if restitution is None else float(restitution),
        )


@called_often
def force(law, d, v, v0):
    """Force [N] of one element at an instant; zero where there is no contact, ``d <= 0``."""
    if d <= 0.0:
        return 0.0
    elastic = law.stiffness * d**law.exponent
    if law.approach_only and v < 0.0:
        return elastic
    if law.over_approach:  # v0 is 0 if the contact began without an approach velocity
        return elastic * (1.0 + law.damping * v / v0) if v0 > 0.0 else elastic
    total = elastic + law.damping * d**law.damping_exponent * v
    return total if law.tension or law.approach_only else max(total, 0.0)


@called_often
def separation_margin(law, d, v):
    """Quantity that falls to zero when the force of a contact ends [m].

    It is the penetration for an element that can pull. Otherwise it is the force over ``k
    d^(n-1)``, which is zero earlier: the element then lets go while it is still compressed.
    """
    return d if law.tension or law.approach_only else d + law.damping * v / law.stiffness


@called_often
def stored_in(law: Any, d: Any) -> Any:
    """Elastic energy of an element at the penetration ``d`` [J]."""
    return law.stiffness * max(d, 0.0) ** (law.exponent + 1.0) / (law.exponent + 1.0)


def reduced_mass(mass_1: Any, mass_2: Any) -> Any:
    """Reduced mass ``m1 m2/(m1 + m2)`` [kg]; infinite mass is a rigid wall. Scalars or arrays."""
    return 1.0 / (1.0 / mass_1 + 1.0 / mass_2)


def velocities_after_impact(
    velocity_1: Any, velocity_2: Any, mass_1: Any, mass_2: Any, restitution: Any
) -> tuple[Any, Any]:
    """Eq. (13): velocities of both structures after stereomechanical impact. Scalars or arrays."""
    jump = (1.0 + restitution) * (velocity_1 - velocity_2)
    return velocity_1 - jump / (1.0 + mass_1 / mass_2), velocity_2 + jump / (1.0 + mass_2 / mass_1)


def impact_loss(mass_1: Any, mass_2: Any, restitution: Any) -> Any:
    """Energy lost in a stereomechanical impact, over ``(u1' - u2')^2`` [kg]. Scalars or arrays."""
    return 0.5 * (1.0 - restitution) * (1.0 + restitution) * reduced_mass(mass_1, mass_2)


@called_often
def _mean_power(p, before, change):
    """Mean of ``max(d, 0)^p`` over the way from ``before`` to ``before + change``."""
    after = before + change
    if before > 0.0 and after > 0.0:
        if p == 0.0:
            return 1.0
        middle = 0.5 * (before + after)
        if p == 1.0 or abs(change) < NEARLY_CONSTANT * middle:
            return middle**p
    elif before <= 0.0 and after <= 0.0:
        return 0.0
    return (max(after, 0.0) ** (p + 1.0) - max(before, 0.0) ** (p + 1.0)) / ((p + 1.0) * change)


@compiled
def mean_force(law, v0, before, change, dt):
    """Mean force of a contact element over a step ``dt`` [s], and its elastic part [N]."""
    k = law.stiffness
    n = law.exponent
    c = law.damping
    p = law.damping_exponent
    v = change / dt
    elastic = k * _mean_power(n, before, change)
    if c == 0.0 or (law.approach_only and v <= 0.0):
        return elastic, elastic
    if law.over_approach:  # v0 is 0 if the contact began without an approach velocity
        return (elastic * (1.0 + c * v / v0) if v0 > 0.0 else elastic), elastic
    least = -c * v / k  # the penetration at which an element without tension lets go
    if law.tension or law.approach_only or v >= 0.0 or least <= before + change:
        return elastic + c * v * _mean_power(p, before, change), elastic
    low, high = max(before, least), max(before + change, least)
    if low == high:
        return (0.0 if low == least else k * low**n + c * v * low**p), elastic
    work = k * (high ** (n + 1.0) - low ** (n + 1.0)) / (n + 1.0) + c * v * (high**n - low**n) / n
    return work / change, elastic


@called_once
def solve_force(law, v0, before, alone, g, dt):
    """Mean force ``f`` [N] of a contact whose penetration changes by ``alone - g f``.

    The force grows with the change, so that it lies between 0 and the force without its own effect.
    It is found by regula falsi, with halved weights for an end that stays (the Illinois method).
    """
    bound = mean_force(law, v0, before, alone, dt)[0]
    low = 0.0
    high = bound
    at_low = -bound
    at_high = bound - mean_force(law, v0, before, alone - g * bound, dt)[0]
    force = high
    side = 0
    for _ in range(MOST_TRIALS):
        if abs(at_high) <= CLOSE_FORCE * abs(bound) or at_high == at_low:
            return high
        force = high - at_high * (high - low) / (at_high - at_low)
        off = force - mean_force(law, v0, before, alone - g * force, dt)[0]
        if abs(off) <= CLOSE_FORCE * abs(bound):
            return force
        if (off > 0.0) == (at_high > 0.0):
            high = force
            at_high = off
            at_low *= 0.5 if side == 1 else 1.0
            side = 1
        else:
            low = force
            at_low = off
            at_high *= 0.5 if side == -1 else 1.0
            side = -1
    return force
