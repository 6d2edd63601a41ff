"""Tables whose cells are computed one by one, for models with arrays as parameters."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Hashable, Mapping, Sequence
from functools import partial, reduce
from operator import and_
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import pandas as pd
import xarray as xr

from stochlin.analyses.tables import labels
from stochlin.analyses.tables.cellwise import is_lazy, lone, row_of
from stochlin.kernels.basics.arrays import Array
from stochlin.messages import sentence
from stochlin.models.parameters import Model
from stochlin.models.structures import Structure

CELL = "_cell"  # temporary dimension; no dimension of a model has this name
USABLE = "usable"
NONE_VALID = "no cell has valid parameters; correct those that are out of range"
OfCell = Callable[..., xr.Dataset]
Kinds = dict[Any, tuple[Sequence[Hashable], npt.DTypeLike]]  # dimensions and type of each variable
OfChunk = Callable[[Mapping[str, Any], xr.Dataset], xr.Dataset]  # of models and a dataset beside them


def over_cells(
    function: OfCell,
    models: Mapping[str, Model],
    usable: xr.DataArray | None = None,
    beside: Mapping[str, Model] | None = None,
) -> xr.Dataset:
    """Table of a ``function`` of scalar models, for every cell of models with arrays.

    The arrays broadcast by dimension name. The function is called with the models of a cell by their
    names. Models ``beside`` are passed on too, with those dimensions that the other models do not have.
    Cells with parameters out of range, or that are not ``usable``, are NaN with the status of invalid
    input. With dask arrays the table is lazy and has the same numbers.
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


class Flat(NamedTuple):
    """Models with arrays, for all valid cells of their table in one row."""

    shape: xr.DataArray  # an array over the dimensions of the cells, in their order
    where: Array  # (c,) places of the valid cells in the flat table
    models: dict[str, Any]  # their parameters are numbers, or arrays over the valid cells

    def table(self, values: Array, dims: Sequence[str] = (), blank: float = np.nan) -> xr.Variable:
        """Values (c, ...) of the valid cells over the dimensions of the cells and ``dims``."""
        whole = np.full((self.shape.size, *values.shape[1:]), blank, values.dtype)
        whole[self.where] = values
        return xr.Variable(
            (*self.shape.dims, *dims), whole.reshape((*self.shape.shape, *values.shape[1:]))
        )

    def array(self, values: Array, blank: float = np.nan) -> Any:
        """Values (c,) of the valid cells as a labelled array, or the number of a single cell."""
        coords = {name: self.shape.coords[name] for name in self.shape.coords}
        return lone(xr.DataArray(self.table(values, blank=blank), coords))

    @property
    def row(self) -> Flat:
        """The valid cells alone, along one dimension that no model has."""
        return self.part(slice(None))

    def part(self, part: slice) -> Flat:
        """Some of the valid cells alone, along one dimension that no model has."""
        count = self.where[part].size
        models = {role: model.isel({CELL: part}) for role, model in self.models.items()}
        return Flat(xr.DataArray(np.zeros(count), dims=CELL), np.arange(count), models)


def flat(models: Mapping[str, Model]) -> Flat:
    """The valid cells of models whose arrays broadcast by dimension name, in one row.

    Structures that would drift away have no stationary response, and are left out.

    Raises a ValueError if dimensions of the same name differ in coordinates or length.
    """
    arrays = [a for model in models.values() for a in model.over_cells().values() if a.ndim]
    if not arrays:
        return Flat(xr.DataArray(0.0), np.zeros(1, int), dict(models))
    try:
        xr.align(*arrays, join="exact", copy=False)
    except (xr.AlignmentError, ValueError) as error:
        raise ValueError(
            f"{', '.join(models)}: they share a dimension whose coordinates or lengths differ: "
            f"{sentence(error)}; give them different dimension names for a table, or equal coordinates "
            "for cells side by side"
        ) from error
    shape = xr.broadcast(*arrays)[0]
    settles = [m.settles() for m in models.values() if isinstance(m, Structure)]
    where = np.flatnonzero(row_of(_good(models, reduce(and_, settles, xr.DataArray(True))), shape))

    def row(model: Model) -> Model:
        several = {name: array for name, array in model.over_cells().items() if array.ndim}
        rows = {name: row_of(array, shape)[where] for name, array in several.items()}
        return model.with_arrays(
            {name: xr.DataArray(values, dims=CELL) for name, values in rows.items()}
        )

    return Flat(shape, where, {role: row(model) for role, model in models.items()})


def _one_by_one(
    function: OfCell,
    models: Mapping[str, Model],
    usable: xr.DataArray | None,
    beside: Mapping[str, Model] | None,
    shape: xr.DataArray,
    known: xr.Dataset | None = None,
) -> xr.Dataset:
    """Table of all cells of ``shape``; ``known`` is a result, the pattern for invalid cells."""
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
    """Whether the parameters of each cell are valid and the cell is usable."""
    good = [model.valid() for model in models.values()]
    return reduce(and_, good if usable is None else [*good, usable])


def _in_chunks(
    function: OfCell,
    models: Mapping[str, Model],
    usable: xr.DataArray | None,
    beside: Mapping[str, Model] | None,
    shape: xr.DataArray,
) -> xr.Dataset:
    """Lazy table in the chunks of the models; one cell is computed at once, as a pattern."""
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
    """Lazy table, of which each chunk is ``function`` of the models and of ``more`` in this chunk.

    Parameters
    ----------
    function : callable
        Function of the models by their names and of a dataset, which returns the table of a chunk.
    models : mapping
        Models with arrays, whose dimensions are chunked.
    more : xarray.Dataset
        Arrays that the function needs beside the models.
    kinds : dict
        Dimensions and type of each variable of the table.
    like : xarray.Dataset, optional
        Pattern with the attributes of the table, and with the sizes and coordinates of the dimensions
        that the models do not have.

    Returns
    -------
    xarray.Dataset
        The lazy table.
    """
    arrays = xr.Dataset(
        {
            f"{role}.{name}": array
            for role, model in models.items()
            for name, array in model.over_cells().items()
            if array.ndim
        }
    )
    with warnings.catch_warnings():
        # A table has more chunks than its axes, which is intended here.
        warnings.filterwarnings("ignore", message="Increasing number of chunks")
        arrays = arrays.assign(more.data_vars).chunk().unify_chunks()
    like = xr.Dataset() if like is None else like
    from dask.array import empty  # dask is installed, since there are dask arrays

    def blank(name: Any, dims: Sequence[Hashable], kind: npt.DTypeLike) -> xr.Variable:
        sizes = [arrays.chunksizes.get(dim) or (like.sizes[dim],) for dim in dims]
        array = empty([sum(size) for size in sizes], dtype=kind, chunks=sizes)
        return xr.Variable(dims, array, like[name].attrs if name in like else None)

    template = xr.Dataset(
        {name: blank(name, *kind) for name, kind in kinds.items()},
        {**like.coords, **arrays.coords},
        like.attrs,
    )
    bare = {role: model.isel(dict.fromkeys(arrays.dims, 0)) for role, model in models.items()}
    bare = {role: model.with_arrays(computed(model)) for role, model in bare.items()}
    options = function, bare, {name: list(dims) for name, (dims, _) in kinds.items()}
    return xr.map_blocks(_of_chunk, arrays, kwargs={"options": options}, template=template)


def computed(model: Model) -> dict[str, xr.DataArray]:
    """The dask arrays of a model, computed."""
    return {name: array.compute() for name, array in model.arrays().items() if is_lazy(array)}


def _of_chunk(arrays: xr.Dataset, options: tuple[Any, ...]) -> xr.Dataset:
    """One chunk of a lazy table; ``arrays`` has the parameters of its cells as ``model.parameter``."""
    function, bare, dims = options
    models = {
        role: model.with_arrays(
            {name: arrays[key] for name in model.arrays() if (key := f"{role}.{name}") in arrays}
        )
        for role, model in bare.items()
    }
    table = function(models, arrays[[name for name in arrays if "." not in str(name)]])
    return table.assign({name: table[name].transpose(*own) for name, own in dims.items()})


def _chunk(models: Mapping[str, Model], more: xr.Dataset, options: tuple[Any, ...]) -> xr.Dataset:
    """One chunk of `over_cells`."""
    function, beside, known = options
    arrays = [array for model in models.values() for array in model.over_cells().values()]
    shape = xr.broadcast(*arrays)[0]
    return _one_by_one(function, models, more.get(USABLE), beside, shape, known)


def _blank(table: xr.Dataset) -> xr.Dataset:
    """Copy of a table with NaN, with the highest value in flags, and with the status invalid input."""
    blank = table.copy()
    for name, array in table.data_vars.items():
        if array.dtype.kind == "f":
            blank[name] = xr.full_like(array, np.nan)
        elif "flag_values" in array.attrs:
            blank[name] = xr.full_like(array, max(array.attrs["flag_values"]))
    if "status" in table:
        blank["status"] = xr.full_like(table.status, labels.INVALID_INPUT)
    return blank
