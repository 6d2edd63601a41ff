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


class ResultAxes(NamedTuple):
    """The heights at which two structures can meet, and the gaps between them."""

    heights: Array  # (h,) [m]; that of two oscillators is NaN
    distance: Gap

    @property
    def gaps(self) -> Array:
        """The gaps in a row (g,) [m], and 1 m in place of invalid ones."""
        return self.distance.arrays()["gap"].where(self.distance.valid(), 1.0).to_numpy().ravel()

    def array(self, values: Array, heights: bool = True, gaps: bool = True) -> xr.DataArray:
        """Labelled array of values over (time, heights, gaps), as far as they depend on these."""
        gap = self.distance.arrays()["gap"] if gaps else xr.DataArray(0.0)
        lead = [*[TIME][: values.ndim - gaps - heights], *[HEIGHT][:heights]]
        shape = values.shape[: len(lead)] + gap.shape
        array = xr.DataArray(values.reshape(shape), gap.coords, [*lead, *gap.dims])
        if heights and np.isnan(self.heights[0]):
            array = array.isel({HEIGHT: 0})
        elif heights:
            axis = labels.axis(HEIGHT, "height above the ground", self.heights, "m")
            array = array.assign_coords({HEIGHT: axis}).transpose(..., HEIGHT)
        return array.where(self.distance.valid()) if gaps else array


def over_heights(table: xr.Dataset) -> xr.Dataset:
    """Table of all heights together: the worst probabilities, and the moments at the highest one.

    The variables at each height have the ending ``_at_height``; the displacements have none.
    """
    whole = {}
    for name, array in table.items():
        kind = str(name).partition("_")[0]
        if kind == "confidence":
            whole[name] = array.min(HEIGHT, skipna=False)
        elif kind in ("instantaneous", "required"):
            whole[name] = array.max(HEIGHT, skipna=False)
        else:
            whole[name] = array.isel({HEIGHT: -1}, drop=True)
        if kind != "displacement":
            whole[f"{name}_at_height"] = array
    return xr.Dataset(whole)
