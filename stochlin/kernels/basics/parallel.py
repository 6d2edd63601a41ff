"""Tasks run on all cores in threads, with their results in order."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from typing import TypeVar

Result = TypeVar("Result")
Progress = Callable[[float], None]
"""A function that is called with the share of the work that is done, from 0 to 1."""


def cores() -> int:
    """Number of processor cores this process may use; what is not compiled uses one at a time."""
    from stochlin.kernels.basics.compiled import UNCOMPILED  # which imports the compiler

    if UNCOMPILED:
        return 1
    with suppress(AttributeError):  # the function is missing on macOS and Windows
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def part_of(progress: Progress | None, begin: float, end: float) -> Progress:
    """Progress of a part of the work, from the share ``begin`` of the whole to ``end``."""
    return lambda share: progress(begin + (end - begin) * share) if progress else None


def in_order(
    task: Callable[[int], Result], count: int, progress: Progress | None = None
) -> Iterator[Result]:
    """Results of ``task(0)`` to ``task(count - 1)`` in this order, computed on all cores."""
    pool = ThreadPoolExecutor(cores())
    try:
        for done, result in enumerate(pool.map(task, range(count)), start=1):
            yield result
            if progress is not None:
                progress(done / count)
    finally:
        # After an interrupt, do not wait for the rest.
        pool.shutdown(wait=False, cancel_futures=True)
