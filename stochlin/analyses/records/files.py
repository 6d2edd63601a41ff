"""Record files: PEER AT2 and columns of text, read as they are written."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from stochlin.messages import brief

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
    re.compile(rf"NPTS\s*=\s*(\d+)\s*,?\s*DT\s*=\s*{_NUMBER}", re.IGNORECASE),
    re.compile(rf"^\s*(\d+)\s+{_NUMBER}\s+NPTS\s*,\s*DT", re.IGNORECASE),
)
_AT2_UNITS = re.compile(r"UNITS\s+OF\s+(\S+)", re.IGNORECASE)
_AT2_HEADER_LINES = 8


class Series(NamedTuple):
    """What a file holds: acceleration as written, and what the file says about it."""

    values: npt.NDArray[np.float64]
    time: npt.NDArray[np.float64] | None
    dt: float | None
    units: str | None


def read_series(path: Path, column: Column | None, time_column: Column | None) -> Series:
    """Read a file of either format."""
    lines = _content(path.read_text(encoding="utf-8-sig", errors="replace"))
    if not lines:
        raise ValueError(f"{path.name} is empty: it holds no line of numbers")
    header = next(
        (i for i, (_, text) in enumerate(lines[:_AT2_HEADER_LINES]) if "NPTS" in text.upper()), None
    )
    if header is None:
        return _read_columns(lines, path.name, column, time_column)
    if column is None and time_column is None:
        return _read_at2(lines, header, path.name)
    raise ValueError(f"column and time_column do not apply: {path.name} is an AT2 file of one series")


def _content(text: str) -> list[Line]:
    """Numbered lines without comments and blanks; a control-Z ends old DOS files."""
    stripped = (re.split("[#%]", line, maxsplit=1)[0].strip(" \t\x1a") for line in text.splitlines())
    return [(number, line) for number, line in enumerate(stripped, 1) if line]


def _read_at2(lines: Sequence[Line], header: int, name: str) -> Series:
    number, text = lines[header]
    match = next((found for pattern in _AT2_DIALECTS if (found := pattern.search(text))), None)
    dt = _float(match[2]) if match else None
    if match is None or dt is None or dt <= 0:
        raise ValueError(
            f"{name}, line {number}: {brief(text)} is not the header of an AT2 file; "
            "allowed: 'NPTS= 5372, DT= .0100 SEC' or '4096 0.0100 NPTS, DT'"
        )
    units = next((found[1] for _, line in lines[:header] if (found := _AT2_UNITS.search(line))), None)
    fields = [(number, field) for number, line in lines[header + 1 :] for field in line.split()]
    values = _numbers(fields, name)
    if values.size != int(match[1]):
        raise ValueError(
            f"{name} holds {values.size} values, but line {number} states NPTS = {match[1]}; "
            "the file is cut or damaged: fetch it again"
        )
    return Series(values, None, dt, units and acceleration_units(units, f"{name}: units"))


def _read_columns(
    lines: Sequence[Line], name: str, column: Column | None, time_column: Column | None
) -> Series:
    separator = next((mark for mark in ";," if mark in lines[0][1]), None)
    names = _column_names(lines[0][1], separator)
    rows = [(number, _fields(text, separator)) for number, text in (lines[1:] if names else lines)]
    if not rows:
        raise ValueError(f"{name} is empty: it holds no line of numbers")
    width = len(names) if names else len(rows[0][1])
    for number, fields in rows:
        if len(fields) != width:
            raise ValueError(
                f"{name}, line {number}: {len(fields)} columns, but line {lines[0][0]} has {width}; "
                "start a title with #, fill what is missing; numbers that run on need an AT2 header"
            )
    time_index = None if time_column is None else _index("time_column", time_column, names, width, name)
    index = _data_index(column, time_index, names, width, name)
    stated = _bracketed(names[index]) if names else None
    if time_index is not None and names and (_bracketed(names[time_index]) or "s") not in _SECONDS:
        raise ValueError(
            f"time_column = {brief(time_column)} is named {brief(names[time_index])}; "
            "allowed: time in seconds"
        )
    return Series(
        _numbers([(number, fields[index]) for number, fields in rows], name),
        None if time_index is None else _numbers([(n, fields[time_index]) for n, fields in rows], name),
        None,
        stated if stated in METRES else None,
    )


def _fields(text: str, separator: str | None) -> list[str]:
    fields = [field.strip(" \t\"'") for field in text.split(separator)]
    return fields[:-1] if separator and not fields[-1] else fields


def _column_names(text: str, separator: str | None) -> list[str]:
    """Names in a first line that has no number; none where it is a line of data."""
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
            f"column and time_column are both {brief(column)}; allowed: two different columns"
        )
    return index


def _index(parameter: str, column: Column, names: Sequence[str], width: int, name: str) -> int:
    if isinstance(column, str) and column in names:
        return names.index(column)
    if isinstance(column, int | np.integer) and 0 <= column < width:
        return column
    raise ValueError(
        f"{parameter} = {brief(column)} is not in {name}, which has {_allowed_columns(names, width)}"
    )


def _allowed_columns(names: Sequence[str], width: int) -> str:
    return f"{width} columns (index 0 to {width - 1})" + (f" named {', '.join(names)}" if names else "")


def _numbers(fields: Sequence[Line], name: str) -> npt.NDArray[np.float64]:
    values = np.empty(len(fields))
    for i, (number, text) in enumerate(fields):
        value = _float(text)
        if value is None:
            raise ValueError(
                f"{name}, line {number}: {brief(text)} is not a number; allowed: such as -0.5E-3"
            )
        if not np.isfinite(value):
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
    """The one spelling of units of acceleration that `METRES` knows."""
    known = spelled(units)
    if known not in METRES:
        raise ValueError(
            f"{parameter} = {units!r} is not a unit of acceleration; allowed: {allowed_units()}"
        )
    return known


def spelled(units: object) -> str:
    """Units in lower case, without the variants of writing per second squared."""
    lower = str(units).strip().lower()
    return _SPELLINGS.get(lower, lower)


def allowed_units() -> str:
    """Units for an error message."""
    return ", ".join(f"{unit!r}" for unit in (*METRES, "gal"))


def _bracketed(column: str) -> str | None:
    """Unit in a column name such as ``acc [g]``."""
    found = re.search(r"[(\[](.+)[)\]]", column)
    return spelled(found[1]) if found else None
