"""Which picture a chart dataset becomes: the one its attribute names."""

from dataclasses import replace

import matplotlib as mpl
import numpy as np
import pytest
import xarray as xr
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.contour import ContourSet
from matplotlib.figure import Figure

import stochlin as sl
from stochlin.views.figures.pictures import contour_levels, planes

pytestmark = pytest.mark.invariant

SETTINGS = sl.charts.ChartSettings(points=5, paths=4, simulated_points=3, reduction_factors=(6.0,))


@pytest.mark.slow
def test_every_kind_of_picture_belongs_to_a_chart():
    charts = [compute() for compute in sl.charts.chart_functions(SETTINGS).values()]
    charts.append(sl.charts.chart_functions(replace(SETTINGS, simulated_points=0))["fig5a"]())
    kinds = {
        chart.attrs[key]
        for chart in charts
        for key in ("chart", "comparison")
        if key in chart.attrs
    }
    assert kinds == set(sl.charts.PICTURES)


def test_what_is_no_chart_is_refused_with_the_kinds_there_are():
    for attrs in ({}, {"chart": "pie"}):
        with pytest.raises(
            ValueError, match=r"attribute chart = .* known chart; allowed: .*curves"
        ):
            sl.charts.draw(xr.Dataset(attrs=attrs))


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("reduction_factors", (4.0, -1.0)),
        ("reduction_factors", (float("nan"),)),
        ("plane_reduction_factor", 0),
        ("damping", 5),
        ("hardening", "stiff"),
        ("ground_period", None),
    ],
)
def test_settings_out_of_range_are_refused_before_any_work(name, value):
    with pytest.raises(ValueError, match=f"{name} = .*; allowed: "):
        sl.charts.ChartSettings(**{name: value})


def test_pictures_have_a_style_of_their_own_that_can_be_switched_off():
    """The settings of matplotlib are the user's before and after; without a style in pictures."""
    chart, usual = sl.charts.white_noise_chart(SETTINGS), dict(sl.charts.STYLE)
    with mpl.rc_context({"font.size": 17.0}):
        before = dict(mpl.rcParams)
        ours = sl.charts.draw(chart)
        assert dict(mpl.rcParams) == before
        try:
            sl.charts.STYLE.clear()
            theirs = sl.charts.draw(chart)
        finally:
            sl.charts.STYLE.update(usual)
    sizes = [one.axes[0].xaxis.label.get_fontsize() for one in (ours, theirs)]
    assert sizes == [usual["font.size"], 17.0]


def test_every_tenth_has_a_number_on_its_contour_that_is_not_cut():
    """They keep away from the edges, and no line is drawn along a ridge at the highest level."""
    x = np.linspace(0.1, 4.0, 41)
    rho = xr.DataArray(
        np.exp(-np.abs(np.subtract.outer(x, x))),
        dims=("a", "b"),
        coords={"a": x, "b": x},
        name="rho",
    )
    figure = FigureCanvasAgg(Figure()).figure
    axes = figure.add_subplot()
    planes(figure, [axes], [("", rho)], contour_levels(rho))
    labels = [text for text in axes.texts if text.get_text()]
    assert sorted({text.get_text() for text in labels}) == [f"0.{n}" for n in range(1, 10)]
    frame = axes.get_window_extent()
    for text in labels:
        box = text.get_window_extent(figure.canvas.get_renderer())
        assert frame.x0 < box.x0 < box.x1 < frame.x1
        assert frame.y0 < box.y0 < box.y1 < frame.y1
    drawn = [
        lines for lines in axes.collections if isinstance(lines, ContourSet) and not lines.filled
    ]
    assert max(drawn[0].levels) < 1
