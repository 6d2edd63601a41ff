"""Force and end of contact of a contact element; velocities after a stereomechanical impact, eq. (13).

``d = u1 - u2 - gap`` is the penetration [m], positive in contact, ``v = d'`` its rate [m/s], and ``v0``
the approach velocity, ``v`` at the beginning of this contact. A positive force pushes structure 1 to the
left and structure 2 to the right; a negative force pulls them together.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.compiled import called_often, compiled, entry

# Branches of a contact: no contact; in contact; in contact and opening, if the dashpot acts only while
# closing; compressed but without force; two floors that move together after a stereomechanical impact.
OPEN, CLOSED, OPENING, PARTED, TOGETHER = range(5)


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
    """The force laws of all contacts as a structured array, the type of ``Row.element``."""
    return np.array([tuple(law) for law in laws], LAW)


@called_often
def branch_force(law, branch, d, v, v0):
    """Force of an element on a given branch, and its elastic part [N].

    Both continue smoothly beyond the ends of the branch.
    """
    if branch == OPEN:
        return 0.0, 0.0
    elastic = law.stiffness * d if law.exponent == 1.0 else law.stiffness * max(d, 0.0) ** law.exponent
    if branch == PARTED:
        return 0.0, elastic
    if branch == OPENING:
        return elastic, elastic
    if law.over_approach:  # v0 is 0 if the contact began without an approach velocity
        return (elastic * (1.0 + law.damping * v / v0) if v0 > 0.0 else elastic), elastic
    c = law.damping
    if law.damping_exponent != 0.0:
        c *= max(d, 0.0) ** law.damping_exponent
    return elastic + c * v, elastic


@compiled
def has_fractional_power(law):
    """Whether the force has a power of ``d`` other than 1: it is then not smooth at ``d = 0``."""
    return law.exponent != 1.0 or law.damping_exponent != 0.0


@compiled
def force(law, d, v, v0):
    """Force [N] of one element; zero where there is no contact, ``d <= 0``."""
    if d <= 0.0:
        return 0.0
    total, _ = branch_force(law, OPENING if law.approach_only and v < 0.0 else CLOSED, d, v, v0)
    return total if law.tension else max(total, 0.0)


def forces(law: ForceLaw, d: Any, v: Any, v0: Any) -> Array:
    """`force` [N] for fields of the law and for ``d``, ``v`` and ``v0`` that broadcast."""
    given = np.broadcast_arrays(*law, d, v, v0)
    result = np.empty(given[-1].shape)
    _forces(*(np.ascontiguousarray(array).ravel() for array in given), result.reshape(-1))
    return result


@entry
def _forces(k, n, c, p, approach_only, over_approach, tension, d, v, v0, out):
    for i in range(out.size):
        law = ForceLaw(k[i], n[i], c[i], p[i], approach_only[i], over_approach[i], tension[i])
        out[i] = force(law, d[i], v[i], v0[i])


@compiled
def separation_margin(law, d, v):
    """Quantity that falls to zero when the contact ends [m].

    It is the penetration for an element that can pull. Otherwise it is the force over ``k d^(n-1)``,
    which is zero earlier: the faces then separate while the element is still compressed.
    """
    return d if law.tension or law.approach_only else d + law.damping * v / law.stiffness


def stored_energy(law: Array, d: Array) -> Array:
    """Elastic energy [J] of contact elements (c,), a `law_table`, at penetrations ``d`` (..., c) [m]."""
    k, n = law["stiffness"], law["exponent"]
    return k * np.maximum(d, 0.0) ** (n + 1) / (n + 1)


@called_often
def reduced_mass(mass_1: Any, mass_2: Any) -> Any:
    """Reduced mass ``m1 m2/(m1 + m2)`` [kg]; an infinite mass is a rigid wall. Scalars or arrays."""
    return 1.0 / (1.0 / mass_1 + 1.0 / mass_2)


@called_often
def velocities_after_impact(
    velocity_1: Any, velocity_2: Any, mass_1: Any, mass_2: Any, restitution: Any
) -> tuple[Any, Any]:
    """Eq. (13): velocities of both structures after a stereomechanical impact. Scalars or arrays."""
    jump = (1.0 + restitution) * (velocity_1 - velocity_2)
    return velocity_1 - jump / (1.0 + mass_1 / mass_2), velocity_2 + jump / (1.0 + mass_2 / mass_1)


@called_often
def impact_loss(mass_1: Any, mass_2: Any, restitution: Any) -> Any:
    """Energy lost in a stereomechanical impact, over ``(u1' - u2')^2`` [kg]. Scalars or arrays."""
    return 0.5 * (1.0 - restitution) * (1.0 + restitution) * reduced_mass(mass_1, mass_2)
