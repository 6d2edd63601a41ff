"""Processes beside the page: a question can be stopped, a stubborn process is replaced, nobody waits."""

from __future__ import annotations

import dataclasses
import os
import time
from concurrent.futures import CancelledError
from typing import Any

import pytest
from browser import PATIENCE, wait
from forms import case_with, form_with

from stochlin.analyses.cases.files.schema import REGULAR
from stochlin.views.explorer import workers
from stochlin.views.explorer.workers import GAPS, GRACE, PROBABILITY, SPECTRA, Stopped, Worker

pytestmark = pytest.mark.invariant

USUAL = case_with()


def tall_case(duration):
    """Buildings of many storeys, of which the formula takes long, in motions that scatter."""
    form = form_with(
        building_1={"described": REGULAR, "storeys": 16},
        building_2={"described": REGULAR, "storeys": 12},
        motion={"duration": duration},
    )
    return dataclasses.replace(form, file={"motion": {"scatter": 0.3}}).case()


class Stubborn:
    """A subject of a question that keeps the process busy as it arrives, without a look at anything."""

    def __reduce__(self) -> Any:
        return time.sleep, (PATIENCE,)


@pytest.fixture(scope="module")
def worker():
    worker = Worker()
    worker.ask(GAPS, USUAL).answer.result(PATIENCE)  # its libraries are there
    yield worker
    worker.close()


def asked_and_begun(worker, question, subject):
    job = worker.ask(question, subject)
    wait(job.answer.running)
    return job


def test_the_formula_of_storeys_tells_how_far_it_is_and_stops_within_its_process(worker, monkeypatch):
    monkeypatch.setattr(
        workers, "GRACE", PATIENCE
    )  # a busy machine may need longer than a user would wait
    process = worker.process_id
    job = asked_and_begun(worker, PROBABILITY, tall_case(60.0))
    wait(lambda: job.share > 0)
    job.stop()
    with pytest.raises(Stopped):
        job.answer.result(PATIENCE)
    assert worker.ask(SPECTRA, USUAL).answer.result(PATIENCE)
    assert worker.process_id == process


@pytest.mark.slow
def test_a_job_that_ignores_its_stop_is_killed_and_the_process_replaced(worker):
    process = worker.process_id
    job = asked_and_begun(worker, GAPS, Stubborn())
    start = time.monotonic()
    job.stop()
    with pytest.raises(Stopped):
        job.answer.result(PATIENCE)
    assert GRACE <= time.monotonic() - start < GRACE + 1
    with pytest.raises(ProcessLookupError):
        os.kill(process, 0)
    assert worker.ask(GAPS, USUAL).answer.result(PATIENCE)
    assert worker.process_id != process


def test_a_stop_is_that_of_one_job(worker):
    first = asked_and_begun(worker, PROBABILITY, tall_case(10.0))
    second, third = worker.ask(GAPS, USUAL), worker.ask(SPECTRA, USUAL)
    second.stop()
    first.stop()
    with pytest.raises((Stopped, CancelledError)):
        first.answer.result(PATIENCE)
    with pytest.raises(CancelledError):
        second.answer.result(PATIENCE)
    assert "psd_ground" in third.answer.result(PATIENCE)
    third.stop()  # too late to mean anything
    assert worker.ask(GAPS, USUAL).answer.result(PATIENCE)


def test_what_a_question_raises_is_raised_with_where_it_was(worker):
    with pytest.raises(ValueError, match="the case has no record") as raised:
        worker.ask("records", USUAL).answer.result(PATIENCE)
    assert "in recorded" in raised.value.__notes__[0]


@pytest.mark.slow
def test_a_process_that_ends_by_itself_is_told_and_replaced(worker):
    job = asked_and_begun(worker, GAPS, Stubborn())
    os.kill(worker.process_id, 9)
    with pytest.raises(RuntimeError, match=r"has ended \(exit code -9\), perhaps for want of memory"):
        job.answer.result(PATIENCE)
    assert worker.ask(GAPS, USUAL).answer.result(PATIENCE)


def test_closing_returns_at_once_and_leaves_no_process():
    worker = Worker()
    process = worker.process_id
    running, queued = worker.ask(GAPS, Stubborn()), worker.ask(GAPS, USUAL)
    wait(running.answer.running)
    start = time.monotonic()
    worker.close()
    assert time.monotonic() - start < 0.1
    for job in (running, queued, worker.ask(GAPS, USUAL)):
        with pytest.raises((Stopped, CancelledError)):
            job.answer.result(PATIENCE)

    def gone() -> bool:
        try:
            os.kill(process, 0)
        except ProcessLookupError:
            return True
        return False

    wait(gone)
