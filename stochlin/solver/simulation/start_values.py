"""Start values of motions, checked for the structures that move."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated

import numpy as np
import xarray as xr

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.pounding.run import BuildingRow
from stochlin.messages import brief
from stochlin.models.start import Start
from stochlin.models.systems import Assembly

END_STATE = "end_state"
STATE_DIMENSION = "state"
ARGUMENTS = "arguments"  # attribute of a state at the end
ROUNDING_OF_EXTENSIONS = 1e-9  # of extensions at yield


def check_start(name: str, start: object) -> None:
    """Raise a TypeError unless motions can begin from this."""
    if start is not None and not isinstance(start, (Start, xr.DataArray)):
        allowed = f"a Start, or the {END_STATE} of the motion before"
        raise TypeError(f"{name} = {brief(start)}; allowed: {allowed}")


AnyStart = Annotated[Start | xr.DataArray, check_start]


def start_in_words(start: Start | xr.DataArray | None) -> dict[str, str]:
    """The attribute of a result that says how its motions begin; none from rest."""
    if start is None:
        return {}
    words = f"{END_STATE} of the motion before"
    return {"start": start.describe() if isinstance(start, Start) else words}


def start_values(system: Assembly, start: Start) -> Array:
    """Displacements and velocities (2, n) of coordinates, checked: no element may yield by them."""
    values = start.of(system.coordinates)
    links = [placed.link.parts[2] for placed in system.placed_links]
    strength = np.concatenate([system.storeys.strength, links])
    extension = np.abs(system.extensions @ values[0])
    beyond = np.flatnonzero(extension > strength * (1 + ROUNDING_OF_EXTENSIONS))
    if beyond.size:
        element = beyond[0]
        what = f"start: the drift of {system.springs[element]} is {extension[element]:g} m"
        allowed = (
            f"up to {strength[element]:g} m, at which it yields, or the {END_STATE} of a motion"
        )
        raise ValueError(f"{what}; allowed: {allowed}")
    return values


def first_block(row: BuildingRow, values: Array, ground_velocity: float) -> Array:
    """The block (rows,) of a motion of a row of buildings that starts with these values."""
    walls = row.elements.system.mass.size - row.parts.mass.size
    q, v = np.pad(values, ((0, 0), (0, walls)))
    v[row.parts.mass.size :] = -ground_velocity
    return row.from_start(q, v)


def as_end_state(values: Array) -> xr.DataArray:
    """The state at the end of a motion, as a result has it."""
    return xr.DataArray(values, dims=STATE_DIMENSION)


def with_arguments(table: xr.Dataset, arguments: Mapping[str, str]) -> xr.Dataset:
    """A result whose state at the end, if it has one, says of which arguments it is."""
    if END_STATE not in table:
        return table
    text = "\n".join(f"{name} = {value}" for name, value in arguments.items())
    return table.assign({END_STATE: table[END_STATE].assign_attrs({ARGUMENTS: text})})


def check_arguments(start: AnyStart | None, arguments: Mapping[str, str]) -> None:
    """Raise a ValueError if a motion goes on from the end of one of other arguments."""
    if not isinstance(start, xr.DataArray) or ARGUMENTS not in start.attrs:
        return
    before = dict(line.split(" = ", 1) for line in str(start.attrs[ARGUMENTS]).splitlines())
    for name in ["function", *sorted(before.keys() ^ arguments.keys()), *before]:
        was = before.get(name)
        now = arguments.get(name)
        if was != now:
            what = f"with {name} = {was}" if was is not None else f"without {name}"
            allowed = f"with {name} = {now}" if now is not None else f"without {name}"
            raise ValueError(
                f"start is the {END_STATE} of a motion {what}; allowed: that of one {allowed}, or "
                "a Start"
            )


def checked_end_state(start: xr.DataArray, size: int) -> Array:
    """So many numbers of the end of a motion; raises a ValueError unless they are those of one."""
    if start.dims != (STATE_DIMENSION,) or start.size != size or start.dtype.kind != "f":
        what = f"start is an array {dict(start.sizes)} of {start.dtype}"
        allowed = f"the {END_STATE}, {size} numbers, of a motion of the same structures"
        raise ValueError(f"{what}; allowed: {allowed}, or a Start")
    return start.to_numpy()
