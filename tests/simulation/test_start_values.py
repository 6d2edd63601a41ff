"""Simulated motions that do not begin from rest."""

import numpy as np
import pytest

import stochlin as sl

pytestmark = [pytest.mark.oracle, pytest.mark.extreme]

WEAK = sl.WhiteNoise(1e-16)
TOWER = sl.ShearBuilding(
    [2e5] * 3, [2e8, 1.6e8, 1e8], [3.5] * 3, 0.05, hardening=0.05, yield_drifts=0.008
)


@pytest.mark.parametrize("law", [sl.Bilinear, sl.BoucWen])
def test_a_throw_without_motion_has_the_peaks_of_free_vibration(law):
    row = [
        law(1.0, 0.05, 0.05, yield_displacement=0.5),
        law(0.5, 0.05, 0.05, yield_displacement=0.5),
    ]
    start = sl.Start(displacement=[0.0, 0.02], velocity=[0.1, 0.0])
    table = sl.simulate(row, WEAK, duration=3.0, paths=32, steps_per_period=256, start=start)
    w, xi = 2 * np.pi, 0.05
    turn = np.arctan2(np.sqrt(1 - xi**2), xi)
    first = 0.1 / w * np.exp(-turn * xi / np.sqrt(1 - xi**2))
    tolerance = 1e-4 if law is sl.Bilinear else 0.05  # its spring softens from the beginning
    np.testing.assert_allclose(table.peak_positive[:, 0], first, rtol=tolerance)
    assert float(table.peak_positive[:, 1].min()) == 0.02
    assert float(table.separation[0, 1, 0]) == pytest.approx(0.02, rel=tolerance)


def test_a_linked_tower_begins_as_in_a_record():
    link = sl.Link(1e7, floors=(3, 1))
    lone = sl.Bilinear(0.6, 0.05, mass=3e5)
    start = sl.Start(velocity=[0.1, 0.2, 0.3, -0.2])
    table = sl.simulate([TOWER, lone], WEAK, duration=3.0, paths=32, link=link, start=start)
    time = 0.01 * np.arange(301)
    still = sl.simulated_motions(WEAK, 3.0, paths=2, step=0.01)[0]
    beside = sl.pound(
        [TOWER, lone],
        1.0,
        sl.LinearSpring(1e8),
        still.assign_coords(time=time[: still.size]),
        link=link,
        start=start,
        steps_per_contact=64,
    )
    peaks = beside.peak.values[~np.isnan(beside.peak.values)]
    np.testing.assert_allclose(table.peak[0], peaks, rtol=1e-3)
    np.testing.assert_allclose(table.peak_link_stroke[0], beside.peak_link_stroke, rtol=2e-3)


def test_a_stationary_response_has_no_start():
    with pytest.raises(
        ValueError, match="start is given without a duration; allowed: both, or neither"
    ):
        sl.simulate([TOWER], WEAK, start=sl.Start(velocity=[0.1] * 3))
    with pytest.raises(ValueError, match=r"velocity has 2 values; allowed: 3, .*: 1.1, 1.2, 1.3"):
        sl.simulate([TOWER], WEAK, duration=3.0, start=sl.Start(velocity=[0.1] * 2))
