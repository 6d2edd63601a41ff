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
from typing import Any

import numpy as np
import xarray as xr

from stochlin.analyses.tables.cellwise import Cells, Solved, cellwise
from stochlin.kernels.basics.arrays import Array, in_one_shape
from stochlin.kernels.basics.interpolation import Grid, interpolate
from stochlin.kernels.basics.slabs import by_slabs
from stochlin.kernels.correlation.tables import OFF
from stochlin.models.grounds import Ground, KanaiTajimi, WhiteNoise
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.laws.bouc_wen import BoucWen
from stochlin.models.structures import Structure

FILE = "bias_map.nc"
RATIO = "elastic_ductility_std"  # R/p: standard deviation of the elastic displacement over uy
STD = "displacement_std"
KNOWN_GROUNDS = (KanaiTajimi, WhiteNoise)
# Of Bouc-Wen structures: beta and exponents n that were simulated, and the fitted share of the bias of
# bilinear structures, n/(n + ROUNDED beta).
BETA, SHARPEST, ROUNDED = (0.3, 0.9), 5.0, 1.5
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
    own, soil = structure.cells(), ground.cells()
    point = [solved[RATIO], own.get("hardening", 1.0), own["damping"]]
    if isinstance(ground, WhiteNoise):
        return point
    return [*point, soil["damping"], own["period"] / soil["period"]]


def nearest_bilinear(structure: Structure) -> Structure:
    """The bilinear structure like a Bouc-Wen one; any other structure itself."""
    if not (isinstance(structure, BoucWen) and structure.yields):
        return structure
    return Bilinear(**{name: getattr(structure, name) for name in Structure.parameter_names()})


def relative_bias(
    structure: Structure, ground: Ground, solved: Solved, gaussian: Solved, nearest: Solved
) -> tuple[Cells, ...]:
    """Relative bias of ``displacement_std`` by any closure, and its caution as by `caution_of`.

    The bias is 0 if the structure is elastic, and NaN if it is unknown.

    ``solved`` is by that closure and ``gaussian`` by the Gaussian one, whose bias is in the map. For the
    Gaussian closure both are the same object. ``nearest`` is `nearest_bilinear` by the Gaussian closure.
    """
    known = type(ground) in KNOWN_GROUNDS and isinstance(structure, (Bilinear, BoucWen))
    point = point_of(structure, ground, gaussian) if known else []
    arrays = (solved[STD], gaussian[STD], gaussian["yield_displacement"], *point)
    options: dict[str, Any] = {"name": map_name(ground), "other": solved is not gaussian}
    bias, caution = cellwise(_relative_bias, *arrays, kinds=(float, np.int8), **options)
    if nearest is gaussian:
        return bias, caution
    shape = (structure.cells()[name] for name in ("beta", "gamma", "exponent"))
    arrays = (bias, gaussian[STD], nearest[STD], *shape)
    return cellwise(_of_bouc_wen, *arrays, kinds=(float, np.int8))


@np.errstate(divide="ignore", invalid="ignore")  # invalid cells are NaN and stay so
def _relative_bias(
    std: Array, gaussian: Array, yield_displacement: Array, *point: Array, name: str, other: bool
) -> tuple[Array, Array]:
    of_map: Any = np.nan
    if point:
        of_map = np.expm1(between_points(_grid(name), np.log(np.array(in_one_shape(*point)))))
    bias = np.where(np.isinf(yield_displacement), 0.0, of_map)
    bias = (1 + bias) * std / gaussian - 1 if other else np.where(np.isnan(std), np.nan, bias)
    return bias, _caution(bias, most=OFF)


@np.errstate(invalid="ignore")
def _of_bouc_wen(
    bias: Array, std: Array, nearest: Array, beta: Array, gamma: Array, n: Array
) -> tuple[Array, Array]:
    """Bias and caution of Bouc-Wen structures from two estimates by the nearest bilinear one.

    They are its ``bias``, and the error of ``std`` if the true standard deviations of both are equal.
    The bias is a share of the smaller one; the caution is that of the same share of the larger one.
    """
    equal = (1 + bias) * std / nearest - 1
    smaller = np.where(np.abs(bias) < np.abs(equal), bias, equal)
    larger = np.maximum(np.abs(bias), np.abs(equal))
    simulated = (
        (beta >= BETA[0]) & (beta <= BETA[1]) & (n <= SHARPEST) & (np.abs(beta + gamma - 1) < 1e-9)
    )
    share = np.where(simulated, n / (n + ROUNDED * beta), np.nan)
    return share * smaller, _caution(share * larger, most=OFF)


def rho_bias_map(first: Structure, second: Structure, ground: Ground) -> Grid | None:
    """Bias of ``rho`` over the coordinates of `place_in_map`; None if the map does not have the pair."""
    known = type(ground) in KNOWN_GROUNDS
    if not known or not (isinstance(first, Bilinear) and isinstance(second, Bilinear)):
        return None
    return _rho_grid(isinstance(ground, WhiteNoise))


def place_in_map(structure: Structure, ground: Ground, solved: Solved) -> list[Cells]:
    """Coordinates of a structure in `rho_bias_map`; white noise has the damping and period 1."""
    own, soil = structure.cells(), ground.cells()
    shared = [solved[RATIO], own.get("hardening", 1.0), own["damping"], soil.get("damping", 1.0)]
    return [*shared, own["period"], soil.get("period", 1.0)]


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


@by_slabs(np.int8)
def _caution(off: Array, *, most: float) -> Array:
    return np.asarray(np.int8(2) * np.isnan(off) + (np.abs(off) > most))


def between_points(grid: Grid, place: Sequence[Array] | Array) -> Array:
    """Interpolated values of a map; ``place`` has an array for each axis. NaN outside the map."""
    points = np.asarray(place)
    out = np.empty(points.shape[1:])
    interpolate(*grid, points.reshape(len(points), -1), out.reshape(-1))
    return out
