"""Compiled functions stay within their arrays: numba checks every index where it is told to."""

import re
from pathlib import Path

import pytest
from commands import process

from stochlin.kernels.basics.compiled import UNCOMPILED

pytestmark = [
    pytest.mark.invariant,
    pytest.mark.skipif(UNCOMPILED, reason="NUMBA_DISABLE_JIT is set: Python checks every index"),
]

TESTS = Path(__file__).parents[1]
FUNCTION = """
import numpy as np
from stochlin.kernels.basics.compiled import called_often, entry

@called_often
def inlined(x, i):
    return x[i]

@entry
def function(x, i):
    return inlined(x, i)

try:
    # What lies beyond belongs to the array, so that reading it does no harm.
    print(function(np.arange(10.0)[:3], 5))
except IndexError as error:
    print(error)
"""


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
    setting = {"NUMBA_BOUNDSCHECK": "1", "NUMBA_CACHE_DIR": str(tmp_path / "cache")}
    done = process(TESTS.parent, setting, "-m", "pytest", *options, *paths)
    assert done.returncode == 0, done.stdout[-4000:]
    assert int(re.search(r"(\d+) passed", done.stdout).group(1)) > 10


@pytest.mark.slow
def test_an_index_out_of_range_raises_in_checked_code(tmp_path):
    (tmp_path / "function.py").write_text(FUNCTION)
    for checked, shown in ((False, "5.0"), (True, "index is out of bounds")):
        setting = {"NUMBA_CACHE_DIR": str(tmp_path), **({"NUMBA_BOUNDSCHECK": "1"} if checked else {})}
        assert process(tmp_path, setting, "function.py").stdout.strip() == shown
    assert len(list((tmp_path / "stochlin").iterdir())) == 2  # both are stored apart
