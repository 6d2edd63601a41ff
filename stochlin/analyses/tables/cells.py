"""Tables of what is computed one cell at a time: loops over the cells of models with arrays."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Hashable, Mapping, Sequence
from functools import partial, reduce
from operator import and_
from typing import Any

import numpy as np
import numpy.typing as npt
import pandas as pd
import xarray as xr

from stochlin.analyses.tables import labels
from stochlin.analyses.tables.cellwise import is_lazy
from stochlin.models.parameters import Model

CELL = "_cell"  # while tables are put together; models have dimensions of any other name
USABLE = "usable"
NONE_VALID = "no cell has valid parameters; correct those that are out of range"
OfCell = Callable[..., xr.Dataset]
Kinds = dict[Any, tuple[Sequence[Hashable], npt.DTypeLike]]  # of variables, with their dimensions
OfChunk = Callable[[Mapping[str, Any], xr.Dataset], xr.Dataset]  # models, and what is more


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
    bare = {role: model.with_arrays(computed(model)) for role, model in at_hand.items()}
    known = function(**bare, **(beside or {}))
    kinds: Kinds = {
        name: ((*variable.dims, *shape.dims), variable.dtype)
        for name, variable in known.data_vars.items()
    }
    more = xr.Dataset(None if usable is None else {USABLE: usable})
    table = in_chunks(partial(_chunk, options=(function, beside, known)), models, more, kinds, known)
    return table.assign_coords({name: shape.coords[name] for name in shape.coords})


def in_chunks(
    function: OfChunk,
    models: Mapping[str, Model],
    more: xr.Dataset,
    kinds: Kinds,
    like: xr.Dataset | None = None,
) -> xr.Dataset:
    """The lazy table of ``function`` of the models, and of ``more``, with the cells of a chunk alone.

    It has variables of these dimensions and ``kinds``, and the attributes and coordinates of another
    that it is ``like``, over dimensions that the models do not have.
    """
    given = xr.Dataset(
        {
            f"{role}.{name}": array
            for role, model in models.items()
            for name, array in model.over_cells().items()
            if array.ndim
        }
    )
    with warnings.catch_warnings():
        # A table has more chunks than its axes: dask warns of what is wanted here.
        warnings.filterwarnings("ignore", message="Increasing number of chunks")
        given = given.assign(more.data_vars).chunk().unify_chunks()
    like = xr.Dataset() if like is None else like
    from dask.array import empty  # which is there, since it holds the arrays

    def blank(name: Any, dims: Sequence[Hashable], kind: npt.DTypeLike) -> xr.Variable:
        sizes = [given.chunksizes.get(dim) or (like.sizes[dim],) for dim in dims]
        array = empty([sum(size) for size in sizes], dtype=kind, chunks=sizes)
        return xr.Variable(dims, array, like[name].attrs if name in like else None)

    template = xr.Dataset(
        {name: blank(name, *kind) for name, kind in kinds.items()},
        {**like.coords, **given.coords},
        like.attrs,
    )
    bare = {role: model.isel(dict.fromkeys(given.dims, 0)) for role, model in models.items()}
    bare = {role: model.with_arrays(computed(model)) for role, model in bare.items()}
    options = function, bare, {name: list(dims) for name, (dims, _) in kinds.items()}
    return xr.map_blocks(_of_chunk, given, kwargs={"options": options}, template=template)


def computed(model: Model) -> dict[str, xr.DataArray]:
    """The arrays of a model that dask holds, with their numbers."""
    return {name: array.compute() for name, array in model.arrays().items() if is_lazy(array)}


def _of_chunk(given: xr.Dataset, options: tuple[Any, ...]) -> xr.Dataset:
    """One chunk of a lazy table, from the parameters of its cells."""
    function, bare, dims = options
    models = {
        role: model.with_arrays(
            {name: given[key] for name in model.arrays() if (key := f"{role}.{name}") in given}
        )
        for role, model in bare.items()
    }
    table = function(models, given[[name for name in given if "." not in str(name)]])
    return table.assign({name: table[name].transpose(*own) for name, own in dims.items()})


def _chunk(models: Mapping[str, Model], more: xr.Dataset, options: tuple[Any, ...]) -> xr.Dataset:
    function, beside, known = options
    arrays = [array for model in models.values() for array in model.over_cells().values()]
    shape = xr.broadcast(*arrays)[0]
    return _one_by_one(function, models, more.get(USABLE), beside, shape, known)


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
