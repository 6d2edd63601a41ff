"""CSMIP Volume 2 and COSMOS V1 and V2: channels one after the other, each below its own header.

Shakal, A. F. and Huang, M. J. (1985), Standard tape format for CSMIP strong-motion data tapes,
Report OSMS 85-03, California Division of Mines and Geology; files ``.V2``. COSMOS (2001), Strong
Motion Data Format, version 1.20, Consortium of Organizations for Strong-Motion Observation Systems;
files ``.V2c``. Both are delivered by https://www.strongmotioncenter.org.

Accelerations stand below lines such as ``15050 points of accel data equally spaced at .020 sec, in
cm/sec2. (8f10.6)`` of CSMIP, and ``42000 acceleration pts, approx 210 secs,
units=cm/sec2(04),Format=(8F10.5)`` of COSMOS. There real value 62 is the time step [ms] and 63 the
length [s]; -999 is what is not known. The earthquake is known by its origin time, or else by the
line ``Rcrd of Tue Dec 20, 2022 02:34:01.0 PST``, the time of the first sample, or the number of the
record.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from stochlin.applications.records.components import stated_as_vertical
from stochlin.applications.records.formats import FORMATS, Format, RecordFile, Series, field_width
from stochlin.applications.sheets.sheets import number_in

_CSMIP = re.compile(r"\A\s*corrected accelerogram\b", re.IGNORECASE)
_COSMOS = re.compile(r"\A.*acceleration.*\(format v\s*\d", re.IGNORECASE)
_CHANNEL_TITLE = re.compile(
    r"\s*corrected accelerogram\b.*\bchan\s*\d+\s*:\s*(.*?)(?:\s{2,}|\s+from\b|$)"
    r"|\s*sta cha\w*\s*:?\s*[^:]*:\s*([^(:]*?)\s*\(",
    re.IGNORECASE,
)
# Of the header above a channel: what identifies the earthquake, by rank, the station, and the
# channel.
_EVENTS = [
    re.compile(pattern, re.IGNORECASE)
    for pattern in (
        r"\borigin\s*(?:\(\w+\))?\s*:\s*(\d+/\d+/\d+[,\s]+\d+\s*:\s*\d+[\d:.\s]*)",
        r"^(?!.*\bprocessed\b)(?=.*\b(?:19|20)\d\d\b)\s*(.*?[a-z]{3}.*\d:\d\d(?:[:.\s]*\d)*(?:\s[A-Z]{3}\b)?)",
        r"\bstart time\s*:\s*(\d+/\d+/\d+[,\s]+\d+\s*:\s*\d+[\d:.\s]*)",
        r"(?:^\s*corrected accelerogram|rcrdid:)\s*(\w+-\w+-\d{5}\.\d+|\d{6,}\.\w+\.\w+)",
    )
]
_STATION = re.compile(
    r"^\s*stat(?:io)?n no\b.*\bcode:\s*(\S+)|^\s*station no\.?\s*(\S+)", re.IGNORECASE
)
_SCNL = re.compile(r"<SCNL>\w*\.(\w+)")
_REALS = re.compile(r"\s*\d+\s+real-header values follow on\s+(\d{1,6})\s+lines", re.IGNORECASE)
_DATA_TITLE = re.compile(
    r"\s*(\d{1,9})\s+"
    r"(?:points of accel data equally spaced at\s+(\S+)|(?:raw\s+)?accel\S*\s+p(?:oin)?ts\b)(.*)",
    re.IGNORECASE,
)
_UNITS_OF_DATA = re.compile(r"(?:\bin\s|units:|units\s*=)\s*([a-z/^*\d]+)", re.IGNORECASE)
_DATA_END = re.compile(r"points of|end.of.data|/&", re.IGNORECASE)
_WIDTH = 10  # of fields where it is not stated
_EXAMPLE = "15050 points of accel data equally spaced at .020 sec, in cm/sec2. (8f10.6)"
_MOST_HEADER_LINES = 100  # lines of the header above a channel
_WIDEST = 200  # signs of one of them
# numbers of real values, from 0
_PLACE_OF_STEP = 61
_PLACE_OF_LENGTH = 62


def _read(file: RecordFile) -> list[Series]:
    channels: list[Series] = []
    name = ""
    reals = 0
    end = 0
    top = 0
    for number, line in enumerate(file.lines, 1):
        if number <= end:
            continue
        if _CSMIP.match(line) or _COSMOS.match(line):
            top = number - 1
        if match := _CHANNEL_TITLE.match(line):
            name = match[match.lastindex or 1].strip()
        elif _REALS.match(line):
            reals = number
        elif match := _DATA_TITLE.match(line):
            count, step, rest = match.groups()
            values, end = file.block(number, int(count), _DATA_END, _width(line))
            dt = _step_of_reals(file, reals, values.size) if step is None else number_in(step)
            if step is not None and not 0 < (dt or 0.0) < 1e9:
                raise file.wrong(number, repr(_EXAMPLE))
            units = _UNITS_OF_DATA.search(rest)
            about = _about(file.lines[top : min(number - 1, top + _MOST_HEADER_LINES)], name)
            channels.append(Series(values, None, dt, units[1] if units else None, about=about))
            name = ""
            reals = 0
    return channels


def _about(header: Sequence[str], name: str) -> dict[str, str]:
    """Component, earthquake and station in the lines above a channel of this name."""
    lines = [line[:_WIDEST] for line in header]
    quake = lines[1].strip() if len(lines) > 1 and _COSMOS.match(lines[0]) else ""
    events = (match[1] for pattern in _EVENTS for line in lines if (match := pattern.search(line)))
    stations = (match[match.lastindex or 1] for line in lines if (match := _STATION.search(line)))
    if stated_as_vertical(name) is None:
        name = next((match[1] for line in lines if (match := _SCNL.search(line))), name)
    return {"component": name, "event": next(events, quake).strip(), "station": next(stations, "")}


def _width(line: str) -> int:
    """Width of the fields by the format at the end of a line."""
    return field_width(line.rpartition("(")[2]) or _WIDTH


def _step_of_reals(file: RecordFile, at: int, count: int) -> float | None:
    """Time step [s] of the real values below a line, if there is one; None if it is not known."""
    if not (match := _REALS.match(file.lines[at - 1]) if at else None):
        return None
    reals = file.numbers(at + 1, at + int(match[1]), _width(file.lines[at - 1]))
    if reals.size <= _PLACE_OF_LENGTH or reals[_PLACE_OF_STEP] <= 0:
        return None
    dt = float(reals[_PLACE_OF_STEP]) / 1000
    length = float(reals[_PLACE_OF_LENGTH])
    if length > 0:
        file.check_length(count, dt, length, at)
    return dt


FORMATS.register("csmip")(Format("a CSMIP file", _CSMIP, _read, "v[12]"))
FORMATS.register("cosmos")(Format("a COSMOS file", _COSMOS, _read, "v[123]c"))
