"""Motions fitted to a record carry its energy and have its response spectrum."""

import csv
from pathlib import Path

import numpy as np
import pytest

import stochlin as sl

SUITES = Path(__file__).parents[3] / "shared" / "records"
SHAPE = sl.AminAng(3.0, 12.0, 0.3)
GROUND = sl.CloughPenzien(0.5, 0.4, 4.0, 0.6, intensity=0.01)


@pytest.fixture(scope="module")
def record():
    return sl.simulated_motions(GROUND, 30.0, SHAPE, paths=2, seed=6)[1]


@pytest.fixture(scope="module")
def motion(record):
    return sl.fit_motion(record)


def recorded():
    """Every twelfth of the suites."""
    with (SUITES / "suites.csv").open(encoding="utf-8", newline="") as file:
        for row in list(csv.DictReader(file))[::12]:
            path = SUITES / row["file"]
            if row["file"].startswith("far_field"):
                yield sl.read_record(path, units="g", time_column=0, column=1)
            else:
                yield sl.read_record(path, units="gal", dt=float(row["dt"]))


@pytest.mark.slow
@pytest.mark.oracle
def test_a_motion_that_was_made_is_found_again(record, motion):
    table = sl.compare_motions(record, motion, paths=512)
    assert abs(table.energy_ratio - 1) < 4 * table.energy_ratio_standard_error
    assert float(table.significant_duration) == pytest.approx(
        float(table.record_significant_duration), rel=0.15
    )
    # One motion scatters about its mean by a fifth or so from period to period.
    assert float(np.sqrt((np.log(table.ratio) ** 2).mean())) < 0.3
    assert abs(float(np.log(table.ratio).mean())) < 0.1


@pytest.mark.oracle
def test_energy_of_a_fitted_motion_is_that_by_hand(record, motion):
    time = np.linspace(0, motion.duration, 20001)
    frequency = np.linspace(0, 4000, 400001)
    variance = 2 * np.trapezoid(motion.ground.psd(frequency), frequency)
    energy = variance * np.trapezoid(motion.envelope.at(time) ** 2, time)
    # A PSD like 1/w^2 leaves a thousandth of the variance beyond 4000 rad/s.
    assert float(energy) == pytest.approx(float((record**2).integrate("time")), rel=5e-3)


@pytest.mark.slow
@pytest.mark.invariant
def test_a_louder_record_makes_the_same_ground_louder(record, motion):
    louder = sl.fit_motion((3 * record).assign_attrs(record.attrs))
    assert louder.ground.intensity == pytest.approx(9 * motion.ground.intensity, rel=1e-6)
    np.testing.assert_allclose(louder.ground.psd(5.0), 9 * motion.ground.psd(5.0), rtol=1e-3)


@pytest.mark.slow
@pytest.mark.oracle
@pytest.mark.skipif(not SUITES.exists(), reason="no records beside the project")
def test_motions_carry_the_energy_of_records_that_were_measured():
    for record in recorded():
        table = sl.compare_motions(record, sl.fit_motion(record), paths=512)
        off = abs(float(table.energy_ratio) - 1)
        assert off < 4 * float(table.energy_ratio_standard_error), record.attrs["source"]
        peak = float(abs(record).max())
        assert float(table.peak_ground_acceleration) == pytest.approx(peak, rel=0.35)


@pytest.mark.invariant
@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (lambda r: sl.fit_motion(r.values), TypeError, "ndarray; allowed: an xarray.DataArray"),
        (lambda r: sl.fit_motion(r[:150]), ValueError, "record lasts 1.5 s; allowed: 2 s or more"),
        (lambda r: sl.fit_motion(r, "square"), ValueError, "envelope = 'square' is not known; allowed"),
        (lambda r: sl.fit_motion(r, filters=0), ValueError, "filters = 0"),
        (
            lambda r: sl.compare_motions(r, GROUND),
            TypeError,
            "motion is a CloughPenzien; allowed: a motion",
        ),
    ],
)
def test_what_cannot_be_fitted_is_refused(record, call, error, message):
    with pytest.raises(error, match=message):
        call(record)
