"""Functions of arrays over labelled arrays: broadcast by dimension name, chunk by chunk where lazy.

Every analysis whose cells do not depend on one another goes through here. Arrays that dask holds stay
with it; nothing is computed until it is asked for, and then by the same function, so that the
results are the same to the last bit. A lone cell has no dimensions and needs no labels: its numbers
stay numbers until a dataset is made of them.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping, Sequence
from typing import Any, overload

import numpy as np
import numpy.typing as npt
import xarray as xr

from stochlin.kernels.basics.arrays import Array
from stochlin.messages import sentence
from stochlin.models.parameters import Model

Cells = xr.DataArray | Array | float
"""The cells of a table with their labels, or a lone cell's number."""
Solved = Mapping[Any, Cells]
"""What was computed, by name: a dataset, or what one is made of."""


def row_of(array: xr.DataArray, like: xr.DataArray) -> Array:
    """The values in the order of the cells of ``like``, over all of its dimensions."""
    return array.broadcast_like(like).transpose(*like.dims).to_numpy().ravel()


def is_lazy(*arrays: Cells) -> bool:
    """Whether dask holds one of them."""
    return any(isinstance(array, xr.DataArray) and array.chunks is not None for array in arrays)


def lone(array: Cells) -> Cells:
    """The number of a lone cell without its label; of several cells the array as it is."""
    if isinstance(array, xr.DataArray) and not array.ndim and isinstance(array.data, np.ndarray):
        return array.data
    return array


def valid_cells(model: Model) -> Cells:
    """Where every parameter is in its range: numbers are, or they would not have been taken."""
    arrays = any(isinstance(value, xr.DataArray) for value in model.cells().values())
    return model.valid() if arrays else True


def where_valid(values: Cells, valid: Cells) -> Cells:
    """The values with NaN in cells that are not valid."""
    return cellwise(_known, values, valid)[0]


def _known(values: Array, valid: Array) -> Array:
    return np.where(valid, values, np.nan)


@overload
def cellwise(
    function: Callable[..., Any], *arrays: xr.DataArray, **options: Any
) -> tuple[xr.DataArray, ...]: ...
@overload
def cellwise(function: Callable[..., Any], *arrays: Cells, **options: Any) -> tuple[Cells, ...]: ...
def cellwise(
    function: Callable[..., Any],
    *arrays: Cells,
    kinds: Sequence[npt.DTypeLike] = (float,),
    core: Sequence[Sequence[str]] | None = None,
    result: Sequence[str] = (),
    **options: Any,
) -> tuple[Cells, ...]:
    """``function`` of arrays that broadcast, with a result of each of these kinds.

    ``core`` lists the dimensions of each array that come last and belong to a cell, ``result`` those of
    the results. An AlignmentError is raised for dimensions that differ in coordinates or length.
    Of numbers alone the results are numbers, arrays without dimensions.
    """
    if not any(isinstance(array, xr.DataArray) for array in arrays):
        found = function(*map(np.asarray, arrays), **options)
        several = found if len(kinds) > 1 else (found,)
        return tuple(np.asarray(one, kind) for one, kind in zip(several, kinds, strict=True))
    labelled = [one if isinstance(one, xr.DataArray) else xr.DataArray(one) for one in arrays]
    with warnings.catch_warnings():
        # A table has more chunks than its axes: dask warns of what is wanted here.
        warnings.filterwarnings("ignore", message="Increasing number of chunks")
        found = xr.apply_ufunc(
            function,
            *labelled,
            kwargs=options,
            input_core_dims=core or [[]] * len(labelled),
            output_core_dims=[list(result)] * len(kinds),
            join="exact",
            dask="parallelized",
            output_dtypes=[np.dtype(kind) for kind in kinds],
        )
    return found if len(kinds) > 1 else (found,)


@overload
def cellwise_pair(
    function: Callable[..., Any], *arrays: xr.DataArray, **options: Any
) -> tuple[xr.DataArray, ...]: ...
@overload
def cellwise_pair(function: Callable[..., Any], *arrays: Cells, **options: Any) -> tuple[Cells, ...]: ...
def cellwise_pair(function: Callable[..., Any], *arrays: Cells, **options: Any) -> tuple[Cells, ...]:
    """`cellwise` of two structures and a ground; a ValueError says how to make them fit."""
    try:
        return cellwise(function, *arrays, **options)
    except xr.AlignmentError as error:
        raise ValueError(
            f"first, second and ground share a dimension whose coordinates differ: "
            f"{sentence(error)}; give "
            "the structures different dimension names for a table, or equal coordinates for pairs"
        ) from error
