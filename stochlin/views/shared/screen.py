"""What commands say: tables as text, and what went wrong in one sentence."""

from __future__ import annotations

import sys
import textwrap
import warnings
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from stochlin.messages import LONGEST_MESSAGE, DoubtfulInput, brief, plain, sentence
from stochlin.registry import Registry

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

COMMANDS: Registry[click.Command] = Registry("command", "stochlin.views", "command")
SCREEN_ROWS, WIDTH = 40, 100
STEPS = 1000  # of a bar
PICTURES = (".png", ".svg", ".pdf")
FILE = click.Path(dir_okay=False, path_type=Path)
# Consoles that know few signs are still about.
PLAIN = {ord("\N{MINUS SIGN}"): "-", ord("\N{EN DASH}"): "-", ord("\N{NO-BREAK SPACE}"): " "}
PLAIN |= {ord("²"): "^2", ord("³"): "^3"}


@contextmanager
def bad_input() -> Iterator[None]:
    """Show what is wrong with the input in one sentence, exit status 2; failed work, status 1.

    What is doubtful is shown on a line of its own.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("always", DoubtfulInput)
            warnings.showwarning = _show_warning
            yield
    except BrokenPipeError:
        raise  # whoever reads has seen enough; click ends quietly
    except (ValueError, TypeError, OSError) as error:
        raise click.UsageError(sentence(error, LONGEST_MESSAGE)) from error
    except (ArithmeticError, RuntimeError, ImportError) as error:
        raise click.ClickException(sentence(error, LONGEST_MESSAGE)) from error


def _show_warning(message: Warning | str, *_: Any, **__: Any) -> None:
    click.echo(f"Warning: {plain(message, LONGEST_MESSAGE)}", err=True)


@contextmanager
def progress_bar(label: str) -> Iterator[Callable[[float], None]]:
    """A bar on the error stream; to be called with the share of the work that is done."""
    with click.progressbar(length=STEPS, label=label, file=sys.stderr) as bar:
        yield lambda share: bar.update(int(STEPS * share) - bar.pos)


def check_target(option: str, path: Path | None, allowed: Sequence[str]) -> None:
    """Raise before the work for a file that could not be written after it."""
    if path is None:
        return
    if path.suffix.lower() not in allowed:
        raise ValueError(
            f"{option} {path} ends in {brief(path.suffix)}; allowed: {' or '.join(allowed)}"
        )
    if not path.parent.is_dir():
        raise ValueError(f"{option} {path}: there is no folder {path.parent}; make it first")


def write(
    table: xr.Dataset, out: Path | None, picture: Path | None, draw: Callable[[xr.Dataset], Figure]
) -> None:
    """Save the table, and the picture drawn of it, each where it is asked for."""
    from stochlin.analyses.tables.storage import save_table
    from stochlin.views.shared.style import save

    if out is not None:
        save_table(table, out)
        click.echo(f"saved {out}")
    if picture is not None:
        save(draw(table), picture)
        click.echo(f"saved {picture}")


def paragraph(text: str, hang: str = "") -> list[str]:
    """The lines of a text on the screen."""
    return textwrap.wrap(text, WIDTH, subsequent_indent=hang)


def show(lines: Iterable[str]) -> None:
    """Print lines with signs that every console knows."""
    for line in lines:
        click.echo(line.translate(PLAIN))


def cut(name: str, wide: int) -> str:
    """A name of at most so many characters."""
    return name if len(name) <= wide else f"{name[: wide - 3]}..."


def columns(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> list[str]:
    """A table as text: the first column to the left, the others to the right."""
    all_rows = [heads, *rows]
    wide = [max(len(row[n]) for row in all_rows) for n in range(len(heads))]
    return [
        "  ".join([row[0].ljust(wide[0]), *(row[n].rjust(wide[n]) for n in range(1, len(heads)))])
        for row in all_rows
    ]


def on_screen(table: xr.Dataset) -> str:
    """The table as text: a row a cell, flags by name, cut where a screen ends."""
    shown = table[[name for name in table.data_vars if not str(name).startswith("yield")]]
    if not shown.sizes:
        shown = shown.expand_dims("case")
    frame = shown.to_dataframe().reset_index().drop(columns="case", errors="ignore")
    for name in set(frame.columns) & set(table.data_vars):
        if "flag_meanings" in table[name].attrs:
            meanings = table[name].attrs["flag_meanings"].split()
            frame[name] = [meanings[code] for code in frame[name]]
    text = frame.head(SCREEN_ROWS).to_string(index=False, float_format=lambda x: f"{x:.6g}")
    more = len(frame) - SCREEN_ROWS
    return text if more <= 0 else f"{text}\n# ... {more} more rows; --out saves all"
