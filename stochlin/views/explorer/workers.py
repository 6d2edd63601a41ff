"""A process beside the page for calculations that take too long for a slider.

Page and process exchange lines of JSON, which hold texts and numbers alone: whatever a case file
holds, neither can do more to the other than to say something. `answering` is the other side.
"""

from __future__ import annotations

import asyncio
import json
import logging
import tempfile
import time
from asyncio.subprocess import PIPE, Process
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

from stochlin.kernels.basics.children import command, environment

POLL_INTERVAL = 0.05  # s between two looks whether the answer is still wanted
GRACE = 0.5  # s that a question may take to stop by itself, before its process is killed
LONGEST_REPLY = 2**26  # bytes of an answer with its pictures
TIME_TO_END = 1.0  # s, in which a process that closes its output ends
ANSWERING_PROGRAM = "from stochlin.views.explorer.answering import main; main()"
# A second thread of linear algebra doubles the processor time of matrices as small as these.
ONE_THREAD = dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"), "1")
LOG = logging.getLogger("stochlin")


class Stopped(Exception):  # noqa: N818 (no error: it was wanted)
    """A calculation that was stopped, since its answer is not wanted any more."""


class NoAnswer(Exception):  # noqa: N818
    """Why a question has no answer, in a sentence."""


@dataclass
class Job:
    """Whether the answer to a question is still wanted, and the share of its work that is done."""

    wanted: bool = True
    share: float = 0.0


class Worker:
    """One process, which answers one question after the other.

    A process that does not stop is killed, and the next question starts another one. ``module`` has
    a mapping ``QUESTIONS`` of names to functions of texts and of ``progress``, which return a text.
    """

    def __init__(self, module: str) -> None:
        self.process: Process | None = None
        self._module = module
        self._turn = asyncio.Lock()

    async def answer(self, job: Job, question: str, *subject: str) -> str:
        """What the function of this name returns for these texts.

        Raises `Stopped` once the job is not wanted any more, and `NoAnswer` if there is none.
        """
        async with self._turn:
            if not job.wanted:
                raise Stopped
            if self.process is None or self.process.returncode is not None:
                self.process = await self._start()
            try:
                await self._send(self.process, [question, *subject])
                reply = await self._reply(self.process, job)
            except (EOFError, OSError) as error:
                # A signal to a process that has just ended would hide its exit code.
                with suppress(TimeoutError):
                    await asyncio.wait_for(self.process.wait(), TIME_TO_END)
                await self.stop()
                what = f"the process that computes has ended (exit code {self.process.returncode})"
                LOG.exception("no answer")
                raise NoAnswer(
                    f"{what}; ask again, with fewer storeys or a shorter motion"
                ) from error
            except BaseException:  # also that the page ends
                await self.stop()
                raise
        if "answer" in reply:
            return str(reply["answer"])
        if "why" not in reply:
            raise Stopped
        if reply["trace"]:
            LOG.error("no answer\n%s", reply["trace"])
        raise NoAnswer(reply["why"])

    async def stop(self) -> None:
        """End the process."""
        if self.process is not None:
            with suppress(ProcessLookupError):  # it has ended by itself
                self.process.kill()
            await self.process.wait()

    async def _start(self) -> Process:
        return await asyncio.create_subprocess_exec(
            *command(ANSWERING_PROGRAM, self._module, tempfile.gettempdir()),
            stdin=PIPE,
            stdout=PIPE,
            env=environment(ONE_THREAD),
            limit=LONGEST_REPLY,
        )

    async def _send(self, process: Process, message: list[str] | None) -> None:
        assert process.stdin is not None
        process.stdin.write(json.dumps(message).encode() + b"\n")
        await process.stdin.drain()

    async def _reply(self, process: Process, job: Job) -> dict[str, Any]:
        """What the process says at last; before that it says how far it is."""
        assert process.stdout is not None
        until = float("inf")
        while True:
            with suppress(TimeoutError):
                line = await asyncio.wait_for(process.stdout.readline(), POLL_INTERVAL)
                if not line:
                    raise EOFError
                reply: dict[str, Any] = json.loads(line)
                if "share" not in reply:
                    return reply
                job.share = reply["share"]
            if not job.wanted and until == float("inf"):
                await self._send(process, None)
                until = time.monotonic() + GRACE
            if time.monotonic() > until:
                raise Stopped
