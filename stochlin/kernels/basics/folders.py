"""Files of one process: locked while it lives, and removed after it, even if it was killed."""

from __future__ import annotations

import os
import re
import shutil
import tempfile
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from multiprocessing.util import Finalize
from pathlib import Path


@cache
def process_folder() -> Path:
    """The temporary folder of this process, which is removed at its end."""
    hidden = Path(tempfile.mkdtemp(prefix=".stochlin-"))  # until it is locked
    with suppress(OSError):  # Windows opens no folders
        lock(os.open(hidden, os.O_RDONLY))
    folder = hidden.rename(hidden.with_name(hidden.name[1:]))
    # Not in the child of a fork, and after the processes that this one has started.
    Finalize(None, shutil.rmtree, (folder, True), exitpriority=-1)
    remove_left(folder.parent, r"stochlin-\w{8}", is_left)
    return folder


def lock(handle: int) -> bool:
    """Lock an open file or folder until it is closed; False if another process has, or none can."""
    with suppress(OSError, ImportError):
        from fcntl import LOCK_EX, LOCK_NB, flock  # not on Windows

        flock(handle, LOCK_EX | LOCK_NB)
        return True
    return False


def is_left(path: Path) -> bool:
    """Whether the process that had locked a file or folder has ended."""
    handle = os.open(path, os.O_RDONLY)
    try:
        return lock(handle)
    finally:
        os.close(handle)


def remove_left(place: Path, names: str, unused: Callable[[Path], bool]) -> None:
    """Remove what has a name of this pattern, belongs to this user and is not used any more."""
    for path in (each for each in place.glob("*") if re.fullmatch(names, each.name)):
        with suppress(OSError):  # another process removes it
            # Where there are no users, the number of each is 0.
            if path.lstat().st_uid == getattr(os, "getuid", int)() and unused(path):
                (shutil.rmtree if path.is_dir() else os.unlink)(path)
