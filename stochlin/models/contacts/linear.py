"""Linear contacts: the spring, and the three Kelvin elements that differ in when their dashpot acts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from stochlin.kernels.pounding.contact import ForceLaw
from stochlin.models.contacts import restitution as closed_forms
from stochlin.models.contacts.base import CONTACTS, DAMPING, Form, Undamped, elementwise
from stochlin.models.contacts.damped import EXACT, WithRatio
from stochlin.models.contacts.restitution import angle_ratio, invert_angle_ratio


@CONTACTS.register("linear_spring", 1)
@dataclass(frozen=True)
class LinearSpring(Undamped):
    """Spring without damping, ``f = k d``: ``e = 1``.

    Parameters
    ----------
    stiffness : float or array
        ``k`` [N/m], positive.

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

    @staticmethod
    def contact_time() -> float:
        """Contact time over `time_scale` [-]: ``pi``, half a period."""
        return float(np.pi)


@dataclass(frozen=True, init=False)
class LinearDamped(WithRatio):
    """A damped element with a linear law: its contact time is known."""

    time_of: ClassVar[Form]

    @classmethod
    def contact_time(cls, damping_ratio: Any) -> Any:
        """Contact time of two free masses times ``w = sqrt(k/m)`` [-]; otherwise as `restitution`."""
        return elementwise(cls.__name__, cls.damping_name, damping_ratio, DAMPING, cls.time_of)


@CONTACTS.register("kelvin", 2)
@dataclass(frozen=True, init=False)
class Kelvin(LinearDamped):
    """Kelvin element that may pull, eq. (14): ``f = k d + c d'`` while ``d > 0``.

    The sign of the dashpot is the right one; the paper's feeds energy in. Before the end of a
    contact the force is negative: the element holds the structures back. `NoTensionKelvin` does
    not.

    ``e = exp(-pi xi/sqrt(1 - xi^2))``, which is eq. (15) and holds for this element only; the
    contact takes ``pi/sqrt(1 - xi^2)`` over ``sqrt(k/m)``. From ``xi = 1`` on it never ends: ``e`` is
    0 and the time infinite.

    Parameters
    ----------
    stiffness : float or array
        ``k`` [N/m], positive.
    damping_ratio : float or array, optional
        ``xi = c/(2 sqrt(k m))`` [-], not negative; ``m`` is the reduced mass ``m1 m2/(m1 + m2)``.
    restitution : float or array, optional
        ``e`` [-] that the contact is to deliver, in (0, 1]; this or ``damping_ratio``.

    Raises
    ------
    ValueError, TypeError
        If a scalar is out of range, a value is not a number, or of ``damping_ratio`` and
        ``restitution`` both or neither are given.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), eqs. (14) and (15); Anagnostopoulos, S. A. and Spiliopoulos,
    K. V. (1992), Earthquake Eng. Struct. Dyn. 21.

    Examples
    --------
    >>> import stochlin as sl
    >>> sl.Kelvin(stiffness=1e8, restitution=0.65).describe()
    'Kelvin(stiffness=1e+08, damping=0.135851)'
    >>> round(sl.Kelvin.restitution(0.5), 4), round(sl.Kelvin.damping_ratio(0.65), 4)
    (0.163, 0.1359)
    """

    restitution_of: ClassVar[Form] = staticmethod(closed_forms.kelvin_restitution)
    damping_for: ClassVar[Mapping[str, Form]] = {EXACT: closed_forms.kelvin_damping}
    time_of: ClassVar[Form] = staticmethod(closed_forms.kelvin_time)


@CONTACTS.register("no_tension_kelvin", 3)
@dataclass(frozen=True, init=False)
class NoTensionKelvin(LinearDamped):
    """Kelvin element that cannot pull: ``f = max(k d + c d', 0)`` while ``d > 0``.

    ``e = exp(-2 xi A)`` and a contact of ``2 A`` over ``sqrt(k/m)``, with ``A = acos(xi)/sqrt(1 -
    xi^2)``, beyond 1 ``acosh(xi)/sqrt(xi^2 - 1)``. The structures part while the element is still
    compressed; it is taken to be back at its full length when they meet again.

    Parameters
    ----------
    stiffness, damping_ratio, restitution : float or array
        As in `Kelvin`; the relation between the last two is another.

    Raises
    ------
    ValueError, TypeError
        As in `Kelvin`.

    References
    ----------
    Derived here: free vibration of two masses until the force vanishes.

    Examples
    --------
    >>> import stochlin as sl
    >>> round(sl.NoTensionKelvin.restitution(0.5), 4)
    0.2984
    >>> round(sl.NoTensionKelvin(stiffness=1e8, restitution=0.65).damping, 4)
    0.1499
    """

    law: ClassVar[ForceLaw] = ForceLaw(tension=False)
    restitution_of: ClassVar[Form] = staticmethod(lambda xi: np.exp(-2 * xi * angle_ratio(xi)))
    damping_for: ClassVar[Mapping[str, Form]] = {
        EXACT: lambda e: invert_angle_ratio(0.5 * np.abs(np.log(e)))
    }
    time_of: ClassVar[Form] = staticmethod(lambda xi: 2 * angle_ratio(xi))


@CONTACTS.register("impact_kelvin", 4)
@dataclass(frozen=True, init=False)
class ImpactKelvin(LinearDamped):
    """Impact Kelvin element, eq. (16): its dashpot acts in approach only, ``f = k d + c max(d', 0)``.

    ``e = exp(-xi A)`` and a contact of ``A + pi/2`` over ``sqrt(k/m)``, with ``A = acos(xi)/sqrt(1 -
    xi^2)``, beyond 1 ``acosh(xi)/sqrt(xi^2 - 1)``. The sign of the dashpot is the right one, as in
    `Kelvin`.

    Parameters
    ----------
    stiffness, damping_ratio, restitution : float or array
        As in `Kelvin`; the relation between the last two is another.

    Raises
    ------
    ValueError, TypeError
        As in `Kelvin`.

    Notes
    -----
    `damping_ratio` also knows the approximation ``"mahmoud_jankowski_2011"``, ``(1 - e^2)/(e (e (pi - 2)
    + 2))``: with it an element asked for 0.5 delivers 0.5061.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), eq. (16) and Fig. 8; Mahmoud, S. and Jankowski, R. (2011),
    modified linear viscoelastic model of pounding.

    Examples
    --------
    >>> import stochlin as sl
    >>> round(sl.ImpactKelvin.restitution(0.5), 4), round(sl.ImpactKelvin.damping_ratio(0.65), 4)
    (0.5463, 0.3293)
    >>> round(sl.ImpactKelvin.delivered_restitution(0.5, "mahmoud_jankowski_2011"), 4)
    0.5061
    """

    law: ClassVar[ForceLaw] = ForceLaw(approach_only=True)
    restitution_of: ClassVar[Form] = staticmethod(lambda xi: np.exp(-xi * angle_ratio(xi)))
    damping_for: ClassVar[Mapping[str, Form]] = {
        EXACT: lambda e: invert_angle_ratio(np.abs(np.log(e))),
        "mahmoud_jankowski_2011": lambda e: (1 - e * e) / (e * (e * (np.pi - 2) + 2)),
    }
    time_of: ClassVar[Form] = staticmethod(lambda xi: angle_ratio(xi) + np.pi / 2)
