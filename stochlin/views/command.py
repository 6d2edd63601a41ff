"""The command line: the commands of all rooms, and those of installed packages.

Libraries are imported inside the commands: ``stochlin --help`` should not wait for them.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager

import click

from stochlin._version import __version__
from stochlin.views.shared.screen import COMMANDS, bad_input

CONTEXT = {"help_option_names": ["-h", "--help"], "max_content_width": 100}


@contextmanager
def warnings_as_sentences() -> Iterator[None]:
    """On the error stream, without the place in the code."""
    with warnings.catch_warnings():
        warnings.showwarning = lambda message, *_, **__: click.echo(f"Warning: {message}", err=True)
        yield


class Commands(click.Group):
    """They are looked for when one is asked for."""

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
    click.get_current_context().with_resource(warnings_as_sentences())
