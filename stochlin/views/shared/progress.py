"""How far a command is: a bar with the time that is left, on terminals."""

from __future__ import annotations

import math
import sys
import time
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from functools import cache
from typing import Any

import click

from stochlin.messages import WHEN_COMPILING

BAR_STEPS = 1000  # of a bar
WITHOUT_ESTIMATE = 1.0  # s, in which no time is foretold
MINUTE = 60.0  # s
QUIET = "stochlin.quiet"  # whether no progress is shown, among what click keeps for a command
COMPILING = (
    "compiling for this machine, once: up to half a minute ('stochlin warmup' does it for all)"
)


def quiet_option(command: Callable[..., Any]) -> Callable[..., Any]:
    """The option of a command that shows its progress not to do so."""

    def take(context: click.Context, _: click.Parameter, value: bool) -> None:
        context.meta[QUIET] = value

    text = "Show neither progress nor that code is compiled."
    return click.option("--quiet", is_flag=True, expose_value=False, callback=take, help=text)(
        command
    )


class TimeLeft:
    """The time that is left, by the work done in the second half of the time so far.

    The first half counts no more, for in it code is compiled and files are read.
    """

    def __init__(self) -> None:
        self._begin = time.monotonic()
        self._reports: deque[tuple[float, float]] = deque()

    def after(self, share: float) -> float:
        """The seconds left after this share of the work; infinite if that cannot be said."""
        now = time.monotonic() - self._begin
        self._reports.append((now, share))
        while len(self._reports) > 2 and self._reports[1][0] <= now / 2:
            self._reports.popleft()
        begin, before = self._reports[0]
        if now < WITHOUT_ESTIMATE or share <= before:
            return math.inf
        return (1 - share) * (now - begin) / (share - before)


def in_words(seconds: float) -> str:
    """A time that is left; empty if it is not known."""
    if not math.isfinite(seconds):
        return ""
    if seconds < MINUTE:
        return f"{math.ceil(seconds)} s left"
    return f"{math.ceil(seconds / MINUTE)} min left"


@contextmanager
def progress_bar(
    label: str, doing: Callable[[], str] | None = None
) -> Iterator[Callable[[float], None]]:
    """A bar on the error stream, from the first call on with the share of the work that is done.

    It also shows the time that is left, and what ``doing`` returns. Without a terminal, and with
    ``--quiet``, nothing is shown.
    """
    if not sys.stderr.isatty() or click.get_current_context().meta.get(QUIET):
        yield lambda share: None
        return
    left = TimeLeft()
    with ExitStack() as shown:
        bar = click.progressbar(
            length=BAR_STEPS,
            label=label,
            file=sys.stderr,
            show_eta=False,
            item_show_func=lambda text: text,
        )

        def progress(share: float) -> None:
            if not bar.entered:  # what is refused before the work has no bar
                shown.enter_context(bar)
            words = (doing() if doing else "", in_words(left.after(share)) if share < 1 else "")
            bar.update(int(BAR_STEPS * share) - bar.pos, ", ".join(filter(None, words)))
            bar.render_progress()

        yield progress


@contextmanager
def compiling_message(context: click.Context) -> Iterator[None]:
    """Say on the error stream, once, when code has to be compiled."""
    say_once = cache(lambda: None if context.meta.get(QUIET) else click.echo(COMPILING, err=True))
    WHEN_COMPILING.append(say_once)
    try:
        yield
    finally:
        WHEN_COMPILING.remove(say_once)
