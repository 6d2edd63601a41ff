"""The folder in which numba keeps compiled functions, so that nothing damaged or old is taken from it.

numba (``cache=True``) compiles a function again only if its own source file has changed, lets processes
that start together overwrite one another's files, and runs a file whose bytes have changed. Each process
therefore has a folder of its own, and each function a folder in it. What numba has written there is
packed into one archive of the function, which is replaced whole and whose check sums are compared when
it is unpacked. The archives lie in a folder named after a digest of all kernel sources and versions.
Those of laws that are compiled at run time, of which there can be any number, are removed when they were
not used for a day.
"""

from __future__ import annotations

import hashlib
import os
import platform
import re
import shutil
import tempfile
import time
import warnings
import zipfile
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from importlib.metadata import version
from io import BytesIO
from multiprocessing.util import Finalize
from pathlib import Path
from threading import RLock
from typing import Any

import numba as nb

from stochlin.messages import WHEN_COMPILING

KERNELS = Path(__file__).parents[1]
CONFIG: Any = nb.config
DAY = 86400.0  # [s]: archives of other versions and of laws are then removed
LAW, WRITING = "law-", "writing-"  # begin the names of archives of laws, and of what is not yet whole
NOT_KEPT = (
    "compiled code cannot be kept: the folder that NUMBA_CACHE_DIR names, or without it both stochlin's "
    "own folder and the user's cache folder, cannot be written, or the disk is full, or that of "
    "temporary files. Every process then compiles anew what it uses, which takes seconds to a minute; "
    "set the environment variable NUMBA_CACHE_DIR to a folder that can be written"
)
_changing = RLock()  # archives, and numba's folder, which is a setting of the whole process


@cache
def warn_once(why: str) -> None:
    """Warn that calls will be slow, and why; once in a process for each reason."""
    warnings.warn(why, stacklevel=2)


def digest_of(sources: Path) -> str:
    """Digest of all modules below a folder, and of what else compiled code depends on."""
    versions = platform.python_version(), [version(name) for name in ("numba", "llvmlite", "numpy")]
    digest = hashlib.sha256(repr((sources, versions, CONFIG.BOUNDSCHECK)).encode())
    for file in sorted(sources.rglob("*.py")):
        digest.update(file.read_bytes())
    return digest.hexdigest()[:16]


@cache
def places() -> list[Path]:
    """Folders in which archives may lie, the preferred first."""
    user = os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")
    own, within = Path(CONFIG.CACHE_DIR or user, "stochlin"), KERNELS.parent / "__pycache__"
    name = f"kernels-{digest_of(KERNELS)}"
    return [place / name for place in ([own] if CONFIG.CACHE_DIR else [within, own])]


@cache
def archives() -> Path | None:
    """The folder to which archives are written; None if there is none that can be written."""
    for folder in places():
        with suppress(OSError):
            folder.mkdir(parents=True, exist_ok=True)
            tempfile.TemporaryFile(dir=folder).close()
            os.utime(folder)
            remove_left(folder.parent, r"kernels-[0-9a-f]{16}", _is_old)
            remove_left(folder, rf"{LAW}[0-9a-f]{{16}}\.zip|{WRITING}\w{{8}}", _is_old)
            return folder
    return None


@cache
def folder_of(process: int) -> Path:
    """The temporary folder of this process: locked while it lives, and removed at its end."""
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


def _is_old(path: Path) -> bool:
    return time.time() - path.lstat().st_mtime > DAY


def remove_left(place: Path, names: str, unused: Callable[[Path], bool]) -> None:
    """Remove what has a name of this pattern, belongs to this user and is not used any more."""
    for path in (each for each in place.glob("*") if re.fullmatch(names, each.name)):
        with suppress(OSError):  # another process removes it
            # Where there are no users, the number of each is 0.
            if path.lstat().st_uid == getattr(os, "getuid", int)() and unused(path):
                (shutil.rmtree if path.is_dir() else os.unlink)(path)


class Archive:
    """What numba has compiled of one function: a file, and what is unpacked of it for this process."""

    def __init__(self, name: str) -> None:
        # The first is written; the first that is there is read, and the others can perhaps only be read.
        self.files = [folder / f"{name}.zip" for folder in (archives(), *places()) if folder]
        self._stored: set[Path] | None = None  # code in the file; None where that is not known

    def begin(self, keep: Callable[[], Any]) -> Any:
        """Unpack the file for this process, where numba keeps what it is told to keep by a call.

        Returns what the call does, or None if nothing can be kept.
        """
        named = CONFIG.CACHE_DIR
        try:
            self._folder = folder_of(os.getpid()) / self.files[0].stem
            self._unpack()
            self._folder.mkdir(parents=True, exist_ok=True)
            CONFIG.CACHE_DIR = str(self._folder)
            return keep()
        except OSError:  # of numba, too, which could not write the code that it has just compiled
            warn_once(NOT_KEPT)
        finally:
            CONFIG.CACHE_DIR = named

    def _unpack(self) -> None:
        """Unpack the file, if there is one that is whole."""
        self._stored = set()
        try:
            file = next(filter(os.path.exists, self.files), self.files[0])
            with zipfile.ZipFile(BytesIO(file.read_bytes())) as archive:
                archive.extractall(self._folder)
            self._stored = set(self._folder.rglob("*.nbc"))
            with suppress(OSError):  # it can perhaps only be read
                os.utime(file)
        except Exception as error:  # what a damaged archive raises is not documented
            if isinstance(error, OSError) and not isinstance(error, FileNotFoundError):  # a full disk
                self._stored = None
                warn_once(NOT_KEPT)
            shutil.rmtree(self._folder, ignore_errors=True)
            for call in tuple(WHEN_COMPILING):
                call()

    def store(self) -> None:
        """Replace the file by what numba has written, if that is more than the file has."""
        with _changing:
            if self._stored is None or not set(self._folder.rglob("*.nbc")) > self._stored:
                return
            try:
                with tempfile.TemporaryDirectory(prefix=WRITING, dir=self.files[0].parent) as folder:
                    whole = Path(folder, self.files[0].name)
                    with zipfile.ZipFile(whole, "w") as archive:
                        for file in self._folder.rglob("*.nb?"):
                            archive.write(file, file.relative_to(self._folder))
                    whole.replace(self.files[0])
                self._stored = set(self._folder.rglob("*.nbc"))
            except OSError:
                warn_once(NOT_KEPT)


def kept_law(function: Any, signature: Any, name: str) -> Any:
    """A C function with this signature, compiled now or found in the archive of a law of this name.

    The name tells all that the function depends on besides the kernels.
    """
    options: dict[str, Any] = {"error_model": "numpy"}
    with _changing:
        archive = Archive(LAW + hashlib.sha256(name.encode()).hexdigest()[:16])
        law = archive.begin(lambda: nb.cfunc(signature, cache=True, **options)(function))
        archive.store()
    return law or nb.cfunc(signature, **options)(function)


class Kept:
    """A function that numba compiles at its first call, or finds compiled in its archive.

    ``options`` are those of ``numba.njit``.
    """

    def __init__(self, function: Any, options: dict[str, Any]) -> None:
        self.py_func, self.__doc__ = function, function.__doc__
        self.dispatcher: Any = nb.njit(**options)(function)
        self._process = 0  # for which the archive is unpacked
        name = f"{function.__module__}.{function.__qualname__}-{function.__code__.co_firstlineno}"
        self._archive = Archive(name)

    @property
    def kinds(self) -> int:
        """Number of kinds of arguments for which the function is compiled in this process."""
        return len(self.dispatcher.overloads)

    def __call__(self, *args: Any) -> Any:
        """The function, compiled."""
        if self._process != os.getpid():  # at the first call, also in the child of a fork
            with _changing:
                if self._process != os.getpid():
                    self._archive.begin(self.dispatcher.enable_caching)
                self._process = os.getpid()
        kinds = self.kinds
        try:
            result = self.dispatcher(*args)
        except OSError:  # of numba, which could not write the code that it has just compiled
            warn_once(NOT_KEPT)
            result = self.dispatcher(*args)
        if self.kinds > kinds:
            self._archive.store()
        return result
