"""Answers that are kept: what a user did before, done again, number by number."""

import re
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from answers import manual, rewrite
from answers.frozen import (
    CASES,
    EXPECTED,
    HERE,
    INDEPENDENT,
    SCRIPT,
    Case,
    Tolerance,
    differences,
    independent,
    kept_independent,
    largest,
    run,
    verified_answers,
)
from cases import with_slow

import stochlin as sl
from stochlin.views.command import main

LONG = {
    *("charts_from_python", "charts_of_every_figure", "gap_at_a_recorded_site"),
    *("first_passage_of_a_frame", "frame_of_six_storeys", "gap_of_bouc_wen_buildings"),
    *("gap_of_storeys", "measures_from_python"),
    *("records_read_and_fitted", "risk_of_a_gap", "site_by_spectrum"),
}
# Time steps of other programs; what they once said is compared with ours above all the same.
LONG_INDEPENDENT = {
    "blows_of_two_oscillators",
    "first_passage",
    "first_passage_of_a_frame",
    "frame_of_six_storeys",
    "frame_of_ten_storeys",
}
VERIFIED = [name for name in CASES if (HERE / name / INDEPENDENT).exists()]


@pytest.mark.cli
@pytest.mark.parametrize("name", with_slow(CASES, LONG))
def test_the_answer_is_what_it_was(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MPLBACKEND", "agg")
    case = Case.named(name)
    moved = [str(each) for each in differences(case, run(case, tmp_path)) if each.moved]
    assert not moved, "\n".join([f"{case.why} 'make answers' rewrites it, if this is meant:", *moved])


@pytest.mark.oracle
@pytest.mark.parametrize("name", VERIFIED)
def test_it_is_the_answer_by_hand_or_of_another_program(name: str) -> None:
    case, ours = Case.named(name), verified_answers(Case.named(name))
    for variable, theirs in kept_independent(case)["answers"].items():
        known = ~np.isnan(np.asarray(theirs))
        apart = largest(ours[variable].values[known], np.asarray(theirs)[known])
        assert apart <= case.verified["within"], variable


@pytest.mark.oracle
@pytest.mark.parametrize("name", with_slow(VERIFIED, LONG_INDEPENDENT))
def test_the_independent_way_gives_what_is_kept(name: str) -> None:
    case = Case.named(name)
    try:
        now, before = independent(case), kept_independent(case)
    except ImportError as error:
        pytest.skip(f"its program is not installed: {error}")
    for kind in ("answers", "numbers"):
        assert now[kind].keys() == before[kind].keys()
        for key, value in before[kind].items():
            assert largest(now[kind][key], value) <= case.verified["within"], key


@pytest.mark.cli
def test_the_manual_is_made_of_the_frozen_answers() -> None:
    page = manual.PAGE.read_text(encoding="utf-8")
    assert page == manual.page(), "'make answers' writes it anew"
    assert len(VERIFIED) >= 10
    assert not [name for name in VERIFIED if f"`tests/answers/{name}`" not in page]


@pytest.mark.cli
@pytest.mark.parametrize("name", VERIFIED)
def test_a_problem_of_the_manual_has_the_numbers_that_were_solved(name: str) -> None:
    """They are put in from what is frozen; left are formulas, numbers of equations and years."""
    words = (HERE / name / "manual.md").read_text(encoding="utf-8")
    (problem,) = re.findall(r"\*Problem\.\*(.*?)\n\n", words, re.DOTALL)
    assert not re.findall(
        r"\d", re.sub(r"<<.*?>>|\$.*?\$|\(\d+\)|\b(18|19|20)\d\d\b|`.*?`", "", problem)
    )


@pytest.mark.invariant
def test_whatever_a_user_can_do_is_asked_for_in_some_case() -> None:
    scripts = "\n".join(path.read_text(encoding="utf-8") for path in HERE.glob(f"*/{SCRIPT}"))
    commands = [line for name in CASES for line in Case.named(name).commands]
    shown = {line.split()[1] for line in commands}
    # A page that is served until it is stopped, and what answers nothing.
    assert set(main.list_commands(None)) - shown == {"explore", "warmup"}
    assert not [name for name in sl.__all__ if not re.search(rf"\bsl\.{name}\b", scripts)]


@pytest.mark.invariant
def test_every_case_says_why_it_is_kept_and_why_its_tolerance_is_what_it_is() -> None:
    for case in map(Case.named, CASES):
        for tolerance in (case.tolerance, *case.others):
            assert len(tolerance.reason) > 10, case.folder.name
        assert len(case.why) > 10
        assert bool(case.commands) != (case.folder / SCRIPT).exists(), case.folder.name
    assert len(CASES) >= 30
    files = [path for path in HERE.rglob("*") if EXPECTED in path.parts and path.is_file()]
    assert sum(path.stat().st_size for path in files) < 1.26e6  # bytes


# --- The comparison itself, and its rewriting ---


@pytest.fixture
def case(tmp_path: Path) -> Case:
    """A case whose answer is two variables and a line of text."""
    folder = tmp_path / "toy"
    (folder / EXPECTED).mkdir(parents=True)
    (folder / SCRIPT).write_text(
        "import xarray as xr\n"
        "data = {'a': ('x', [1.0, float('nan'), 3.0], {'units': 'm'}), 'n': ('x', [1, 2, 3])}\n"
        "xr.Dataset(data, attrs={'title': 'made with 2.5 m'}).to_netcdf('answer.nc')\n"
        "print('gap 1.25 m, 7 impacts')\n"
    )
    toy = Case(folder, "toy", Tolerance("", relative=1e-6))
    shutil.copytree(run(toy, tmp_path / "first"), folder / EXPECTED, dirs_exist_ok=True)
    return toy


def after(case: Case, old: str, new: str, scratch: Path) -> list[str]:
    """What moves when a word of the script is another."""
    script = case.folder / SCRIPT
    text = script.read_text()
    assert old in text
    script.write_text(text.replace(old, new, 1))
    return [str(each) for each in differences(case, run(case, scratch)) if each.moved]


@pytest.mark.invariant
@pytest.mark.parametrize(
    ("old", "new", "shown"),
    [
        ("3.0]", "3.00001]", "answer.nc a: 3.3e-06, 3 -> 3.00001"),
        ("float('nan')", "2.0", "answer.nc a: other, nan -> 2"),
        ("[1.0,", "[float('inf'),", "answer.nc a: other, 1 -> inf"),
        ("'n': ('x', [1, 2, 3])", "'n': ('x', [1, 2, 4])", "answer.nc n: other, 3 -> 4"),
        ("'n':", "'k':", "answer.nc k: other, missing -> there"),
        ("'units': 'm'", "'units': 'mm'", "answer.nc a, units: other, m -> mm"),
        ("with 2.5 m", "with 2.6 m", "answer.nc, title: 4.0e-02, 2.5 -> 2.6"),
        ("gap 1.25", "gap 1.26", "screen.txt: 8.0e-03, 1.25 -> 1.26"),
        ("7 impacts", "8 impacts", "screen.txt: 1.4e-01, 7 -> 8"),
        ("impacts", "hits", "screen.txt: other, gap 1.25 m, 7 impacts -> gap 1.25 m, 7 hits"),
        ("answer.nc", "other.nc", "answer.nc: other, there -> missing"),
    ],
)
def test_what_moves_is_told(case: Case, old: str, new: str, shown: str, tmp_path: Path) -> None:
    assert shown in after(case, old, new, tmp_path / "again")


@pytest.mark.invariant
def test_what_is_within_the_tolerance_has_not_moved(case: Case, tmp_path: Path) -> None:
    """That of the case, or the one of a variable or line."""
    for old, new in (
        ("3.0]", "3.000001]"),
        ("gap 1.25 m", "gap  1.2500001  m"),
        ("2.5 m", "2.500001 m"),
    ):
        assert after(case, old, new, tmp_path / f"toy {len(new)}") == []
    of_variables = {"a": 0.5, "impacts": 1.0}
    others = [Tolerance("", absolute=size, variables=(name,)) for name, size in of_variables.items()]
    case = replace(case, others=tuple(others))
    assert after(case, "3.000001]", "3.4]", tmp_path / "of a") == []
    assert after(case, "7 impacts", "8 impacts", tmp_path / "of impacts") == []


@pytest.mark.invariant
def test_rewriting_touches_nothing_that_has_not_moved_and_shows_what_has(case: Case) -> None:
    kept = {path: path.stat().st_mtime_ns for path in (case.folder / EXPECTED).iterdir()}
    assert list(rewrite.rewritten(case)) == []
    script = case.folder / SCRIPT
    script.write_text(script.read_text().replace("3.0]", "3.0000001]"))
    assert list(rewrite.rewritten(case)) == []
    assert {path: path.stat().st_mtime_ns for path in (case.folder / EXPECTED).iterdir()} == kept
    script.write_text(script.read_text().replace("3.0000001]", "3.5]"))
    assert list(rewrite.rewritten(case)) == ["toy: answer.nc a: 1.7e-01, 3 -> 3.5"]
    with xr.open_dataset(case.folder / EXPECTED / "answer.nc") as written:
        assert float(written.a[2]) == 3.5
    assert list(rewrite.rewritten(case)) == []
