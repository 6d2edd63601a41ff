"""The process beside the page: it answers the questions that come in as lines of JSON.

A question is a list of its name and its texts, and ``null`` the wish that the present one stops. A
reply has the ``share`` of the work that is done, the ``answer``, or ``why`` there is none; an empty
one says that the work has stopped.
"""

from __future__ import annotations

import importlib
import json
import os
import signal
import sys
import tempfile
import traceback
from queue import SimpleQueue
from threading import Thread
from typing import Any

from stochlin.messages import LONGEST_MESSAGE, sentence

# What a case may be refused with; anything else is a fault of the program, and logged.
REFUSAL_ERRORS = (ValueError, TypeError, ArithmeticError, MemoryError, OSError)


class _Stop(Exception):  # noqa: N818
    """The answer is not wanted any more."""


def main() -> None:
    """Answer questions until the page ends; Ctrl+C is left to it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    module, folder = sys.argv[1:]
    tempfile.tempdir = folder  # the page's, which removes what a process has left that was killed
    replies = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)  # what a library prints is no reply
    questions = importlib.import_module(module).QUESTIONS
    messages: SimpleQueue[list[str] | None] = SimpleQueue()
    Thread(target=_receive, args=(messages,), daemon=True).start()

    def reply(**what: Any) -> None:
        replies.write(json.dumps(what) + "\n")
        replies.flush()

    def progress(share: float) -> None:
        if not messages.empty():  # while a question is answered, only the wish to stop can come
            raise _Stop
        reply(share=float(share))

    while True:
        message = messages.get()
        if message is None:  # to stop what has just been answered
            continue
        question, *subject = message
        try:
            answer = questions[question](*subject, progress)
        except _Stop:
            reply()
        except Exception as error:
            trace = "" if isinstance(error, REFUSAL_ERRORS) else traceback.format_exc()
            reply(why=sentence(error, LONGEST_MESSAGE), trace=trace)
        else:
            reply(answer=answer)


def _receive(messages: SimpleQueue[list[str] | None]) -> None:
    for line in sys.stdin:
        messages.put(json.loads(line))
    os._exit(0)  # the page has ended
