"""The stereomechanical impact, eq. (13), in which velocities jump and no contact force is modelled."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import xarray as xr

from stochlin.kernels.simulation import contacts as kernel
from stochlin.models.contacts.base import ANY, CONTACTS, Contact, checked_value
from stochlin.models.parameters import POSITIVE, Parameter, Range, parameter

SHARE = Range(
    upper=1.0,
    include_lower=True,
    include_upper=True,
    reason="0 is a plastic impact, 1 an elastic one",
)


@CONTACTS.register("stereomechanical", 8)
@dataclass(frozen=True)
class Stereomechanical(Contact):
    """Stereomechanical impact, eq. (13): it multiplies ``u1' - u2'`` by ``-e`` and conserves momentum.

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
    >>> impact = sl.Stereomechanical(restitution=0.5)
    >>> [float(v) for v in impact.velocities_after(1.0, -1.0, mass_1=2e5, mass_2=2e5)]
    [-0.5, 0.5]
    """

    restitution: Parameter = parameter("1", "coefficient of restitution", SHARE)

    @property
    def e(self) -> Any:
        """Coefficient of restitution [-]."""
        return self.restitution

    def velocities_after(
        self, velocity_1: Any, velocity_2: Any, mass_1: Any, mass_2: Any
    ) -> tuple[xr.DataArray, xr.DataArray]:
        """Velocities [m/s] of both structures after the impact, from those before and the masses [kg].

        Structure 1 is on the left, so that the structures approach one another if
        ``velocity_1 >= velocity_2``. Cells that are out of range or do not approach are NaN; a scalar
        out of range, or a single pair that does not approach, raises an error.
        """
        arguments, usable = self._approach(velocity_1, velocity_2, mass_1, mass_2)
        after = xr.apply_ufunc(
            kernel.velocities_after_impact, *arguments, join="exact", output_core_dims=[(), ()]
        )
        attrs = {"units": "m/s", "long_name": "velocity after the impact"}
        first, second = (value.where(usable).assign_attrs(attrs) for value in after)
        return first, second

    def energy_loss(self, velocity_1: Any, velocity_2: Any, mass_1: Any, mass_2: Any) -> xr.DataArray:
        """Energy lost in the impact [J], ``(1 - e^2) m (v1 - v2)^2/2`` with the reduced mass ``m``.

        Arguments, NaN cells and errors are as in `velocities_after`.
        """
        arguments, usable = self._approach(velocity_1, velocity_2, mass_1, mass_2)
        loss = xr.apply_ufunc(
            lambda v1, v2, *rest: kernel.impact_loss(*rest) * (v1 - v2) ** 2, *arguments, join="exact"
        )
        return loss.where(usable).assign_attrs(units="J", long_name="energy lost in the impact")

    def _approach(self, *arguments: Any) -> tuple[list[xr.DataArray], xr.DataArray]:
        """Velocities, masses and restitution as arrays, and the cells in which there is an impact."""
        names = ("velocity_1", "velocity_2", "mass_1", "mass_2")
        ranges = (ANY, ANY, POSITIVE, POSITIVE)
        units = ("m/s", "m/s", "kg", "kg")
        name = type(self).__name__
        values = [
            xr.DataArray(checked_value(name, *argument))
            for argument in zip(names, arguments, units, ranges, strict=True)
        ]
        first, second, *masses = values
        usable = (first >= second) & self.valid()
        for mass in masses:
            usable = usable & POSITIVE.contains(mass)
        if usable.ndim == 0 and not usable:
            raise ValueError(
                f"{name}: velocity_1 = {float(first):g} is below velocity_2 = {float(second):g}; "
                "allowed: velocity_1 >= velocity_2, since structure 1 is on the left"
            )
        return [*values, xr.DataArray(self.restitution)], usable
