"""Functions of large tables, computed in pieces (slabs) that fit the processor's cache.

A slab of a table is about as wide as it is high: what belongs to one row or column costs little.
They run on one core: numpy's short operations on a slab would wait for one another in threads.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from itertools import product
from typing import Any

import numpy as np
import numpy.typing as npt

from stochlin.kernels.basics.arrays import Array

SLAB_CELLS = 16384  # usual number of cells of a slab
SLAB_WIDTH = 128  # of these along the last dimension, of which the others are columns


def in_slabs(
    function: Callable[..., Any], *inputs: Array, kinds: Sequence[npt.DTypeLike] = (float,)
) -> tuple[Array, ...]:
    """Results of ``function`` for inputs that broadcast, without temporary arrays of table size.

    The function is called for slabs of about `SLAB_CELLS` cells. It returns an array, or a tuple
    with one for each data type of ``kinds``.
    """
    shape = np.broadcast_shapes(*{array.shape for array in inputs})
    inputs = tuple(
        array.reshape((1,) * (len(shape) - array.ndim) + array.shape) for array in inputs
    )
    results = tuple(np.empty(shape, kind) for kind in kinds)
    for slab in _slabs(shape):
        outputs = function(*(_cut(slab, array) for array in inputs))
        outputs = outputs if isinstance(outputs, tuple) else (outputs,)
        for result, output in zip(results, outputs, strict=True):
            result[slab] = output
    return results


def in_ranges(task: Callable[[slice], Any], cells: int, size: int = SLAB_CELLS) -> list[Any]:
    """Results of a task for each range of ``size`` cells; for no cells, of an empty range."""
    return [task(slice(begin, min(begin + size, cells))) for begin in range(0, max(cells, 1), size)]


def _slabs(shape: tuple[int, ...]) -> Iterator[tuple[slice, ...]]:
    """Indices of the slabs of an array of this shape."""
    sizes = list[int]()
    left = SLAB_CELLS
    for axis in reversed(range(len(shape))):
        widest = left if sizes else max(SLAB_WIDTH, SLAB_CELLS // max(1, math.prod(shape[:axis])))
        sizes.insert(0, max(1, min(shape[axis], widest, left)))
        left //= sizes[0]
    for begins in product(*(range(0, n, size) for n, size in zip(shape, sizes, strict=True))):
        yield tuple(slice(begin, begin + size) for begin, size in zip(begins, sizes, strict=True))


def _cut(slab: tuple[slice, ...], array: Array) -> Array:
    """The slab of an array that broadcasts to the table: dimensions of length 1 are taken whole."""
    return array[
        tuple(slice(None) if n == 1 else s for s, n in zip(slab, array.shape, strict=False))
    ]
