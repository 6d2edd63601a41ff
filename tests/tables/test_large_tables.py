"""The page on large tables: its program goes on where it stopped, and the rest of the page runs."""

import re
import subprocess
import sys
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


def test_the_program_writes_its_table_goes_on_and_the_rest_of_the_page_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A second run after a row is lost writes that row alone."""
    assert SIZE in PROGRAM
    (tmp_path / "large_table.py").write_text(PROGRAM.replace(SIZE, SMALL), encoding="utf-8")
    rows = tmp_path / "written"
    for lost in (None, rows / "0"):
        before = {path: path.stat().st_mtime_ns for path in rows.glob("*") if path != lost}
        if lost is not None:
            lost.unlink()
        command = [sys.executable, "-W", "error", "large_table.py"]
        subprocess.run(command, cwd=tmp_path, timeout=LONGEST, check=True)
        assert len([*rows.iterdir()]) == ROWS
        assert all(path.stat().st_mtime_ns == at for path, at in before.items())
    monkeypatch.chdir(tmp_path)
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
