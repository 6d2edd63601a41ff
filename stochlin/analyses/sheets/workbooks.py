"""Workbooks (.xlsx): the cells of their visible sheets, within limits of time and memory."""

from __future__ import annotations

import re
import warnings
import zipfile
from io import BytesIO
from typing import Any

from stochlin.analyses.tables.optional import needed
from stochlin.messages import plain, sentence

# The parts that hold tables, and what none of them has: comments, entities, very long texts.
_PART = re.compile(r"\[Content_Types\]\.xml|xl/(_rels/[^/]+\.rels|(worksheets/)?[^/]+\.xml)")
_STRANGE = re.compile(rb"<(?:!|\?(?!xml )|[^<]{200000})")
# A cell with a formula and without a value, or with an empty one, which is a result in cells of texts.
_WITHOUT_RESULT = re.compile(
    rb"<\w*:?c\b([^<>]*)>\s*<\w*:?f\b[^<>]*(?:/>|>[^<]*</\w*:?f>)"
    rb"(\s*<\w*:?v(?:\s*/>|>\s*</\w*:?v>))?\s*</\w*:?c>"
)
MOST_PARTS, MOST_BYTES, MOST_SIGNS = 2000, 16 * 2**20, 16 * 2**20  # of a workbook, unpacked
# What openpyxl takes for a sign < of cells and texts, a row, another element and an attribute, in half
# microseconds, and how much a workbook may take.
_SIGN, _ROW, _OTHER, _ATTRIBUTE, MOST_COST = 5, 10, 50, 20, 5_000_000
_OTHERS, _RANGES = re.compile(rb"<(?![/?]|(?:\w+:)?(?:c|v|t|f|is|si|row)[\s/>])"), rb"sqref\s*=[^<>]*"


def rows_of(content: bytes, name: str) -> dict[str, dict[int, list[str]]]:
    """The cells of the visible sheets by title and line; a ValueError if they cannot be read."""
    openpyxl = needed("openpyxl", f"{name} is a workbook, which", "tables", "save its tables as .csv")
    try:
        with warnings.catch_warnings(action="ignore"):  # of formats, which are not read
            return _rows(openpyxl.reader.excel.ExcelReader, _unpacked(content))
    except Exception as error:  # of any library within: zip, XML
        what = f"{name} cannot be read as a workbook: {sentence(error.__cause__ or error)}"
        raise ValueError(f"{what}; save it again as .xlsx without a password, or as .csv") from None


def _rows(kind: Any, archive: BytesIO) -> dict[str, dict[int, list[str]]]:
    """The cells of all sheets that are not hidden, by title and line."""
    reader = kind(archive, read_only=True, data_only=True, keep_links=False)
    reader.read_manifest()
    reader.read_workbook()
    parts = [relation.target for _, relation in reader.parser.find_sheets()]
    if len({*parts}) < len(parts):
        raise ValueError("two sheets are the same part of the file")
    reader.read()
    sheets: dict[str, dict[int, list[str]]] = {}
    work = 0
    for sheet in (sheet for sheet in reader.wb.worksheets if sheet.sheet_state == "visible"):
        rows = sheets[plain(sheet.title)] = {}
        sheet.reset_dimensions()  # many programs write them wrong, and what is beyond is then lost
        for line, row in enumerate(sheet.iter_rows(values_only=True), 1):
            rows[line] = cells = ["" if cell is None else str(cell) for cell in row]
            work += 4 * (3 + len(cells)) + sum(map(len, cells))
            if work > MOST_SIGNS:
                raise ValueError(
                    f"it is too long or too wide at line {line} of sheet {plain(sheet.title)}"
                )
    return sheets


def _unpacked(content: bytes) -> BytesIO:
    """The tables of a workbook, not compressed; a ValueError if they take too much time or memory."""
    copy, cost = BytesIO(), 0
    if content.count(b"PK\x01\x02") > MOST_PARTS:  # signature of the entry of each
        raise ValueError(f"it has more than {MOST_PARTS} parts")
    with zipfile.ZipFile(BytesIO(content)) as archive, zipfile.ZipFile(copy, "w") as tables:
        parts = [part for part in archive.infolist() if _PART.fullmatch(part.filename)]
        if (size := sum(part.file_size for part in parts)) > MOST_BYTES:
            raise ValueError(f"its tables have {size} bytes unpacked; allowed: {MOST_BYTES}")
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
    usual = sum(map(xml.count, (b" r=", b" s=", b" t=")))
    cost = _SIGN * xml.count(b"<") + _ROW * xml.count(b"row") + _ATTRIBUTE * (xml.count(b"=") - usual)
    cost += sum(5 * len(text) + len(text) ** 2 // 60 for text in re.findall(_RANGES, xml))
    return cost + (_OTHER * len(_OTHERS.findall(xml)) if cost < MOST_COST else 0)
