"""An atlas outlives its process, its disk and its workers, and ends as one that ran through."""

import errno
import multiprocessing
import os
import shutil
import time

import numpy as np
import pytest
import xarray as xr

import stochlin as sl
from stochlin.analyses.atlases import atlas as atlas_module
from stochlin.analyses.atlases import store as atlas_store
from stochlin.analyses.atlases.specification import specification

pytestmark = pytest.mark.invariant

pytest.importorskip("zarr", reason="zarr is in the extra 'scale'")

KILLS = 20
SWEEP = {"start": 0.1, "stop": 10, "count": 40, "spacing": "log"}
SPEC = {
    "block_cells": 200,
    "parameters": {
        "period_1": SWEEP,
        "period_2": SWEEP,
        "ground_damping": [0.05, 0.3],
        "damping": 0.05,
        "hardening": 0.05,
        "reduction_factor": [2, 4],
    },
}


def blocks_done(path):
    return int(atlas_store.done(path, atlas_store.checks_of(path)).sum())


def is_done(path):
    return bool(atlas_store.done(path, atlas_store.checks_of(path)).all())


@pytest.fixture(scope="module")
def whole():
    """The same table in one piece."""
    first, second, ground = specification(SPEC).models()
    return sl.correlate(first, second, ground)


def assert_is(atlas, whole):
    for name, variable in atlas.data_vars.items():
        expected = whole[name].transpose(*variable.dims)
        assert variable.dtype == expected.dtype
        np.testing.assert_array_equal(variable, expected, err_msg=str(name))


@pytest.mark.slow
def test_drift_closure_in_blocks_is_that_in_one_piece(tmp_path):
    short = {**SWEEP, "count": 7}
    drifting = {**SPEC, "closure": "drift", "block_cells": 20}
    grounds = {"ground_damping": [0.02, 0.3]}  # the first is outside of what was checked
    drifting["parameters"] = {**SPEC["parameters"], **grounds, "period_1": short, "period_2": short}
    atlas = sl.write_atlas(drifting, tmp_path / "a.zarr")
    first, second, ground = specification(drifting).models()
    whole = sl.correlate(first, second, ground, closure="drift")
    for name, variable in atlas.data_vars.items():  # series are cut by the largest cell of a block
        expected = whole[name].transpose(*variable.dims)
        np.testing.assert_allclose(variable, expected, rtol=0, atol=1e-9, err_msg=str(name))
    assert set(np.unique(atlas.caution)) == {0, 1, 2}


@pytest.mark.slow
def test_without_interruption(whole, tmp_path):
    told = []
    atlas = sl.write_atlas(SPEC, tmp_path / "a.zarr", progress=told.append)
    assert_is(atlas, whole)
    assert told[0] == 0
    assert told[-1] == 1
    assert told == sorted(told)
    again = sl.write_atlas(SPEC, tmp_path / "a.zarr")
    xr.testing.assert_identical(again.load(), atlas.load())
    assert not list(tmp_path.glob(".*"))


@pytest.mark.slow
def test_killed_at_random_moments(whole, tmp_path):
    """SIGKILL, twenty times; an atlas that was finished in spite of it is compared and begun anew."""
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["stochlin.analyses.atlases.atlas", "zarr", "scipy.special"])
    rng = np.random.default_rng(1985)
    target, partial = tmp_path / "a.zarr", 0
    for _ in range(KILLS):
        process = context.Process(target=sl.write_atlas, args=(SPEC, target))
        before = blocks_done(target) if target.exists() else 0
        process.start()
        deadline = time.monotonic() + 20
        while process.is_alive() and time.monotonic() < deadline:
            if target.exists() and blocks_done(target) > before:
                break
            time.sleep(0.01)
        time.sleep(rng.uniform(0, 0.15))
        process.kill()
        process.join()
        if target.exists() and is_done(target):
            assert_is(sl.open_atlas(target), whole)
            shutil.rmtree(target)
        else:
            partial += 1
            with pytest.raises(ValueError, match="not finished"):
                sl.open_atlas(target)
    assert partial >= KILLS // 2
    assert_is(sl.write_atlas(SPEC, target), whole)


@pytest.mark.slow
def test_a_full_disk_is_told_and_the_rest_written_later(whole, tmp_path, monkeypatch):
    """The disk takes five blocks, then no more; with room again the rest is written."""
    target, write, count = tmp_path / "a.zarr", atlas_store.write_block, 0

    def until_full(*arguments):
        nonlocal count
        count += 1
        if count > 5:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        write(*arguments)

    monkeypatch.setattr(atlas_store, "write_block", until_full)
    with pytest.raises(RuntimeError, match=r"No space left on device.*blocks are written and stay"):
        sl.write_atlas(SPEC, target)
    assert blocks_done(target) == 5
    monkeypatch.undo()
    assert_is(sl.write_atlas(SPEC, target), whole)


def test_no_room_is_said_before_any_work(tmp_path, monkeypatch):
    usage = shutil._ntuple_diskusage(10**9, 10**9 - 1000, 1000)
    monkeypatch.setattr(shutil, "disk_usage", lambda _: usage)
    with pytest.raises(ValueError, match=r"need up to .* GB.* free; take shorter axes or another disk"):
        sl.write_atlas(SPEC, tmp_path / "a.zarr")
    assert not list(tmp_path.iterdir())


def test_another_specification_or_version_is_not_mixed_in(tmp_path, monkeypatch):
    small = {
        "ground": "white_noise",
        "parameters": {"period_1": [0.5, 1], "period_2": 1, "damping": 0.05},
    }
    target = tmp_path / "a.zarr"
    sl.write_atlas(small, target)
    other = small | {"parameters": small["parameters"] | {"damping": 0.04}}
    with pytest.raises(ValueError, match=r"another specification \(damping differ"):
        sl.write_atlas(other, target)
    monkeypatch.setattr(atlas_store, "code_version", lambda: "9.9")
    with pytest.raises(ValueError, match=r"was begun by .*, this is 9\.9"):
        sl.write_atlas(small, target)


def test_what_is_no_atlas_is_left_alone(tmp_path):
    target = tmp_path / "a.zarr"
    target.mkdir()
    (target / "thesis.txt").write_text("years of work")
    with pytest.raises(ValueError, match="is no atlas"):
        sl.write_atlas(SPEC, target)
    assert (target / "thesis.txt").read_text() == "years of work"
    with pytest.raises(OSError, match="is no folder"):
        sl.write_atlas(SPEC, tmp_path / "nowhere" / "a.zarr")


@pytest.fixture
def cluster():
    distributed = pytest.importorskip("distributed", reason="distributed is in the extra 'scale'")
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, dashboard_address=":0", processes=True
    ) as local:
        yield local


@pytest.mark.slow
def test_two_workers_make_the_same_bits_and_a_dead_one_is_no_loss(cluster, whole, tmp_path):
    atlas = sl.write_atlas(SPEC, tmp_path / "a.zarr", scheduler=cluster.scheduler_address)
    assert_is(atlas, whole)
    killed = []

    def kill_one(share):
        if share > 0.1 and not killed:
            process = next(iter(cluster.workers.values())).process.process
            os.kill(process.pid, 9)
            killed.append(process.pid)

    with cluster.get_client() as client:
        survivor = sl.write_atlas(SPEC, tmp_path / "b.zarr", scheduler=client, progress=kill_one)
    assert killed
    assert_is(survivor, whole)


@pytest.mark.slow
def test_without_workers_it_says_so(whole, tmp_path, monkeypatch):
    distributed = pytest.importorskip("distributed", reason="distributed is in the extra 'scale'")
    monkeypatch.setattr(atlas_module, "PATIENCE", 2.0)
    target = tmp_path / "a.zarr"
    with (
        distributed.LocalCluster(n_workers=0, dashboard_address=":0", processes=False) as empty,
        pytest.raises(RuntimeError, match=r"has had no worker .*0 of \d+ blocks are written and stay"),
    ):
        sl.write_atlas(SPEC, target, scheduler=empty.scheduler_address)
    with pytest.raises(RuntimeError, match="no scheduler answers"):
        sl.write_atlas(SPEC, target, scheduler="tcp://127.0.0.1:9")
    assert_is(sl.write_atlas(SPEC, target), whole)
