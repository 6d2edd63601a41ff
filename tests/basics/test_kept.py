"""Compiled functions that are kept on the disk: nothing that befalls it stops or changes them."""

import importlib.util
import os
import re
import shutil
import subprocess
import sys
import time
import warnings
import zipfile

import numba
import pytest
import sympy

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
# Each process calls it with arguments of these kinds.
RACE = """
import sys, numpy as np, toy
kinds = [1, 1.0, 1 + 0j, np.ones(3)]
for n in map(int, sys.argv[1:]):
    assert np.all(toy.twice(kinds[n]) == 2), n
    assert type(toy.twice(kinds[n])) is type(kinds[n]), n
print(sum(toy.twice.dispatcher.stats.cache_hits.values()))
"""


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
        for cached in (kept.warn_once, kept.archives, kept._of_process):
            cached.cache_clear()
        monkeypatch.delitem(sys.modules, "inner", raising=False)
        importlib.invalidate_caches()
        spec = importlib.util.spec_from_file_location("toy", sources / "toy.py")
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        return module.twice

    yield begun, place
    for cached in (kept.archives, kept._of_process):
        cached.cache_clear()


def hits(function):
    return sum(function.dispatcher.stats.cache_hits.values())


def test_what_is_kept_is_found_again(toy):
    begun, place = toy
    for expected in (0, 1):
        twice = begun()
        assert twice(1.5) == 3.0
        assert hits(twice) == expected
    assert len(list(place.glob("kernels-*/*.zip"))) == 1


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
    "cut at the end": lambda data: data[:-1],
    "a flipped bit": flipped,
    "zeros": lambda data: bytes(len(data)),
}


@pytest.mark.parametrize("kind", BROKEN)
def test_a_broken_archive_is_replaced(toy, kind):
    begun, place = toy
    begun()(1.5)
    (file,) = place.glob("kernels-*/*.zip")
    file.write_bytes(BROKEN[kind](file.read_bytes()))
    for expected in (0, 1):
        twice = begun()
        assert twice(1.5) == 3.0
        assert hits(twice) == expected


def test_kinds_of_arguments_are_kept_side_by_side(toy):
    begun, place = toy
    assert begun()(1.5) == 3.0
    assert begun()(1j) == 2j
    twice = begun()
    assert twice(1.5) == 3.0
    assert twice(1j) == 2j
    assert hits(twice) == 2
    (file,) = place.glob("kernels-*/*.zip")
    assert sum(name.endswith(".nbc") for name in zipfile.ZipFile(file).namelist()) == 2


def test_without_a_folder_it_runs_and_says_so_once(toy, tmp_path, monkeypatch):
    """A file where the folder should be: not even root makes any there."""
    begun, place = toy
    place.write_text("in the way")
    with pytest.warns(UserWarning, match="folder that can be written"):
        twice = begun()
    assert twice(1.5) == 3.0  # another warning would be an error
    assert twice(1j) == 2j
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path / "elsewhere"))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert begun()(1.5) == 3.0
    assert list((tmp_path / "elsewhere").rglob("*.zip"))


def test_a_folder_that_can_no_longer_be_written_does_not_stop_it(toy):
    begun, place = toy
    twice = begun()
    (folder,) = place.iterdir()
    folder.rmdir()
    folder.write_text("in the way")
    with pytest.warns(UserWarning, match="the disk is full"):
        assert twice(1.5) == 3.0
    assert twice(1) == 2  # another warning would be an error


def test_a_folder_of_the_process_that_was_removed_is_made_again(toy):
    begun, _ = toy
    twice = begun()
    assert twice(1.5) == 3.0
    shutil.rmtree(kept._of_process())
    assert twice(1j) == 2j
    assert begun()(1j) == 2j


def test_what_others_have_put_beside_it_stays(toy):
    begun, place = toy
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


@pytest.mark.slow
def test_eight_processes_that_begin_at_once_agree(toy):
    _, place = toy
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(place.parent)}
    environment["PYTHONPATH"] = os.pathsep.join(
        [str(place.parents[1] / "kernels"), *filter(None, sys.path)]
    )

    def process(*numbers):
        command = [sys.executable, "-c", RACE, *map(str, numbers)]
        return subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True)

    for one in [process(n % 4, (n + 1) % 4) for n in range(8)]:
        one.communicate()
        assert one.returncode == 0
    for expected in (None, "4\n"):  # what processes have replaced is compiled again, once
        told = process(0, 1, 2, 3).communicate()[0]
        assert expected in (None, told)


def law_times(factor):
    def law(x):
        return factor * x

    return law


def begun_law(factor, name):
    """A law as a process finds it that has just begun."""
    for cached in (kept.warn_once, kept.archives, kept._of_process):
        cached.cache_clear()
    return kept.kept_law(law_times(factor), numba.float64(numba.float64), name)


def test_a_law_is_found_again_by_its_name_and_never_taken_for_another(toy):
    _, place = toy
    for hit in (0, 1):
        for factor, name in ((2.0, "double"), (3.0, "triple")):
            law = begun_law(factor, name)
            assert law(1.5) == factor * 1.5
            assert law.cache_hits == hit
    same = begun_law(4.0, "double")  # what a law contains counts, too
    assert same(1.5) == 6.0
    assert len(list(place.glob("kernels-*/law-*.zip"))) == 2


@pytest.mark.parametrize("kind", BROKEN)
def test_a_broken_archive_of_a_law_is_replaced(toy, kind):
    _, place = toy
    begun_law(2.0, "double")
    (file,) = place.glob("kernels-*/law-*.zip")
    file.write_bytes(BROKEN[kind](file.read_bytes()))
    for hit in (0, 1):
        law = begun_law(2.0, "double")
        assert law(1.5) == 3.0
        assert law.cache_hits == hit


def test_laws_that_were_not_used_for_a_day_are_removed(toy):
    _, place = toy
    begun_law(2.0, "double")
    (old,) = place.glob("kernels-*/law-*.zip")
    begun_law(3.0, "triple")
    two_days_ago = time.time() - 2 * kept.DAY
    os.utime(old, (two_days_ago, two_days_ago))
    begun_law(4.0, "fourfold")
    assert not old.exists()
    assert len(list(place.glob("kernels-*/law-*.zip"))) == 2


def test_a_law_runs_without_a_folder_and_says_so_once(toy):
    _, place = toy
    place.write_text("in the way")
    with pytest.warns(UserWarning, match="folder that can be written"):
        law = begun_law(2.0, "double")
    assert law(1.5) == 3.0


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
