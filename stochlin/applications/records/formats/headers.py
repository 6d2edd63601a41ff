"""One component below a header with a key in each line: of K-NET and KiK-net, and of ESM and ITACA.

National Research Institute for Earth Science and Disaster Resilience, About K-NET ASCII format,
http://www.kyoshin.bosai.go.jp/kyoshin/man/knetform_en.html: 17 lines, with labels of 18 characters.
Counts times the scale factor, ``3920(gal)/6182761``, are in gal, and there are as many of them as
the sampling frequency times the duration. They have an offset: the mean of the whole record is
subtracted, as the network does for the largest acceleration in the header.

Luzi, L. et al. (2016), The Engineering Strong-Motion Database, Seismol. Res. Lett. 87, 987-997;
format DYNA 1.2 of https://esm-db.eu: 64 lines ``KEY: value``. The mean of a record with ``BASELINE
NOT REMOVED`` is subtracted.
"""

from __future__ import annotations

import re
from typing import NamedTuple

from stochlin.applications.records.formats import FORMATS, Format, RecordFile, Series
from stochlin.applications.sheets.sheets import number_in
from stochlin.kernels.basics.arrays import Array

_KNET_LINE = re.compile(r"(.{0,18})(.*)")
_LAST_ENTRY = "Memo."
_SCALE_ENTRY = "Scale Factor"
_DURATION = "Duration Time(s)"
_GAL_FRACTION = re.compile(r"([\d.]+)\s*\(\s*gal\s*\)\s*/\s*([\d.]+)", re.IGNORECASE)
_ESM_LINE = re.compile(r"([A-Z][A-Z0-9_/^]*)\s*:\s*(.*)")
_DATE = "EVENT_DATE_YYYYMMDD"
_TIME = "EVENT_TIME_HHMMSS"
_HERTZ = re.compile(r"\s*Hz$", re.IGNORECASE)
# KiK-net has numbers of channels for the directions of K-NET; those of three are in a borehole.
_CHANNELS = {"4": "N-S", "5": "E-W", "6": "U-D"}
_CHANNELS |= {"1": "N-S borehole", "2": "E-W borehole", "3": "U-D borehole"}


class _Header(NamedTuple):
    """The first lines of a file: their numbers and texts by key, and the number of the last one."""

    file: RecordFile
    lines: dict[str, tuple[int, str]]
    end: int

    @classmethod
    def of(cls, file: RecordFile, form: re.Pattern[str], last: str = "") -> _Header:
        """The lines of this form, up to that of the ``last`` key."""
        lines: dict[str, tuple[int, str]] = {}
        for number, line in enumerate(file.lines, 1):
            if last in lines or (match := form.match(line)) is None:
                return cls(file, lines, number - 1)
            lines.setdefault(match[1].strip(), (number, match[2].strip()))
        return cls(file, lines, len(file.lines))

    def line(self, key: str, example: str) -> tuple[int, str]:
        """Number and text of the line of this key; a ValueError if there is none."""
        if key not in self.lines:
            raise ValueError(
                f"{self.file.name} has no line {key!r}; allowed: a header with {example!r}"
            )
        return self.lines[key]

    def positive(self, key: str, example: str) -> float:
        """The positive number of this key, below a thousand million."""
        number, text = self.line(key, example)
        value = number_in(_HERTZ.sub("", text))
        if value is None or not 0 < value < 1e9:
            raise self.file.wrong(number, f"a positive number, as in {example!r}")
        return value

    def texts(self, **keys: str) -> dict[str, str]:
        """Texts of the lines of these keys, empty if there are none."""
        return {name: self.lines.get(key, (0, ""))[1] for name, key in keys.items()}

    def values(self, count: float, key: str) -> Array:
        """All numbers below, as many as the line of this key says."""
        file = self.file
        return file.counted(self.end + 1, len(file.lines), round(count), self.lines[key][0])


def _read_knet(file: RecordFile) -> list[Series]:
    header = _Header.of(file, _KNET_LINE, _LAST_ENTRY)
    header.line(_LAST_ENTRY, "Memo.             ")
    rate = header.positive("Sampling Freq(Hz)", "Sampling Freq(Hz) 100Hz")
    count = rate * header.positive(_DURATION, "Duration Time(s)  108")
    example = "Scale Factor      3920(gal)/6182761"
    number, text = header.line(_SCALE_ENTRY, example)
    fraction = _GAL_FRACTION.fullmatch(text)
    gal = number_in(fraction[1]) or 0.0 if fraction else 0.0
    counts = number_in(fraction[2]) or 0.0 if fraction else 0.0
    if not (gal > 0 and counts > 0):
        raise file.wrong(number, repr(example))
    values, comment = _centred(header.values(count, _DURATION) * gal / counts, "gal")
    about = header.texts(event="Origin Time", station="Station Code", component="Dir.")
    about["component"] = _CHANNELS.get(about["component"], about["component"])
    return [Series(values, None, 1 / rate, "gal", about=about | {"comment": comment})]


def _read_esm(file: RecordFile) -> list[Series]:
    header = _Header.of(file, _ESM_LINE)
    example = "DATA_TYPE: ACCELERATION"
    number, kind = header.line("DATA_TYPE", example)
    if kind.upper() != "ACCELERATION":
        raise file.wrong(number, repr(example))
    dt = header.positive("SAMPLING_INTERVAL_S", "SAMPLING_INTERVAL_S: 0.005000")
    values = header.values(header.positive("NDATA", "NDATA: 19128"), "NDATA")
    about = header.texts(station="STATION_CODE", component="STREAM")
    name, *of_event = header.texts(n="EVENT_NAME", i="EVENT_ID", d=_DATE, t=_TIME).values()
    identifier = of_event[0] or " ".join(of_event[1:])
    about["event"] = ", ".join(filter(None, [name, identifier.strip()]))
    units, baseline = header.texts(units="UNITS", baseline="BASELINE_CORRECTION").values()
    if "NOT REMOVED" in baseline.upper():
        values, about["comment"] = _centred(values, units)
    return [Series(values, None, dt, units or None, about=about)]


def _centred(values: Array, units: str) -> tuple[Array, str]:
    """A record without baseline correction less its mean, and the sentence that says so."""
    mean = float(values.mean()) if values.size else 0.0
    return values - mean, f"its mean of {mean:.6g} {units} is subtracted"


_FIRST_OF_KNET = re.compile(r"\AOrigin Time\s")
_FIRST_OF_ESM = re.compile(r"\AEVENT_NAME\s*:")
FORMATS.register("knet")(Format("a K-NET file", _FIRST_OF_KNET, _read_knet, "(ns|ew|ud)[12]?"))
FORMATS.register("esm")(Format("an ESM file", _FIRST_OF_ESM, _read_esm, "asc"))
