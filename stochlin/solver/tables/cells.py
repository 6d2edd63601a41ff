"""Tables whose cells are computed one by one, for models with arrays as parameters."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial, reduce
from operator import and_
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
import xarray as xr

from stochlin.kernels.basics.arrays import Array
from stochlin.models.parameters import Model
from stochlin.models.structures import Structure
from stochlin.solver.tables import labels
from stochlin.solver.tables.lazy import arrays_of, check_names, computed, in_blocks, is_lazy, row_of

CELL_DIMENSION = "_cell"  # temporary dimension; no dimension of a model has this name
USABLE = "usable"
NONE_VALID = "no cell has valid parameters; correct those that are out of range"
OfCell = Callable[..., xr.Dataset]
ALL_USABLE = xr.DataArray(True)  # usable cells
NO_MODELS = dict[str, Model]()  # models beside those of a table
ONE = xr.DataArray(0.0)  # the shape of a single cell


def over_cells(
    function: OfCell,
    models: Mapping[str, Model],
    usable: xr.DataArray = ALL_USABLE,
    beside: Mapping[str, Model] = NO_MODELS,
) -> xr.Dataset:
    """Table of a ``function`` of scalar models, for every cell of models with arrays.

    The arrays broadcast by dimension name. The function is called with the models of a cell by
    their names. Models ``beside`` are passed on too, with those dimensions that the other models do
    not have. Cells with parameters out of range, or that are not ``usable``, are NaN with the
    status of invalid input, and those in which the function raises an ArithmeticError NaN and not
    converged. With dask arrays the table is lazy and has the same numbers.
    """
    if not arrays_of(models):
        return function(**models, **beside)
    pattern = None  # of a lazy table the result for the first valid cell
    if is_lazy(models):
        good = _good(models, usable)
        places = np.argwhere(good.to_numpy())
        if not len(places):
            raise ValueError(NONE_VALID)
        place = dict(zip(good.dims, places[0].tolist(), strict=True))
        cell = {role: computed(model.isel(place)) for role, model in models.items()}
        pattern = function(**cell, **beside)
    one_by_one = partial(_one_by_one, function, beside, pattern)
    table = in_blocks(one_by_one, models, xr.Dataset({USABLE: usable}))
    return table.assign_attrs({role: model.describe() for role, model in models.items()})


def together_or_alone(
    function: OfCell, models: Mapping[str, Model], usable: xr.DataArray
) -> xr.Dataset:
    """Table of a ``function`` of all cells together, or else of every cell by `over_cells`."""
    table = _of_cell(function, models)
    return table if isinstance(table, xr.Dataset) else over_cells(function, models, usable)


class Flat(NamedTuple):
    """Models with arrays, for all valid cells of their table in one row."""

    shape: xr.DataArray  # an array over the dimensions of the cells, in their order
    where: Array  # (c,) places of the valid cells in the flat table
    models: dict[str, Any]  # their parameters are numbers, or arrays over the valid cells

    def of_structure(self, role: str) -> Flat:
        """The same cells, of one structure on the ground."""
        models = {"structure": self.models[role], "ground": self.models["ground"]}
        return self._replace(models=models)

    def whole(self, values: Array, blank: float = np.nan) -> Array:
        """Values (..., c) of the valid cells in the shape of the table, and ``blank`` elsewhere."""
        if self.where.size < self.shape.size:
            filled = np.full((*values.shape[:-1], self.shape.size), blank, values.dtype)
            filled[..., self.where] = values
            values = filled
        return values.reshape((*values.shape[:-1], *self.shape.shape))

    def places(self, table: xr.DataArray) -> Array:
        """Numbers of the valid cells, -1 for others, with the dimensions of a larger table."""
        numbers = xr.Variable(self.shape.dims, self.whole(np.arange(self.where.size), -1))
        return numbers.set_dims(table.dims).values  # type: ignore[no-untyped-call]

    def table(self, values: Array, dims: Sequence[str] = (), blank: float = np.nan) -> xr.Variable:
        """Values (c, ...) of the valid cells over the dimensions of the cells and ``dims``."""
        whole = self.whole(np.moveaxis(values, 0, -1), blank)
        return xr.Variable((*dims, *self.shape.dims), whole).transpose(*self.shape.dims, *dims)

    def array(self, values: Array, blank: float = np.nan) -> Any:
        """Values (c,) of the valid cells as a labelled array, or the number of a single cell."""
        whole = self.whole(values, blank)
        return xr.DataArray(whole, self.shape.coords, self.shape.dims) if whole.ndim else whole


def flat(models: Mapping[str, Model], settled: bool = True) -> Flat:
    """The valid cells of models whose arrays broadcast by dimension name, in one row.

    Structures that would drift away have no stationary response, and are left out if ``settled``.

    Raises a ValueError if dimensions of the same name differ in coordinates or length.
    """
    arrays = arrays_of(models)
    if not arrays:
        return Flat(ONE, np.zeros(1, int), dict(models))
    shape = over_all(*arrays.values())
    settles = [m.settles() for m in models.values() if settled and isinstance(m, Structure)]
    where = np.flatnonzero(row_of(_good(models, reduce(and_, settles, ALL_USABLE)), shape))

    def row(model: Model) -> Model:
        arrays = ((name, array) for name, array in model.over_cells().items() if array.ndim)
        rows = {name: row_of(array, shape)[where] for name, array in arrays}
        return model.with_arrays(
            {name: xr.DataArray(row, dims=CELL_DIMENSION) for name, row in rows.items()}
        )

    return Flat(shape, where, {role: row(model) for role, model in models.items()})


def over_all(*arrays: xr.DataArray) -> xr.DataArray:
    """An array with the dimensions and coordinates of a result of these arrays."""
    if not any(array.ndim for array in arrays):
        return ONE
    return xr.apply_ufunc(lambda *x: np.broadcast_arrays(*x)[0], *arrays, join="exact")


def _one_by_one(
    function: OfCell,
    beside: Mapping[str, Model],
    pattern: xr.Dataset | None,
    /,
    more: xr.Dataset,
    **models: Any,
) -> xr.Dataset:
    """Table of all cells; ``pattern`` is a result, the pattern for invalid cells."""
    shape = xr.broadcast(*arrays_of(models).values())[0]
    good = _good(models, more[USABLE])
    done: list[xr.Dataset | ArithmeticError | None] = []
    for place in np.ndindex(shape.shape):
        where = dict(zip(shape.dims, place, strict=True))
        valid = bool(good.isel(where, missing_dims="ignore"))
        cell = (
            {role: model.isel(where) for role, model in {**models, **beside}.items()}
            if valid
            else {}
        )
        done.append(_of_cell(function, cell) if valid else None)
        if pattern is None and isinstance(done[-1], xr.Dataset):
            pattern = done[-1]
            check_names((*shape.dims, *shape.coords), {*pattern.variables, *pattern.dims})
    if pattern is None:
        raise next(filter(None, done), ValueError(NONE_VALID))  # type: ignore[misc]
    tables = [table if isinstance(table, xr.Dataset) else _blank(pattern, table) for table in done]
    index = pd.MultiIndex.from_product(
        [range(n) for n in shape.shape], names=list(map(str, shape.dims))
    )
    stacked = xr.concat(
        tables,
        CELL_DIMENSION,
        data_vars="all",
        coords="minimal",
        compat="override",
        combine_attrs="override",
        join="outer",
    )
    coordinates = xr.Coordinates.from_pandas_multiindex(index, CELL_DIMENSION)
    table = (
        stacked.assign_coords(coordinates)
        .unstack(CELL_DIMENSION)
        .drop_vars(list(map(str, shape.dims)))
    )
    return table.assign_coords({name: shape.coords[name] for name in shape.coords})


def _of_cell(function: OfCell, models: Mapping[str, Model]) -> xr.Dataset | ArithmeticError:
    """The result for one cell of a table, in which a cell that fails spoils no other."""
    try:
        return function(**models)
    except ArithmeticError as error:
        return error


def _good(models: Mapping[str, Model], usable: xr.DataArray) -> xr.DataArray:
    """Whether the parameters of each cell are valid and the cell is usable."""
    return reduce(and_, (model.valid() for model in models.values()), usable)


def _blank(table: xr.Dataset, error: ArithmeticError | None) -> xr.Dataset:
    """Copy of a table with NaN, with the highest value in flags, and with the status of a failure.

    The parameters are out of range if there is no ``error``.
    """
    blank = table.copy()
    for name, array in table.data_vars.items():
        if array.dtype.kind == "f":
            blank[name] = xr.full_like(array, np.nan)
        elif "flag_values" in array.attrs:
            blank[name] = xr.full_like(array, max(array.attrs["flag_values"]))
    if "status" in table:
        status = labels.INVALID_INPUT if error is None else labels.NOT_CONVERGED
        blank["status"] = xr.full_like(table.status, status)
    return blank
