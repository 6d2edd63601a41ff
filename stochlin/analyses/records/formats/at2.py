"""PEER AT2: one component, whose header states the number of samples, the time step and the units.

PEER Ground Motion Database, https://ngawest2.berkeley.edu. The line with ``NPTS`` has two forms:
``NPTS=  5372, DT=   .0100 SEC`` and, in older files, ``4096    0.0100    NPTS, DT``.
"""

from __future__ import annotations

import math
import re

from stochlin.analyses.records.formats import (
    FORMATS,
    Format,
    RecordFile,
    Series,
    as_float,
    without_comment,
)
from stochlin.messages import brief
from stochlin.registry import LAST

_NUMBER = r"([-+.\dEeDd]+)"
_DIALECTS = (
    re.compile(rf"NPTS\s*=\s*(\d{{1,15}})\s*,?\s*DT\s*=\s*{_NUMBER}", re.IGNORECASE),
    re.compile(rf"^\s*(\d{{1,15}})\s+{_NUMBER}\s+NPTS\s*,\s*DT", re.IGNORECASE),
)
_UNITS = re.compile(r"UNITS\s+OF\s+([^\s,]+)", re.IGNORECASE)
_OF_PEER = re.compile(r"STRONG.MOTION", re.IGNORECASE)  # first line of a file whose second is a title
_HEADER = re.compile("NPTS", re.IGNORECASE)


def _read(file: RecordFile) -> list[Series]:
    lines = [without_comment(line) for line in file.lines]
    number = next(n for n, line in enumerate(lines, 1) if _HEADER.search(line))
    stated = lines[number - 1]
    match = next((header for pattern in _DIALECTS if (header := pattern.search(stated))), None)
    dt = as_float(match[2]) if match else None
    if match is None or dt is None or not 0 < dt < math.inf:
        raise ValueError(
            f"{file.name}, line {number}: {brief(stated)} is not the header of an AT2 file; "
            "allowed: 'NPTS= 5372, DT= .0100 SEC' or '4096 0.0100 NPTS, DT'"
        )
    units = next((unit[1] for line in lines[: number - 1] if (unit := _UNITS.search(line))), None)
    values = RecordFile(file.name, lines).numbers(number + 1, len(lines))
    if values.size != int(match[1]):
        raise ValueError(
            f"{file.name} holds {values.size} values, but line {number} states NPTS = {match[1]}; "
            "the file is cut or damaged: fetch it again"
        )
    return [Series(values, None, dt, units, about=_title(file))]


def _title(file: RecordFile) -> dict[str, str]:
    """Event, station and component in PEER's second line: ``Kobe, 1/16/1995, Nishi-Akashi, 090``."""
    if len(file.lines) < 2 or not _OF_PEER.search(file.lines[0]):
        return {}
    *event, station, component = (part.strip() for part in f",,{file.lines[1]}".split(","))
    known = any(event) and station and component
    named = {"event": ", ".join(filter(None, event)), "station": station, "component": component}
    return named if known else {}


FORMATS.register("at2", LAST + 1)(  # its header is the least distinct
    Format("an AT2 file", _HEADER, _read, "at2", has_components=False)
)
