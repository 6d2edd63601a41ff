"""Figs. 3b, 4 and 5a: effective rules, the drift closure and simulation beside linearization."""

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
SHOWN = "Penzien (1997)", "Iwan (1980)"
PUBLISHED = "Jeng, Kasai and Maison (1992), constants unverified", "Iwan (1980)"
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
    assert fig4c.rule.values.tolist() == USUAL
    given = {"damping": 0.05, "hardening": 0.05}
    both = {f"{name}_{n}": value for name, value in given.items() for n in (1, 2)}
    for n in (1, 2):
        both[f"ductility_{n}"] = 3 * drift[f"ductility_std_{n}"]
        np.testing.assert_allclose(fig4c[f"ductility_peak_{n}"], both[f"ductility_{n}"], rtol=1e-12)
    for rule in USUAL:
        expected = sl.rules.rho_effective(ratio * 1.0, 1.0, **both, rule=rule).rho
        for n in (1, 2):
            expected = expected.where(
                both[f"ductility_{n}"] <= sl.rules.effective_rule(rule).largest_ductility
            )
        np.testing.assert_allclose(
            fig4c.rho_effective.sel(rule=rule), expected.transpose(*fig4c.rho.dims), rtol=1e-12
        )


def test_rules_end_at_the_ductility_to_which_they_were_fitted(fig4c):
    beyond = (fig4c.ductility_peak_1 > 8) | (fig4c.ductility_peak_2 > 8)
    assert bool(beyond.any())
    assert not bool(beyond.all())
    np.testing.assert_array_equal(
        fig4c.rho_effective.sel(rule=IWAN).isnull(), beyond.transpose(*fig4c.rho.dims)
    )
    several = sl.charts.effective_rules_chart(0.05, 0.05, [4.0, 9.0, 11.0], 5)
    assert several.rho.dims == ("ductility", "rule", "period_ratio")
    there = several.rho.notnull().all("period_ratio")
    assert there.sel(rule=IWAN).values.tolist() == [True, False, False]
    assert there.sel(rule="fema_440").values.tolist() == [True, True, False]
    assert bool(there.sel(rule="penzien_1997").all())


def test_a_chart_of_both_grounds_is_that_of_each_side_by_side(both_grounds, fig4c):
    assert both_grounds.ground.values.tolist() == ["narrow band, ξg = 0.05", "broad band, ξg = 0.6"]
    broad = sl.charts.period_ratio_chart(SETTINGS, sl.KanaiTajimi(2.0, 0.6), frequency_ratio=2.0)
    for ground, alone in zip(both_grounds.ground, (fig4c, broad), strict=True):
        for name in ("rho", "rho_drift", "rho_simulated", "rho_effective", "rho_elastic"):
            np.testing.assert_allclose(
                both_grounds[name].sel(ground=ground), alone[name], rtol=6e-6, atol=1e-9
            )
        assert alone.attrs["comment"] in both_grounds.attrs["comment"]
    assert "Tg = 2 s, ξg = 0.05 and 0.6; T2 = 1 s" in both_grounds.attrs["caption"]


def test_the_plain_picture_has_a_panel_a_ground_and_a_curve_with_points_a_strength(both_grounds):
    figure = sl.charts.draw(both_grounds)
    assert [axes.get_title("left") for axes in figure.axes] == [
        r"narrow band, $\xi_{g}$ = 0.05",
        r"broad band, $\xi_{g}$ = 0.6",
    ]
    assert words(figure) == ["R = 2", "R = 4", r"$\rho$, linearized", r"$\rho$, simulated"]
    for axes in figure.axes:
        curves = [line for line in axes.get_lines() if len(line.get_xdata()) == 9]
        assert len({str(line._dash_pattern) for line in curves}) == 2
        dots = [line for line in axes.get_lines() if len(line.get_xdata()) == 3]
        assert [line.get_color() for line in dots] == [line.get_color() for line in curves]
        assert len({line.get_marker() for line in dots}) == 2


def test_simulated_points_stand_among_the_others_with_their_error_and_difference(fig4c, fig5a):
    there = fig4c.rho_simulated.notnull()
    assert there.sum("period_ratio").values.tolist() == [3, 3]
    np.testing.assert_array_equal(fig4c.rho_standard_error.notnull(), there)
    np.testing.assert_array_equal(fig4c.rho_difference, fig4c.rho - fig4c.rho_simulated)
    assert int(fig5a.rho_simulated.notnull().sum()) == 3 * 3
    known = fig4c.where(there.all("reduction_factor"), drop=True)
    table = sl.correlate(
        *pair(known.period_ratio, known.reduction_factor), LAKEBED, "simulation", paths=64, seed=1
    )
    error = 4 * np.hypot(known.rho_standard_error, table.rho_standard_error) + 1e-12
    assert bool((np.abs(known.rho_simulated - table.rho) <= error).all())
    assert "Simulated on 32 paths; standard error at most" in fig4c.attrs["comment"]
    assert "Caution" not in fig4c.attrs["comment"]


def test_every_variable_has_units_and_a_name(fig4c, fig5a):
    for chart in (fig4c, fig5a):
        for name, variable in chart.variables.items():
            assert variable.attrs["long_name"], name
            assert "units" in variable.attrs or variable.dtype.kind in "Ub" or name == "status", name


def test_the_drift_closure_is_nearer_to_simulation_than_linearization_and_rules(fig4c):
    off = {
        name: float(np.abs(fig4c[name] - fig4c.rho_simulated).mean()) for name in ("rho", "rho_drift")
    }
    assert off["rho_drift"] < 0.05 < off["rho"]
    derived = np.abs(fig4c.rho_effective.sel(rule="penzien_1997") - fig4c.rho_simulated)
    assert off["rho_drift"] < 0.6 * float(derived.mean())
    for name in ("linearized", "drift closure"):
        assert f"{name} " in fig4c.attrs["comment"]


def test_fig4_has_a_panel_for_each_reduction_factor_with_all_methods_in_it(fig4c):
    figure = sl.charts.draw(fig4c, comparison=True)
    assert [axes.get_title("left") for axes in figure.axes] == ["R = 2", "R = 4"]
    told = ["linearized", "drift closure", *SHOWN, "elastic, this ground", "elastic, eq. (4)"]
    assert sorted(words(figure)) == sorted([*told, r"$\rho$, simulated"])
    for axes in figure.axes:
        looks = {(line.get_color(), str(line._dash_pattern)) for line in axes.get_lines()}
        assert len(looks) == len(told) + 1
        (points,) = (line for line in axes.get_lines() if line.get_marker() == "o")
        assert np.isfinite(np.asarray(points.get_ydata(), float)).sum() == 3
    figure.draw_without_rendering()
    assert figure.legends[0].get_window_extent().y0 >= figure.axes[0].get_window_extent().y1


@pytest.mark.slow
def test_fig5a_shows_four_planes_and_a_difference_with_its_signs(fig5a):
    figure = sl.charts.draw(fig5a, comparison=True)
    titles = [axes.get_title("left") for axes in figure.axes if axes.get_title("left")]
    assert titles == ["linearized", "drift closure", "simulated", "difference"]
    (difference,) = (axes for axes in figure.axes if axes.get_title("left") == "difference")
    signs = {text.get_text()[0] for text in difference.texts}
    assert signs <= set("+-\N{MINUS SIGN}")
    assert "+" in signs
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
    assert {PUBLISHED[0], "FEMA-440"} <= set(said)
    assert not [text for text in said if "_" in text]
    assert "Jeng, Kasai and Maison (1992), Earthquake Spectra" in chart.attrs["references"]


def test_fig3b_is_marked_as_its_constants_are():
    chart = sl.charts.effective_rules_chart(0.05, 0.05, 4.0, 9, rules=[JENG])
    assert chart.mark.item() == "M low"
    assert "constants in doubt, not compared with their source" in chart.attrs["comment"]
    expected = sl.rules.rho_effective(
        chart.period_ratio, 1.0, 0.05, 0.05, 0.05, 0.05, 4.0, 4.0, rule=JENG
    )
    np.testing.assert_array_equal(chart.rho[0], expected.rho)
    usual = sl.charts.effective_rules_chart(0.05, 0.05, 4.0, 9)
    assert "memory" not in usual.attrs["comment"]


def test_no_rule_is_shown_by_a_name_of_the_code():
    for name in EFFECTIVE_RULES:
        for shown in (sl.charts.rule_label(name), sl.charts.rule_label(f"eq_3_{name}")):
            assert "_" not in shown
            assert ("unverified" in shown) == ("unverified" in name)
    assert sl.charts.rule_label(f"eq_3_{IWAN}") == "eq. (3), Iwan (1980)"
    assert sl.charts.rule_label("eurocode_8") == "Eurocode 8"


def test_without_simulation_a_chart_keeps_its_caution():
    quick = sl.charts.chart_functions(replace(SETTINGS, simulated_points=0))
    for name, kind in (("fig4a", "curves"), ("fig5a", "plane")):
        chart = quick[name]()
        assert chart.attrs["chart"] == kind
        assert "Caution" in chart.attrs["comment"]
        assert "rho_simulated" not in chart
        assert sl.charts.draw(chart).axes


@pytest.mark.slow
def test_the_drift_closure_does_not_stand_beside_itself():
    chart = sl.charts.chart_functions(replace(SETTINGS, closure="drift"))["fig5a"]()
    assert "rho_drift" not in chart
    figure = sl.charts.draw(chart, comparison=True)
    assert len([axes for axes in figure.axes if axes.get_title("left")]) == 3 * 2


@pytest.mark.parametrize(
    ("given", "kind", "says"),
    [
        (
            {"curves": ("iwan_1980", "magic")},
            ValueError,
            "'magic' is not a known .*secant, .*, fema_440",
        ),
        ({"curves": "iwan_1980"}, TypeError, "curves = 'iwan_1980'; allowed: a list of names"),
        ({"ground_dampings": ()}, ValueError, "ground_dampings is empty; allowed: at least one value"),
        ({"ground_dampings": (0.05, -1.0)}, ValueError, "ground_dampings = -1.0 is out of range"),
        ({"simulated_points": 1}, ValueError, "simulated_points = 1; allowed: at least 2, or 0"),
    ],
)
def test_nonsense_is_refused_by_name(given, kind, says):
    with pytest.raises(kind, match=says):
        sl.charts.ChartSettings(**given)


def test_the_command_takes_curves_by_name(tmp_path):
    def run(*given):
        return invoke("charts", "fig3b", *given, "--points", "9", "--out", tmp_path)

    assert run("--curves", f"{JENG},iwan-1980").exit_code == 0
    with xr.open_dataset(tmp_path / "fig3b.nc") as chart:
        assert chart.rule.values.tolist() == [JENG, IWAN]
    refused = run("--curves", "jeng")
    assert refused.exit_code == 2
    assert JENG in " ".join(refused.output.split())
