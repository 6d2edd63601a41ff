"""Contact elements with the elastic force of Hertz, ``k d^n``: one undamped and two damped ones."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from stochlin.kernels.simulation.contacts import ForceLaw
from stochlin.models.contacts import restitution
from stochlin.models.contacts.base import CONTACTS, DAMPING, Element
from stochlin.models.contacts.damped import Damped, WithRatio
from stochlin.models.contacts.restitution import Relation
from stochlin.models.parameters import POSITIVE, Parameter, Range, parameter

EXPONENT = Range(lower=1.0, include_lower=True, reason="1.5 for spheres")
SPHERES = 1.5


@CONTACTS.register("hertz", 5)
@dataclass(frozen=True)
class Hertz(Element):
    """Hertz contact without damping, ``f = k d^n``; its coefficient of restitution is 1.

    Parameters
    ----------
    stiffness : float or array
        Stiffness ``k`` [N/m^n], positive.
    exponent : float or array
        Exponent ``n`` [-], at least 1; 1.5 for spheres.

    Raises
    ------
    ValueError, TypeError
        If a scalar is out of range, or a value is not a number.

    References
    ----------
    Soong, T. T. (1983), Shock and Vibration Bulletin 53.

    Examples
    --------
    >>> import stochlin as sl
    >>> pair = sl.Hertz(stiffness=2e9)
    >>> pair.e
    1.0
    """

    stiffness: Parameter = parameter("N/m^n", "stiffness of the contact", POSITIVE)
    exponent: Parameter = parameter("1", "exponent of the contact", EXPONENT, SPHERES)


@CONTACTS.register("hertz_damp", 6)
@dataclass(frozen=True, init=False)
class HertzDamp(Damped):
    """Hertz contact with hysteresis damping, ``f = k d^n (1 + a d'/v0)``, ``v0`` the approach velocity.

    The coefficient of restitution ``e`` is the exact solution of ``a (1 + e) = ln[(1 + a)/(1 - a e)]``
    for any exponent. The force on two free masses is never tensile. It would be tensile if the masses
    were driven apart faster than ``v0/a``.

    Parameters
    ----------
    stiffness : float or array
        Stiffness ``k`` [N/m^n], positive.
    damping_factor : float or array, optional
        Damping factor ``a`` [-], not negative; given, or ``restitution`` is.
    restitution : float or array, optional
        Coefficient of restitution ``e`` [-], in (0, 1]; given, or ``damping_factor`` is.
    exponent : float or array
        Exponent ``n`` [-], at least 1; 1.5 for spheres.

    Raises
    ------
    ValueError, TypeError
        As in `Kelvin`.

    References
    ----------
    Muthukumar, S. and DesRoches, R. (2006), Earthquake Eng. Struct. Dyn. 35.

    Examples
    --------
    >>> import stochlin as sl
    >>> round(sl.HertzDamp(stiffness=2e9, restitution=0.5).damping, 4)
    1.4328
    """

    law: ClassVar[ForceLaw] = ForceLaw(over_approach=True)
    stiffness: Parameter = parameter("N/m^n", "stiffness of the contact", POSITIVE)
    damping: Parameter = parameter("1", "damping factor of the contact", DAMPING)
    exponent: Parameter = parameter("1", "exponent of the contact", EXPONENT, SPHERES)

    damping_name: ClassVar[str] = "damping_factor"
    relation: ClassVar[Relation] = restitution.HERTZ_DAMP

    def __init__(
        self,
        stiffness: Parameter,
        *,
        damping_factor: Parameter | None = None,
        restitution: Parameter | None = None,
        exponent: Parameter = SPHERES,
    ) -> None:
        object.__setattr__(self, "stiffness", stiffness)
        object.__setattr__(self, "damping", self._settle(damping_factor, restitution))
        object.__setattr__(self, "exponent", exponent)
        self.__post_init__()

    @classmethod
    def damping_factor(cls, restitution: Any) -> Any:
        """Damping factor [-] for a coefficient of restitution; otherwise as `Kelvin.damping_ratio`."""
        return cls._damping_for(restitution)

    def damping_coefficient(self, reduced_mass: Any) -> Any:
        """The damping factor ``a`` [-], which does not depend on the mass."""
        return self.damping


@CONTACTS.register("jankowski", 7)
@dataclass(frozen=True, init=False)
class Jankowski(WithRatio):
    """Hertz contact damped in approach only: ``f = k d^1.5 + 2 xi sqrt(k sqrt(d) m) max(d', 0)``.

    With ``y = sqrt(4/5) sqrt(k/m) d^1.25`` the equation of motion ``v dv = -f dd/m`` becomes that of a
    linear element, ``v dv = -(y + 2 z max(v, 0)) dy`` with ``z = 2 xi/sqrt(5)``. The coefficient of
    restitution is therefore exactly that of an `ImpactKelvin` with the damping ratio ``z``.

    Parameters
    ----------
    stiffness : float or array
        Stiffness ``k`` [N/m^1.5], positive.
    damping_ratio, restitution : float or array
        As in `Kelvin`, with another relation between the two.

    Raises
    ------
    ValueError, TypeError
        As in `Kelvin`.

    References
    ----------
    Jankowski, R. (2005), Earthquake Eng. Struct. Dyn. 34.

    Examples
    --------
    >>> import stochlin as sl
    >>> round(sl.Jankowski(stiffness=2e9, restitution=0.5).damping, 4)
    0.6678
    """

    law: ClassVar[ForceLaw] = ForceLaw(exponent=SPHERES, damping_exponent=0.25, approach_only=True)
    stiffness: Parameter = parameter("N/m^1.5", "stiffness of the contact", POSITIVE)
    relation: ClassVar[Relation] = restitution.JANKOWSKI
