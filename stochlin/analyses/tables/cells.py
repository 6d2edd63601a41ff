"""Tables of what is computed one cell at a time: loops over the cells of models with arrays."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
import pandas as pd
import xarray as xr

from stochlin.analyses.tables import labels
from stochlin.models.parameters import Model

CELL = "_cell"  # while tables are put together; models have dimensions of any other name


def over_cells(
    function: Callable[..., xr.Dataset],
    models: Mapping[str, Model],
    usable: xr.DataArray | None = None,
    beside: Mapping[str, Model] | None = None,
) -> xr.Dataset:
    """``function`` of scalar models, for every cell of models whose arrays broadcast by name.

    What stands ``beside`` keeps the dimensions that the others lack. A cell whose parameters are out of
    range, or that is not ``usable``, is NaN, with the status of invalid input.
    """
    arrays = [array for model in models.values() for array in model.over_cells().values()]
    whole = {**models, **(beside or {})}
    if not any(array.ndim for array in arrays):
        return function(**whole)
    shape = xr.broadcast(*arrays)[0]
    places = list(np.ndindex(shape.shape))
    done: list[xr.Dataset | None] = []
    for place in places:
        where = dict(zip(shape.dims, place, strict=True))
        good = [model.valid() for model in models.values()]
        good += [] if usable is None else [usable]
        valid = all(bool(one.isel(where, missing_dims="ignore")) for one in good)
        cell = {role: model.isel(where) for role, model in whole.items()} if valid else {}
        done.append(function(**cell) if valid else None)
    known = next((table for table in done if table is not None), None)
    if known is None:
        raise ValueError("no cell has valid parameters; correct those that are out of range")
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
    table = table.assign_coords({name: shape.coords[name] for name in shape.coords})
    return table.assign_attrs({role: model.describe() for role, model in models.items()})


def _blank(table: xr.Dataset) -> xr.Dataset:
    """The same without answers."""
    blank = table.copy()
    for name, array in table.data_vars.items():
        if array.dtype.kind == "f":
            blank[name] = xr.full_like(array, np.nan)
    if "status" in table:
        blank["status"] = xr.full_like(table.status, labels.INVALID_INPUT)
    return blank
