"""Writing a record as a PEER AT2 file."""

from __future__ import annotations

import os

import numpy as np
import xarray as xr

from stochlin.analyses.records.files import METRES
from stochlin.analyses.records.records import checked_record
from stochlin.analyses.tables.checks import as_path
from stochlin.analyses.tables.storage import whole_file
from stochlin.messages import plain

_IN_A_LINE = 5


def to_at2(record: xr.DataArray, path: str | os.PathLike[str]) -> None:
    """Write a record as a PEER AT2 file, which `read_record` and programs for dynamic analysis read.

    Parameters
    ----------
    record : xarray.DataArray
        Ground acceleration [m/s^2] over ``time`` [s], as from `read_record`, or one motion from
        `simulated_motions`. In the file its time starts at zero.
    path : str or path
        Path of the file. An existing file is replaced; if an error occurs, it is kept.

    Returns
    -------
    None
        The result is the file.

    Raises
    ------
    ValueError, TypeError
        If the record is not valid.
    OSError
        If the file cannot be written.

    Notes
    -----
    Accelerations are written in g, with eight digits. The second line is the attribute ``source``.

    Examples
    --------
    >>> import tempfile, pathlib
    >>> import stochlin as sl
    >>> motion = sl.simulated_motions(sl.named_ground("firm", 0.01), 10.0, paths=2)[0]
    >>> path = pathlib.Path(tempfile.mkdtemp()) / "motion.at2"
    >>> sl.to_at2(motion, path)
    >>> bool(abs(sl.read_record(path) - motion).max() < 1e-6)
    True
    """
    values, dt = checked_record(record)
    path = as_path("path", path)
    in_g = values / METRES["g"]
    rows = (in_g[n : n + _IN_A_LINE] for n in range(0, in_g.size, _IN_A_LINE))
    head = [
        "GROUND MOTION IN THE FORMAT OF PEER AT2 FILES",
        plain(record.attrs.get("source", "a record")),
        "ACCELERATION TIME SERIES IN UNITS OF G",
        f"NPTS= {in_g.size:6d}, DT= {np.format_float_positional(dt, precision=12)} SEC",
    ]
    lines = [*head, *("".join(f"{value:16.7E}" for value in row) for row in rows)]
    with whole_file(path) as unfinished:
        unfinished.write_text("\n".join(lines) + "\n", encoding="utf-8")
