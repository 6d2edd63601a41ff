"""Force of a contact element, its end of contact, and the jump of a stereomechanical impact; compiled.

``d = u1 - u2 - gap`` is the penetration [m], positive in contact, ``v = d'`` [m/s], and ``v0`` the
approach velocity, ``v`` at the beginning of this contact. ``parameters`` are three numbers whatever
the law: stiffness ``k`` [N/m^n], exponent ``n``, and a damping ``c`` whose meaning is the law's. The
force pushes structure 1 back and structure 2 forward; negative, it pulls.
"""

from __future__ import annotations

from typing import Any

import numba as nb
from numba.extending import register_jitable

KELVIN, NO_TENSION, IMPACT_KELVIN, SPRING, HERTZ_DAMP, JANKOWSKI = range(6)


@nb.njit(nogil=True, cache=True, error_model="numpy")
def force(kind, parameters, d, v, v0):  # type: ignore[no-untyped-def]
    """Force [N] of one element; zero where there is no contact, ``d <= 0``.

    ======================  ====================================  =======================
    kind                    force                                 c
    ======================  ====================================  =======================
    KELVIN                  ``k d + c v``                         N s/m
    NO_TENSION              ``max(k d + c v, 0)``                 N s/m
    IMPACT_KELVIN           ``k d + c max(v, 0)``                 N s/m
    SPRING                  ``k d^n``                             0
    HERTZ_DAMP              ``k d^n (1 + c v/v0)``                1
    JANKOWSKI               ``k d^n + c d^((n-1)/2) max(v, 0)``   N s/m^((n+1)/2)
    ======================  ====================================  =======================
    """
    k, n, c = parameters
    if d <= 0.0:
        return 0.0
    elastic = k * d if n == 1.0 else k * d**n
    if kind == HERTZ_DAMP:  # a contact that did not begin with an approach has no v0
        return elastic * (1.0 + c * v / v0) if v0 > 0.0 else elastic
    if kind == JANKOWSKI:
        c *= d ** (0.5 * (n - 1.0))
    if kind in (IMPACT_KELVIN, JANKOWSKI):
        v = max(v, 0.0)
    total = elastic + c * v
    return max(total, 0.0) if kind == NO_TENSION else total


@nb.vectorize(cache=True)  # type: ignore[no-untyped-call]
def forces(kind, k, n, c, d, v, v0):  # type: ignore[no-untyped-def]
    """`force` over arrays that broadcast."""
    return force(kind, (k, n, c), d, v, v0)


@nb.njit(nogil=True, cache=True, error_model="numpy")
def separation_margin(kind, parameters, d, v):  # type: ignore[no-untyped-def]
    """What reaches zero, falling, when the contact ends [m].

    The penetration; for NO_TENSION the force over the stiffness, which is there before: the faces
    part while the element is still compressed.
    """
    k, _, c = parameters
    return d + c * v / k if kind == NO_TENSION else d


@register_jitable
def reduced_mass(mass_1: Any, mass_2: Any) -> Any:
    """``m1 m2/(m1 + m2)`` [kg]; an infinite mass is a rigid wall. Scalars or arrays."""
    return 1.0 / (1.0 / mass_1 + 1.0 / mass_2)


@register_jitable
def velocities_after_impact(
    velocity_1: Any, velocity_2: Any, mass_1: Any, mass_2: Any, restitution: Any
) -> tuple[Any, Any]:
    """Eq. (13): velocities of both structures after a stereomechanical impact. Scalars or arrays."""
    jump = (1.0 + restitution) * (velocity_1 - velocity_2)
    return velocity_1 - jump / (1.0 + mass_1 / mass_2), velocity_2 + jump / (1.0 + mass_2 / mass_1)
