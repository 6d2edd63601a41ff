"""Answers that are kept: what a user did before, done again, number by number."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from answers import manual
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
    moved_independent,
    run,
    verified_answers,
)
from cases import with_slow

import stochlin as sl

LONG = {
    *("charts_from_python", "charts_of_every_figure", "gap_at_a_recorded_site"),
    *("first_passage_of_a_frame", "frame_of_six_storeys", "frame_of_ten_storeys"),
    *(
        "fragility_of_a_gap",
        "gap_of_bouc_wen_buildings",
        "gap_of_storeys",
        "what_matters_for_a_gap",
    ),
    *("measures_from_python", "records_read_and_fitted", "risk_of_a_gap", "site_by_spectrum"),
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
def test_the_answer_is_what_it_was(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("MPLBACKEND", "agg")
    case = Case.named(name)
    moved = [str(each) for each in differences(case, run(case, tmp_path)) if each.moved]
    assert not moved, "\n".join(
        [f"{case.why} 'make answers' rewrites it, if this is meant:", *moved]
    )


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
        now = independent(case)
    except ImportError as error:
        pytest.skip(f"its program is not installed: {error}")
    assert moved_independent(case, now) == []


@pytest.mark.cli
def test_the_manual_is_made_of_the_frozen_answers() -> None:
    page = manual.PAGE.read_text(encoding="utf-8")
    assert page == manual.page(), "'make answers' writes it anew"
    assert len(VERIFIED) >= 10
    assert not [name for name in VERIFIED if f"`tests/answers/{name}`" not in page]


@pytest.mark.invariant
def test_what_users_do_most_is_asked_for_in_some_case() -> None:
    """At least these; one more command or public name needs no case of its own."""
    scripts = "\n".join(path.read_text(encoding="utf-8") for path in HERE.glob(f"*/{SCRIPT}"))
    commands = [line for name in CASES for line in Case.named(name).commands]
    shown = {line.split()[1] for line in commands}
    assert shown >= {"building", "charts", "gap", "mitigate", "pound", "probability", "rho"}
    names = [name for name in sl.__all__ if re.search(rf"\bsl\.{name}\b", scripts)]
    assert len(names) >= 80


@pytest.mark.invariant
def test_one_more_variable_and_one_more_rule_are_no_difference(tmp_path: Path) -> None:
    """Nor is what texts say of the rule, in a list or on a line of its own."""
    folder, results = tmp_path / "toy" / EXPECTED, tmp_path / "results"
    folder.mkdir(parents=True)
    results.mkdir()
    case = Case(folder.parent, "toy", Tolerance(""))

    def write(into: Path, rules: list[str], gaps: list[float], **more: Any) -> None:
        table = xr.Dataset({"gap": ("rule", gaps), **more}, {"rule": rules})
        table.assign_attrs(references="; ".join(rules)).to_netcdf(into / "answer.nc")
        rows = "".join(f"{rule}  {gap} m\n" for rule, gap in zip(rules, gaps, strict=True))
        (into / "screen.txt").write_text(f"{rows}allowed: {', '.join(rules)}\n")

    first, other, last = sl.rules.code_rule_names()[:3]
    write(folder, [first, last], [1.0, 2.0])
    write(results, [first, other, last], [1.0, 7.0, 2.0], more=1.0)
    assert [*differences(case, results)] == []
    write(results, [first, other, last], [1.0, 7.0, 2.5])
    places = {each.place for each in differences(case, results)}
    assert places == {"answer.nc gap", "screen.txt, line 2"}
    write(results, [first, other], [1.0, 7.0])
    places = {each.place for each in differences(case, results)}
    assert {"answer.nc rule, line 2", "screen.txt, line 2"} <= places


@pytest.mark.invariant
def test_a_difference_is_shown_beyond_the_tolerance_and_not_within(tmp_path: Path) -> None:
    """Of numbers, flags, attributes and words, in datasets and texts."""
    folder, results = tmp_path / "toy" / EXPECTED, tmp_path / "results"
    folder.mkdir(parents=True)
    results.mkdir()
    tolerances = Tolerance("", relative=1e-6), Tolerance("", absolute=1.0, variables=("impacts",))
    case = Case(folder.parent, "toy", tolerances[0], tolerances[1:])

    def write(into: Path, a: float, flag: int, units: str, impacts: int, word: str) -> None:
        data = {"a": ("x", [1.0, np.nan, a], {"units": units}), "n": ("y", [1, flag])}
        xr.Dataset(data).to_netcdf(into / "answer.nc")
        (into / "screen.txt").write_text(f"gap {a / 2} m\n{impacts} impacts {word}\n")

    write(folder, 3.0, 2, "m", 7, "each")
    write(results, 3.000001, 2, "m", 8, "each")
    assert not [each for each in differences(case, results) if each.moved]
    write(results, 3.5, 3, "mm", 9, "all")
    assert [str(each) for each in differences(case, results) if each.moved] == [
        "answer.nc a: 1.7e-01, 3 -> 3.5",
        "answer.nc a, units: other, m -> mm",
        "answer.nc n, line 2: 5.0e-01, 2 -> 3",
        "screen.txt, line 1: 1.7e-01, 1.5 -> 1.75",
        "screen.txt, line 2: other, 7 impacts each -> 9 impacts all",
    ]
    write(results, np.nan, 2, "m", 7, "each")
    assert "answer.nc a: other, 3 -> nan" in map(str, differences(case, results))
