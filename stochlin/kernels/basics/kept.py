"""The disk cache of compiled functions, made safe against damaged files and full disks.

numba's own cache raises if no folder can be written, if a file is truncated or if the disk is full. It
numbers its files in an index: two processes that start together can give one number to code for
different argument types, and a file with a damaged byte is executed. Here each file is named after its
function and argument types, repeats both inside and begins with a digest of its content. A file that
does not match is compiled again, and replaced if possible.

numba recompiles a function only if its own source file has changed. Here it is also recompiled if a
module of `stochlin.kernels` that this file imports has changed, since functions of that module are
compiled into it.
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
def warn_once(why: str) -> None:
    """Warn that calls will be slow, and why; once in a process for each reason."""
    warnings.warn(why, stacklevel=2)


@cache
def digest_of(file: Path) -> bytes:
    """Digest of the source of a module and of all modules of `stochlin.kernels` that it imports."""
    source = file.read_bytes()
    digest = DIGEST(source)
    for package, lines, line in IMPORTS.findall(source.decode()):
        for name in ("", *re.findall(r"\w+", lines or line)):
            module = ROOT.joinpath(*package.split("."), name).with_suffix(".py")
            if module.is_file():
                digest.update(digest_of(module))
    return digest.digest()


def kept(function: Any) -> FunctionCache | NullCache:
    """The disk cache of a function; an empty one, with a warning, if no folder can be written."""
    found = _place(function)
    if isinstance(found, NullCache):
        warn_once(NOT_KEPT)
    return found


def check_that_it_is_kept() -> None:
    """Raise a RuntimeError if no folder can be written for the disk cache."""
    if isinstance(_place(check_that_it_is_kept), NullCache):
        raise RuntimeError(NOT_KEPT)


def _place(function: Any) -> FunctionCache | NullCache:
    """The disk cache of a function, or an empty one if no folder can be written."""
    try:
        return _Cache(function)
    except (RuntimeError, OSError):  # numba raises "no locator available"
        return NullCache()


class _Cache(FunctionCache):
    """Numba's cache of one function, with `_Files` in place of its index and data files."""

    def __init__(self, function: Any) -> None:
        super().__init__(function)  # type: ignore[no-untyped-call]
        stamp = digest_of(Path(function.__code__.co_filename))
        self._cache_file = _Files(self._cache_path, self._impl.filename_base, stamp)  # type: ignore[no-untyped-call]

    def save_overload(self, sig: Any, data: Any) -> None:
        """Write the code for one signature, or warn if the disk does not take it."""
        try:
            super().save_overload(sig, data)  # type: ignore[no-untyped-call]
        except OSError:
            warn_once(NOT_KEPT)


class _Files(IndexDataCacheFile):
    """One file for the code of each signature (the ``key``), without an index."""

    def save(self, key: Any, data: Any) -> None:
        """Write the file of this key, whole or not at all."""
        content = self._dump((self._source_stamp, key, data))  # type: ignore[no-untyped-call]
        with self._open_for_write(self._path(key)) as file:
            file.write(DIGEST(content).digest() + content)

    def load(self, key: Any) -> Any:
        """The code in the file of this key; None if the file is missing, damaged or out of date."""
        data = self._read(key)
        if data is None:
            for call in tuple(WHEN_COMPILING):
                call(True)
        return data

    def _read(self, key: Any) -> Any:
        """The code in the file of this key, after its digest, source and key are checked; else None."""
        try:
            whole = Path(self._path(key)).read_bytes()
            size = DIGEST().digest_size
            if DIGEST(whole[size:]).digest() != whole[:size]:
                return None
            stamp, of, data = pickle.loads(whole[size:])
        except Exception:  # reading failed, or an older version pickled names that no longer exist
            return None
        return data if (stamp, of) == (self._source_stamp, key) else None

    def _path(self, key: Any) -> str:
        """Path of the file of this key, named after a digest of the key and numba's version."""
        name = DIGEST(repr((self._version, key)).encode()).hexdigest()[:16]
        return f"{self._index_path.removesuffix('.nbi')}.{name}.nbc"
