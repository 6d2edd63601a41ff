"""Kinds of files that are known by how they begin, and what to do with those that are not read."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import NamedTuple

from stochlin.files.package_data import data_of

# bytes at each end in which a kind is recognized; archives list their parts at the end
_BYTES_AT_ENDS = 4096
_MARK = b"\xef\xbb\xbf"  # of text in UTF-8, which some programs write


class FileKind(NamedTuple):
    """A kind of files: its title with its article, how its content begins, and a way to read it."""

    title: str
    begins: re.Pattern[bytes]
    cure: str

    def fits(self, content: bytes) -> bool:
        """Whether a file with this content is of the kind."""
        content = content.removeprefix(_MARK)
        return self.begins.match(content[:_BYTES_AT_ENDS] + content[-_BYTES_AT_ENDS:]) is not None


def _read_kinds() -> Mapping[str, FileKind]:
    """The kinds of `file_kinds.toml`."""
    flags = re.DOTALL | re.IGNORECASE
    return {
        name: FileKind(kind["title"], re.compile(kind["begins"].encode(), flags), kind["cure"])
        for name, kind in data_of(__package__, "file_kinds.toml").items()
    }


KINDS_OF_FILES = _read_kinds()
WORKBOOK = KINDS_OF_FILES["workbook"]
JSON = KINDS_OF_FILES["json"]


def check_kind(name: str, content: bytes, read: FileKind | None = None) -> None:
    """Raise a ValueError for a file of a kind that is known, unless it is the kind that is read."""
    for kind in KINDS_OF_FILES.values():
        if kind is not read and kind.fits(content):
            raise ValueError(f"{name} is {kind.title}, which is not read here; {kind.cure}")
