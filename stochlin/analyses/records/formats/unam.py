"""Standard accelerogram file of the Mexican networks, as of UNAM and RACM: a column for each channel.

Instituto de Ingenieria, UNAM, Archivo estandar de aceleracion, version 2.0, 109 lines of header, as in
Alcantara, L. et al. (1997), Base Mexicana de Datos de Sismos Fuertes. Values of all channels stand in
one line of the header, ``/0.005/0.005/0.005``. Accelerations are read as they are written, without
correction of the baseline.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from stochlin.analyses.records.formats import (
    FORMATS,
    Format,
    RecordFile,
    Series,
    as_float,
    field_width,
)

_HEADER = re.compile(r"ARCHIVO EST.NDAR DE ACELERACI.N", re.IGNORECASE)
_DATA, _RULE = re.compile(r"\s*DATOS DE ACELERACI.N"), re.compile(r"-{9}")
_MOST_HEADS = 10  # lines from the title of the data to the data
_INTERVAL = r"INTERVALO DE MUESTREO", "INTERVALO DE MUESTREO, C1-C6 (s) : /0.005/0.005/0.005"
_COUNT = r"NUM\. TOTAL DE MUESTRAS", "NUM. TOTAL DE MUESTRAS, C1-C6 : /35600/35600/35600"
_LENGTH = r"DURACI.N DEL REGISTRO", "DURACION DEL REGISTRO (s), C1-C6 : /178.00/178.00/178.00"
_NAMES = r"ORIENTACI.N", "ORIENTACION C1-C6 (rumbo;orientacion) : /V/N00E/N90E"


def _read(file: RecordFile) -> list[Series]:
    title, start = _data(file)
    header = RecordFile(file.name, file.lines[: title - 1])
    names = _channels(header, *_NAMES)[1]
    steps, counts, lengths = (_numbers(header, of, len(names)) for of in (_INTERVAL, _COUNT, _LENGTH))
    rows, more = round(max(counts)), _rows(file.lines[start:]) - round(max(counts))
    end = len(file.lines) if more <= 0 else start + rows
    stated, width = _channels(header, *_COUNT)[0], field_width(_text(header, "FORMATO DATOS"))
    values = file.counted(start + 1, end, rows * len(names), stated, width)
    table = values.reshape(rows, len(names))
    about = {
        "comment": f"{more} rows beyond the stated {rows} are left out" if more > 0 else "",
        "event": _text(header, "FECHA DEL SISMO"),
        "station": _text(header, "CLAVE DE LA ESTACI.N"),
    }
    units = _text(header, "UNIDADES DE LOS DATOS").partition(" ")[0]
    channels = []
    for column, (name, dt, count, length) in enumerate(zip(names, steps, counts, lengths, strict=True)):
        file.check_length(round(count), dt, length, _channels(header, *_LENGTH)[0])
        own = {key: text for key, text in {**about, "component": name}.items() if text}
        channels.append(Series(table[: round(count), column], None, dt, units or None, about=own))
    return channels


def _data(file: RecordFile) -> tuple[int, int]:
    """Line of the title of the data, and the last line above them."""
    title = next((n for n, line in enumerate(file.lines, 1) if _DATA.match(line)), 0)
    heads = range(title, min(title + _MOST_HEADS, len(file.lines)))
    rules = [n + 1 for n in heads if _RULE.match(file.lines[n])]
    if not title or not rules:
        raise ValueError(
            f"{file.name} has no data; allowed: the line 'DATOS DE ACELERACION:', names of the "
            "channels, a line of '---------+' and below it a column for each channel"
        )
    return title, rules[-1]


def _rows(lines: Sequence[str]) -> int:
    """Number of rows up to the last one with text; some files repeat the last sample a few times."""
    return next((n for n in range(len(lines), 0, -1) if lines[n - 1].strip()), 0)


def _text(header: RecordFile, key: str) -> str:
    """Text of the first line of a key; empty if there is none."""
    lines = (line for line in header.lines if re.match(rf"\s*{key}", line))
    return next(lines, "").partition(":")[2].strip()


def _channels(header: RecordFile, key: str, example: str) -> tuple[int, list[str]]:
    """First line of a key, and the values of all channels on its lines."""
    found = [(n, line) for n, line in enumerate(header.lines, 1) if re.match(rf"\s*{key}", line)]
    texts = [text.strip() for _, line in found for text in line.partition(":")[2].split("/")]
    values = [text for text in texts if text]
    if not values:
        raise ValueError(f"{header.name} has no line {example!r}; allowed: a value for each channel")
    return found[0][0], values


def _numbers(header: RecordFile, of: tuple[str, str], channels: int) -> list[float]:
    number, texts = _channels(header, *of)
    values = [as_float(text) or 0.0 for text in texts]
    if len(values) != channels or not all(0 < value < 1e9 for value in values):
        raise header.wrong(number, f"a positive number for each of {channels} channels, as in {of[1]!r}")
    return values


FORMATS.register("unam")(Format("a standard file of UNAM", _HEADER, _read, r"\d{3}"))
