"""Kinds of files that are known by how they begin, and what to do with those that are not read."""

from __future__ import annotations

import re
from typing import NamedTuple

_EDGE = 4096  # bytes at each end in which a kind is recognized; archives list their parts at the end
_MARK = b"\xef\xbb\xbf"  # of text in UTF-8, which some programs write


class FileKind(NamedTuple):
    """A kind of files: its title with its article, how its content begins, and a way to read it."""

    title: str
    begins: re.Pattern[bytes]
    cure: str

    def fits(self, content: bytes) -> bool:
        """Whether a file with this content is of the kind."""
        content = content.removeprefix(_MARK)
        return self.begins.match(content[:_EDGE] + content[-_EDGE:]) is not None


def _kind(title: str, begins: bytes, cure: str) -> FileKind:
    return FileKind(title, re.compile(begins, re.DOTALL | re.IGNORECASE), cure)


_OBSPY = "read it with obspy, as docs/from_records.md shows"
# The names of the parts of a workbook stand in a zip archive as they are; .xls begins as the second.
WORKBOOK = _kind(
    "a workbook", rb"PK\x03\x04.*(?:\[Content_Types\]|xl/)|\xd0\xcf\x11\xe0", "save its table as .csv"
)
JSON = _kind("JSON", rb"\s*\{", "write its numbers into columns of text")
KINDS = (
    WORKBOOK,
    JSON,
    _kind(
        "a compressed archive",
        rb"PK[\x03\x05]|7z\xbc\xaf|Rar!|BZh\d|\xfd7zXZ",
        "unpack it, and name a file in it",
    ),
    _kind("miniSEED", rb"\d{6}[VDRQM][ \0]|MS\x03", _OBSPY),
    _kind("SAC", rb".{304}(?:[\x06\x07]\0\0\0|\0\0\0[\x06\x07])", _OBSPY),
    _kind(
        "NRML of OpenQuake",
        rb"\s*<.*<nrml\b|\s*<nrml\b",
        "export the hazard as .csv, as by 'oq export hcurves -1 --exports csv'",
    ),
    _kind("a web page", rb"\s*<(?:!doctype html|html)\b", "download the file itself"),
    _kind(
        "XML",
        rb"\s*<[?!a-z]",
        "export its numbers as .csv, or read records with obspy as docs/from_records.md shows",
    ),
    _kind(
        "a model of SAP2000 (.s2k)",
        rb'.*TABLE:\s+"[^"\n]*"[^\n]*\n[ \t]+\w+=',
        "export its tables as .xlsx or .csv",
    ),
    _kind(
        "a model of ETABS (.e2k)",
        rb"\$ (?:File|PROGRAM INFORMATION)\b",
        "export its tables as .xlsx or .csv",
    ),
    _kind("a PDF", rb"%PDF-", "copy its numbers into columns of text"),
    _kind("a netCDF or HDF5 file", rb"\x89HDF|CDF[\x01\x02\x05]", "save its numbers as columns of text"),
    _kind("a file of MATLAB", rb"MATLAB 5\.0", "save its numbers as text, as by writematrix"),
    _kind("an array of numpy", rb"\x93NUMPY", "save it as text, as by numpy.savetxt"),
)


def check_kind(name: str, content: bytes, read: FileKind | None = None) -> None:
    """Raise a ValueError for a file of a kind that is known, unless it is the kind that is read."""
    for kind in KINDS:
        if kind is not read and kind.fits(content):
            raise ValueError(f"{name} is {kind.title}, which is not read here; {kind.cure}")
