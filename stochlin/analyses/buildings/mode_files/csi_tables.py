"""Tables as ETABS and SAP2000 export them: a line with the name, titles, units, and rows."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import NamedTuple

from stochlin.analyses.buildings.sheets import Sheet, SheetRow, number_in
from stochlin.analyses.buildings.units import size_stated
from stochlin.messages import listed

TITLE = re.compile(r"table:\s*(.*)", re.IGNORECASE)


class CsiTable(NamedTuple):
    """A table with its titles, its units if a row has them, and its rows."""

    name: str
    titles: SheetRow
    units: list[SheetRow]  # none or one
    rows: list[SheetRow]

    def column(self, *titles: str, needed: bool = True) -> int:
        """Number of the column with one of these titles; -1 if there is none, and it is not needed."""
        own = [spelled(title) for title in self.titles.cells]
        for title in titles:
            if spelled(title) in own:
                return own.index(spelled(title))
        if needed:
            raise self.titles.error(
                None,
                f"table {self.name} has no column {' or '.join(titles)}; it has "
                f"{listed(self.titles.cells)}",
            )
        return -1

    def size(self, quantity: str, column: int, asked: str | None) -> float:
        """The unit of a column in SI, as its row of units says it or as it is asked for."""
        row = self.units[0] if self.units else self.titles
        stated = row.cell(column) if self.units else ""
        return size_stated(quantity, stated, asked, f"{row.where}, column {column + 1}")


def spelled(title: str) -> str:
    """A title or a name as it is compared: small letters and digits."""
    return re.sub(r"[^a-z0-9]", "", title.lower())


def tables_in(sheets: Sequence[Sheet]) -> dict[str, CsiTable]:
    """All tables by name; titles and units that are repeated on each page are left out."""
    tables: dict[str, CsiTable] = {}
    for sheet in sheets:
        name, current = "", None
        for row in sheet:
            if match := TITLE.match(row.cell(0)):
                name, current = match[1].strip(" \"'"), None
            elif not name:
                continue  # what precedes the tables, or another file in their folder
            elif current is None:
                current = tables.setdefault(spelled(name), CsiTable(name, row, [], []))
                if current.titles.cells != row.cells:
                    raise row.error(None, f"table {name} is there twice, with other titles")
            elif row.cells == current.titles.cells:
                continue
            elif not any(number_in(cell, not row.has_comma) is not None for cell in row.cells):
                if current.units and row.cells != current.units[0].cells:
                    raise row.error(None, f"this row of table {name} has no number")
                current.units[:] = [row]
            else:
                current.rows.append(row)
    return tables


def needed_table(tables: dict[str, CsiTable], *names: str) -> CsiTable:
    """The table of one of these names; a ValueError if it is missing or empty."""
    table = next((tables[spelled(name)] for name in names if spelled(name) in tables), None)
    if table is not None and table.rows:
        return table
    if table is not None:
        raise table.titles.error(None, f"table {table.name} has no rows")
    known = listed(table.name for table in tables.values())
    raise ValueError(
        f"table {' or '.join(names)} is missing: the file has {known}; export it as well, into the same "
        "file"
    )
