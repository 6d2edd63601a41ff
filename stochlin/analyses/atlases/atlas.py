"""Atlases: tables larger than memory, written block by block, carried on where they stopped."""

from __future__ import annotations

import importlib
import os
import time
import warnings
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import CancelledError, ThreadPoolExecutor, as_completed
from contextlib import contextmanager, nullcontext
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from stochlin.analyses.atlases import store as atlas_store
from stochlin.analyses.atlases.checksums import CHECKSUM, CHECKSUMS, Checks, Number
from stochlin.analyses.atlases.specification import AtlasSpecification, read_specification, specification
from stochlin.kernels.basics.parallel import Progress, cores

PATIENCE = 20.0  # seconds without any worker
POLL = 1.0  # seconds between looks at the cluster
UNCHECKED = (
    "{} was written before atlases had checksums: it is read as it is, and numbers that were lost or "
    "damaged since may read as good ones; write it anew where that matters"
)


def write_atlas(
    spec: str | os.PathLike[str] | Mapping[str, Any],
    path: str | os.PathLike[str],
    *,
    scheduler: Any = None,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Compute a design atlas into a Zarr store, or continue an interrupted one.

    A table of linearized `correlate` over any parameters, in blocks. A block that is written stays
    written: a process that was killed loses its current blocks, and the same call carries on. What is
    there is read and compared with its checksums; what is damaged is computed again. The result is the
    same, to the last bit, as that of a run without interruption.

    Parameters
    ----------
    spec : path or mapping
        A TOML file, or its contents; ``stochlin atlas --help`` shows one. ``period_1`` and
        ``period_2`` are over the ground's period; numbers are held, lists and sweeps are axes.
    path : path
        Where the store is or will be.
    scheduler : str or distributed.Client, optional
        Address of a dask scheduler, or a client of one, whose workers then compute and write; they must
        see the same file system. The cores of this machine, if not given.
    progress : callable, optional
        Called with the share of blocks that are written and good.

    Returns
    -------
    xarray.Dataset
        As `open_atlas`, over the dimensions of the specification.

    Raises
    ------
    ValueError
        If the specification is wrong, might not fit on the disk or in memory, or differs from that of
        the store, as may its version.
    OSError
        If the specification cannot be read or there is no folder for the store.
    RuntimeError
        If the disk is full or workers are lost: what is written is kept. If another process is writing
        the same atlas.
    ImportError
        Without the extra ``scale``.

    Examples
    --------
    >>> import tempfile, stochlin as sl
    >>> parameters = {"period_1": [0.5, 1.0], "period_2": [0.7], "damping": 0.05}
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     spec = {"ground": "white_noise", "parameters": parameters}
    ...     atlas = sl.write_atlas(spec, f"{folder}/atlas.zarr")
    ...     print(dict(atlas.rho.sizes))
    {'period_1': 2, 'period_2': 1}
    """
    chosen = specification(spec) if isinstance(spec, Mapping) else read_specification(spec)
    target = Path(path).absolute()
    atlas_store.zarr_module()
    if scheduler is None:
        atlas_store.check_memory(chosen)
    told = "none of it is written"
    if not target.exists():
        atlas_store.check_room(chosen, target)
    try:
        if not target.exists():
            atlas_store.create(target, chosen)
        with atlas_store.held(target):
            checks = atlas_store.mend(target, chosen)
            for written, total in _blocks(checks, chosen, scheduler):
                told = f"{written} of {total} blocks are written and stay"
                if progress is not None:
                    progress(written / total)
    except (OSError, MemoryError, _ClusterLostError) as error:
        raise RuntimeError(
            f"{target} is not finished: {_reason(error)}; {told}; the same call goes on from there"
        ) from error
    return open_atlas(target)


def _blocks(checks: Checks, chosen: AtlasSpecification, scheduler: Any) -> Iterator[tuple[int, int]]:
    """Look all blocks over and write those that are not good; how many are, and the number of all."""
    path, numbers = checks.root, list(np.ndindex(checks.counts))
    good, todo = 0, []
    yield good, len(numbers)
    with _threads() as pool:
        for number, is_good in zip(numbers, pool.map(checks.is_good, numbers), strict=True):
            if is_good:
                good += 1
                yield good, len(numbers)
            else:
                todo.append(number)
    if scheduler is None:
        run = _on_this_machine(path, chosen, todo)
    else:
        run = _on_cluster(scheduler, path, chosen, todo)
    for _ in run:
        good += 1
        yield good, len(numbers)


def open_atlas(path: str | os.PathLike[str]) -> xr.Dataset:
    """Open a finished atlas; numbers are read when they are used.

    Parameters
    ----------
    path : path
        What `write_atlas` made.

    Returns
    -------
    xarray.Dataset
        ``rho``, ``bias`` [-], ``status`` and ``caution`` over the dimensions of both structures;
        ``ductility_std_1`` and ``_2``, ``bias_1`` and ``_2`` [-] over those of each. Periods are over
        the ground's.

    Raises
    ------
    ValueError
        If there is no atlas, an unfinished one, or one of whose files some are missing, too short or too
        long. Bytes are compared with their checksums when they are read, by `lookup` or any other.
    ImportError
        Without the extra ``scale``.

    Warns
    -----
    UserWarning
        If the atlas was written before there were checksums: it is read as it is.

    Examples
    --------
    >>> import stochlin as sl
    >>> sl.open_atlas("nowhere.zarr")
    Traceback (most recent call last):
    ...
    ValueError: nowhere.zarr is no atlas: no Zarr group is there
    """
    atlas_store.zarr_module()
    root = Path(path)
    checks = atlas_store.checks_of(root)
    done = atlas_store.done(root, checks)
    if not done.all():
        raise ValueError(
            f"{path} is not finished, {done.size - done.sum()} of {done.size} blocks are missing; "
            "write_atlas goes on"
        )
    if checks is None:
        warnings.warn(UNCHECKED.format(path), stacklevel=2)
        files: Any = str(path)
    else:
        checks.check_presence()
        files = importlib.import_module("stochlin.analyses.atlases.reading").CheckedFiles.of(checks)
    atlas = xr.open_zarr(files, consolidated=False, chunks=None)
    atlas.attrs = {k: v for k, v in atlas.attrs.items() if k not in (CHECKSUM, CHECKSUMS)}
    return atlas[[*atlas_store.TABLES, *atlas_store.SIDES]]


class _ClusterLostError(Exception):
    """The dask cluster is gone, or its workers are."""


def _reason(error: BaseException) -> str:
    if isinstance(error, OSError) and error.errno is not None:
        file = error.filename2 or error.filename
        return os.strerror(error.errno) + (f" ({file})" if file else "")
    told = str(error) or type(error).__name__
    return f"not enough memory ({told})" if isinstance(error, MemoryError) else told


@contextmanager
def _threads() -> Iterator[ThreadPoolExecutor]:
    """One a core; what they have not begun when the block ends is left."""
    pool = ThreadPoolExecutor(cores())
    try:
        yield pool
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def _on_this_machine(path: Path, chosen: AtlasSpecification, todo: Sequence[Number]) -> Iterator[None]:
    """Write blocks in threads: one computes while another writes."""
    with _threads() as pool:
        futures = [pool.submit(atlas_store.write_block, str(path), chosen, n) for n in todo]
        for future in as_completed(futures):
            future.result()
            yield


def _on_worker(path: str, chosen: AtlasSpecification, number: Number, code: str) -> None:
    if atlas_store.code_version() != code:
        raise OSError(
            f"a worker runs stochlin {atlas_store.code_version()}, this is {code}; install the same"
        )
    atlas_store.write_block(path, chosen, number)


def _on_cluster(
    scheduler: Any, path: Path, chosen: AtlasSpecification, todo: Sequence[Number]
) -> Iterator[None]:
    """Let the workers of a dask cluster write the blocks."""
    try:
        distributed: Any = importlib.import_module("distributed")
    except ImportError as error:
        raise ImportError("a cluster needs dask.distributed: pip install 'stochlin[scale]'") from error
    lost = (distributed.KilledWorker, distributed.comm.CommClosedError, CancelledError, OSError)
    opened: Any
    if isinstance(scheduler, distributed.Client):
        opened, address = nullcontext(scheduler), scheduler.scheduler.address
    else:
        try:
            opened = distributed.Client(scheduler, timeout=PATIENCE, set_as_default=False)
        except (OSError, ValueError) as error:
            raise _ClusterLostError(f"no scheduler answers at {scheduler}") from error
        address = scheduler
    code = atlas_store.code_version()
    with opened as client:
        pending = {
            client.submit(_on_worker, str(path), chosen, number, code, pure=False) for number in todo
        }
        seen = time.monotonic()
        while pending:
            done, pending = _finished(client, pending)
            for future in done:
                try:
                    future.result()
                except lost as error:
                    client.cancel(list(pending))
                    raise _ClusterLostError(f"a worker failed, {_reason(error)}") from error
                yield
            if done or _workers(client, address):
                seen = time.monotonic()
            elif time.monotonic() - seen > PATIENCE:
                client.cancel(list(pending))
                raise _ClusterLostError(f"the cluster at {address} has had no worker for {PATIENCE:g} s")


def _finished(client: Any, pending: set[Any]) -> tuple[set[Any], set[Any]]:
    distributed: Any = importlib.import_module("distributed")
    try:
        with client.as_current():
            finished = distributed.wait(pending, timeout=POLL, return_when="FIRST_COMPLETED")
    except TimeoutError:
        return set(), pending
    return set(finished.done), set(finished.not_done)


def _workers(client: Any, address: str) -> int:
    try:
        return len(client.nthreads())
    except Exception as error:
        raise _ClusterLostError(f"the scheduler at {address} does not answer") from error
