"""Linear contact elements: the spring, and three Kelvin elements with different unloading."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from stochlin.kernels.simulation.contacts import ForceLaw
from stochlin.models.contacts import restitution
from stochlin.models.contacts.base import CONTACTS, Element
from stochlin.models.contacts.damped import WithRatio
from stochlin.models.contacts.restitution import Relation


@CONTACTS.register("linear_spring", 1)
@dataclass(frozen=True)
class LinearSpring(Element):
    """Linear spring without damping, ``f = k d``; its coefficient of restitution is 1.

    Parameters
    ----------
    stiffness : float or array
        Stiffness ``k`` [N/m], positive.

    Raises
    ------
    ValueError, TypeError
        If a scalar is out of range, or a value is not a number.

    References
    ----------
    Maison, B. F. and Kasai, K. (1990), J. Struct. Eng. ASCE 116.

    Examples
    --------
    >>> import stochlin as sl
    >>> sl.LinearSpring(stiffness=1e8).e
    1.0
    """


@CONTACTS.register("kelvin", 2)
@dataclass(frozen=True, init=False)
class Kelvin(WithRatio):
    """Kelvin element with tension, eq. (14): ``f = k d + c d'`` while ``d > 0``.

    The dashpot dissipates energy; with its sign in the available text of the paper it would supply
    energy. Near the end of a contact the force is tensile and holds the structures together.
    `NoTensionKelvin` has no tension.

    The coefficient of restitution is ``e = exp(-pi xi/sqrt(1 - xi^2))``. It is the inverse of eq. (15),
    which holds for this element only. The contact time is ``pi/sqrt(1 - xi^2) sqrt(m/k)``. For
    ``xi >= 1`` the contact never ends: ``e`` is 0 and the contact time is infinite.

    Parameters
    ----------
    stiffness : float or array
        Stiffness ``k`` [N/m], positive.
    damping_ratio : float or array, optional
        Damping ratio ``xi = c/(2 sqrt(k m))`` [-], not negative, with the reduced mass
        ``m = m1 m2/(m1 + m2)``; given, or ``restitution`` is.
    restitution : float or array, optional
        Coefficient of restitution ``e`` [-], in (0, 1]; given, or ``damping_ratio`` is.

    Raises
    ------
    ValueError, TypeError
        If a scalar is out of range, a value is not a number, or both or neither of ``damping_ratio``
        and ``restitution`` are given.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), eqs. (14) and (15); Anagnostopoulos, S. A. and Spiliopoulos,
    K. V. (1992), Earthquake Eng. Struct. Dyn. 21.

    Examples
    --------
    >>> import stochlin as sl
    >>> sl.Kelvin(stiffness=1e8, restitution=0.65).describe()
    'Kelvin (stiffness 100 MN/m, damping 0.135851)'
    >>> round(sl.Kelvin.restitution(0.5), 4), round(sl.Kelvin.damping_ratio(0.65), 4)
    (0.163, 0.1359)
    """

    relation: ClassVar[Relation] = restitution.KELVIN


@CONTACTS.register("no_tension_kelvin", 3)
@dataclass(frozen=True, init=False)
class NoTensionKelvin(WithRatio):
    """Kelvin element without tension: ``f = max(k d + c d', 0)`` while ``d > 0``.

    The coefficient of restitution is ``e = exp(-2 xi A)`` and the contact time ``2 A sqrt(m/k)``, where
    ``A = acos(xi)/sqrt(1 - xi^2)``, or ``acosh(xi)/sqrt(xi^2 - 1)`` for ``xi > 1``. The structures
    separate while the element is still compressed.

    Once it has let go, the element is taken to have its full length again at once. If it is approached
    again while ``d > 0`` still, it pushes again, with the same formula of the penetration and velocity
    then, as soon as this is positive, and not only after the faces have parted to ``d = 0``. Both pushes
    are one impact.

    Parameters
    ----------
    stiffness, damping_ratio, restitution : float or array
        As in `Kelvin`, with another relation between the last two.

    Raises
    ------
    ValueError, TypeError
        As in `Kelvin`.

    References
    ----------
    Derived here, as the free vibration of two masses until the force vanishes.

    Examples
    --------
    >>> import stochlin as sl
    >>> round(sl.NoTensionKelvin.restitution(0.5), 4)
    0.2984
    >>> round(sl.NoTensionKelvin(stiffness=1e8, restitution=0.65).damping, 4)
    0.1499
    """

    law: ClassVar[ForceLaw] = ForceLaw(tension=False)
    relation: ClassVar[Relation] = restitution.NO_TENSION_KELVIN


@CONTACTS.register("impact_kelvin", 4)
@dataclass(frozen=True, init=False)
class ImpactKelvin(WithRatio):
    """Impact Kelvin element, eq. (16): its dashpot acts in approach only, ``f = k d + c max(d', 0)``.

    The coefficient of restitution is ``e = exp(-xi A)`` and the contact time
    ``(A + pi/2) sqrt(m/k)``, where ``A = acos(xi)/sqrt(1 - xi^2)``, or ``acosh(xi)/sqrt(xi^2 - 1)`` for
    ``xi > 1``. As in `Kelvin`, the dashpot dissipates energy, which it would not with its sign in the
    available text of the paper.

    Parameters
    ----------
    stiffness, damping_ratio, restitution : float or array
        As in `Kelvin`, with another relation between the last two.

    Raises
    ------
    ValueError, TypeError
        As in `Kelvin`.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), eq. (16) and Fig. 8.

    Examples
    --------
    >>> import stochlin as sl
    >>> round(sl.ImpactKelvin.restitution(0.5), 4), round(sl.ImpactKelvin.damping_ratio(0.65), 4)
    (0.5463, 0.3293)
    """

    law: ClassVar[ForceLaw] = ForceLaw(approach_only=True)
    relation: ClassVar[Relation] = restitution.IMPACT_KELVIN
