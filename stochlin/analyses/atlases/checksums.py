"""Checks of the files of an atlas: the size and the checksum of each file, in files of their own.

The codecs of Zarr find a damaged chunk, but not one that is missing or in the place of another. The
group `CHECKS` of an atlas therefore has the file `FIXED`, with the checks of the metadata and axes,
which exist from the beginning, and a file for each block with the checks of its chunks. It is written
after these chunks, so that its presence means that the block is complete.

Each of these files begins with its own checksum, which includes its name, and that of a block also the
specification and the code version. A file that belongs to another place or atlas therefore has a wrong
checksum.
"""

from __future__ import annotations

import json
import stat
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, Self

import numpy as np

CHECKS, FIXED = "checks", "checks/fixed"
BLOCKS = "blocks"  # attribute of an atlas with the number of blocks along each axis
METADATA = "zarr.json"
SEAL = 9  # bytes of the first line of a file with checks, which is its checksum
CURE = "write_atlas with the specification that made it computes what is damaged again, and just that"
Number = tuple[int, ...]
Facts = tuple[int, int]
"""Size of a file [bytes], and its checksum."""


def seed_of(specification: str, code: str) -> int:
    """Initial value of the checksums of an atlas, from its specification and code version."""
    return zlib.crc32(f"{specification}\n{code}".encode())


def facts(data: Any) -> Facts:
    """Size and checksum of the content of a file."""
    return len(data), zlib.crc32(data)


def sealed(key: str, seed: int, checks: Mapping[str, Facts]) -> bytes:
    """Content of the file named ``key``, with the checks of other files by their names."""
    body = json.dumps(checks).encode()
    return _seal(key, seed, body) + body


def _seal(key: str, seed: int, body: bytes) -> bytes:
    return b"%08x\n" % zlib.crc32(body, zlib.crc32(key.encode(), seed))


def chunk_key(name: str, number: Sequence[int]) -> str:
    """Name of the file of a chunk within the atlas."""
    return "/".join([name, "c", *map(str, number)])


def block_key(number: Number) -> str:
    """Name of the file with the checks of a block."""
    return f"{CHECKS}/{'.'.join(map(str, number))}"


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
    """The checks of one atlas, with the number of blocks along each axis."""

    root: Path
    seed: int = 0
    fixed: Mapping[str, Facts] = field(default_factory=dict)
    counts: Number = ()

    @classmethod
    def of(cls, root: Path, attributes: Mapping[str, Any]) -> Self:
        """The checks of the atlas with these attributes; `DamagedError` for metadata or axes."""
        seed = seed_of(attributes["specification"], attributes["code"])
        checks = cls(root, seed, cls(root).sealed_file(FIXED) or {}, tuple(attributes[BLOCKS]))
        for key, expected in checks.fixed.items():
            checks.check(key, checks.content(key), expected)
        return checks

    def sealed_file(self, key: str) -> dict[str, Facts] | None:
        """The checks in a file, None if it is missing; a `DamagedError` if it is damaged."""
        data = self.content(key)
        if data is None:
            return None
        if data[:SEAL] != _seal(key, self.seed, data[SEAL:]):
            raise DamagedError(self.root, key, "its checksum is wrong")
        return {name: (size, checksum) for name, (size, checksum) in json.loads(data[SEAL:]).items()}

    def of_block(self, number: Number) -> dict[str, Facts] | None:
        """Size and checksum of the chunks of a block, None if it is not written."""
        return self.sealed_file(block_key(number))

    @cached_property
    def blocks(self) -> list[dict[str, Facts] | None]:
        """The checks of all blocks, read once."""
        return [self.of_block(number) for number in np.ndindex(self.counts)]

    @cached_property
    def expected(self) -> dict[str, Facts]:
        """Size and checksum of all files of the atlas that have been written."""
        files = dict(self.fixed)
        for block in self.blocks:
            files |= block or {}
        return files

    def any_block(self) -> bool:
        """Whether the checks of any block are intact, and so of this specification and code version."""
        for number in np.ndindex(self.counts):
            try:
                if self.of_block(number) is not None:
                    return True
            except DamagedError:
                pass
        return False

    def check(self, key: str, data: Any, expected: Facts | None) -> None:
        """Raise a `DamagedError` unless ``data`` is the content of the file; None is a missing file."""
        if expected is None:
            return
        if data is None:
            raise DamagedError(self.root, key, "it is missing")
        if len(data) != expected[0]:
            raise DamagedError(self.root, key, f"it has {len(data)} of {expected[0]} bytes")
        if facts(data) != expected:
            raise DamagedError(self.root, key, "its checksum is wrong")

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
        """Raise a `DamagedError` unless every file exists with its size; chunks are not read."""
        wrong = []
        for key, (size, _) in self.expected.items():
            actual = _bytes_of(self.root / key)
            if actual != size:
                has = "it is missing" if actual is None else f"it has {actual} of {size} bytes"
                wrong.append((key, has))
        if wrong:
            raise DamagedError(self.root, *wrong[0], len(wrong) - 1)

    def is_good(self, number: Number) -> bool:
        """Whether a block is written and its checksums are right; reads the whole block."""
        try:
            chunks = self.of_block(number)
            for key, expected in (chunks or {}).items():
                self.check(key, self.content(key), expected)
        except DamagedError:
            return False
        return chunks is not None


def _bytes_of(file: Path) -> int | None:
    try:
        about = file.stat()
    except (FileNotFoundError, NotADirectoryError):
        return None
    return about.st_size if stat.S_ISREG(about.st_mode) else None
