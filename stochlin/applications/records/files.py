"""Record files: the registered formats and columns of text, without conversion of units."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from itertools import islice

from stochlin.applications.records.columns import TextFile
from stochlin.applications.records.formats import FORMATS, HEADER_LINES, RecordFile, Series
from stochlin.applications.sheets.columns import ColumnName
from stochlin.files.inputs import input_path, read_text
from stochlin.messages import brief, plain, refuse
from stochlin.models.arguments import is_label, is_whole
from stochlin.models.units import likely_unit, size_of

_COMMENT = re.compile(r"^([-+.,;\dDEde\s]*)[#%].*")


class UnknownFormatError(ValueError):
    """A text in which no record can be seen, such as notes beside records."""

    def __init__(self, name: str) -> None:
        titles = ", ".join(of.title for of in FORMATS.values())
        allowed = f"{titles}, columns of numbers; docs/from_records.md has what obspy reads"
        super().__init__(
            f"{name} has no accelerations in a format that is known; allowed: {allowed}"
        )


def read_channels(
    path: str | os.PathLike[str],
    column: ColumnName | None = None,
    time_column: ColumnName | None = None,
    wrapped: bool = False,
    skip: int = 0,
) -> tuple[str, list[Series]]:
    """The name of a record file of any format, and the components in it."""
    path = input_path("path", path)
    name = plain(path.name)
    written = read_text(path).replace("\x1a", "").splitlines()  # control-Z ends old DOS files
    lines = [_COMMENT.sub(r"\1", line) if "#" in line or "%" in line else line for line in written]
    heads = [_head(lines[skip:]), _head(written[skip:])]
    if not heads[0]:
        raise ValueError(f"{name} is empty: it holds no line of numbers")
    of = next((of for of in FORMATS.values() if any(map(of.header.search, heads))), None)
    if of is None:
        if (text := TextFile.of(name, lines, skip)) is None:
            raise UnknownFormatError(name)
        return name, [text.series(column, time_column, wrapped)]
    columns = {"column": column, "time_column": time_column, "wrapped": wrapped or None}
    refuse(name, of.title, columns)
    if not (channels := of.read(RecordFile(name, lines, written))):
        raise UnknownFormatError(name)
    for unit in (channel.units for channel in channels if channel.units):
        if size_of(unit, "m/s^2") is None:
            what = f"{name} has {brief(unit)}; {likely_unit(unit, 'm/s^2')}"
            raise ValueError(f"{what}allowed: units of an acceleration")
    return name, channels


def chosen(channels: Sequence[Series], component: ColumnName | None, name: str) -> Series:
    """The component that is asked for, or the only one, which takes the name if it states none."""
    if component is not None and not (is_whole(component) or is_label(component)):
        raise ValueError(f"component = {brief(component)}; allowed: the name or the number of one")
    names = [channel.about.get("component", "") for channel in channels]
    components = ", ".join(
        f"{n} ({plain(text)})" if text else f"{n}" for n, text in enumerate(names, 1)
    )
    if component is None:
        if len(channels) == 1:
            return channels[0]
        raise ValueError(f"component is missing: {name} has {components}; give component=")
    if names == [""]:
        return channels[0]._replace(about={**channels[0].about, "component": str(component)})
    wanted = letters(component)
    fitting = [n for n, text in enumerate(names) if wanted and letters(text) == wanted]
    if not fitting and wanted in map(str, range(1, len(channels) + 1)):
        fitting = [int(wanted) - 1]
    if len(fitting) != 1:
        count = "is more than one" if fitting else "is not"
        raise ValueError(f"component = {brief(component)} {count} in {name}; allowed: {components}")
    return channels[fitting[0]]


def format_stated(path: str | os.PathLike[str]) -> str:
    """The format of records whose header a text has; empty for other texts."""
    head = _head(read_text(input_path("path", path)).splitlines())
    return next((of.title for of in FORMATS.values() if of.header.search(head)), "")


def letters(text: object) -> str:
    """Letters and digits of a name, in capitals."""
    return re.sub(r"\W|_", "", str(text)).upper()


def is_record(name: str) -> bool:
    """Whether a file has the ending of a record, also if it is compressed by gzip."""
    endings = "|".join(["txt", "csv", "dat", "acc", *(of.endings for of in FORMATS.values())])
    return re.search(rf"\.({endings})(\.gz)?$", name, re.IGNORECASE) is not None


def _head(lines: Sequence[str]) -> str:
    """The first lines with text, in which the headers of formats are searched."""
    return "\n".join(islice(filter(str.strip, lines), HEADER_LINES))
