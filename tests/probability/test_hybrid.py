"""The hybrid method, fits of envelopes, and their pictures."""

import numpy as np
import pytest
import xarray as xr
from cases import check_labels, with_slow
from motions import RECORDS, motion, needs_records, recorded

import stochlin as sl
from stochlin.kernels.probability import beyond_phase, concentration, least_phase

pytestmark = pytest.mark.oracle

ONE, TWO = sl.Bilinear(0.6, 0.05), sl.Bilinear(1.0, 0.05)


def array(value):
    return np.atleast_1d(np.asarray(value, float))


@pytest.fixture(scope="module")
def quake():
    """A modulated noise through a soil of half a second, as a record."""
    time = 0.02 * np.arange(1500)
    noise = np.random.default_rng(4).normal(size=time.size)
    soil = np.exp(-0.3 * 12 * time[:100]) * np.sin(12 * time[:100])
    values = sl.GammaEnvelope(1.0, 0.2).at(time) * np.convolve(noise, soil)[: time.size]
    return motion(values, source="made")


# --- Phases ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("rho", [-1.0, -0.8, 0.0, 0.4, 1.0])
def test_phases_have_the_correlation_and_the_chances_of_drawn_ones(rho):
    k, rng, n = concentration(rho), np.random.default_rng(11), 400_000
    d = (
        np.full(n, np.arccos(rho))
        if abs(rho) == 1
        else rng.vonmises(0 if k >= 0 else np.pi, abs(k), n)
    )
    a = rng.uniform(0, 2 * np.pi, n)
    # standard error of a correlation of n pairs is at most 1/sqrt(n)
    assert np.corrcoef(np.cos(a), np.cos(a + d))[0, 1] == pytest.approx(rho, abs=4 / np.sqrt(n))
    for r1, r2, gap in ((1.0, 0.7, 0.6), (1.0, 0.3, 0.6), (1.0, 0.7, 1.8), (0.5, 0.5, 0.3)):
        reached = np.mean(r1**2 + r2**2 - 2 * r1 * r2 * np.cos(d) > gap**2)
        found = beyond_phase(least_phase(array(r1), array(r2), array(gap)), k)[0]
        assert found == pytest.approx(reached, abs=2 / np.sqrt(n)), (r1, r2, gap)


# --- Records --------------------------------------------------------------------------------------


def check_record(record, first=ONE, second=TWO):
    options = {"method": "hybrid", "record": record}
    wide = float(sl.pounding_probability(first, second, None, 0.8, **options).radius_1.max())
    gaps = xr.DataArray(wide * np.array([1e-4, 0.3, 0.8, 50.0]), dims="gap")
    table = sl.pounding_probability(first, second, None, gaps, **options)
    safe = table.confidence_of_no_pounding
    assert (safe.diff("time") <= 1e-12).all()
    assert (safe.diff("gap") >= -1e-12).all()
    assert float(safe[-1, 0]) < 1e-3
    assert float(safe[-1, -1]) == pytest.approx(1, abs=1e-12)
    # what really happened is within what the radii allow
    assert float(table.separation) <= float((table.radius_1 + table.radius_2).max())
    again = sl.pounding_probability(first, second, None, float(table.required_gap), **options)
    assert float(again.confidence_of_no_pounding[-1]) == pytest.approx(0.9, abs=1e-3)
    return table


def test_hybrid_of_a_made_record(quake):
    table = check_record(quake)
    assert table.attrs["record"] == "made"
    one, two = (sl.respond(each, quake) for each in (ONE, TWO))
    largest = float(abs(one.displacement - two.displacement).max())
    assert float(abs(table.recorded_difference).max()) == pytest.approx(largest, rel=0.01)
    check_labels(table)


@pytest.mark.slow
@pytest.mark.extreme
def test_hybrid_of_laws_beside_the_bilinear_one(quake):
    strength = {"hardening": 0.05, "yield_displacement": 0.01}
    peak_oriented = sl.ModifiedClough(0.6, 0.05, **strength)
    table = check_record(quake, peak_oriented, sl.BoucWen(1.0, 0.05, **strength))
    own = sl.recorded_gap(peak_oriented, sl.BoucWen(1.0, 0.05, **strength), quake)
    assert float(table.rho) == float(own.rho)  # the law cannot be linearized
    strong = sl.ModifiedClough(0.6, 0.05, 0.05, yield_displacement=2.0)
    elastic, same = (
        sl.pounding_probability(one, TWO, None, 0.05, method="hybrid", record=quake)
        for one in (ONE, strong)
    )
    np.testing.assert_allclose(
        same.radius_1, elastic.radius_1, atol=1e-3 * float(elastic.radius_1.max())
    )


@needs_records
@pytest.mark.parametrize("where", with_slow(RECORDS, {"SCT", "El Centro"}))
def test_hybrid_of_real_records(where):
    check_record(recorded(where))


@pytest.mark.filterwarnings("ignore:.*are the same building")
def test_hybrid_of_equal_structures_is_safe(quake):
    table = sl.pounding_probability(ONE, ONE, None, 1e-3, method="hybrid", record=quake)
    assert float(table.rho) == pytest.approx(1, abs=1e-9)
    assert (table.confidence_of_no_pounding == 1).all()


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"record": None}, "record is missing"),
        ({"first": sl.Bilinear([0.5, 0.6], 0.05)}, "is an array"),
        ({"record": 3}, "record"),
    ],
    ids=str,
)
def test_bad_hybrids_are_refused(quake, changes, message):
    arguments = {"first": ONE, "second": TWO, "ground": None, "gap": 0.1, "record": quake} | changes
    with pytest.raises((TypeError, ValueError), match=message):
        sl.pounding_probability(**arguments, method="hybrid")


# --- Envelopes and spectra ------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("model", "envelope"),
    [
        ("amin_ang", sl.AminAng(4.0, 12.0, 0.3)),
        ("shinozuka_sato", sl.ShinozukaSato(0.15, 0.6)),
        ("gamma", sl.GammaEnvelope(2.0, 0.3)),
    ],
)
def test_fit_finds_the_envelope_that_made_the_record(model, envelope):
    time = 0.01 * np.arange(6000)
    record = motion(envelope.at(time) * np.sin(60 * time), 0.01)
    fitted = sl.fit_envelope(record, model)
    np.testing.assert_allclose(fitted.at(time), envelope.at(time), atol=0.02)
