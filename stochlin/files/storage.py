"""Files of results, which are written completely or not at all."""

from __future__ import annotations

import os
import stat
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import xarray as xr

from stochlin.files.folders import temporary_folder
from stochlin.messages import REASONS, brief

if TYPE_CHECKING:
    import pandas as pd

CSV = ".csv"  # a row for each cell
TABLE_FORMATS = (".nc", CSV)


def written_file(path: str | os.PathLike[str]) -> Path:
    """The file that writing to ``path`` changes; for a symbolic link, its target.

    Raises an OSError with the reason if it cannot be written, before any work is done.
    """
    target = Path(os.path.realpath(path) if os.path.islink(path) else path)
    try:
        mode = target.stat().st_mode
    except FileNotFoundError:
        mode = None
    except OSError as error:
        raise OSError(f"{path}: {error.strerror}; give another name") from error
    if mode is not None and not stat.S_ISREG(mode):
        raise OSError(f"{path} is no ordinary file; give the name of a file")
    if mode is not None and not (mode & 0o222 and os.access(target, os.W_OK)):
        raise PermissionError(f"{path} is read-only; make it writable, or give another name")
    if not target.parent.is_dir():
        raise FileNotFoundError(f"{path}: there is no folder {target.parent}; make it first")
    try:
        tempfile.TemporaryFile(dir=target.parent).close()
    except OSError as error:
        raise OSError(f"{path}: cannot write in {target.parent}: {error.strerror}") from error
    return target


@contextmanager
def whole_file(path: str | os.PathLike[str]) -> Iterator[Path]:
    """A temporary path; renamed to the file after the block, or removed after an error.

    It lies in a folder beside the file. Those that killed processes left there of the same file are
    removed.
    """
    target = written_file(path)
    try:
        with temporary_folder(target.parent, f".writing-{target.stem[:40]}-") as folder:
            temporary = folder / target.name
            yield temporary
            if target.exists():
                temporary.chmod(stat.S_IMODE(target.stat().st_mode))
            temporary.replace(target)
    except OSError as error:  # its text has no file name, or the temporary one
        failed = OSError(
            f"{path} could not be written: {REASONS.get(error.errno or 0, error.strerror or error)}"
        )
        failed.errno = error.errno
        raise failed from error


def save_table(dataset: xr.Dataset, path: str | os.PathLike[str]) -> None:
    """Save a dataset as ``.nc`` (netCDF), or as ``.csv`` (a row for each cell, no attributes)."""
    suffix = Path(path).suffix.lower()
    if suffix not in TABLE_FORMATS:
        raise ValueError(
            f"{brief(str(path))} ends in {brief(suffix)}; allowed: {' or '.join(TABLE_FORMATS)}"
        )
    with whole_file(path) as temporary:
        if suffix == ".nc":
            dataset.to_netcdf(temporary, engine="scipy", format="NETCDF3_64BIT")
        else:
            table = in_rows(dataset if dataset.sizes else dataset.expand_dims("case"))
            table.map(_no_formula).to_csv(temporary, index=False)


def _no_formula(value: Any) -> Any:
    """A text that a spreadsheet would compute, such as ``=1+1``, behind an apostrophe."""
    return (
        f"'{value}" if isinstance(value, str) and value.startswith(("=", "+", "-", "@")) else value
    )


def in_rows(table: xr.Dataset) -> pd.DataFrame:
    """Data frame with a row for each cell, with flags in words and with units in the heads."""
    frame = table.to_dataframe().reset_index()
    for name in set(frame.columns) & set(table.data_vars):
        if "flag_meanings" in table[name].attrs:
            meanings = table[name].attrs["flag_meanings"].split()
            frame[name] = [meanings[code] for code in frame[name]]
    units = {name: table[name].attrs.get("units", "1") for name in table.variables}
    heads = {name: f"{name} [{unit}]" for name, unit in units.items() if unit != "1"}
    return frame.rename(columns=heads)
