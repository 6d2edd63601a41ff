"""Compiled functions on the disk: nothing that befalls their folder stops or changes them."""

import importlib.util
import os
import re
import subprocess
import sys
from contextlib import contextmanager

import numba
import pytest
import sympy
from commands import process

import stochlin as sl
from stochlin import messages
from stochlin.files import folders
from stochlin.kernels.basics import compiled
from stochlin.kernels.basics.children import command, environment
from stochlin.kernels.simulation.laws import by_number

pytestmark = [
    pytest.mark.invariant,
    pytest.mark.skipif(compiled.UNCOMPILED, reason="NUMBA_DISABLE_JIT is set: nothing is compiled"),
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


def forget():
    """What a process knows that has just begun."""
    for cached in (compiled.warn_once, compiled.code_folder, folders.process_folder):
        cached.cache_clear()


OF_ONE = numba.float64(numba.float64)


def law_times(factor, name="double"):
    """A law as a process finds it that has just begun."""

    def law(x):
        return factor * x

    law.__qualname__ = name
    forget()
    return compiled.c_function(law, OF_ONE)


@pytest.fixture
def toy(tmp_path, monkeypatch):
    """The functions as a process finds them that has just begun; and the place of their folder."""
    sources, place = tmp_path / "kernels", tmp_path / "cache" / "stochlin"
    for folder in (sources, place.parent):
        folder.mkdir()
    (sources / "toy.py").write_text(TOY)
    (sources / "inner.py").write_text(INNER)
    monkeypatch.setattr(compiled, "KERNELS", sources)
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
    """Twice a number, in a process just begun; and how often compiled code was ready for it."""

    def double(x):
        if request.param == "law":
            law = law_times(2.0)
            return law(x), law.cache_hits
        twice = toy[0]()
        return twice(x), hits(twice)

    return double


def test_compiled_code_is_loaded_and_only_a_compilation_is_announced(toy, doubled, monkeypatch):
    calls = []
    monkeypatch.setattr(compiled, "WHEN_COMPILING", [lambda: calls.append(1)])
    assert doubled(1.5) == (3.0, 0)
    assert doubled(1.5) == (3.0, 1)
    assert len(calls) == 1


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


def test_without_a_folder_it_runs_and_says_so_once(toy, doubled, tmp_path, monkeypatch):
    """A file where the folder should be: not even root makes any there."""
    toy[1].write_text("in the way")
    with pytest.warns(UserWarning, match="folder that can be written") as messages:
        assert doubled(1.5) == (3.0, 0)
    assert len(messages) == 1
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path / "elsewhere"))
    assert doubled(1.5) == (3.0, 0)
    assert list((tmp_path / "elsewhere").rglob("*.nbc"))


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


def test_a_full_disk_harms_nothing(doubled):
    for stored in (False, True):
        if not stored:
            with full_disk(), pytest.warns(UserWarning, match="the disk is full"):
                assert doubled(1.5) == (3.0, 0)
        else:
            with full_disk():
                assert doubled(1.5) == (3.0, 1)
        assert doubled(1.5) == (3.0, stored)


def test_folders_of_earlier_versions_are_removed_and_what_others_have_put_there_stays(toy):
    begun, place = toy
    names = "kernels-thesis", "kernels-0123456789abcdef", "kernels-of-version-1"
    for folder in (place, place.parent):
        folder.mkdir(exist_ok=True)
        for name in names:
            (folder / name).mkdir()
    os.close(folders.mark(place / names[2]))
    for name in names:
        os.utime(place / name, (1e9, 1e9))
    assert begun()(1.5) == 3.0
    assert {path.name for path in place.parent.iterdir()} == {*names, "stochlin"}
    assert {*names[:2]} < {path.name for path in place.iterdir()}
    assert not (place / names[2]).exists()


def test_a_folder_that_others_can_write_is_not_used(toy, tmp_path, monkeypatch):
    """Nor one with a file that they can, or below a folder in which they can rename it."""
    begun, place = toy
    program = tmp_path / "program"
    monkeypatch.setattr(compiled, "PROGRAM_CACHE", program)
    assert begun()(1.5) == 3.0
    assert not program.exists()
    (folder,) = place.glob("kernels-*")
    planted = folder / "planted.nbi"
    planted.touch()
    for path in (place.parent, place, folder, planted):
        mode = path.stat().st_mode
        path.chmod(mode | 0o002)
        with pytest.warns(UserWarning, match="since others could put code there") as messages:
            assert begun()(1.5) == 3.0
        assert len(messages) == 1
        assert list(program.glob("kernels-*"))
        path.chmod(mode)
    planted.unlink()
    place.parent.chmod(0o1777)  # others can rename there what is theirs
    twice = begun()
    assert twice(1.5) == 3.0
    assert hits(twice) == 1


@pytest.mark.parametrize("entry", ["a mark", "no mark", "another mark", "a link"])
def test_only_what_is_marked_inside_is_removed(tmp_path, entry):
    """Not a name alone, nor the mark of a folder of another name."""
    folder = tmp_path / "stochlin-examples"
    marked = folder if entry == "a mark" else tmp_path / "stochlin-others"
    for path in {folder, marked}:
        path.mkdir()
        (path / "results.csv").write_text("three days of results")
    if entry != "no mark":
        os.close(folders.mark(marked))
    if entry == "another mark":
        (marked / folders.MARK).rename(folder / folders.MARK)
    if entry == "a link":
        folder.rename(tmp_path / "elsewhere")
        folder.symlink_to(marked)
        marked.rename(tmp_path / "moved")
        folder.unlink()
        folder.symlink_to(tmp_path / "moved")
    folders.remove_left(tmp_path, "stochlin-")
    assert folder.exists() is (entry != "a mark")


def test_no_mark_is_waited_for(tmp_path):
    """A pipe in its place, which another user may put into a shared folder, has no end."""
    for name in ("stochlin-1", "stochlin-2"):
        (tmp_path / name).mkdir()
    os.mkfifo(tmp_path / "stochlin-1" / folders.MARK)
    (tmp_path / "stochlin-2" / folders.MARK).mkdir()
    program = f"from stochlin.files.folders import *; remove_left(Path({str(tmp_path)!r}), '')"
    done = process(tmp_path, {}, "-c", program)
    assert done.returncode == 0, done.stderr
    assert len([*tmp_path.iterdir()]) == 2


def test_the_folder_of_code_has_no_link_in_its_path(tmp_path, monkeypatch):
    """The owner of a link might turn it elsewhere after a look at the folder."""
    (tmp_path / "mine").mkdir(mode=0o700)
    (tmp_path / "link").symlink_to(tmp_path / "mine")
    monkeypatch.setattr(compiled.CONFIG, "CACHE_DIR", str(tmp_path / "link"))
    forget()
    folder = compiled.code_folder()
    forget()
    assert folder.is_dir()
    assert str(folder) == os.path.realpath(folder)


def test_a_child_runs_the_package_of_its_parent(tmp_path):
    """Also where `sys.path` has another one before it."""
    (tmp_path / "stochlin").mkdir()
    (tmp_path / "stochlin" / "__init__.py").write_text("raise ImportError('another one')")
    program = (
        "import stochlin, stochlin.messages as inner; print(stochlin.__file__, inner.__file__)"
    )
    variables = environment({"PYTHONPATH": str(tmp_path)})
    done = subprocess.run(
        command(program), env=variables, capture_output=True, text=True, check=True
    )
    assert done.stdout.split() == [sl.__file__, messages.__file__]


def test_a_folder_in_use_stays_and_one_of_an_ended_process_goes(tmp_path):
    folder = tmp_path / "stochlin-1"
    folder.mkdir()
    handle = folders.mark(folder)
    folders.remove_left(tmp_path, "stochlin-")
    assert folder.exists()
    os.close(handle)
    folders.remove_left(tmp_path, "stochlin-")
    assert not folder.exists()


ENDS = """
import os, sys
from stochlin.files.folders import process_folder
process_folder()
if sys.argv[1] == "killed":
    os.kill(os.getpid(), 9)
if os.fork() == 0:
    sys.exit()
os.wait()
print(*os.listdir(os.environ["TMPDIR"]))
"""


@pytest.mark.skipif(
    not hasattr(os, "fork"), reason="Windows has neither forks nor locks of folders"
)
def test_processes_remove_their_own_temporary_folder_and_those_of_killed_ones(tmp_path):
    def run(argument):
        return process(tmp_path, {"TMPDIR": str(tmp_path)}, "-c", ENDS, argument).stdout.split()

    run("killed")
    (left,) = os.listdir(tmp_path)
    (of_parent,) = run("after its child")
    assert of_parent != left
    assert not os.listdir(tmp_path)


def test_a_law_is_never_taken_for_another(toy):
    """What a law contains counts beside its name."""
    for factor, name in ((2.0, "double"), (3.0, "triple"), (4.0, "double")):
        assert law_times(factor, name).cache_hits == 0
        assert law_times(factor, name).cache_hits == 1


def test_functions_of_two_laws_have_different_names_in_compiled_code(toy):
    """Of equal names, with which processes compile them, one loading both would take the first."""
    toy[0]()  # nothing is compiled yet, since numba shows no code that it has loaded
    v, z = sympy.symbols("v z")

    def structure(law):
        return sl.Hysteretic(0.5, 0.05, 0.1, yield_displacement=0.02, law=law)

    def names(law):
        code = by_number((structure(law).step(),)).inspect_llvm()
        defined = re.findall(r'^define .*?@"?([^"( ]+)', code, re.M)
        # numba's own number of a function in its process is left out
        return {re.sub(r"B\d+v\d+", "", name) for name in defined if "NRT" not in name}

    first, second = names(v - 1.25 * abs(v) * z), names(v * (1 - 1.5 * z**2))
    assert any("chosen" in name for name in first)
    assert not first & second
    known = structure(v - 1.25 * abs(v) * z)._compiled
    after_others = type(known).step.func(
        known
    )  # as a process makes it that has met other laws before
    assert by_number((after_others,)).cache_hits == 1
