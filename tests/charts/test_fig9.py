"""Fig. 9: the required gap by the drift closure in time, beside simulation, eq. (3) and SRSS."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import stochlin as sl
from stochlin.charts import CURVES, ChartSettings, draw, required_gap_chart

FEW = ChartSettings(points=5, simulated_points=3, paths=8, reduction_factors=(1.0, 4.0))
GROUND, ENVELOPE = sl.KanaiTajimi(2.0, 0.6), sl.AminAng(4.0, 15.0, 0.35)
RULES = ("eq_3_drift", "eq_3_linearized", "srss")


@pytest.fixture(scope="module")
def chart():
    return required_gap_chart(FEW, GROUND)


@pytest.fixture(scope="module")
def saved():
    with xr.open_dataset(Path(__file__).parents[2] / "figures" / "fig9.nc") as file:
        return file.load()


def pair(ratio, factor):
    return [sl.Bilinear(period, 0.05, 0.05, reduction_factor=factor) for period in (ratio, 1.0)]


@pytest.mark.oracle
def test_gaps_are_those_of_the_library_in_the_motion_that_the_caption_states(chart):
    soil = sl.KanaiTajimi(2.0, 0.6, intensity=0.01)
    unit = float(sl.linearize(sl.Bilinear(1.0, 0.05), soil).displacement_std)
    here = chart.sel(reduction_factor=4.0).isel(period_ratio=2)
    structures = pair(float(here.period_ratio), 4.0)
    closure = sl.passage_gap(*structures, soil, 30.0, envelope=ENVELOPE, confidence=0.9)
    assert float(here.required_gap) == pytest.approx(float(closure.required_gap) / unit, rel=1e-6)
    assert int(here.caution) == int(closure.caution)
    motion = {"envelope": ENVELOPE, "confidence": 0.9, "paths": 32 * 8}
    rules = sl.separation(*structures, soil, 30.0, **motion)
    simulated = rules.sel(rule="simulation")
    for end in ("", "_lower", "_upper"):
        known = float(simulated[f"gap{end}"]) / unit
        assert float(here[f"required_gap_simulated{end}"]) == pytest.approx(known, rel=1e-6)
    for rule in RULES:
        known = float(rules.gap.sel(rule=rule)) / unit
        assert float(here[f"required_gap_{rule}"]) == pytest.approx(known, rel=1e-6)
    for words in ("30 s", ENVELOPE.describe(), "90 %", "T2 = 1 s", "R = 3 σel/uy"):
        assert words in chart.title + chart.caption


@pytest.mark.invariant
def test_the_period_of_the_ground_only_sets_the_units(chart):
    other = required_gap_chart(FEW, sl.KanaiTajimi(0.4, 0.6))
    for name in chart.data_vars:
        # The bandwidth of a difference, an integral over frequencies, is less exact than the
        # variances.
        few_digits = 2e-3 if name == "required_gap" else 1e-6
        np.testing.assert_allclose(other[name], chart[name], rtol=few_digits)


@pytest.mark.invariant
def test_the_comment_has_the_largest_errors_to_both_sides(saved):
    """And docs/drift.md the side to which eq. (3) is off with either correlation."""
    off = {
        name: 100 * (saved[f"required_gap{name}"] / saved.required_gap_simulated - 1)
        for name in ("", *(f"_{rule}" for rule in RULES))
    }
    for errors in off.values():
        low, high = (
            of(["reduction_factor", "period_ratio"]).values for of in (errors.min, errors.max)
        )
        ranges = (f"{a:+.0f} to {b:+.0f}" for a, b in zip(low, high, strict=True))
        assert " and ".join(ranges) in saved.comment
    assert float(abs(off[""]).max()) < 30
    assert float(off["_eq_3_drift"].max()) > 100
    assert float(off["_eq_3_linearized"].min()) < -50
    assert float(off["_srss"].min()) > 0
    flagged = int((saved.caution > 0).where(saved.required_gap_simulated.notnull(), 0).sum())
    assert (
        f"caution at {flagged} of {int(saved.required_gap_simulated.count())} points"
        in saved.comment
    )


@pytest.mark.invariant
def test_simulated_gaps_are_within_their_intervals_of_a_few_percent(saved):
    lower, middle, upper = (
        saved[f"required_gap_simulated{end}"] for end in ("_lower", "", "_upper")
    )
    known = middle.notnull()
    assert bool(((lower <= middle) & (middle <= upper)).where(known, True).all())
    assert float(((upper - lower) / 2 / middle).median()) < 0.03
    assert known.sum("period_ratio").values.tolist() == [[11] * 4] * 2


@pytest.mark.cli
@pytest.mark.parametrize("width", [0.083, 0.173])
def test_a_panel_has_every_method_in_a_look_of_its_own(saved, width):
    figure = draw(saved, print_width=width)
    assert len(figure.axes) == 8
    down, across = (4, 2) if width < 0.1 else (2, 4)
    grid = figure.axes[0].get_gridspec()
    assert (grid.nrows, grid.ncols) == (down, across)
    panel = figure.axes[0]
    curves = {
        line.get_label(): line for line in panel.lines if not line.get_label().startswith("_")
    }
    looks = [(line.get_color(), line.get_linewidth() > 1.2) for line in curves.values()]
    assert looks == [(color, n == 0) for n, (color, _) in enumerate(CURVES[:4])]
    np.testing.assert_array_equal(
        curves["drift closure in time"].get_ydata(), saved.required_gap[0, 0]
    )
    known = saved.required_gap_srss[0, 0].dropna("period_ratio")
    np.testing.assert_array_equal(curves["SRSS"].get_ydata(), known)
    assert [text.get_text() for text in figure.legends[0].get_texts()] == [*curves, "simulated"]


@pytest.mark.cli
def test_without_simulation_the_closure_is_drawn_alone_with_its_error():
    chart = required_gap_chart(ChartSettings(points=5, simulated_points=0, paths=2), GROUND)
    assert "off by 13 % or less in 95 % of the cases" in chart.comment
    assert set(chart.data_vars) == {"required_gap", "caution", "status"}
    figure = draw(chart)
    assert [len(axes.lines) for axes in figure.axes] == [1] * 4
