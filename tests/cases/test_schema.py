"""The schema of case files: each key is explained, read as it says, and not read where it is known."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
import pytest

import stochlin as sl
from stochlin.analyses.cases.case import Case, case_of
from stochlin.analyses.cases.files import schema
from stochlin.analyses.cases.files.keys import Key
from stochlin.analyses.cases.files.known import Known
from stochlin.analyses.cases.files.sections import Section
from stochlin.models.arguments import Whole

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
    limits, (low, high) = key.slider.limits, key.ends
    assert low < high
    for end in (low, high):
        if isinstance(limits, Whole):
            limits(key.name, int(end))
        elif limits is not None:
            assert limits.contains(end)


def test_a_key_that_the_example_does_not_explain_has_a_line_of_its_own(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    more = Key("occupancy", Whole(0), "People in it on a working day", None)
    monkeypatch.setitem(schema.BUILDING, "occupancy", more)  # type: ignore[index]
    line = "# occupancy = 0                 # People in it on a working day\n"
    text = sl.example_case()
    assert text.count(line) == 1
    assert text.index("[building_1]") < text.index(line) < text.index("[building_2]")


def again(case: Case, **strength: str) -> Case:
    """The case with another strength of its site, of files that are gone."""
    values = {**case.whole.values, "site": {**case.whole.values["site"], **strength}}
    return case_of(Section(case.file, (), values, {}), Path("nowhere/case.toml"), case.of_site.known)


SITES = {
    "pga": 'ground = "firm"\npga = "0.2 g"\n',
    "ag": 'spectrum = "eurocode_8"\nsoil = "B"\nag = "0.2 g"\nfilters = 1\n',
}


@pytest.mark.parametrize("strength", SITES)
def test_what_is_known_is_neither_read_nor_fitted_again(strength: str, tmp_path: Path) -> None:
    (tmp_path / "record.at2").write_text(sl.example_record(), encoding="utf-8")
    text = sl.example_case()
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
