"""The form of a case file: it shows what the file has, and what it writes is read as the same case."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest
from cases import BLOCK, with_buildings

import stochlin as sl
from stochlin.analyses.cases.examples import example_case
from stochlin.analyses.explorer.form import AS_IN_FILE, Choice, changed_text, chosen, form_of
from stochlin.analyses.tables.toml import toml_text

pytestmark = pytest.mark.invariant

EXAMPLE = example_case()
SINGLY = """
[building_2]
name = "Annex"
masses = ["300 t", "250 t"]
stiffnesses = ["200 MN/m", "180 MN/m"]
heights = ["4 m", "3.2 m"]
yield_drifts = "1 cm"
damping = 0.04
hardening = 0.1
p_delta = true
"""
FILES = {
    "example": EXAMPLE,
    "regular": with_buildings(
        BLOCK.format(n=1, period=1.0, storeys=6, height=3.2),
        BLOCK.format(n=2, period=0.6, storeys=4, height=3.2),
    ),
    "singly": with_buildings(
        EXAMPLE[EXAMPLE.index("[building_1]") : EXAMPLE.index("[building_2]")], SINGLY
    ),
}


def read(text: str, folder: Path) -> sl.Case:
    path = folder / "case.toml"
    path.write_text(text, encoding="utf-8")
    return sl.read_case(path)


def entry(text: str, table: str, key: str):
    entries = [each for group in form_of(tomllib.loads(text)) for each in group.entries]
    return next(each for each in entries if (each.table, each.key.name) == (table, key))


def choice(text: str, table: str) -> Choice:
    return next(
        each for group in form_of(tomllib.loads(text)) for each in group.choices if each.table == table
    )


def taken(text: str, table: str, option: str) -> str:
    return toml_text(chosen(tomllib.loads(text), choice(text, table), option))


@pytest.mark.parametrize("file", FILES)
def test_each_entry_says_what_the_file_says(file):
    text, shown = FILES[file], 0
    for group in form_of(tomllib.loads(text)):
        for each in group.entries:
            if each.key.kind is bool or each.value is None:
                continue
            assert each.read(each.text) == each.value
            assert changed_text(text, each, each.read(each.text)) == text
            shown += 1
    assert shown >= 20


@pytest.mark.parametrize(
    ("file", "table", "key", "typed", "line"),
    [
        (
            "example",
            "building_1",
            "period",
            "1.25 s",
            'period = "1.25 s"                # of small vibrations',
        ),
        ("example", "building_1", "period", "1 s +- 20 %", 'period = "1 s +- 20 %"'),
        ("example", "building_2", "reduction_factor", "3.5", "reduction_factor = 3.5"),
        ("example", "building_2", "damping", "4 %", 'damping = "4 %"'),
        ("example", "site", "intensity", "200 cm^2/s^3", 'intensity = "200 cm^2/s^3"'),
        (
            "example",
            "separation",
            "existing",
            "7 cm",
            'existing = "7 cm"               # the existing gap',
        ),
        ("singly", "building_2", "masses", "300 t, 270 t", 'masses = ["300 t", "270 t"]'),
    ],
)
def test_an_entry_makes_the_case_of_a_file_with_another_line(file, table, key, typed, line, tmp_path):
    text = FILES[file]
    before = entry(text, table, key)
    changed = changed_text(text, before, before.read(typed))
    assert line in changed
    old, new = text.splitlines(), changed.splitlines()
    assert len(old) == len(new)
    assert sum(one != other for one, other in zip(old, new, strict=True)) == 1
    by_hand = tomllib.loads(text)
    by_hand[table][key] = tomllib.loads(line)[key]
    assert tomllib.loads(changed) == by_hand
    case = read(changed, tmp_path)
    of_hand = read(toml_text(by_hand), tmp_path)
    for one, other in zip(case.buildings, of_hand.buildings, strict=True):
        assert one.structure.describe() == other.structure.describe()
    assert case.gap == (0.07 if key == "existing" else 0.05)


def test_a_missing_gap_has_an_entry_and_an_empty_one_leaves_it_out(tmp_path):
    before = entry(EXAMPLE, "separation", "existing")
    without = changed_text(EXAMPLE, before, before.read(" "))
    assert read(without, tmp_path).gap is None
    missing = entry(without, "separation", "existing")
    assert missing.text == ""
    assert read(changed_text(without, missing, missing.read("6 cm")), tmp_path).gap == 0.06


def test_what_has_no_line_of_its_own_is_written_anew():
    text = 'separation = { confidence = "90 %", existing = "5 cm" }\n'
    confidence = entry(text, "separation", "confidence")
    changed = tomllib.loads(changed_text(text, confidence, "95 %"))
    assert changed == {"separation": {"confidence": "95 %", "existing": "5 cm"}}


@pytest.mark.parametrize(
    ("key", "written", "at", "slid"),
    [
        ("damping", '"5 %"', 0.05, "10 %"),
        ("damping", "0.05", 0.05, "0.1"),
        ("period", '"900 ms"', 0.9, "100 ms"),
        ("storeys", "8", 8, "0.1"),
        ("period", '"1 s +- 20 %"', None, "0.1 s"),
    ],
)
def test_a_slider_keeps_the_unit_of_the_file(key, written, at, slid):
    text = f"[building_1]\n{key} = {written}\n"
    found = entry(text, "building_1", key)
    assert found.at == at
    if at is not None:
        assert found.slid(0.1) == slid


@pytest.mark.parametrize("table", ["site", "motion", "building_1", "building_2"])
def test_every_choice_makes_a_case_and_the_first_one_comes_back(table, tmp_path):
    text = FILES["example"]
    of_all = choice(text, table)
    before = read(text, tmp_path)
    for option in of_all.options:
        other = taken(text, table, option)
        case = read(other, tmp_path)
        assert choice(other, table).present == option
        again = read(taken(other, table, of_all.present), tmp_path)
        assert again.duration == before.duration
        if option not in ("eurocode_8", "asce_7"):  # which have no intensity to keep
            assert again.ground == before.ground
        assert case.second.period == pytest.approx(before.second.period)
        assert again.first.structure.period == before.first.structure.period


def test_what_is_not_chosen_from_the_list_is_as_in_the_file():
    assert choice(FILES["singly"], "building_2").present == AS_IN_FILE
    assert choice(FILES["regular"], "building_1").present == "regular storeys"
    assert choice(EXAMPLE, "building_1").present == "oscillator, R"


@pytest.mark.parametrize(
    "text",
    ["", "site = 3\n[building_1]\nname = 4\nmasses = []\nperiod = [[1]]\n", "[motion]\nduration = nan"],
)
def test_a_text_that_is_no_case_has_a_form_all_the_same(text):
    for group in form_of(tomllib.loads(text)):
        for each in group.entries:
            assert isinstance(each.text, str)
            _ = each.at
