"""Bias of statistical linearization, interpolated in a map of nonlinear simulations.

The map has the relative bias of the standard deviation and the bias of ``rho`` by the Gaussian closure,
for bilinear structures on Kanai-Tajimi ground and on white noise. The bias of ``rho`` is that of pairs
with equal damping, hardening and strength ratio. The map is interpolated linearly in the logarithms of
its parameters and is not extrapolated. ``make bias`` computes it.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from importlib.resources import files

import numpy as np
import xarray as xr

from stochlin.analyses.tables.cellwise import Cells, Solved, cellwise
from stochlin.kernels.basics.arrays import Array, in_one_shape
from stochlin.kernels.basics.interpolation import Grid, interpolate
from stochlin.kernels.basics.slabs import in_slabs
from stochlin.kernels.correlation.tables import OFF
from stochlin.models.grounds import Ground, KanaiTajimi, WhiteNoise
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.structures import Structure

FILE = "bias_map.nc"
SHARED = ("elastic_ductility_std", "hardening", "damping")
STD = "displacement_std"
KNOWN_GROUNDS = (KanaiTajimi, WhiteNoise)
EXPECTED = 0.05  # expected error above which an error of more than OFF is not rare


@cache
def bias_map() -> xr.Dataset:
    """The map of the package; its attributes describe how it was computed."""
    with files("stochlin.analyses.linearization").joinpath(FILE).open("rb") as stream:
        return xr.load_dataset(stream, engine="scipy")


@cache
def _grid(name: str) -> Grid:
    array = bias_map()[name]
    axes = [np.log(array[dim].values.astype(float)) for dim in array.dims]
    values = np.log1p(array.values) if name.startswith("displacement") else array.values
    return Grid.of(axes, values)


def map_name(ground: Ground) -> str:
    """Name of the variable of the map with the bias of the standard deviation on this ground."""
    white = isinstance(ground, WhiteNoise)
    return "displacement_std_bias_white_noise" if white else "displacement_std_bias"


def point_of(structure: Structure, ground: Ground, solved: Solved) -> list[Cells]:
    """Coordinates of a solved structure along the axes of the variable `map_name`."""
    point = [solved[SHARED[0]], *(_property(structure, name) for name in SHARED[1:])]
    if isinstance(ground, WhiteNoise):
        return point
    soil = ground.cells()
    return [*point, soil["damping"], _property(structure, "period") / soil["period"]]


def relative_bias(structure: Structure, ground: Ground, solved: Solved, gaussian: Solved) -> Cells:
    """Relative bias of ``displacement_std`` by any closure; 0 if elastic, NaN if unknown.

    ``solved`` is by that closure and ``gaussian`` by the Gaussian one, whose bias is in the map. For the
    Gaussian closure both are the same object.
    """
    known = type(ground) in KNOWN_GROUNDS and isinstance(structure, Bilinear)
    point = point_of(structure, ground, gaussian) if known else []
    arrays = (solved[STD], gaussian[STD], gaussian["yield_displacement"], *point)
    return cellwise(_relative_bias, *arrays, name=map_name(ground), other=solved is not gaussian)[0]


@np.errstate(invalid="ignore")  # invalid cells are NaN and stay so
def _relative_bias(
    std: Array, gaussian: Array, yield_displacement: Array, *point: Array, name: str, other: bool
) -> Array:
    bias = np.where(np.isinf(yield_displacement), 0.0, _at_point(*point, name=name) if point else np.nan)
    return (1 + bias) * std / gaussian - 1 if other else np.where(np.isnan(std), np.nan, bias)


def rho_bias_map(first: Structure, second: Structure, ground: Ground) -> Grid | None:
    """Bias of ``rho`` over the coordinates of `place_in_map`; None if the map does not have the pair."""
    known = type(ground) in KNOWN_GROUNDS
    if not known or not (isinstance(first, Bilinear) and isinstance(second, Bilinear)):
        return None
    return _rho_grid(isinstance(ground, WhiteNoise))


def place_in_map(structure: Structure, ground: Ground, solved: Solved) -> list[Cells]:
    """Coordinates of a structure in `rho_bias_map`; white noise has the damping and period 1."""
    one: dict[str, Cells] = {"damping": 1.0, "period": 1.0}
    soil = one if isinstance(ground, WhiteNoise) else one | ground.cells()
    return [
        solved[SHARED[0]],
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
    everywhere = np.array([-1e3, 1e3])  # white noise: the bias does not depend on these axes
    values = np.broadcast_to(table.values[..., None, None, :], (*table.shape[:-1], 2, 2, ratio.size))
    return Grid.of([*shared, everywhere, everywhere, ratio], values)


def caution_of(bias: Cells) -> Cells:
    """Flag (int8) of a bias: 0 up to `OFF`, 1 above, 2 unknown."""
    return cellwise(_caution, bias, kinds=(np.int8,), most=OFF)[0]


def caution_of_error(error: Cells) -> Cells:
    """Flag (int8) of an expected error: 0 up to `EXPECTED`, 1 above, 2 unknown."""
    return cellwise(_caution, error, kinds=(np.int8,), most=EXPECTED)[0]


def _caution(off: Array, most: float) -> Array:
    return in_slabs(lambda one: 2 * np.isnan(one) + (np.abs(one) > most), off, kinds=(np.int8,))[0]


def _property(structure: Structure, name: str) -> Cells:
    return structure.cells().get(name, 1.0)


@np.errstate(divide="ignore", invalid="ignore")  # invalid cells are NaN and stay so
def _at_point(*point: Array, name: str) -> Array:
    return np.expm1(between_points(_grid(name), in_one_shape(*map(np.log, point))))


def between_points(grid: Grid, place: Sequence[Array] | Array) -> Array:
    """Interpolated values of a map; ``place`` has an array for each axis. NaN outside the map."""
    points = np.asarray(place)
    out = np.empty(points.shape[1:])
    interpolate(*grid, points.reshape(len(points), -1), out.reshape(-1))
    return out
