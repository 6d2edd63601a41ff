"""Volume 2 of the California Strong Motion Instrumentation Program (CSMIP): corrected accelerograms.

Shakal, A. F. and Huang, M. J. (1985), Standard tape format for CSMIP strong-motion data tapes, Report
OSMS 85-03, California Division of Mines and Geology; files ``.V2`` of https://www.strongmotioncenter.org.
Channels follow each other, each with acceleration, velocity and displacement below lines such as
``15050 points of accel data equally spaced at .020 sec, in cm/sec2. (8f10.6)``.
"""

from __future__ import annotations

import re

from stochlin.applications.records.formats import FORMATS, Format, RecordFile, Series, field_width
from stochlin.applications.sheets.sheets import number_in

_HEADER = re.compile(r"\A\s*corrected accelerogram\b", re.IGNORECASE)
_CHANNEL = re.compile(r".*\bchan\s*\d+\s*:\s*(.*?)(?:\s{2,}|\s+from\b|$)", re.IGNORECASE)
_DATA = re.compile(r"\s*(\d{1,9})\s+points of accel data equally spaced at\s+(\S+)", re.IGNORECASE)
_UNITS = re.compile(r"(?:\bin|units:)\s+([a-z/^*\d]+)", re.IGNORECASE)
_END = re.compile(r"points of|end.of.data|/&", re.IGNORECASE)
_WIDTH = 10  # of fields where it is not stated
_EXAMPLE = "15050 points of accel data equally spaced at .020 sec, in cm/sec2. (8f10.6)"


def _read(file: RecordFile) -> list[Series]:
    channels, name, end = [], "", 0
    for number, line in enumerate(file.lines, 1):
        if number <= end:
            continue
        if _HEADER.match(line):
            channel = _CHANNEL.match(line)
            name = channel[1].strip() if channel else ""
        if match := _DATA.match(line):
            dt, units = number_in(match[2]), _UNITS.search(line[match.end() :])
            if dt is None or not 0 < dt < 1e9:
                raise file.wrong(number, repr(_EXAMPLE))
            width = field_width(line.rpartition("(")[2]) or _WIDTH
            values, end = file.block(number, int(match[1]), _END, width)
            about = {"component": name}
            channels.append(Series(values, None, dt, units[1] if units else None, about=about))
    return channels


FORMATS.register("csmip")(Format("a CSMIP file", _HEADER, _read, "v[12]"))
