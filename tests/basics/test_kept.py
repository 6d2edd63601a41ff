"""Compiled functions that are kept on the disk: nothing that befalls it stops or changes them."""

import importlib.util
import os
import re
import shutil
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from functools import cache

import numba
import numpy as np
import pytest
import sympy
from commands import process

import stochlin as sl
from stochlin.kernels.basics import kept
from stochlin.kernels.basics.compiled import UNCOMPILED
from stochlin.kernels.simulation.laws import by_number

pytestmark = [
    pytest.mark.invariant,
    pytest.mark.skipif(UNCOMPILED, reason="NUMBA_DISABLE_JIT is set: nothing is compiled or kept"),
]

TOY = """
from stochlin.kernels.basics.compiled import entry
from inner import double

@entry
def twice(x):
    return double(x)
"""
INNER = """
from stochlin.kernels.basics.compiled import compiled

@compiled
def double(x):
    return x + x
"""
# Each process calls it with arguments of some of these kinds.
RACE = """
import sys, numpy as np, toy
kinds = [1, 1.0, 1 + 0j, np.ones(3)]
for n in map(int, sys.argv[1]):
    assert np.all(toy.twice(kinds[n]) == 2), n
    assert type(toy.twice(kinds[n])) is type(kinds[n]), n
print(sum(toy.twice.dispatcher.stats.cache_hits.values()))
"""


def forget():
    """What a process finds that has just begun."""
    for cached in (kept.warn_once, kept.places, kept.archives, kept.folder_of):
        cached.cache_clear()


OF_ONE = numba.float64(numba.float64)


def law_times(factor):
    def law(x):
        return factor * x

    return law


def begun_law(factor, name):
    """A law as a process finds it that has just begun."""
    forget()
    return kept.kept_law(law_times(factor), OF_ONE, name)


@pytest.fixture
def toy(tmp_path, monkeypatch):
    """The functions as a process finds them that has just begun; and the place of the archives."""
    sources, place = tmp_path / "kernels", tmp_path / "cache" / "stochlin"
    for folder in (sources, place.parent):
        folder.mkdir()
    (sources / "toy.py").write_text(TOY)
    (sources / "inner.py").write_text(INNER)
    monkeypatch.setattr(kept, "KERNELS", sources)
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(place.parent))
    monkeypatch.syspath_prepend(str(sources))

    def begun():
        forget()
        monkeypatch.delitem(sys.modules, "inner", raising=False)
        importlib.invalidate_caches()
        spec = importlib.util.spec_from_file_location("toy", sources / "toy.py")
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        return module.twice

    yield begun, place
    forget()


def hits(function):
    return sum(function.dispatcher.stats.cache_hits.values())


@pytest.fixture(params=["function", "law"])
def doubled(toy, request):
    """Twice a number, in a process that has just begun; and how often compiled code was ready for it."""

    def double(x):
        if request.param == "law":
            law = begun_law(2.0, "double")
            return law(x), law.cache_hits
        twice = toy[0]()
        return twice(x), hits(twice)

    return double


def test_what_is_kept_is_found_again(toy, doubled, monkeypatch):
    assert doubled(1.5) == (3.0, 0)
    assert doubled(1.5) == (3.0, 1)
    assert [file.suffix for file in toy[1].glob("kernels-*/*")] == [".zip"]
    monkeypatch.setattr(kept, "archives", cache(lambda: None))  # where files can only be read
    assert doubled(1.5) == (3.0, 1)


def test_a_changed_function_in_another_file_changes_the_result(toy):
    begun, place = toy
    assert begun()(1.5) == 3.0
    inner = place.parents[1] / "kernels" / "inner.py"
    inner.write_text(INNER.replace("x + x", "x + x + 1"))
    assert begun()(1.5) == 4.0
    inner.write_text(INNER)
    twice = begun()
    assert twice(1.5) == 3.0
    assert hits(twice) == 1


def flipped(data):
    middle = len(data) // 2
    return data[:middle] + bytes([data[middle] ^ 4]) + data[middle + 1 :]


BROKEN = {
    "empty": lambda data: b"",
    "cut": lambda data: data[:1000],
    "a flipped bit": flipped,
    "zeros": lambda data: bytes(len(data)),
}


@pytest.mark.parametrize("kind", BROKEN)
def test_a_broken_archive_is_replaced(toy, doubled, kind):
    doubled(1.5)
    (file,) = toy[1].glob("kernels-*/*.zip")
    file.write_bytes(BROKEN[kind](file.read_bytes()))
    assert doubled(1.5) == (3.0, 0)
    assert doubled(1.5) == (3.0, 1)


def test_without_a_folder_it_runs_and_says_so_once(toy, doubled, tmp_path, monkeypatch):
    """A file where the folder should be: not even root makes any there."""
    toy[1].write_text("in the way")
    with pytest.warns(UserWarning, match="folder that can be written") as told:
        assert doubled(1.5) == (3.0, 0)
    assert len(told) == 1
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path / "elsewhere"))
    assert doubled(1.5) == (3.0, 0)
    assert list((tmp_path / "elsewhere").rglob("*.zip"))
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "absent"))
    with pytest.warns(UserWarning, match="temporary files"):
        assert doubled(1.5) == (3.0, 0)


@contextmanager
def full_disk():
    """Files are no larger than indices of compiled code; what numba then raises is alike."""
    resource = pytest.importorskip("resource")
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (4096, limits[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)


def test_a_full_disk_replaces_no_archive(toy, doubled):
    begun, place = toy
    for stored in (False, True):
        with full_disk(), pytest.warns(UserWarning, match="the disk is full"):
            assert doubled(1.5) == (3.0, 0)
        assert len(list(place.glob("kernels-*/*"))) == stored
        assert doubled(1.5) == (3.0, stored)
    twice = begun()
    twice(1.5)
    with full_disk(), pytest.warns(UserWarning, match="the disk is full"):
        assert twice(1j) == 2j
    assert doubled(1.5) == (3.0, 1)


def test_threads_that_begin_at_once_agree(toy):
    for hit in (0, 1, 1, 1):
        with ThreadPoolExecutor(8) as threads:
            twice = toy[0]()
            assert [*threads.map(twice, [1, 1.0, 1j, np.float32(1)] * 2)] == [2, 2, 2j, 2] * 2
            assert hits(twice) == 4 * hit
            forget()
            law = kept.kept_law, law_times(2.0), OF_ONE, "double"
            laws = [threads.submit(*law) for _ in range(8)]
            assert sum(law.result().cache_hits for law in laws) == 7 + hit


def test_a_folder_of_the_process_that_was_removed_is_made_again(toy):
    begun, _ = toy
    twice = begun()
    assert twice(1.5) == 3.0
    shutil.rmtree(kept.folder_of(os.getpid()))
    assert twice(1j) == 2j
    for expected in (1, 2):  # what is not known to contain it does not replace its archive
        twice = begun()
        assert twice(1.5) == 3.0
        assert twice(1j) == 2j
        assert hits(twice) == expected


def test_what_is_not_used_is_removed_and_what_others_have_put_beside_it_stays(toy):
    begun, place = toy
    begun_law(2.0, "double")
    (law,) = place.glob("kernels-*/law-*.zip")
    os.utime(law, (1e9, 1e9))
    names = "kernels-thesis", "kernels-notes.txt", "kernels-0123456789abcdef"
    for folder in (place, place.parent):
        folder.mkdir(exist_ok=True)
        for name in names:
            (folder / name).mkdir()
            os.utime(folder / name, (1e9, 1e9))
    assert begun()(1.5) == 3.0
    assert {path.name for path in place.parent.iterdir()} == {*names, "stochlin"}
    assert {*names[:2]} < {path.name for path in place.iterdir()}
    assert not (place / names[2]).exists()  # of an earlier version
    assert not law.exists()


@pytest.fixture
def ran(toy, tmp_path):
    """What a process prints that runs a program with this argument, and its exit status."""
    (tmp_path / "tmp").mkdir()
    setting = {"NUMBA_CACHE_DIR": str(toy[1].parent), "TMPDIR": str(tmp_path / "tmp")}

    def run(program, argument):
        done = process(tmp_path / "kernels", setting, "-c", program, argument)
        return done.stdout.strip(), done.returncode

    return run


@pytest.mark.slow
def test_eight_processes_that_begin_at_once_agree(ran):
    with ThreadPoolExecutor(8) as threads:
        done = [threads.submit(ran, RACE, f"{n % 4}{(n + 1) % 4}") for n in range(8)]
    assert [one.result()[1] for one in done] == [0] * 8
    ran(RACE, "0123")  # what processes have replaced is compiled again, once
    assert ran(RACE, "0123") == ("4", 0)


ENDS = """
import os, sys, toy
toy.twice(1.0)
if sys.argv[1] == "killed":
    os.kill(os.getpid(), 9)
if os.fork() == 0:
    toy.twice(1)
    sys.exit()
os.wait()
print(*os.listdir(os.environ["TMPDIR"]))
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="Windows has neither forks nor locks of folders")
def test_processes_remove_their_own_temporary_files_and_those_of_killed_ones(ran, tmp_path):
    ran(ENDS, "killed")
    (left,) = os.listdir(tmp_path / "tmp")
    (of_parent,) = ran(ENDS, "after its child")[0].split()
    assert of_parent != left
    assert not os.listdir(tmp_path / "tmp")


def test_a_law_is_never_taken_for_another(toy):
    """What a law contains counts beside its name."""
    for factor, name in ((2.0, "double"), (3.0, "triple"), (4.0, "double")):
        assert begun_law(factor, name).cache_hits == 0
        assert begun_law(factor, name).cache_hits == 1


def test_functions_of_two_laws_have_different_names_in_compiled_code(toy):
    """Of equal names, with which processes compile them, one that loads both would take the first."""
    toy[0]()  # nothing is compiled yet
    v, z = sympy.symbols("v z")

    def names(law):
        structure = sl.Hysteretic(0.5, 0.05, 0.1, yield_displacement=0.02, law=law)
        code = by_number((structure.step(),)).inspect_llvm()
        found = re.findall(r'^define .*?@"?([^"( ]+)', code, re.M)
        # numba's own number of a function in its process is left out
        return {re.sub(r"B\d+v\d+", "", name) for name in found if "NRT" not in name}

    one, other = names(v - 1.25 * abs(v) * z), names(v * (1 - 1.5 * z**2))
    assert any("advance" in name for name in one)
    assert not one & other
