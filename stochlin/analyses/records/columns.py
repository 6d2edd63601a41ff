"""Records as columns of text, or as one series in rows, below titles and names of columns."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from io import StringIO
from itertools import islice
from typing import NamedTuple

import numpy as np
import pandas as pd

from stochlin.analyses.records.formats import (
    Array,
    Line,
    Series,
    as_float,
    as_numbers,
    without_comment,
)
from stochlin.messages import brief, listed
from stochlin.models.arguments import is_whole

Column = int | str

METRES = {"g": 9.80665, "m/s^2": 1.0, "cm/s^2": 0.01, "mm/s^2": 0.001}
_SPELLINGS = {"gal": "cm/s^2"} | {
    f"{length}/{spelling}": f"{length}/s^2"
    for length in ("m", "cm", "mm")
    for spelling in ("s2", "s/s", "s**2", "sec/sec", "sec^2", "sec2")
}
# Units in column names that are not of a known acceleration.
_OTHER_UNITS = re.compile(r"(mm|cm|m|km|in|ft|ms|hz|rad|deg)([/^*][\w/^*.-]*)?")

MOST_TITLES = 2
_HEAD = 20  # lines with text in which the numbers begin
_SECONDS = (None, "s", "sec", "second", "seconds")
# Lines of other formats: "SAMPLING INTERVAL (sec) : 0.01", "UNITS OF ACCEL ARE SEC AND G/10".
_STATEMENT = re.compile(r"[:=]\s*\S|\bunits?\b", re.IGNORECASE)
_COMMENT = re.compile(r"[#%].*")
_COMMA = re.compile(r"[-+]?\d+,\d{2,}")
_DECIMAL_COMMA = re.compile(r"(^|[;\t])\s*[-+]?\d*,\d", re.MULTILINE)
_DECIMAL_POINT = re.compile(
    r"(^|[;\t])[^\S\n]*[-+]?\d*\.\d+(e[-+]?\d+)?[^\S\n]*([;\t]|$)", re.IGNORECASE | re.MULTILINE
)
_SAMPLE = 100  # lines checked for decimal commas
_FEWEST = 8  # rows of a series in rows
_ALIKE, _NEARER = 2.0, 0.7  # scatter of columns, and steps along rows over those between rows


def content(lines: Sequence[str], start: int = 0) -> Iterator[Line]:
    """Numbered lines after the first ``start``, without comments, empty lines and white space."""
    for number, line in enumerate(islice(lines, start, None), start + 1):
        if text := without_comment(line):
            yield number, text


class Text(NamedTuple):
    """A text of numbers and its head."""

    name: str
    numbers: str  # without comments and decimal commas
    above: int  # number of lines above them
    separator: str | None  # None for white space
    titles: Sequence[str]
    names: list[str]  # of the columns; empty if there are none
    width: int

    @classmethod
    def of(cls, name: str, lines: Sequence[str], skip: int) -> Text | None:
        """The text after ``skip`` lines; None if its head is not titles, names and units of columns."""
        head = list(islice(content(lines, skip), _HEAD))
        texts: list[str] = []
        for (number, line), (_, below) in zip(head, [*head[1:], *head[-1:]], strict=True):
            separator = _separator(line)
            rows = [_fields(each, separator) for each in (line, below)]
            numbers = [[as_float(field) is not None for field in row] for row in rows]
            if all(numbers[0]) or (len(rows[0]) == len(rows[1]) and np.all(numbers, axis=0).any()):
                start, width = number - 1, len(rows[0])
                break
            texts.append(line)
        else:
            return None
        names, titles = _names(texts, separator, width)
        stated = any(map(_STATEMENT.search, texts if width == 1 else titles))
        if not skip and (stated or len(titles) > MOST_TITLES):
            return None
        rest = "\n".join(lines[start:]).rstrip("\x1a \n")
        if "#" in rest or "%" in rest:
            rest = _COMMENT.sub("", rest)
        if "," in rest:
            _check_commas(name, rest, separator)
            rest = rest if separator == "," else rest.replace(",", ".")
        return cls(name, rest, start, separator, titles, names, width)

    def series(self, column: Column | None, time_column: Column | None, wrapped: bool) -> Series:
        """The record, from a column or from all numbers in their order."""
        dt = self._step_above() if time_column is None else None
        if wrapped or dt is not None:
            fields = [(n, field) for n, row in self.rows() for field in row]
            values = as_numbers(fields[2:] if dt else fields, self.name)
            return Series(values, None, dt, self.units_of(0), " ".join(self.titles))
        time_index = None if time_column is None else self._index("time_column", time_column)
        index = self._index("column", column, time_index)
        units, named = self.units_of(index), self.names[index] if self.names else " ".join(self.titles)
        if time_index is not None and self.names and bracketed(self.names[time_index]) not in _SECONDS:
            raise ValueError(f"time_column is {brief(self.names[time_index])}; allowed: time in seconds")
        table = self.columns([n for n in (index, time_index) if n is not None])
        times = None if time_index is None else table[time_index]
        doubt = self._may_be_one_series(table) if column is not None and not self.names else ""
        return Series(table[index], times, None, units, named, doubt=doubt)

    def units_of(self, column: int) -> str | None:
        """Units of acceleration in the name of a column, or in a title; a ValueError for others."""
        stated = bracketed(self.names[column]) if self.names else None
        if is_other_unit(stated):
            what = f"column {brief(self.names[column])} of {self.name} is no acceleration that is known"
            raise ValueError(f"{what}; allowed: {allowed_units()}")
        units = (stated, *map(bracketed, self.titles))
        return next((unit for unit in units if unit in METRES), None)

    def columns(self, indices: Sequence[int]) -> dict[int, Array]:
        """The columns as numbers, at least those of these indices; others may hold text."""
        return self._table() or self._by_line(indices)

    def places(self) -> list[str]:
        """Name of file, line and row for each row of numbers, for messages."""
        lines = (number for number, _ in self.rows())
        return [f"{self.name}, line {line}, row {row}" for row, line in enumerate(lines, 1)]

    def rows(self) -> Iterator[tuple[int, list[str]]]:
        """Line number and fields of each row."""
        for number, line in enumerate(self.numbers.split("\n"), self.above + 1):
            if line.strip():
                yield number, _fields(line, self.separator)

    def _step_above(self) -> float | None:
        """The time step in a first row with the number of samples and it, ``1559 0.02``."""
        numbers = [as_float(field) or 0.0 for field in next(self.rows())[1]]
        step, count = min(numbers), max(numbers)
        if len(numbers) != 2 or not 0 < step < 1 < count == round(count):
            return None
        return step if sum(len(row) for _, row in self.rows()) == count + 2 else None

    def _table(self) -> dict[int, Array] | None:
        """All columns; None unless all rows have as many finite numbers as the first."""
        sep, text = self.separator or r"\s+", StringIO(self.numbers)
        try:
            table = pd.read_csv(text, sep=sep, header=None, skipinitialspace=True)
        except ValueError:  # lines of unequal length
            return None
        values = table.dropna(axis="columns", how="all").to_numpy()
        known = values.shape[1] == self.width and values.dtype.kind in "if" and np.isfinite(values).all()
        return dict(enumerate(values.astype(float).T)) if known else None

    def _by_line(self, indices: Sequence[int]) -> dict[int, Array]:
        """Some of the columns; a ValueError names the line that is no row of them."""
        rows = list(self.rows())
        for number, row in rows:
            if len(row) != self.width:
                allowed = f"{self.width}, as in the first row{self._or_wrapped()}"
                raise ValueError(f"{self.name}, line {number}: {len(row)} columns; allowed: {allowed}")
        return {i: as_numbers([(n, row[i]) for n, row in rows], self.name) for i in indices}

    def _or_wrapped(self) -> str:
        """The other cure for rows of numbers without names."""
        count = sum(len(row) for _, row in self.rows())
        return "" if self.names else f", or wrapped=True, if these are one series of {count} numbers"

    def _may_be_one_series(self, table: dict[int, Array]) -> str:
        """A doubt on columns that go on from the end of a row to the beginning of the next."""
        values = np.column_stack([*table.values()])
        if len(values) < _FEWEST or len(table) < 3:
            return ""
        with np.errstate(over="ignore", invalid="ignore"):
            scatter = values.std(axis=0)
            along, between = values[1:, 0] - values[:-1, -1], np.diff(values[:, 0])
            nearer = np.abs(along).mean() < _NEARER * np.abs(between).mean()
            alike = scatter.max() <= _ALIKE * scatter.min()
        question = f"its rows may be one series of {values.size} numbers; is it one, with wrapped=True?"
        return question if alike and nearer else ""

    def _index(self, parameter: str, column: Column | None, other: int | None = None) -> int:
        """The column that is asked for, or the only one but another."""
        left = [i for i in range(self.width) if i != other]
        if column is None and len(left) == 1:
            return left[0]
        if column is None:
            held = f"column is missing: {self.name} has {self._allowed()}"
            raise ValueError(f"{held}; give column={self._or_wrapped()}")
        if is_whole(column) and column in left:
            return column
        if isinstance(column, str) and column in self.names and self.names.index(column) in left:
            return self.names.index(column)
        others = "" if other is None else f", but column {other}, the time"
        raise ValueError(
            f"{parameter} = {brief(column)}; allowed in {self.name}: {self._allowed()}{others}"
        )

    def _allowed(self) -> str:
        named = f" named {listed(self.names)}" if self.names else ""
        return f"{self.width} columns (index 0 to {self.width - 1}){named}"


def _check_commas(name: str, text: str, separator: str | None) -> None:
    """Raise a ValueError for numbers such as ``0,05`` as columns, and for points beside commas."""
    lines = [line.strip() for line in islice(StringIO(text), _SAMPLE) if line.strip()]
    if all(_COMMA.fullmatch(line) for line in lines) and any(",0" in line for line in lines):
        raise ValueError(f"{name} seems to have decimal commas, as {brief(lines[0])}; allowed: points")
    if separator != "," and _DECIMAL_COMMA.search(text) and _DECIMAL_POINT.search(text):
        raise ValueError(f"{name} has decimal points and decimal commas; allowed: one of them")


def _separator(line: str) -> str | None:
    """Sign between the columns; None for white space, also between decimal commas."""
    between_tabs = "\t" in line and not re.search(r",(\s|$)", line)
    return next((mark for mark in ";," if mark in line and (mark == ";" or not between_tabs)), None)


def _fields(line: str, separator: str | None) -> list[str]:
    """Fields of a line of numbers, with decimal points."""
    line = line if separator == "," else line.replace(",", ".")
    fields = [field.strip(" \t\"'") for field in line.split(separator)]
    return fields[:-1] if separator and not fields[-1] else fields


def _names(texts: Sequence[str], separator: str | None, width: int) -> tuple[list[str], list[str]]:
    """Names of the columns, which may be above a line of units, and the titles above them."""
    rows = [_cells(text, separator, width) for text in texts]
    units = [spelled(cell.strip("()[]")) for cell in rows[-1]] if rows else []
    of_units = bool(units) and {*units} <= {*METRES, *_SECONDS}
    if of_units and len(rows) > 1 and len(rows[-2]) == width:
        names = [f"{name} [{unit}]" for name, unit in zip(rows[-2], units, strict=True)]
        return names, [*texts[:-2]]
    if rows and len(rows[-1]) == width:
        return rows[-1], [*texts[:-1]]
    return [], [*texts]


def _cells(text: str, separator: str | None, width: int) -> list[str]:
    """Cells of a line above the numbers; white space may be within names."""
    ways = [separator] if separator else [r"\t+", r"\s{2,}", r"\s+(?![(\[])", r"\s+"]
    cells = [[cell.strip(" \t\"'") for cell in re.split(way, text)] for way in ways]
    cells = [row[:-1] if separator and not row[-1] else row for row in cells]
    return next((row for row in cells if len(row) == width), [])


def bracketed(column: str) -> str | None:
    """Unit in the last brackets of a name such as ``acc [g]``."""
    units = re.findall(r"[(\[]([^()\[\]]+)[)\]]", column)
    return spelled(units[-1]) if units else None


def is_other_unit(unit: str | None) -> bool:
    """Whether this is a unit, but none of a known acceleration."""
    return unit is not None and unit not in METRES and _OTHER_UNITS.fullmatch(unit) is not None


def acceleration_units(units: str, parameter: str) -> str:
    """Units of acceleration in the spelling of `METRES`; a ValueError if they are unknown."""
    known = spelled(units)
    if known not in METRES:
        raise ValueError(f"{parameter} = {brief(units)} is no acceleration; allowed: {allowed_units()}")
    return known


def spelled(units: object) -> str:
    """Units in lower case and in one spelling of per second squared."""
    lower = str(units).strip().lower()
    return _SPELLINGS.get(lower, lower)


def allowed_units() -> str:
    """All known units in one line, for error messages."""
    return ", ".join(f"{unit!r}" for unit in (*METRES, "gal"))


def stated_units(stated: str | None, name: str, units: str | None) -> str:
    """Units of a file, as given or stated in it; a ValueError if neither is the case or they differ."""
    if units and stated and units != stated:
        raise ValueError(f"units = {brief(units)} contradicts {name}, which states {brief(stated)}")
    if not (units or stated):
        raise ValueError(f"units is missing and {name} does not state it; allowed: {allowed_units()}")
    return units or stated or ""
