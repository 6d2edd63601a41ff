"""The page on large tables: its program is killed and goes on, and the rest of the page runs."""

import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import stochlin as sl

pytestmark = [pytest.mark.cli, pytest.mark.slow]

for extra in ("distributed", "zarr"):
    pytest.importorskip(extra, reason=f"{extra} is in the extra 'scale'")

PAGE = Path(__file__).parents[2] / "docs" / "large_tables.md"
PROGRAM, *REST = re.findall(r"^```python\n(.*?)^```", PAGE.read_text(encoding="utf-8"), re.DOTALL | re.M)
SIZE = "SIZE, BLOCK = 10_000, 1000"
SMALL = "SIZE, BLOCK = 60, 6"
ROWS = 10
LONGEST = 300.0  # s


def started(folder: Path) -> subprocess.Popen[bytes]:
    """The program of the page in this folder, with a table that is small."""
    assert SIZE in PROGRAM
    folder.mkdir(exist_ok=True)
    (folder / "large_table.py").write_text(PROGRAM.replace(SIZE, SMALL), encoding="utf-8")
    command = [sys.executable, "-W", "error", "large_table.py"]
    places = os.pathsep.join([str(Path(sl.__file__).parents[1]), *filter(None, sys.path)])
    return subprocess.Popen(
        command, cwd=folder, env={**os.environ, "PYTHONPATH": places}, start_new_session=True
    )


def files(folder: Path) -> dict[str, bytes]:
    found = (path for path in folder.rglob("*") if path.is_file())
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in found}


def test_a_program_that_was_killed_goes_on_and_leaves_the_same_bytes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole, stopped = tmp_path / "whole", tmp_path / "stopped"
    assert started(whole).wait(LONGEST) == 0
    process, begin = started(stopped), time.monotonic()
    while not (stopped / "written" / "0").exists():
        assert process.poll() is None
        assert time.monotonic() - begin < LONGEST
        time.sleep(0.002)
    os.killpg(process.pid, signal.SIGKILL)  # with its workers
    process.wait()
    assert 0 < len(files(stopped / "written")) < ROWS
    assert started(stopped).wait(LONGEST) == 0
    assert len(files(stopped / "written")) == ROWS
    assert files(stopped / "table.zarr") == files(whole / "table.zarr")

    monkeypatch.chdir(stopped)
    namespace: dict[str, object] = {}
    for block in REST:
        exec(compile(block, PAGE.name, "exec"), namespace)
    periods = np.geomspace(0.1, 10.0, 60)
    axes = [xr.DataArray(periods, {name: periods}, [name]) for name in ("period_1", "period_2")]
    pair = [sl.Bilinear(axis, 0.05, 0.05, reduction_factor=4.0) for axis in axes]
    expected = sl.correlate(*pair, sl.KanaiTajimi(1.0, 0.3))
    table = namespace["table"]
    assert isinstance(table, xr.Dataset)
    for name in table.data_vars:
        np.testing.assert_allclose(table[name], expected[name], rtol=1e-12, atol=1e-14)
