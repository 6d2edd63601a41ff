"""Motions fitted to a record carry its energy and have its response spectrum."""

import numpy as np
import pytest
import xarray as xr

import stochlin as sl
from stochlin.applications.sites.motion_fit import energy_ratio
from stochlin.messages import DoubtfulInput

SHAPE = sl.AminAng(3.0, 12.0, 0.3)
GROUND = sl.CloughPenzien(0.5, 0.4, 4.0, 0.6, intensity=0.01)


@pytest.fixture(scope="module")
def record():
    return sl.simulated_motions(GROUND, 30.0, SHAPE, paths=2, seed=6)[1]


@pytest.fixture(scope="module")
def motion(record):
    return sl.fit_motion(record)


def assert_energy_is_that(record, motion):
    """The mean energy of simulated motions, within four standard errors, is that of the record."""
    course = motion.ground, motion.duration, motion.envelope
    motions = sl.simulated_motions(*course, paths=512, scatter=0.0)
    ratio = (motions**2).integrate("time") / (record**2).integrate("time")
    assert abs(float(ratio.mean()) - 1) < 4 * float(ratio.std()) / np.sqrt(512), record.attrs[
        "source"
    ]


@pytest.mark.oracle
def test_energy_of_motions_over_that_of_a_sine_of_the_same_rms_is_the_ratio_of_durations():
    ground = sl.KanaiTajimi(0.5, 0.4, intensity=0.01)
    w, damping = 4 * np.pi, 0.4  # of the ground; its variance is pi S0 w (1 + 4 xi^2) / (2 xi)
    rms = np.sqrt(np.pi * 0.01 * w * (1 + 4 * damping**2) / (2 * damping))
    time = np.arange(2001) * 0.01
    sine = rms * np.sqrt(2) * np.sin(2 * np.pi * time)
    record = xr.DataArray(sine, [("time", time)], attrs={"units": "m/s^2"})
    assert energy_ratio(record, ground, None, 10.0) == pytest.approx(0.5, rel=1e-3)


@pytest.mark.slow
@pytest.mark.oracle
def test_a_motion_that_was_made_is_found_again(record, motion):
    assert_energy_is_that(record, motion)
    periods = np.geomspace(0.05, 4.0, 72)
    course = motion.duration, motion.envelope
    table = sl.simulated_spectrum(motion.ground, periods, *course, paths=512)
    of_record = sl.response_spectrum(record, periods, 0.05).pseudo_acceleration.squeeze()
    off = np.log(table.pseudo_acceleration.values / of_record.values)
    # One motion scatters about its mean by a fifth or so from period to period.
    assert float(np.sqrt((off**2).mean())) < 0.3
    assert abs(float(off.mean())) < 0.1


@pytest.mark.oracle
def test_energy_of_a_fitted_motion_is_that_by_hand(record, motion):
    time, frequency = np.linspace(0, motion.duration, 2001), np.geomspace(1e-3, 4000, 20001)
    variance = 2 * np.trapezoid(motion.ground.psd(frequency), frequency)
    energy = variance * np.trapezoid(motion.envelope.at(time) ** 2, time)
    # A PSD like 1/w^2 leaves a thousandth of the variance beyond 4000 rad/s.
    assert float(energy) == pytest.approx(float((record**2).integrate("time")), rel=5e-3)


@pytest.mark.filterwarnings("ignore:.*are the same motion")
@pytest.mark.slow
@pytest.mark.oracle
def test_both_components_are_fitted_by_their_geometric_means(record, motion):
    twice = (2 * record).assign_attrs(record.attrs)
    both = sl.fit_motion({"north": record, "east": twice})
    assert both.ground.intensity == pytest.approx(2 * motion.ground.intensity, rel=1e-3)
    for name, value in motion.envelope.arrays().items():
        assert float(both.envelope.arrays()[name]) == pytest.approx(float(value), rel=1e-4)
    assert both.scatter == pytest.approx(np.log(2) / np.sqrt(2))  # about the mean of 0 and ln 2
    assert "between both components" in both.scatter_source
    assert_energy_is_that((np.sqrt(2) * record).assign_attrs(record.attrs), both)


def burst_and_tail(start):
    """A burst, and a long harmonic motion from a time [s] on: no filter under an envelope."""
    time = 0.02 * np.arange(3000)
    noise = np.random.default_rng(2).standard_normal(3000)
    values = noise * np.exp(-((time - 5) ** 2)) + 0.2 * np.sin(40 * time) * (time > start)
    return xr.DataArray(
        values, dims="time", coords={"time": time}, attrs={"source": "burst", "units": "m/s^2"}
    )


@pytest.mark.slow
@pytest.mark.oracle
@pytest.mark.parametrize(
    ("start", "message"),
    [
        (45, "burst: the motions have a significant duration of"),
        (20, "burst: the mean spectrum is off by .* from 0.2 to 2 s, most at 0.41 s"),
    ],
)
def test_a_fit_that_misses_duration_or_spectrum_says_so(start, message):
    with pytest.warns(DoubtfulInput, match=message):
        sl.fit_motion(burst_and_tail(start), "gamma", filters=1)


@pytest.mark.invariant
@pytest.mark.filterwarnings("ignore:.*are the same motion")
@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda r: [r, r[:-5]], "have the sample counts 3001 and 2996; allowed: equal"),
        (
            lambda r: [r, r.assign_attrs(event="Kobe")],
            "events .Duzce. and .Kobe.; allowed: equal",
        ),
        (lambda r: [r, r, r], "record has 3 components; allowed: one, or"),
        (lambda r: r[:150], "record lasts 1.5 s; allowed: 2 s or more"),
    ],
)
def test_what_cannot_be_fitted_is_refused(record, change, message):
    with pytest.raises(ValueError, match=message):
        sl.fit_motion(change(record.assign_attrs(event="Duzce", station="Bolu")))


@pytest.mark.filterwarnings("ignore:.*are the same motion")
@pytest.mark.oracle
def test_motions_of_a_fitted_ground_have_sources_too_long_for_names(record):
    long = [record.assign_attrs(source=f"{name}, {'intensity ' * 30}") for name in "ab"]
    assert list(sl.response_spectrum(long, [0.5], 0.05).record.values) == ["1", "2"]
