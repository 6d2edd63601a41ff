"""Checks of the files of an atlas: the size and the checksum of each file, stored in another file.

Those of the metadata and axes, which exist from the beginning, are in the attribute `CHECKSUMS` of the
group. The metadata of the group have their own `CHECKSUM`. Those of the chunks of a block are in the
array ``block_checks``, which has one chunk for each block, with a row for each variable and a last row
for this chunk itself. It is written after the other chunks of the block, so that its presence means that
the block is complete.

A checksum includes the specification, the code version and the name of the file. A file that belongs to
another place, array or atlas therefore has a wrong checksum.
"""

from __future__ import annotations

import json
import math
import stat
import zlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any, Self

import numpy as np

from stochlin.kernels.basics.arrays import Array

CHECKS = "block_checks"
CHECKSUM, CHECKSUMS = "checksum", "checksums"
METADATA = "zarr.json"
FILES = "files"  # attribute of the checks with the names of the variables in the order of their rows
NONE = -1  # size and checksum where there is no chunk
CURE = "write_atlas with the specification that made it computes what is damaged again, and just that"
Number = tuple[int, ...]
Facts = tuple[int, int]
"""Size of a file [bytes], and its checksum."""


def seed_of(specification: str, code: str) -> int:
    """Initial value of the checksums of an atlas, from its specification and code version."""
    return zlib.crc32(f"{specification}\n{code}".encode())


def facts(seed: int, key: str, data: Any) -> Facts:
    """Size and checksum of the content ``data`` of the file named ``key``."""
    return len(data), zlib.crc32(data, zlib.crc32(key.encode(), seed))


def checksum_of_metadata(metadata: Mapping[str, Any]) -> int:
    """Checksum of the metadata of the group, without the checksum itself."""
    attributes = {k: v for k, v in metadata["attributes"].items() if k != CHECKSUM}
    return zlib.crc32(json.dumps({**metadata, "attributes": attributes}, sort_keys=True).encode())


def chunk_key(name: str, number: Sequence[int]) -> str:
    """Name of the file of a chunk within the atlas."""
    return "/".join([name, "c", *map(str, number)])


def rows_key(number: Number) -> str:
    """Name of the file with the checks of a block."""
    return chunk_key(CHECKS, (*number, 0, 0))


def rows_of_block(seed: int, number: Number, entries: Sequence[Facts] | Array) -> Array:
    """The checks of the chunks of a block, with a last row for the checks themselves."""
    rows = np.array(entries, "<i8")
    return np.vstack([rows, np.array([facts(seed, rows_key(number), rows.tobytes())], "<i8")])


class DamagedError(ValueError):
    """A file of an atlas is damaged; ``more`` is the number of other damaged files."""

    def __init__(self, root: Path, key: str, why: str, more: int = 0) -> None:
        super().__init__(root, key, why, more)  # all arguments, so that the error can be pickled
        self.key = key
        array, _, chunk = key.partition("/")
        what = f"chunk {chunk} of {array}" if chunk.startswith("c") else key
        self.what = f"{root}: {what} is damaged: {why}{f', and so are {more} more' if more else ''}"

    def __str__(self) -> str:
        return f"{self.what}; {CURE}"


@dataclass(frozen=True)
class Checks:
    """The checks of one atlas; ``variables`` has the dimensions of each variable."""

    root: Path
    seed: int
    fixed: Mapping[str, Facts]
    axes: Sequence[str]
    variables: Mapping[str, Sequence[str]]
    counts: Number

    @classmethod
    def of(cls, root: Path, attributes: Mapping[str, Any]) -> Self:
        """The checks of the atlas with these attributes; `DamagedError` for metadata or axes."""
        seed = seed_of(attributes["specification"], attributes["code"])
        fixed = {
            key: (size, checksum) for key, (size, checksum) in json.loads(attributes[CHECKSUMS]).items()
        }
        bare = cls(root, seed, fixed, (), {}, ())
        for key, expected in fixed.items():
            bare.check_file(key, expected)
        checks = _metadata(root, CHECKS)
        files = checks["attributes"][FILES]
        names = {name: _metadata(root, name).get("dimension_names", []) for name in files}
        return replace(bare, axes=names["rho"], variables=names, counts=tuple(checks["shape"][:-2]))

    @cached_property
    def rows(self) -> Array:
        """The checks of all blocks, read once; `NONE` where a block is not written."""
        rows = np.full((*self.counts, len(self.variables) + 1, 2), NONE, np.int64)
        for number in np.ndindex(self.counts):
            rows[number] = self.rows_of(number)
        return rows

    def rows_of(self, number: Number) -> Array:
        """The checks of a block, read from its file; raises a `DamagedError` if this is damaged."""
        key, shape = rows_key(number), (len(self.variables) + 1, 2)
        data = self.content(key)
        if data is None:
            return np.full(shape, NONE)
        if len(data) != 8 * math.prod(shape):
            raise DamagedError(self.root, key, f"it has {len(data)} bytes")
        rows = np.frombuffer(data, "<i8").reshape(shape)
        if not np.array_equal(rows, rows_of_block(self.seed, number, rows[:-1])):
            raise DamagedError(self.root, key, "its checksum is wrong")
        return rows

    @property
    def done(self) -> Array:
        """Array that tells whether each block is written."""
        return self.rows[..., -1, 0] != NONE

    def any_block(self) -> bool:
        """Whether the checks of any block are intact, and so of this specification and code version."""
        for number in np.ndindex(self.counts):
            try:
                if self.rows_of(number)[-1, 0] != NONE:
                    return True
            except DamagedError:
                pass
        return False

    def of_block(self, number: Number, rows: Array) -> Iterator[tuple[str, Facts]]:
        """Name, size and checksum of each chunk of a block, from its checks."""
        at = dict(zip(self.axes, number, strict=True))
        for (name, dims), (size, checksum) in zip(self.variables.items(), rows, strict=False):
            if size != NONE:
                yield chunk_key(name, [at[dim] for dim in dims]), (int(size), int(checksum))

    def expected(self, key: str) -> Facts | None:
        """Size and checksum that a file should have; None if it is not a file of the atlas."""
        if key in self.fixed:
            return self.fixed[key]
        name, _, rest = key.partition("/")
        kind, *chunk = rest.split("/")
        if name not in self.variables or kind != "c":
            return None
        at = dict(zip(self.variables[name], map(int, chunk), strict=True))
        number = tuple(at.get(axis, 0) for axis in self.axes)
        size, checksum = self.rows[number][list(self.variables).index(name)]
        return int(size), int(checksum)

    def check(self, key: str, data: Any, expected: Facts | None) -> None:
        """Raise a `DamagedError` unless ``data`` is the content of the file; None is a missing file."""
        if expected is None:
            return
        if data is None:
            raise DamagedError(self.root, key, "it is missing")
        if len(data) != expected[0]:
            raise DamagedError(self.root, key, f"it has {len(data)} of {expected[0]} bytes")
        if facts(self.seed, key, data) != expected:
            raise DamagedError(self.root, key, "its checksum is wrong")

    def check_file(self, key: str, expected: Facts) -> None:
        """Raise a `DamagedError` unless the file on disk has this size and checksum."""
        self.check(key, self.content(key), expected)

    def content(self, key: str) -> bytes | None:
        """Content of a file, None if it is missing; a `DamagedError` if it cannot be read."""
        try:
            return (self.root / key).read_bytes()
        except (FileNotFoundError, IsADirectoryError, NotADirectoryError):
            return None
        except PermissionError:
            raise
        except OSError as error:
            raise DamagedError(self.root, key, f"it cannot be read, {error.strerror}") from error

    def check_presence(self) -> None:
        """Raise a `DamagedError` unless every chunk exists with its size; chunks are not read."""
        wrong = []
        for number in np.ndindex(self.counts):
            for key, (size, _) in self.of_block(number, self.rows[number]):
                actual = _bytes_of(self.root / key)
                if actual != size:
                    has = "it is missing" if actual is None else f"it has {actual} of {size} bytes"
                    wrong.append((key, has))
        if wrong:
            raise DamagedError(self.root, *wrong[0], len(wrong) - 1)

    def is_good(self, number: Number) -> bool:
        """Whether a block is written and its checksums are right; reads the whole block."""
        try:
            rows = self.rows_of(number)
            for key, expected in self.of_block(number, rows):
                self.check_file(key, expected)
        except DamagedError:
            return False
        return bool(rows[-1, 0] != NONE)


def _bytes_of(file: Path) -> int | None:
    try:
        about = file.stat()
    except (FileNotFoundError, NotADirectoryError):
        return None
    return about.st_size if stat.S_ISREG(about.st_mode) else None


def _metadata(root: Path, name: str) -> Any:
    return json.loads((root / name / METADATA).read_bytes())
