"""Standard accelerogram file of the Mexican networks, as of UNAM and RACM: a column per channel.

Instituto de Ingenieria, UNAM, Archivo estandar de aceleracion, version 2.0, 109 lines of header, as
in Alcantara, L. et al. (1997), Base Mexicana de Datos de Sismos Fuertes. Values of all channels
stand in one line of the header, ``/0.005/0.005/0.005``. Accelerations are read as they are written,
without correction of the baseline.
"""

from __future__ import annotations

import re

from stochlin.applications.records.formats import (
    FORMATS,
    Format,
    RecordFile,
    Series,
    field_width,
)
from stochlin.applications.sheets.sheets import number_in

_ARCHIVE_TITLE = re.compile(r"ARCHIVO EST.NDAR DE ACELERACI.N", re.IGNORECASE)
_ACCELERATIONS_TITLE = re.compile(r"\s*DATOS DE ACELERACI.N")
_RULE = re.compile(r"-{9}")
_LINES_TO_DATA = 10  # lines from the title of the data to the data
_INTERVAL = r"INTERVALO DE MUESTREO", "INTERVALO DE MUESTREO, C1-C6 (s) : /0.005/0.005/0.005"
_COUNT = r"NUM\. TOTAL DE MUESTRAS", "NUM. TOTAL DE MUESTRAS, C1-C6 : /35600/35600/35600"
_LENGTHS = r"DURACI.N DEL REGISTRO", "DURACION DEL REGISTRO (s), C1-C6 : /178.00/178.00/178.00"
_HOUR = r"HORA EPICENTRO"
_NAMES = r"ORIENTACI.N", "ORIENTACION C1-C6 (rumbo;orientacion) : /V/N00E/N90E"


def _read(file: RecordFile) -> list[Series]:
    title = next(
        (n for n, line in enumerate(file.lines) if _ACCELERATIONS_TITLE.match(line)),
        len(file.lines),
    )
    heads = file.lines[title : title + _LINES_TO_DATA]
    start = max((n for n, line in enumerate(heads, title + 1) if _RULE.match(line)), default=0)
    if not start:
        raise ValueError(
            f"{file.name} has no data; allowed: below 'DATOS DE ACELERACION' and '------'"
        )
    header = RecordFile(file.name, file.lines[:title])
    names = _values(header, *_NAMES)[1]
    steps = _numbers(header, _INTERVAL, len(names))
    counts = _numbers(header, _COUNT, len(names))
    lengths = _numbers(header, _LENGTHS, len(names))
    rows = round(max(counts))
    last = max((n for n, line in enumerate(file.lines, 1) if line.strip()), default=0)
    more = last - start - rows  # some files repeat the last sample a few times
    end = start + rows if more > 0 else len(file.lines)
    width = field_width(_text(header, "FORMATO DATOS"))
    values = file.counted(start + 1, end, rows * len(names), _values(header, *_COUNT)[0], width)
    about = {
        "comment": f"{more} rows beyond the stated {rows} are left out" if more > 0 else "",
        "event": f"{_text(header, 'FECHA DEL SISMO')} {_text(header, _HOUR)}".strip(),
        "station": _text(header, "CLAVE DE LA ESTACI.N"),
    }
    units = _text(header, "UNIDADES DE LOS DATOS").partition(" ")[0] or None
    channels = []
    of_channels = zip(names, steps, counts, lengths, values.reshape(rows, -1).T, strict=True)
    for name, dt, count, length, column in of_channels:
        file.check_length(round(count), dt, length, _values(header, *_LENGTHS)[0])
        of = {**about, "component": name}
        channels.append(Series(column[: round(count)], None, dt, units, about=of))
    return channels


def _text(header: RecordFile, key: str) -> str:
    """Text of the first line of a key; empty if there is none."""
    lines = (line for line in header.lines if re.match(rf"\s*{key}", line))
    return next(lines, "").partition(":")[2].strip()


def _values(header: RecordFile, key: str, example: str) -> tuple[int, list[str]]:
    """First line of a key, and the values of all channels on its lines."""
    lines = {n: line for n, line in enumerate(header.lines, 1) if re.match(rf"\s*{key}", line)}
    texts = "/".join(line.partition(":")[2] for line in lines.values()).split("/")
    if not (values := [text.strip() for text in texts if text.strip()]):
        raise ValueError(
            f"{header.name} has no line {example!r}; allowed: a value for each channel"
        )
    return min(lines), values


def _numbers(header: RecordFile, of: tuple[str, str], channels: int) -> list[float]:
    number, texts = _values(header, *of)
    values = [number_in(text) or 0.0 for text in texts]
    if len(values) != channels or not all(0 < value < 1e9 for value in values):
        raise header.wrong(
            number, f"a positive number for each of {channels} channels, as in {of[1]!r}"
        )
    return values


FORMATS.register("unam")(Format("a standard file of UNAM", _ARCHIVE_TITLE, _read, r"\d{3}"))
