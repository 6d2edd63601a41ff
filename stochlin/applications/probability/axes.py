"""Dimensions of the results of a pair: instants, gaps, and heights of contact."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import xarray as xr

from stochlin.kernels.basics.arrays import Array
from stochlin.models.structures import Gap
from stochlin.solver.linearization.transient_systems import TIME
from stochlin.solver.tables import labels

HEIGHT = "height"
AT_HEIGHT = (
    "confidence_of_no_pounding",
    "instantaneous_probability",
    "difference_std",
    "difference_std_simulated",
    "difference_std_simulated_standard_error",
    "required_gap",
    "required_gap_simulated",
    "rho",
)


class Draws(NamedTuple):
    """Number, seed and scatter of simulated motions."""

    paths: int | None  # 0 for no simulation, None for as many as are needed
    seed: int
    scatter: float  # standard deviation of the logarithm of a random factor on each motion


class ResultAxes(NamedTuple):
    """The heights at which two structures can meet, and the gaps between them."""

    heights: Array  # (h,) [m]; that of two oscillators is NaN
    distance: Gap

    @property
    def gaps(self) -> Array:
        """The gaps in a row (g,) [m], and 1 m in place of invalid ones."""
        return self.distance.arrays()["gap"].where(self.distance.valid(), 1.0).to_numpy().ravel()

    def array(self, values: Array, gaps: bool = True, heights: bool = True) -> xr.DataArray:
        """Labelled array of values over (time, heights, gaps), as far as they depend on these."""
        lead = [TIME][: values.ndim - gaps - heights]
        gap = self.distance.arrays()["gap"] if gaps else xr.DataArray(0.0)
        tall = heights and not np.isnan(self.heights[0])
        axis = labels.axis(HEIGHT, "height above the ground", self.heights, "m") if tall else None
        shape = values.shape[: len(lead)] + (self.heights.shape if tall else ()) + gap.shape
        dims, coords = [*lead, *([HEIGHT] if tall else []), *gap.dims], dict(gap.coords)
        if axis is not None:
            coords[HEIGHT] = axis[HEIGHT]
        array = xr.DataArray(values.reshape(shape), coords, dims)
        array = array.where(self.distance.valid()) if gaps else array
        return array.transpose(..., HEIGHT, missing_dims="ignore")


def over_heights(table: xr.Dataset) -> xr.Dataset:
    """Table of all heights together: the worst probabilities, and the moments at the highest one.

    Variables of `AT_HEIGHT` are also kept at each height.
    """
    whole = {}
    for name, array in table.items():
        kind = str(name).partition("_")[0]
        if HEIGHT not in array.dims:
            whole[name] = array
        elif kind == "confidence":
            whole[name] = array.min(HEIGHT, skipna=False)
        elif kind in ("instantaneous", "required"):
            whole[name] = array.max(HEIGHT, skipna=False)
        else:
            whole[name] = array.isel({HEIGHT: -1}, drop=True)
        if name in AT_HEIGHT and HEIGHT in array.dims:
            whole[f"{name}_at_height"] = array
    return xr.Dataset(whole)
