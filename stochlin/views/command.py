"""The command line: the commands of all rooms and those of installed packages.

Libraries are imported inside the commands: ``stochlin --help`` should not wait for them.
"""

from __future__ import annotations

import io
import os
import re
import sys
from typing import Any

import click

from stochlin._version import __version__
from stochlin.removed import REMOVED, instead_of
from stochlin.views.shared.screen import (
    COMMANDS,
    SPELLED,
    bad_input,
    compiling_told,
    warnings_as_sentences,
)

NAMED = re.compile(r"(?<=')[^' ]+(?=')|--[\w-]+")  # in a refusal of click
INTERRUPTED = 130  # as shells have it: 128 and the number of the signal
CONTEXT = {"help_option_names": ["-h", "--help"], "max_content_width": 100}


class Commands(click.Group):
    """The commands; they are imported when the first is used."""

    def main(self, *args: Any, **kwargs: Any) -> Any:
        """Run the command, with signs that the output cannot show spelled out."""
        for stream in (sys.stdout, sys.stderr):
            if isinstance(stream, io.TextIOWrapper):
                stream.reconfigure(errors=SPELLED)
        return super().main(*args, **kwargs)

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        """The program: one that is interrupted does not wait for what its threads still compute."""
        try:
            return super().__call__(*args, **kwargs)
        except SystemExit as end:
            if end.code == INTERRUPTED:
                sys.stdout.flush()
                os._exit(INTERRUPTED)
            raise

    def invoke(self, ctx: click.Context) -> Any:
        """The command; Ctrl-C ends it with the exit status that shells know."""
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt:
            click.echo("\ninterrupted", err=True)
            ctx.exit(INTERRUPTED)
        except click.UsageError as error:
            names = [name for name in NAMED.findall(error.message) if name in REMOVED]
            if not names or instead_of(names[0]) in f"{error.message}; ":
                raise
            said = f"{error.message.removesuffix('.')}; {instead_of(names[0])[:-2]}"
            raise click.UsageError(said, error.ctx) from error

    def list_commands(self, ctx: click.Context) -> list[str]:
        """All by name."""
        with bad_input():
            return super().list_commands(ctx)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """The one of this name."""
        with bad_input():
            return super().get_command(ctx, cmd_name)


@click.group(cls=Commands, commands=COMMANDS, context_settings=CONTEXT)
@click.version_option(__version__, prog_name="stochlin")
def main() -> None:
    """Correlation and separation of neighbouring yielding buildings."""
    for kept in (warnings_as_sentences(), compiling_told()):
        click.get_current_context().with_resource(kept)
