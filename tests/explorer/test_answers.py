"""What the explorer shows: the answer of the library's own functions, with few motions."""

from __future__ import annotations

import dataclasses
import html
import re

import pytest
import xarray as xr
from cases import BLOCK, example_of_short_motion, with_buildings

import stochlin as sl
from stochlin.applications.cases.separation import answer_case
from stochlin.views.explorer.answers import PATHS, by_few_motions, page_of
from stochlin.views.separation.words import first_lines

pytestmark = pytest.mark.invariant

TEXT = example_of_short_motion()
STOREYS = with_buildings(
    BLOCK.format(n=1, period=1.0, storeys=6, height=3.2),
    BLOCK.format(n=2, period=0.6, storeys=4, height=3.2),
)


def nothing(share: float) -> None:
    assert 0 <= share <= 1


def answered(text, folder):
    page = page_of(str(folder), "case.toml", text, nothing)
    return html.unescape(re.sub(r"<svg.*?</svg>|<[^>]*>", "", page, flags=re.DOTALL))


def test_the_gap_is_that_of_the_case_with_few_motions(tmp_path):
    (tmp_path / "case.toml").write_text(TEXT, encoding="utf-8")
    case = sl.read_case(tmp_path / "case.toml")
    few = dataclasses.replace(case.simulated, paths=PATHS)
    expected = answer_case(dataclasses.replace(case, simulated=few))
    page = answered(TEXT.replace('title = "', 'title = "<b>'), tmp_path)
    for sentence in first_lines(expected):
        assert sentence in page
    shown = [answer.separation.gap for answer in (by_few_motions(case), expected)]
    xr.testing.assert_identical(*shown)
    assert f"From {PATHS} motions; 'stochlin gap' takes more" in page
    assert "RuleGap [cm]Error" in page


def test_names_are_no_html(tmp_path):
    text = TEXT.replace('"Annex"', '"<img src=x onerror=alert(1)>"')
    page = page_of(str(tmp_path), "case.toml", text, nothing)
    assert "<img" not in page
    assert "&lt;img" in page


@pytest.mark.slow
def test_buildings_with_storeys_have_a_gap(tmp_path):
    assert "should stand" in answered(STOREYS, tmp_path)


def test_what_progress_raises_stops_an_answer(tmp_path):
    class Enough(Exception):  # noqa: N818
        pass

    def stop(share: float) -> None:
        raise Enough

    with pytest.raises(Enough):
        page_of(str(tmp_path), "case.toml", TEXT, stop)
