"""Files of cells: text with separators, or sheets of a workbook; errors name line and column."""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from itertools import islice
from pathlib import Path
from statistics import mode
from typing import NamedTuple

import numpy as np
import pandas as pd

from stochlin.applications.sheets.titles import Said, said_by
from stochlin.applications.sheets.workbooks import rows_of
from stochlin.files.file_kinds import WORKBOOK
from stochlin.files.inputs import read_input, read_text
from stochlin.kernels.basics.arrays import Array
from stochlin.messages import brief, listed, plain
from stochlin.models.parameters import Range
from stochlin.models.units import parsed, stated_size

MOST_CELLS_OF_TEXT = 2**23  # of a text, with the empty ones between others
_SAMPLE = 50  # lines in which the separator is looked for, and where the numbers begin
_CELL_WITH_COMMA = re.compile(r"(^|[;\s])[-+]?\d*,\d+(?:[eE][-+]?\d+)?([;\s]|$)")
_BETWEEN_TITLES = r"\t+|\s{2,}", r"\s+(?![(\[])", r"\s+"  # white space, which may be within titles
_UNIT = re.compile(r"(.*)[(\[]([^()\[\]]*)[)\]](.*)")  # the last pair of brackets


class Sheet(NamedTuple):
    """The cells of a text, or of one sheet of a workbook.

    ``cells`` are texts without what surrounds them; the index has the numbers of the lines, from 1,
    and the columns theirs, from 0. Empty lines are left out. A part of them, such as
    ``sheet.cells.loc[lines, [2, 3]]``, keeps both, so that `numbers` can say where something is
    wrong.
    """

    name: str  # the file, and the sheet of a workbook
    cells: pd.DataFrame
    decimal: str = ".,"  # the signs that numbers may have before their decimals
    separator: str | None = None  # between the columns of a text; None for white space

    def row(self, line: int) -> tuple[str, ...]:
        """The cells of a line up to the last one that is not empty."""
        # A file may have a million lines: `loc` would make a Series for each.
        return _without_empty_end(self.cells.to_numpy()[self.cells.index.get_loc(line)])

    def where(self, line: int, column: int | None = None) -> str:
        """A place in words; columns are counted from 1 there."""
        return f"{self.name}, line {line}" + ("" if column is None else f", column {column + 1}")

    def error(self, line: int, column: int | None, what: str) -> ValueError:
        """A ValueError at a cell, or at the whole line."""
        return ValueError(f"{self.where(line, column)}: {what}")

    def columns_of_numbers(self, line: int) -> set[int]:
        """The columns that have a number in a line."""
        return self.places_of_numbers(self.row(line))

    def places_of_numbers(self, row: Sequence[str]) -> set[int]:
        """The indices of the numbers in the cells of a line."""
        return {n for n, cell in enumerate(row) if number_in(cell, self.decimal) is not None}

    def numbers(self, cells: pd.DataFrame, what: str, allowed: Range | None = None) -> Array:
        """The numbers in a part of the cells, each of them ``what`` in messages.

        Raises a ValueError at the first cell that is missing, no number, or out of the range.
        """
        texts = cells.to_numpy(dtype=object)
        values = np.array([number_in(text, self.decimal) for text in texts.ravel()], dtype=float)
        wrong = np.isnan(values) if allowed is None else ~allowed.contains(values)
        if wrong.any():
            n = int(np.argmax(wrong))
            line = cells.index[n // cells.shape[1]]
            column = cells.columns[n % cells.shape[1]]
            text = self.cells.at[line, column]
            signs = " or ".join(map(repr, self.decimal))
            if not np.isnan(values[n]):
                raise self.error(line, column, f"the {what} is {values[n]:g}; allowed: {allowed}")
            article = "an" if what[0] in "aeiou" else "a"
            what = f"{brief(text)} is not {article} {what}" if text else f"the {what} is missing"
            what += f"; allowed: a number, with {signs} before its decimals"
            raise self.error(line, column, what + self._where_from(text))
        return values.reshape(texts.shape)

    def _where_from(self, text: str) -> str:
        """Where the sheet has the decimal comma by which a text with a point is no number."""
        if self.decimal != "," or number_in(text, ".") is None:
            return ""
        commas = self.cells.apply(lambda cells: cells.str.fullmatch(r"[-+]?\d*,\d+")).stack()
        if not commas.any():
            return ""
        line, column = commas.idxmax()
        cell = self.cells.at[line, column]
        whole = cell.replace(",", "")
        return (
            f", as {brief(cell)} in line {line} has it, which is {whole} if ',' is between "
            "thousands"
        )

    def check_width(self, lines: Sequence[int], width: int) -> None:
        """Raise a ValueError for cells beyond the columns, such as the rest of 190,000."""
        beyond = self.cells.loc[lines].iloc[:, width:]
        filled = (beyond != "").to_numpy()
        if filled.any():
            n, m = np.argwhere(filled)[0]
            what = (
                f"{brief(beyond.iat[n, m])} is beyond the {width} columns above; allowed: no signs"
            )
            what += " between thousands, and '.' before decimals, or ';' between columns"
            raise self.error(beyond.index[n], beyond.columns[m], what)

    def without_comments(self) -> Sheet:
        """The lines that do not begin with # or %."""
        return self._replace(cells=self.cells[~self.cells[0].str.startswith(("#", "%"))])


class Table(NamedTuple):
    """A line of titles, maybe one of units below it, and lines with numbers; 0 if there is none."""

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
    def title_cells(self) -> tuple[str, ...]:
        """The titles as they are written; empty if there are none."""
        return self.sheet.row(self.titles) if self.titles else ()

    @property
    def width(self) -> int:
        """Number of columns."""
        return max(len(self.sheet.row(self.rows.index[0])), len(self.title_cells))

    def remarks(self) -> Iterator[tuple[str, str]]:
        """Place and text of each line that is neither of titles or units, nor of numbers."""
        for line in self.sheet.cells.index.difference(self.rows.index):
            if line not in (self.titles, self.units):
                between = self.sheet.separator or " "
                yield self.sheet.where(line), between.join(self.sheet.row(line))

    def places(self) -> list[str]:
        """Name of file and line of each row, for messages."""
        return [self.sheet.where(line) for line in self.rows.index]

    @property
    def names(self) -> list[str]:
        """Names of the columns, in small letters and digits alone."""
        names = [spelled(with_unit(title)[0]) for title in self.title_cells]
        return [self.alike.get(name, name) for name in names]

    def column(self, name: str) -> int:
        """The last column of a name that a program writes, from 0; a ValueError without one."""
        fitting = [n for n, other in enumerate(self.names) if other == spelled(with_unit(name)[0])]
        if not fitting:
            raise self.error(
                f"has no column {brief(name)}; allowed: columns {listed(self.title_cells)}"
            )
        return fitting[-1]

    def texts(self, name: str) -> pd.Series:
        """The texts of a column."""
        return self.rows[self.column(name)]

    def numbers(self, name: str | int, what: str, allowed: Range | None = None) -> Array:
        """The numbers of a column, by its name or from 0, each of them ``what`` in messages."""
        column = self.column(name) if isinstance(name, str) else name
        if self.rows[column].dtype.kind == "f":
            return self.rows[column].to_numpy()
        return self.sheet.numbers(self.rows[[column]], what, allowed)[:, 0]

    def said_of(self, column: int) -> Said:
        """What the title of a column says, with the cell of units below it."""
        return said_by(self._cell(self.titles, column), self._cell(self.units, column))

    def _cell(self, line: int, column: int) -> str:
        """A cell of a line; empty if there is no such line, or if it ends before."""
        row = self.sheet.row(line) if line else ()
        return row[column] if column < len(row) else ""

    def in_si(self, name: str, quantity: str, unit: str | None, allowed: Range | None) -> Array:
        """The numbers of a column in SI by the unit of its title, the line of units or this one."""
        column = self.column(name)
        line = self.units or self.titles or self.rows.index[0]
        stated = self.said_of(column).unit
        size = stated_size(quantity, stated, unit, self.sheet.where(line, column))
        return size * self.numbers(column, quantity, allowed)


def table_of(sheet: Sheet) -> Table | None:
    """The table below titles; None if there are no numbers.

    They begin in the first line of numbers alone, or with a number in a column where the next line
    has one. The titles are the line above with the most names of known quantities, also after
    ``#``.
    """
    below = sheet.without_comments().cells
    row = sheet.row
    start = _first_of_numbers(sheet, below)
    if start is None:
        return None
    above = [n for n in sheet.cells.index if n < start and (n in below.index or len(row(n)) > 1)]

    def rank(line: int) -> tuple[int, int]:
        return sum(_is_title(cell) for cell in row(line)), line

    wide = [line for line in above if len(row(line)) >= len(row(start)) or rank(line)[0] > 1]
    if wide[1:] and all(parsed(cell.strip("()[]")) for cell in row(wide[-1]) if cell):
        wide = wide[:-1]
    titles = max(wide, key=rank, default=0)
    units = next((line for line in above if line > titles > 0), 0)
    return Table("the table", sheet, titles, units, below.loc[start:])


def _is_title(cell: str) -> bool:
    """Whether a cell names a known quantity, and not only a unit."""
    said = said_by(cell)
    return bool(said.quantities) and cell.strip("()[] ") != said.unit


def _first_of_numbers(sheet: Sheet, cells: pd.DataFrame) -> int | None:
    """The line of these cells in which the numbers of a table begin; None if there is none."""
    before = 0
    places_before = set[int]()
    for line, cells_of_line in zip(cells.index.tolist(), cells.to_numpy(), strict=True):
        row = _without_empty_end(cells_of_line)
        places = sheet.places_of_numbers(row)
        if places & places_before:
            return int(before)
        if len(places) == len(row):
            return int(line)
        before = line
        places_before = places
    return int(before) if places_before else None  # the last line has no next one


def _without_empty_end(row: Array) -> tuple[str, ...]:
    """The cells of a line up to the last one that is not empty."""
    cells = row.tolist()
    return tuple(cells[: max((n for n, cell in enumerate(cells, 1) if cell), default=0)])


def table_in(sheets: Sequence[Sheet], what: str) -> Table:
    """The only table of numbers in a file; a ValueError if there are none or several."""
    tables = [table for sheet in sheets if (table := table_of(sheet))]
    if not tables:
        raise ValueError(f"{sheets[0].name} has no line of numbers; allowed: {what}")
    check_alone([table.sheet for table in tables], "lines of numbers")
    tables[0].sheet.check_width(tables[0].rows.index, tables[0].width)
    return tables[0]


def spelled(title: str) -> str:
    """A title or a name as it is compared: small letters and digits."""
    return re.sub(r"[^a-z0-9]", "", title.lower())


def sheets_of(path: Path) -> list[Sheet]:
    """All sheets of a workbook, or the one of a text; an OSError or ValueError if it is neither."""
    name = plain(path.name)
    content = read_input(path)
    if WORKBOOK.fits(content):
        cells = [(f"{name}, sheet {title}", rows) for title, rows in rows_of(content, name)]
        sheets = [Sheet(place, _frame(rows, place)) for place, rows in cells]
    else:
        sheets = [text_sheet(read_text(path).splitlines(), name)]
    if not (sheets := [sheet for sheet in sheets if sheet.cells.size]):
        raise ValueError(f"{name} is empty: it holds no visible table")
    return sheets


def check_alone(sheets: Sequence[Sheet], what: str) -> None:
    """Raise a ValueError if there are several sheets with what is wanted."""
    if len(sheets) > 1:
        raise ValueError(
            f"{sheets[0].name} and {sheets[1].name} both have {what}; allowed: one of them"
        )


def number_in(text: str, decimal: str = ".") -> float | None:
    """The finite number that a text is, also as Fortran writes it; None if it is none.

    Before its decimals is one of the signs in ``decimal``, and none between thousands.
    """
    point = text.replace(",", ".", 1) if "," in decimal and "." not in text else text
    try:
        value = float(point.upper().replace("D", "E"))  # Fortran writes .5D-03
    except ValueError:
        return None
    valid = math.isfinite(value) and "_" not in text and (decimal != "," or "." not in text)
    return value if valid else None


def with_unit(title: str) -> tuple[str, str]:
    """The name and unit in a title such as ``S(T) [g]``, in lower case; the unit may be empty."""
    match = _UNIT.fullmatch(title)
    name, unit, rest = match.groups() if match else (title, "", "")
    return f"{name.strip()} {rest.strip()}".strip().lower(), unit.strip()


def text_sheet(lines: Sequence[str], name: str, marks: str = ";\t,") -> Sheet:
    """The cells of a text: columns are between the marks that half of its lines have, or spaces."""
    first = (line for line in lines if line.strip(" \t;,") and not line.startswith("#"))
    sample = [*islice(first, _SAMPLE)]
    often = (mark for mark in marks if 2 * sum(mark in line for line in sample) >= len(sample))
    separator = next(often, None)
    decimal = "," if separator != "," and any(map(_CELL_WITH_COMMA.search, lines)) else "."
    reader = partial(csv.reader, delimiter=separator or " ", skipinitialspace=True)
    width = mode([len(line.split()) for line in sample] or [0])
    rows = {}
    for number, line in enumerate(lines, 1):
        try:
            rows[number] = next(reader([line]) if separator else _apart(line, width), [])
        except csv.Error as error:
            raise ValueError(
                f"{name}, line {number}: {error}; allowed: cells of less text"
            ) from error
    return Sheet(name, _frame(rows, name), decimal, separator)


def _apart(line: str, width: int) -> Iterator[list[str]]:
    """The numbers of a line, or as many titles as there are columns, or the line itself."""
    if all(number_in(word, ".,") is not None for word in line.split()):
        yield line.split()
    yield from (row for way in _BETWEEN_TITLES if len(row := re.split(way, line.strip())) == width)
    yield [line]


def _frame(rows: Mapping[int, Sequence[str]], name: str) -> pd.DataFrame:
    """The lines that are not empty, and their cells without what surrounds them."""
    edge = " \t\"'\xa0"
    lines = {
        n: row for n, cells in rows.items() if any(row := [cell.strip(edge) for cell in cells])
    }
    width = max(map(len, lines.values()), default=0)
    if width * len(lines) > MOST_CELLS_OF_TEXT:
        raise ValueError(f"{name} has {len(lines)} lines, one with {width} columns; allowed: less")
    cells = [[*row, *[""] * (width - len(row))] for row in lines.values()]
    return pd.DataFrame(cells, [*lines], dtype=object)
