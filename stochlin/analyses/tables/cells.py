"""Tables of what is computed one cell at a time: loops over the cells of models with arrays."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import reduce
from operator import and_
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from stochlin.analyses.tables import labels
from stochlin.analyses.tables.cellwise import is_lazy
from stochlin.models.parameters import Model

CELL = "_cell"  # while tables are put together; models have dimensions of any other name
USABLE = "usable"
NONE_VALID = "no cell has valid parameters; correct those that are out of range"
OfCell = Callable[..., xr.Dataset]


def over_cells(
    function: OfCell,
    models: Mapping[str, Model],
    usable: xr.DataArray | None = None,
    beside: Mapping[str, Model] | None = None,
) -> xr.Dataset:
    """``function`` of scalar models, for every cell of models whose arrays broadcast by name.

    What stands ``beside`` keeps the dimensions that the others lack. A cell whose parameters are out of
    range, or that is not ``usable``, is NaN, with the status of invalid input.

    Where dask holds one of the arrays the table is lazy: its chunks are computed when they are asked
    for, wherever dask computes, and hold the same numbers.
    """
    arrays = [array for model in models.values() for array in model.over_cells().values()]
    whole = {**models, **(beside or {})}
    if not any(array.ndim for array in arrays):
        return function(**whole)
    shape = xr.broadcast(*arrays)[0]
    if is_lazy(*arrays):
        table = _in_chunks(function, models, usable, beside, shape)
    else:
        table = _one_by_one(function, models, usable, beside, shape)
    return table.assign_attrs({role: model.describe() for role, model in models.items()})


def _one_by_one(
    function: OfCell,
    models: Mapping[str, Model],
    usable: xr.DataArray | None,
    beside: Mapping[str, Model] | None,
    shape: xr.DataArray,
    known: xr.Dataset | None = None,
) -> xr.Dataset:
    """The table of all cells of this ``shape``; ``known`` is what any of a larger table gave."""
    whole = {**models, **(beside or {})}
    good = _good(models, usable)
    places = list(np.ndindex(shape.shape))
    done: list[xr.Dataset | None] = []
    for place in places:
        where = dict(zip(shape.dims, place, strict=True))
        valid = bool(good.isel(where, missing_dims="ignore"))
        cell = {role: model.isel(where) for role, model in whole.items()} if valid else {}
        done.append(function(**cell) if valid else None)
    known = known if known is not None else next((table for table in done if table is not None), None)
    if known is None:
        raise ValueError(NONE_VALID)
    tables = [_blank(known) if table is None else table for table in done]
    index = pd.MultiIndex.from_product([range(n) for n in shape.shape], names=list(map(str, shape.dims)))
    stacked = xr.concat(
        tables,
        CELL,
        data_vars="all",
        coords="minimal",
        compat="override",
        combine_attrs="override",
        join="outer",
    )
    coordinates = xr.Coordinates.from_pandas_multiindex(index, CELL)
    table = stacked.assign_coords(coordinates).unstack(CELL).drop_vars(list(map(str, shape.dims)))
    return table.assign_coords({name: shape.coords[name] for name in shape.coords})


def _good(models: Mapping[str, Model], usable: xr.DataArray | None) -> xr.DataArray:
    """Cells with valid parameters that are usable."""
    good = [model.valid() for model in models.values()]
    return reduce(and_, good if usable is None else [*good, usable])


def _in_chunks(
    function: OfCell,
    models: Mapping[str, Model],
    usable: xr.DataArray | None,
    beside: Mapping[str, Model] | None,
    shape: xr.DataArray,
) -> xr.Dataset:
    """The same table, lazy, in the chunks of the models. One cell is computed, to know what it has."""
    good = _good(models, usable).broadcast_like(shape).transpose(*shape.dims)
    place: dict[str, int] = {}
    for dim in map(str, shape.dims):
        left = good.isel(place)
        along = left.any([other for other in left.dims if other != dim])
        place[dim] = int(np.argmax(along.to_numpy()))
    if not bool(good.isel(place)):
        raise ValueError(NONE_VALID)
    at_hand = {role: model.isel(place) for role, model in models.items()}
    bare = {role: model.with_arrays(_computed(model)) for role, model in at_hand.items()}
    known = function(**bare, **(beside or {}))
    given = xr.Dataset(
        {
            f"{role}.{name}": array
            for role, model in models.items()
            for name, array in model.over_cells().items()
            if array.ndim
        }
    )
    given = given.assign({} if usable is None else {USABLE: usable}).unify_chunks().chunk()
    from dask.array import empty  # which is there, since it holds the arrays

    sizes = [given.chunksizes[dim] for dim in shape.dims]
    variables = {
        name: (
            (*variable.dims, *shape.dims),
            empty(
                (*variable.shape, *shape.shape),
                dtype=variable.dtype,
                chunks=(*((n,) for n in variable.shape), *sizes),
            ),
            variable.attrs,
        )
        for name, variable in known.data_vars.items()
    }
    coords = {**known.coords, **{name: shape.coords[name] for name in shape.coords}}
    template = xr.Dataset(variables, coords, known.attrs)
    return xr.map_blocks(
        _chunk, given, kwargs={"options": (function, bare, beside, known)}, template=template
    )


def _computed(model: Model) -> dict[str, xr.DataArray]:
    """The arrays of a model that dask holds, with their numbers."""
    return {name: array.compute() for name, array in model.arrays().items() if is_lazy(array)}


def _chunk(given: xr.Dataset, options: tuple[Any, ...]) -> xr.Dataset:
    """One chunk of a lazy table, from the parameters of its cells."""
    function, bare, beside, known = options
    models = {
        role: model.with_arrays(
            {name: given[key] for name in model.arrays() if (key := f"{role}.{name}") in given}
        )
        for role, model in bare.items()
    }
    arrays = [array for model in models.values() for array in model.over_cells().values()]
    shape = xr.broadcast(*arrays)[0]
    table = _one_by_one(function, models, given.get(USABLE), beside, shape, known)
    return table.transpose(*(dim for dim in known.dims), *shape.dims, missing_dims="ignore")


def _blank(table: xr.Dataset) -> xr.Dataset:
    """The same without answers."""
    blank = table.copy()
    for name, array in table.data_vars.items():
        if array.dtype.kind == "f":
            blank[name] = xr.full_like(array, np.nan)
        elif "flag_values" in array.attrs:
            blank[name] = xr.full_like(array, max(array.attrs["flag_values"]))
    if "status" in table:
        blank["status"] = xr.full_like(table.status, labels.INVALID_INPUT)
    return blank
