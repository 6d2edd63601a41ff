"""What simulation adds to the drift closure: exact over derived standard deviations, on a grid.

The closure is derived; how far it is off is known where the structures of the map of the bias were
simulated. The ratio varies slowly, and is held at the map's ends beyond them, but for weak motions:
where the yield displacement is seven standard deviations away nothing yields and nothing is off.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import xarray as xr

from stochlin.analyses.bias import KNOWN_GROUNDS, bias_map, map_name, point_of
from stochlin.analyses.cellwise import cellwise
from stochlin.analyses.equivalent_systems import solve_derived
from stochlin.analyses.tolerance import USUAL
from stochlin.kernels.arrays import Array
from stochlin.kernels.interpolation import Grid, interpolate
from stochlin.models.grounds import Ground, KanaiTajimi, WhiteNoise
from stochlin.models.structures import DRIFT, Bilinear, Structure

ELASTIC = 0.15  # R/p below which no drift grows within a million periods
STRENGTH = "elastic_ductility_std"


def corrected(structure: Structure, ground: Ground, derived: xr.Dataset) -> xr.Dataset:
    """The derived table with its displacements corrected, where the map knows the kind of ground."""
    if type(ground) not in KNOWN_GROUNDS or not structure.yields:
        return derived
    name = map_name(ground)
    point = point_of(structure, ground, derived)
    (factor,) = cellwise(_factor, *point, name=name)
    shown = ("displacement_std", "ductility_std")
    return derived.assign({variable: derived[variable] * factor for variable in shown})


@cache
def _grid(name: str) -> Grid:
    """Logarithm of the exact standard deviation over the derived one."""
    bias = bias_map()[name]
    axis = {str(dim): bias[dim] for dim in bias.dims}
    ground = KanaiTajimi(1.0, axis["ground_damping"]) if "ground_damping" in axis else WhiteNoise()
    structure = Bilinear(
        axis.get("period", 1.0), axis["damping"], axis["hardening"], reduction_factor=3 * axis[STRENGTH]
    )
    gaussian, derived = (
        solve_derived(structure, ground, closure, USUAL) for closure in ("gaussian", DRIFT)
    )
    ratio = gaussian.displacement_std / (1 + bias) / derived.displacement_std
    off = np.log(ratio).transpose(*bias.dims)
    strongest = xr.zeros_like(off.isel({STRENGTH: [0]})).assign_coords({STRENGTH: [ELASTIC]})
    whole = xr.concat([strongest, off], STRENGTH).transpose(*bias.dims)
    return Grid.of([np.log(whole[dim].values.astype(float)) for dim in whole.dims], whole.values)


@np.errstate(divide="ignore", invalid="ignore")  # elastic: log 0; invalid cells are NaN and stay so
def _factor(*point: Array, name: str) -> Array:
    grid = _grid(name)
    arrays = np.broadcast_arrays(*(np.log(array) for array in point))
    ends = [axis[[0, size - 1]] for axis, size in zip(grid.axes, grid.sizes, strict=True)]
    inside = [np.clip(array.ravel(), *end) for array, end in zip(arrays, ends, strict=True)]
    out = np.empty(arrays[0].size)
    interpolate(*grid, np.stack(inside), out)
    return np.exp(out).reshape(arrays[0].shape)
