"""COSMOS V1 and V2: a header of text, whole numbers and real numbers, comments, and one series.

COSMOS (2001), Strong Motion Data Format, version 1.20, Consortium of Organizations for Strong-Motion
Observation Systems; files ``.V2c`` of https://www.strongmotioncenter.org. Real value 62 is the time step
[ms] and 63 the length [s]; -999 is what is not known. Series follow each other, and accelerations stand
below lines such as ``42000 acceleration pts, approx 210 secs, units=cm/sec2(04),Format=(8F10.5)``.
"""

from __future__ import annotations

import re

from stochlin.applications.records.formats import FORMATS, Array, Format, RecordFile, Series, field_width

_HEADER = re.compile(r"\A.*acceleration.*\(format v\s*\d", re.IGNORECASE)
_CHANNEL = re.compile(r"\s*sta cha\w*\s*:?\s*[^:]*:\s*([^(:]*?)\s*\(", re.IGNORECASE)
_REALS = re.compile(r"\s*\d+\s+real-header values follow on\s+(\d{1,6})\s+lines(.*)", re.IGNORECASE)
_DATA = re.compile(r"\s*(\d{1,9})\s+(?:raw\s+)?accel\S*\s+p(?:oin)?ts\b(.*)", re.IGNORECASE)
_UNITS = re.compile(r"units\s*=\s*([^(,]+)", re.IGNORECASE)
_END = re.compile(r"end.of.data|/&", re.IGNORECASE)
_STEP, _LENGTH = 61, 62  # numbers of real values, from 0


def _read(file: RecordFile) -> list[Series]:
    channels: list[Series] = []
    name, reals, at, end = "", None, 0, 0
    for number, line in enumerate(file.lines, 1):
        if number <= end:
            continue
        if channel := _CHANNEL.match(line):
            name = channel[1]
        elif match := _REALS.match(line):
            at, end = number, number + int(match[1])
            reals = file.numbers(number + 1, end, field_width(match[2].rpartition("(")[2]))
        elif match := _DATA.match(line):
            width = field_width(line.rpartition("(")[2])
            values, end = file.block(number, int(match[1]), _END, width)
            units, about = _UNITS.search(match[2]), {"component": name}
            dt = _step(file, values.size, reals, at)
            channels.append(Series(values, None, dt, units[1].strip() if units else None, about=about))
            name, reals = "", None
    return channels


def _step(file: RecordFile, count: int, reals: Array | None, at: int) -> float | None:
    """Time step [s] of the real values, which begin below a line; None if it is not known."""
    if reals is None or reals.size <= _LENGTH or reals[_STEP] <= 0:
        return None
    dt, length = float(reals[_STEP]) / 1000, float(reals[_LENGTH])
    if length > 0:
        file.check_length(count, dt, length, at)
    return dt


FORMATS.register("cosmos")(Format("a COSMOS file", _HEADER, _read, "v[123]c"))
