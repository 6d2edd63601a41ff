"""Processes beside the page for calculations that take too long for a slider."""

from __future__ import annotations

import multiprocessing
import os
import signal
import tempfile
import threading
import time
import traceback
from concurrent.futures import Future
from multiprocessing.connection import wait
from queue import SimpleQueue
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable
    from multiprocessing.connection import Connection
    from multiprocessing.context import SpawnProcess

LOOK = 0.05  # s between two looks at whether a job is still wanted
GRACE = 0.5  # s that a job may take to stop by itself, before its process is killed
# A second thread of linear algebra doubles the processor time of matrices as small as these.
ONE_THREAD = dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"), "1")


class Stopped(Exception):  # noqa: N818 (no error: it was asked for)
    """A calculation that was told to stop."""


class Job:
    """A question that a worker has been asked."""

    def __init__(self, question: Callable[..., Any], subject: tuple[Any, ...]) -> None:
        self.question, self.subject = question, subject
        self.answer: Future[Any] = Future()
        self.share = 0.0  # of the work that is done
        self.unwanted = False

    def stop(self) -> None:
        """Drop the question; one that is being answered stops, or its process is killed."""
        self.unwanted = True
        self.answer.cancel()


class Worker:
    """One process, which answers one question after the other.

    A process that does not stop is killed, and the next question starts another one.
    """

    def __init__(self) -> None:
        self._context = multiprocessing.get_context("spawn")  # numba's threads do not survive a fork
        self._jobs: SimpleQueue[Job | None] = SimpleQueue()
        self._process: SpawnProcess | None = None
        self.closed = False
        self._start()
        threading.Thread(target=self._serve, daemon=True).start()

    def ask(self, question: Callable[..., Any], *subject: Any) -> Job:
        """Have a function called with these arguments and ``progress``; cancelled once closed."""
        job = Job(question, subject)
        if self.closed:
            job.stop()
        self._jobs.put(job)
        return job

    def close(self) -> None:
        """Take no other question, and kill the process; returns at once."""
        self.closed = True
        self._jobs.put(None)
        process = self._process
        if process is not None:
            process.kill()

    @property
    def process_id(self) -> int | None:
        """Number of the process that answers, None after it was killed."""
        return None if self._process is None else self._process.pid

    def _start(self) -> None:
        self._pipe, other = self._context.Pipe()
        arguments = other, tempfile.gettempdir()
        self._process = self._context.Process(target=_answer_questions, args=arguments, daemon=True)
        self._process.start()
        other.close()  # so that the end of the process ends the pipe

    def _serve(self) -> None:
        """In a thread: have the questions answered, one after the other."""
        while (job := self._jobs.get()) is not None:
            if self.closed:
                job.stop()
            if not job.answer.set_running_or_notify_cancel():
                continue
            try:
                answer = self._ask_process(job)
            except Exception as error:
                job.answer.set_exception(error)
            else:
                job.answer.set_result(answer)

    def _ask_process(self, job: Job) -> Any:
        """The answer of the process to a question; raises what it raised there."""
        if self._process is None or not self._process.is_alive():
            self._start()
        try:
            self._pipe.send((job.question, job.subject))
            answer, failure = self._told(job)
        except (EOFError, OSError) as error:
            code = self._end()
            if self.closed:
                raise Stopped from error
            raise RuntimeError(
                f"the process that computes has ended (exit code {code}), perhaps for want of memory; "
                "ask again, with fewer simulated motions or storeys"
            ) from error
        if failure is not None:
            raise failure
        return answer

    def _told(self, job: Job) -> tuple[Any, Exception | None]:
        """What the process tells at last: the answer, or why there is none."""
        message: Any = 0.0
        until = float("inf")
        while not isinstance(message, tuple):  # but the share that is done
            job.share = message
            if job.unwanted and until == float("inf"):
                self._pipe.send(None)
                until = time.monotonic() + GRACE
            if self.closed or time.monotonic() > until:
                self._end()
                raise Stopped
            if self._pipe.poll(LOOK):
                message = self._pipe.recv()
        return message

    def _end(self) -> int | None:
        """Kill the process; its exit code."""
        assert self._process is not None
        self._process.kill()
        self._process.join()
        code, self._process = self._process.exitcode, None
        self._pipe.close()
        return code


def _answer_questions(pipe: Connection, folder: str) -> None:
    """In the process: answer what comes through the pipe; leave Ctrl+C to the page, and end with it."""
    tempfile.tempdir = folder  # the page's, which removes what a process has left that was killed
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_the_page, daemon=True).start()

    def progress(share: float) -> None:
        if pipe.poll():  # while a question is answered, only the wish to stop can come
            raise Stopped
        pipe.send(float(share))

    while True:
        message = pipe.recv()
        if message is None:  # to stop what has just been answered
            continue
        reply: tuple[Any, Exception | None]
        try:
            question, subject = message
            reply = question(*subject, progress), None
        except Exception as error:
            error.add_note(traceback.format_exc())  # which does not pass the pipe otherwise
            reply = None, error
        pipe.send(reply)


def _end_with_the_page() -> None:
    page = multiprocessing.parent_process()
    if page is not None:
        wait([page.sentinel])
        os._exit(0)
