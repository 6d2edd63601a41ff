"""What the formats of record files have in common."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from stochlin.applications.sheets.sheets import number_in
from stochlin.kernels.basics.arrays import Array
from stochlin.messages import brief
from stochlin.registry import Registry


class Series(NamedTuple):
    """Content of a record file: accelerations as written; time, time step and units if stated."""

    values: Array
    time: Array | None
    dt: float | None
    units: str | None
    about: Mapping[str, str] = MappingProxyType({})  # event, station and component, if stated
    rows: int = 0  # number of columns that may be rows of one series
    timed: bool = True  # whether the time holds beside a time step of the caller, who asked for it
    title: str = ""  # of the file, which may end with the component


class RecordFile(NamedTuple):
    """Name and lines of a record file, without comments, and the lines as they are written."""

    name: str
    lines: Sequence[str]
    written: Sequence[str] = ()

    def wrong(self, number: int, allowed: str) -> ValueError:
        """The error that a line is not what is allowed there."""
        line = (
            self.lines[number - 1].strip() if number <= len(self.lines) else "the end of the file"
        )
        return ValueError(f"{self.name}, line {number}: {brief(line)}; allowed there: {allowed}")

    def counted(self, first: int, last: int, count: int, stated: int, width: int = 0) -> Array:
        """The numbers from line ``first`` to ``last``, as many as line ``stated`` says.

        Numbers that run on are separated where a ``width`` of the fields is known.
        """
        values = self.numbers(first, last, width)
        if values.size != count:
            held = f"{self.name} holds {values.size} values, but line {stated} states {count}"
            raise ValueError(f"{held}; the file is cut or damaged: fetch it again")
        return values

    def block(self, number: int, count: int, end: re.Pattern[str], width: int) -> tuple[Array, int]:
        """As many numbers as the line above states, up to one with ``end``, and their last line."""
        after = enumerate(self.lines[number:], number)
        last = next((n for n, text in after if end.search(text)), len(self.lines))
        return self.counted(number + 1, last, count, number, width), last

    def numbers(self, first: int, last: int, width: int = 0) -> Array:
        """The numbers from line ``first`` to ``last``, both included."""
        lines = self.lines[first - 1 : last]
        text = "\n".join(lines)
        with suppress(ValueError):  # of other text, which follows
            values = np.array(text.split(), float)
            if np.isfinite(values).all() and "_" not in text:
                return values
        fields = [
            (n, field) for n, line in enumerate(lines, first) for field in _fields(line, width)
        ]
        for n, field in fields:
            if number_in(field) is None:
                raise self.wrong(n, f"finite numbers, such as -0.5E-3, and not {brief(field)}")
        return np.array([number_in(field) for _, field in fields], float)

    def check_length(self, count: int, dt: float, seconds: float, number: int) -> None:
        """Raise a ValueError if samples and time step do not give the length on a header line."""
        if abs(count * dt - seconds) > 2 * dt + 0.01 * seconds:
            raise self.wrong(number, f"the length of {count} samples with a step of {dt:g} s")


@dataclass(frozen=True)
class Format:
    """A format of record files.

    ``header`` is searched in the first `HEADER_LINES` lines with text, as they are written and
    without comments, and ``read`` gives the components, none if it sees no accelerations. Of a
    folder of records, files with these ``endings``, a regular expression, are read.
    """

    title: str  # with its article
    header: re.Pattern[str]
    read: Callable[[RecordFile], list[Series]]
    endings: str

    def __post_init__(self) -> None:
        if any(map(self.header.search, NO_HEADERS)):
            what = f"{self.title}: the header {brief(self.header.pattern)} is in every file"
            raise ValueError(
                f"{what}; allowed: a pattern that only files of this format begin with"
            )


HEADER_LINES = 8
# first lines of other files
NO_HEADERS = ("", "0.1", "0.0, 0.1\n0.02, 0.3", "time acceleration\n0.0 0.1")
FORMATS: Registry[Format] = Registry("format of records", "stochlin.applications.records.formats")


def field_width(stated: str) -> int:
    """Width of the fields of a Fortran format such as ``8F10.5``; 0 if it is not known."""
    width = re.search(r"[DEFGI](\d{1,3})", stated.upper())
    return int(width[1]) if width else 0


def _fields(line: str, width: int) -> list[str]:
    fields = line.split()
    if width and any(number_in(field) is None for field in fields):
        line = line.rstrip()
        return [line[start : start + width].strip() for start in range(0, len(line), width)]
    return fields
