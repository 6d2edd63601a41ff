"""Contact elements with a force law, linear and of Hertz, and the stereomechanical impact."""

from __future__ import annotations

import inspect
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
import xarray as xr

from stochlin.kernels.simulation.contacts import ForceLaw
from stochlin.models.contacts.restitution import (
    HERTZ_DAMP,
    IMPACT_KELVIN,
    JANKOWSKI,
    KELVIN,
    NO_TENSION_KELVIN,
    Form,
    Relation,
)
from stochlin.models.parameters import (
    NOT_NEGATIVE,
    POSITIVE,
    Model,
    Parameter,
    Range,
    check,
    parameter,
)
from stochlin.models.plausible import ANY, PLAUSIBLE, Plausible
from stochlin.registry import Registry, expect_class

DAMPING = NOT_NEGATIVE
RESTITUTION = Range(
    upper=1.0,
    include_upper=True,
    reason="the share of the approach velocity that remains; for 0 use Stereomechanical",
)
CONTACT_EXPONENT = Range(lower=1.0, include_lower=True, reason="1.5 for spheres")
SPHERES = 1.5
IMPACT_RESTITUTION = Range(
    upper=1.0,
    include_lower=True,
    include_upper=True,
    reason="0 is a plastic impact, 1 an elastic one",
)
CONTACTS: Registry[type[Contact]] = Registry(
    "contact", "stochlin.models.contacts", check=lambda kind: expect_class(kind, Contact, "e")
)


@dataclass(frozen=True)
class Contact(Model, base=True):
    """Base of the contacts: elements with a contact force, and impacts in which velocities jump."""

    @property
    def e(self) -> Any:
        """Coefficient of restitution [-] of two free masses."""
        raise NotImplementedError


@dataclass(frozen=True)
class Element(Contact, base=True):
    """A contact with a force law: a spring, and in most elements a dashpot.

    The penetration is ``d = u1 - u2 - gap`` [m], its rate ``v = d'`` [m/s]. A contact force acts
    only while ``d > 0``.
    """

    other_limits: ClassVar[Mapping[str, Plausible]] = {"stiffness": PLAUSIBLE["contact stiffness"]}
    law: ClassVar[ForceLaw] = ForceLaw()  # the fields that do not depend on the parameters
    stiffness: Parameter = parameter("N/m", "stiffness of the contact", POSITIVE)

    @property
    def e(self) -> Any:
        """Coefficient of restitution [-] of two free masses; 1 without a dashpot."""
        return 1.0

    def damping_coefficient(self, reduced_mass: Any) -> Any:
        """Damping of the force law for a reduced mass [kg]; 0 for an element without a dashpot."""
        return 0.0

    def force_law(self, reduced_mass: Any) -> ForceLaw:
        """The force law for a reduced mass [kg]; its fields are numbers if the parameters are."""
        exponent = getattr(self, "exponent", self.law.exponent)
        damping = self.damping_coefficient(reduced_mass)
        return self.law._replace(stiffness=self.stiffness, exponent=exponent, damping=damping)


@dataclass(frozen=True)
class Damped(Element, base=True):
    """A contact element with a dashpot.

    Each subclass has its own relation between damping and coefficient of restitution.
    """

    other_limits: ClassVar[Mapping[str, Plausible]] = {**Element.other_limits, "damping": ANY}
    damping: Parameter = parameter("1", "damping of the contact", DAMPING)

    damping_name: ClassVar[str]  # name of the argument that gives the damping
    relation: ClassVar[Relation]

    @property
    def e(self) -> Any:
        """Coefficient of restitution [-] of two free masses."""
        return self.restitution(self.damping)

    @classmethod
    def restitution(cls, damping: Any) -> Any:
        """Coefficient of restitution ``e`` [-] of this element between two free masses.

        ``damping`` is its damping ratio or damping factor [-], not negative, a number or an array
        as a parameter is. The result has the same dimensions and is NaN in cells out of range. A
        number out of range raises a ValueError, what is no number a TypeError.
        """
        return cls._related(cls.damping_name, damping, DAMPING, cls.relation.restitution)

    def constructor_arguments(self) -> dict[str, Any]:
        """As of every model, with the damping by its name in the constructor."""
        values = super().constructor_arguments()
        name = getattr(self, "damping_name", "damping")
        if name in inspect.signature(type(self)).parameters:
            values[name] = values.pop("damping")
        return values

    @classmethod
    def _damping_for(cls, restitution: Any) -> Any:
        return cls._related("restitution", restitution, RESTITUTION, cls.relation.damping)

    @classmethod
    def _related(cls, name: str, value: Any, allowed: Range, form: Form) -> float | xr.DataArray:
        """``form`` of a number, or of the cells of an array that are in the allowed range."""
        checked = checked_value(cls.__name__, name, value, "1", allowed)
        if not isinstance(checked, xr.DataArray):
            return float(form(np.array(checked)))
        inside = checked.where(allowed.contains(checked)).drop_attrs(deep=False)
        return inside.copy(data=form(inside.values)).rename(None).assign_attrs(units="1")

    def _set(self, stiffness: Any, damping: Any, restitution: Any, **others: Any) -> None:
        """Set the fields, with the damping that follows from ``damping`` or ``restitution``."""
        name = type(self).__name__
        if (damping is None) == (restitution is None):
            text = "neither is given" if damping is None else "both are given"
            what = f"{name}: of {self.damping_name} and restitution {text}"
            raise ValueError(f"{what}; allowed: exactly one of them")
        if damping is None:
            damping = self._damping_for(restitution)
        damping = checked_value(name, self.damping_name, damping, "1", DAMPING)
        for field, value in {"stiffness": stiffness, "damping": damping, **others}.items():
            object.__setattr__(self, field, value)
        self.__post_init__()


@dataclass(frozen=True, init=False)
class WithRatio(Damped, base=True):
    """An element with the damping ratio ``xi = c/(2 sqrt(k m))``, ``m`` being the reduced mass."""

    damping: Parameter = parameter("1", "damping ratio of the contact", DAMPING)
    damping_name: ClassVar[str] = "damping_ratio"

    def __init__(
        self,
        stiffness: Parameter,
        *,
        damping_ratio: Parameter | None = None,
        restitution: Parameter | None = None,
    ) -> None:
        self._set(stiffness, damping_ratio, restitution)

    def doubts(self) -> Iterator[str]:
        """Text on a damping ratio that no contact has."""
        ratio = self.damping if isinstance(self.damping, float) else 0.0
        if text := PLAUSIBLE["damping of a contact"].doubt(ratio):
            yield f"{self.damping_name} = {ratio:g}: {text}"

    @classmethod
    def damping_ratio(cls, restitution: Any) -> Any:
        """Damping ratio ``xi`` [-] of this element for a coefficient of restitution, exactly.

        ``restitution`` is ``e`` [-], in (0, 1]. Dimensions, NaN cells and errors are as in
        `restitution`.
        """
        return cls._damping_for(restitution)

    def damping_coefficient(self, reduced_mass: Any) -> Any:
        """Constant ``c = 2 xi sqrt(k m)`` for a reduced mass [kg]; [N s/m] of a linear element."""
        k: Any = self.stiffness
        xi: Any = self.damping
        with np.errstate(invalid="ignore"):  # NaN in cells out of range
            return 2 * xi * np.sqrt(k * reduced_mass)


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

    The coefficient of restitution is ``e = exp(-pi xi/sqrt(1 - xi^2))``. It is the inverse of eq.
    (15), which holds for this element only. The contact time is ``pi/sqrt(1 - xi^2) sqrt(m/k)``.
    For ``xi >= 1`` the contact never ends: ``e`` is 0 and the contact time is infinite.

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
        If a scalar is out of range, a value is not a number, or both or neither of
        ``damping_ratio`` and ``restitution`` are given.

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

    relation: ClassVar[Relation] = KELVIN


@CONTACTS.register("no_tension_kelvin", 3)
@dataclass(frozen=True, init=False)
class NoTensionKelvin(WithRatio):
    """Kelvin element without tension: ``f = max(k d + c d', 0)`` while ``d > 0``.

    The coefficient of restitution is ``e = exp(-2 xi A)`` and the contact time ``2 A sqrt(m/k)``,
    where ``A = acos(xi)/sqrt(1 - xi^2)``, or ``acosh(xi)/sqrt(xi^2 - 1)`` for ``xi > 1``. The
    structures separate while the element is still compressed.

    Once it has let go, the element is taken to have its full length again at once. If it is
    approached again while ``d > 0`` still, it pushes again, with the same formula of the
    penetration and velocity then, as soon as this is positive, and not only after the faces have
    parted to ``d = 0``. Both pushes are one impact.

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
    relation: ClassVar[Relation] = NO_TENSION_KELVIN


@CONTACTS.register("impact_kelvin", 4)
@dataclass(frozen=True, init=False)
class ImpactKelvin(WithRatio):
    """Impact Kelvin element, eq. (16), with a dashpot in approach only: ``f = k d + c max(d', 0)``.

    The coefficient of restitution is ``e = exp(-xi A)`` and the contact time ``(A + pi/2)
    sqrt(m/k)``, where ``A = acos(xi)/sqrt(1 - xi^2)``, or ``acosh(xi)/sqrt(xi^2 - 1)`` for ``xi >
    1``. As in `Kelvin`, the dashpot dissipates energy, which it would not with its sign in the
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
    >>> round(sl.ImpactKelvin.restitution(0.5), 4)
    0.5463
    >>> round(sl.ImpactKelvin(stiffness=1e8, restitution=0.65).damping, 4)
    0.3293
    """

    law: ClassVar[ForceLaw] = ForceLaw(approach_only=True)
    relation: ClassVar[Relation] = IMPACT_KELVIN


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

    other_limits: ClassVar[Mapping[str, Plausible]] = {}
    stiffness: Parameter = parameter("N/m^n", "stiffness of the contact", POSITIVE)
    exponent: Parameter = parameter("1", "exponent of the contact", CONTACT_EXPONENT, SPHERES)


@CONTACTS.register("hertz_damp", 6)
@dataclass(frozen=True, init=False)
class HertzDamp(Damped):
    """Hertz contact with hysteresis damping, ``f = k d^n (1 + a d'/v0)``, approach velocity ``v0``.

    The coefficient of restitution ``e`` is the exact solution of ``a (1 + e) = ln[(1 + a)/(1 - a
    e)]`` for any exponent. The force on two free masses is never tensile. It would be tensile if
    the masses were driven apart faster than ``v0/a``.

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
    other_limits: ClassVar[Mapping[str, Plausible]] = {"damping": ANY}
    stiffness: Parameter = parameter("N/m^n", "stiffness of the contact", POSITIVE)
    damping: Parameter = parameter("1", "damping factor of the contact", DAMPING)
    exponent: Parameter = parameter("1", "exponent of the contact", CONTACT_EXPONENT, SPHERES)

    damping_name: ClassVar[str] = "damping_factor"
    relation: ClassVar[Relation] = HERTZ_DAMP

    def __init__(
        self,
        stiffness: Parameter,
        *,
        damping_factor: Parameter | None = None,
        restitution: Parameter | None = None,
        exponent: Parameter = SPHERES,
    ) -> None:
        self._set(stiffness, damping_factor, restitution, exponent=exponent)

    @classmethod
    def damping_factor(cls, restitution: Any) -> Any:
        """Damping factor [-] for a coefficient of restitution, else as `Kelvin.damping_ratio`."""
        return cls._damping_for(restitution)

    def damping_coefficient(self, reduced_mass: Any) -> Any:
        """The damping factor ``a`` [-], which does not depend on the mass."""
        return self.damping


@CONTACTS.register("jankowski", 7)
@dataclass(frozen=True, init=False)
class Jankowski(WithRatio):
    """Hertz contact damped in approach only: ``f = k d^1.5 + 2 xi sqrt(k sqrt(d) m) max(d', 0)``.

    With ``y = sqrt(4/5) sqrt(k/m) d^1.25`` the equation of motion ``v dv = -f dd/m`` becomes that
    of a linear element, ``v dv = -(y + 2 z max(v, 0)) dy`` with ``z = 2 xi/sqrt(5)``. The
    coefficient of restitution is therefore exactly that of an `ImpactKelvin` with the damping ratio
    ``z``.

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
    other_limits: ClassVar[Mapping[str, Plausible]] = {"damping": ANY}
    stiffness: Parameter = parameter("N/m^1.5", "stiffness of the contact", POSITIVE)
    relation: ClassVar[Relation] = JANKOWSKI


@CONTACTS.register("stereomechanical", 8)
@dataclass(frozen=True)
class Stereomechanical(Contact):
    """Stereomechanical impact, eq. (13), multiplies ``u1' - u2'`` by ``-e`` and conserves momentum.

    Parameters
    ----------
    restitution : float or array
        Coefficient of restitution ``e`` [-], in [0, 1].

    Raises
    ------
    ValueError, TypeError
        If a scalar is out of range, or a value is not a number.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), eq. (13).

    Examples
    --------
    >>> import stochlin as sl
    >>> sl.Stereomechanical(restitution=0.5).e
    0.5
    """

    restitution: Parameter = parameter("1", "coefficient of restitution", IMPACT_RESTITUTION)

    @property
    def e(self) -> Any:
        """Coefficient of restitution [-]."""
        return self.restitution


def checked_value(
    model: str, name: str, value: Any, units: str, allowed: Range
) -> float | xr.DataArray:
    """The value of an argument, checked and labelled like a declared parameter of a model."""
    declared = {"units": units, "long_name": name.replace("_", " "), "allowed": allowed}
    return check(f"{model}: ", name, value, declared)
