"""Compiled functions kept on the disk, whatever becomes of the disk.

numba's cache raises where no folder can be written, where a file is cut and where the disk is full. Its
files are numbered by an index: two processes that begin at once may give one number to code for
different arguments, and a flipped bit runs. Here every file is named after what it is for, tells that
again inside, below its digest; whatever is not right is compiled anew, and replaced if that is possible.

To numba, code is out of date when the file of its function has changed. Here it is out of date too when
one has changed of those modules that the file imports, from whose functions the code was made.
"""

from __future__ import annotations

import hashlib
import pickle
import re
import warnings
from functools import cache
from pathlib import Path
from typing import Any

from numba.core.caching import FunctionCache, IndexDataCacheFile, NullCache

from stochlin.messages import WHEN_COMPILING

DIGEST = hashlib.sha256
ROOT = Path(__file__).parents[3]
IMPORTS = re.compile(r"^from (stochlin\.kernels[.\w]*) import (?:\(([^)]*)\)|(.*))$", re.MULTILINE)
NOT_KEPT = (
    "compiled code cannot be kept: neither stochlin's own folder nor the user's cache folder can be "
    "written, or the disk is full. Every process compiles anew what it uses, which takes seconds to a "
    "minute; set the environment variable NUMBA_CACHE_DIR to a folder that can be written"
)
NOT_COMPILED = (
    "the environment variable NUMBA_DISABLE_JIT is set: nothing is compiled, and simulations take a "
    "thousand times as long, hours for what takes seconds; unset it, unless that is wanted"
)


@cache
def say_that_it_is_slow(why: str) -> None:
    """A warning, once in a process."""
    warnings.warn(why, stacklevel=2)


@cache
def digest_of(file: Path) -> bytes:
    """Of the source of a module, and of all modules of kernels that it imports."""
    source = file.read_bytes()
    digest = DIGEST(source)
    for package, lines, line in IMPORTS.findall(source.decode()):
        for name in ("", *re.findall(r"\w+", lines or line)):
            module = ROOT.joinpath(*package.split("."), name).with_suffix(".py")
            if module.is_file():
                digest.update(digest_of(module))
    return digest.digest()


def kept(function: Any) -> FunctionCache | NullCache:
    """Where the compiled forms of a function are kept; nowhere, where no folder can be written."""
    found = _place(function)
    if isinstance(found, NullCache):
        say_that_it_is_slow(NOT_KEPT)
    return found


def check_that_it_is_kept() -> None:
    """Raise a RuntimeError where no folder can be written."""
    if isinstance(_place(check_that_it_is_kept), NullCache):
        raise RuntimeError(NOT_KEPT)


def _place(function: Any) -> FunctionCache | NullCache:
    try:
        return _Cache(function)
    except (RuntimeError, OSError):  # numba's "no locator available"
        return NullCache()


class _Cache(FunctionCache):
    """numba's, with other files."""

    def __init__(self, function: Any) -> None:
        super().__init__(function)  # type: ignore[no-untyped-call]
        stamp = digest_of(Path(function.__code__.co_filename))
        self._cache_file = _Files(self._cache_path, self._impl.filename_base, stamp)  # type: ignore[no-untyped-call]

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep one compiled form, if there is room."""
        try:
            super().save_overload(sig, data)  # type: ignore[no-untyped-call]
        except OSError:
            say_that_it_is_slow(NOT_KEPT)


class _Files(IndexDataCacheFile):
    """A file for each compiled form, without an index."""

    def save(self, key: Any, data: Any) -> None:
        """Write the file of this key, whole."""
        content = self._dump((self._source_stamp, key, data))  # type: ignore[no-untyped-call]
        with self._open_for_write(self._path(key)) as file:
            file.write(DIGEST(content).digest() + content)

    def load(self, key: Any) -> Any:
        """What the file of this key holds; None if there is none, or it is not right."""
        data = self._read(key)
        if data is None:
            for call in tuple(WHEN_COMPILING):
                call(True)
        return data

    def _read(self, key: Any) -> Any:
        try:
            whole = Path(self._path(key)).read_bytes()
            size = DIGEST().digest_size
            if DIGEST(whole[size:]).digest() != whole[:size]:
                return None
            stamp, of, data = pickle.loads(whole[size:])
        except Exception:  # of the disk; or names that an older version wrote and this one has not
            return None
        return data if (stamp, of) == (self._source_stamp, key) else None

    def _path(self, key: Any) -> str:
        name = DIGEST(repr((self._version, key)).encode()).hexdigest()[:16]
        return f"{self._index_path.removesuffix('.nbi')}.{name}.nbc"
