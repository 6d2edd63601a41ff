"""Workbooks (.xlsx): the cells of their visible sheets, within limits of time and memory."""

from __future__ import annotations

import re
import zipfile
from functools import reduce
from io import BytesIO

from stochlin.messages import plain, sentence
from stochlin.solver.tables.checks import needed

# The parts that hold tables.
_PART = re.compile(
    r"\[Content_Types\]\.xml|_rels/\.rels|xl/(_rels/[^/]+\.rels|(worksheets/)?[^/]+\.xml)"
)
_CELL, _ROW = re.compile(rb"<(?:\w+:)?c[\s/>]"), re.compile(rb"<(?:\w+:)?row[\s/>]")
_PLACE = re.compile(rb"\sr\s*=\s*[\"']\s*([A-Za-z]*)(\d*)")
# A cell with a formula and without a value, or with an empty one, which is a result in cells of texts.
_WITHOUT_RESULT = re.compile(
    rb"<\w*:?c\b([^<>]*)>\s*<\w*:?f\b[^<>]*(?:/>|>[^<]*</\w*:?f>)"
    rb"(\s*<\w*:?v(?:\s*/>|>\s*</\w*:?v>))?\s*</\w*:?c>"
)
MOST_PARTS, MOST_BYTES, MOST_CELLS = 2000, 16 * 2**20, 2**23  # of a workbook and of a sheet


def rows_of(content: bytes, name: str) -> dict[str, dict[int, list[str]]]:
    """The cells of the visible sheets by title and line; a ValueError if they cannot be read."""
    what = f"{name} is a workbook, which"
    calamine = needed("python_calamine", what, "tables", "save its tables as .csv")
    try:
        book = calamine.CalamineWorkbook.from_filelike(_unpacked(content))
        visible = calamine.SheetVisibleEnum.Visible
        titles = [sheet.name for sheet in book.sheets_metadata if sheet.visible == visible]
        sheets = {title: book.get_sheet_by_name(title).to_python(False) for title in titles}
    except Exception as error:  # of any library within: zip, XML
        what = f"{name} cannot be read as a workbook: {sentence(error.__cause__ or error)}"
        raise ValueError(f"{what}; save it again as .xlsx without a password, or as .csv") from None
    return {
        plain(title): {line: [*map(_text, row)] for line, row in enumerate(rows, 1)}
        for title, rows in sheets.items()
    }


def _text(value: object) -> str:
    """A cell as a text; whole numbers are written without decimals, as a workbook shows them."""
    return str(int(value)) if isinstance(value, float) and value.is_integer() else str(value)


def _unpacked(content: bytes) -> BytesIO:
    """The tables of a workbook, not compressed; a ValueError if they take too much time or memory."""
    copy = BytesIO()
    if content.count(b"PK\x01\x02") > MOST_PARTS:  # signature of the entry of each
        raise ValueError(f"it has more than {MOST_PARTS} parts")
    with zipfile.ZipFile(BytesIO(content)) as archive, zipfile.ZipFile(copy, "w") as tables:
        parts = [part for part in archive.infolist() if _PART.fullmatch(part.filename)]
        if (size := sum(part.file_size for part in parts)) > MOST_BYTES:
            raise ValueError(f"its tables have {size} bytes unpacked; allowed: {MOST_BYTES}")
        for part in parts:
            with archive.open(part) as file:
                xml = file.read(part.file_size)  # which ends there, whatever follows
            if (cells := _most_cells(xml)) > MOST_CELLS:
                raise ValueError(f"{part.filename} has up to {cells} cells; allowed: {MOST_CELLS}")
            empty = _WITHOUT_RESULT.findall(xml) if b"f>" in xml or b"<f" in xml else []
            if any(not value or b"str" not in cell for cell, value in empty):
                raise ValueError(f"{part.filename} has formulas without results")
            tables.writestr(part.filename, xml)
    copy.seek(0)
    return copy


def _most_cells(xml: bytes) -> int:
    """Most cells, also empty ones, that a sheet may have by the numbers and places of its cells."""
    names, lines = zip((b"", b""), *_PLACE.findall(xml), strict=True)
    last = max(names, key=lambda name: (len(name), name.upper())).upper()
    column = reduce(lambda number, letter: 26 * number + letter - 64, last, 0)
    rows = _ROW.split(xml)
    height = len(rows) + max(int(line or 0) for line in lines)
    return height * (column + max(len(_CELL.findall(row)) for row in rows))
