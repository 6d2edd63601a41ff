"""A process beside the page for calculations that take too long for a slider."""

from __future__ import annotations

import asyncio
import multiprocessing
import signal
import tempfile
import time
import traceback
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable
    from multiprocessing.connection import Connection
    from multiprocessing.context import SpawnProcess

LOOK = 0.05  # s between two looks at what the process tells
GRACE = 0.5  # s that a question may take to stop by itself, before its process is killed
# A second thread of linear algebra doubles the processor time of matrices as small as these.
ONE_THREAD = dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"), "1")


class Stopped(Exception):  # noqa: N818 (no error: it was asked for)
    """A calculation that was told to stop."""


@dataclass
class Job:
    """Whether the answer to a question is still wanted, and the share of its work that is done."""

    wanted: bool = True
    share: float = 0.0


class Worker:
    """One process, which answers one question after the other.

    A process that does not stop is killed, and the next question starts another one.
    """

    def __init__(self) -> None:
        self.process: SpawnProcess | None = None
        self._context = multiprocessing.get_context("spawn")  # numba's threads do not survive a fork
        self._turn = asyncio.Lock()

    async def answer(self, job: Job, question: Callable[..., Any], *subject: Any) -> Any:
        """What a function of these arguments and of ``progress`` returns; raises what it raises.

        Raises `Stopped` once the job is not wanted any more.
        """
        async with self._turn:
            if not job.wanted:
                raise Stopped
            if self.process is None or not self.process.is_alive():
                self.process = self._start()
            try:
                self._pipe.send((question, subject))
                answer, failure = await self._reply(job)
            except BaseException as error:  # also that the page ends
                self.process.kill()
                self.process.join()
                self._pipe.close()
                if not isinstance(error, (EOFError, OSError)):
                    raise
                what = f"the process that computes has ended (exit code {self.process.exitcode})"
                raise RuntimeError(
                    f"{what}; ask again, with fewer storeys or a shorter motion"
                ) from error
        if failure is not None:
            raise failure
        return answer

    def _start(self) -> SpawnProcess:
        self._pipe, other = self._context.Pipe()
        arguments = other, tempfile.gettempdir()
        process = self._context.Process(target=_answer_questions, args=arguments, daemon=True)
        process.start()
        other.close()  # so that the end of the process ends the pipe
        return process

    async def _reply(self, job: Job) -> tuple[Any, Exception | None]:
        """What the process tells at last: the answer, or why there is none."""
        until = float("inf")
        while True:
            if self._pipe.poll():
                message = self._pipe.recv()
                if isinstance(message, tuple):
                    return message
                job.share = message
                continue
            if not job.wanted and until == float("inf"):
                self._pipe.send(None)
                until = time.monotonic() + GRACE
            if time.monotonic() > until:
                raise Stopped
            await asyncio.sleep(LOOK)


def _answer_questions(pipe: Connection, folder: str) -> None:
    """In the process: answer what comes through the pipe; leave Ctrl+C to the page."""
    tempfile.tempdir = folder  # the page's, which removes what a process has left that was killed
    signal.signal(signal.SIGINT, signal.SIG_IGN)

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
