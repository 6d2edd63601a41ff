"""PEER AT2: one component, whose header states the number of samples, the time step and the units.

PEER Ground Motion Database, https://ngawest2.berkeley.edu. ``NPTS`` and ``DT`` stand on one line or
on two, in any order: ``NPTS=  5372, DT=   .0100 SEC``, or ``4096    0.0100    NPTS, DT`` in older
files.
"""

from __future__ import annotations

import re

from stochlin.applications.records.formats import (
    FORMATS,
    Format,
    RecordFile,
    Series,
)
from stochlin.applications.sheets.sheets import number_in
from stochlin.models.units import size_of
from stochlin.registry import LAST

_POINTS_LINE = re.compile(r"\bNPTS\b", re.IGNORECASE)
_NUMBER = r"((?:\d+\.?\d*|\.\d+)(?:[ED][-+]?\d+)?)"
_IN_ANY_ORDER = re.compile(
    rf"(?=.*?\bNPTS\b[\s=:]*{_NUMBER})(?=.*?\bDT\b[\s=:]*{_NUMBER}[\s(]*([A-Z]*))", re.IGNORECASE
)
_NUMBERS_FIRST = re.compile(
    rf"^\s*{_NUMBER}[\s,]+{_NUMBER}[\s,]+NPTS\W+DT[\s(]*([A-Z]*)", re.IGNORECASE
)
# "UNITS OF G.", "UNITS OF (CM/SEC/SEC)", "UNITS: G'S"
_STATED_UNITS = re.compile(
    r"\bUNITS?(?:\s+OF)?[\s:=(\[]+([A-Z]+\d?(?:(?:/|\^|\*\*)[A-Z\d]+)*)", re.IGNORECASE
)
# first line of a file whose second line is a title
_PEER_TITLE = re.compile(r"STRONG.MOTION", re.IGNORECASE)
_EXAMPLES = "'NPTS= 5372, DT= .0100 SEC' or '4096 0.0100 NPTS, DT', the time step in SEC or MSEC"


def _read(file: RecordFile) -> list[Series]:
    lines = file.lines
    number = next(n for n, line in enumerate(lines, 1) if _POINTS_LINE.search(line))
    # The time step may stand on the line of the number of samples, below it, or above it.
    places = ((number, number), (number, number + 1), (number - 1, number))
    headers = ((last, _stated(" ".join(lines[max(first - 1, 0) : last]))) for first, last in places)
    last, stated = next(((last, header) for last, header in headers if header), (number, None))
    if stated is None:
        raise file.wrong(number, _EXAMPLES)
    count, dt = stated
    values = file.counted(last + 1, len(lines), count, number)
    units = next((unit[1] for line in lines[:last] if (unit := _STATED_UNITS.search(line))), None)
    title = lines[1] if number > 2 else lines[0] if number > 1 else ""
    return [Series(values, None, dt, units, about=_title(file), title=title)]


def _stated(text: str) -> tuple[int, float] | None:
    """Number of samples and time step [s] of a header; None unless it states both."""
    if not (match := _NUMBERS_FIRST.search(text) or _IN_ANY_ORDER.search(text)):
        return None
    samples, dt, unit = match.groups()
    unit = unit.lower() if unit.isupper() else unit  # a header in capitals has MSEC
    seconds = (number_in(dt) or 0.0) * (size_of(unit or "s", "s") or 0.0)
    return (int(samples), seconds) if samples.isdigit() and 0 < seconds < float("inf") else None


def _title(file: RecordFile) -> dict[str, str]:
    """Event, station and component in the second line: ``Kobe, 1/16/1995, Nishi-Akashi, 090``."""
    if len(file.lines) < 2 or not _PEER_TITLE.search(file.lines[0]):
        return {}
    *event, station, component = (part.strip() for part in f",,{file.lines[1]}".split(","))
    complete = any(event) and station and component
    named = {"event": ", ".join(filter(None, event)), "station": station, "component": component}
    return named if complete else {}


FORMATS.register("at2", LAST + 1)(  # its header is the least distinct
    Format("an AT2 file", _POINTS_LINE, _read, "at2")
)
