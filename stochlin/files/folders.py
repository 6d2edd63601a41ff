"""Folders that this package makes beside files of others: marked, and removed after their process.

A name is no mark, since anybody may choose the same. A folder of this package has a file inside
that says so, with a digest of the folder's name. The process that made it locks this file before it
writes the mark: one that is not locked was left behind by a process that has ended, even if it was
killed.
"""

from __future__ import annotations

import atexit
import hashlib
import os
import shutil
import stat
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path

MARK = ".stochlin-folder"
_LONGEST_MARK = 200
# Without following a link, and without waiting for the writer of a pipe. Windows has no such flags.
_AT_ONCE: int = getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0)
_PREFIX = "stochlin-"  # of temporary folders


def mark(folder: Path) -> int:
    """Mark a new folder; it counts as used until the returned handle is closed."""
    handle = os.open(folder / MARK, os.O_RDWR | os.O_CREAT | os.O_EXCL, 0o600)
    _lock(handle)
    os.write(handle, _mark_of(folder.name, os.getpid()))
    return handle


def is_marked(folder: Path) -> bool:
    """Whether a folder of this user was marked by this package."""
    with suppress(OSError), _mark_in(folder) as handle:
        return handle is not None
    return False


def remove_left(place: Path, prefix: str) -> None:
    """Remove marked folders whose names begin so, if the processes that made them have ended."""
    for folder in _folders(place, prefix):
        with suppress(OSError), _mark_in(folder) as handle:  # another process may remove it, too
            if handle is not None and _lock(handle):
                shutil.rmtree(folder)


def remove_unused(place: Path, prefix: str, since: float) -> None:
    """Remove marked folders with names that begin so and were not changed since a time [s]."""
    for folder in _folders(place, prefix):
        with suppress(OSError):
            if folder.lstat().st_mtime < since and is_marked(folder):
                shutil.rmtree(folder)


@contextmanager
def temporary_folder(place: Path, prefix: str) -> Iterator[Path]:
    """A new marked folder, removed after the block, as are those left there by killed processes."""
    remove_left(place, prefix)
    folder = Path(tempfile.mkdtemp(prefix=prefix, dir=place))
    try:
        handle = mark(folder)
        try:
            yield folder
        finally:
            os.close(handle)  # Windows removes no open file
    finally:
        shutil.rmtree(folder, ignore_errors=True)


@cache
def process_folder() -> Path:
    """The temporary folder of this process, which is removed at its end."""
    place = Path(tempfile.gettempdir())
    remove_left(place, _PREFIX)
    folder = Path(tempfile.mkdtemp(prefix=_PREFIX, dir=place))
    handle = mark(folder)
    process = os.getpid()

    @atexit.register
    def remove() -> None:
        """Unless this is a fork of the process."""
        if os.getpid() == process:
            os.close(handle)
            shutil.rmtree(folder, ignore_errors=True)

    return folder


def is_private(folder: Path) -> bool:
    """Whether this user or root alone can change a folder, what it holds, and the folders above it.

    Windows does not say who can, and every folder passes there.
    """
    if not hasattr(os, "getuid"):
        return True
    folder = folder.resolve()
    parts = (folder.stat(), *(path.lstat() for path in folder.rglob("*")))
    above = (path.stat() for path in folder.parents)
    return all(map(_is_safe, parts)) and all(
        _is_safe(status) or _is_sticky(status) for status in above
    )


def _is_safe(status: os.stat_result) -> bool:
    """Whether what has this status is of this user or root, and others cannot write to it."""
    # A group of one user alone has the number of that user on most systems.
    private = status.st_gid in (0, status.st_uid)
    others = stat.S_IWOTH if private else stat.S_IWOTH | stat.S_IWGRP
    closed = stat.S_ISLNK(status.st_mode) or not status.st_mode & others
    return status.st_uid in (0, os.getuid()) and closed


def _is_sticky(status: os.stat_result) -> bool:
    """Whether others can rename in a folder what is theirs, and nothing else, as in ``/tmp``."""
    return status.st_uid in (0, os.getuid()) and bool(status.st_mode & stat.S_ISVTX)


def _folders(place: Path, prefix: str) -> Iterator[Path]:
    with os.scandir(place) as entries:
        names = [entry.name for entry in entries if entry.name.startswith(prefix)]
    return (place / name for name in names)


@contextmanager
def _mark_in(folder: Path) -> Iterator[int | None]:
    """The open mark of a folder of this user, or None if what is there is no mark of it."""
    status = folder.lstat()
    handle = os.open(folder / MARK, os.O_RDONLY | _AT_ONCE)
    try:
        is_file = stat.S_ISREG(os.fstat(handle).st_mode)
        text = os.read(handle, _LONGEST_MARK) if is_file else b""
        process = int(text.split()[1]) if text.count(b" ") == 2 and text.split()[1].isdigit() else 0
        # Where there are no users, the number of each is 0.
        is_ours = stat.S_ISDIR(status.st_mode) and status.st_uid == getattr(os, "getuid", int)()
        yield handle if is_ours and text == _mark_of(folder.name, process) else None
    finally:
        os.close(handle)


def _mark_of(name: str, process: int) -> bytes:
    """What the mark of a folder of this name says."""
    digest = hashlib.sha256(f"stochlin {process} {name}".encode()).hexdigest()
    return f"stochlin {process} {digest}".encode()


def _lock(handle: int) -> bool:
    """Lock an open file until it is closed; False if another process has, or if none can."""
    with suppress(OSError, ImportError):
        from fcntl import LOCK_EX, LOCK_NB, flock  # not on Windows

        flock(handle, LOCK_EX | LOCK_NB)
        return True
    return False
