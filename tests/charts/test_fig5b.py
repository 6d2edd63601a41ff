"""Fig. 5b: the amplification of standard deviations and maxima, beside what linearization says."""

import numpy as np
import pytest

import stochlin as sl
from stochlin.charts import ChartSettings, amplification_chart

FEW = ChartSettings(points=5, reduction_factors=(1.0, 4.0), paths=64)
GROUND = sl.KanaiTajimi(2.0, 0.05)


@pytest.fixture(scope="module")
def chart():
    return amplification_chart(FEW, GROUND)


@pytest.mark.paper
def test_points_are_those_of_amplification_on_the_motion_that_the_caption_states(chart):
    ratio = chart.period_ratio.values
    building = sl.Bilinear(2.0 * ratio, 0.05, 0.05, reduction_factor=4.0)
    motion = {"duration": 30.0, "envelope": sl.AminAng(4.0, 15.0, 0.35), "paths": 64}
    peaks = sl.amplification(building, GROUND, of="peak", **motion)
    row = chart.sel(reduction_factor=4.0)
    np.testing.assert_allclose(row.amplification_of_peaks, peaks.amplification, rtol=1e-9)
    stds = sl.correlate(building, building, GROUND, "simulation", paths=64).displacement_std_1
    elastic = sl.linearize(sl.Bilinear(2.0 * ratio, 0.05), GROUND).displacement_std
    np.testing.assert_allclose(row.amplification_simulated, stds / elastic, rtol=1e-9)
    drifting = sl.amplification(building, GROUND, closure="drift")
    np.testing.assert_allclose(row.amplification_drift, drifting.amplification, rtol=1e-9)
    assert f"Maxima: 30 s of motion, {motion['envelope'].describe()}" in chart.caption
    assert chart.amplification_simulated.sel(reduction_factor=1.0).isnull().all()
    assert chart.amplification_of_peaks.notnull().all()


@pytest.mark.invariant
def test_the_period_of_the_ground_only_sets_the_units(chart):
    other = amplification_chart(FEW, sl.KanaiTajimi(0.4, 0.05))
    for name in ("amplification_of_peaks", "amplification_drift"):
        np.testing.assert_allclose(other[name], chart[name], rtol=1e-8)


@pytest.mark.paper
def test_maxima_of_stiff_structures_on_a_lake_bed_are_far_above_the_linearized_ratio(chart):
    stiff = chart.sel(reduction_factor=4.0, period_ratio=0.1)
    assert float(stiff.amplification_of_peaks) > 5 * float(stiff.amplification)
