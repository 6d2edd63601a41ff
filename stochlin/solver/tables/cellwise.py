"""Functions of arrays applied to labelled arrays, which broadcast by dimension name.

All analyses with independent cells use this module. Arguments without dimensions are passed on as plain
numbers, without the cost of labels.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt
import xarray as xr

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.slabs import in_slabs
from stochlin.models.parameters import Model

Cells = xr.DataArray | Array | float
"""Values of the cells of a table with labels, or the number of a single cell."""


def row_of(array: xr.DataArray, like: xr.DataArray) -> Array:
    """Values in one row, broadcast to the dimensions of ``like`` and in the order of its cells."""
    if not array.ndim:
        return np.repeat(array.to_numpy(), like.size)
    return array.broadcast_like(like).transpose(*like.dims).to_numpy().ravel()


def valid_cells(model: Model) -> Cells:
    """Whether the parameters of each cell are in range; True for scalars, which were checked before."""
    return model.valid() if any(isinstance(x, xr.DataArray) for x in model.cells().values()) else True


def cellwise(
    function: Callable[..., Any],
    *arrays: Cells,
    kinds: Sequence[npt.DTypeLike] = (float,),
    **options: Any,
) -> tuple[Any, ...]:
    """Results of a ``function`` of plain arrays for labelled arrays, which broadcast by dimension name.

    Parameters
    ----------
    function : callable
        Function of arrays, which returns an array, or a tuple of arrays for several ``kinds``. It is
        called for slabs of large tables.
    *arrays : Cells
        Labelled arrays or numbers. If all are numbers, so are the results (arrays without dimensions).
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
