"""Tables as ETABS exports them, with names above, on their sheets or as names of their files."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import PurePath

import pandas as pd

from stochlin.applications.buildings.mode_files import MODE_NUMBERS
from stochlin.applications.sheets.sheets import Sheet, Table, number_in, spelled
from stochlin.messages import brief, listed
from stochlin.models.buildings.base import MODE
from stochlin.models.parameters import Range

TITLE = re.compile(r"table:\s*(.*)", re.IGNORECASE)
MASS_RATIOS = "Modal Participating Mass Ratios"
JOINT_TABLE = "Joint Displacements"
CENTRE_TABLE = "Diaphragm Center Of Mass Displacements"
STORY_TABLE = "Mass Summary by Story"
DIAPHRAGM_TABLE = "Centers Of Mass And Rigidity"
BASES = "Tower and Base Story Definitions"
SUMMARY = "Mass Summary by Diaphragm"
HEIGHTS = "Story Definitions"
STORY_DATA = "Story Data"
TABLES = (
    MASS_RATIOS,
    JOINT_TABLE,
    CENTRE_TABLE,
    STORY_TABLE,
    DIAPHRAGM_TABLE,
    SUMMARY,
    BASES,
    HEIGHTS,
    STORY_DATA,
)
# Names of columns that differ between the versions of the program.
SAME_COLUMNS = {
    **dict.fromkeys(("outputcase", "loadcase", "loadcasecombo"), "case"),
    **dict.fromkeys(("stepnum", "stepnumber"), "mode"),
    **{"name": "story", "massx": "ux", "massy": "uy"},
}
MERGED_COLUMNS = "tower", "story", "diaphragm"  # cells of these may be merged over several lines


def tables_in(sheets: Sequence[Sheet]) -> dict[str, Table]:
    """All tables by name; titles and units that are repeated on each page are left out."""
    tables: dict[str, Table] = {}
    lines: dict[str, list[int]] = {}
    for sheet in sheets:
        key = spelled(name := _of_sheet(sheet))
        at_titles = bool(name)
        for line, *cells in sheet.cells.itertuples():
            has_number = any(number_in(cell, sheet.decimal) is not None for cell in cells[::-1])
            if match := TITLE.match(cells[0]):
                name = match[1].strip(" \"'")
                key = spelled(name)
                at_titles = True
            elif at_titles:
                at_titles = False
                new = Table(f"table {name}", sheet, line, 0, sheet.cells, SAME_COLUMNS)
                table = tables.setdefault(key, new)
                if table.sheet is not sheet or sheet.row(table.titles) != sheet.row(line):
                    raise table.error(f"is also at {sheet.where(line)}; allowed: each table once")
            elif key and has_number:
                lines.setdefault(key, []).append(line)
            elif key and sheet.row(line) != sheet.row(table.titles):
                if sheet.row(line) != sheet.row(table.units or line):
                    raise sheet.error(line, None, f"this row of {table.name} has no number")
                table = tables[key] = table._replace(units=line)
    for key, table in tables.items():
        rows = table.sheet.cells.loc[lines.get(key, [])].copy()
        table.sheet.check_width(rows.index, len(table.names))
        for column in (table.column(name) for name in MERGED_COLUMNS if name in table.names):
            rows[column] = rows[column].where(rows[column] != "").ffill().fillna("")
        tables[key] = table._replace(rows=rows)
    return tables


def _of_sheet(sheet: Sheet) -> str:
    """The table that a sheet (in 31 characters at most) or a text is named after; empty if none.

    The name of a text may have words before that of the table, such as the name of the building.
    """
    file, _, title = sheet.name.partition(", sheet ")
    if title:
        return next(
            (name for name in TABLES if spelled(name).startswith(spelled(title) or " ")), ""
        )
    stem = spelled(PurePath(file).stem)
    return next((name for name in TABLES if stem.endswith(spelled(name))), "")


def needed_tables(tables: Mapping[str, Table], *groups: Sequence[str]) -> list[Table]:
    """A table of each group of names; a ValueError names all groups of which the file has none."""
    there = {key: table for key, table in tables.items() if len(table.rows)}
    chosen = [
        [there[spelled(name)] for name in names if spelled(name) in there] for names in groups
    ]
    missing = [
        " or ".join(names) for names, fitting in zip(groups, chosen, strict=True) if not fitting
    ]
    if missing:
        present = listed(table.name.removeprefix("table ") for table in there.values()) or "none"
        what = f"table {', table '.join(missing)} {'are' if missing[1:] else 'is'} missing"
        raise ValueError(
            f"{what}: the file has {present}; export what is missing, into the same file or folder"
        )
    return [fitting[0] for fitting in chosen]


def keyed(
    table: Table,
    keys: Sequence[str],
    title: str,
    what: str,
    allowed: Range | None,
    unit: str | None = None,
) -> pd.Series:
    """A column over the columns of these names, ``"mass"`` and ``"length"`` in SI.

    Raises a ValueError for a line whose keys an earlier line has.
    """
    frame = table.rows[[table.column(key) for key in keys]].set_axis([*keys], axis=1)
    if MODE in frame:
        frame[MODE] = table.numbers(MODE, "mode number", MODE_NUMBERS).astype(int)
    twice = frame.duplicated()
    if twice.any():
        line = twice.idxmax()
        names = brief(" ".join(map(str, frame.loc[line])))
        raise table.sheet.error(line, None, f"{names} is there twice; choose by tower= or points=")
    read = partial(table.in_si, unit=unit) if what in {"mass", "length"} else table.numbers
    frame["value"] = read(title, what, allowed=allowed)
    return frame.set_index([*keys])["value"]
