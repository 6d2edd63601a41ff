"""What contacts share: how they are found, asked for their restitution, and handed to a kernel."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
import xarray as xr

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.pounding.contact import ForceLaw, forces
from stochlin.messages import brief
from stochlin.models.parameters import NOT_NEGATIVE, POSITIVE, Model, Parameter, Range, check, parameter
from stochlin.registry import Registry

ANY = Range(lower=-np.inf)
DAMPING = NOT_NEGATIVE
RESTITUTION = Range(
    upper=1.0,
    include_upper=True,
    reason="the share of the approach velocity that remains; for 0 use Stereomechanical",
)

Form = Callable[[Array], Array]

CONTACTS: Registry[type[Contact]] = Registry("contact", "stochlin.models.contacts")


@dataclass(frozen=True)
class Contact(Model):
    """Base of the contacts: elements with a force, or impacts in which velocities jump."""

    @property
    def e(self) -> Any:
        """Coefficient of restitution [-] of two free masses."""
        raise NotImplementedError


@dataclass(frozen=True)
class Element(Contact):
    """A contact with a force law: a spring, as a rule with a dashpot.

    With ``d = u1 - u2 - gap`` the penetration and ``v = d'``, there is a force while ``d > 0``.
    """

    law: ClassVar[ForceLaw] = ForceLaw()  # the parts of it that do not hang on the parameters
    stiffness: Parameter = parameter("N/m", "stiffness of the contact", POSITIVE)

    def __post_init__(self) -> None:
        super().__post_init__()
        law = self.law
        if not (law.tension or law.approach_only) and (
            law.over_approach or np.any(law.damping_exponent != self.power - 1)
        ):
            raise ValueError(
                f"{type(self).__name__}: law = {law} has no tension; allowed with that: a "
                "damping_exponent of the exponent less 1, not over_approach, for the end of contact is "
                "known for these"
            )

    @property
    def power(self) -> Any:
        """Exponent of the penetration in the elastic force [-]."""
        return getattr(self, "exponent", self.law.exponent)

    def damping_coefficient(self, reduced_mass: Any) -> Any:
        """The damping of the force law, for a reduced mass [kg]; none here."""
        return 0.0

    def force_law(self, reduced_mass: Any) -> ForceLaw:
        """The law of the force, for a reduced mass [kg].

        Its fields are numbers where the contact and the mass are, else arrays that broadcast by
        dimension name.
        """
        mass = checked(type(self).__name__, "reduced_mass", reduced_mass, "kg", POSITIVE)
        return self.law._replace(
            stiffness=self.stiffness, exponent=self.power, damping=self.damping_coefficient(mass)
        )

    def force(
        self, penetration: Any, velocity: Any, approach_velocity: Any, reduced_mass: Any
    ) -> xr.DataArray:
        """Force of the contact [N], positive where it pushes the structures apart.

        ``penetration`` is ``d = u1 - u2 - gap`` [m], without contact not positive: there is no force;
        ``velocity`` is ``d'`` [m/s], positive in approach, and ``approach_velocity`` its value at the
        beginning of this contact, positive, for which only `HertzDamp` asks; ``reduced_mass`` is ``m1
        m2/(m1 + m2)`` [kg]. NaN in cells that are out of range; a scalar that is out of range raises.

        Examples
        --------
        >>> import stochlin as sl
        >>> float(sl.LinearSpring(stiffness=2e6).force(0.01, 0.3, 0.5, reduced_mass=1e5))
        20000.0
        """
        name = type(self).__name__
        mass = checked(name, "reduced_mass", reduced_mass, "kg", POSITIVE)
        d = checked(name, "penetration", penetration, "m", ANY)
        v = checked(name, "velocity", velocity, "m/s", ANY)
        v0 = checked(name, "approach_velocity", approach_velocity, "m/s", POSITIVE)
        given = [xr.DataArray(value) for value in (*self.force_law(mass), d, v, v0)]
        with np.errstate(invalid="ignore"):  # cells out of range are blanked below
            result: xr.DataArray = xr.apply_ufunc(forces, *given, join="exact", keep_attrs=False)
        result = result.where(self.valid() & POSITIVE.contains(mass) & POSITIVE.contains(v0))
        return result.rename("contact_force").assign_attrs(units="N", long_name="contact force")

    def time_scale(self, reduced_mass: Any, approach_velocity: Any) -> Any:
        """The time that contact times are multiples of [s].

        ``(m v0^(1-n)/k)^(1/(n+1))``, which is ``sqrt(m/k)`` for the linear elements whatever the
        velocity. The scale of penetration is ``v0`` times this. Arguments as in `force`.
        """
        name = type(self).__name__
        mass = checked(name, "reduced_mass", reduced_mass, "kg", POSITIVE)
        v0 = checked(name, "approach_velocity", approach_velocity, "m/s", POSITIVE)
        n = self.power
        with np.errstate(invalid="ignore"):  # NaN in cells out of range
            return (mass * v0 ** (1 - n) / self.stiffness) ** (1 / (n + 1))


@dataclass(frozen=True)
class Undamped(Element):
    """A spring alone."""

    @property
    def e(self) -> float:
        """Coefficient of restitution [-]: 1."""
        return self.restitution()

    @staticmethod
    def restitution() -> float:
        """Coefficient of restitution [-]: 1."""
        return 1.0


def checked(model: str, name: str, value: Any, units: str, allowed: Range) -> float | xr.DataArray:
    """The value of an argument, checked and labelled as a declared parameter of a model would be."""
    declared = {"units": units, "long_name": name.replace("_", " "), "allowed": allowed}
    return check(f"{model}: ", name, value, declared)


def elementwise(model: str, name: str, value: Any, allowed: Range, form: Form) -> Any:
    """``form`` of numbers in the range; a scalar out of range raises, such cells of an array are NaN.

    Gives back what it is given: a float, an array of the same shape, or a DataArray.
    """
    array = np.asarray(value)
    if array.dtype.kind not in "iuf":
        raise TypeError(f"{model}: {name} = {brief(value)} is not a real number; allowed: {allowed}")
    inside = allowed.contains(array)
    if array.ndim == 0 and not inside:
        raise ValueError(f"{model}: {name} = {float(array):g} is out of range; allowed: {allowed}")
    result = form(np.where(inside, array, np.nan).astype(float))
    if isinstance(value, xr.DataArray):
        return value.copy(data=result).rename(None).drop_attrs(deep=False).assign_attrs(units="1")
    return float(result) if array.ndim == 0 else result
