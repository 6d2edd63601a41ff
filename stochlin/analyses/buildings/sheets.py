"""Files of cells: text with separators, or the sheets of a workbook; errors name line and column."""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Iterable, Sequence
from itertools import islice
from pathlib import Path
from typing import NamedTuple

from stochlin.analyses.tables.inputs import MOST_LINES, read_input, read_text
from stochlin.analyses.tables.optional import needed
from stochlin.messages import brief, plain, sentence
from stochlin.models.parameters import Range

_WORKBOOK = b"PK\x03\x04"  # signature of .xlsx, which is a zip archive
_SAMPLE = 50  # lines in which the separator is looked for
_UNIT = re.compile(r"\s*(.*?)\s*[(\[](.*)[)\]]\s*")


class SheetRow(NamedTuple):
    """One line of a file with its cells; columns are counted from 0 here and from 1 in messages."""

    where: str  # file, sheet and line
    cells: tuple[str, ...]
    has_comma: bool = False  # columns are separated by commas, so that numbers have a point

    def cell(self, column: int) -> str:
        """The text of a cell; empty beyond the last one."""
        return self.cells[column] if column < len(self.cells) else ""

    def error(self, column: int | None, what: str) -> ValueError:
        """A ValueError at a cell, or at the whole line."""
        place = self.where if column is None else f"{self.where}, column {column + 1}"
        return ValueError(f"{place}: {what}")

    def number(self, column: int, what: str, allowed: Range | None = None) -> float:
        """The number in a cell, which is ``what`` in messages; a ValueError if it is none."""
        text = self.cell(column)
        if not text:
            raise self.error(column, f"the {what} is missing; allowed: a number")
        value = number_in(text, decimal_comma=not self.has_comma)
        if value is None:
            sign = ", with a decimal point" if self.has_comma and "," in text else ""
            raise self.error(column, f"{brief(text)} is not a {what}; allowed: a number{sign}")
        if allowed is not None and not allowed.contains(value):
            raise self.error(column, f"the {what} is {value:g}; allowed: {allowed}")
        return value


Sheet = Sequence[SheetRow]
"""The lines of a text, or of one sheet of a workbook, that are not empty."""


def sheets_of(path: Path) -> list[Sheet]:
    """All sheets of a workbook, or the one of a text; an OSError or ValueError if it is neither."""
    name, content = plain(path.name), read_input(path)
    sheets = _workbook(path, name) if content.startswith(_WORKBOOK) else [_text(path, name)]
    if not any(sheets):
        raise ValueError(f"{name} is empty: it holds no table")
    return sheets


def sheets_in(folder: Path) -> list[Sheet]:
    """The sheets of all files ``.csv`` in a folder; a ValueError if it holds none."""
    files = sorted(f for f in folder.iterdir() if f.suffix.lower() == ".csv" and f.is_file())
    if not files:
        raise ValueError(f"the folder {plain(folder.name)} holds no file .csv")
    return [sheet for file in files for sheet in sheets_of(file)]


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
    """The name and the unit in a title such as ``mass [kg]``, in lower case; the unit may be empty."""
    match = _UNIT.fullmatch(title)
    return (match[1].lower(), match[2]) if match else (title.strip().lower(), "")


def _text(path: Path, name: str) -> Sheet:
    lines = read_text(path).splitlines()
    first = list(islice((line for line in lines if line.strip()), _SAMPLE))
    separator = next((mark for mark in ";\t," if any(mark in line for line in first)), ",")
    rows = (next(csv.reader([line], delimiter=separator), []) for line in lines)
    return _filled(rows, name, separator == ",")


def _workbook(path: Path, name: str) -> list[Sheet]:
    openpyxl = needed(
        "openpyxl", f"{name} is a workbook, which", "tables", "save its tables as one .csv file"
    )
    try:
        book = openpyxl.load_workbook(path, read_only=True, data_only=True)
    except Exception as error:  # of any library within: zip, XML
        raise ValueError(f"{name} cannot be read as a workbook: {sentence(error)}") from error
    try:
        return [
            _filled(
                (
                    ["" if cell is None else str(cell) for cell in row]
                    for row in islice(sheet.iter_rows(values_only=True), MOST_LINES)
                ),
                f"{name}, sheet {plain(sheet.title)}",
            )
            for sheet in book.worksheets
        ]
    finally:
        book.close()


def _filled(rows: Iterable[list[str]], where: str, has_comma: bool = False) -> Sheet:
    """The rows with text in them, with their line numbers."""
    filled = []
    for line, cells in enumerate(rows, 1):
        stripped = [cell.strip(" \t\"'\xa0") for cell in cells]
        while stripped and not stripped[-1]:
            stripped.pop()
        if stripped:
            filled.append(SheetRow(f"{where}, line {line}", tuple(stripped), has_comma))
    return filled
