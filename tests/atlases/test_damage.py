"""A damaged atlas never reads as good: the message names the file, and `write_atlas` mends just that."""

import contextlib
import errno
import json
import os
import pickle
import shutil
import subprocess
import sys
import threading
import warnings
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from cases import with_slow
from commands import answered, invoke, refused
from hypothesis import given
from hypothesis import strategies as st

import stochlin as sl
from stochlin.analyses.atlases import store as atlas_store
from stochlin.analyses.atlases.checksums import BLOCKS, CHECKS, FIXED, DamagedError

pytestmark = pytest.mark.invariant

zarr = pytest.importorskip("zarr", reason="zarr is in the extra 'scale'")

SWEEP = {"start": 0.2, "stop": 5, "count": 7, "spacing": "log"}
SPEC = {
    "block_cells": 20,
    "parameters": {
        "period_1": SWEEP,
        "period_2": {**SWEEP, "count": 5},
        "ground_damping": [0.05, 0.3],
        "damping": 0.05,
        "hardening": 0.05,
        "reduction_factor": [1, 4],
    },
}
OTHER = {**SPEC, "parameters": {**SPEC["parameters"], "damping": 0.04}}
TABLES, SIDES = ("rho", "status", "bias", "caution"), ("ductility_std_1", "bias_1", "bias_2")
FIRST, LAST = "c/0/0/0/0", "c/1/0/1/1"  # the last is cut by the end of an axis
SHARE = st.floats(0, 1, exclude_max=True)
CASE = {"period_1": 0.3, "period_2": 0.5, "ground_damping": 0.05, "reduction_factor": 1.0}
OPTIONS = [f"--{name.replace('_', '-')}={value}" for name, value in CASE.items()]


@pytest.fixture(scope="module")
def kept(tmp_path_factory):
    """A good atlas, one of another specification, and what is in the good one."""
    folder = tmp_path_factory.mktemp("kept")
    sl.write_atlas(OTHER, folder / "other.zarr")
    return folder, sl.write_atlas(SPEC, folder / "good.zarr").load()


@pytest.fixture
def path(kept, tmp_path):
    return shutil.copytree(kept[0] / "good.zarr", tmp_path / "a.zarr")


@pytest.fixture
def computed(monkeypatch):
    """Numbers of the blocks that are computed."""
    write, numbers = atlas_store.write_block, []

    def counted(path, specification, number):
        numbers.append(number)
        write(path, specification, number)

    monkeypatch.setattr(atlas_store, "write_block", counted)
    return numbers


def flip(file, place=0.5, bit=3):
    data = bytearray(file.read_bytes())
    data[int(place * len(data))] ^= 1 << bit
    file.write_bytes(data)


def cut(file, to):
    file.write_bytes(file.read_bytes()[:to])


def longer(file):
    file.write_bytes(file.read_bytes() + b"0000")


def swap(one, other):
    kept = one.read_bytes()
    one.write_bytes(other.read_bytes())
    other.write_bytes(kept)


def edit(file, change):
    """Metadata as another program might leave them."""
    metadata = json.loads(file.read_text())
    change(metadata)
    file.write_text(json.dumps(metadata))


def other(path, kept, *names):
    for name in names:
        shutil.copyfile(kept / "other.zarr" / name, path / name)


def in_place_of(file):
    """A folder where a file was."""
    file.unlink()
    file.mkdir()


OF_FIRST = f"{CHECKS}/0.0.0.0"
BLOCK = [f"{name}/{FIRST}" for name in TABLES] + ["ductility_std_1/c/0/0/0", OF_FIRST]
# What is done to it, what the message says, and how many blocks are then computed.
DAMAGE = {
    **{
        f"no {name}": (lambda p, k, n=name: (p / n / LAST).unlink(), f"{LAST} of {name}.*missing", 1)
        for name in TABLES
    },
    **{
        f"no {name}": (lambda p, k, n=name: (p / n / "c/0/0/1").unlink(), f"c/0/0/1 of {name}", 1)
        for name in SIDES
    },
    "no axis": (lambda p, k: (p / "period_1/c/0").unlink(), "c/0 of period_1", 0),
    "no checks of a block": (
        lambda p, k: (p / OF_FIRST).unlink(),
        "not finished, 1 of 8",
        1,
    ),
    "no caution at all": (lambda p, k: shutil.rmtree(p / "caution/c"), "of caution.* 7 more", 8),
    "no array": (lambda p, k: shutil.rmtree(p / "rho"), "rho/zarr.json is damaged: it is missing", 8),
    "bit in rho": (lambda p, k: flip(p / "rho" / LAST), f"{LAST} of rho.*checksum", 1),
    "bit in status": (lambda p, k: flip(p / "status" / FIRST, 0.99), f"{FIRST} of status.*checksum", 1),
    "bit in an axis": (lambda p, k: flip(p / "period_2/c/0"), "c/0 of period_2.*checksum", 0),
    "bit in the checks": (lambda p, k: flip(p / OF_FIRST), f"{OF_FIRST} is damaged", 1),
    "bit in metadata": (lambda p, k: flip(p / "bias/zarr.json"), "bias/zarr.json.*checksum", 0),
    "cut chunk": (lambda p, k: cut(p / "bias" / LAST, 30), f"{LAST} of bias.*30 of", 1),
    "empty chunk": (lambda p, k: cut(p / "caution" / FIRST, 0), f"{FIRST} of caution.*0 of", 1),
    "cut checks": (lambda p, k: cut(p / OF_FIRST, 40), f"{OF_FIRST} is damaged: its checksum", 1),
    "longer chunk": (lambda p, k: longer(p / "rho" / LAST), f"{LAST} of rho.*it has", 1),
    "arrays swapped": (lambda p, k: swap(p / "status" / LAST, p / "caution" / LAST), f"{LAST} of", 1),
    "places swapped": (
        lambda p, k: swap(p / "rho" / FIRST, p / "rho/c/0/0/1/0"),
        "c/0/0/[01]/0 of rho",
        2,
    ),
    "chunk of another": (lambda p, k: other(p, k, f"rho/{FIRST}"), f"{FIRST} of rho", 1),
    "block of another": (lambda p, k: other(p, k, *BLOCK), f"{OF_FIRST} is damaged: its checksum", 1),
    "group of another": (lambda p, k: other(p, k, "zarr.json"), "is damaged", None),
    "bit in the fixed checks": (lambda p, k: flip(p / FIXED), f"{FIXED} is damaged: its checksum", 0),
    "no fixed checks": (lambda p, k: (p / FIXED).unlink(), f"{FIXED} is damaged: it is missing", 0),
    "no group": (lambda p, k: (p / "zarr.json").unlink(), "zarr.json.*no Zarr group", 0),
    "cut group": (lambda p, k: cut(p / "zarr.json", 300), "zarr.json is damaged: it is no JSON", 0),
    "bytes in group": (lambda p, k: (p / "zarr.json").write_bytes(b"\xff\xfe\0"), "it is no JSON", 0),
    "list in group": (lambda p, k: (p / "zarr.json").write_text("[1]"), "it has no specification", 0),
    "cut array": (lambda p, k: cut(p / "rho/zarr.json", 300), "rho/zarr.json.*300 of", 0),
    "no metadata": (lambda p, k: (p / "caution/zarr.json").unlink(), "caution/zarr.json.*missing", 0),
    "another specification": (
        lambda p, k: edit(p / "zarr.json", lambda m: m["attributes"].update(specification="{}")),
        "zarr.json is damaged",
        0,
    ),
    "another version": (
        lambda p, k: edit(p / "zarr.json", lambda m: m["attributes"].update(code="1")),
        "zarr.json is damaged",
        0,
    ),
    "another type": (
        lambda p, k: edit(p / "rho/zarr.json", lambda m: m.update(data_type="int64")),
        "rho/zarr.json is damaged",
        0,
    ),
    "another shape": (
        lambda p, k: edit(p / "rho/zarr.json", lambda m: m.update(shape=[7, 5, 2, 1])),
        "rho/zarr.json is damaged",
        0,
    ),
    **{
        f"no {name} in group": (
            lambda p, k, n=name: edit(p / "zarr.json", lambda m: m["attributes"].pop(n)),
            "zarr.json is damaged",
            0,
        )
        for name in ("specification", "code", BLOCKS)
    },
    "folder for a chunk": (
        lambda p, k: in_place_of(p / "rho" / FIRST),
        f"{FIRST} of rho.*missing",
        None,
    ),
    "file for an array": (
        lambda p, k: (shutil.rmtree(p / "rho"), (p / "rho").write_text("rho")),
        "rho/zarr.json",
        None,
    ),
}


# The same in another array or file, which `make test-all` also tries.
LONG = {
    *("no array", "no bias", "no status", "no bias_1", "no bias_2", "bit in status", "bytes in group"),
    *("another version", "another shape", "cut array", "cut chunk", "no axis", "list in group"),
    *(f"no {name} in group" for name in ("code", BLOCKS)),
}


@pytest.mark.parametrize("kind", with_slow(DAMAGE, LONG))
def test_damage_is_named_and_mended(kind, path, kept, computed):
    damage, says, blocks = DAMAGE[kind]
    damage(path, kept[0])
    with pytest.raises(ValueError, match=says) as told:
        sl.open_atlas(path).load()
    assert "write_atlas" in str(told.value)
    if blocks is None:
        return
    xr.testing.assert_identical(sl.write_atlas(SPEC, path).load(), kept[1])
    assert len(computed) == blocks
    files = [file.relative_to(path) for file in path.rglob("*") if file.is_file()]
    for file in files:
        assert (path / file).read_bytes() == (kept[0] / "good.zarr" / file).read_bytes()


def test_what_cannot_be_mended_is_said(path, kept):
    in_place_of(path / "rho" / FIRST)
    with pytest.raises(RuntimeError, match=rf"Is a directory \(.*rho/{FIRST}\); 7 of 8 blocks"):
        sl.write_atlas(SPEC, path)
    cut(path / "zarr.json", 300)
    with pytest.raises(ValueError, match="no block shows that it is an atlas of this specification"):
        sl.write_atlas(OTHER, path)
    shutil.rmtree(path)
    shutil.copytree(kept[0] / "other.zarr", path)
    with pytest.raises(ValueError, match="another specification"):
        sl.write_atlas(SPEC, path)


@pytest.mark.slow
@given(
    where=st.floats(0, 1, exclude_max=True),
    place=st.floats(0, 1, exclude_max=True),
    bit=st.integers(0, 7),
)
def test_any_flipped_bit_is_refused_or_changes_nothing(kept, where, place, bit):
    """One bit of one file: what is read then is nothing, or the same."""
    files = sorted(file for file in (kept[0] / "good.zarr").rglob("*") if file.is_file())
    file = files[int(where * len(files))]
    good = file.read_bytes()
    flip(file, place, bit)
    with contextlib.suppress(DamagedError):
        xr.testing.assert_identical(sl.open_atlas(kept[0] / "good.zarr").load(), kept[1])
    file.write_bytes(good)


def test_lookup_checks_what_it_reads(path, kept):
    atlas = sl.open_atlas(path)
    expected = sl.lookup(kept[1], **CASE)
    flip(path / "rho" / LAST)
    xr.testing.assert_identical(sl.lookup(atlas, **CASE), expected)
    for damage in (flip, lambda file: file.unlink()):
        damage(path / "status" / FIRST)
        with pytest.raises(ValueError, match=f"{FIRST} of status is damaged.*write_atlas"):
            sl.lookup(atlas, **CASE)
    xr.testing.assert_identical(pickle.loads(pickle.dumps(atlas.bias)).load(), kept[1].bias)


@pytest.mark.slow
def test_one_message_and_no_more(tmp_path):
    """Reads that are under way when one fails are not complained of when the process ends."""
    path = tmp_path / "a.zarr"
    sl.write_atlas({**SPEC, "block_cells": 4}, path)
    for file in (path / "rho").rglob("c/*/*/*/*"):
        flip(file)
    program = f"import stochlin as sl\ntry: sl.open_atlas({str(path)!r}).load()\nexcept ValueError: pass"
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    command = [sys.executable, "-c", program]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    assert done.stdout + done.stderr == ""


def test_whoever_does_not_know_the_checks_sees_the_worst(path):
    """Read by xarray alone: flags that are gone are the worst ones, and broken chunks are refused."""
    for name in ("status", "caution", "rho"):
        (path / name / FIRST).unlink()
    plain = xr.open_zarr(str(path), consolidated=False, chunks=None)
    first = dict.fromkeys(plain.rho.dims, 0)
    assert plain.status[first] == max(plain.status.attrs["flag_values"])
    assert plain.caution[first] == 2
    flip(path / "bias" / FIRST)
    with pytest.raises(ValueError, match="checksum"):
        plain.bias.load()


def of_earlier_version(path, atlas, marks):
    """The atlas as earlier versions wrote it, with the array that marked the written blocks."""
    code = {"code": "0.9+before", "specification": atlas.attrs["specification"]}
    group = zarr.open_group(str(path), mode="w", attributes=atlas.attrs | code)
    for name, variable in atlas.variables.items():
        chunks = [4, 5, 1, 1][: variable.ndim] if name in atlas.data_vars else variable.shape
        fill = np.nan if variable.dtype.kind == "f" else 0
        kind = {"shape": variable.shape, "dtype": variable.dtype, "dimension_names": variable.dims}
        array = group.create_array(str(name), chunks=chunks, fill_value=fill, **kind)
        array[...] = variable.values
        array.attrs.update({k: np.asarray(v).tolist() for k, v in variable.attrs.items()})
    group.create_array(marks, **EARLIER[marks])[...] = 1
    return group[marks]


EARLIER = {
    "block_done": {"shape": (1,), "dtype": "i1", "dimension_names": ["block"]},
    "block_checks": {"shape": (1, 9, 2), "dtype": "i8", "dimension_names": ["block", "file", "check"]},
}


@pytest.mark.parametrize("marks", EARLIER)
def test_an_atlas_of_an_earlier_version_is_read_and_says_so(marks, kept, tmp_path):
    path = tmp_path / "a.zarr"
    written = of_earlier_version(path, kept[1], marks)
    with pytest.warns(UserWarning, match=r"a\.zarr was written by an earlier version"):
        atlas = sl.open_atlas(path)
    xr.testing.assert_equal(atlas.load(), kept[1])
    xr.testing.assert_equal(sl.lookup(atlas, **CASE), sl.lookup(kept[1], **CASE))
    with pytest.raises(ValueError, match=r"was begun by 0\.9\+before"):
        sl.write_atlas(SPEC, path)
    with warnings.catch_warnings():
        warnings.simplefilter("default")
        done = answered("lookup", path, *OPTIONS)
        assert done.output.startswith(f"Warning: {path} was written by an earlier")
        shutil.rmtree(path / "rho/c/0/0")
        done = invoke("lookup", path, *OPTIONS)
    assert done.exit_code == 2
    assert "rho is missing where status says that it was found" in done.output
    written[...] = {"block_done": 0, "block_checks": -1}[marks]
    with pytest.raises(ValueError, match="not finished, 1 of 1 blocks"):
        sl.open_atlas(path)


def test_one_writer_at_a_time(path, kept, tmp_path):
    with (
        atlas_store.held(path),
        pytest.raises(RuntimeError, match=r"a\.zarr is being written by another process; wait"),
    ):
        sl.write_atlas(SPEC, path)
    xr.testing.assert_identical(sl.write_atlas(SPEC, path).load(), kept[1])
    told = []

    def write():
        try:
            sl.write_atlas(SPEC, tmp_path / "b.zarr")
        except RuntimeError as error:
            told.append(str(error))

    writers = [threading.Thread(target=write) for _ in range(4)]
    for writer in writers:
        writer.start()
    for writer in writers:
        writer.join()
    assert all("another process" in message for message in told)
    xr.testing.assert_identical(sl.open_atlas(tmp_path / "b.zarr").load(), kept[1])


def test_what_does_not_fit_is_refused(tmp_path, monkeypatch):
    def full(*_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    axes = SPEC["parameters"] | {f"period_{n}": {**SWEEP, "count": 100_000} for n in (1, 2)}
    many = {**SPEC, "block_cells": 1, "parameters": axes}
    with pytest.raises(ValueError, match=r"cells in 2e\+11 files need up to .* GB"):
        sl.write_atlas(many, tmp_path / "a.zarr")
    sizes = {"SC_PAGE_SIZE": 4096, "SC_PHYS_PAGES": 1000}
    monkeypatch.setattr(os, "sysconf", sizes.get)
    with pytest.raises(ValueError, match=r"block_cells = 99999: .* GB; allowed: .* smaller blocks"):
        sl.write_atlas({**many, "block_cells": 99_999}, tmp_path / "a.zarr")
    monkeypatch.undo()
    monkeypatch.setattr(atlas_store, "_fill", full)
    with pytest.raises(RuntimeError, match=r"not finished: No space left on device; none of it"):
        sl.write_atlas(SPEC, tmp_path / "a.zarr")
    assert not list(tmp_path.iterdir())


def test_a_bad_sector_is_damage(path, kept, computed, monkeypatch):
    read, bad = Path.read_bytes, [path / "rho" / LAST]

    def from_disk(file):
        if file in bad and not computed:
            raise OSError(errno.EIO, os.strerror(errno.EIO))
        return read(file)

    monkeypatch.setattr(Path, "read_bytes", from_disk)
    with pytest.raises(ValueError, match=f"{LAST} of rho is damaged: it cannot be read, Input/output"):
        sl.open_atlas(path).load()
    xr.testing.assert_identical(sl.write_atlas(SPEC, path).load(), kept[1])
    assert computed == [(1, 0, 1, 1)]


def test_too_little_memory_is_said(path, monkeypatch):
    def hungry(*_):
        raise MemoryError("Unable to allocate 7 GiB")

    (path / "rho" / FIRST).unlink()
    monkeypatch.setattr(atlas_store, "write_block", hungry)
    with pytest.raises(RuntimeError, match=r"not enough memory \(Unable to allocate 7 GiB\); 7 of 8"):
        sl.write_atlas(SPEC, path)


def test_refusals_on_the_command_line_stand_alone(path, tmp_path):
    spec = 'ground = "white_noise"\n[parameters]\nperiod_1 = [1, 2]\nperiod_2 = 1\ndamping = 0.05\n'
    (tmp_path / "spec.toml").write_text(spec)
    done = refused("atlas", tmp_path / "spec.toml", "--out", path)
    assert done.startswith("Usage: ")
    assert "another specification" in done
    flip(path / "rho" / FIRST)
    assert f"chunk {FIRST} of rho is damaged" in refused("lookup", path, *OPTIONS)
