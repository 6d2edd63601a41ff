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
