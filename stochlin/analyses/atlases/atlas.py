"""Atlases: tables larger than memory, written block by block, carried on where they stopped."""

from __future__ import annotations

import importlib
import os
import time
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import CancelledError, ThreadPoolExecutor, as_completed
from pathlib import Path
from typing import Any

import xarray as xr

from stochlin.analyses.atlases import store as atlas_store
from stochlin.analyses.atlases.specification import AtlasSpecification, read_specification, specification
from stochlin.kernels.basics.parallel import Progress

Number = tuple[int, ...]

PATIENCE = 20.0  # seconds without any worker
POLL = 1.0  # seconds between looks at the cluster


def write_atlas(
    spec: str | os.PathLike[str] | Mapping[str, Any],
    path: str | os.PathLike[str],
    *,
    scheduler: str | None = None,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Compute a design atlas into a Zarr store, or go on with one that was stopped.

    A table of linearized `correlate` over any parameters, in blocks. A block that is written stays
    written: a process that was killed loses its current blocks, and the same call carries on. The
    result is the same, to the last bit, as that of a run without interruption.

    Parameters
    ----------
    spec : path or mapping
        A TOML file, or its contents; ``stochlin atlas --help`` shows one. ``period_1`` and
        ``period_2`` are over the ground's period; numbers are held, lists and sweeps are axes.
    path : path
        Where the store is or will be.
    scheduler : str, optional
        Address of a dask scheduler, whose workers then compute and write; they must see the same file
        system. The cores of this machine, if not given.
    progress : callable, optional
        Called with the share of blocks that are written.

    Returns
    -------
    xarray.Dataset
        As `open_atlas`, over the dimensions of the specification.

    Raises
    ------
    ValueError
        If the specification is wrong, might not fit on the disk, or differs from that of the store, as
        may its version.
    OSError
        If the specification cannot be read or there is no folder for the store.
    RuntimeError
        If the disk is full or workers are lost: what is written is kept.
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
    if target.exists():
        atlas_store.check_same(target, chosen)
    else:
        atlas_store.check_room(chosen, target)
        atlas_store.create(target, chosen)
    todo, total = atlas_store.undone(target)
    written = total - len(todo)
    if scheduler is None:
        run = _on_this_machine(target, chosen, todo)
    else:
        run = _on_cluster(scheduler, target, chosen, todo)
    report: Progress = progress or (lambda share: None)
    try:
        report(written / total)
        for _ in run:
            written += 1
            report(written / total)
    except (OSError, _ClusterLostError) as error:
        raise RuntimeError(
            f"{target} is not finished: {_reason(error)}; {written} of {total} blocks are written and "
            "stay; the same call goes on from there"
        ) from error
    return open_atlas(target)


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
        If there is no atlas, or an unfinished one.
    ImportError
        Without the extra ``scale``.

    Examples
    --------
    >>> import stochlin as sl
    >>> sl.open_atlas("nowhere.zarr")
    Traceback (most recent call last):
    ...
    ValueError: nowhere.zarr is no atlas: no Zarr group is there
    """
    atlas_store.read_attributes(path)
    missing, total = atlas_store.undone(Path(path))
    if missing:
        raise ValueError(
            f"{path} is not finished, {len(missing)} of {total} blocks are missing; write_atlas goes on"
        )
    atlas = xr.open_zarr(str(path), consolidated=False, chunks=None)
    return atlas[[*atlas_store.TABLES, *atlas_store.SIDES]]


class _ClusterLostError(Exception):
    """The dask cluster is gone, or its workers are."""


def _reason(error: BaseException) -> str:
    if isinstance(error, OSError) and error.errno is not None:
        return f"{os.strerror(error.errno)} ({error})"
    return str(error) or type(error).__name__


def _on_this_machine(path: Path, chosen: AtlasSpecification, todo: Sequence[Number]) -> Iterator[None]:
    """Write blocks in threads: one computes while another writes."""
    pool = ThreadPoolExecutor(os.cpu_count())
    try:
        futures = [pool.submit(atlas_store.write_block, str(path), chosen, n) for n in todo]
        for future in as_completed(futures):
            future.result()
            yield
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def _on_worker(path: str, chosen: AtlasSpecification, number: Number, code: str) -> None:
    if atlas_store.code_version() != code:
        raise OSError(
            f"a worker runs stochlin {atlas_store.code_version()}, this is {code}; install the same"
        )
    atlas_store.write_block(path, chosen, number)


def _on_cluster(
    address: str, path: Path, chosen: AtlasSpecification, todo: Sequence[Number]
) -> Iterator[None]:
    """Let the workers of a dask cluster write the blocks."""
    try:
        distributed: Any = importlib.import_module("distributed")
    except ImportError as error:
        raise ImportError("a cluster needs dask.distributed: pip install 'stochlin[scale]'") from error
    lost = (distributed.KilledWorker, distributed.comm.CommClosedError, CancelledError, OSError)
    try:
        client = distributed.Client(address, timeout=PATIENCE, set_as_default=False)
    except (OSError, ValueError) as error:
        raise _ClusterLostError(f"no scheduler answers at {address}") from error
    code = atlas_store.code_version()
    with client:
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
