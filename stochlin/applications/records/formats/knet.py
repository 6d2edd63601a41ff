"""K-NET and KiK-net ASCII: counts of one component below a header of 17 lines.

National Research Institute for Earth Science and Disaster Resilience, About K-NET ASCII format,
http://www.kyoshin.bosai.go.jp/kyoshin/man/knetform_en.html: each line has a label of 18 characters. The
counts times the scale factor, ``3920(gal)/6182761``, are in gal, and there are as many of them as the
sampling frequency times the duration.

The counts have an offset. The mean of the whole record is subtracted, as the network does for the
largest acceleration in the header.
"""

from __future__ import annotations

import re

from stochlin.applications.records.formats import FORMATS, Format, RecordFile, Series, centred
from stochlin.applications.sheets.sheets import number_in

_LABEL = 18  # characters
_SCALE, _RATE, _LAST = "Scale Factor", "Sampling Freq(Hz)", "Memo."
_FRACTION = re.compile(r"([\d.]+)\s*\(\s*gal\s*\)\s*/\s*([\d.]+)", re.IGNORECASE)
_HEADER = re.compile(r"\AOrigin Time\s")
# KiK-net has numbers of channels for the directions of K-NET; those of three are in a borehole.
_CHANNELS = {"4": "N-S", "5": "E-W", "6": "U-D"}
_CHANNELS |= {"1": "N-S borehole", "2": "E-W borehole", "3": "U-D borehole"}


def _read(file: RecordFile) -> list[Series]:
    stated: dict[str, tuple[int, str]] = {}
    for number, line in enumerate(file.lines, 1):
        label = line[:_LABEL].strip()
        stated.setdefault(label, (number, line[_LABEL:].strip()))
        if label == _LAST:
            break
    first, _ = file.line(stated, _LAST, "Memo.             ")
    number, text = file.line(stated, _RATE, "Sampling Freq(Hz) 100Hz")
    stated[_RATE] = number, re.sub(r"\s*Hz$", "", text, flags=re.IGNORECASE)
    rate = file.positive(stated, _RATE, "Sampling Freq(Hz) 100Hz")
    duration = file.positive(stated, "Duration Time(s)", "Duration Time(s)  108")
    if not rate * duration < 1e9:
        raise file.wrong(number, "'Sampling Freq(Hz) 100Hz'")
    number, text = file.line(stated, _SCALE, "Scale Factor      3920(gal)/6182761")
    fraction = _FRACTION.fullmatch(text)
    gal, counts = (number_in(fraction[n]) or 0.0 if fraction else 0.0 for n in (1, 2))
    if not (gal > 0 and counts > 0):
        raise file.wrong(number, "'Scale Factor      3920(gal)/6182761'")
    samples, (at, _) = round(rate * duration), stated["Duration Time(s)"]
    read = file.counted(first + 1, len(file.lines), samples, at)
    values, comment = centred(read * gal / counts, "gal")
    of = {"event": "Origin Time", "station": "Station Code", "component": "Dir."}
    about = {name: stated.get(key, (0, ""))[1] for name, key in of.items()} | {"comment": comment}
    about["component"] = _CHANNELS.get(about["component"], about["component"])
    return [Series(values, None, 1 / rate, "gal", about=about)]


FORMATS.register("knet")(Format("a K-NET file", _HEADER, _read, "(ns|ew|ud)[12]?"))
