"""The command line: the commands of all rooms and those of installed packages.

Libraries are imported inside the commands: ``stochlin --help`` should not wait for them.
"""

from __future__ import annotations

import atexit
import io
import os
import re
import signal
import sys
from typing import Any

import click

from stochlin._version import __version__
from stochlin.removed import REMOVED, instead_of
from stochlin.views.shared.progress import compiling_message
from stochlin.views.shared.screen import (
    COMMANDS,
    SPELLED,
    warnings_as_sentences,
)

# Words in a refusal of click, but for values of keys, which may be known there: = 'fitted'.
NAMES_IN_REFUSAL = re.compile(r"(?<!= ')(?<!\[')(?<=')[^' ]+(?=')|--[\w-]+")
BY_SIGNAL = 128  # shells add the number of the signal that ended a program
CONTEXT = {"help_option_names": ["-h", "--help"], "max_content_width": 100}


class Commands(click.Group):
    """The commands; they are imported when the first is used."""

    def main(self, *args: Any, **kwargs: Any) -> Any:
        """Run the command, with warnings in sentences; signs the output lacks are spelled out."""
        for stream in (sys.stdout, sys.stderr):
            if isinstance(stream, io.TextIOWrapper):
                stream.reconfigure(errors=SPELLED)
        with warnings_as_sentences():
            return super().main(*args, **kwargs)

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        """The program: one that is interrupted does not wait for what its threads still compute."""
        signal.signal(signal.SIGTERM, lambda number, _: sys.exit(BY_SIGNAL + number))
        try:
            return super().__call__(*args, **kwargs)
        except SystemExit as end:
            if isinstance(end.code, int) and end.code > BY_SIGNAL:
                sys.stdout.flush()
                atexit._run_exitfuncs()  # which remove temporary folders
                os._exit(end.code)
            raise

    def invoke(self, ctx: click.Context) -> Any:
        """The command; Ctrl-C ends it with the exit status that shells know."""
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt:
            click.echo("\ninterrupted", err=True)
            ctx.exit(BY_SIGNAL + signal.SIGINT)
        except click.UsageError as error:
            names = [name for name in NAMES_IN_REFUSAL.findall(error.message) if name in REMOVED]
            if not names or instead_of(names[0]) in f"{error.message}; ":
                raise
            said = f"{error.message.removesuffix('.')}; {instead_of(names[0])[:-2]}"
            raise click.UsageError(said, error.ctx) from error


@click.group(cls=Commands, commands=COMMANDS, context_settings=CONTEXT)
@click.version_option(__version__, prog_name="stochlin")
def main() -> None:
    """Correlation and separation of neighbouring yielding buildings."""
    context = click.get_current_context()
    context.with_resource(compiling_message(context))
