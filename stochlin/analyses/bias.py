"""How far linearization is off: a map computed by simulation, interpolated, never extrapolated.

The map holds the bias of the Gaussian closure for bilinear structures on Kanai-Tajimi ground and on
white noise; ``make bias`` computes it anew. Between its points it is linear in the logarithms of
its parameters. Of ``rho`` it knows pairs of equal damping, hardening and strength ratio.
"""

from __future__ import annotations

from functools import cache
from importlib.resources import files

import numpy as np
import xarray as xr

from stochlin.analyses.slabs import in_slabs
from stochlin.kernels.arrays import Array
from stochlin.kernels.interpolation import Grid, interpolate
from stochlin.models.grounds import Ground, KanaiTajimi, WhiteNoise
from stochlin.models.structures import Bilinear, Structure

FILE = "bias_map.nc"
OFF = 0.1  # beyond which a cell is cautioned
EQUAL = 1e-6  # relative difference of properties that count as equal
SHARED = ("elastic_ductility_std", "hardening", "damping")
MEANINGS = ("within_10_percent", "off_by_more_than_10_percent", "outside_of_the_map")


@cache
def bias_map() -> xr.Dataset:
    """The map that comes with the package, with its grids, errors and how it was made."""
    with files("stochlin.analyses").joinpath(FILE).open("rb") as stream:
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
    if not _known(ground) or not isinstance(structure, Bilinear):
        return _nothing_but(elastic)
    point = [solved.elastic_ductility_std, *(_property(structure, name) for name in SHARED[1:])]
    if isinstance(ground, WhiteNoise):
        name = "displacement_std_bias_white_noise"
    else:
        name = "displacement_std_bias"
        point += [ground.arrays()["damping"], _property(structure, "period") / ground.arrays()["period"]]
    value = xr.apply_ufunc(lambda *inputs: np.expm1(_at(name, *inputs)), *point, join="exact")
    return value.where(~elastic, 0.0)


def relative_bias(
    structure: Structure, ground: Ground, solved: xr.Dataset, gaussian: xr.Dataset
) -> xr.DataArray:
    """Relative bias of the ``displacement_std`` solved under any closure."""
    bias = displacement_bias(structure, ground, gaussian).where(solved.displacement_std.notnull())
    if solved is gaussian:
        return bias
    return (1 + bias) * solved.displacement_std / gaussian.displacement_std - 1


def rho_bias(
    first: Structure, second: Structure, ground: Ground, solved: list[xr.Dataset]
) -> xr.DataArray:
    """Bias of ``rho`` by the Gaussian closure; 0 for two elastic structures, NaN where unknown."""
    elastic = [np.isinf(side.yield_displacement) for side in solved]
    both = xr.apply_ufunc(np.logical_and, *elastic, join="exact")
    if not _known(ground) or not (isinstance(first, Bilinear) and isinstance(second, Bilinear)):
        return _nothing_but(both)
    sides = [
        (side.elastic_ductility_std, *(_property(s, name) for name in (*SHARED[1:], "period")))
        for s, side in zip((first, second), solved, strict=True)
    ]
    pairs = [array for pair in zip(*sides, strict=True) for array in pair]
    if isinstance(ground, WhiteNoise):
        value = xr.apply_ufunc(_of_pair_on_white_noise, *pairs, join="exact")
    else:
        soil = [ground.arrays()[name] for name in ("damping", "period")]
        value = xr.apply_ufunc(_of_pair, *pairs, *soil, join="exact")
    return value.where(~both, 0.0)


def with_caution(table: xr.Dataset, biases: dict[str, xr.DataArray]) -> xr.Dataset:
    """Add the biases, and a flag that says where one is large or unknown."""
    worst = xr.DataArray(np.int8(0))
    for name, bias in biases.items():
        table[name] = bias
        flag = xr.where(table[name].notnull(), np.abs(bias) > OFF, 2)  # type: ignore[no-untyped-call]
        worst = xr.apply_ufunc(np.maximum, worst, flag, join="exact")
    worst.attrs = {
        "long_name": "whether linearization can be trusted here",
        "flag_values": np.arange(len(MEANINGS), dtype=np.int8),
        "flag_meanings": " ".join(MEANINGS),
    }
    return table.assign(caution=worst.astype(np.int8))


def _nothing_but(elastic: xr.DataArray) -> xr.DataArray:
    return xr.zeros_like(elastic, float).where(elastic)


def _known(ground: Ground) -> bool:
    return type(ground) in (KanaiTajimi, WhiteNoise)


def _property(structure: Structure, name: str) -> xr.DataArray:
    return structure.arrays().get(name, xr.DataArray(1.0))


def _of_pair(*inputs: Array) -> Array:
    def piece(*arrays: Array) -> Array:
        *pairs, ground_damping, ground_period = arrays
        shared, ratio, longer = _pair(pairs)
        return _at("rho_bias", *shared, ground_damping, longer / ground_period, ratio)

    return in_slabs(piece, *inputs)


def _of_pair_on_white_noise(*inputs: Array) -> Array:
    def piece(*arrays: Array) -> Array:
        shared, ratio, _ = _pair(list(arrays))
        return _at("rho_bias_white_noise", *shared, ratio)

    return in_slabs(piece, *inputs)


def _pair(pairs: list[Array]) -> tuple[list[Array], Array, Array]:
    """What both structures share, NaN where they do not; shorter over longer period; the longer."""
    *properties, period_1, period_2 = pairs
    shared = [
        np.where(np.abs(a - b) <= EQUAL * np.abs(a), a, np.nan)
        for a, b in zip(properties[::2], properties[1::2], strict=True)
    ]
    longer = np.maximum(period_1, period_2)
    return shared, np.minimum(period_1, period_2) / longer, longer


@np.errstate(divide="ignore", invalid="ignore")  # invalid cells are NaN and stay so
def _at(name: str, *point: Array) -> Array:
    arrays = np.broadcast_arrays(*(np.log(array) for array in point))
    out = np.empty(arrays[0].size)
    interpolate(*_grid(name), np.stack([array.ravel() for array in arrays]), out)
    return out.reshape(arrays[0].shape)
