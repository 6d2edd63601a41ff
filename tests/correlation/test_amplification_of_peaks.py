"""Amplification of maximum displacements, as the caption of Fig. 5b has it."""

import numpy as np
import pytest
import xarray as xr

import stochlin as sl

LAKEBED = sl.KanaiTajimi(2.0, 0.05, intensity=0.01)
SHAPE = sl.AminAng(3.0, 12.0, 0.35)
MOTION = {"of": "peak", "duration": 20.0, "envelope": SHAPE, "paths": 64}
PERIODS = xr.DataArray([0.4, 1.0, 2.0], dims="period", coords={"period": [0.4, 1.0, 2.0]})


def weak(period=1.0, factor=4.0, **others):
    return sl.Bilinear(period, 0.05, 0.05, reduction_factor=factor, **others)


@pytest.mark.invariant
@pytest.mark.extreme
def test_what_does_not_yield_is_not_amplified():
    elastic = sl.amplification(sl.Bilinear(1.0, 0.05), LAKEBED, **MOTION)
    assert (float(elastic.amplification), float(elastic.amplification_standard_error)) == (1.0, 0.0)
    strong = sl.amplification(weak(factor=0.2), LAKEBED, **MOTION)
    assert float(strong.amplification) == pytest.approx(1.0, rel=1e-12)
    assert int(strong.status) == int(elastic.status) == 1
    assert int(sl.amplification(weak(), LAKEBED, **MOTION).status) == 0


@pytest.mark.invariant
def test_scales_of_motion_and_of_time_do_not_matter():
    one = sl.amplification(weak(PERIODS), LAKEBED, **MOTION)
    louder = sl.amplification(weak(PERIODS), sl.KanaiTajimi(2.0, 0.05, intensity=0.04), **MOTION)
    xr.testing.assert_allclose(louder.amplification, one.amplification, rtol=1e-9)
    np.testing.assert_allclose(louder.peak_mean, 2 * one.peak_mean, rtol=1e-9)
    slow = {**MOTION, "duration": 40.0, "envelope": sl.AminAng(6.0, 24.0, 0.175)}
    slower = sl.amplification(weak(2 * PERIODS.values), sl.KanaiTajimi(4.0, 0.05, 0.01), **slow)
    np.testing.assert_allclose(slower.amplification, one.amplification, rtol=1e-9)


@pytest.mark.oracle
def test_the_same_motions_of_simulate_give_the_same_ratio():
    table = sl.amplification(weak(), LAKEBED, **MOTION)
    drawn = {key: MOTION[key] for key in ("duration", "envelope", "paths")}
    motions = sl.simulate([weak(), sl.Bilinear(1.0, 0.05)], LAKEBED, **drawn)
    inelastic, elastic = motions.peak.values.T
    assert float(table.amplification) == pytest.approx(inelastic.mean() / elastic.mean(), rel=1e-12)
    assert float(table.peak_mean) == pytest.approx(inelastic.mean(), rel=1e-12)
    assert float(table.elastic_peak_mean) == pytest.approx(elastic.mean(), rel=1e-12)
    strength = float(sl.linearize(weak(), LAKEBED).yield_displacement)
    assert float(table.ductility) == pytest.approx(inelastic.mean() / strength, rel=1e-12)


@pytest.mark.oracle
@pytest.mark.extreme
def test_building_of_one_storey_is_the_oscillator():
    one = sl.ShearBuilding([1e5], [4e6], [3.0], 0.05, 0.05, yield_drifts=0.02)
    period = float(one.periods()[0])
    alone = sl.Bilinear(period, 0.05, 0.05, yield_displacement=0.02)
    table, expected = (sl.amplification(s, LAKEBED, **MOTION) for s in (one, alone))
    for name in ("amplification", "amplification_standard_error", "peak_mean", "ductility"):
        assert table[name].values[0] == pytest.approx(float(expected[name]), rel=1e-6)
    tower = sl.ShearBuilding([1e5] * 3, [4e7] * 3, [3.0] * 3, 0.05, 0.05, yield_drifts=0.004)
    table = sl.amplification(tower, LAKEBED, **MOTION)
    assert table.amplification.dims == ("floor",)
    assert int(table.status) == 0
    rigid = sl.ShearBuilding([1e5] * 3, [4e7] * 3, [3.0] * 3, 0.05, 0.05, yield_drifts=10.0)
    table = sl.amplification(rigid, LAKEBED, **MOTION)
    np.testing.assert_allclose(table.amplification, 1, rtol=1e-9)
    assert int(table.status) == 1
    with pytest.raises(TypeError, match=r"oscillator\(\)"):
        sl.amplification(tower, LAKEBED)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"of": "max"}, "of = 'max' is not known; allowed: std, peak"),
        ({}, "duration = None is no number"),
        ({"duration": 0.3}, "shorter than the period of structure"),
        ({"closure": "drift"}, "has no use with of=.peak."),
        ({"of": "std", "duration": 20.0}, "duration and envelope belong to finite motions"),
        ({"of": "std", "envelope": SHAPE}, "duration and envelope belong to finite motions"),
    ],
)
@pytest.mark.invariant
def test_what_cannot_be_is_said(given, said):
    with pytest.raises((ValueError, TypeError), match=said):
        sl.amplification(weak(), LAKEBED, **{"of": "peak", **given})
