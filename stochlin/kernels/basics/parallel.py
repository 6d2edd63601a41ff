"""Tasks on all cores, their results in order."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

Result = TypeVar("Result")
Progress = Callable[[float], None]
"""Called with the share of the work that is done."""


def cores() -> int:
    """Those that this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:  # neither on macOS nor on Windows
        return os.cpu_count() or 1


def in_order(
    task: Callable[[int], Result], count: int, progress: Progress | None = None
) -> Iterator[Result]:
    """Results of ``task(0), task(1), ...`` in this order, from all cores."""
    if count == 1:
        yield task(0)
        if progress is not None:
            progress(1.0)
        return
    pool = ThreadPoolExecutor(cores())
    try:
        for done, result in enumerate(pool.map(task, range(count)), start=1):
            yield result
            if progress is not None:
                progress(done / count)
    finally:
        pool.shutdown(wait=False, cancel_futures=True)  # who interrupts does not wait for the rest


def in_ranges(
    task: Callable[[slice], Result], cells: int, size: int, *, threads: bool = True
) -> list[Result]:
    """Results of a task for each range of ``size`` cells, in order; in this thread without ``threads``.

    If there are no cells, the task runs once with an empty range.
    """
    ranges = [slice(begin, min(begin + size, cells)) for begin in range(0, max(cells, 1), size)]

    def part(number: int) -> Result:
        return task(ranges[number])

    return list(in_order(part, len(ranges)) if threads else map(part, range(len(ranges))))
