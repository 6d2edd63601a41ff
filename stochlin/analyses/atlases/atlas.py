"""Writing an atlas block by block, also after an interruption, and opening a finished atlas."""

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
from stochlin.analyses.atlases.checksums import BLOCKS, Checks, Number
from stochlin.analyses.atlases.specification import AtlasSpecification, read_specification, specification
from stochlin.kernels.basics.parallel import Progress, cores

PATIENCE = 20.0  # longest time without any worker [s]
POLL = 1.0  # time between two queries of the cluster [s]
UNCHECKED = (
    "{} was written by an earlier version, whose checksums are not read: numbers that were lost or "
    "damaged since may read as good ones; write it anew where that matters"
)


def write_atlas(
    spec: str | os.PathLike[str] | Mapping[str, Any],
    path: str | os.PathLike[str],
    *,
    scheduler: Any = None,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Compute a design atlas into a Zarr store, or continue an interrupted computation.

    An atlas is a table of `correlate` by linearization over any of its parameters. It is computed in
    blocks. If the process is interrupted, only the blocks in progress are lost, and the same call
    continues with the others. Existing blocks are compared with their checksums, and damaged ones are
    computed again. The result is bit for bit that of a run without interruption.

    Parameters
    ----------
    spec : path or mapping
        Specification, as a TOML file or a mapping with its content; ``stochlin atlas --help`` shows an
        example. ``period_1`` and ``period_2`` are relative to the ground period. Parameters with one
        number are fixed; lists and sweeps are the axes.
    path : path
        Path of the store, which may exist.
    scheduler : str or distributed.Client, optional
        Address of a dask scheduler, or a client of one. Its workers compute and write the blocks and
        must have access to the same file system. By default the cores of this machine are used.
    progress : callable, optional
        Called with the share of the blocks that are written and intact.

    Returns
    -------
    xarray.Dataset
        The atlas, as from `open_atlas`, over the dimensions of the specification.

    Raises
    ------
    ValueError
        If the specification is not valid or needs more disk space or memory than there is, or if an
        existing store has another specification or was written by another version.
    OSError
        If the specification cannot be read, or the folder of the store does not exist.
    RuntimeError
        If the disk is full or workers are lost; written blocks are kept. Also if another process is
        writing the same atlas.
    ImportError
        If the extra ``scale`` is not installed.

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
    state = "none of it is written"
    if not target.exists():
        atlas_store.check_room(chosen, target)
    try:
        if not target.exists():
            atlas_store.create(target, chosen)
        with atlas_store.held(target):
            checks = atlas_store.mend(target, chosen)
            for written, total in _blocks(checks, chosen, scheduler):
                state = f"{written} of {total} blocks are written and stay"
                if progress is not None:
                    progress(written / total)
    except (OSError, MemoryError, _ClusterLostError) as error:
        raise RuntimeError(
            f"{target} is not finished: {_reason(error)}; {state}; the same call goes on from there"
        ) from error
    return open_atlas(target)


def _blocks(checks: Checks, chosen: AtlasSpecification, scheduler: Any) -> Iterator[tuple[int, int]]:
    """Check all blocks and write those that are missing or damaged.

    Yields the number of intact blocks so far and the number of all blocks.
    """
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
    """Open a finished atlas; its numbers are read when they are used.

    Parameters
    ----------
    path : path
        Path of an atlas written by `write_atlas`.

    Returns
    -------
    xarray.Dataset
        Over the dimensions of both structures: ``rho``, ``bias`` [-], ``status`` and ``caution``. Over
        the dimensions of each structure: ``ductility_std_1`` and ``_2``, ``bias_1`` and ``_2`` [-]. The
        coordinates ``period_1`` and ``period_2`` are relative to the ground period.

    Raises
    ------
    ValueError
        If there is no atlas, the atlas is unfinished, or files of it are missing or have a wrong length.
        Later reading of numbers, by `lookup` or otherwise, raises it if a checksum is wrong.
    ImportError
        If the extra ``scale`` is not installed.

    Warns
    -----
    UserWarning
        If the atlas was written by an earlier version; it is then read unchecked.

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
    atlas.attrs = {k: v for k, v in atlas.attrs.items() if k != BLOCKS}
    return atlas[[*atlas_store.TABLES, *atlas_store.SIDES]]


class _ClusterLostError(Exception):
    """The connection to the dask cluster or to all its workers is lost."""


def _reason(error: BaseException) -> str:
    if isinstance(error, OSError) and error.errno is not None:
        file = error.filename2 or error.filename
        return os.strerror(error.errno) + (f" ({file})" if file else "")
    message = str(error) or type(error).__name__
    return f"not enough memory ({message})" if isinstance(error, MemoryError) else message


@contextmanager
def _threads() -> Iterator[ThreadPoolExecutor]:
    """A pool with a thread for each core; at its end, tasks that have not started are cancelled."""
    pool = ThreadPoolExecutor(cores())
    try:
        yield pool
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def _on_this_machine(path: Path, chosen: AtlasSpecification, todo: Sequence[Number]) -> Iterator[None]:
    """Compute and write blocks in threads, so that computing and writing overlap."""
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
    """Compute and write blocks on the workers of a dask cluster."""
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
