"""How strong a ground is to be: by PGA, by Sa at a period, by a return period."""

import math

import numpy as np
import pytest
import scipy.signal
import xarray as xr

import stochlin as sl
from stochlin.applications.sites.intensity import shaking

G = 9.80665
FIRM = sl.named_ground("firm", intensity=1.0)
QUAKE = {"duration": 15.0, "envelope": sl.AminAng(2.0, 9.0, 0.5)}
GROUNDS = {
    "one filter": FIRM,
    "lake bed": sl.KanaiTajimi(2.0, 0.05, 0.01),
    "two in parallel": sl.ParallelGround(
        [sl.CloughPenzien(0.8, 0.5, 3.0, 0.6, 0.01), sl.CloughPenzien(0.2, 0.6, 1.0, 0.6, 0.02)]
    ),
}


def off(samples: np.ndarray, wanted: float, ground: sl.KanaiTajimi) -> float:
    """Standard errors from a mean of other motions to what was wanted, both errors counted."""
    error = samples.std(ddof=1) * math.sqrt(1 / samples.size + 1 / 1024)
    assert "standard error of" in ground.source
    return abs(samples.mean() - wanted) / error


@pytest.mark.oracle
def test_other_motions_have_the_peak_that_was_asked_for():
    ground = GROUNDS["lake bed"]
    found = sl.scale_ground(ground, **QUAKE, pga=0.3 * G)
    motions = sl.simulated_motions(found, **QUAKE, paths=512, seed=11)
    assert off(abs(motions).max("time").values, 0.3 * G, found) < 4


@pytest.mark.oracle
def test_other_motions_have_the_spectral_acceleration_that_was_asked_for():
    """By the exact response of each to a recorded motion, and not as it was sought."""
    ground = GROUNDS["two in parallel"]
    found = sl.scale_ground(ground, **QUAKE, sa=0.8 * G, period=0.9, damping=0.04)
    motions = sl.simulated_motions(found, **QUAKE, paths=256, seed=12)
    table = sl.response_spectrum(list(motions), period=0.9, damping=0.04)
    assert off(table.pseudo_acceleration.values.ravel(), 0.8 * G, found) < 4


@pytest.mark.invariant
def test_the_same_motions_are_simulated_once():
    shares = []
    options = {**QUAKE, "seed": 77, "period": 0.31, "paths": 8, "progress": shares.append}
    first = sl.scale_ground(FIRM, **options, sa=1.0)
    simulated = len(shares)
    stronger = sl.scale_ground(first, **options, sa=3.0)
    assert len(shares) == simulated > 0
    assert stronger.intensity == pytest.approx(9 * first.intensity, rel=1e-12)
    sl.scale_ground(first, **options | {"seed": 78}, sa=1.0)
    assert len(shares) > simulated


@pytest.mark.invariant
def test_the_intensity_goes_with_the_square_and_forgets_what_it_was():
    once, twice = (sl.scale_ground(FIRM, **QUAKE, pga=pga) for pga in (1.0, 2.0))
    assert twice.intensity == pytest.approx(4 * once.intensity, rel=1e-12)
    again = sl.scale_ground(twice, **QUAKE, pga=1.0)
    assert again.intensity == pytest.approx(once.intensity, rel=1e-9)
    assert again.source == once.source  # it says once by what
    assert once.source.startswith(FIRM.source)
    assert once.period == FIRM.period


@pytest.mark.invariant
def test_what_was_asked_for_is_what_is_told():
    ground = sl.scale_ground(FIRM, **QUAKE, sa=3.0, period=0.7)
    table = shaking(ground, np.array([0.7, 0.4, 0.7]), **QUAKE)
    assert float(table.spectral_acceleration_1) == pytest.approx(3.0, rel=1e-9)
    assert float(table.spectral_acceleration_3) == float(table.spectral_acceleration_1)
    assert float(table.spectral_acceleration_2) > 3.0
    assert float(table.rms_acceleration) < float(table.peak_ground_acceleration)
    assert all({"units", "long_name"} <= set(one.attrs) for one in table.data_vars.values())
    white = sl.scale_ground(sl.WhiteNoise(1.0), **QUAKE, sa=3.0, period=0.7)
    table = shaking(white, np.array([0.7]), **QUAKE)
    assert np.isnan(table.peak_ground_acceleration)
    assert np.isnan(table.rms_acceleration)
    assert float(table.spectral_acceleration_1) == pytest.approx(3.0, rel=1e-9)


@pytest.mark.invariant
@pytest.mark.parametrize(
    ("ground", "options", "message"),
    [
        (
            sl.WhiteNoise(1.0),
            {"pga": 3.0},
            "pga: white noise has no peak.*allowed: sa with a period",
        ),
        (FIRM, {"pga": 1.0, "period": 1.0}, "sa and period go together"),
        (sl.KanaiTajimi([1.0, 2.0], 0.3), {"pga": 1.0}, "period is an array"),
    ],
)
def test_what_cannot_be_met_is_refused(ground, options, message):
    with pytest.raises(ValueError, match=message):
        sl.scale_ground(ground, **QUAKE, **options)


# --- How often: hazard ---


@pytest.mark.oracle
def test_a_power_law_by_hand():
    """At k = 2 four times as rare is twice as strong."""
    hazard = sl.PowerLawHazard(k0=0.01, k=2.0)
    assert hazard.intensity(100.0) == pytest.approx(1.0)
    assert hazard.intensity(400.0) == pytest.approx(2.0)
    assert hazard.frequency(2.0) == pytest.approx(0.0025)
    assert -math.expm1(-50 * hazard.frequency(hazard.intensity(474.56))) == pytest.approx(
        0.1, abs=1e-5
    )


@pytest.mark.oracle
def test_a_curve_on_a_power_law_is_the_power_law_between_its_points():
    law = sl.PowerLawHazard(k0=0.003, k=2.7)
    points = [0.5, 1.0, 3.0, 8.0]
    curve = sl.HazardCurve(points, [law.frequency(im) for im in points])
    years = np.geomspace(1 / law.frequency(0.5), 1 / law.frequency(8.0), 9)
    np.testing.assert_allclose(curve.intensity(years), law.intensity(years), rtol=1e-9)
    at = xr.DataArray([0.6, 2.0, 7.9], dims="im")
    np.testing.assert_allclose(curve.frequency(at), law.frequency(at), rtol=1e-9)
    assert curve.frequency(at).dims == ("im",)


@pytest.mark.invariant
def test_nothing_is_extrapolated():
    curve = sl.HazardCurve([1.0, 2.0], [0.01, 0.001])
    with pytest.raises(
        ValueError, match="return_period = 2475 is beyond the hazard curve; allowed: 100 to 1000"
    ):
        curve.intensity(2475)
    with pytest.raises(
        ValueError, match=r"intensity = 0.5 is beyond the hazard curve; allowed: 1 to 2"
    ):
        curve.frequency(0.5)
    assert np.isnan(curve.intensity([50.0, 200.0, 2475.0])).values.tolist() == [True, False, True]


@pytest.mark.invariant
@pytest.mark.parametrize(
    ("make", "message"),
    [
        (
            lambda: sl.HazardCurve([1.0, 2.0], [0.01, 0.02]),
            "number 2: the annual frequency 0.02 follows",
        ),
        (
            lambda: sl.HazardCurve([2.0, 1.0], [0.01, 0.001]),
            "increasing intensities, so sort them$",
        ),
        (
            lambda: sl.HazardCurve([0.02, 1e-3], [0.5, 4.0]),
            "are they exchanged with the frequencies",
        ),
        (lambda: sl.HazardCurve([1.0, 4.0], [0.002, 0.04]), "since what is stronger is rarer$"),
        (lambda: sl.HazardCurve([1.0, 4.0], [100, 2475]), "or are they return periods"),
        (lambda: sl.PowerLawHazard(1.0, 2.0, measure="sa"), "measure = 'sa' with period = None"),
        (
            lambda: sl.PowerLawHazard(1.0, 2.0, period=1.0),
            "allowed: a period in seconds with sa alone",
        ),
    ],
)
def test_what_is_no_hazard_is_refused(make, message):
    with pytest.raises(ValueError, match=message):
        make()


@pytest.mark.oracle
@pytest.mark.parametrize(
    ("ground", "period"),
    [
        (sl.KanaiTajimi(0.4, 0.6, 1.0), 1.0),
        (sl.WhiteNoise(1.0), 1.0),
    ],
)
def test_a_spectral_acceleration_loses_no_peak_between_two_steps(ground, period):
    """By the exact response to the same motions, straight between values, at 16 points of a step.

    The motions are the same, so that nothing is random but what is between steps, 0.25 % of a peak
    at most: of the mean of 256 motions 0.02 %. 64 steps in a period lose 0.04 %, and 16 lost 0.4 to
    1.1 %.
    """
    known = {"duration": 12.0, "envelope": sl.AminAng(2.0, 8.0, 0.5), "paths": 256, "seed": 5}
    scaled = sl.scale_ground(ground, **known, sa=3.0, period=period)
    white, omega, finer = isinstance(ground, sl.WhiteNoise), 2 * math.pi / period, 16
    motions = sl.simulated_motions(
        scaled, **known, step=(period if white else min(period, 0.4)) / 64
    )
    count = motions.sizes["time"]
    fine = np.arange((count - 1) * finer + 1) / finer
    pushed = np.array([np.interp(fine, np.arange(count), motion) for motion in motions.values])
    if white:  # whose values are means over a step
        pushed = np.repeat(motions.values, finer, axis=1)
    law = [-1.0], [1.0, 2 * 0.05 * omega, omega**2]
    way = "zoh" if white else "foh"
    above, below, _ = scipy.signal.cont2discrete(law, motions.attrs["dt"] / finer, method=way)
    peaks = omega**2 * np.abs(scipy.signal.lfilter(above.ravel(), below, pushed, axis=1)).max(
        axis=1
    )
    assert peaks.mean() == pytest.approx(3.0, rel=1.5e-3)


@pytest.mark.invariant
def test_every_peak_ground_acceleration_is_counted_in_the_same_step():
    """0.01 s, for short motions and long ones: of `scale_ground`, spectra, reports and hazards."""
    for duration in (6.0, 30.0):
        motion = {"duration": duration, "envelope": sl.AminAng(2.0, 5.0, 0.5)}
        ground = sl.scale_ground(GROUNDS["two in parallel"], **motion, pga=3.0)
        assert "peak ground acceleration (steps of 0.01 s)" in ground.source
        motions = sl.simulated_motions(ground, **motion, paths=1024, step=0.01)
        assert np.abs(motions.values).max(axis=1).mean() == pytest.approx(3.0, rel=1e-12)
        for table in (
            sl.simulated_spectrum(ground, [1.0], **motion),
            shaking(ground, np.array([1.0]), **motion),
        ):
            assert float(table.peak_ground_acceleration) == pytest.approx(3.0, rel=1e-12)
            assert table.attrs["pga_step_s"] == 0.01
