"""Functions of arrays applied to labelled arrays, which broadcast by dimension name.

All analyses with independent cells use this module. Arguments without dimensions are passed on as plain
numbers, without the cost of labels.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
import xarray as xr

from stochlin.kernels.basics.arrays import Array
from stochlin.models.parameters import Model

Cells = xr.DataArray | Array | float
"""Values of the cells of a table with labels, or the number of a single cell."""
Solved = Mapping[Any, Cells]
"""Computed variables by name: a dataset, or the variables for one."""


def row_of(array: xr.DataArray, like: xr.DataArray) -> Array:
    """Values in one row, broadcast to the dimensions of ``like`` and in the order of its cells."""
    if not array.ndim:
        return np.repeat(array.to_numpy(), like.size)
    return array.broadcast_like(like).transpose(*like.dims).to_numpy().ravel()


def is_labelled(*arrays: Cells) -> bool:
    """Whether one of the arrays has labels."""
    return any(isinstance(array, xr.DataArray) for array in arrays)


def lone(array: Cells) -> Cells:
    """The number of an array without dimensions, without label; any other array unchanged."""
    if isinstance(array, xr.DataArray) and not array.ndim and isinstance(array.data, np.ndarray):
        return array.data
    return array


def valid_cells(model: Model) -> Cells:
    """Whether the parameters of each cell are in range; True for scalars, which were checked before."""
    return model.valid() if is_labelled(*model.cells().values()) else True


def where_valid(values: Cells, valid: Cells) -> Cells:
    """The values, with NaN in invalid cells."""
    return cellwise(np.where, valid, values, np.nan)[0]


def cellwise(
    function: Callable[..., Any],
    *arrays: Cells,
    kinds: Sequence[npt.DTypeLike] = (float,),
    core: Sequence[Sequence[str]] | None = None,
    result: Sequence[str] = (),
    **options: Any,
) -> tuple[Any, ...]:
    """Results of a ``function`` of plain arrays for labelled arrays, which broadcast by dimension name.

    Parameters
    ----------
    function : callable
        Function of arrays, which returns an array, or a tuple of arrays for several ``kinds``.
    *arrays : Cells
        Labelled arrays or numbers. If all are numbers, so are the results (arrays without dimensions).
    kinds : sequence of dtypes
        Types of the results.
    core : sequence of sequences of str, optional
        For each array, the dimensions that belong to one cell; the function has them last.
    result : sequence of str
        Dimensions of the results that belong to one cell.
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
    if not is_labelled(*arrays):
        results = function(*map(np.asarray, arrays), **options)
        several = results if len(kinds) > 1 else (results,)
        return tuple(map(np.asarray, several, kinds))
    labelled = [entry if isinstance(entry, xr.DataArray) else xr.DataArray(entry) for entry in arrays]
    results = xr.apply_ufunc(
        function,
        *labelled,
        kwargs=options,
        input_core_dims=core or [[]] * len(labelled),
        output_core_dims=[list(result)] * len(kinds),
        join="exact",
    )
    return results if len(kinds) > 1 else (results,)
