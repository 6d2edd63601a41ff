"""What every file of an atlas has to be: its bytes and its checksum, told by another file.

Files that are there from the beginning, metadata and axes, stand in the attribute `CHECKSUMS` of the
group, whose own metadata carry a `CHECKSUM` of themselves. Chunks of a block stand in the array
``block_checks``: one chunk for each block, a row for each variable and the last for itself. It is
written after the chunks of the block: where it is, the block is done.

A checksum begins with that of the specification and the code and goes on with the name of the file: what
belongs to another place, array or atlas is as wrong as what is broken.
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
FILES = "files"  # attribute of the checks: the variables in the order of their rows
NONE = -1  # in place of bytes and checksum: no such chunk
CURE = "write_atlas with the specification that made it computes what is damaged again, and just that"
Number = tuple[int, ...]
Facts = tuple[int, int]
"""Bytes of a file, and their checksum."""


def seed_of(specification: str, code: str) -> int:
    """Where the checksums of an atlas begin."""
    return zlib.crc32(f"{specification}\n{code}".encode())


def facts(seed: int, key: str, data: Any) -> Facts:
    """Bytes and checksum of what the file of this name holds."""
    return len(data), zlib.crc32(data, zlib.crc32(key.encode(), seed))


def checksum_of_metadata(metadata: Mapping[str, Any]) -> int:
    """Of the group's metadata, less this number itself."""
    attributes = {k: v for k, v in metadata["attributes"].items() if k != CHECKSUM}
    return zlib.crc32(json.dumps({**metadata, "attributes": attributes}, sort_keys=True).encode())


def chunk_key(name: str, number: Sequence[int]) -> str:
    """Name of the file of a chunk within the atlas."""
    return "/".join([name, "c", *map(str, number)])


def rows_key(number: Number) -> str:
    """Name of the file with the checks of a block."""
    return chunk_key(CHECKS, (*number, 0, 0))


def rows_of_block(seed: int, number: Number, found: Sequence[Facts] | Array) -> Array:
    """The checks of a block's chunks, and of these rows."""
    rows = np.array(found, "<i8")
    return np.vstack([rows, np.array([facts(seed, rows_key(number), rows.tobytes())], "<i8")])


class DamagedError(ValueError):
    """A file of an atlas is not what was written; says which, why, how many others, and the cure."""

    def __init__(self, root: Path, key: str, why: str, more: int = 0) -> None:
        super().__init__(root, key, why, more)  # as they are: the error may come from another process
        self.key = key
        array, _, chunk = key.partition("/")
        what = f"chunk {chunk} of {array}" if chunk.startswith("c") else key
        self.what = f"{root}: {what} is damaged: {why}{f', and so are {more} more' if more else ''}"

    def __str__(self) -> str:
        return f"{self.what}; {CURE}"


@dataclass(frozen=True)
class Checks:
    """The checks of one atlas. ``variables`` has the axes that each variable goes along."""

    root: Path
    seed: int
    fixed: Mapping[str, Facts]
    axes: Sequence[str]
    variables: Mapping[str, Sequence[str]]
    counts: Number

    @classmethod
    def of(cls, root: Path, attributes: Mapping[str, Any]) -> Self:
        """Those of the atlas with these attributes; a `DamagedError` if metadata or axes are damaged."""
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
        """Of every block, as they were when they were first asked for; `NONE` where there are none."""
        rows = np.full((*self.counts, len(self.variables) + 1, 2), NONE, np.int64)
        for number in np.ndindex(self.counts):
            rows[number] = self.rows_of(number)
        return rows

    def rows_of(self, number: Number) -> Array:
        """Of a block, read from its file; raises a `DamagedError` if that is damaged."""
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
        """Whether each block is written."""
        return self.rows[..., -1, 0] != NONE

    def any_block(self) -> bool:
        """Whether the checks of some block are good: they are of no other specification or code."""
        for number in np.ndindex(self.counts):
            try:
                if self.rows_of(number)[-1, 0] != NONE:
                    return True
            except DamagedError:
                pass
        return False

    def of_block(self, number: Number, rows: Array) -> Iterator[tuple[str, Facts]]:
        """The chunks of a block that its rows tell of."""
        at = dict(zip(self.axes, number, strict=True))
        for (name, dims), (size, checksum) in zip(self.variables.items(), rows, strict=False):
            if size != NONE:
                yield chunk_key(name, [at[dim] for dim in dims]), (int(size), int(checksum))

    def expected(self, key: str) -> Facts | None:
        """What the file of this name has to be; None if it is not one of the atlas."""
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
        """Raise a `DamagedError` unless these are the bytes of the file; None: it is not there."""
        if expected is None:
            return
        if data is None:
            raise DamagedError(self.root, key, "it is missing")
        if len(data) != expected[0]:
            raise DamagedError(self.root, key, f"it has {len(data)} of {expected[0]} bytes")
        if facts(self.seed, key, data) != expected:
            raise DamagedError(self.root, key, "its checksum is wrong")

    def check_file(self, key: str, expected: Facts) -> None:
        """The same, of what lies on the disk."""
        self.check(key, self.content(key), expected)

    def content(self, key: str) -> bytes | None:
        """The bytes of a file, None if there is none; a `DamagedError` if the disk does not tell."""
        try:
            return (self.root / key).read_bytes()
        except (FileNotFoundError, IsADirectoryError, NotADirectoryError):
            return None
        except PermissionError:
            raise
        except OSError as error:
            raise DamagedError(self.root, key, f"it cannot be read, {error.strerror}") from error

    def check_presence(self) -> None:
        """Raise a `DamagedError` unless every chunk is there and as long as it was; reads none."""
        wrong = []
        for number in np.ndindex(self.counts):
            for key, (size, _) in self.of_block(number, self.rows[number]):
                found = _bytes_of(self.root / key)
                if found != size:
                    has = "it is missing" if found is None else f"it has {found} of {size} bytes"
                    wrong.append((key, has))
        if wrong:
            raise DamagedError(self.root, *wrong[0], len(wrong) - 1)

    def is_good(self, number: Number) -> bool:
        """Whether a block is written, and every byte of it as it was; reads it whole."""
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
