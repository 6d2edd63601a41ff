"""Compiled functions that are kept on the disk: nothing that befalls it stops or changes them."""

from __future__ import annotations

import errno
import importlib.util
import os
import subprocess
import sys
import warnings

import numba
import numpy as np
import pytest
from numba.core.caching import CompileResultCacheImpl

from stochlin.kernels.basics import kept

pytestmark = pytest.mark.invariant

TOY = """
from stochlin.kernels.basics.compiled import elementwise, entry

@entry
def twice(x):
    return x + x

@elementwise
def half(x):
    return x / 2
"""
# Each begins with an empty cache, for arguments of another kind; then all are read.
RACE = """
import sys, numpy as np, toy
kinds = [1, 1.0, 1 + 0j, np.ones(3)]
for n in map(int, sys.argv[1:]):
    assert np.all(toy.twice(kinds[n]) == 2), n
    assert type(toy.twice(kinds[n])) is type(kinds[n]), n
print(sum(toy.twice.stats.cache_hits.values()))
"""


@pytest.fixture
def toy(tmp_path, monkeypatch):
    """The functions as a process finds them that has just begun; with the folder of their cache."""
    monkeypatch.setattr(numba.config, "CACHE_DIR", "")
    kept.warn_once.cache_clear()
    file = tmp_path / "toy.py"
    file.write_text(TOY)

    def begun():
        spec = importlib.util.spec_from_file_location("toy", file)
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        return module

    return begun, tmp_path / "__pycache__"


def hits(function):
    return sum(function.stats.cache_hits.values())


def test_what_is_kept_is_found_again(toy):
    begun, folder = toy
    for expected in (0, 1):
        module = begun()
        assert module.twice(1.5) == 3.0
        assert hits(module.twice) == expected
        np.testing.assert_array_equal(module.half(np.arange(3.0)), [0, 0.5, 1])
    assert len(list(folder.glob("*.nbc"))) == 2
    assert not list(folder.glob("*.nbi"))


def flipped(data):
    middle = len(data) // 2
    return data[:middle] + bytes([data[middle] ^ 4]) + data[middle + 1 :]


BROKEN = {
    "empty": lambda data: b"",
    "cut": lambda data: data[:1000],
    "a flipped bit": flipped,
    "no pickle": lambda data: kept.DIGEST(b"x").digest() + b"x",
    "zeros": lambda data: bytes(len(data)),
}


@pytest.mark.parametrize("kind", BROKEN)
def test_a_broken_file_is_replaced(toy, kind):
    begun, folder = toy
    begun().twice(1.5)
    (file,) = folder.glob("*.nbc")
    file.write_bytes(BROKEN[kind](file.read_bytes()))
    for expected in (0, 1):
        module = begun()
        assert module.twice(1.5) == 3.0
        assert hits(module.twice) == expected


def test_a_file_for_other_arguments_is_not_taken(toy):
    begun, folder = toy
    module = begun()
    assert module.twice(1.5) == 3.0
    (of_numbers,) = folder.glob("*.nbc")
    assert module.twice(1j) == 2j
    (of_complex,) = set(folder.glob("*.nbc")) - {of_numbers}
    of_complex.write_bytes(of_numbers.read_bytes())
    module = begun()
    assert module.twice(1j) == 2j
    assert hits(module.twice) == 0


def test_without_a_folder_it_runs_and_says_so_once(toy, tmp_path, monkeypatch):
    """Files where the folders should be: not even root makes any there."""
    begun, folder = toy
    for place in (folder, tmp_path / "cache"):
        place.write_text("in the way")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    classes = CompileResultCacheImpl._locator_classes
    if sys.platform != "linux":  # elsewhere the user's folder is not told by the environment
        monkeypatch.setattr(CompileResultCacheImpl, "_locator_classes", classes[:2])
    with pytest.warns(UserWarning, match=r"set the environment variable NUMBA_CACHE_DIR") as told:
        module = begun()
    assert len(told) == 1
    assert module.twice(1.5) == 3.0
    assert module.half(3.0) == 1.5
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path / "elsewhere"))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert begun().twice(1.5) == 3.0
    assert list((tmp_path / "elsewhere").rglob("*.nbc"))


def test_a_full_disk_does_not_stop_it(toy, monkeypatch):
    begun, folder = toy
    module = begun()

    def full(*_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(kept._Files, "_open_for_write", full)
    with pytest.warns(UserWarning, match="the disk is full"):
        assert module.twice(1.5) == 3.0
    assert module.twice(1) == 2  # another warning would be an error
    assert not list(folder.glob("*.nb?"))


@pytest.mark.slow
def test_processes_that_begin_at_once(toy, tmp_path):
    environment = {k: v for k, v in os.environ.items() if k != "NUMBA_CACHE_DIR"}
    places = [str(tmp_path), *filter(None, sys.path)]
    environment["PYTHONPATH"] = os.pathsep.join(places)

    def process(*numbers):
        command = [sys.executable, "-c", RACE, *map(str, numbers)]
        return subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True)

    together = [process(n) for n in range(4)]
    assert [one.communicate()[0] for one in together] == ["0\n"] * 4
    assert process(0, 1, 2, 3).communicate()[0] == "4\n"


def test_code_is_out_of_date_when_what_its_module_imports_has_changed(tmp_path, monkeypatch):
    room = tmp_path / "stochlin" / "kernels" / "room"
    room.mkdir(parents=True)
    texts = {
        "outer": "from stochlin.kernels.room import middle\n",
        "middle": "from stochlin.kernels.room.inner import (\n    one,\n    two,\n)\n",
        "inner": "one = two = 1\n",
        "other": "",
    }
    for name, text in texts.items():
        (room / f"{name}.py").write_text(text)
    monkeypatch.setattr(kept, "ROOT", tmp_path)

    def digest():
        kept.digest_of.cache_clear()
        return kept.digest_of(room / "outer.py")

    before = digest()
    (room / "other.py").write_text("three = 3\n")
    assert digest() == before
    (room / "inner.py").write_text("one = two = 2\n")
    assert digest() != before
