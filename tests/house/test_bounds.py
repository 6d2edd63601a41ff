"""Compiled functions stay within their arrays: numba checks every index where it is told to."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from stochlin.kernels.basics.compiled import UNCOMPILED

pytestmark = [
    pytest.mark.invariant,
    pytest.mark.skipif(UNCOMPILED, reason="NUMBA_DISABLE_JIT is set: Python checks every index"),
]

TESTS = Path(__file__).parents[1]
FUNCTIONS = """
from stochlin.kernels.basics.compiled import called_often, compiled, entry

@entry
def alone(x, i):
    return x[i]

@compiled
def inner(x, i):
    return x[i]

@entry
def calls(x, i):
    return inner(x, i)

@called_often
def inlined(x, i):
    return x[i]

@entry
def calls_often(x, i):
    return inlined(x, i)
"""
PROGRAM = """
import numpy as np, functions
x = np.arange(10.0)[:3]  # what lies beyond belongs to it, so that reading it does no harm
for function in (functions.alone, functions.calls, functions.calls_often):
    assert function(x, 2) == 2.0
    try:
        print(function(x, 5))
    except IndexError as error:
        print(error)
"""


def process(place: Path, checked: bool, *command: str) -> subprocess.CompletedProcess[str]:
    """A Python process with compiled code in a folder of its own."""
    env = {name: value for name, value in os.environ.items() if name != "NUMBA_BOUNDSCHECK"}
    env |= {"NUMBA_CACHE_DIR": str(place), "OPENBLAS_NUM_THREADS": "1"}
    env |= {"NUMBA_BOUNDSCHECK": "1"} if checked else {}
    paths = [str(place.parent), str(TESTS.parent), str(TESTS), env.get("PYTHONPATH", "")]
    return subprocess.run(
        [sys.executable, *command],
        env=env | {"PYTHONPATH": os.pathsep.join(paths)},
        cwd=TESTS.parent,
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.mark.slow
def test_an_index_out_of_range_raises_in_checked_code_only_and_both_are_kept_apart(tmp_path):
    (tmp_path / "functions.py").write_text(FUNCTIONS)
    place = tmp_path / "cache"
    for times in range(2):
        for checked, told in ((False, "5.0\n"), (True, "index is out of bounds\n")):
            done = process(place, checked, "-c", PROGRAM)
            assert done.returncode == 0, done.stderr
            assert done.stdout == 3 * told, (times, checked)
    folders = sorted((place / "stochlin").iterdir())
    assert len(folders) == 2
    names = [sorted(file.name for file in folder.rglob("*.nbi")) for folder in folders]
    assert names[0] == names[1]
    assert len(names[0]) == 3


@pytest.mark.slow
@pytest.mark.parametrize(
    "files",
    [
        "simulation/test_stepping.py simulation/test_contacts.py simulation/test_laws.py",
        "pounding/test_forces.py pounding/test_linked.py",
    ],
    ids=["simulation", "pounding"],
)
def test_time_steps_stay_within_their_arrays(files, tmp_path):
    """An error in a law of a user, which is called as C, is a warning, and warnings are errors."""
    options = ["-p", "no:cacheprovider", "-p", "no:xdist", "-m", "not slow"]
    paths = [str(TESTS / file) for file in files.split()]
    done = process(tmp_path / "cache", True, "-m", "pytest", *options, *paths)
    assert done.returncode == 0, done.stdout[-4000:]
    assert int(re.search(r"(\d+) passed", done.stdout).group(1)) > 20
