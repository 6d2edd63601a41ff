"""The command ``stochlin explore``: a page in the browser, with a form and its answer."""

from __future__ import annotations

import tempfile
from pathlib import Path

import click

from stochlin.views.shared.screen import COMMANDS, FILE_PATH, bad_input


@COMMANDS.register("explore")
@click.command()
@click.option(
    "--case", type=FILE_PATH, help="Start from a case file like that of 'stochlin gap --example'."
)
@click.option(
    "--port",
    type=click.IntRange(1, 65535),
    default=8640,
    show_default=True,
    help="Port to listen on.",
)
@click.option(
    "--open/--no-open", "show", default=True, show_default=True, help="Open the page in a browser."
)
def explore(case: Path | None, port: int, show: bool) -> None:
    """Explore a pair of buildings interactively, in a local browser page.

    The page is served by this computer and needs no network. It opens and saves case files for
    'stochlin gap'.

    \b
    Examples:
      stochlin explore
      stochlin explore --case case.toml --port 9000 --no-open
    """
    with bad_input():
        try:
            from stochlin.views.explorer.server import check_port, serve
        except ImportError as error:
            what = "the explorer needs NiceGUI: pip install 'stochlin[app]'"
            raise ImportError(f"{what} ({error})") from error
        from stochlin.applications.cases.examples import short_example
        from stochlin.applications.explorer.uploads import of_file, uploaded
        from stochlin.files.folders import process_folder

        check_port(port)
        tempfile.tempdir = str(process_folder())  # removed with all that is left in it
        start = of_file(case) if case else uploaded({"case.toml": short_example().encode()})
        serve(start, port=port, show=show)
        start.remove()
