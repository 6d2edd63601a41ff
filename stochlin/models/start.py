"""Start values of motions: displacements and velocities of all coordinates."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.messages import brief, listed
from stochlin.models.descriptions import shown_unit, span
from stochlin.models.parameters import ANY_NUMBER, Model, Parameter, parameter
from stochlin.models.plausible import PLAUSIBLE

MOST_SHOWN = 12  # values that are stated one by one


@dataclass(frozen=True)
class Start(Model):
    """Displacements and velocities at the start of a motion, in place of rest.

    Parameters
    ----------
    displacement, velocity : float or array
        Displacement [m] and velocity [m/s], relative to the ground, of each coordinate: of the
        floors of all buildings from left to right, each from the ground up; in place of the floors
        of a `ModalBuilding` of its modes. By default 0 of all.
    ground_velocity : float
        Velocity of the ground [m/s], which matters for a `Wall` that is fixed in space.

    Raises
    ------
    ValueError, TypeError
        If a value is not a finite number, is in another unit by its attribute, or is an array of
        several dimensions.

    References
    ----------
    Chopra, A. K. (2012), Dynamics of Structures, 4th ed., section 2.1.

    Examples
    --------
    >>> import stochlin as sl
    >>> sl.Start(velocity=[0.0, 1.0]).describe()
    'Start (velocity 0, 1 m/s)'
    """

    displacement: Parameter = parameter("m", "displacement at the start", ANY_NUMBER, 0.0)
    velocity: Parameter = parameter("m/s", "velocity at the start", ANY_NUMBER, 0.0)
    ground_velocity: float = parameter(
        "m/s", "velocity of the ground", ANY_NUMBER, 0.0, scalar=True
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        for name, values in self.arrays().items():
            if values.ndim > 1 or not np.isfinite(values.values).all():
                what = f"Start: {name} = {brief(values.values.tolist())}"
                raise ValueError(
                    f"{what}; allowed: a list of finite numbers, in {self.units(name)}"
                )

    def doubts(self) -> Iterator[str]:
        """Texts on displacements and velocities that are implausible."""
        for name, values in self.arrays().items():
            largest = float(np.abs(values.values).max(initial=0.0))
            if text := PLAUSIBLE[f"{name.removeprefix('ground_')} at the start"].doubt(largest):
                yield f"{name} = {largest:g}: {text}"

    def stated(self) -> list[str]:
        """The values that are not 0, one after the other; of many the range."""
        return [
            _stated(name.replace("_", " "), values.values.ravel(), self.units(name))
            for name, values in self.arrays().items()
            if values.values.any()
        ]

    def of(self, coordinates: Sequence[str]) -> Array:
        """Displacements and velocities (2, n) of the coordinates with these names."""
        columns = []
        for name in ("displacement", "velocity"):
            values = self.arrays()[name].values
            single = values.size == 1 and (len(coordinates) == 1 or not values.any())
            if not single and values.shape != (len(coordinates),):
                what = f"start: {name} has {values.size} value{'s' * (values.size > 1)}"
                of_each = f"one for each structure, floor or mode: {listed(coordinates)}"
                raise ValueError(f"{what}; allowed: {len(coordinates)}, {of_each}")
            columns.append(np.broadcast_to(values.ravel(), len(coordinates)))
        return np.array(columns, float)


def _stated(name: str, values: Array, units: str) -> str:
    """Values of coordinates in words, in the unit that is shown."""
    if values.size > MOST_SHOWN:
        return f"{name} {span(values, units)} in {values.size} coordinates"
    unit, scale = shown_unit(units, float(np.abs(values).max()))
    numbers = ", ".join(f"{scale * value:.6g}" for value in values)
    return f"{name} {numbers} {unit}"
