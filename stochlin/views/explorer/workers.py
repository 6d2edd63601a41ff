"""Processes beside the page for calculations that take too long for a slider."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from multiprocessing.connection import wait
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Mapping

    from stochlin.analyses.explorer.scene import Scene

RUNNING, SHARE, STOPPED = range(3)  # on the board: a job, how far it is, the job to be stopped
CORRELATION, GAPS, PROBABILITY, SPECTRA = "correlation", "gaps", "probability", "spectra"
SIMULATIONS, GROUND, RECORDS, OPEN = "simulations", "ground", "records", "open"
EVERY_JOB = -1.0
_board: Any = None  # of this process, if it is a worker


class Stopped(Exception):  # noqa: N818 (no error: it was asked for)
    """A simulation that was told to stop."""


class Job(NamedTuple):
    """A question that a worker has been asked."""

    number: int
    answer: Future[Any]
    board: Any

    @property
    def share(self) -> float:
        """The share that is done; 0 while it waits for its turn."""
        return float(self.board[SHARE]) if self.board[RUNNING] == self.number else 0.0

    def stop(self) -> None:
        """Drop the question, or stop its simulation when it next tells how far it is."""
        if not self.answer.cancel():
            self.board[STOPPED] = self.number


class Worker:
    """One process, which answers one question after the other."""

    def __init__(self) -> None:
        self._context = multiprocessing.get_context("spawn")  # numba's threads do not survive a fork
        self._board = self._context.Array("d", 3)
        self._count = 0
        self.closed = False
        self._pool = self._start()

    def ask(self, question: str, scene: Scene | Mapping[str, bytes]) -> Job:
        """Put a question about a scene, or about files of which one is to be; cancelled once closed."""
        self._count += 1
        if self.closed:
            answer: Future[Any] = Future()
            answer.cancel()
            return Job(self._count, answer, self._board)
        try:
            answer = self._pool.submit(_answer, self._count, question, scene)
        except BrokenProcessPool:  # the process was killed, for want of memory perhaps
            self._pool = self._start()
            answer = self._pool.submit(_answer, self._count, question, scene)
        return Job(self._count, answer, self._board)

    def close(self) -> None:
        """Stop what is running, and take no other question."""
        self.closed = True
        self._board[STOPPED] = EVERY_JOB
        self._pool.shutdown(cancel_futures=True)  # waits, as the exit would, which may race with it

    def _start(self) -> ProcessPoolExecutor:
        return ProcessPoolExecutor(1, self._context, _begin, (self._board,))


def _begin(board: Any) -> None:
    """In the worker: share the board; leave Ctrl+C to the page, and end with it."""
    global _board  # noqa: PLW0603 (a process is given it once, at its start)
    _board = board
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_the_page, daemon=True).start()


def _end_with_the_page() -> None:
    page = multiprocessing.parent_process()
    if page is not None:
        wait([page.sentinel])
        os._exit(0)


def _answer(number: int, question: str, scene: Any) -> Any:
    from stochlin.analyses.explorer import formulas
    from stochlin.analyses.explorer.case_scene import open_case
    from stochlin.analyses.explorer.simulations import simulations

    _board[RUNNING], _board[SHARE] = number, 0.0

    def progress(share: float) -> None:
        if _board[STOPPED] in (number, EVERY_JOB):
            raise Stopped
        _board[SHARE] = share

    if question == OPEN:
        return open_case(scene)
    if question == SPECTRA:
        return formulas.spectra(scene)
    if question == GAPS:
        return formulas.gap_rules(scene)
    if question == RECORDS:
        return formulas.recorded(scene)
    if question == GROUND:
        return scene.settle(progress)
    long = {
        CORRELATION: formulas.correlation,
        PROBABILITY: formulas.probability,
        SIMULATIONS: simulations,
    }
    return long[question](scene, progress)
