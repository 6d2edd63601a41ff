"""Zarr's way to the files of an atlas, each of which is checked whenever it is read. Needs zarr."""

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
    """The files below the atlas's folder, to be read only; a damaged one raises a `DamagedError`."""

    def __init__(self, store: LocalStore, checks: Checks) -> None:
        super().__init__(store)
        self.checks = checks

    @classmethod
    def of(cls, checks: Checks) -> Self:
        """Those that are told by these checks."""
        return cls(LocalStore(checks.root, read_only=True), checks)

    def _with_store(self, store: LocalStore) -> Self:
        return type(self)(store, self.checks)

    async def get(
        self, key: str, prototype: BufferPrototype, byte_range: ByteRequest | None = None
    ) -> Buffer | None:
        """The content of a file."""
        try:
            whole = await self._store.get(key, prototype)
        except OSError:
            self.checks.content(key)  # says which file it is
            raise
        data = None if whole is None else whole.as_buffer_like()
        self.checks.check(key, data, self.checks.expected(key))
        return whole if byte_range is None else await self._store.get(key, prototype, byte_range)


async def _drop_other_reads() -> None:
    others = asyncio.all_tasks() - {asyncio.current_task()}
    for one in others:
        one.cancel()
    if others:
        await asyncio.wait(others, timeout=1.0)


# Zarr reads chunks side by side. Where one is damaged the others are left, and a process that ends then
# would complain of each of them.
atexit.register(lambda: sync(_drop_other_reads()))
