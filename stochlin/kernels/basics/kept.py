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

import atexit
import hashlib
import os
import platform
import re
import shutil
import tempfile
import time
import warnings
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import cache
from importlib.metadata import version
from pathlib import Path
from threading import Lock, RLock
from typing import Any

import numba as nb

from stochlin.messages import WHEN_COMPILING

KERNELS = Path(__file__).parents[1]
BUILT_WITH = ("numba", "llvmlite", "numpy")
DAY = 86400.0  # [s]: folders of other versions, of processes that were killed, and laws are then removed
LAW = "law-"  # begins the names of archives of laws
NOT_KEPT = (
    "compiled code cannot be kept: the folder that NUMBA_CACHE_DIR names, or without it both stochlin's "
    "own folder and the user's cache folder, cannot be written, or the disk is full. Every process then "
    "compiles anew what it uses, which takes seconds to a minute; set the environment variable "
    "NUMBA_CACHE_DIR to a folder that can be written"
)


@cache
def warn_once(why: str) -> None:
    """Warn that calls will be slow, and why; once in a process for each reason."""
    warnings.warn(why, stacklevel=2)


def digest_of(sources: Path) -> str:
    """Digest of all modules below a folder, and of what else compiled code depends on."""
    versions = sources, platform.python_version(), [version(name) for name in BUILT_WITH]
    checked = nb.config.BOUNDSCHECK  # type: ignore[attr-defined]
    digest = hashlib.sha256(repr((versions, checked)).encode())
    for file in sorted(sources.rglob("*.py")):
        digest.update(file.read_bytes())
    return digest.hexdigest()[:16]


@cache
def archives() -> Path | None:
    """The folder of the archives; None, with a warning, if there is none that can be written."""
    user = os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")
    named = nb.config.CACHE_DIR  # type: ignore[attr-defined]
    own = Path(named or user, "stochlin")
    for place in [own] if named else [KERNELS.parent / "__pycache__", own]:
        folder = Path(place, f"kernels-{digest_of(KERNELS)}")
        try:
            folder.mkdir(parents=True, exist_ok=True)
            tempfile.TemporaryFile(dir=folder).close()
            os.utime(folder)
        except OSError:
            continue
        _remove_unused(folder.parent, r"kernels-[0-9a-f]{16}")
        return folder
    warn_once(NOT_KEPT)
    return None


@cache
def _of_process() -> Path:
    """The folder of this process."""
    folder = Path(tempfile.mkdtemp(prefix="stochlin-kernels-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    _remove_unused(folder.parent, r"stochlin-kernels-\w{8}")
    return folder


def _remove_unused(place: Path, names: str) -> None:
    """Remove what has a name of this pattern, belongs to this user and was not used for a day."""
    user = getattr(os, "getuid", int)()  # 0 where there are no users
    for path in (each for each in place.iterdir() if re.fullmatch(names, each.name)):
        with suppress(OSError):  # another process removes it
            about = path.lstat()
            if about.st_uid == user and time.time() - about.st_mtime > DAY:
                (shutil.rmtree if path.is_dir() else os.unlink)(path)


_changing = RLock()  # numba's folder is a setting of the whole process


class Archive:
    """What numba has compiled of one function: a file, and what is unpacked of it for this process."""

    def __init__(self, name: str) -> None:
        within = archives()
        self.file = within and within / f"{name}.zip"
        self.folder = within and _of_process() / name

    @contextmanager
    def taken_by_numba(self) -> Iterator[None]:
        """Functions that numba is told to keep are kept here."""
        config: Any = nb.config
        with _changing:
            named, config.CACHE_DIR = config.CACHE_DIR, str(self.folder)
            try:
                yield
            finally:
                config.CACHE_DIR = named

    def fetch(self) -> None:
        """Unpack the file, if there is one that is whole."""
        try:
            with zipfile.ZipFile(self.file or "") as archive:
                archive.extractall(self.folder)
            os.utime(self.file or "")
        except Exception:  # what a damaged archive raises is not documented
            if self.folder is not None:
                shutil.rmtree(self.folder, ignore_errors=True)
            for call in tuple(WHEN_COMPILING):
                call()

    def store(self) -> None:
        """Replace the file by what numba has written."""
        assert self.file is not None
        assert self.folder is not None
        whole = self.file.with_suffix(f".{os.getpid()}")
        try:
            whole.parent.mkdir(parents=True, exist_ok=True)
            with zipfile.ZipFile(whole, "w") as archive:
                for file in self.folder.rglob("*.nb?"):
                    archive.write(file, file.relative_to(self.folder))
            whole.replace(self.file)
        except OSError:
            warn_once(NOT_KEPT)
            with suppress(OSError):
                whole.unlink()


def kept_law(function: Any, signature: Any, name: str) -> Any:
    """A C function with this signature, compiled now or found in the archive of a law of this name.

    The name tells all that the function depends on besides the kernels.
    """
    options: dict[str, Any] = {"error_model": "numpy"}
    archive = Archive(LAW + hashlib.sha256(name.encode()).hexdigest()[:16])
    if archive.file is not None:
        archive.fetch()
        try:
            with archive.taken_by_numba():
                law = nb.cfunc(signature, cache=True, **options)(function)
        except OSError:  # of numba, which could not write the code that it has just compiled
            warn_once(NOT_KEPT)
        else:
            if not law.cache_hits:
                archive.store()
                _remove_unused(archive.file.parent, rf"{LAW}[0-9a-f]{{16}}\.\w+")
            return law
    return nb.cfunc(signature, **options)(function)


class Kept:
    """A function that numba compiles at its first call, or finds compiled in its archive.

    ``options`` are those of ``numba.njit``.
    """

    def __init__(self, function: Any, options: dict[str, Any]) -> None:
        self.py_func, self.__doc__ = function, function.__doc__
        self._lock, self._fetched, self._kept, self._misses = Lock(), False, 0, 0
        self._archive = Archive(
            f"{function.__module__}.{function.__qualname__}-{function.__code__.co_firstlineno}"
        )
        if self._archive.file is None:
            self.dispatcher = nb.njit(**options)(function)
            return
        with self._archive.taken_by_numba():
            self.dispatcher = nb.njit(cache=True, **options)(function)

    @property
    def kinds(self) -> int:
        """Number of kinds of arguments for which the function is compiled in this process."""
        return len(self.dispatcher.overloads)

    @property
    def kept(self) -> bool:
        """Whether the function has an archive, from which it is ready in a tenth of a second."""
        return self._archive.file is not None and self._archive.file.exists()

    def __call__(self, *args: Any) -> Any:
        """The function, compiled."""
        if not self._fetched:
            with self._lock:
                if not self._fetched:
                    self._archive.fetch()
                self._fetched = True
        try:
            result = self.dispatcher(*args)
        except OSError:  # of numba, which could not write the code that it has just compiled
            warn_once(NOT_KEPT)
            result = self.dispatcher(*args)
        if len(self.dispatcher.overloads) > self._kept:
            self._store()
        return result

    def _store(self) -> None:
        """Replace the archive, if numba has compiled and written something."""
        with self._lock:
            self._kept = self.kinds
            misses = sum(self.dispatcher.stats.cache_misses.values())
            if self._archive.file is not None and misses != self._misses:
                self._misses = misses
                self._archive.store()
