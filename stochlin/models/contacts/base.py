"""What contacts share: how they are found, asked for their restitution, and handed to a kernel."""

from __future__ import annotations

import copy
import dataclasses
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any, ClassVar, Self

import numpy as np
import xarray as xr

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.pounding.contact import ForceLaw, forces
from stochlin.models.parameters import Model, Parameter, Range, parameter
from stochlin.registry import Registry

POSITIVE = Range()
ANY = Range(lower=-np.inf)
DAMPING = Range(include_lower=True)
RESTITUTION = Range(
    upper=1.0,
    include_upper=True,
    reason="the share of the approach velocity that is left; for 0 use Stereomechanical",
)

Form = Callable[[Array], Array]

CONTACTS: Registry[type[Contact]] = Registry("contact", "stochlin.models.contacts")


@dataclass(frozen=True)
class Contact(Model):
    """Base of what structures may meet at: elements with a force; without one, velocities jump."""

    @property
    def e(self) -> Any:
        """Coefficient of restitution [-] of two free masses."""
        raise NotImplementedError

    def isel(self, indexers: Mapping[Any, int | slice]) -> Self:
        """The contact with only these cells along the dimensions that it has."""
        part = copy.copy(self)
        for name, array in self.arrays().items():
            if array.ndim:
                object.__setattr__(part, name, array.isel(indexers, missing_dims="ignore"))
        return part


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
        """Force of the contact, positive where it pushes the structures apart.

        Parameters
        ----------
        penetration : float or array
            ``d = u1 - u2 - gap`` [m]; without contact, ``d <= 0``, there is no force.
        velocity : float or array
            ``d'`` [m/s], positive in approach.
        approach_velocity : float or array
            ``d'`` [m/s] at the beginning of this contact, positive; only `HertzDamp` asks for it.
        reduced_mass : float or array
            ``m1 m2/(m1 + m2)`` [kg], positive.

        Returns
        -------
        xarray.DataArray
            Force [N]; NaN in cells that are out of range.

        Raises
        ------
        ValueError, TypeError
            If a scalar is out of range, a value is not a number, or dimensions do not fit.

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
        velocity. The scale of penetration is ``v0`` times this.

        Parameters
        ----------
        reduced_mass : float or array
            ``m1 m2/(m1 + m2)`` [kg], positive.
        approach_velocity : float or array
            ``d'`` [m/s] at the beginning of the contact, positive.
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
    return getattr(_holder(model, name, units, allowed)(value), name)


@cache
def _holder(model: str, name: str, units: str, allowed: Range) -> Any:
    """A model of one parameter, called as the model whose argument it is."""
    field = (name, Parameter, parameter(units, name.replace("_", " "), allowed))
    return dataclasses.make_dataclass(model, [field], bases=(Model,), frozen=True)


def elementwise(model: str, name: str, value: Any, allowed: Range, form: Form) -> Any:
    """``form`` of numbers in the range; a scalar out of range raises, such cells of an array are NaN.

    Gives back what it is given: a float, an array of the same shape, or a DataArray.
    """
    array = np.asarray(value)
    if array.dtype.kind not in "iuf":
        raise TypeError(f"{model}: {name} = {value!r} is not a real number; allowed: {allowed}")
    inside = allowed.contains(array)
    if array.ndim == 0 and not inside:
        raise ValueError(f"{model}: {name} = {float(array):g} is out of range; allowed: {allowed}")
    result = form(np.where(inside, array, np.nan).astype(float))
    if isinstance(value, xr.DataArray):
        return value.copy(data=result).rename(None).drop_attrs(deep=False).assign_attrs(units="1")
    return float(result) if array.ndim == 0 else result
