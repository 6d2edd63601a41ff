"""Pushover curves from files: base shear over the displacement of the roof."""

from __future__ import annotations

import os
import re

import numpy as np
import xarray as xr

from stochlin.applications.buildings.mode_files.csi_tables import check_one_case
from stochlin.applications.buildings.pushover import CURVE, DISPLACEMENT, OF_ROOF, checked_curve
from stochlin.applications.sheets.sheets import Table, sheets_of, table_in, with_unit
from stochlin.messages import plain
from stochlin.models.arguments import checked
from stochlin.solver.tables import labels
from stochlin.solver.tables.inputs import input_path

# Words by which the titles of the columns are known, and the quantity of each column.
TITLES = {"displacement": ("displ|roof", "length"), "force": ("shear|force", "force")}


@checked
def read_pushover(
    path: str | os.PathLike[str],
    *,
    length_units: str | None = None,
    force_units: str | None = None,
    displacement_column: int | str | None = None,
    force_column: int | str | None = None,
) -> xr.DataArray:
    r"""Read a pushover curve from a file: base shear over the displacement of the roof.

    Units are those of the file, or are given here; they are not guessed. A curve that is pushed in the
    negative direction, or whose base shear is that of the reactions, is turned to positive signs. Where
    the file begins above 0 in both, the origin is added.

    Parameters
    ----------
    path : str or path
        Path of the file: text in UTF-8 with ``,``, ``;``, tabs or spaces between its columns, or a
        workbook. Text after ``#`` at the start of a line is a comment. Lines of titles, and a line of
        units below them, may come first.
    length_units, force_units : str, optional
        Units of the displacement, ``"m"``, ``"cm"``, ``"mm"``, ``"in"`` or ``"ft"``, and of the base
        shear, ``"N"``, ``"kN"``, ``"MN"``, ``"kgf"``, ``"tonf"``, ``"lbf"`` or ``"kip"``. Not needed if
        the titles have them, as in ``base shear [kN]``, or a line below the titles.
    displacement_column, force_column : int or str, optional
        Columns by index from 0 or by title. By default those whose titles have the words displacement or
        roof, and shear or force, and without titles the first two of a file of two columns.

    Returns
    -------
    xarray.DataArray
        Base shear [N] over ``displacement``, that of the roof [m], which begins at 0.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ImportError
        If the file is a workbook and python-calamine is not installed.
    ValueError
        If a column or a unit is not known, contradicts the file or is missing, something is no number,
        there are fewer than 4 points, displacements do not increase, or the base shear is not positive
        or falls from the start. The message names the line.

    Examples
    --------
    >>> import tempfile, pathlib
    >>> import stochlin as sl
    >>> path = pathlib.Path(tempfile.mkdtemp()) / "push.csv"
    >>> rows = ["roof displacement [mm],base shear [kN]", "0,0", "20,900", "50,1300", "120,1500"]
    >>> _ = path.write_text("\n".join(rows), encoding="utf-8")
    >>> curve = sl.read_pushover(path)
    >>> curve.displacement.values.tolist(), curve.values.tolist()
    ([0.0, 0.02, 0.05, 0.12], [0.0, 900000.0, 1300000.0, 1500000.0])
    """
    path = input_path("path", path)
    name = plain(path.name)
    words = "|".join(words for words, _ in TITLES.values())
    table = table_in(sheets_of(path), words, "displacements and base shears")
    for column in (n for n, name in enumerate(table.names) if "case" in name):
        check_one_case(table, column)
    wanted = {"displacement": (displacement_column, length_units), "force": (force_column, force_units)}
    columns = {what: _column(what, column, table) for what, (column, _) in wanted.items()}
    if len({*columns.values()}) == 1:
        what = f"{name}: displacement and base shear are both in column {columns['force'] + 1}"
        raise ValueError(f"{what}; give displacement_column= and force_column=")
    series = []
    for what, column in columns.items():
        values = table.in_si(column, TITLES[what][1], wanted[what][1], None)
        series.append(values * np.sign(values[np.argmax(np.abs(values))]))
    displacement, force = checked_curve(series[0], series[1], table.places())
    return xr.DataArray(
        force,
        coords=[labels.axis(DISPLACEMENT, OF_ROOF, displacement, "m")],
        name=CURVE,
        attrs={"units": "N", "long_name": "base shear", "source": name},
    )


def _column(what: str, wanted: int | str | None, table: Table) -> int:
    """Index of the column of displacements or forces."""
    parameter, names = f"{what}_column", [with_unit(title)[0] for title in table.title_cells]
    if wanted is not None:
        return table.column(wanted, several=False)
    fitting = [n for n, name in enumerate(names) if re.search(TITLES[what][0], name)]
    if len(fitting) == 1:
        return fitting[0]
    if not names and table.width == 2:
        return [*TITLES].index(what)
    where = table.sheet.where(table.rows.index[0])
    raise ValueError(f"{parameter} is missing: {where} has {table.in_words}; give {parameter}=")
