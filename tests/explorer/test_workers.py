"""The process beside the page: a question can be stopped, a stubborn process is replaced."""

from __future__ import annotations

import os
import tempfile
import time
from concurrent.futures import CancelledError
from typing import Any

import pytest
from browser import PATIENCE, wait

from stochlin.views.explorer import workers
from stochlin.views.explorer.workers import GRACE, Stopped, Worker

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
    time.sleep(PATIENCE)


def refuse(progress: Any) -> None:
    raise ValueError("this is refused")


def folder_of_files(progress: Any) -> str:
    return tempfile.gettempdir()


@pytest.fixture(scope="module")
def worker():
    worker = Worker()
    assert worker.ask(twice, 2).answer.result(PATIENCE) == 4
    yield worker
    worker.close()


def asked_and_begun(worker, question):
    job = worker.ask(question)
    wait(job.answer.running)
    return job


def test_work_tells_how_far_it_is_and_stops_within_its_process(worker, monkeypatch):
    monkeypatch.setattr(workers, "GRACE", PATIENCE)  # a busy machine may need longer than a user waits
    process = worker.process_id
    job = asked_and_begun(worker, patient)
    wait(lambda: job.share > 0)
    job.stop()
    with pytest.raises(Stopped):
        job.answer.result(PATIENCE)
    assert worker.ask(twice, 3).answer.result(PATIENCE) == 6
    assert worker.process_id == process


def test_work_that_ignores_its_stop_is_killed_and_the_process_replaced(worker, monkeypatch, tmp_path):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))  # of the page, which cleans up
    process = worker.process_id
    job = asked_and_begun(worker, stubborn)
    start = time.monotonic()
    job.stop()
    with pytest.raises(Stopped):
        job.answer.result(PATIENCE)
    assert GRACE <= time.monotonic() - start < GRACE + 1
    with pytest.raises(ProcessLookupError):
        os.kill(process, 0)
    assert worker.ask(folder_of_files).answer.result(PATIENCE) == str(tmp_path)
    assert worker.process_id != process


def test_a_stop_is_that_of_one_job(worker):
    first = asked_and_begun(worker, patient)
    second, third = worker.ask(twice, 1), worker.ask(twice, 5)
    second.stop()
    first.stop()
    with pytest.raises((Stopped, CancelledError)):
        first.answer.result(PATIENCE)
    with pytest.raises(CancelledError):
        second.answer.result(PATIENCE)
    assert third.answer.result(PATIENCE) == 10
    third.stop()  # too late to mean anything
    assert worker.ask(twice, 3).answer.result(PATIENCE) == 6


def test_what_a_question_raises_is_raised_with_where_it_was(worker):
    with pytest.raises(ValueError, match="this is refused") as raised:
        worker.ask(refuse).answer.result(PATIENCE)
    assert "in refuse" in raised.value.__notes__[0]


def test_a_process_that_ends_by_itself_is_told_and_replaced(worker):
    job = asked_and_begun(worker, stubborn)
    wait(lambda: worker.process_id is not None)
    os.kill(worker.process_id, 9)
    with pytest.raises(RuntimeError, match=r"has ended \(exit code -9\), perhaps for want of memory"):
        job.answer.result(PATIENCE)
    assert worker.ask(twice, 3).answer.result(PATIENCE) == 6


def test_closing_returns_at_once_and_leaves_no_process():
    worker = Worker()
    process = worker.process_id
    running, queued = worker.ask(stubborn), worker.ask(twice, 1)
    wait(running.answer.running)
    start = time.monotonic()
    worker.close()
    assert time.monotonic() - start < 0.1
    for job in (running, queued, worker.ask(twice, 1)):
        with pytest.raises((Stopped, CancelledError)):
            job.answer.result(PATIENCE)

    def gone() -> bool:
        try:
            os.kill(process, 0)
        except ProcessLookupError:
            return True
        return False

    wait(gone)
