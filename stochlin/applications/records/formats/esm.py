"""Engineering Strong Motion database (ESM) and ITACA: one component below a header of ``KEY: value``.

Luzi, L. et al. (2016), The Engineering Strong-Motion Database, Seismol. Res. Lett. 87, 987-997; format
DYNA 1.2, 64 lines, of https://esm-db.eu. The mean of a record with ``BASELINE NOT REMOVED`` is
subtracted.
"""

from __future__ import annotations

import re

from stochlin.applications.records.formats import FORMATS, Format, RecordFile, Series, centred

_KEY = re.compile(r"([A-Z][A-Z0-9_/^]*)\s*:\s*(.*)")
_HEADER = re.compile(r"\AEVENT_NAME\s*:")


def _read(file: RecordFile) -> list[Series]:
    stated: dict[str, tuple[int, str]] = {}
    first = len(file.lines) + 1
    for number, line in enumerate(file.lines, 1):
        match = _KEY.match(line)
        if match is None:
            first = number
            break
        stated.setdefault(match[1], (number, match[2].strip()))
    number, kind = file.line(stated, "DATA_TYPE", "DATA_TYPE: ACCELERATION")
    if kind.upper() != "ACCELERATION":
        raise file.wrong(number, "'DATA_TYPE: ACCELERATION'")
    dt = file.positive(stated, "SAMPLING_INTERVAL_S", "SAMPLING_INTERVAL_S: 0.005000")
    count = file.positive(stated, "NDATA", "NDATA: 19128")
    values = file.counted(first, len(file.lines), round(count), stated["NDATA"][0])
    units = stated.get("UNITS", (0, ""))[1]
    of = {"event": "EVENT_NAME", "station": "STATION_CODE", "component": "STREAM"}
    about = {name: stated.get(key, (0, ""))[1] for name, key in of.items()}
    if "NOT REMOVED" in stated.get("BASELINE_CORRECTION", (0, ""))[1].upper():
        values, about["comment"] = centred(values, units)
    return [Series(values, None, dt, units or None, about=about)]


FORMATS.register("esm")(Format("an ESM file", _HEADER, _read, "asc"))
