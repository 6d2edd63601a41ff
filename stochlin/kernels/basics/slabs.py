"""Functions of large tables, computed in contiguous pieces (slabs) that fit the processor's cache.

They run on one core: numpy's short operations on a slab would wait for one another in threads.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from functools import partial, wraps
from typing import Any

import numpy as np
import numpy.typing as npt

from stochlin.kernels.basics.arrays import Array

CHUNK = 8192  # cells of a slab


def in_slabs(
    function: Callable[..., Any],
    *inputs: Array,
    kinds: Sequence[npt.DTypeLike] = (float,),
    cells: int = CHUNK,
) -> tuple[Array, ...]:
    """Results of ``function`` for inputs that broadcast, without temporary arrays of the table's size.

    The function is called for slabs of about ``cells`` cells. It returns one array for each data type of
    ``kinds``: the array itself for one type, a tuple for several.
    """
    shape = np.broadcast_shapes(*{array.shape for array in inputs})
    results = tuple(np.empty(shape, kind) for kind in kinds)
    padded = [array.reshape((1,) * (len(shape) - array.ndim) + array.shape) for array in inputs]
    small = math.prod(shape) <= cells
    for slab in [(slice(None),) * len(shape)] if small else _slabs(shape, cells):
        outputs = function(*(padded if small else (array[_clip(slab, array.shape)] for array in padded)))
        for result, output in zip(results, outputs if len(kinds) > 1 else (outputs,), strict=True):
            result[slab] = output
    return results


def by_slabs(*kinds: npt.DTypeLike) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Decorator of a function of arrays that broadcast, which is then called slab by slab.

    It returns an array for each of the ``kinds``, the array itself for one; its options are keywords.
    """

    def decorate(function: Callable[..., Any]) -> Callable[..., Any]:
        @wraps(function)
        def whole(*inputs: Array, **options: Any) -> Any:
            results = in_slabs(partial(function, **options), *inputs, kinds=kinds)
            return results if len(kinds) > 1 else results[0]

        return whole

    return decorate


def in_ranges(task: Callable[[slice], Any], cells: int, size: int) -> list[Any]:
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


def _clip(slab: tuple[slice, ...], shape: tuple[int, ...]) -> tuple[slice, ...]:
    """The slab's index into an input that broadcasts: dimensions of length 1 are taken whole."""
    return tuple(slice(None) if n == 1 else s for s, n in zip(slab, shape, strict=True))
