"""Workbooks (.xlsx): the cells of their visible sheets, within limits of time and memory."""

from __future__ import annotations

import re
import subprocess
import zipfile
from io import BytesIO
from pathlib import Path

from stochlin.applications.sheets import workbook_rows
from stochlin.applications.sheets.workbook_rows import (
    CELL_SIGN,
    EXIT_REFUSED,
    MOST_MEMORY,
    PROCESSOR_SECONDS,
    ROW_SIGN,
    SHEET_SIGN,
)
from stochlin.kernels.basics.children import isolated
from stochlin.messages import plain, sentence
from stochlin.solver.tables.checks import needed

# The parts that hold tables.
_TABLE_PART = re.compile(
    r"\[Content_Types\]\.xml|_rels/\.rels|xl/(_rels/[^/]+\.rels|(worksheets/)?[^/]+\.xml)"
)
# A cell with a formula and without a value, or with an empty one, which is a result in cells of
# texts.
_WITHOUT_RESULT = re.compile(
    rb"<\w*:?c\b([^<>]*)>\s*<\w*:?f\b[^<>]*(?:/>|>[^<]*</\w*:?f>)"
    rb"(\s*<\w*:?v(?:\s*/>|>\s*</\w*:?v>))?\s*</\w*:?c>"
)
_METHODS = zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED  # others take memory that they do not state
# s that reading may take on a busy machine, and on one that does not limit its time
_PATIENCE = 20.0
MOST_PARTS = 2000  # of a workbook
UNPACKED_BYTES = 16 * 2**20  # of a workbook


def rows_of(content: bytes, name: str) -> list[tuple[str, dict[int, list[str]]]]:
    """Title and cells by line of each visible sheet; a ValueError if they cannot be read.

    They are read in a process of their own, which takes at most `MOST_MEMORY` and
    `PROCESSOR_SECONDS`, whatever the workbook is; only its unpacked parts, of at most
    `UNPACKED_BYTES`, are in the memory of this one.
    """
    what = f"{name} is a workbook, which"
    calamine = needed("python_calamine", what, "tables", "save its tables as .csv")
    try:
        answer = _read_apart(_unpacked(content), Path(calamine.__file__).parents[1])
    except Exception as error:  # of any library within: zip, XML
        what = f"{name} cannot be read as a workbook: {sentence(error)}"
        raise ValueError(f"{what}; save it again as .xlsx without a password, or as .csv") from None
    sheets = (sheet.split(ROW_SIGN) for sheet in answer.split(SHEET_SIGN) if answer)
    return [
        (plain(title), {line: row.split(CELL_SIGN) for line, row in enumerate(rows, 1)})
        for title, *rows in sheets
    ]


def _read_apart(content: bytes, library: Path) -> str:
    """What the program `workbook_rows` writes; a ValueError with its reason if it does not."""
    command = isolated(Path(workbook_rows.__file__), str(library))
    most = f"reading may take {MOST_MEMORY >> 20} MiB and {PROCESSOR_SECONDS} s"
    try:
        done = subprocess.run(
            command, input=content, capture_output=True, timeout=_PATIENCE, check=False
        )
    except subprocess.TimeoutExpired:
        raise ValueError(f"it takes more than {_PATIENCE:g} s; {most}") from None
    answer = done.stdout.decode("utf-8", "replace")
    if done.returncode == EXIT_REFUSED:
        raise ValueError(answer)
    if done.returncode != 0:
        raise ValueError(f"it is damaged, or takes more memory or time; {most}")
    return answer


def _unpacked(content: bytes) -> bytes:
    """The tables of a workbook, uncompressed; a ValueError if they take too much time or memory."""
    copy = BytesIO()
    if content.count(b"PK\x01\x02") > MOST_PARTS:  # signature of the entry of each
        raise ValueError(f"it has more than {MOST_PARTS} parts")
    with zipfile.ZipFile(BytesIO(content)) as archive, zipfile.ZipFile(copy, "w") as tables:
        parts = [part for part in archive.infolist() if _TABLE_PART.fullmatch(part.filename)]
        if (size := sum(part.file_size for part in parts)) > UNPACKED_BYTES:
            raise ValueError(f"its tables have {size} bytes unpacked; allowed: {UNPACKED_BYTES}")
        if len({part.filename for part in parts}) < len(parts):
            raise ValueError("it has a part twice")
        for part in parts:
            if part.compress_type not in _METHODS:
                raise ValueError(f"{part.filename} is not compressed as in a workbook")
            with archive.open(part) as file:
                xml = file.read(part.file_size)  # which ends there, whatever follows
            empty = _WITHOUT_RESULT.finditer(xml) if b"f>" in xml or b"<f" in xml else []
            if any(not cell[2] or b"str" not in cell[1] for cell in empty):
                raise ValueError(f"{part.filename} has formulas without results")
            tables.writestr(part.filename, xml)
    return copy.getvalue()
