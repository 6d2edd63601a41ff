"""Decorators that compile kernels with numba, and the folder in which numba keeps compiled code.

================  ==================================================================================
`entry`           for functions called from Python; the compiled code is kept on the disk
`compiled`        for functions called from compiled code; from Python they are plain Python
`called_often`    as `compiled`, for functions so short that a call takes longer than their work:
                  inlined
`called_once`     as `compiled`, for functions with one caller, of which they become a part: not
                  compiled apart, which halves the time of the compiler
================  ==================================================================================

numba compiles a function again only if its own source file has changed. The folder is therefore
named after a digest of all kernel sources and versions. Processes that compile a function at the
same time for arguments of different types may overwrite one another's files: each function on the
disk is called with arguments of one type only (`variant`).
"""

from __future__ import annotations

import hashlib
import os
import platform
import tempfile
import time
import types
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from importlib.metadata import version
from pathlib import Path
from threading import RLock
from typing import Any

import numba as nb
import numpy as np
from numba.extending import overload, register_jitable

from stochlin.files.folders import is_private, mark, remove_unused
from stochlin.messages import WHEN_COMPILING

KERNELS = Path(__file__).parents[1]
PROGRAM_CACHE = KERNELS.parent / "__pycache__"
CONFIG: Any = nb.config
UNCOMPILED = bool(CONFIG.DISABLE_JIT)
NOT_COMPILED = (
    "the environment variable NUMBA_DISABLE_JIT is set: nothing is compiled, and simulations take "
    "a thousand times as long, hours for what takes seconds; unset it, unless that is wanted"
)
NOT_KEPT = (
    "compiled code cannot be kept: the folder that NUMBA_CACHE_DIR names, or without it both "
    "stochlin's own folder and the user's cache folder, cannot be written, or not by this user "
    "alone, or the disk is full. Every process then compiles anew what it uses, which takes "
    "seconds to a minute; set the environment variable NUMBA_CACHE_DIR to a folder that can be "
    "written"
)
NOT_PRIVATE = (
    "the folder that NUMBA_CACHE_DIR names is not used, since others could put code there that "
    "this user would run: compiled code is kept in stochlin's own folder; name a folder that this "
    "user alone can write, and so all folders above it"
)
FOLDER_PREFIX = "kernels-"  # of folders of compiled code
ENTRY_OPTIONS: dict[str, Any] = {"nogil": True, "error_model": "numpy", "no_cfunc_wrapper": True}
# Functions that only compiled code calls need no code to be called from elsewhere, a third of the
# time.
INNER: Any = {"error_model": "numpy", "no_cpython_wrapper": True, "no_cfunc_wrapper": True}
FORCED_INLINE: Any = INNER | {"forceinline": True}

compiled: Callable[[Any], Any] = register_jitable(**INNER)
called_often: Callable[[Any], Any] = register_jitable(**FORCED_INLINE)
called_once = nb.njit(inline="always", **ENTRY_OPTIONS)
_naming_folder = RLock()  # numba's folder is a setting of the whole process


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
def code_folder() -> Path | None:
    """The folder of compiled code, the first of its places that can be used; None if none can.

    Compiled code is run as it is read: where others could write, it would be theirs.
    """
    if CONFIG.CACHE_DIR:
        folder = _folder_in(Path(CONFIG.CACHE_DIR, "stochlin"))
        if folder is None or is_private(folder):
            return folder
        warn_once(NOT_PRIVATE)
    folder = _folder_in(PROGRAM_CACHE)  # who can write there can also change the program
    if folder is not None:
        return folder
    user = os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")
    folder = _folder_in(Path(user, "stochlin"))
    return folder if folder is not None and is_private(folder) else None


def _folder_in(place: Path) -> Path | None:
    """The folder of this version's compiled code in a place; None if it cannot be written.

    It has no link in its path, which another user might turn elsewhere after a look at the folder.
    """
    place = Path(os.path.realpath(place))
    folder = place / f"{FOLDER_PREFIX}{digest_of(KERNELS)}"
    yesterday = time.time() - 86400.0  # [s]
    try:
        place.mkdir(mode=0o755, parents=True, exist_ok=True)
        folder.mkdir(mode=0o755, exist_ok=True)
        with suppress(FileExistsError):  # marked already
            os.close(mark(folder))
        remove_unused(place, FOLDER_PREFIX, yesterday)
        tempfile.TemporaryFile(dir=folder).close()
        os.utime(folder)
    except OSError:
        return None
    return folder


@contextmanager
def _kept_on_disk(function: Any) -> Iterator[bool]:
    """Have numba keep on the disk what it is asked to keep in this block; False if it cannot."""
    module = function.__module__.rpartition(".")[2]
    line = function.__code__.co_firstlineno
    code = f"{module}.{function.__qualname__}-{line}."
    with _naming_folder:
        folder = code_folder()
        named = CONFIG.CACHE_DIR
        if folder is None:
            warn_once(NOT_KEPT)
        for call in tuple(WHEN_COMPILING):
            if folder is None or not any(folder.rglob(f"{code}*.nbi")):
                call()
        CONFIG.CACHE_DIR = str(folder or named)
        try:
            yield folder is not None
        finally:
            CONFIG.CACHE_DIR = named


class Entry:
    """A function that numba compiles at its first call, or finds compiled on the disk."""

    def __init__(self, function: Any) -> None:
        self.py_func = function
        self.__doc__ = function.__doc__
        self.dispatcher: Any = nb.njit(**ENTRY_OPTIONS)(function)
        self._ready = False

    def __call__(self, *args: Any, **named: Any) -> Any:
        """The function, compiled."""
        if not self._ready:
            with _kept_on_disk(self.py_func) as can_be_kept:
                if can_be_kept and not self._ready:
                    self.dispatcher.enable_caching()
                self._ready = True
        try:
            return self.dispatcher(*args, **named)
        except OSError:  # of numba, which could not write the code that it has just compiled
            warn_once(NOT_KEPT)
            return self.dispatcher(*args, **named)


def entry(function: Any) -> Any:
    """Compile a function that Python calls, and keep it on the disk."""
    if not UNCOMPILED:
        return Entry(function)
    warn_once(NOT_COMPILED)
    return np.errstate(all="ignore")(function)  # no warnings of overflow, as in compiled code


def variant(function: Any, name: str) -> Any:
    """The same function under a name of its own, for arguments of other types."""
    copy = types.FunctionType(function.__code__, function.__globals__, function.__name__)
    copy.__qualname__ = name
    copy.__doc__ = function.__doc__
    return copy


def by_pointer(function: Any, *arguments: Any) -> Any:
    """The function as a C function for arguments of the types of these, which returns nothing.

    What calls it by its pointer does not contain it: each of both is compiled once, and only if
    used.
    """
    with _naming_folder:
        return function if UNCOMPILED else c_function(function, nb.void(*map(nb.typeof, arguments)))


@cache
def c_function(function: Any, signature: Any) -> Any:
    """A C function with this signature, compiled now or found on the disk by its qualified name."""
    try:
        with _kept_on_disk(function) as can_be_kept:
            return nb.cfunc(signature, cache=can_be_kept, error_model="numpy")(function)
    except OSError:  # of a full disk
        warn_once(NOT_KEPT)
        return nb.cfunc(signature, error_model="numpy")(function)


def of_lane(value: Any, lane: int) -> Any:
    """Element ``lane`` of an array over lanes, or the number itself if all lanes share one."""
    return value[lane] if np.ndim(value) else value


@overload(of_lane, jit_options=FORCED_INLINE)
def _of_lane(value, lane):  # type: ignore[no-untyped-def]
    if isinstance(value, nb.types.Array):
        return lambda value, lane: value[lane]
    return lambda value, lane: value
