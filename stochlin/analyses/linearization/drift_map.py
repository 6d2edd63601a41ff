"""What simulation adds to the drift closure: a map of corrections, interpolated, held at its ends.

The closure is derived; how far it is off is known where structures were simulated. The map holds the
exact over the derived standard deviation, and the simulated less the derived signature (see
`drift_signatures`). Both vary slowly. Beyond its ends the map is held, but for weak motions and for
hardening 1: where the yield displacement is seven standard deviations away nothing yields and nothing is
off. ``make bias`` computes it anew.
"""

from __future__ import annotations

from functools import cache
from importlib.resources import files

import numpy as np
import xarray as xr

from stochlin.analyses.linearization.bias_map import KNOWN_GROUNDS, between_points, point_of
from stochlin.analyses.tables.cellwise import cellwise
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.interpolation import Grid
from stochlin.models.grounds import CloughPenzien, Ground, WhiteNoise
from stochlin.models.structures import DRIFT, GAUSSIAN, Structure

FILE = "drift_map.nc"
# A Clough-Penzien ground is corrected as its soil would be alone.
CORRECTED_GROUNDS = (*KNOWN_GROUNDS, CloughPenzien)
ELASTIC = 0.15  # R/p below which no drift grows within a million periods
STRENGTH, HARDENING = "elastic_ductility_std", "hardening"
DISPLACEMENT, DISPLACEMENT_WHITE = "displacement_correction", "displacement_correction_white_noise"
SIGNATURE, REFERENCE = "signature_correction", "drift_reference"


@cache
def drift_map() -> xr.Dataset:
    """The map that comes with the package, with its grids and how it was made."""
    with files("stochlin.analyses.linearization").joinpath(FILE).open("rb") as stream:
        return xr.load_dataset(stream, engine="scipy")


def with_correction(structure: Structure, ground: Ground, derived: xr.Dataset) -> xr.Dataset:
    """The derived table with its displacements corrected, where the map knows the kind of ground."""
    if type(ground) not in CORRECTED_GROUNDS or not structure.yields:
        return derived
    name = DISPLACEMENT_WHITE if isinstance(ground, WhiteNoise) else DISPLACEMENT
    (logarithm,) = hold_at_ends(name, point_of(structure, ground, derived))
    factor = np.exp(logarithm)
    shown = ("displacement_std", "ductility_std")
    return derived.assign({variable: derived[variable] * factor for variable in shown})


def usual_closure(structure: Structure, ground: Ground) -> str:
    """The drift closure where it holds and is corrected, elsewhere the Gaussian one."""
    known = DRIFT in structure.closure_names() and type(ground) in CORRECTED_GROUNDS
    return DRIFT if known and structure.yields else GAUSSIAN


def hold_at_ends(name: str, point: list[xr.DataArray]) -> tuple[xr.DataArray, ...]:
    """The values of a variable of the map, one a reference, at a point of `point_of`."""
    return cellwise(_held, *point, name=name, kinds=(float,) * len(_grids(name)))


@cache
def _grids(name: str) -> tuple[Grid, ...]:
    whole = drift_map()[name]
    for dim, value, before in ((STRENGTH, ELASTIC, True), (HARDENING, 1.0, False)):
        exact = xr.zeros_like(whole.isel({dim: [0]})).assign_coords({dim: [value]})
        order = (exact, whole) if before else (whole, exact)
        whole = xr.concat(order, dim).transpose(*whole.dims)
    axes = [np.log(whole[dim].values.astype(float)) for dim in whole.dims if dim != REFERENCE]
    columns = whole.values if REFERENCE in whole.dims else whole.values[..., None]
    return tuple(Grid.of(axes, column) for column in np.moveaxis(columns, -1, 0))


@np.errstate(divide="ignore", invalid="ignore")  # elastic: log 0; invalid cells are NaN and stay so
def _held(*point: Array, name: str) -> Array | tuple[Array, ...]:
    arrays = np.broadcast_arrays(*(np.log(array) for array in point))
    grids = _grids(name)
    ends = [axis[[0, size - 1]] for axis, size in zip(grids[0].axes, grids[0].sizes, strict=True)]
    inside = [np.clip(array, *end) for array, end in zip(arrays, ends, strict=True)]
    found = tuple(between_points(grid, inside) for grid in grids)
    return found if len(found) > 1 else found[0]
