"""The form of a case file: it shows what the file has, and what it writes is read as the same case."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest
from cases import BLOCK, with_buildings

import stochlin as sl
from stochlin.applications.cases.examples import short_example
from stochlin.applications.explorer.form import changed_text, chosen, form_of
from stochlin.solver.tables.toml import toml_text

pytestmark = pytest.mark.invariant

EXAMPLE = short_example()
STOREYS = with_buildings(
    BLOCK.format(n=1, period=1.0, storeys=6, height=3.2),
    """
[building_2]
name = "Annex"
masses = ["300 t", "250 t"]
stiffnesses = ["200 MN/m", "180 MN/m"]
heights = ["4 m", "3.2 m"]
yield_drifts = "1 cm"
damping = 0.04
hardening = 0.1
p_delta = true
""",
).replace("floors_align = true", "floors_align = false")


def read(text: str, folder: Path) -> sl.Case:
    path = folder / "case.toml"
    path.write_text(text, encoding="utf-8")
    return sl.read_case(path)


def shown(text: str, table: str, name: str):
    """The entry or the choice of a key."""
    rows = [row for _, *both in form_of(tomllib.loads(text)) for rows in both for row in rows]
    return next(row for row in rows if (row.table, row.name) == (table, name))


@pytest.mark.parametrize(("text", "least"), [(EXAMPLE, 20), (STOREYS, 18)], ids=["short", "storeys"])
def test_an_entry_says_what_the_file_says(text, least):
    entries = [entry for *_, of_table in form_of(tomllib.loads(text)) for entry in of_table]
    for entry in entries:
        assert entry.value == tomllib.loads(text)[entry.table][entry.name]
        assert isinstance(entry.value, bool) or entry.read(entry.text) == entry.value
        assert changed_text(text, entry) == text
    assert len(entries) >= least


@pytest.mark.parametrize(
    ("text", "table", "name", "typed", "value"),
    [
        (EXAMPLE, "building_1", "period", "1.25 s", "1.25 s"),
        (EXAMPLE, "building_1", "period", "1 s +- 20 %", "1 s +- 20 %"),
        (EXAMPLE, "building_2", "reduction_factor", "3.5", 3.5),
        (EXAMPLE, "building_2", "damping", " 4 % ", "4 %"),
        (EXAMPLE, "separation", "existing", '"7 cm"', "7 cm"),
        (EXAMPLE, "separation", "existing", "", None),
        (STOREYS, "building_2", "masses", '["300 t", "270 t"]', ["300 t", "270 t"]),
    ],
)
def test_a_typed_text_changes_one_line_of_the_file(text, table, name, typed, value, tmp_path):
    entry = shown(text, table, name)
    changed = changed_text(text, entry._replace(value=entry.read(typed)))
    wanted = tomllib.loads(text)
    if value is None:
        del wanted[table][name]
    else:
        wanted[table][name] = value
        lines = zip(text.splitlines(), changed.splitlines(), strict=True)
        ((old, new),) = (pair for pair in lines if pair[0] != pair[1])
        assert old.partition("#")[1:] == new.partition("#")[1:]  # its comment stays
    assert tomllib.loads(changed) == wanted
    read(changed, tmp_path)


def test_what_has_no_line_is_written_anew():
    text = 'separation = { confidence = "90 %" }\n'
    existing = shown(text, "separation", "existing")
    assert existing.text == ""
    changed = tomllib.loads(changed_text(text, existing._replace(value="6 cm")))
    assert changed == {"separation": {"confidence": "90 %", "existing": "6 cm"}}


@pytest.mark.parametrize(
    "typed", ["[" * 9999, "[1979-05-27]", '{"a": 1}', "1\n[site]", "true", "'", "é\0"]
)
def test_nonsense_is_a_text_that_the_reader_refuses(typed, tmp_path):
    entry = shown(EXAMPLE, "building_1", "period")
    with pytest.raises(ValueError, match=r"line \d+: building_1.period = "):
        read(changed_text(EXAMPLE, entry._replace(value=entry.read(typed))), tmp_path)


@pytest.mark.parametrize(
    ("name", "written", "reach", "at_half"),
    [
        ("period", '"900 ms"', (-1, 1), "1800 ms"),
        ("period", '"1 s +- 20 %"', (-1, 1), "2 s +- 20 %"),
        ("period", '"0.8 to 1.2 s"', None, None),
        ("damping", '"5 %"', (-1, 1), "10 %"),
        ("damping", "0.4", (-1, 0.65), 0.8),
        ("storeys", "8", (-1, 1), 16),
        ("mass", '"3200 t"', (-1, 1), "6400 t"),
        ("heights", '["3 m", "3 m"]', None, None),
    ],
)
def test_a_slider_reaches_four_times_as_far_in_the_unit_of_the_file(name, written, reach, at_half):
    entry = shown(f"[building_1]\n{name} = {written}\n", "building_1", name)
    assert entry.reach() == reach
    if reach is not None:
        assert entry.slid(0.5) == at_half
        assert entry.slid(0.0) == entry.value


@pytest.mark.parametrize(
    ("table", "name"),
    [("site", "ground"), ("motion", "envelope"), ("building_1", ""), ("building_2", "")],
)
def test_every_choice_makes_a_case_and_the_first_one_comes_back(table, name, tmp_path):
    first = shown(EXAMPLE, table, name)
    before = read(EXAMPLE, tmp_path)
    for option in first.ways:
        other = toml_text(chosen(tomllib.loads(EXAMPLE), first, option))
        assert shown(other, table, name).present == option
        assert read(other, tmp_path).buildings[1].period == pytest.approx(0.6)
        back = chosen(tomllib.loads(other), shown(other, table, name), first.present)
        again = read(toml_text(back), tmp_path)
        assert again.site.course == before.site.course
        assert again.site.ground == before.site.ground
        assert again.buildings[0].structure.period == before.buildings[0].structure.period


def test_what_no_choice_writes_is_as_in_the_file():
    assert shown(STOREYS, "building_2", "").present == "as in the file"
    assert shown(STOREYS, "building_1", "").present == "equal storeys"
