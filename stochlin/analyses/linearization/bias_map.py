"""How far linearization is off: a map computed by simulation, interpolated, never extrapolated.

The map holds the bias of the Gaussian closure for bilinear structures on Kanai-Tajimi ground and on
white noise; ``make bias`` computes it anew. Between its points it is linear in the logarithms of
its parameters. Of ``rho`` it knows pairs of equal damping, hardening and strength ratio.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from importlib.resources import files

import numpy as np
import xarray as xr

from stochlin.analyses.tables.cellwise import cellwise
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.interpolation import Grid, interpolate
from stochlin.kernels.correlation.tables import OFF
from stochlin.models.grounds import Ground, KanaiTajimi, WhiteNoise
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.structures import Structure

FILE = "bias_map.nc"
SHARED = ("elastic_ductility_std", "hardening", "damping")
KNOWN_GROUNDS = (KanaiTajimi, WhiteNoise)
EXPECTED = 0.05  # error from which on one of more than OFF is not rare
MEANINGS = ("within_10_percent", "off_by_more_than_10_percent", "outside_of_the_map")


@cache
def bias_map() -> xr.Dataset:
    """The map that comes with the package, with its grids, errors and how it was made."""
    with files("stochlin.analyses.linearization").joinpath(FILE).open("rb") as stream:
        return xr.load_dataset(stream, engine="scipy")


@cache
def _grid(name: str) -> Grid:
    array = bias_map()[name]
    axes = [np.log(array[dim].values.astype(float)) for dim in array.dims]
    values = np.log1p(array.values) if name.startswith("displacement") else array.values
    return Grid.of(axes, values)


def displacement_bias(structure: Structure, ground: Ground, solved: xr.Dataset) -> xr.DataArray:
    """Relative bias of the Gaussian closure's ``displacement_std``; 0 if elastic, NaN if unknown."""
    elastic = np.isinf(solved.yield_displacement)
    if type(ground) not in KNOWN_GROUNDS or not isinstance(structure, Bilinear):
        return xr.zeros_like(elastic, float).where(elastic)
    (value,) = cellwise(_at_point, *point_of(structure, ground, solved), name=map_name(ground))
    return value.where(~elastic, 0.0)


def map_name(ground: Ground) -> str:
    """The map's variable for the standard deviation on this ground."""
    white = isinstance(ground, WhiteNoise)
    return "displacement_std_bias_white_noise" if white else "displacement_std_bias"


def point_of(structure: Structure, ground: Ground, solved: xr.Dataset) -> list[xr.DataArray]:
    """Where a solved structure is in `map_name`, axis by axis."""
    point = [solved.elastic_ductility_std, *(_property(structure, name) for name in SHARED[1:])]
    if isinstance(ground, WhiteNoise):
        return point
    soil = ground.arrays()
    return [*point, soil["damping"], _property(structure, "period") / soil["period"]]


def relative_bias(
    structure: Structure, ground: Ground, solved: xr.Dataset, gaussian: xr.Dataset
) -> xr.DataArray:
    """Relative bias of the ``displacement_std`` solved under any closure."""
    bias = displacement_bias(structure, ground, gaussian).where(solved.displacement_std.notnull())
    if solved is gaussian:
        return bias
    return (1 + bias) * solved.displacement_std / gaussian.displacement_std - 1


def rho_bias_map(first: Structure, second: Structure, ground: Ground) -> Grid | None:
    """What the map knows of ``rho`` on this ground, by the axes of `place_in_map`; None: nothing."""
    known = type(ground) in KNOWN_GROUNDS
    if not known or not (isinstance(first, Bilinear) and isinstance(second, Bilinear)):
        return None
    return _rho_grid(isinstance(ground, WhiteNoise))


def place_in_map(structure: Structure, ground: Ground, solved: xr.Dataset) -> list[xr.DataArray]:
    """Coordinates of a structure in `rho_bias_map`; 1 where the ground has no such property."""
    one = {"damping": xr.DataArray(1.0), "period": xr.DataArray(1.0)}
    soil = one if isinstance(ground, WhiteNoise) else one | ground.arrays()
    return [
        solved.elastic_ductility_std,
        *(_property(structure, name) for name in SHARED[1:]),
        soil["damping"],
        _property(structure, "period"),
        soil["period"],
    ]


@cache
def _rho_grid(white_noise: bool) -> Grid:
    if not white_noise:
        return _grid("rho_bias")
    table = bias_map()["rho_bias_white_noise"]
    *shared, ratio = (np.log(table[dim].values.astype(float)) for dim in table.dims)
    everywhere = np.array([-1e3, 1e3])  # the ground is the same for all dampings and periods
    values = np.broadcast_to(table.values[..., None, None, :], (*table.shape[:-1], 2, 2, ratio.size))
    return Grid.of([*shared, everywhere, everywhere, ratio], values)


def caution_of(bias: xr.DataArray) -> xr.DataArray:
    """Flag (int8) of a bias: 0 small, 1 large, 2 unknown."""
    return _flag(xr.where(bias.notnull(), np.abs(bias) > OFF, 2))  # type: ignore[no-untyped-call]


def caution_of_error(error: xr.DataArray) -> xr.DataArray:
    """Flag of an expected error: 0 where more than `OFF` is rare, 1 where it is not, 2 unknown."""
    return _flag(xr.where(error.notnull(), error > EXPECTED, 2))  # type: ignore[no-untyped-call]


def _flag(flag: xr.DataArray) -> xr.DataArray:
    flag.attrs = {
        "long_name": "whether linearization can be trusted here",
        "flag_values": np.arange(len(MEANINGS), dtype=np.int8),
        "flag_meanings": " ".join(MEANINGS),
    }
    return flag.astype(np.int8)


def _property(structure: Structure, name: str) -> xr.DataArray:
    return structure.arrays().get(name, xr.DataArray(1.0))


@np.errstate(divide="ignore", invalid="ignore")  # invalid cells are NaN and stay so
def _at_point(*point: Array, name: str) -> Array:
    return np.expm1(between_points(_grid(name), np.broadcast_arrays(*map(np.log, point))))


def between_points(grid: Grid, place: Sequence[Array]) -> Array:
    """The value of a map at this place, axis by axis, in arrays of one shape; NaN outside."""
    out = np.empty(place[0].size)
    interpolate(*grid, np.stack([array.ravel() for array in place]), out)
    return out.reshape(place[0].shape)
