"""Record files: PEER AT2 and columns of text, read without conversion of units."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from io import StringIO
from itertools import islice
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from stochlin.analyses.tables.inputs import read_text
from stochlin.messages import brief, listed, plain
from stochlin.models.arguments import is_whole

Column = int | str
Line = tuple[int, str]
"""Line number in the file, from 1, and its text."""

METRES = {"g": 9.80665, "m/s^2": 1.0, "cm/s^2": 0.01, "mm/s^2": 0.001}
_SPELLINGS = {"gal": "cm/s^2"} | {
    f"{length}/{spelling}": f"{length}/s^2"
    for length in ("m", "cm", "mm")
    for spelling in ("s2", "s/s", "s**2", "sec/sec", "sec^2")
}
_SECONDS = {"s", "sec", "second", "seconds"}

_NUMBER = r"([-+.\dEeDd]+)"
_AT2_DIALECTS = (
    re.compile(rf"NPTS\s*=\s*(\d{{1,15}})\s*,?\s*DT\s*=\s*{_NUMBER}", re.IGNORECASE),
    re.compile(rf"^\s*(\d{{1,15}})\s+{_NUMBER}\s+NPTS\s*,\s*DT", re.IGNORECASE),
)
_AT2_UNITS = re.compile(r"UNITS\s+OF\s+([^\s,]+)", re.IGNORECASE)
_OF_PEER = re.compile(r"STRONG.MOTION", re.IGNORECASE)  # first line of a file whose second is a title
_AT2_HEADER_LINES = 8
# Units in column names that are not of a known acceleration.
_OTHER_UNITS = re.compile(r"(mm|cm|m|km|in|ft|ms|hz|rad|deg)([/^*][\w/^*.-]*)?")
_COMMA = re.compile(r"[-+]?\d+,\d{2,}")
_SAMPLE = 100  # lines checked for decimal commas
_LINE_ENDS = ("\r\n", *"\r\x0b\x0c\x1c\x1d\x1e\x85\u2028\u2029")


class Series(NamedTuple):
    """Content of a record file: accelerations as written, and time, time step and units if stated."""

    values: npt.NDArray[np.float64]
    time: npt.NDArray[np.float64] | None
    dt: float | None
    units: str | None
    column: str = ""  # name of the column
    about: Mapping[str, str] = MappingProxyType({})  # event, station and component, if stated


def read_series(path: Path, column: Column | None, time_column: Column | None) -> Series:
    """Read a record file of either format."""
    name, text = plain(path.name), _text(path)
    head = list(islice(_content(text), _AT2_HEADER_LINES))
    if not head:
        raise ValueError(f"{name} is empty: it holds no line of numbers")
    header = next((i for i, (_, line) in enumerate(head) if "NPTS" in line.upper()), None)
    if header is None:
        return _read_columns(text, head[0], name, column, time_column)
    if column is None and time_column is None:
        return _read_at2(text, head[: header + 1], name)
    raise ValueError(f"column and time_column do not apply: {name} is an AT2 file of one series")


def _text(path: Path) -> str:
    """Text of the file, with ``#`` for each comment sign and one kind of line ends."""
    text = read_text(path)
    for other in _LINE_ENDS:
        text = text.replace(other, "\n")
    return text.replace("%", "#")  # both start a comment


def _content(text: str, start: int = 0) -> Iterator[Line]:
    """Numbered lines after the first ``start``, without comments, empty lines and white space.

    The control-Z at the end of old DOS files is dropped.
    """
    for number, line in enumerate(StringIO(text), 1):
        kept = line.partition("#")[0].strip(" \t\n\x1a")
        if kept and number > start:
            yield number, kept


def _read_at2(text: str, head: Sequence[Line], name: str) -> Series:
    number, stated = head[-1]
    match = next((header for pattern in _AT2_DIALECTS if (header := pattern.search(stated))), None)
    dt = _float(match[2]) if match else None
    if match is None or dt is None or not 0 < dt < math.inf:
        raise ValueError(
            f"{name}, line {number}: {brief(stated)} is not the header of an AT2 file; "
            "allowed: 'NPTS= 5372, DT= .0100 SEC' or '4096 0.0100 NPTS, DT'"
        )
    units = next((unit[1] for _, line in head[:-1] if (unit := _AT2_UNITS.search(line))), None)
    values = _plain_series(text, number)
    if values is None:
        fields = [(n, field) for n, line in _content(text, number) for field in line.split()]
        values = _numbers(fields, name)
    if values.size != int(match[1]):
        raise ValueError(
            f"{name} holds {values.size} values, but line {number} states NPTS = {match[1]}; "
            "the file is cut or damaged: fetch it again"
        )
    known = units and acceleration_units(units, f"{name}: units")
    return Series(values, None, dt, known, about=_at2_title(text))


def _at2_title(text: str) -> dict[str, str]:
    """Event, station and component in PEER's second line: ``Kobe, 1/16/1995, Nishi-Akashi, 090``."""
    lines = text.split("\n", 2)
    if not _OF_PEER.search(lines[0]):
        return {}
    *event, station, component = (part.strip() for part in f",,{lines[1]}".split(","))
    known = any(event) and station and component
    named = {"event": ", ".join(filter(None, event)), "station": station, "component": component}
    return named if known else {}


def _plain_series(text: str, header: int) -> npt.NDArray[np.float64] | None:
    """The numbers after ``header`` lines, or None if there is anything else."""
    start = 0
    for _ in range(header):
        start = text.find("\n", start) + 1
    try:
        values = np.array(text[start:].split(), dtype=float)
    except ValueError:
        return None
    return values if np.isfinite(values).all() else None


def _read_columns(
    text: str, first: Line, name: str, column: Column | None, time_column: Column | None
) -> Series:
    number, line = first
    separator = next((mark for mark in ";," if mark in line), None)
    names = _column_names(line, separator)
    start = number if names else 0
    if separator == ",":
        _refuse_decimal_commas(text, start, name)
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
        return _numbers([(n, fields[index]) for n, fields in rows], name)

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
            f"{name} seems to have decimal commas, as in {brief(lines[0])}; write numbers with a point"
        )


def _plain_table(text: str, start: int, separator: str | None) -> npt.NDArray[np.float64] | None:
    """The columns after ``start`` lines, or None unless all lines have equally many finite numbers."""
    try:
        table = np.loadtxt(StringIO(text), comments="#", delimiter=separator, skiprows=start, ndmin=2)
    except ValueError:
        return None
    return table if np.isfinite(table).all() else None


def _fields(text: str, separator: str | None) -> list[str]:
    fields = [field.strip(" \t\"'") for field in text.split(separator)]
    return fields[:-1] if separator and not fields[-1] else fields


def _column_names(text: str, separator: str | None) -> list[str]:
    """Names of the columns in a first line without numbers; empty if it is a line of data."""
    fields = _fields(text, "\t" if separator is None and "\t" in text else separator)
    return fields if all(re.match(r"[^-+.\d]|$", f) and _float(f) is None for f in fields) else []


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


def _numbers(fields: Sequence[Line], name: str) -> npt.NDArray[np.float64]:
    values = np.empty(len(fields))
    for i, (number, text) in enumerate(fields):
        value = _float(text)
        if value is None:
            raise ValueError(
                f"{name}, line {number}: {brief(text)} is not a number; "
                "allowed: such as -0.5E-3, with a decimal point"
            )
        if not math.isfinite(value):
            raise ValueError(
                f"{name}, line {number}: {brief(text)} is not finite; "
                "fill the gap, or cut the record there"
            )
        values[i] = value
    return values


def _float(text: str) -> float | None:
    try:
        return float(text.upper().replace("D", "E"))  # Fortran writes .5D-03
    except ValueError:
        return None


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
