"""The page on large tables: its programs go on where they stopped; the rest of the page runs."""

import os
import re
import runpy
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from scipy.constants import g

import stochlin as sl

pytestmark = [pytest.mark.cli, pytest.mark.slow]

for extra in ("distributed", "zarr"):
    pytest.importorskip(extra, reason=f"{extra} is in the extra 'scale'")

PAGE = Path(__file__).parents[2] / "docs" / "large_tables.md"
PROGRAM, GENERATOR, DISTRICT, *REST = re.findall(
    r"^```python\n(.*?)^```", PAGE.read_text(encoding="utf-8"), re.DOTALL | re.M
)
SIZE = "SIZE, BLOCK = 10_000, 1000"
SMALL = "SIZE, BLOCK = 60, 6"
ROWS = 10
LONGEST = 300.0  # s
PAIRS = 60
SMALL_BLOCK = "BLOCK = 1000", "BLOCK = 6"
UNKNOWN = 2  # a pair without a period
CHECKED = [1, 4, 6, 7, 13]  # pairs on two grounds, without caution


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


def copied(folder: Path) -> Path:
    """A folder with the programs of the district and its pairs, one of which is not known."""
    folder.mkdir()
    assert SMALL_BLOCK[0] in DISTRICT
    (folder / "make_district.py").write_text(GENERATOR, encoding="utf-8")
    (folder / "district.py").write_text(DISTRICT.replace(*SMALL_BLOCK), encoding="utf-8")
    subprocess.run([sys.executable, "make_district.py", str(PAIRS)], cwd=folder, check=True)
    rows = pd.read_csv(folder / "district.csv")
    rows.loc[UNKNOWN, "period_2"] = np.nan
    rows.to_csv(folder / "district.csv", index=False)
    return folder


def started(folder: Path) -> "subprocess.Popen[bytes]":
    command = [sys.executable, "-W", "error", "district.py"]
    return subprocess.Popen(command, cwd=folder, start_new_session=True, stdout=subprocess.DEVNULL)


@pytest.fixture(scope="module")
def district(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder in which the program was killed and started again."""
    folder = copied(tmp_path_factory.mktemp("district") / "killed")
    parts, end = folder / "parts", time.monotonic() + LONGEST
    program = started(folder)
    while not [*parts.glob("*.csv")]:
        assert program.poll() is None
        assert time.monotonic() < end
        time.sleep(0.01)
    os.killpg(program.pid, signal.SIGKILL)  # with its workers
    program.wait()
    before = {path: path.stat().st_mtime_ns for path in parts.glob("*.csv")}
    assert 0 < len(before) < PAIRS // 6
    assert not (folder / "gaps.csv").exists()
    assert started(folder).wait(LONGEST) == 0
    assert all(path.stat().st_mtime_ns == at for path, at in before.items())
    return folder


@pytest.mark.skipif(not hasattr(os, "killpg"), reason="kills a group of processes")
def test_the_gaps_of_a_district_are_the_same_after_it_was_killed(district: Path) -> None:
    whole = copied(district.parent / "whole")
    assert started(whole).wait(LONGEST) == 0
    for name in ("gaps.csv", *(f"parts/{path.name}" for path in (whole / "parts").iterdir())):
        assert (district / name).read_bytes() == (whole / name).read_bytes(), name
    gaps = pd.read_csv(whole / "gaps.csv", index_col="id")
    assert gaps.index.tolist() == pd.read_csv(whole / "district.csv").id.tolist()
    assert np.flatnonzero(gaps.isna().any(axis=1)).tolist() == [UNKNOWN]
    assert gaps.status.tolist() == [3 if n == UNKNOWN else 0 for n in range(PAIRS)]
    assert gaps.pounds_in_design_motion.dropna().between(0, 1).all()


@pytest.mark.oracle
@pytest.mark.skipif(not hasattr(os, "killpg"), reason="kills a group of processes")
def test_five_rows_of_the_district_agree_with_simulation(district: Path) -> None:
    """Within 15 % of the gap, .1 of the probability, a factor of 1.5 of the annual frequency."""
    program = runpy.run_path(str(district / "district.py"))
    rows, gaps = (pd.read_csv(district / name) for name in ("district.csv", "gaps.csv"))
    for place in CHECKED:
        row, found = rows.loc[place], gaps.loc[place]
        gap, pounds, rate = by_simulation(row, program)
        assert found.caution == 0
        assert found.required_gap == pytest.approx(gap, rel=0.15)
        assert found.pounds_in_design_motion == pytest.approx(pounds, abs=0.1)
        assert 1 / 1.5 < found.pounds_in_a_year / rate < 1.5
        numbers = f"{found.required_gap:.3f} | {gap:.3f} | {found.pounds_in_design_motion:.2f}"
        numbers += f" | {pounds:.2f} | {1e3 * found.pounds_in_a_year:.1f} | {1e3 * rate:.1f}"
        assert f"| `{row.id}` | {row.ground} | {row.gap} | {numbers} |" in PAGE.read_text(
            encoding="utf-8"
        )


def by_simulation(row: Any, program: dict[str, Any]) -> tuple[float, float, float]:
    """Gap, probability of pounding in the motion of the design, and annual frequency of a pair."""
    pair = [
        sl.Bilinear(
            row[f"period_{n}"],
            row[f"damping_{n}"],
            row[f"hardening_{n}"],
            yield_displacement=row[f"base_shear_{n}"] * g * (row[f"period_{n}"] / (2 * np.pi)) ** 2,
        )
        for n in (1, 2)
    ]
    on_soil, rock = program["SOILS"][row.ground], program["ON_ROCK"]
    motion = {"duration": program["DURATION"], "envelope": program["ENVELOPE"]}
    ground = sl.scale_ground(sl.named_ground(row.ground), **motion, pga=on_soil * program["DESIGN"])
    hazard = sl.HazardCurve([on_soil * pga for pga in rock.intensities], rock.frequencies)
    gap = sl.separation(*pair, ground, **motion, paths=2048).gap.sel(rule="simulation")
    pounds = sl.pounding_probability(*pair, ground, row.gap, **motion, paths=2048)
    rate = sl.pounding_risk(*pair, ground, row.gap, hazard, **motion, paths=512).annual_rate
    stays = pounds.confidence_of_no_pounding_simulated
    return float(gap), 1 - float(stays), float(rate)
