"""Files that are written whole or not at all."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import xarray as xr

from stochlin.messages import brief

FORMATS = (".nc", ".csv")


@contextmanager
def whole_file(path: str | os.PathLike[str]) -> Iterator[Path]:
    """A temporary path beside ``path``, renamed to it if the block ends well, removed if not."""
    target = Path(path)
    handle, name = tempfile.mkstemp(prefix=f".{target.stem}-", suffix=target.suffix, dir=target.parent)
    os.close(handle)
    temporary = Path(name)
    try:
        yield temporary
        umask = os.umask(0)
        os.umask(umask)
        temporary.chmod(0o666 & ~umask)  # mkstemp keeps others out
        temporary.replace(target)
    finally:
        temporary.unlink(missing_ok=True)


def as_netcdf(dataset: xr.Dataset) -> bytes:
    """The bytes of the netCDF file that `save_table` writes."""
    return bytes(dataset.to_netcdf(None, engine="scipy", format="NETCDF3_64BIT"))


def save_table(dataset: xr.Dataset, path: str | os.PathLike[str]) -> None:
    """Save as ``.nc`` (netCDF, with all metadata) or ``.csv`` (one row a cell)."""
    suffix = Path(path).suffix.lower()
    if suffix not in FORMATS:
        raise ValueError(
            f"path = {brief(str(path))} ends in {brief(suffix)}; allowed: {' or '.join(FORMATS)}"
        )
    with whole_file(path) as temporary:
        if suffix == ".nc":
            dataset.to_netcdf(temporary, engine="scipy", format="NETCDF3_64BIT")
        else:
            table = dataset if dataset.sizes else dataset.expand_dims("case")
            table.to_dataframe().reset_index().to_csv(temporary, index=False)
