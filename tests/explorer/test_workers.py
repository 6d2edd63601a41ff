"""The process beside the page: a question can be stopped, a stubborn process is replaced."""

from __future__ import annotations

import asyncio
import os
import tempfile
import time
from collections.abc import Callable, Coroutine
from pathlib import Path
from typing import Any

import pytest
from browser import PATIENCE

from stochlin.views.explorer import workers
from stochlin.views.explorer.workers import GRACE, Job, NoAnswer, Stopped, Worker

pytestmark = pytest.mark.invariant

HERE = Path(__file__).parent
SHADOWED = (
    "json",
    "pickle",
    "queue",
    "selectors",
    "signal",
    "socket",
    "struct",
    "threading",
    "numpy",
)


def of_worker(scenario: Callable[..., Coroutine[Any, Any, None]]) -> Callable[..., None]:
    """A test of a worker that has answered once, in a folder with modules that nobody may run."""

    def test_(
        tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
    ) -> None:
        async def run() -> None:
            worker = Worker("questions")
            try:
                assert await worker.answer(Job(), "twice", "2") == "22"
                await asyncio.wait_for(scenario(worker, caplog), PATIENCE)
            finally:
                await worker.stop()

        for name in SHADOWED:
            (tmp_path / f"{name}.py").write_text("open('RAN', 'a').write(__name__)")
        monkeypatch.chdir(tmp_path)
        monkeypatch.setenv("PYTHONPATH", os.pathsep.join(map(str, (HERE, HERE.parent))))
        asyncio.run(run())
        assert not (tmp_path / "RAN").exists()

    test_.__doc__ = scenario.__doc__
    return test_


async def begun(worker: Worker, question: str) -> tuple[Job, asyncio.Task[Any]]:
    """A question that is being answered."""
    job = Job()
    task = asyncio.create_task(worker.answer(job, question, ""))
    while job.share == 0:
        await asyncio.sleep(0.01)
    return job, task


@of_worker
async def test_work_stops_within_its_process(worker, caplog):
    workers.GRACE = PATIENCE  # a busy machine may need longer than a user waits
    process = worker.process.pid
    try:
        job, task = await begun(worker, "patient")
        job.wanted = False
        with pytest.raises(Stopped):
            await task
    finally:
        workers.GRACE = GRACE
    assert await worker.answer(Job(), "twice", "3") == "33"
    assert worker.process.pid == process


@of_worker
async def test_work_that_ignores_its_stop_is_killed_and_the_process_replaced(worker, caplog):
    process = worker.process.pid
    job, task = await begun(worker, "stubborn")
    start, job.wanted = time.monotonic(), False
    with pytest.raises(Stopped):
        await task
    assert GRACE <= time.monotonic() - start < GRACE + 1
    with pytest.raises(ProcessLookupError):
        os.kill(process, 0)
    assert await worker.answer(Job(), "folder", "") == tempfile.gettempdir()
    assert worker.process.pid != process


@of_worker
async def test_what_a_question_raises_is_said_and_a_fault_is_logged(worker, caplog):
    process = worker.process.pid
    for question, message in (("refuse", "this is refused"), ("nest", "ValueError")):
        with pytest.raises(NoAnswer) as refusal:
            await worker.answer(Job(), question, "this")
        assert str(refusal.value).startswith(message)
        assert caplog.text == ""
    with pytest.raises(NoAnswer, match="this"):
        await worker.answer(Job(), "fail", "this")
    assert "in fail" in caplog.text
    assert worker.process.pid == process


@of_worker
async def test_any_text_passes_and_what_is_printed_is_no_answer(worker, caplog):
    for text in ("[" * 100_000, "\n\r\u2028\x00", "\ud800", "a" * 2**20):
        assert await worker.answer(Job(), "talk", text) == text


@of_worker
async def test_a_process_that_ends_by_itself_is_replaced(worker, caplog):
    _, task = await begun(worker, "stubborn")
    os.kill(worker.process.pid, 9)
    with pytest.raises(NoAnswer, match=r"has ended \(exit code -9\); ask again"):
        await task
    assert await worker.answer(Job(), "twice", "3") == "33"
