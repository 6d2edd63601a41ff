"""The schema of case files: each key is explained, read as it says, and not read where it is known."""

from __future__ import annotations

import dataclasses
import html
import tomllib
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import stochlin as sl
from stochlin.analyses.cases.case import Case, case_of
from stochlin.analyses.cases.examples import example_case, example_record
from stochlin.analyses.cases.files import schema
from stochlin.analyses.cases.files.keys import Key, Slider
from stochlin.analyses.cases.files.known import Known
from stochlin.analyses.cases.files.sections import Section
from stochlin.analyses.cases.separation import answer_case
from stochlin.analyses.explorer.form import changed_text, form_of
from stochlin.models.arguments import Whole
from stochlin.views.separation.report import report_page

pytestmark = pytest.mark.invariant

KEYS = [(table, key) for table, keys in schema.TABLES.items() for key in keys.values()]


@pytest.mark.filterwarnings("ignore::stochlin.messages.DoubtfulInput")
@pytest.mark.parametrize(("table", "key"), KEYS, ids=lambda part: getattr(part, "name", part))
def test_the_example_of_a_key_can_be_read_and_its_slider_is_within_its_range(
    table: str, key: Key
) -> None:
    place = tuple(table.replace("building", "building_1").split(".")) if table else ()
    value = tomllib.loads(f"value = {key.example}")["value"]
    section = Section("case.toml", place, {key.name: value}, {})
    assert section.read(key.name) is not None
    if key.slider is None:
        return
    assert key.slider.low <= key.slider.start <= key.slider.high
    for end in (key.slider.low, key.slider.high):
        text = f"{end:g} {key.slider.unit}" if key.slider.unit else end
        assert Section("case.toml", place, {key.name: text}, {}).read(key.name) == pytest.approx(
            end * key.unit_size
        )


def again(case: Case, **strength: str) -> Case:
    """The case with another strength of its site, of files that are gone."""
    values = {**case.whole.values, "site": {**case.whole.values["site"], **strength}}
    return case_of(Section(case.file, (), values, {}), Path("nowhere/case.toml"), case.of_site.known)


SITES = {
    "pga": 'ground = "firm"\npga = "0.2 g"\n',
    "ag": 'spectrum = "eurocode_8"\nsoil = "B"\nag = "0.2 g"\nfilters = 1\n',
}


@pytest.mark.slow
@pytest.mark.parametrize("strength", SITES)
def test_what_is_known_is_neither_read_nor_fitted_again(strength: str, tmp_path: Path) -> None:
    (tmp_path / "record.at2").write_text(example_record(), encoding="utf-8")
    text = example_case()
    start, end = text.index("[site]"), text.index("[motion]")
    record = '[[site.records]]\npath = "record.at2"\n'
    text = f"{text[:start]}[site]\n{SITES[strength]}{record}{text[end:]}"
    (tmp_path / "case.toml").write_text(text, encoding="utf-8")
    case = sl.read_case(tmp_path / "case.toml")
    assert case.of_site.waits
    before = case.ground
    assert not case.of_site.waits
    stronger = again(case, **{strength: "0.4 g"})
    assert not stronger.of_site.waits
    ratio = stronger.ground.arrays()["intensity"] / before.arrays()["intensity"]
    assert float(ratio) == pytest.approx(4, rel=1e-12)
    assert stronger.records["record.at2"] is case.records["record.at2"]
    fresh = case_of(stronger.whole, tmp_path / "case.toml", Known()).ground
    np.testing.assert_allclose(
        *(float(ground.arrays()["intensity"]) for ground in (fresh, stronger.ground)), rtol=1e-6
    )


@pytest.fixture
def occupancy(monkeypatch: pytest.MonkeyPatch) -> Iterator[Key]:
    """One more key of a building, by its line in the schema and nothing else."""
    slider = Slider(0, 2000, 10, 120)
    key = Key("occupancy", Whole(0), "People on a working day", None, slider, noted=True)
    monkeypatch.setitem(schema.BUILDING, key.name, key)  # type: ignore[arg-type]
    yield key
    monkeypatch.undo()


def test_a_key_of_the_schema_is_explained_read_shown_edited_and_saved(
    occupancy: Key, tmp_path: Path
) -> None:
    text = example_case()
    line = "# occupancy = 0                 # People on a working day\n"
    assert text.count(line) == 1
    assert text.index("[building_1]") < text.index(line) < text.index("[building_2]")
    path = tmp_path / "case.toml"
    path.write_text(text.replace("[building_1]", "[building_1]\noccupancy = 300", 1), encoding="utf-8")
    case = sl.read_case(path)
    text = path.read_text(encoding="utf-8")
    entries = [entry for group in form_of(tomllib.loads(text)) for entry in group.entries]
    (entry,) = (entry for entry in entries if entry.key is occupancy)
    assert entry.value == 300
    assert "occupancy = 450" in changed_text(text, entry, entry.read("450"))
    page = report_page(answer_case(dataclasses.replace(case, paths=100)))
    assert "occupancy = 300" in page
    path.write_text(path.read_text(encoding="utf-8").replace("300", "-1"), encoding="utf-8")
    with pytest.raises(ValueError, match=r"line \d+: building_1.occupancy = -1 is out of range"):
        sl.read_case(path)


@pytest.mark.slow
def test_the_page_contains_the_case_from_which_it_is_made(tmp_path: Path) -> None:
    """What is between its tags is typed again, and gives the same numbers."""
    (tmp_path / "case.toml").write_text(example_case(), encoding="utf-8")
    answer = answer_case(dataclasses.replace(sl.read_case(tmp_path / "case.toml"), paths=100))
    page = report_page(answer)
    text = html.unescape(page[page.index("<pre>") + len("<pre>") : page.index("</pre>")])
    (tmp_path / "again.toml").write_text(text, encoding="utf-8")
    case = sl.read_case(tmp_path / "again.toml")
    assert case.whole.values == answer.case.whole.values
    again = answer_case(dataclasses.replace(case, paths=100))
    xr.testing.assert_equal(again.separation, answer.separation)
