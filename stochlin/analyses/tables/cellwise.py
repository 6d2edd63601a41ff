"""Functions of arrays over labelled arrays: broadcast by dimension name, chunk by chunk where lazy.

Every analysis whose cells do not depend on one another goes through here. Arrays that dask holds stay
with it; nothing is computed until it is asked for, and then by the same function, so that the
results are the same to the last bit.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
import xarray as xr

from stochlin.kernels.basics.arrays import Array
from stochlin.messages import sentence


def row_of(array: xr.DataArray, like: xr.DataArray) -> Array:
    """The values in the order of the cells of ``like``, over all of its dimensions."""
    return array.broadcast_like(like).transpose(*like.dims).to_numpy().ravel()


def is_lazy(*arrays: xr.DataArray) -> bool:
    """Whether dask holds one of them."""
    return any(array.chunks is not None for array in arrays)


def cellwise(
    function: Callable[..., Any],
    *arrays: xr.DataArray,
    kinds: Sequence[npt.DTypeLike] = (float,),
    core: Sequence[Sequence[str]] | None = None,
    result: Sequence[str] = (),
    **options: Any,
) -> tuple[xr.DataArray, ...]:
    """``function`` of arrays that broadcast, with a result of each of these kinds.

    ``core`` lists the dimensions of each array that come last and belong to a cell, ``result`` those of
    the results. An AlignmentError is raised for dimensions that differ in coordinates or length.
    """
    with warnings.catch_warnings():
        # A table has more chunks than its axes: dask warns of what is wanted here.
        warnings.filterwarnings("ignore", message="Increasing number of chunks")
        found = xr.apply_ufunc(
            function,
            *arrays,
            kwargs=options,
            input_core_dims=core or [[]] * len(arrays),
            output_core_dims=[list(result)] * len(kinds),
            join="exact",
            dask="parallelized",
            output_dtypes=[np.dtype(kind) for kind in kinds],
        )
    return found if len(kinds) > 1 else (found,)


def cellwise_pair(
    function: Callable[..., Any], *arrays: xr.DataArray, **options: Any
) -> tuple[xr.DataArray, ...]:
    """`cellwise` of two structures and a ground; a ValueError says how to make them fit."""
    try:
        return cellwise(function, *arrays, **options)
    except xr.AlignmentError as error:
        raise ValueError(
            f"first, second and ground share a dimension whose coordinates differ: "
            f"{sentence(error)}; give "
            "the structures different dimension names for a table, or equal coordinates for pairs"
        ) from error
