"""Pictures for print: of the width of a column, without words of their own, in text of 7 points."""

from pathlib import Path

import pytest
import xarray as xr
from matplotlib.text import Text

import stochlin as sl

pytestmark = pytest.mark.cli

FIGURES = sorted((Path(__file__).parents[2] / "figures").glob("*.nc"))
NAMES = ("fig4b", "fig5a", "fig5b", "fig6", "fig9")
COLUMNS = (0.084, 0.174)  # m


def drawn(name, width):
    with xr.open_dataset(FIGURES[0].with_name(f"{name}.nc")) as chart:
        chart.load()
    seconds = (False, True) if "comparison" in chart.attrs else (False,)
    for comparison in seconds:
        figure = sl.charts.draw(chart, comparison=comparison, print_width=width)
        figure.draw_without_rendering()
        yield figure


def texts_of(figure):
    return [text for text in figure.findobj(Text) if text.get_text() and text.get_visible()]


@pytest.mark.slow
@pytest.mark.parametrize("width", COLUMNS)
@pytest.mark.parametrize("name", NAMES)
def test_pictures_fit_a_column_and_are_legible_in_it(name, width):
    for figure in drawn(name, width):
        assert figure.get_figwidth() * 0.0254 == pytest.approx(width)
        assert figure.get_figheight() * 0.0254 < 0.28  # a page
        assert min(text.get_size() for text in texts_of(figure)) >= 7
        room = figure.bbox
        for axes in figure.axes:
            box = axes.get_tightbbox()
            assert -1 < box.x0 < box.x1 < room.width + 1
            assert -1 < box.y0 < box.y1 < room.height + 1
        for legend in figure.legends:
            box = legend.get_window_extent()
            assert box.x1 < room.width
            assert all(axes.get_tightbbox().y1 < box.y0 + 1 for axes in figure.axes)


@pytest.mark.parametrize("width", [0.01, "84mm", float("nan")])
def test_a_width_that_is_none_is_refused(width):
    chart = sl.charts.white_noise_chart(sl.charts.ChartSettings(points=5))
    with pytest.raises(ValueError, match=r"print_width = .*; allowed: 0.08 to 0.25 m"):
        sl.charts.draw(chart, print_width=width)


def test_a_chart_without_other_methods_has_no_second_picture():
    chart = sl.charts.white_noise_chart(sl.charts.ChartSettings(points=5))
    with pytest.raises(ValueError, match="attribute comparison = None is not a known chart"):
        sl.charts.draw(chart, comparison=True)
