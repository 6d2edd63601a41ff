"""What matters in words, as a picture, and in the page of a case."""

from __future__ import annotations

import re

import numpy as np
import pytest
import xarray as xr
from cases import example_case
from click.testing import CliRunner

import stochlin as sl
from stochlin.views.command import main
from stochlin.views.sensitivity.words import blocks, rows, sentences
from stochlin.views.shared.blocks import ViewSection
from stochlin.views.shared.screen import lines
from stochlin.views.shared.words import MINUS, SPACE

pytestmark = pytest.mark.cli
GROUND = sl.KanaiTajimi(0.4, 0.6, 0.01)
KNOWN = sl.Bilinear(1.0, 0.05)


@pytest.fixture(scope="module")
def table():
    first = sl.Bilinear(sl.Uncertain(0.6, 0.25), sl.Uncertain.between(0.03, 0.07))
    return sl.sensitivity(first, KNOWN, GROUND, 12.0, paths=64)


@pytest.mark.slow
def test_rows_begin_with_what_is_uncertain_and_moves_the_gap_most(table):
    shown = rows(table)
    assert [row.uncertain for row in shown[:3]] == [True, True, False]
    moves = [float(np.abs(table.gap_change[row.place]).max()) for row in shown]
    for part in (moves[:2], moves[2:]):
        assert part == sorted(part, reverse=True)
    period = next(row for row in shown if row.label == "period of building 1")
    assert period.range == f"0.468 to 0.769{SPACE}s"
    assert re.fullmatch(rf"[+{MINUS}]\d\.\d / [+{MINUS}]\d\.\d", period.change)
    intensity = next(row for row in shown if row.label == "(intensity of the ground)")
    assert intensity.range == f"0.009 to 0.011{SPACE}m²/s³"


def test_sentences_name_what_matters(table):
    names = {"structure_1": "Annex", "structure_2": "Tower", "ground": "the site"}
    first, medians = sentences(table, names)
    assert re.match(r"Among the uncertain inputs, the gap depends most on the \w+ of Annex: ", first)
    assert "If all inputs were known" in medians
    assert all(
        len(line) <= 100 for line in lines([ViewSection("Influence of the inputs", blocks(table))])
    )


def test_a_tornado_chart_has_a_bar_a_number(table):
    figure = sl.charts.draw_sensitivity(table)
    (axes,) = figure.axes
    bars = [bar.get_width() for bar in axes.patches]
    np.testing.assert_allclose(bars[:2], 100 * table.gap_change[rows(table)[0].place])
    assert len(bars) == 2 * len(rows(table))
    low, high = (axes.patches[n] for n in (0, 1))
    assert low.get_hatch()  # told apart in grey
    assert not high.get_hatch()
    with pytest.raises(ValueError, match="a dataset that sensitivity returns"):
        sl.charts.draw_sensitivity(xr.Dataset())


@pytest.mark.slow
def test_the_page_of_a_case_with_uncertain_periods(tmp_path):
    text = example_case().replace('period = "0.6 s"', 'period = "0.6 s +- 25 %"')
    text = text.replace('existing = "5 cm"', "").replace("paths = 2048", "paths = 100")
    text = text.replace('duration = "20 s"', 'duration = "16 s"')
    (tmp_path / "case.toml").write_text(text, encoding="utf-8")
    page, picture = tmp_path / "page.html", tmp_path / "tornado.svg"
    options = ["--report", str(page), "--sensitivity", str(picture)]
    result = CliRunner().invoke(main, ["gap", str(tmp_path / "case.toml"), *options])
    assert result.exit_code == 0, result.output
    assert "Influence of the inputs:" in result.output
    assert "period of Annex" in page.read_text(encoding="utf-8").split("Influence of the inputs")[1]
    with xr.open_dataset(picture.with_suffix(".nc")) as saved:
        assert saved.uncertain.values.tolist().count(1) == 1
        assert len(sl.charts.draw_sensitivity(saved).axes) == 1
