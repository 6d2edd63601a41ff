"""Commands where nothing is compiled, where nothing can be kept, and on one core."""

import json
import os
import subprocess
from pathlib import Path
from typing import Any

import pytest
import xarray as xr
from cases import example_case
from commands import answered, process

pytestmark = pytest.mark.cli

UNCOMPILED = {"NUMBA_DISABLE_JIT": "1"}
ONE_CORE = {"NUMBA_NUM_THREADS": "1"}

COMMANDS = """
import json, os, sys
from click.testing import CliRunner
if "NUMBA_NUM_THREADS" in os.environ and hasattr(os, "sched_setaffinity"):
    os.sched_setaffinity(0, [min(os.sched_getaffinity(0))])
from stochlin.views.command import main
for command in json.loads(sys.argv[1]):
    done = CliRunner().invoke(main, command)
    assert done.exit_code == 0, (command, done.output)
    print(done.output)
"""
YIELDING = ("--period-1", ".7s", "--period-2", "1s", "--hardening", ".05", "--reduction-factor", "4")
SIMULATED = ("--method", "simulation", "--paths", "32", "--out", "table.nc")
RHO = ["rho", *YIELDING]
CASE = [[command, "case.toml"] for command in ("gap", "probability", "pound")]
SHORTER = {
    "paths = 2048": "paths = 100",
    'duration = "20 s"': 'duration = "1.2 s"',
    'rise_end = "4 s"': 'rise_end = "0.2 s"',
    'strong_end = "15 s"': 'strong_end = "1 s"',
    "[motion]": '[[site.records]]\npath = "wave.txt"\nunits = "g"\ndt = "0.02 s"\n[motion]',
}


def case(text: str) -> str:
    """The example of a case file, made short, with a record."""
    for long, short in SHORTER.items():
        text = text.replace(long, short, 1)
    return text


def ran(folder: Path, setting: dict[str, str], commands: list[Any]) -> subprocess.CompletedProcess[str]:
    """A process in which these commands end well, one after another."""
    (folder / "case.toml").write_text(case(example_case()), encoding="utf-8")
    (folder / "wave.txt").write_text("\n".join(f"{0.1 * (n % 7 - 3):g}" for n in range(50)))
    done = process(folder, setting, "-c", COMMANDS, json.dumps(commands))
    assert done.returncode == 0, done.stdout + done.stderr
    return done


@pytest.mark.slow
def test_what_is_not_compiled_gives_the_same_numbers_and_says_that_it_is_slow(tmp_path: Path) -> None:
    done = ran(tmp_path, UNCOMPILED, [["pound", "case.toml", "--out", "pound.nc"], ["warmup"]])
    assert done.stdout.count("NUMBA_DISABLE_JIT is set: nothing is compiled") == 2
    assert "overflow" not in done.stdout + done.stderr
    with xr.open_dataset(tmp_path / "pound.nc") as table:
        plain = table.load()
    again = [str(tmp_path / "case.toml"), "--out", str(tmp_path / "pound.nc")]
    answered("pound", *again)
    with xr.open_dataset(tmp_path / "pound.nc") as table:
        xr.testing.assert_allclose(plain, table, rtol=1e-6)


@pytest.mark.slow
def test_what_would_take_hours_uncompiled_is_refused_at_once(tmp_path: Path) -> None:
    simulated = [*RHO, "--method", "simulation", "--paths", "100000"]
    done = process(tmp_path, UNCOMPILED, "-m", "stochlin", *simulated)
    assert done.returncode == 2
    assert "NUMBA_DISABLE_JIT is set: nothing is compiled" in done.stderr
    assert "allowed: 15 minutes on this machine" in done.stderr
    assert "or unset NUMBA_DISABLE_JIT" in done.stderr


@pytest.mark.slow
def test_commands_run_on_one_core(tmp_path: Path) -> None:
    ran(tmp_path, ONE_CORE, [RHO, [*RHO, *SIMULATED], *CASE])


@pytest.mark.slow
def test_warmup_says_that_it_is_in_vain(tmp_path: Path) -> None:
    done = process(tmp_path, {"NUMBA_CACHE_DIR": os.devnull}, "-m", "stochlin", "warmup")
    assert done.returncode == 1
    assert "NUMBA_CACHE_DIR to a folder that can be written" in done.stderr
