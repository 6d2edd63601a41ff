"""The output of commands: tables as text, and errors in one sentence."""

from __future__ import annotations

import codecs
import math
import textwrap
import warnings
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from contextlib import contextmanager
from functools import cache, partial
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from stochlin.messages import (
    FULL,
    LONGEST_MESSAGE,
    DoubtfulInput,
    as_written,
    brief,
    plain,
    sentence,
)
from stochlin.registry import Registry
from stochlin.views.shared.blocks import (
    LETTERS,
    PICTURE_FORMATS,
    Block,
    Items,
    TableBlock,
    TextBlock,
    ViewSection,
)

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

    Draw = Callable[[xr.Dataset], Figure]


def _check_command(command: Any) -> None:
    if not isinstance(command, click.Command):
        raise ValueError(f"command {brief(command)}; allowed: a function below @click.command()")


COMMANDS: Registry[click.Command] = Registry(
    "command", "stochlin.views", "command", check=_check_command
)
SCREEN_ROWS = 40
SCREEN_WIDTH = 100
FILE_PATH = click.Path(dir_okay=False, path_type=Path)
# Consoles that know few signs are still about.
PLAIN = {ord("\N{MINUS SIGN}"): "-", ord("\N{EN DASH}"): "-", ord("\N{NO-BREAK SPACE}"): " "}
PLAIN |= {ord("²"): "^2", ord("³"): "^3"}
QUOTE = "'"
SPELLED = "spelled out"  # what a stream does with signs that its encoding does not have


def _spelled(error: UnicodeError) -> tuple[str, int]:
    """Words for signs that cannot be encoded, as `codecs.register_error` asks for it."""
    if not isinstance(error, UnicodeEncodeError):
        raise error
    signs = error.object[error.start : error.end]
    return "".join(PLAIN.get(ord(sign), LETTERS.get(sign, "?")) for sign in signs), error.end


codecs.register_error(SPELLED, _spelled)


@contextmanager
def bad_input(**called: str) -> Iterator[None]:
    """Show an error of the input in one sentence with exit status 2, failed work with status 1.

    Arguments that an error names are written as options, by the names in ``called`` if these
    differ.
    """
    try:
        yield
    except BrokenPipeError:
        raise  # whoever reads has seen enough; click ends quietly
    except (ValueError, TypeError, OSError, MemoryError) as error:
        message = sentence(error, LONGEST_MESSAGE)
        options = _options() | called
        message = as_written(message, options, _as_option)
        subject, _, others = message.partition(" = ")
        message = f"{options[subject]} {others}" if subject in options else message
        if isinstance(error, OSError) and error.errno in FULL:
            raise click.ClickException(message) from error
        raise click.UsageError(message) from error
    except (ArithmeticError, RuntimeError, ImportError) as error:
        raise click.ClickException(sentence(error, LONGEST_MESSAGE)) from error


def _options() -> dict[str, str]:
    """The options of the command that runs, by the names of their arguments."""
    context = click.get_current_context(silent=True)
    parameters = context.command.params if context else []
    return {
        str(parameter.name): parameter.opts[0]
        for parameter in parameters
        if parameter.opts[0].startswith("--")
    }


def _as_option(option: str, value: str | None) -> str:
    """An option with its value, if that is known."""
    return option if value is None else f"{option} {value.strip(QUOTE)}"


@contextmanager
def warnings_as_sentences() -> Iterator[None]:
    """Show warnings on the error stream, each once, on a line and without its place in the code."""
    with warnings.catch_warnings():
        warnings.simplefilter("always", DoubtfulInput)
        say_once = cache(lambda text: click.echo(f"Warning: {text}", err=True))
        warnings.showwarning = lambda message, *_, **__: say_once(plain(message, LONGEST_MESSAGE))
        yield


def check_target(
    option: str, path: Path | None, allowed: Collection[str], inputs: Iterable[Path] = ()
) -> None:
    """Raise before the work for a file that could not be written after it, or that is an input."""
    from stochlin.files.storage import CSV, written_file

    if path is None:
        return
    if path.suffix.lower() not in allowed:
        what = f"{option} {path} ends in {brief(path.suffix)}"
        raise ValueError(f"{what}; allowed: {' or '.join(allowed)}")
    try:
        target = written_file(path)
    except OSError as error:
        raise ValueError(f"{option} {error}") from error
    for source in inputs:
        of_tables = source.is_dir() and path.suffix.lower() == CSV  # a folder whose tables are read
        written = target.parent if of_tables else target
        if target.exists() and source.exists() and written.samefile(source):
            raise ValueError(
                f"{option} {path} would overwrite the input {source}; give another name"
            )


def data_target(
    out: Path | None, picture: Path | None, allowed: Sequence[str], inputs: Iterable[Path] = ()
) -> Path | None:
    """Where the data go, where asked for or beside the picture; raises as `check_target`."""
    data = out if out or not picture else picture.with_suffix(allowed[0])
    check_target("--out" if out else "--picture", data, allowed, inputs)
    check_target("--picture", picture, PICTURE_FORMATS, inputs)
    return data


def write(
    table: xr.Dataset, out: Path | None, picture: Path | None = None, draw: Draw | None = None
) -> None:
    """Save the table, and the picture drawn of it, each where it is asked for."""
    from stochlin.files.storage import save_table
    from stochlin.views.shared.style import save

    if out is not None:
        save_table(table, out)
        click.echo(f"saved {out}")
    if picture is not None and draw is not None:
        save(draw(table), picture)
        click.echo(f"saved {picture}")


def show(lines: Iterable[str]) -> None:
    """Print lines with signs that every console knows."""
    for line in lines:
        click.echo(line.translate(PLAIN))


def lines(sections: Iterable[ViewSection], details: bool = False) -> list[str]:
    """Sections as text: a line without text between them, and around every table."""
    shown: list[str] = []
    for section in sections:
        written = [line for block in section.blocks for line in _written(block)]
        if section.on_screen and written and (details or not section.detail):
            shown += ["", *([f"{section.title}:"] if section.title else []), *written]
    apart = [line for before, line in pairwise(["", *shown]) if before or line]
    return apart if apart[-1] else apart[:-1]


def _written(block: Block) -> list[str]:
    """The lines of a block; pictures and names with their meaning are for pages."""
    if isinstance(block, TextBlock):
        return textwrap.wrap(block.text, SCREEN_WIDTH)
    if isinstance(block, Items):
        fill = partial(
            textwrap.wrap, width=SCREEN_WIDTH, initial_indent="  ", subsequent_indent="    "
        )
        return [line for text in block.texts for line in fill(text)]
    return _columns(block) if isinstance(block, TableBlock) and block.rows else []


def _columns(table: TableBlock) -> list[str]:
    """The first column and those of words to the left, the others to the right."""
    rows = [table.heads, *(row.cells for row in table.rows)]
    columns: list[list[str]] = []
    for head, texts in zip(table.heads, zip(*rows, strict=True), strict=True):
        cells = [text.translate(PLAIN) for text in texts]  # as wide as they are when shown
        wide = max(map(len, cells))
        left = not columns or head in table.words
        columns.append([cell.ljust(wide) if left else cell.rjust(wide) for cell in cells])
    across = [*zip(*columns, strict=True)]
    loose = ["  ".join(cells).rstrip() for cells in across]
    close = [" ".join(cells).rstrip() for cells in across]
    fitting = close if max(map(len, close)) <= SCREEN_WIDTH < max(map(len, loose)) else loose
    return ["", *fitting, ""]


def on_screen(table: xr.Dataset) -> str:
    """The table as text: a row a cell, cut where a screen ends; a single cell as a row a number."""
    from stochlin.files.storage import in_rows

    shown = table[[name for name in table.data_vars if not str(name).startswith("yield")]]
    digits: Any = {"float_format": lambda x: f"{x:.3g}"}
    if not shown.sizes:
        cell = in_rows(shown.expand_dims("case")).drop(columns="case").iloc[0]
        return str(cell.to_string(**digits))
    more = math.prod(shown.sizes.values()) - SCREEN_ROWS
    text = in_rows(shown.head(SCREEN_ROWS)).head(SCREEN_ROWS).to_string(index=False, **digits)
    return text if more <= 0 else f"{text}\n# ... {more} more rows; --out saves all"
