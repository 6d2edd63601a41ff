"""What the explorer shows: the answer of the library's own functions, with few motions."""

from __future__ import annotations

import dataclasses
import html
import re

import numpy as np
import pytest
import xarray as xr
from cases import BLOCK, example_of_short_motion, with_buildings

import stochlin as sl
from stochlin.applications.cases.separation import answer_case
from stochlin.applications.explorer.answers import PATHS_OF_ANSWER, correlations, gap_by_few_motions
from stochlin.views.explorer.answers import correlation_of, gap_of
from stochlin.views.separation.words import first_lines

pytestmark = pytest.mark.invariant

TEXT = example_of_short_motion()
STOREYS = with_buildings(
    BLOCK.format(n=1, period=1.0, storeys=6, height=3.2),
    BLOCK.format(n=2, period=0.6, storeys=4, height=3.2),
)


def nothing(share: float) -> None:
    assert 0 <= share <= 1


def answered(question, text, folder):
    page = question(str(folder), "case.toml", text, nothing)
    return html.unescape(re.sub(r"<svg.*?</svg>|<[^>]*>", "", page, flags=re.DOTALL))


def test_the_gap_is_that_of_the_case_with_few_motions(tmp_path):
    (tmp_path / "case.toml").write_text(TEXT, encoding="utf-8")
    case = sl.read_case(tmp_path / "case.toml")
    few = dataclasses.replace(case.simulated, paths=PATHS_OF_ANSWER)
    expected = answer_case(dataclasses.replace(case, simulated=few))
    page = answered(gap_of, TEXT.replace('title = "', 'title = "<b>'), tmp_path)
    for sentence in first_lines(expected):
        assert sentence in page
    shown = [answer.separation.gap for answer in (gap_by_few_motions(case), expected)]
    xr.testing.assert_identical(*shown)
    assert f"From {PATHS_OF_ANSWER} motions; 'stochlin gap' takes more" in page
    assert "RuleGap [cm]Error" in page


def test_names_are_no_html(tmp_path):
    text = TEXT.replace('"Annex"', '"<img src=x onerror=alert(1)>"')
    page = gap_of(str(tmp_path), "case.toml", text, nothing)
    assert "<img" not in page
    assert "&lt;img" in page


@pytest.mark.slow
def test_storeys_have_a_gap_and_no_correlation(tmp_path):
    assert "should stand" in answered(gap_of, STOREYS, tmp_path)
    with pytest.raises(ValueError, match="is that of two oscillators"):
        answered(correlation_of, STOREYS, tmp_path)


def test_the_correlation_is_that_of_correlate(tmp_path):
    (tmp_path / "case.toml").write_text(TEXT, encoding="utf-8")
    case = sl.read_case(tmp_path / "case.toml")
    first, second = case.buildings[0].structure, case.buildings[1].structure
    narrow, broad = correlations(case)
    expected = sl.correlate(first, second, case.site.ground)
    own = narrow.linearized.sel(period_ratio=0.6, method="nearest")
    assert float(own) == pytest.approx(float(expected.rho), rel=1e-9)
    white = sl.WhiteNoise(float(case.site.ground.psd(2 * np.pi / first.period)))
    wide = broad.linearized.sel(period_ratio=0.6, method="nearest")
    assert float(wide) == pytest.approx(float(sl.correlate(first, second, white).rho), rel=1e-9)
    for on in (narrow, broad):
        near = on.linearized.interp(period_ratio=on.simulated.period_ratio)
        assert float(abs(near - on.simulated.rho).max()) < 0.25
    assert "On white noise: ρ = 0.63 linearized" in answered(correlation_of, TEXT, tmp_path)


def test_what_progress_raises_stops_an_answer(tmp_path):
    class Enough(Exception):  # noqa: N818
        pass

    def stop(share: float) -> None:
        raise Enough

    for question in (gap_of, correlation_of):
        with pytest.raises(Enough):
            question(str(tmp_path), "case.toml", TEXT, stop)
