"""Files of cells: text with separators, or the sheets of a workbook; errors name line and column."""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd

from stochlin.analyses.sheets.workbooks import rows_of
from stochlin.analyses.tables.inputs import read_input, read_text
from stochlin.kernels.basics.arrays import Array
from stochlin.messages import brief, listed, plain
from stochlin.models.parameters import Range
from stochlin.models.units import stated_size

_WORKBOOK = b"PK\x03\x04"  # signature of .xlsx, which is a zip archive
_OLE = b"\xd0\xcf\x11\xe0"  # signature of .xls, and of .xlsx with a password
_SAMPLE = 50  # lines in which the separator is looked for
MOST_CELLS = 2**23  # lines times columns
_UNIT = re.compile(r"(.*)[(\[]([^()\[\]]*)[)\]](.*)")  # the last pair of brackets


class Sheet(NamedTuple):
    """The cells of a text, or of one sheet of a workbook.

    ``cells`` are texts without what surrounds them; the index has the numbers of the lines, from 1, and
    the columns theirs, from 0. Empty lines are left out. A part of them, such as
    ``sheet.cells.loc[lines, [2, 3]]``, keeps both, so that `numbers` can say where something is wrong.
    """

    name: str  # the file, and the sheet of a workbook
    cells: pd.DataFrame
    has_comma: bool = False  # columns are separated by commas, so that numbers have a point

    def row(self, line: int) -> tuple[str, ...]:
        """The cells of a line up to the last one that is not empty."""
        cells = self.cells.loc[line].tolist()
        return tuple(cells[: max((n for n, cell in enumerate(cells, 1) if cell), default=0)])

    def where(self, line: int, column: int | None = None) -> str:
        """A place in words; columns are counted from 1 there."""
        return f"{self.name}, line {line}" + ("" if column is None else f", column {column + 1}")

    def error(self, line: int, column: int | None, what: str) -> ValueError:
        """A ValueError at a cell, or at the whole line."""
        return ValueError(f"{self.where(line, column)}: {what}")

    def number_in(self, text: str) -> float | None:
        """The finite number that a cell stands for; None if it is none."""
        return number_in(text, decimal_comma=not self.has_comma)

    def has_numbers(self, cells: Sequence[str]) -> bool:
        """Whether two of the cells are numbers."""
        return sum(self.number_in(cell) is not None for cell in cells) > 1

    def numbers(self, cells: pd.DataFrame, what: str, allowed: Range | None = None) -> Array:
        """The numbers in a part of the cells, each of them ``what`` in messages.

        Raises a ValueError at the first cell that is missing, no number, or out of the range.
        """
        texts = cells.to_numpy(dtype=object)
        values = np.array([self.number_in(text) for text in texts.ravel()], dtype=float)  # None: NaN
        wrong = np.isnan(values) if allowed is None else ~allowed.contains(values)
        if wrong.any():
            raise self._refused(cells, int(np.argmax(wrong)), what, allowed)
        return values.reshape(texts.shape)

    def _refused(self, cells: pd.DataFrame, n: int, what: str, allowed: Range | None) -> ValueError:
        line, column = cells.index[n // cells.shape[1]], cells.columns[n % cells.shape[1]]
        text = self.cells.at[line, column]
        if not text:
            return self.error(line, column, f"the {what} is missing; allowed: a number")
        value = self.number_in(text)
        if value is None:
            sign = ", with a decimal point" if self.has_comma and "," in text else ""
            return self.error(line, column, f"{brief(text)} is not a {what}; allowed: a number{sign}")
        return self.error(line, column, f"the {what} is {value:g}; allowed: {allowed}")

    def check_width(self, lines: Sequence[int], width: int) -> None:
        """Raise a ValueError for cells beyond the columns, such as the rest of 190,000."""
        beyond = self.cells.loc[lines].iloc[:, width:]
        for line in beyond.index[(beyond != "").any(axis=1)][:1]:
            column = next(n for n in beyond.columns if beyond.at[line, n])
            what = f"{brief(beyond.at[line, column])} is beyond the {width} columns above"
            raise self.error(line, column, f"{what}; allowed: no signs between thousands")

    def without_comments(self) -> Sheet:
        """The lines that do not begin with #."""
        return self._replace(cells=self.cells[~self.cells[0].str.startswith("#")])


class Table(NamedTuple):
    """A line of titles, maybe one of units below it, and lines with numbers; 0 if there is no line."""

    name: str  # in messages
    sheet: Sheet
    titles: int
    units: int
    rows: pd.DataFrame
    alike: Mapping[str, str] = {}  # the names that stand for another one

    def error(self, what: str) -> ValueError:
        """A ValueError at the table."""
        return self.sheet.error(self.titles or self.rows.index[0], None, f"{self.name} {what}")

    @property
    def names(self) -> list[str]:
        """Names of the columns, in small letters and digits alone."""
        titles = self.sheet.row(self.titles) if self.titles else ()
        names = [spelled(with_unit(title)[0]) for title in titles]
        return [self.alike.get(name, name) for name in names]

    def column(self, name: str | int) -> int:
        """The last column of a name; a ValueError with all of them if there is none."""
        if isinstance(name, int):
            return name
        if name not in self.names:
            known = listed(self.sheet.row(self.titles))
            raise self.error(f"has no column {name.upper()}; it has {known}")
        return len(self.names) - 1 - self.names[::-1].index(name)

    def texts(self, name: str | int) -> pd.Series:
        """The texts of a column."""
        return self.rows[self.column(name)]

    def numbers(self, name: str | int, what: str, allowed: Range | None = None) -> Array:
        """The numbers of a column, each of them ``what`` in messages."""
        return self.sheet.numbers(self.rows[[self.column(name)]], what, allowed)[:, 0]

    def in_si(self, name: str | int, quantity: str, unit: str | None, allowed: Range | None) -> Array:
        """The numbers of a column in SI, by the unit of its title, of the line of units, or this one."""
        column, line = self.column(name), self.units or self.titles or self.rows.index[0]
        titles = self.sheet.cells.loc[[n for n in (self.titles, self.units) if n], column]
        stated = [with_unit(title)[1] for title in titles]
        if self.units and not any(stated):
            stated = [titles.iloc[-1]]
        size = stated_size(
            quantity, max(stated, default="", key=len), unit, self.sheet.where(line, column)
        )
        return size * self.numbers(column, quantity, allowed)

    def check_once(self, keys: pd.DataFrame, allowed: str) -> None:
        """Raise a ValueError for the first line whose keys an earlier line has."""
        for line in keys.index[keys.duplicated()][:1]:
            names = " ".join(map(str, keys.loc[line]))
            raise self.sheet.error(line, None, f"{brief(names)} is there twice; {allowed}")


def table_of(sheet: Sheet, pattern: str) -> Table | None:
    """The table whose numbers begin in the first line with two of them; None if there is none.

    Its titles are the line above with the most names that have a word of the pattern, also after ``#``.
    """
    start = next((line for line, *cells in sheet.cells.itertuples() if sheet.has_numbers(cells)), None)
    if start is None:
        return None

    def known(line: int) -> int:
        return sum(re.search(pattern, cell, re.IGNORECASE) is not None for cell in sheet.row(line))

    below = sheet.without_comments().cells
    above = [n for n in sheet.cells.index if n < start and (n in below.index or len(sheet.row(n)) > 1)]
    titles = max(above, key=known, default=0)
    units = next((line for line in above if line > titles), 0)
    table = Table(sheet.name, sheet, titles, units, below.loc[start:])
    sheet.check_width(table.rows.index, len(table.names) or len(sheet.row(start)))
    return table


def spelled(title: str) -> str:
    """A title or a name as it is compared: small letters and digits."""
    return re.sub(r"[^a-z0-9]", "", title.lower())


def sheets_of(path: Path) -> list[Sheet]:
    """All sheets of a workbook, or the one of a text; an OSError or ValueError if it is neither."""
    name, content = plain(path.name), read_input(path)
    if content.startswith(_OLE):
        raise ValueError(f"{name} is an .xls workbook or has a password; save it as .xlsx without one")
    if content.startswith(_WORKBOOK):
        sheets = [
            Sheet(f"{name}, sheet {title}", _frame(rows, name))
            for title, rows in rows_of(content, name).items()
        ]
    else:
        sheets = [_text(read_text(path), name)]
    sheets = [sheet for sheet in sheets if sheet.cells.size]
    if not sheets:
        raise ValueError(f"{name} is empty: it holds no visible table")
    return sheets


def sheets_in(folder: Path) -> list[Sheet]:
    """The sheets of all files ``.csv`` in a folder; a ValueError if it holds none."""
    files = sorted(f for f in folder.iterdir() if f.suffix.lower() == ".csv" and f.is_file())
    if not files:
        raise ValueError(f"the folder {plain(folder.name)} holds no file .csv")
    return [sheet for file in files for sheet in sheets_of(file)]


def check_alone(sheets: Sequence[Sheet], what: str) -> None:
    """Raise a ValueError if there are several sheets with what is wanted."""
    if len(sheets) > 1:
        first, second = (sheet.name for sheet in sheets[:2])
        raise ValueError(f"{first} and {second} both have {what}; allowed: one, so take the other out")


def number_in(text: str, decimal_comma: bool = True) -> float | None:
    """The finite number that a text stands for; None if it is none, or has signs between thousands."""
    if decimal_comma and text.count(",") == 1 and "." not in text:
        text = text.replace(",", ".")
    try:
        value = float(text)
    except ValueError:
        return None
    return value if math.isfinite(value) and "_" not in text else None


def with_unit(title: str) -> tuple[str, str]:
    """The name and the unit in a title such as ``S(T) [g]``, in lower case; the unit may be empty."""
    match = _UNIT.fullmatch(title)
    if match is None:
        return title.strip().lower(), ""
    return f"{match[1].strip()} {match[3].strip()}".strip().lower(), match[2].strip()


def _text(text: str, name: str) -> Sheet:
    lines = dict(enumerate(text.splitlines(), 1))
    first = [line for line in lines.values() if line.strip(" \t;,") and not line.startswith("#")]
    marks = (mark for mark in ";\t," if any(mark in line for line in first[:_SAMPLE]))
    if (separator := next(marks, None)) is None:  # only spaces, which also titles have
        return Sheet(name, _frame({number: _apart(line) for number, line in lines.items()}, name))
    rows = {}
    for number, line in lines.items():
        try:
            rows[number] = next(csv.reader([line], delimiter=separator), [])
        except csv.Error as error:
            raise ValueError(f"{name}, line {number}: {error}; allowed: cells of less text") from error
    return Sheet(name, _frame(rows, name), separator == ",")


def _apart(line: str) -> list[str]:
    """The numbers of a line, or the line itself if it has other words."""
    words = line.split()
    return words if all(number_in(word) is not None for word in words) else [line]


def _frame(rows: Mapping[int, Sequence[str]], name: str) -> pd.DataFrame:
    """The lines that are not empty, and their cells without what surrounds them."""
    lines = {line: [cell.strip(" \t\"'\xa0") for cell in row] for line, row in rows.items() if any(row)}
    lines = {line: row for line, row in lines.items() if any(row)}
    width = max(map(len, lines.values()), default=0)
    if width * len(lines) > MOST_CELLS:
        raise ValueError(f"{name} has {len(lines)} lines, one with {width} columns; allowed: less")
    cells = [[*row, *[""] * (width - len(row))] for row in lines.values()]
    return pd.DataFrame(cells, [*lines], dtype=object)
