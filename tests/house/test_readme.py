"""What the README and the page of commands show works as printed."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import numpy as np
import pytest
from cases import FEW_MOTIONS, recorded_example, with_slow
from click.testing import CliRunner

import stochlin as sl
from stochlin.views.command import main

pytestmark = pytest.mark.cli

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
CALLS = (ROOT / "docs" / "calls.md").read_text(encoding="utf-8")


def blocks(text: str, language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", text, re.DOTALL | re.MULTILINE)


def command_lines() -> list[str]:
    text = "".join(blocks(README, "") + blocks(CALLS, "sh")).replace("\\\n", " ")
    lines = [line.split("  #")[0].strip() for line in text.splitlines() if line.startswith("stochlin ")]
    assert set(lines) >= ELSEWHERE
    return sorted(set(lines) - ELSEWHERE)


ELSEWHERE = {
    "stochlin warmup",  # it would compile everything
    "stochlin charts",  # tests/house/test_command.py
}
LONG = {
    "stochlin gap case.toml --report gap.html",
    "stochlin gap case.toml --report gap.html --out gap.nc",
    "stochlin mitigate case.toml --picture measures.png",
    "stochlin pound case.toml --motions 100",  # there is one with a picture
    "stochlin verify fig4b --points 9 --paths 64",  # tests/correlation/test_simulated.py
}


@pytest.mark.parametrize("line", with_slow(command_lines(), LONG))
def test_command_lines_run(line: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    rng = np.random.default_rng(7)
    t = np.arange(4000) * 0.01
    motion = np.convolve(rng.normal(size=t.size), np.exp(-5 * t) * np.sin(15 * t), "full")[: t.size]
    np.savetxt("taft.txt", 0.01 * motion)
    case = recorded_example() if line.startswith("stochlin pound") else sl.example_case()
    few = case.replace("paths = 2048", "paths = 256")
    Path("case.toml").write_text(few, encoding="utf-8")
    # It would serve until it is interrupted; tests/explorer/test_page.py lets it.
    monkeypatch.setattr("stochlin.views.explorer.server.serve", lambda *scene, **options: None)
    command, _, target = line.partition(" > ")
    result = CliRunner().invoke(main, shlex.split(command)[1:], default_map=FEW_MOTIONS)
    assert result.exit_code == 0, result.output
    if target:
        assert result.output == case


def test_python_example_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "agg")
    (example,) = blocks(README, "python")
    exec(compile(example, "README.md", "exec"), {})
    assert (tmp_path / "chart.nc").exists()


def test_pictures_and_links_exist() -> None:
    for target in re.findall(r"\]\(([^)#]+)\)", README):
        assert (ROOT / target).exists(), target
