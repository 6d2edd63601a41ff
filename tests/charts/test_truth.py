"""Figs. 3b, 4 and 5a show what the methods compute, and count no simulated point with a slow drift."""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from commands import invoke

import stochlin as sl
from stochlin.models.rules.effective_properties import EFFECTIVE_RULES

pytestmark = pytest.mark.paper

JENG, IWAN = "jeng_kasai_maison_1992_unverified", "iwan_1980"
USUAL = ["penzien_1997", IWAN]
PUBLISHED = "Jeng, Kasai and Maison (1992), constants unverified"
SETTINGS = sl.charts.ChartSettings(points=5, simulated_points=3, paths=32, reduction_factors=(2.0, 4.0))
CHARTS = sl.charts.chart_functions(SETTINGS)
LAKEBED = sl.KanaiTajimi(2.0, 0.05)


def pair(ratio, factor):
    """Those of Fig. 4c."""
    return [sl.Bilinear(period, 0.05, 0.05, reduction_factor=factor) for period in (ratio * 1.0, 1.0)]


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


def test_what_stands_beside_linearization_is_what_the_methods_say(fig4c):
    ratio, factor = fig4c.period_ratio, fig4c.reduction_factor
    drift = sl.correlate(*pair(ratio, factor), LAKEBED, closure="drift")
    np.testing.assert_array_equal(fig4c.rho_drift, drift.rho.transpose(*fig4c.rho.dims))
    both = {f"{name}_{n}": 0.05 for name in ("damping", "hardening") for n in (1, 2)}
    ductilities = {f"ductility_{n}": 3 * drift[f"ductility_std_{n}"] for n in (1, 2)}
    for rule in USUAL:
        largest = sl.rules.effective_rule(rule).largest_ductility
        expected = sl.rules.rho_effective(ratio * 1.0, 1.0, **both, **ductilities, rule=rule).rho
        for ductility in ductilities.values():
            expected = expected.where(ductility <= largest)
        np.testing.assert_allclose(
            fig4c.rho_effective.sel(rule=rule), expected.transpose(*fig4c.rho.dims), rtol=1e-12
        )
    assert bool(fig4c.rho_effective.sel(rule=IWAN).isnull().any())  # beyond a ductility of 8


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
        for name in (
            "rho",
            "rho_drift",
            "rho_simulated",
            "rho_in_motions",
            "rho_effective",
            "rho_elastic",
        ):
            np.testing.assert_allclose(
                both_grounds[name].sel(ground=ground), alone[name], rtol=6e-6, atol=1e-9
            )
        assert alone.attrs["comment"].splitlines()[0] in both_grounds.attrs["comment"]


def test_simulated_points_are_those_of_correlate(fig4c, fig5a):
    there = fig4c.rho_simulated.notnull()
    assert there.sum("period_ratio").values.tolist() == [3, 3]
    assert int(fig5a.rho_simulated.notnull().sum()) == 3 * 3
    known = fig4c.where(there.all("reduction_factor"), drop=True)
    table = sl.correlate(
        *pair(known.period_ratio, known.reduction_factor), LAKEBED, "simulation", paths=64, seed=1
    )
    error = 4 * np.hypot(known.rho_standard_error, table.rho_standard_error) + 1e-12
    assert bool((np.abs(known.rho_simulated - table.rho) <= error).all())


def test_points_with_a_slow_drift_are_open_with_motions_beside_them_and_in_no_error(fig4c):
    slow = (fig4c.drift_memory > 60).transpose(*fig4c.rho.dims)
    assert bool(slow.any())
    assert bool((fig4c.rho_simulated.notnull() & ~slow).any())
    np.testing.assert_array_equal(fig4c.rho_in_motions.notnull(), slow)
    ground = replace(LAKEBED, intensity=0.01)
    factor, ratio = slow.stack(cell=slow.dims).idxmax().item()
    solid = [
        replace(
            each, reduction_factor=None, yield_displacement=sl.linearize(each, ground).yield_displacement
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
    entries = ["R = 2", "R = 4", r"$\rho$, linearized", r"$\rho$, simulated", "simulated, slow drift"]
    assert words(figure) == [*entries, r"$\rho$ in motions of 30 s"]


def test_fig4_has_a_panel_for_each_reduction_factor_with_all_methods_in_it(fig4c):
    figure = sl.charts.draw(fig4c, comparison=True)
    assert [axes.get_title("left") for axes in figure.axes] == ["R = 2", "R = 4"]
    rules = "Penzien (1997)", "Iwan (1980)"
    curves = ["linearized", "drift closure", *rules, "elastic, this ground", "elastic, eq. (4)"]
    assert set(curves) < set(words(figure))


@pytest.mark.slow
def test_fig5a_shows_four_planes_and_a_difference_with_its_signs(fig5a):
    figure = sl.charts.draw(fig5a, comparison=True)
    titles = [axes.get_title("left") for axes in figure.axes if axes.get_title("left")]
    assert titles == ["linearized", "drift closure", "simulated", "difference"]
    (difference,) = (axes for axes in figure.axes if axes.get_title("left") == "difference")
    filled = next(one for one in difference.collections if getattr(one, "filled", False))
    edges = np.asarray(filled.norm.boundaries)
    np.testing.assert_array_equal(edges, -edges[::-1])
    assert filled.cmap(filled.norm(0.0))[:3] == pytest.approx([0.965] * 3, abs=0.02)  # white about zero
    assert len(sl.charts.draw(fig5a).axes) == 2  # the linearized plane, and the bar of its shades


@pytest.mark.parametrize("name", ["fig3b", "fig4b"])
def test_rules_are_named_and_drawn_under_their_published_names(name):
    chart = sl.charts.chart_functions(replace(SETTINGS, curves=(JENG, "FEMA-440")))[name]()
    assert chart.rule.values.tolist() == [JENG, "fema_440"]
    said = words(sl.charts.draw(chart, comparison=name == "fig4b"))
    assert {PUBLISHED, "FEMA-440"} <= set(said)
    assert not [text for text in said if "_" in text]
    assert "Jeng, Kasai and Maison (1992), Earthquake Spectra" in chart.attrs["references"]


def test_fig3b_is_marked_as_its_constants_are():
    chart = sl.charts.effective_rules_chart(0.05, 0.05, 4.0, 9, rules=[JENG])
    assert chart.mark.item() == "M low"
    assert "constants in doubt, not compared with their source" in chart.attrs["comment"]
    both = {f"{name}_{n}": 0.05 for name in ("damping", "hardening") for n in (1, 2)}
    both |= {"ductility_1": 4.0, "ductility_2": 4.0}
    expected = sl.rules.rho_effective(chart.period_ratio, 1.0, **both, rule=JENG)
    np.testing.assert_array_equal(chart.rho[0], expected.rho)


def test_no_rule_is_shown_by_a_name_of_the_code():
    for name in EFFECTIVE_RULES:
        for shown in (sl.charts.rule_label(name), sl.charts.rule_label(f"eq_3_{name}")):
            assert "_" not in shown
            assert ("unverified" in shown) == ("unverified" in name)


def test_without_simulation_a_chart_keeps_its_caution():
    quick = sl.charts.chart_functions(replace(SETTINGS, simulated_points=0))
    for name in ("fig4a", "fig5a"):
        chart = quick[name]()
        assert "Caution" in chart.attrs["comment"]
        assert "rho_simulated" not in chart
        assert sl.charts.draw(chart).axes


@pytest.mark.slow
def test_the_drift_closure_does_not_stand_beside_itself():
    chart = sl.charts.chart_functions(replace(SETTINGS, closure="drift"))["fig5a"]()
    assert "rho_drift" not in chart
    figure = sl.charts.draw(chart, comparison=True)
    assert len([axes for axes in figure.axes if axes.get_title("left")]) == 3 * 2


def test_the_command_takes_curves_by_name(tmp_path):
    def run(*given):
        return invoke("charts", "fig3b", *given, "--points", "9", "--out", tmp_path)

    assert run("--curves", f"{JENG},iwan-1980").exit_code == 0
    with xr.open_dataset(tmp_path / "fig3b.nc") as chart:
        assert chart.rule.values.tolist() == [JENG, IWAN]
    assert run("--curves", "jeng").exit_code == 2
