"""Record files: the registered formats, and columns of text, read without conversion of units."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from io import StringIO
from itertools import islice
from pathlib import Path

import numpy as np
import numpy.typing as npt

from stochlin.analyses.records.formats import (
    FORMATS,
    HEADER_LINES,
    Format,
    Line,
    RecordFile,
    Series,
    as_float,
    as_numbers,
    without_comment,
)
from stochlin.analyses.tables.inputs import read_text
from stochlin.messages import brief, listed, plain
from stochlin.models.arguments import is_label, is_whole

Column = int | str

METRES = {"g": 9.80665, "m/s^2": 1.0, "cm/s^2": 0.01, "mm/s^2": 0.001}
_SPELLINGS = {"gal": "cm/s^2"} | {
    f"{length}/{spelling}": f"{length}/s^2"
    for length in ("m", "cm", "mm")
    for spelling in ("s2", "s/s", "s**2", "sec/sec", "sec^2", "sec2")
}
_SECONDS = {"s", "sec", "second", "seconds"}

# Units in column names that are not of a known acceleration.
_OTHER_UNITS = re.compile(r"(mm|cm|m|km|in|ft|ms|hz|rad|deg)([/^*][\w/^*.-]*)?")
_COMMA = re.compile(r"[-+]?\d+,\d{2,}")
_DECIMAL_COMMA = re.compile(r"(^|;)\s*[-+]?\d*,\d")  # in a field between semicolons
_DECIMAL_POINT = re.compile(r"(^|;)\s*[-+]?\d*\.\d+(e[-+]?\d+)?\s*(;|$)", re.IGNORECASE)
_SAMPLE = 100  # lines checked for decimal commas
_LINE_ENDS = ("\r\n", *"\r\x0b\x0c\x1c\x1d\x1e\x85\u2028\u2029")


def read_series(
    path: Path,
    column: Column | None,
    time_column: Column | None,
    component: Column | None = None,
) -> Series:
    """Read a record file of any format."""
    name, text = plain(path.name), _text(path)
    head = list(islice(_content(text), HEADER_LINES))
    if not head:
        raise ValueError(f"{name} is empty: it holds no line of numbers")
    if component is not None and not (is_whole(component) or is_label(component)):
        raise ValueError(f"component = {brief(component)}; allowed: the name or the number of one")
    first = "\n".join(line for _, line in head)
    of = next((of for of in FORMATS.values() if of.header.search(first)), None)
    if of is None:
        series = _read_columns(text, head[0], name, column, time_column)
        return _named(series, component)
    if column is not None or time_column is not None:
        raise ValueError(
            f"column and time_column do not apply: {name} is {of.title}; allowed: component"
        )
    series = _component(of, of.read(RecordFile(name, text.split("\n"))), component, name)
    known = series.units and acceleration_units(series.units, f"{name}: units")
    return series._replace(units=known)


def _component(of: Format, series: Sequence[Series], component: Column | None, name: str) -> Series:
    """The series of the component that is asked for, or the only one."""
    if not of.has_components:
        return _named(series[0], component)
    names = [channel.about.get("component", "") for channel in series]
    known = ", ".join(f"{n} ({plain(text)})" if text else f"{n}" for n, text in enumerate(names, 1))
    if component is None:
        if len(series) == 1:
            return series[0]
        raise ValueError(f"component is missing: {name} has {known}; give component=")
    wanted = _letters(component)
    fitting = [n for n, text in enumerate(names) if wanted and _letters(text) == wanted]
    if not fitting and wanted in map(str, range(1, len(series) + 1)):
        fitting = [int(wanted) - 1]
    if len(fitting) != 1:
        count = "is more than one" if fitting else "is not"
        raise ValueError(f"component = {brief(component)} {count} in {name}; allowed: {known}")
    return series[fitting[0]]


def _named(series: Series, component: Column | None) -> Series:
    """The only component of a file, with the name that is given for it."""
    return (
        series
        if component is None
        else series._replace(about={**series.about, "component": str(component)})
    )


def _letters(text: object) -> str:
    return re.sub(r"\W|_", "", str(text)).upper()


def is_record(name: str) -> bool:
    """Whether a file has the ending of a record, also if it is compressed by gzip."""
    endings = "|".join(["txt", "csv", "dat", "acc", *(of.endings for of in FORMATS.values())])
    return re.search(rf"\.({endings})(\.gz)?$", name, re.IGNORECASE) is not None


def _text(path: Path) -> str:
    """Text of the file with one kind of line ends."""
    text = read_text(path)
    for other in _LINE_ENDS:
        text = text.replace(other, "\n")
    return text


def _content(text: str, start: int = 0) -> Iterator[Line]:
    """Numbered lines after the first ``start``, without comments, empty lines and white space."""
    for number, line in enumerate(StringIO(text), 1):
        kept = without_comment(line)
        if kept and number > start:
            yield number, kept


def _read_columns(
    text: str, first: Line, name: str, column: Column | None, time_column: Column | None
) -> Series:
    number, line = first
    separator = next((mark for mark in ";," if mark in line), None)
    names = _column_names(line, separator)
    start = number if names else 0
    if separator == ",":
        _refuse_decimal_commas(text, start, name)
    if separator == ";":
        text = _with_points(text, start, name)
    if next(_content(text, start), None) is None:
        raise ValueError(f"{name} is empty: it holds no line of numbers")
    rows: list[tuple[int, list[str]]] = []
    table = _plain_table(text, start, separator)
    if table is None or len(names) not in (0, table.shape[1]):
        table, rows = None, [(n, _fields(content, separator)) for n, content in _content(text, start)]
    width = len(names) or (len(rows[0][1]) if table is None else table.shape[1])
    for n, fields in rows:
        if len(fields) != width:
            raise ValueError(
                f"{name}, line {n}: {len(fields)} columns, but line {number} has {width}; "
                "start a title with #, fill what is missing; numbers that run on need an AT2 header"
            )
    time_index = None if time_column is None else _index("time_column", time_column, names, width, name)
    index = _data_index(column, time_index, names, width, name)
    stated = _bracketed(names[index]) if names else None
    if stated is not None and stated not in METRES and _OTHER_UNITS.fullmatch(stated):
        raise ValueError(
            f"column {brief(names[index])} of {name} is in {plain(stated)}, which is no acceleration "
            f"that is known; allowed: {allowed_units()}"
        )
    if time_index is not None and names and (_bracketed(names[time_index]) or "s") not in _SECONDS:
        raise ValueError(
            f"time_column = {brief(time_column)} is named {brief(names[time_index])}; "
            "allowed: time in seconds"
        )

    def series(index: int) -> npt.NDArray[np.float64]:
        if table is not None:
            return table[:, index].copy()
        return as_numbers([(n, fields[index]) for n, fields in rows], name)

    times = None if time_index is None else series(time_index)
    known = stated if stated in METRES else None
    return Series(series(index), times, None, known, names[index] if names else "")


def rows_in_words(path: Path) -> list[str]:
    """Name of file, line and row for each row of numbers, for messages."""
    name, text = plain(path.name), _text(path)
    number, line = next(_content(text))
    separator = next((mark for mark in ";," if mark in line), None)
    start = number if _column_names(line, separator) else 0
    lines = (number for number, _ in _content(text, start))
    return [f"{name}, line {number}, row {row}" for row, number in enumerate(lines, 1)]


def _refuse_decimal_commas(text: str, start: int, name: str) -> None:
    """Raise a ValueError for numbers such as ``0,05``, which would be read as 0 and 5."""
    lines = [line for _, line in islice(_content(text, start), _SAMPLE)]
    if all(_COMMA.fullmatch(line) for line in lines) and any(",0" in line for line in lines):
        raise ValueError(
            f"{name} seems to have decimal commas, as in {brief(lines[0])}; write numbers with a point, "
            "or separate the columns by semicolons"
        )


def _with_points(text: str, start: int, name: str) -> str:
    """The text with decimal points for the decimal commas between semicolons."""
    lines = text.split("\n")
    commas, points = (
        next((n for n, line in enumerate(lines[start:], start + 1) if mark.search(line)), None)
        for mark in (_DECIMAL_COMMA, _DECIMAL_POINT)
    )
    if commas is None:
        return text
    if points is not None:
        raise ValueError(
            f"{name} has decimal points in line {points} and decimal commas in line {commas}; "
            "allowed: one of them"
        )
    return "\n".join([*lines[:start], *(line.replace(",", ".") for line in lines[start:])])


def _plain_table(text: str, start: int, separator: str | None) -> npt.NDArray[np.float64] | None:
    """The columns after ``start`` lines, or None unless all lines have equally many finite numbers."""
    try:
        table = np.loadtxt(
            StringIO(text), comments=("#", "%"), delimiter=separator, skiprows=start, ndmin=2
        )
    except ValueError:
        return None
    return table if np.isfinite(table).all() else None


def _fields(text: str, separator: str | None) -> list[str]:
    fields = [field.strip(" \t\"'") for field in text.split(separator)]
    return fields[:-1] if separator and not fields[-1] else fields


def _column_names(text: str, separator: str | None) -> list[str]:
    """Names of the columns in a first line without numbers; empty if it is a line of data."""
    fields = _fields(text, "\t" if separator is None and "\t" in text else separator)
    return fields if all(re.match(r"[^-+.\d]|$", f) and as_float(f) is None for f in fields) else []


def _data_index(
    column: Column | None, time_index: int | None, names: Sequence[str], width: int, name: str
) -> int:
    if column is None:
        left = [i for i in range(width) if i != time_index]
        if len(left) != 1:
            raise ValueError(
                f"column is missing: {name} has {_allowed_columns(names, width)}; give column="
            )
        return left[0]
    index = _index("column", column, names, width, name)
    if index == time_index:
        raise ValueError(
            f"column = {brief(column)} is the time_column as well; allowed: two different columns"
        )
    return index


def _index(parameter: str, column: Column, names: Sequence[str], width: int, name: str) -> int:
    if isinstance(column, str) and column in names:
        return names.index(column)
    if is_whole(column) and 0 <= column < width:
        return column
    raise ValueError(
        f"{parameter} = {brief(column)} is not in {name}, which has {_allowed_columns(names, width)}"
    )


def _allowed_columns(names: Sequence[str], width: int) -> str:
    return f"{width} columns (index 0 to {width - 1})" + (f" named {listed(names)}" if names else "")


def acceleration_units(units: str, parameter: str) -> str:
    """Units of acceleration in the spelling of `METRES`; a ValueError if they are unknown."""
    known = spelled(units)
    if known not in METRES:
        raise ValueError(
            f"{parameter} = {brief(units)} is not a unit of acceleration; allowed: {allowed_units()}"
        )
    return known


def spelled(units: object) -> str:
    """Units in lower case and in one spelling of per second squared."""
    lower = str(units).strip().lower()
    return _SPELLINGS.get(lower, lower)


def allowed_units() -> str:
    """All known units in one line, for error messages."""
    return ", ".join(f"{unit!r}" for unit in (*METRES, "gal"))


def stated_units(series: Series, name: str, units: str | None) -> str:
    """Units of a file, as given or stated in it; a ValueError if neither is the case or they differ."""
    if units and series.units and units != series.units:
        raise ValueError(
            f"units = {brief(units)} contradicts {name}, which states {brief(series.units)}; correct "
            "it, or leave it out"
        )
    stated = units or series.units
    if stated is None:
        raise ValueError(f"units is missing and {name} does not state it; allowed: {allowed_units()}")
    return stated


def _bracketed(column: str) -> str | None:
    """Unit in a column name such as ``acc [g]``."""
    unit = re.search(r"[(\[](.+)[)\]]", column)
    return spelled(unit[1]) if unit else None
