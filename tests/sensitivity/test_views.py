"""What matters in words, as a picture, and in the page of a case."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from cases import example_case
from click.testing import CliRunner

import stochlin as sl
from stochlin.views.command import main
from stochlin.views.sensitivity.tornado import blocks, rows
from stochlin.views.shared.blocks import ViewSection
from stochlin.views.shared.screen import lines
from stochlin.views.shared.words import MINUS, NBSP

pytestmark = pytest.mark.cli
GROUND = sl.KanaiTajimi(0.4, 0.6, 0.01)
KNOWN = sl.Bilinear(1.0, 0.05)


@pytest.fixture(scope="module")
def table():
    first = sl.Bilinear(sl.Uncertain(0.6, 0.25), sl.Uncertain.between(0.03, 0.07))
    return sl.sensitivity(first, KNOWN, GROUND, 12.0, paths=32)


def test_rows_begin_with_what_is_uncertain_and_moves_the_gap_most(table):
    shown = rows(table)
    moves = [float(np.abs(table.gap_change[row.place]).max()) for row in shown]
    for part in (moves[:2], moves[2:]):
        assert part == sorted(part, reverse=True)
    by_label = {row.label: row for row in shown}
    period, known = by_label["period of building 1"], by_label["intensity of the ground"]
    assert shown.index(period) < 2 < shown.index(known) + 1
    assert (period.range, period.kind) == (f"0.468 to 0.769{NBSP}s", f"16 to 84{NBSP}%")
    assert (known.range, known.kind) == (f"0.009 to 0.011{NBSP}m²/s³", f"±{NBSP}10{NBSP}%")
    low, high = 100 * table.gap_change[period.place].values
    assert period.change == f"{low:+.1f} / {high:+.1f}".replace("-", MINUS)


def test_sentences_name_what_matters(table):
    names = {"structure_1": "Annex", "structure_2": "Tower", "ground": "the site"}
    said = lines([ViewSection("Influence of the inputs", blocks(table, names))])
    assert f"The gap depends most on the {rows(table, names)[0].label}" in " ".join(said)
    less = 100 * float(table.gap_of_medians / table.gap - 1)
    assert f"at their medians, the gap would be {abs(less):.0f} ± " in " ".join(
        " ".join(said).split()
    )
    assert all(len(line) <= 100 for line in said)


def test_a_tornado_chart_has_a_bar_a_number(table):
    figure = sl.charts.draw_sensitivity(table)
    (axes,) = figure.axes
    bars = [bar.get_width() for bar in axes.patches]
    count = len(rows(table))  # all low ends, then all high ones
    np.testing.assert_allclose(bars[::count], 100 * table.gap_change[rows(table)[0].place])
    assert len(bars) == 2 * count
    low, high = axes.patches[::count]
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
    page = tmp_path / "page.html"
    options = ["--report", str(page)]
    result = CliRunner().invoke(main, ["gap", str(tmp_path / "case.toml"), *options])
    assert result.exit_code == 0, result.output
    assert "Influence of the inputs:" in result.output
    assert "period of Annex" in page.read_text(encoding="utf-8").split("Influence of the inputs")[1]
