"""What the README and the page to start with show works as printed, in an empty folder."""

import re
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path

import pytest
import xarray as xr
from cases import run_as_printed, with_slow
from commands import answered

pytestmark = pytest.mark.cli

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
START = (ROOT / "docs" / "start.md").read_text(encoding="utf-8")


def blocks(text: str, language: str) -> list[str]:
    every = re.findall(r"^```(\w*)\n(.*?)^```$", text, re.DOTALL | re.MULTILINE)
    return [block for own, block in every if own == language]


def command_lines() -> list[str]:
    text = "".join(blocks(README, "") + blocks(START, "sh")).replace("\\\n", " ")
    lines = [line.split("  #")[0].strip() for line in text.splitlines() if line.startswith("stochlin ")]
    assert set(lines) >= ELSEWHERE
    return sorted(set(lines) - ELSEWHERE)


ELSEWHERE = {
    "stochlin warmup",  # it would compile everything
    "stochlin charts",  # tests/house/test_command.py
}
LONG = {
    "stochlin charts fig5a --damping 0.02 --hardening 0.1 --format pdf --out out",  # others are drawn
    "stochlin charts fig4b --print-width 84mm --format pdf --out out",  # tests/charts/test_print.py
    "stochlin charts fig4b --ground-damping 0.05,0.2,0.6 --comparison",
    "stochlin gap case.toml --report gap.html",
    "stochlin gap case.toml --report gap.html --out gap.nc",
    "stochlin mitigate case.toml --picture measures.png",
    "stochlin pound case.toml --motions 100",  # there is one with a picture
}


@pytest.mark.parametrize("line", with_slow(command_lines(), LONG))
def test_command_lines_run(line: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    # It would serve until it is interrupted; tests/explorer/test_page.py lets it.
    monkeypatch.setattr("stochlin.views.explorer.server.serve", lambda *form, **options: None)
    monkeypatch.setattr("tempfile.tempdir", None)  # the command sets it
    run_as_printed(line, command_lines())


def test_python_example_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "agg")
    (example,) = blocks(README, "python")
    with redirect_stdout(StringIO()) as printed:
        exec(compile(example, "README.md", "exec"), {})
    _, shown = blocks(README, "text")
    # The last change is rounding error.
    assert printed.getvalue().splitlines()[:-1] == shown.splitlines()[:-1]
    assert xr.load_dataset(tmp_path / "rho.nc").rho.notnull().all()


def test_the_case_file_gives_the_table(tmp_path: Path) -> None:
    case = tmp_path / "case.toml"
    case.write_text("".join(blocks(README, "toml")), encoding="utf-8")
    printed = iter(answered("gap", case).output.splitlines())
    assert all(line in printed for line in blocks(README, "text")[0].splitlines())


def test_pictures_and_links_exist() -> None:
    for target in re.findall(r"\]\(([^)#]+)\)", README):
        assert (ROOT / target).exists(), target
