"""Files that a user names: regular files of a limited size, where it is asked within one folder."""

from __future__ import annotations

import gzip
import os
import re
import stat
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from io import BytesIO
from pathlib import Path

from stochlin.files.file_kinds import FileKind, check_kind
from stochlin.files.paths import as_path
from stochlin.messages import brief, plain

_GZIP = b"\x1f\x8b"
MOST_BYTES = 64 * 2**20
MOST_LINES_OF_TEXT = 2_000_000
_ADDRESS = re.compile(r"(^|.*/)[A-Za-z][A-Za-z0-9+.-]+://?")  # pathlib makes one slash of two
_folder: ContextVar[Path | None] = ContextVar("folder", default=None)


@contextmanager
def only_within(folder: Path) -> Iterator[None]:
    """Refuse inputs outside of this folder: for a case file of somebody else."""
    token = _folder.set(folder)
    try:
        yield
    finally:
        _folder.reset(token)


def input_path(name: str, value: object) -> Path:
    """The path of a file or folder to be read.

    Raises a TypeError or ValueError if ``value`` cannot be one, is an address on a network, or lies
    outside of the folder of `only_within` once links are followed.
    """
    path = as_path(name, value)
    folder = _folder.get()
    if folder is not None and not path.resolve().is_relative_to(folder.resolve()):
        as_written = str(value).removeprefix(f"{folder}{os.sep}")
        what = f"{name} = {brief(as_written)} is outside of the folder of the case file"
        raise ValueError(f"{what}; allowed here: files in that folder; 'stochlin gap' reads any")
    if _ADDRESS.match(str(value)) and not path.exists():
        what = f"{name} = {brief(str(value))} is an address on a network"
        raise ValueError(f"{what}; allowed: a file on this computer")
    return path


def read_input(path: Path, most: int = MOST_BYTES) -> bytes:
    """Content of a regular file of at most ``most`` bytes and `MOST_LINES_OF_TEXT` lines.

    Raises an OSError if it cannot be read, and a ValueError that says what it is in place of that.
    """
    path = input_path("path", path)
    name = plain(path.name)
    status = path.stat()
    if not stat.S_ISREG(status.st_mode):
        what = "a folder" if stat.S_ISDIR(status.st_mode) else "a device or a pipe"
        raise ValueError(f"{name} is {what}; allowed: a regular file")
    with path.open("rb") as file:
        return _limited(file.read, name, most, status.st_size)


def _limited(read: Callable[[int], bytes], name: str, most: int, size: int = 0) -> bytes:
    content = read(most + 1)
    if len(content) > most:
        what = f"{name} has {max(size, len(content))} bytes or more"
        raise ValueError(f"{what}; allowed: {most} bytes ({most >> 20} MiB)")
    lines = content.count(b"\n")
    if lines > MOST_LINES_OF_TEXT:
        raise ValueError(
            f"{name} has {lines} lines; allowed: {MOST_LINES_OF_TEXT}; leave out empty lines"
        )
    return content


def read_text(path: Path, kind: FileKind | None = None) -> str:
    """Text of a file as `read_input` reads it, also compressed by gzip.

    A ValueError is raised if it is not text in UTF-8, or of another known kind than this one.
    """
    content = read_input(path)
    if content.startswith(_GZIP):
        try:
            with gzip.GzipFile(fileobj=BytesIO(content)) as file:
                content = _limited(file.read, f"{plain(path.name)}, unpacked,", MOST_BYTES)
        except (OSError, EOFError, zlib.error) as error:
            what = f"{plain(path.name)} is compressed by gzip and damaged"
            raise ValueError(f"{what} ({error}); fetch it again") from error
    check_kind(plain(path.name), content, kind)
    if content.startswith((b"\xff\xfe", b"\xfe\xff")):
        raise ValueError(
            f"{plain(path.name)} is text in UTF-16; allowed: UTF-8, so save it as such"
        )
    if b"\0" in content:
        what = f"{plain(path.name)} is no text; allowed: text in UTF-8, such as columns of numbers"
        raise ValueError(f"{what}; docs/from_records.md has what obspy reads")
    return content.decode("utf-8-sig", errors="replace")
