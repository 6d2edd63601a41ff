"""A program apart: the cells of a workbook, from standard input to standard output, within limits.

Whatever a workbook makes its reader do, this process ends within them, and no other one notices. It
is run by its path, with the folder of python-calamine, and imports nothing that it does not need,
since it is started for each workbook. Where a system has no such limits, as Windows, time alone is
bounded.
"""

from __future__ import annotations

import sys
from io import BytesIO

TYPE_CHECKING = False  # without typing, whose import takes longer than a small workbook
if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

MOST_MEMORY = 256 * 2**20  # bytes that reading may take
PROCESSOR_SECONDS = 2  # of processor time that it may take
MOST_CELLS_OF_SHEETS = 2**20  # of all visible sheets, with the empty ones between others
# of all of them; what reads the table afterwards takes longest for each line
MOST_LINES_OF_SHEETS = 100_000
MOST_SIGNS = 2**24  # of the texts of all of them
# signs between them, which no text in XML may contain
SHEET_SIGN = "\x1d"
ROW_SIGN = "\x1e"
CELL_SIGN = "\x1f"
EXIT_REFUSED = 3  # exit status, with a message in place of cells


def take_limits() -> None:
    """Let the system end this process when it takes more, without a memory image on the disk."""
    try:
        import resource
    except ImportError:
        return
    limits = {"RLIMIT_AS": MOST_MEMORY, "RLIMIT_CPU": PROCESSOR_SECONDS, "RLIMIT_CORE": 0}
    for name, most in limits.items():
        try:
            resource.setrlimit(getattr(resource, name), (most, most))
        except (AttributeError, ValueError, OSError):  # the system does not know it
            continue


def text_of(value: object) -> str:
    """A cell as a text; whole numbers are written without decimals, as a workbook shows them."""
    return str(int(value)) if isinstance(value, float) and value.is_integer() else str(value)


def text_rows(sheet: Iterable[Sequence[object]]) -> list[list[str]]:
    """The lines of a sheet up to their last cell that is not empty."""
    rows = []
    for row in sheet:
        last = max((n for n, cell in enumerate(row, 1) if cell != ""), default=0)
        rows.append([text_of(cell) for cell in row[:last]])
    return rows


def visible_sheets(content: bytes) -> dict[str, list[list[str]]]:
    """The lines of all sheets that are shown, by title."""
    import python_calamine as calamine

    book = calamine.CalamineWorkbook.from_filelike(BytesIO(content))
    visible = calamine.SheetVisibleEnum.Visible
    titles = [sheet.name for sheet in book.sheets_metadata]
    if len({*titles}) < len(titles):  # of which a reader takes one for the other
        raise ValueError("it has two sheets of the same title")
    shown = [sheet.name for sheet in book.sheets_metadata if sheet.visible == visible]
    return {title: text_rows(book.get_sheet_by_name(title).to_python(False)) for title in shown}


def joined(sheets: dict[str, list[list[str]]]) -> str:
    """The sheets as one text, each with its title before its lines."""
    cells = sum(len(rows) * max(map(len, rows), default=0) for rows in sheets.values())
    if cells > MOST_CELLS_OF_SHEETS:
        raise ValueError(f"it has {cells} cells; allowed: {MOST_CELLS_OF_SHEETS}")
    count = sum(map(len, sheets.values()))
    if count > MOST_LINES_OF_SHEETS:
        raise ValueError(f"it has {count} lines; allowed: {MOST_LINES_OF_SHEETS}")
    signs = sum(len(cell) for rows in sheets.values() for row in rows for cell in row)
    if signs > MOST_SIGNS:
        raise ValueError(f"its texts have {signs} signs; allowed: {MOST_SIGNS}")
    lines = {title: [CELL_SIGN.join(row) for row in rows] for title, rows in sheets.items()}
    text = SHEET_SIGN.join(ROW_SIGN.join([title, *rows]) for title, rows in lines.items())
    counts = {
        SHEET_SIGN: max(len(sheets) - 1, 0),
        ROW_SIGN: count,
        CELL_SIGN: sum(max(len(row) - 1, 0) for rows in sheets.values() for row in rows),
    }
    if any(text.count(sign) != count for sign, count in counts.items()):
        raise ValueError("it has control characters in its texts")
    return text


if __name__ == "__main__":
    take_limits()
    sys.path.append(sys.argv[1])
    status = 0
    try:
        answer = joined(visible_sheets(sys.stdin.buffer.read()))
    except Exception as error:
        status = EXIT_REFUSED
        answer = str(error.__cause__ or error) or type(error).__name__
    sys.stdout.buffer.write(answer.encode("utf-8", "replace"))
    sys.stdout.flush()
    sys.exit(status)
