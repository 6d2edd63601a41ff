"""Files of cells: text with separators, or the sheets of a workbook; errors name line and column."""

from __future__ import annotations

import csv
import math
import re
import warnings
import zipfile
from collections import Counter
from collections.abc import Iterator, Sequence
from io import BytesIO
from itertools import islice
from pathlib import Path
from typing import Any, NamedTuple

from stochlin.analyses.tables.inputs import read_input, read_text
from stochlin.analyses.tables.optional import needed
from stochlin.messages import brief, plain, sentence
from stochlin.models.parameters import Range

_WORKBOOK = b"PK\x03\x04"  # signature of .xlsx, which is a zip archive
_OLE = b"\xd0\xcf\x11\xe0"  # signature of .xls, and of .xlsx with a password
_SAMPLE = 50  # lines in which the separator is looked for
# The parts that hold tables, and what none of them has: comments, entities, very long texts.
_PART = re.compile(r"\[Content_Types\]\.xml|xl/(_rels/[^/]+\.rels|(worksheets/)?[^/]+\.xml)")
_STRANGE = re.compile(rb"<(?:!|\?(?!xml )|[^<]{200000})")
# A cell with a formula and without a value, or with an empty one, which is a result in cells of texts.
_WITHOUT_RESULT = re.compile(
    rb"<\w*:?c\b([^<>]*)>\s*<\w*:?f\b[^<>]*(?:/>|>[^<]*</\w*:?f>)"
    rb"(\s*<\w*:?v(?:\s*/>|>\s*</\w*:?v>))?\s*</\w*:?c>"
)
MOST_PARTS, MOST_BYTES, MOST_SIGNS = 2000, 16 * 2**20, 16 * 2**20  # of a workbook, unpacked
# What openpyxl takes for an element, in half microseconds, and how much a workbook may take.
_ELEMENT, _RANGES = re.compile(rb"<(?:\w+:)?(\w+)"), re.compile(rb"sqref\s*=[^<>]*")
_COSTS = {b"c": 8, b"v": 3, b"t": 3, b"f": 3, b"row": 25, b"si": 20, b"is": 30}
_OTHER, _ATTRIBUTE, MOST_COST = 50, 20, 5_000_000
_UNIT = re.compile(r"\s*(.*?)\s*[(\[](.*)[)\]]\s*")


class SheetRow(NamedTuple):
    """One line of a file with its cells; columns are counted from 0 here and from 1 in messages."""

    where: str  # file, sheet and line
    cells: tuple[str, ...]
    has_comma: bool = False  # columns are separated by commas, so that numbers have a point

    @property
    def sheet(self) -> str:
        """The file and the sheet."""
        return self.where.rpartition(", line ")[0]

    def cell(self, column: int) -> str:
        """The text of a cell; empty beyond the last one."""
        return self.cells[column] if column < len(self.cells) else ""

    def error(self, column: int | None, what: str) -> ValueError:
        """A ValueError at a cell, or at the whole line."""
        place = self.where if column is None else f"{self.where}, column {column + 1}"
        return ValueError(f"{place}: {what}")

    def check_width(self, width: int) -> None:
        """Raise a ValueError for cells beyond the columns, such as the rest of 190,000."""
        if len(self.cells) > width:
            what = f"{brief(self.cell(width))} is beyond the {width} columns above"
            raise self.error(width, f"{what}; allowed: no signs between thousands")

    def number(self, column: int, what: str, allowed: Range | None = None) -> float:
        """The number in a cell, which is ``what`` in messages; a ValueError if it is none."""
        if not (text := self.cell(column)):
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
    if content.startswith(_OLE):
        raise ValueError(f"{name} is an .xls workbook or has a password; save it as .xlsx without one")
    sheets = _workbook(content, name) if content.startswith(_WORKBOOK) else [_text(path, name)]
    if not any(sheets):
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
        first, second = (sheet[0].sheet for sheet in sheets[:2])
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


def without_comments(sheet: Sheet) -> Sheet:
    """The lines that do not begin with #."""
    return [row for row in sheet if not row.cell(0).startswith("#")]


def with_unit(title: str) -> tuple[str, str]:
    """The name and the unit in a title such as ``mass [kg]``, in lower case; the unit may be empty."""
    match = _UNIT.fullmatch(title)
    return (match[1].lower(), match[2]) if match else (title.strip().lower(), "")


def _text(path: Path, name: str) -> Sheet:
    lines = read_text(path).splitlines()
    first = list(islice((line for line in lines if line.strip()), _SAMPLE))
    separator = next((mark for mark in ";\t," if any(mark in line for line in first)), ",")
    rows = []
    for number, line in enumerate(lines, 1):
        where = f"{name}, line {number}"
        try:
            cells = _filled(next(csv.reader([line], delimiter=separator), []))
        except csv.Error as error:
            raise ValueError(f"{where}: {error}; allowed: cells of less text") from error
        if cells:
            rows.append(SheetRow(where, cells, separator == ","))
    return rows


def _workbook(content: bytes, name: str) -> list[Sheet]:
    """The sheets that are not hidden and not empty."""
    openpyxl = needed(
        "openpyxl", f"{name} is a workbook, which", "tables", "save its tables as one .csv file"
    )
    sheets: dict[str, list[SheetRow]] = {}
    try:
        with warnings.catch_warnings(action="ignore"):  # of formats, which are not read
            for title, line, row in _rows(openpyxl.reader.excel.ExcelReader, _unpacked(content)):
                if cells := _filled(row):
                    where = f"{name}, sheet {plain(title)}, line {line}"
                    sheets.setdefault(title, []).append(SheetRow(where, cells))
    except Exception as error:  # of any library within: zip, XML
        raise ValueError(
            f"{name} cannot be read as a workbook: {sentence(error.__cause__ or error)}; save it again "
            "in a spreadsheet program, or its tables as .csv files"
        ) from error
    return [*sheets.values()]


def _rows(kind: Any, archive: BytesIO) -> Iterator[tuple[str, int, list[str]]]:
    """Title, line and cells of the rows of all sheets that are not hidden."""
    reader = kind(archive, read_only=True, data_only=True, keep_links=False)
    reader.read_manifest()
    reader.read_workbook()
    parts = [relation.target for _, relation in reader.parser.find_sheets()]
    if len({*parts}) < len(parts):
        raise ValueError("two sheets are the same part of the file")
    reader.read()
    work = 0
    for sheet in (sheet for sheet in reader.wb.worksheets if sheet.sheet_state == "visible"):
        sheet.reset_dimensions()  # many programs write them wrong, and what is beyond is then lost
        for line, row in enumerate(sheet.iter_rows(values_only=True), 1):
            cells = ["" if cell is None else str(cell) for cell in row]
            work += 4 * (3 + len(cells)) + sum(map(len, cells))
            if work > MOST_SIGNS:
                raise ValueError(f"it is too long or too wide at line {line} of sheet {sheet.title}")
            yield sheet.title, line, cells


def _unpacked(content: bytes) -> BytesIO:
    """The tables of a workbook, not compressed; a ValueError if they take too much time or memory."""
    copy, cost = BytesIO(), 0
    if content.count(b"PK\x01\x02") > MOST_PARTS:  # signature of the entry of each
        raise ValueError(f"it has more than {MOST_PARTS} parts")
    with zipfile.ZipFile(BytesIO(content)) as archive, zipfile.ZipFile(copy, "w") as tables:
        parts = [part for part in archive.infolist() if _PART.fullmatch(part.filename)]
        if (size := sum(part.file_size for part in parts)) > MOST_BYTES:
            raise ValueError(f"its tables have {size} bytes unpacked; allowed: {MOST_BYTES}")
        if not {part.compress_type for part in parts} <= {zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED}:
            raise ValueError("it is packed in a way that spreadsheet programs do not use")
        for part in parts:
            with archive.open(part) as file:
                xml = file.read(part.file_size)  # which ends there, whatever follows
            if b"\0" in xml or _STRANGE.search(xml):
                raise ValueError(f"{part.filename} has a comment, an entity or a very long text")
            cost += _cost(xml)
            if cost > MOST_COST:
                raise ValueError("it has too many cells, texts or formats; allowed: about 250000 cells")
            empty = _WITHOUT_RESULT.findall(xml) if b"f>" in xml or b"<f" in xml else []
            if any(not value or b"str" not in cell for cell, value in empty):
                raise ValueError(f"{part.filename} has formulas without results")
            tables.writestr(part.filename, xml)
    return copy


def _cost(xml: bytes) -> int:
    """The time that openpyxl takes for a part of a workbook."""
    cost, usual = xml.count(b"<"), sum(map(xml.count, (b" r=", b" s=", b" t=")))
    cost += _ATTRIBUTE * (xml.count(b"=") - usual)
    cost += sum(5 * len(text) + len(text) ** 2 // 60 for text in _RANGES.findall(xml))
    if cost < MOST_COST:  # else its elements might not even be counted
        counts = Counter(_ELEMENT.findall(xml))
        cost += sum(_COSTS.get(name, _OTHER) * count for name, count in counts.items())
    return cost


def _filled(cells: list[str]) -> tuple[str, ...]:
    """The cells up to the last one with text, without what surrounds them."""
    stripped = [cell.strip(" \t\"'\xa0") for cell in cells]
    while stripped and not stripped[-1]:
        stripped.pop()
    return tuple(stripped)
