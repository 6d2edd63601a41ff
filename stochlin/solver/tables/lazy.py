"""Functions of labelled arrays, cell by cell, and lazy tables of parameters that are dask arrays.

Numbers without dimensions are passed on without the cost of labels. No other module knows of dask.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt
import xarray as xr

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.slabs import in_slabs
from stochlin.models.parameters import Model, check_alignment
from stochlin.models.plausible import unquestioned

Cells = xr.DataArray | Array | float
"""Values of the cells of a table with labels, or the number of a single cell."""


def row_of(array: xr.DataArray, like: xr.DataArray) -> Array:
    """Values in one row, broadcast to the dimensions of ``like`` and in the order of its cells."""
    if not array.ndim:
        return np.repeat(array.to_numpy(), like.size)
    return array.broadcast_like(like).transpose(*like.dims).to_numpy().ravel()


def valid_cells(model: Model) -> Cells:
    """Whether parameters of each cell are in range; True for scalars, which were checked before."""
    has_arrays = any(isinstance(values, xr.DataArray) for values in model.cells().values())
    return model.valid() if has_arrays else True


def cellwise(
    function: Callable[..., Any],
    *arrays: Cells,
    kinds: Sequence[npt.DTypeLike] = (float,),
    **options: Any,
) -> tuple[Any, ...]:
    """Results of a ``function`` of plain arrays for labelled ones that broadcast by dimension name.

    Parameters
    ----------
    function : callable
        Function of arrays, which returns an array, or a tuple of arrays for several ``kinds``. It
        is called for slabs of large tables.
    *arrays : Cells
        Labelled arrays or numbers. If all are numbers, so are the results (arrays without
        dimensions).
    kinds : sequence of dtypes
        Types of the results.
    **options
        Keyword arguments of the function.

    Returns
    -------
    tuple of Cells
        A result for each of the ``kinds``.

    Raises
    ------
    xarray.AlignmentError
        If dimensions of the same name differ in coordinates or length.
    """

    def whole(*inputs: Any) -> Any:
        plain = map(np.asarray, inputs)
        results = in_slabs(partial(function, **options), *plain, kinds=kinds)
        return results if len(kinds) > 1 else results[0]

    if any(isinstance(array, xr.DataArray) for array in arrays):
        results = xr.apply_ufunc(whole, *arrays, output_core_dims=[[]] * len(kinds), join="exact")
    else:
        results = whole(*arrays)
    return results if len(kinds) > 1 else (results,)


def in_blocks(
    function: Callable[..., xr.Dataset], models: Mapping[str, Model], more: xr.Dataset | None = None
) -> xr.Dataset:
    """Table of a ``function`` of models; with dask arrays as parameters it is lazy.

    Each block of a lazy table is the ``function`` of the parameters in this block. The function is
    called once beforehand, with a single cell without valid parameters, which shows what a table
    contains.

    Parameters
    ----------
    function : callable
        Function of the models by their names, and of the dataset ``more`` if there is one.
    models : mapping
        Models by name.
    more : xarray.Dataset, optional
        Variables over dimensions of the models, of which each block has its part.

    Raises
    ------
    ValueError
        If dimensions of the same name differ in coordinates or length, or have the name of a
        variable.
    """
    arrays = arrays_of(models)
    rest = {} if more is None else {"more": more}
    if not is_lazy(models):
        names = {name for array in arrays.values() for name in (*array.dims, *array.coords)}
        try:
            table = function(**models, **rest)
        except (ValueError, KeyError) as error:  # xarray quotes a name that is there twice
            check_names(names, [name for name in names if repr(name) in str(error)])
            raise
        # another dimension may become a variable
        labelled = (array.coords for array in arrays.values())
        check_names(names.difference(*labelled), table.variables)
        return table
    whole = xr.Dataset(arrays | dict(more or {})).chunk()
    with warnings.catch_warnings():
        # A table has more chunks than its axes, which is intended here.
        warnings.filterwarnings("ignore", message="Increasing number of chunks")
        whole = whole.unify_chunks()
    cell = dict.fromkeys(whole.dims, slice(0, 1))
    bare = {role: _unknown(model.isel(cell)) for role, model in models.items()}
    rest = {name: table.isel(cell, missing_dims="ignore").compute() for name, table in rest.items()}
    like = in_blocks(function, bare, rest.get("more"))
    template = xr.Dataset(
        {name: _empty(variable, whole.chunksizes) for name, variable in like.data_vars.items()},
        {**like.coords, **whole.coords},
        like.attrs,
    )
    options = {"function": function, "bare": bare, "more": list(more or ())}
    # Older releases of xarray lose the order of the variables.
    return xr.map_blocks(_of_block, whole, kwargs=options, template=template)[list(like.data_vars)]


def check_names(names: Iterable[Hashable], taken: Iterable[Hashable]) -> None:
    """Raise a ValueError if a dimension or coordinate is named as what the result itself has."""
    for name in {*taken}.intersection(names):
        raise ValueError(
            f"a dimension is named {name!r}, as a part of the result; give it another name"
        )


def arrays_of(models: Mapping[str, Model]) -> dict[str, xr.DataArray]:
    """The parameters with dimensions of a table, by the names ``model.parameter``.

    Raises a ValueError if dimensions of the same name differ in coordinates or length.
    """
    arrays = {
        f"{role}.{name}": array
        for role, model in models.items()
        for name, array in model.over_cells().items()
        if array.ndim
    }
    *others, last = models
    check_alignment(f"{', '.join(others)} and {last}", *arrays.values())
    return arrays


def is_lazy(models: Mapping[str, Model]) -> bool:
    """Whether a parameter is a dask array."""
    arrays = [array for model in models.values() for array in model.over_cells().values()]
    return any(array.ndim and array.chunks is not None for array in arrays)


def computed(model: Model) -> Any:
    """The model, with its dask arrays computed."""
    arrays = {name: array for name, array in model.over_cells().items() if array.chunks is not None}
    return model.with_arrays({name: array.compute() for name, array in arrays.items()})


def _unknown(model: Model) -> Model:
    """The model with NaN in place of its arrays."""
    arrays = {name: array for name, array in model.over_cells().items() if array.ndim}
    return model.with_arrays(
        {name: array.copy(data=np.full(array.shape, np.nan)) for name, array in arrays.items()}
    )


def _empty(variable: xr.DataArray, chunks: Mapping[Any, tuple[int, ...]]) -> xr.Variable:
    """A lazy variable like this one, in chunks along the dimensions that have some."""
    from dask.array import empty  # dask is installed, since there are dask arrays

    parts = [chunks.get(dim, (size,)) for dim, size in variable.sizes.items()]
    array = empty([sum(part) for part in parts], dtype=variable.dtype, chunks=parts)
    return xr.Variable(variable.dims, array, variable.attrs)


def _of_block(
    whole: xr.Dataset,
    function: Callable[..., xr.Dataset],
    bare: Mapping[str, Model],
    more: list[Any],
) -> xr.Dataset:
    """The table of one block; ``whole`` has its parameters, ``bare`` the models without them."""
    models = {
        role: model.with_arrays(
            {name: whole[key] for name in model.over_cells() if (key := f"{role}.{name}") in whole}
        )
        for role, model in bare.items()
    }
    with unquestioned():  # in a thread that does not know that the caller's values were judged
        return function(**models, **({"more": whole[more]} if more else {}))
