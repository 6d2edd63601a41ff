"""A read-only Zarr store of the files of an atlas, checked whenever they are read. Needs zarr."""

from __future__ import annotations

import asyncio
import atexit
from typing import Self

from zarr.abc.store import ByteRequest
from zarr.core.buffer import Buffer, BufferPrototype
from zarr.core.sync import sync
from zarr.storage import LocalStore, WrapperStore

from stochlin.analyses.atlases.checksums import Checks


class CheckedFiles(WrapperStore[LocalStore]):
    """Read-only store of the files in the folder of an atlas; a damaged file raises `DamagedError`."""

    def __init__(self, store: LocalStore, checks: Checks) -> None:
        super().__init__(store)
        self.checks = checks

    @classmethod
    def of(cls, checks: Checks) -> Self:
        """The store of the atlas with these checks."""
        return cls(LocalStore(checks.root, read_only=True), checks)

    def _with_store(self, store: LocalStore) -> Self:
        return type(self)(store, self.checks)

    async def get(
        self, key: str, prototype: BufferPrototype, byte_range: ByteRequest | None = None
    ) -> Buffer | None:
        """Content of a file, or a range of it, after a check of the whole file."""
        try:
            whole = await self._store.get(key, prototype)
        except OSError:
            self.checks.content(key)  # raises an error that names the file
            raise
        data = None if whole is None else whole.as_buffer_like()
        self.checks.check(key, data, self.checks.expected.get(key))
        return whole if byte_range is None else await self._store.get(key, prototype, byte_range)


async def _drop_other_reads() -> None:
    others = asyncio.all_tasks() - {asyncio.current_task()}
    for task in others:
        task.cancel()
    if others:
        await asyncio.wait(others, timeout=1.0)


# Zarr reads several chunks at a time. After an error in one of them the other reads are still pending;
# unless they are cancelled, asyncio prints a warning for each at the end of the process.
atexit.register(lambda: sync(_drop_other_reads()))
