"""Functions of large tables, computed in contiguous pieces (slabs) that fit the processor's cache.

They run on one core: numpy's short operations on a slab would wait for one another in threads.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from stochlin.kernels.basics.arrays import Array

CHUNK = 8192  # cells of a slab


def in_slabs(
    function: Callable[..., Any], *inputs: Array, kinds: Sequence[npt.DTypeLike] = (float,)
) -> tuple[Array, ...]:
    """Results of ``function`` for inputs that broadcast, without temporary arrays of the table's size.

    The function is called for slabs of about `CHUNK` cells. It returns an array, or a tuple with one for
    each data type of ``kinds``.
    """
    shape = np.broadcast_shapes(*{array.shape for array in inputs})
    inputs = tuple(array.reshape((1,) * (len(shape) - array.ndim) + array.shape) for array in inputs)
    results = tuple(np.empty(shape, kind) for kind in kinds)
    for slab in _slabs(shape, CHUNK):
        outputs = function(*(_cut(slab, array) for array in inputs))
        outputs = outputs if isinstance(outputs, tuple) else (outputs,)
        for result, output in zip(results, outputs, strict=True):
            result[slab] = output
    return results


def in_ranges(task: Callable[[slice], Any], cells: int, size: int = CHUNK) -> list[Any]:
    """Results of a task for each range of ``size`` of the cells; for no cells, of an empty range."""
    return [task(slice(begin, min(begin + size, cells))) for begin in range(0, max(cells, 1), size)]


def _slabs(shape: tuple[int, ...], cells: int) -> Iterator[tuple[slice, ...]]:
    """Indices of contiguous slabs of an array of this shape, with at most ``cells`` cells each."""
    inner, axis = 1, len(shape)
    while axis > 0 and inner * shape[axis - 1] <= cells:
        axis -= 1
        inner *= shape[axis]
    whole = (slice(None),) * (len(shape) - axis)
    if axis == 0:
        yield whole
        return
    step = max(1, cells // inner)
    for lead in np.ndindex(*shape[: axis - 1]):
        for begin in range(0, shape[axis - 1], step):
            yield (*(slice(i, i + 1) for i in lead), slice(begin, begin + step), *whole)


def _cut(slab: tuple[slice, ...], array: Array) -> Array:
    """The slab of an array that broadcasts to the table: dimensions of length 1 are taken whole."""
    return array[tuple(slice(None) if n == 1 else s for s, n in zip(slab, array.shape, strict=False))]
