"""Pushover curves from files: base shear over the displacement of the roof."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence

import numpy as np
import xarray as xr

from stochlin.analyses.buildings.pushover import CURVE, DISPLACEMENT, check_curve
from stochlin.analyses.buildings.sheets import (
    SheetRow,
    check_alone,
    number_in,
    sheets_of,
    with_unit,
    without_comments,
)
from stochlin.analyses.buildings.units import size_stated
from stochlin.analyses.buildings.variables import VARIABLES
from stochlin.analyses.tables import labels
from stochlin.analyses.tables.inputs import input_path
from stochlin.messages import brief, listed, plain
from stochlin.models.arguments import checked, is_whole

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
        If the file is a workbook and openpyxl is not installed.
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
    tables = [[*map(_fields, without_comments(sheet))] for sheet in sheets_of(path)]
    tables = [rows for rows in tables if any(map(_is_of_numbers, rows))]
    if not tables:
        raise ValueError(f"{name} has no line of numbers; allowed: displacements and base shears")
    check_alone(tables, "lines of numbers")
    start = next(n for n, row in enumerate(tables[0]) if _is_of_numbers(row))
    above, points = tables[0][:start], tables[0][start:]
    titles = max(above, key=_known_titles, default=None)
    widest = titles if titles is not None and _known_titles(titles) == len(TITLES) else points[0]
    for row in points:
        row.check_width(len(widest.cells))
    asked = {"displacement": (displacement_column, length_units), "force": (force_column, force_units)}
    columns = {what: _column(what, column, titles, points[0]) for what, (column, _) in asked.items()}
    if len({*columns.values()}) == 1:
        raise ValueError(
            f"{name}: displacement and base shear are both in column {columns['force'] + 1}; give "
            "displacement_column= and force_column="
        )
    series = []
    for what, column in columns.items():
        size = _size(TITLES[what][1], column, above, asked[what][1], name)
        values = np.array([row.number(column, what) for row in points])
        series.append(size * values * np.sign(values[np.argmax(np.abs(values))]))
    displacement, force = series
    places = [row.where for row in points]
    if displacement[0] > 0 and force[0] > 0:
        displacement, force = (np.append(0.0, values) for values in (displacement, force))
        places = ["the origin", *places]
    check_curve(displacement, force, places)
    units, long_name = VARIABLES[CURVE]
    return xr.DataArray(
        force,
        coords=[labels.axis(DISPLACEMENT, VARIABLES[DISPLACEMENT][1], displacement, "m")],
        name=CURVE,
        attrs={"units": units, "long_name": long_name, "source": name},
    )


def _fields(row: SheetRow) -> SheetRow:
    """The line with its numbers apart, where only spaces are between them."""
    apart = row.cells[0].split()
    alone = len(row.cells) == 1 and all(number_in(field) is not None for field in apart)
    return row._replace(cells=tuple(apart)) if alone else row


def _is_of_numbers(row: SheetRow) -> bool:
    return sum(number_in(cell, not row.has_comma) is not None for cell in row.cells) > 1


def _known_titles(row: SheetRow) -> int:
    """How many columns are known by the titles in a line."""
    known = "|".join(pattern for pattern, _ in TITLES.values())
    return sum(re.search(known, cell, re.IGNORECASE) is not None for cell in row.cells)


def _column(what: str, asked: int | str | None, titles: SheetRow | None, first: SheetRow) -> int:
    """Index of the column of displacements or forces."""
    names = [] if titles is None else [with_unit(cell)[0] for cell in titles.cells]
    parameter, width = f"{what}_column", max(len(first.cells), len(names))
    known = f"{width} columns (index 0 to {width - 1})" + (f" titled {listed(names)}" if names else "")
    if asked is None:
        found = [n for n, title in enumerate(names) if re.search(TITLES[what][0], title)]
        if len(found) == 1:
            return found[0]
        if not names and width == 2:
            return [*TITLES].index(what)
        raise ValueError(f"{parameter} is missing: {first.where} has {known}; give {parameter}=")
    if isinstance(asked, str) and (title := with_unit(asked)[0]) in names:
        return names.index(title)
    if is_whole(asked) and 0 <= asked < width:
        return int(asked)
    raise ValueError(f"{parameter} = {brief(asked)} is not in {first.where}; allowed: {known}")


def _size(quantity: str, column: int, above: Sequence[SheetRow], asked: str | None, name: str) -> float:
    """The unit of a column in SI, from its title, from the line below the titles, or as asked for."""
    stated = next((unit for row in above if (unit := with_unit(row.cell(column))[1])), "")
    if not stated and len(above) > 1:
        stated = above[-1].cell(column)
    return size_stated(quantity, stated, asked, f"{name}, column {column + 1}")
