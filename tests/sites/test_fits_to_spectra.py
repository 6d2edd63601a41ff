"""Simulated motions have the spectrum that their ground was fitted to."""

import warnings
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from scipy import integrate

import stochlin as sl

G = 9.80665
ENVELOPE = sl.AminAng(2.0, 12.0, 0.4)
FIRM, YIELDING = sl.named_ground("firm", 0.01), sl.Bilinear(1.0, 0.05, 0.1, reduction_factor=3)
RECORD = sl.simulated_motions(FIRM, 20.0, paths=2)[0]
CODES = {
    f"type {kind}, {soil}": sl.eurocode_8(0.25 * G, soil, kind)
    for kind, soil in ((1, "D"), (2, "A"))
}
CODES["ASCE 7"] = sl.asce_7(0.68 * G, 0.39 * G, 12.0)


@pytest.mark.slow
@pytest.mark.oracle
@pytest.mark.parametrize("name", CODES)
def test_motions_deliver_the_spectrum(name):
    duration, envelope = 12.0, sl.AminAng(1.5, 7.0, 0.6)
    ground = sl.fit_ground(CODES[name], duration=duration, envelope=envelope)
    table = sl.simulated_spectrum(ground, CODES[name], duration, envelope, paths=2048, seed=77)
    seen = table.sel(period=slice(0.1, 4.0))
    # The aim is 3 and 6 %; the scatter of 2048 motions is within 0.8 %.
    assert float(np.sqrt(((seen.ratio - 1) ** 2).mean())) < 0.03
    assert float(abs(seen.ratio - 1).max()) < 0.06
    assert "errors of" in ground.source


@pytest.mark.invariant
@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({}, "duration is missing; a spectrum does not contain it"),
        (
            {"duration": 20.0, "model": "kanai_tajimi"},
            "model = 'kanai_tajimi' is not known; allowed: clough",
        ),
        (
            {"duration": 20.0, "estimator": "psd"},
            "estimator = 'psd' does not apply: target is a spectrum",
        ),
        (
            {"target": RECORD, "duration": 20.0},
            r"duration = 20\.0 does not apply: target is a record",
        ),
    ],
)
def test_options_that_do_not_go_with_the_target_are_refused(options, message):
    with pytest.raises(ValueError, match=message):
        sl.fit_ground(**{"target": CODES["ASCE 7"]} | options)


@pytest.mark.slow
@pytest.mark.invariant
def test_a_ground_has_as_many_filters_as_asked():
    for filters in (1, 2):
        ground = sl.fit_ground(CODES["ASCE 7"], duration=12.0, filters=filters)
        assert len(getattr(ground, "grounds", [ground])) == filters


@pytest.mark.extreme
@pytest.mark.oracle
def test_a_simulated_spectrum_is_that_of_its_motions():
    """The same motions, followed by the exact solution for records."""
    ground, step = sl.named_ground("firm", 0.01), 0.0025
    motions = sl.simulated_motions(ground, 10.0, ENVELOPE, paths=256, seed=1, step=step)
    periods = np.array([0.2, 0.5, 1.0])
    found = sl.simulated_spectrum(ground, periods, 10.0, ENVELOPE, paths=1024, seed=2)
    each = sl.response_spectrum(list(motions), periods, 0.05).pseudo_acceleration.values
    mean, error = np.mean(each, axis=0), np.std(each, axis=0) / np.sqrt(256)
    off = np.abs(found.pseudo_acceleration - mean)
    assert (off < 4 * np.hypot(error, found.pseudo_acceleration_standard_error)).all()


@pytest.mark.oracle
@pytest.mark.parametrize("ground", [sl.named_ground("firm", 0.01), sl.KanaiTajimi(0.4, 0.3, 0.02)])
def test_variance_of_stationary_motions(ground):
    motions = sl.simulated_motions(ground, 20.0, paths=512, seed=2, step=0.005)
    exact = 2 * integrate.quad(lambda w: float(ground.psd(w)), 0, np.inf, limit=500)[0]
    each = (motions**2).mean("time")
    assert abs(float(each.mean()) - exact) < 4 * float(each.std()) / np.sqrt(512) + 0.01 * exact


@pytest.mark.invariant
def test_a_seed_is_an_answer_and_fewer_paths_are_the_first():
    ground = sl.named_ground("firm", 0.01)
    many, few = (sl.simulated_motions(ground, 5.0, paths=paths, seed=9) for paths in (40, 3))
    np.testing.assert_array_equal(many[:3], few)
    louder = sl.simulated_motions(replace(ground, intensity=0.04), 5.0, paths=3, seed=9)
    np.testing.assert_allclose(louder, 2 * few)


APART = {  # each value is allowed, and not with the others
    "tl = 8 s; allowed: longer than TS = sd1/sds = 9 s": lambda: sl.asce_7(0.3 * G, 2.7 * G, 8.0),
    "step = 30.0 is out of range; allowed: 0 < step": lambda: sl.simulated_motions(
        FIRM, 9.0, step=30.0
    ),
    "nothing is given; allowed: one of pga, sa": lambda: sl.scale_records({"a": RECORD}),
    "is not within the spectrum": lambda: sl.scale_records(
        {"a": RECORD}, spectrum=CODES["ASCE 7"], band=(2.0, 80.0)
    ),
    "allowed: 0 < lower < upper": lambda: sl.fit_motion(RECORD, band=(2.0, 1.0)),
    "or more apart in this part": lambda: sl.fit_ground(RECORD, frequency_range=(1.0, 1.1)),
    "reduction_factor is for a ground": lambda: sl.energy_gap(YIELDING, YIELDING, RECORD),
}


@pytest.mark.invariant
@pytest.mark.parametrize("message", APART)
def test_values_that_do_not_go_together_are_refused(message):
    with pytest.raises(ValueError, match=message):
        APART[message]()


@pytest.mark.slow
@pytest.mark.invariant
def test_a_fit_that_is_poor_is_said():
    """One filter has one peak, and this spectrum two."""
    period = np.geomspace(0.05, 4, 40)
    peaks = sum(5 * np.exp(-((np.log(period / at) / 0.25) ** 2)) for at in (0.15, 2.0))
    attrs = {"units": "m/s^2", "elastic": "elastic as stated"}
    spectrum = xr.DataArray(2 + peaks, {"period": period}, attrs=attrs)
    with pytest.warns(sl.DoubtfulInput, match=r"motions differs by up to 1\d\d %; usual are 10 %"):
        sl.fit_ground(spectrum, duration=8.0, filters=1)


@pytest.mark.invariant
@pytest.mark.parametrize(
    ("period", "motion", "asked"),
    [
        (1.0, {"duration": 15.0, "envelope": ENVELOPE}, ""),
        (1.0, {"duration": 30.0, "envelope": ENVELOPE}, "for motions of 15 s under AminAng"),
        (1.0, {"duration": 15.0}, "for motions of 15 s under AminAng"),
        (3.0, {"duration": 15.0, "envelope": ENVELOPE}, "up to 2 s, and a period is 3 s"),
    ],
)
def test_a_fitted_ground_is_that_of_the_motions_and_periods_of_its_fit(period, motion, asked):
    ground = replace(FIRM, fitted_for=(15.0, ENVELOPE, 2.0))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", sl.DoubtfulInput)
        sl.simulate([sl.Bilinear(0.5, 0.05), sl.Bilinear(period, 0.05)], ground, paths=32, **motion)
    texts = [str(each.message) for each in caught]
    assert len(texts) == bool(asked)
    assert asked in "".join(texts)
