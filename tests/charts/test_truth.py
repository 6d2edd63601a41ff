"""Figs. 3b, 4 and 5a show what the methods compute, and count no simulated point of slow drift."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from commands import answered, refused

import stochlin as sl

pytestmark = pytest.mark.paper

JENG, IWAN = "jeng_kasai_maison_1992_unverified", "iwan_1980"
PUBLISHED = "Jeng, Kasai and Maison (1992), constants unverified"
SETTINGS = sl.charts.ChartSettings(
    points=5, simulated_points=3, paths=32, reduction_factors=(2.0, 4.0)
)
CHARTS = sl.charts.chart_functions(SETTINGS)
LAKEBED = sl.KanaiTajimi(2.0, 0.05)


def pair(ratio, factor):
    """Those of Fig. 4c."""
    return [
        sl.Bilinear(period, 0.05, 0.05, reduction_factor=factor) for period in (ratio * 1.0, 1.0)
    ]


def words(figure):
    """All that a picture says of its curves, on one line each."""
    legends = [*figure.legends, *(axes.get_legend() for axes in figure.axes)]
    texts = [text.get_text() for one in legends if one is not None for text in one.get_texts()]
    return [" ".join(text.split()) for text in texts]


@pytest.fixture(scope="module")
def both_grounds():
    return CHARTS["fig4c"]()


@pytest.fixture(scope="module")
def fig4c():
    """On narrow-band ground, with all digits."""
    return sl.charts.period_ratio_chart(SETTINGS, LAKEBED, frequency_ratio=2.0)


@pytest.fixture(scope="module")
def fig5a():
    return sl.charts.period_plane_chart(SETTINGS, LAKEBED)


def test_the_drift_closure_and_elastic_structures_stand_beside_linearization(fig4c):
    ratio, factor = fig4c.period_ratio, fig4c.reduction_factor
    drift = sl.correlate(*pair(ratio, factor), LAKEBED, closure="drift")
    np.testing.assert_array_equal(fig4c.rho_drift, drift.rho.transpose(*fig4c.rho.dims))
    elastic = [sl.Bilinear(period, 0.05) for period in (ratio * 1.0, 1.0)]
    for name, method in (("elastic", "linearization"), ("white_noise", "white_noise")):
        expected = sl.correlate(*elastic, LAKEBED, method).rho
        np.testing.assert_allclose(fig4c[f"rho_{name}"], expected, rtol=1e-12)


def test_rules_of_fig3b_end_at_the_ductility_to_which_they_were_fitted():
    ends = {IWAN: [True, False, False], "fema_440": [True, True, False], "penzien_1997": [True] * 3}
    charts = [sl.charts.effective_rules_chart(0.05, 0.05, mu, 5) for mu in (4.0, 9.0, 11.0)]
    for rule, there in ends.items():
        drawn = [bool(chart.rho.sel(rule=rule).notnull().all()) for chart in charts]
        assert drawn == there, rule


def test_a_chart_of_both_grounds_is_that_of_each_side_by_side(both_grounds, fig4c):
    assert both_grounds.ground.values.tolist() == ["narrow band, ξg = 0.05", "broad band, ξg = 0.6"]
    broad = sl.charts.period_ratio_chart(SETTINGS, sl.KanaiTajimi(2.0, 0.6), frequency_ratio=2.0)
    for ground, alone in zip(both_grounds.ground, (fig4c, broad), strict=True):
        for name in ("rho", "rho_drift", "rho_simulated", "rho_in_motions", "rho_elastic"):
            np.testing.assert_allclose(
                both_grounds[name].sel(ground=ground), alone[name], rtol=6e-6, atol=1e-9
            )
        error = re.search(r"linearized ([\d.]+ \([\d.]+\))", alone.attrs["comment"])[1]
        assert error in both_grounds.attrs["comment"]


def test_points_with_a_slow_drift_are_open_with_motions_beside_them_and_in_no_error(fig4c):
    slow = (fig4c.drift_memory > 60).transpose(*fig4c.rho.dims)
    assert bool(slow.any())
    assert bool((fig4c.rho_simulated.notnull() & ~slow).any())
    np.testing.assert_array_equal(fig4c.rho_in_motions.notnull(), slow)
    ground = replace(LAKEBED, intensity=0.01)
    factor, ratio = slow.stack(cell=slow.dims).idxmax().item()
    solid = [
        replace(
            each,
            reduction_factor=None,
            yield_displacement=sl.linearize(each, ground).yield_displacement,
        )
        for each in pair(float(ratio), float(factor))
    ]
    envelope = sl.AminAng(4.0, 15.0, 0.35)
    motions = sl.simulated_motions(ground, 30.0, envelope, paths=32, step=0.02)
    samples = [float(sl.recorded_gap(*solid, motion).rho) for motion in motions]
    there = fig4c.rho_in_motions.sel(reduction_factor=factor, period_ratio=ratio)
    assert float(there) == pytest.approx(np.mean(samples), abs=1e-9)
    settled = np.abs(fig4c.rho - fig4c.rho_simulated).where(~slow)
    assert f"linearized {float(settled.mean()):.2g} ({float(settled.max()):.2g})" in fig4c.comment
    lines = [line for line in sl.charts.draw(fig4c).axes[0].lines if line.get_linestyle() == "None"]
    faces = {line.get_markerfacecolor() for line in lines if line.get_marker() in "os^D"}
    assert "w" in faces
    assert len(faces) > 1


def test_the_drift_closure_is_nearer_to_simulation_than_linearization(fig4c):
    off = np.abs(fig4c[["rho", "rho_drift"]] - fig4c.rho_simulated).where(fig4c.drift_memory <= 60)
    assert float(off.rho_drift.mean()) < 0.05 < float(off.rho.mean())


def test_the_plain_picture_has_a_panel_a_ground_and_a_curve_with_points_a_strength(both_grounds):
    figure = sl.charts.draw(both_grounds)
    assert [axes.get_title("left") for axes in figure.axes] == [
        r"narrow band, $\xi_{g}$ = 0.05",
        r"broad band, $\xi_{g}$ = 0.6",
    ]
    entries = ["R = 2", "R = 4", r"$\rho$, linearized", r"$\rho$ by the drift closure"]
    points = [
        r"$\rho$, simulated",
        "simulated, drift slower than any motion",
        r"$\rho$ in motions of 30 s",
    ]
    assert words(figure) == [*entries, *points]


def test_without_simulation_a_chart_keeps_its_caution():
    quick = sl.charts.chart_functions(replace(SETTINGS, simulated_points=0))
    for name in ("fig4a", "fig5a"):
        chart = quick[name]()
        assert "Caution" in chart.attrs["comment"]
        assert "rho_simulated" not in chart
        assert sl.charts.draw(chart).axes


def test_fig3b_names_the_rules_as_published_with_the_doubt_in_their_constants():
    chart = sl.charts.chart_functions(replace(SETTINGS, curves=(JENG, "FEMA-440")))["fig3b"]()
    assert chart.rule.values.tolist() == [JENG, "fema_440"]
    assert words(sl.charts.draw(chart)) == [PUBLISHED, "FEMA-440"]
    assert chart.mark.values[0] == "M low"
    assert "constants in doubt, not compared with their source" in chart.attrs["comment"]
    assert "Jeng, Kasai and Maison (1992), Earthquake Spectra" in chart.attrs["references"]


def test_the_comparison_of_fig4_has_all_methods_in_a_panel_for_each_strength(both_grounds):
    figure = sl.charts.draw(both_grounds, comparison=True)
    titles = [axes.get_title("left") for axes in figure.axes]
    assert titles[::2] == [rf"R = {r}, narrow band, $\xi_{{g}}$ = 0.05" for r in (2, 4)]
    panel, curve = figure.axes[0], both_grounds.isel(reduction_factor=0, ground=0)
    drawn = [line.get_ydata() for line in panel.lines if line.get_linestyle() != "None"]
    for name in ("rho", "rho_drift", "rho_elastic", "rho_white_noise"):
        assert any(np.array_equal(curve[name], values) for values in drawn), name


@pytest.mark.slow
def test_the_comparison_of_fig5a_is_white_where_the_drift_is_slow(fig5a):
    figure = sl.charts.draw(fig5a, comparison=True)
    titles = [axes.get_title("left") for axes in figure.axes if axes.get_title("left")]
    assert titles == ["linearized", "drift closure", "simulated"]
    # The planes of linearization and of simulation, and the bar of their shades.
    assert len(sl.charts.draw(fig5a).axes) == 3


def test_the_charts_of_a_motion_are_those_of_a_record(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("record.at2").write_text(answered("gap", "--example-record").output, encoding="utf-8")
    assert (
        "1 charts" in answered("charts", "fig2", "--record", "record.at2", "--points", "5").output
    )
    record = sl.read_record("record.at2")
    with xr.open_dataset("figures/fig2.nc") as chart:
        expected = sl.charts.recorded_gap_chart(record, 0.05, 5)
        # Files of charts have six digits.
        np.testing.assert_allclose(chart.critical_gap, expected.critical_gap, rtol=1e-5)
    assert "--units or --dt is given without --record" in refused("charts", "fig2", "--units", "g")
