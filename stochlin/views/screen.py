"""What commands say: tables as text, and what went wrong in one sentence."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    import xarray as xr

SCREEN_ROWS = 40


@contextmanager
def bad_input() -> Iterator[None]:
    """Show what is wrong with the input in one sentence, exit status 2; failed work, status 1."""
    try:
        yield
    except (ValueError, TypeError, OSError) as error:
        raise click.UsageError(str(error)) from error
    except (ArithmeticError, RuntimeError, ImportError) as error:
        raise click.ClickException(str(error)) from error


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
