"""Tables as ETABS and SAP2000 export them: a line with the name, titles, units, and rows."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

from stochlin.analyses.buildings.sheets import Sheet, SheetRow, number_in
from stochlin.analyses.buildings.units import size_stated
from stochlin.messages import brief, listed

TITLE = re.compile(r"table:\s*(.*)", re.IGNORECASE)


class CsiTable(NamedTuple):
    """A table with its titles, its units if a row has them, and its rows."""

    name: str
    titles: SheetRow
    units: list[SheetRow]  # none or one
    rows: list[SheetRow]

    def error(self, what: str) -> ValueError:
        """A ValueError at the table."""
        return self.titles.error(None, f"table {self.name} {what}")

    def column(self, *titles: str, needed: bool = True) -> int:
        """Number of the column with one of these titles; -1 if there is none, and it is not needed."""
        columns = [spelled(title) for title in self.titles.cells]
        for title in map(spelled, titles):
            if title in columns:
                return columns.index(title)
        if needed:
            known = listed(self.titles.cells)
            raise self.error(f"has no column {' or '.join(titles)}; it has {known}")
        return -1

    def by(self, column: int, key: Callable[[SheetRow, int], Any]) -> dict[Any, SheetRow]:
        """The rows by what a column has; a ValueError for what comes twice."""
        rows: dict[Any, SheetRow] = {}
        for row in self.rows:
            if rows.setdefault(key(row, column), row) is not row:
                raise row.error(column, f"{brief(row.cell(column))} is there twice; export one of them")
        return rows

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
            elif not name or (current and row.cells == current.titles.cells):
                continue  # what precedes the tables, or the titles on the next page
            elif current is None:
                current = tables.setdefault(spelled(name), CsiTable(name, row, [], []))
                if current.titles.cells != row.cells or current.titles.sheet != row.sheet:
                    raise current.error(f"is also at {row.where}; allowed: each table once")
            elif not any(number_in(cell, not row.has_comma) is not None for cell in row.cells):
                if current.units and row.cells != current.units[0].cells:
                    raise row.error(None, f"this row of table {name} has no number")
                current.units[:] = [row]
            else:
                row.check_width(len(current.titles.cells))
                current.rows.append(row)
    return tables


def needed_table(tables: dict[str, CsiTable], *names: str) -> CsiTable:
    """The table of one of these names; a ValueError if it is missing or empty."""
    for name in names:
        if table := tables.get(spelled(name)):
            if not table.rows:
                raise table.error("has no rows")
            return table
    known = listed(table.name for table in tables.values())
    what = f"table {' or '.join(names)} is missing: the file has {known}"
    raise ValueError(f"{what}; export it as well, into the same file")
