"""Commands where nothing is compiled, and where nothing can be kept."""

import os
from pathlib import Path

import pytest
import xarray as xr
from cases import example_case
from commands import answered, process

pytestmark = pytest.mark.cli

UNCOMPILED = {"NUMBA_DISABLE_JIT": "1"}

YIELDING = (
    "--period-1",
    ".7s",
    "--period-2",
    "1s",
    "--hardening",
    ".05",
    "--reduction-factor",
    "4",
)
RHO = ["rho", *YIELDING]
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


@pytest.mark.slow
def test_what_is_not_compiled_gives_the_same_numbers_and_says_that_it_is_slow(
    tmp_path: Path,
) -> None:
    path, table = tmp_path / "case.toml", tmp_path / "pound.nc"
    path.write_text(case(example_case()), encoding="utf-8")
    (tmp_path / "wave.txt").write_text("\n".join(f"{0.1 * (n % 7 - 3):g}" for n in range(50)))
    pound = ("pound", str(path), "--out", str(table))
    for command in (pound, ("warmup",)):
        done = process(tmp_path, UNCOMPILED, "-m", "stochlin", *command)
        said = done.stdout + done.stderr
        assert done.returncode == 0, said
        assert "NUMBA_DISABLE_JIT is set: nothing is compiled" in said
        assert "overflow" not in said
    plain = xr.load_dataset(table)
    answered(*pound)
    xr.testing.assert_allclose(plain, xr.load_dataset(table), rtol=1e-6)


@pytest.mark.slow
def test_what_would_take_hours_uncompiled_is_refused_at_once(tmp_path: Path) -> None:
    simulated = [*RHO, "--method", "simulation", "--paths", "100000"]
    done = process(tmp_path, UNCOMPILED, "-m", "stochlin", *simulated)
    assert done.returncode == 2
    assert "NUMBA_DISABLE_JIT is set: nothing is compiled" in done.stderr
    assert "allowed: 15 minutes on this machine" in done.stderr
    assert "or unset NUMBA_DISABLE_JIT" in done.stderr


@pytest.mark.slow
def test_warmup_says_that_it_is_in_vain(tmp_path: Path) -> None:
    done = process(tmp_path, {"NUMBA_CACHE_DIR": os.devnull}, "-m", "stochlin", "warmup")
    assert done.returncode == 1
    assert "NUMBA_CACHE_DIR to a folder that can be written" in done.stderr
