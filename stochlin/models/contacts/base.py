"""The base classes of contacts and contact elements, and checks of their arguments."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
import xarray as xr

from stochlin.kernels.simulation.contacts import ForceLaw, forces
from stochlin.models.contacts.restitution import Form
from stochlin.models.parameters import (
    NOT_NEGATIVE,
    POSITIVE,
    Model,
    Parameter,
    Range,
    as_array,
    check,
    parameter,
)
from stochlin.registry import Registry

ANY = Range(lower=-np.inf)
DAMPING = NOT_NEGATIVE
RESTITUTION = Range(
    upper=1.0,
    include_upper=True,
    reason="the share of the approach velocity that remains; for 0 use Stereomechanical",
)


CONTACTS: Registry[type[Contact]] = Registry("contact", "stochlin.models.contacts")


@dataclass(frozen=True)
class Contact(Model):
    """Base of the contacts: elements with a contact force, and impacts in which velocities jump."""

    @property
    def e(self) -> Any:
        """Coefficient of restitution [-] of two free masses."""
        raise NotImplementedError


@dataclass(frozen=True)
class Element(Contact):
    """A contact with a force law: a spring, and in most elements a dashpot.

    The penetration is ``d = u1 - u2 - gap`` [m], its rate ``v = d'`` [m/s]. A contact force acts only
    while ``d > 0``.
    """

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
        """The force law for a reduced mass [kg].

        Its fields are numbers if the parameters of the contact and the mass are numbers. Otherwise they
        are arrays that broadcast by dimension name.
        """
        mass = checked_value(type(self).__name__, "reduced_mass", reduced_mass, "kg", POSITIVE)
        exponent = getattr(self, "exponent", self.law.exponent)
        damping = self.damping_coefficient(mass)
        return self.law._replace(stiffness=self.stiffness, exponent=exponent, damping=damping)

    def force(
        self, penetration: Any, velocity: Any, approach_velocity: Any, reduced_mass: Any
    ) -> xr.DataArray:
        """Contact force [N], positive if it pushes the structures apart.

        ``penetration`` is ``d = u1 - u2 - gap`` [m]; the force is zero where it is not positive.
        ``velocity`` is ``d'`` [m/s], positive in approach. ``approach_velocity`` is its value at the
        start of this contact, positive, and is used by `HertzDamp` only. ``reduced_mass`` is
        ``m1 m2/(m1 + m2)`` [kg]. Cells out of range are NaN; a scalar out of range raises an error.

        Examples
        --------
        >>> import stochlin as sl
        >>> float(sl.LinearSpring(stiffness=2e6).force(0.01, 0.3, 0.5, reduced_mass=1e5))
        20000.0
        """
        name = type(self).__name__
        mass = checked_value(name, "reduced_mass", reduced_mass, "kg", POSITIVE)
        d = checked_value(name, "penetration", penetration, "m", ANY)
        v = checked_value(name, "velocity", velocity, "m/s", ANY)
        v0 = checked_value(name, "approach_velocity", approach_velocity, "m/s", POSITIVE)
        arguments = [xr.DataArray(value) for value in (*self.force_law(mass), d, v, v0)]
        with np.errstate(invalid="ignore"):  # cells out of range are blanked below
            result: xr.DataArray = xr.apply_ufunc(
                lambda *arrays: forces(ForceLaw(*arrays[:-3]), *arrays[-3:]),
                *arguments,
                join="exact",
                keep_attrs=False,
            )
        result = result.where(self.valid() & POSITIVE.contains(mass) & POSITIVE.contains(v0))
        return result.rename("contact_force").assign_attrs(units="N", long_name="contact force")


def checked_value(model: str, name: str, value: Any, units: str, allowed: Range) -> float | xr.DataArray:
    """The value of an argument, checked and labelled like a declared parameter of a model."""
    declared = {"units": units, "long_name": name.replace("_", " "), "allowed": allowed}
    return check(f"{model}: ", name, value, declared)


def elementwise(model: str, name: str, value: Any, allowed: Range, form: Form) -> Any:
    """``form(value)`` for values in the allowed range.

    A scalar out of range raises an error; cells of an array out of range are NaN. The result is of the
    kind of the value: a float, an array of the same shape, or a DataArray.
    """
    array = as_array(value)
    if array.ndim == 0 or array.dtype.kind not in "iuf":
        checked_value(model, name, value, "1", allowed)
    result = form(np.where(allowed.contains(array), array, np.nan).astype(float))
    if isinstance(value, xr.DataArray):
        return value.copy(data=result).rename(None).drop_attrs(deep=False).assign_attrs(units="1")
    return float(result) if array.ndim == 0 else result
