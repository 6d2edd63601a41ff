"""The process beside the page: a question can be stopped, a stubborn process is replaced."""

from __future__ import annotations

import asyncio
import os
import tempfile
import time
from collections.abc import Callable, Coroutine
from typing import Any

import pytest
from browser import PATIENCE

from stochlin.views.explorer import workers
from stochlin.views.explorer.workers import GRACE, Job, Stopped, Worker

pytestmark = pytest.mark.invariant


def twice(number: int, progress: Any) -> int:
    return 2 * number


def patient(progress: Any) -> None:
    """Work that looks whether it is still wanted."""
    for step in range(int(PATIENCE / 0.01)):
        progress(step * 0.01 / PATIENCE)
        time.sleep(0.01)


def stubborn(progress: Any) -> None:
    """Work that never looks."""
    progress(0.1)
    time.sleep(PATIENCE)


def refuse(progress: Any) -> None:
    raise ValueError("this is refused")


def folder_of_files(progress: Any) -> str:
    return tempfile.gettempdir()


def of_worker(scenario: Callable[[Worker], Coroutine[Any, Any, None]]) -> Callable[[], None]:
    """A test of a worker that has answered once."""

    async def run() -> None:
        worker = Worker()
        try:
            assert await worker.answer(Job(), twice, 2) == 4
            await asyncio.wait_for(scenario(worker), PATIENCE)
        finally:
            worker.process.kill()

    def test_() -> None:
        asyncio.run(run())

    test_.__doc__ = scenario.__doc__
    return test_


async def begun(worker: Worker, question: Any) -> tuple[Job, asyncio.Task[Any]]:
    """A question that is being answered."""
    job = Job()
    task = asyncio.create_task(worker.answer(job, question))
    while job.share == 0:
        await asyncio.sleep(0.01)
    return job, task


@of_worker
async def test_work_stops_within_its_process(worker):
    workers.GRACE = PATIENCE  # a busy machine may need longer than a user waits
    process = worker.process.pid
    job, task = await begun(worker, patient)
    job.wanted = False
    with pytest.raises(Stopped):
        await task
    workers.GRACE = GRACE
    assert await worker.answer(Job(), twice, 3) == 6
    assert worker.process.pid == process


@of_worker
async def test_work_that_ignores_its_stop_is_killed_and_the_process_replaced(worker):
    process = worker.process.pid
    job, task = await begun(worker, stubborn)
    start, job.wanted = time.monotonic(), False
    with pytest.raises(Stopped):
        await task
    assert GRACE <= time.monotonic() - start < GRACE + 1
    with pytest.raises(ProcessLookupError):
        os.kill(process, 0)
    assert await worker.answer(Job(), folder_of_files) == tempfile.gettempdir()
    assert worker.process.pid != process


@of_worker
async def test_what_a_question_raises_is_raised_with_where_it_was(worker):
    with pytest.raises(ValueError, match="this is refused") as raised:
        await worker.answer(Job(), refuse)
    assert "in refuse" in raised.value.__notes__[0]


@of_worker
async def test_a_process_that_ends_by_itself_is_replaced(worker):
    _, task = await begun(worker, stubborn)
    os.kill(worker.process.pid, 9)
    with pytest.raises(RuntimeError, match=r"has ended \(exit code -9\); ask again"):
        await task
    assert await worker.answer(Job(), twice, 3) == 6
