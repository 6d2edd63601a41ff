"""The stereomechanical impact, eq. (13), in which velocities jump and no contact force is modelled."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import xarray as xr

from stochlin.kernels.simulation.contacts import velocities_after_impact
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
        name = type(self).__name__
        first, second, *masses = (
            xr.DataArray(checked_value(name, *argument))
            for argument in (
                ("velocity_1", velocity_1, "m/s", ANY),
                ("velocity_2", velocity_2, "m/s", ANY),
                ("mass_1", mass_1, "kg", POSITIVE),
                ("mass_2", mass_2, "kg", POSITIVE),
            )
        )
        usable = (first >= second) & self.valid()
        for mass in masses:
            usable = usable & POSITIVE.contains(mass)
        if usable.ndim == 0 and not usable:
            raise ValueError(
                f"{name}: velocity_1 = {float(first):g} is below velocity_2 = {float(second):g}; "
                "allowed: velocity_1 >= velocity_2, since structure 1 is on the left"
            )
        after = xr.apply_ufunc(
            velocities_after_impact,
            *(first, second, *masses, xr.DataArray(self.restitution)),
            join="exact",
            output_core_dims=[(), ()],
        )
        attrs = {"units": "m/s", "long_name": "velocity after the impact"}
        left, right = (value.where(usable).assign_attrs(attrs) for value in after)
        return left, right
