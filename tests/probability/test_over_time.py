"""Probability of pounding: against simulation, its own limits, and formulas of the crossings."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.integrate
import scipy.stats
import xarray as xr
from cases import check_labels
from hypothesis import given
from hypothesis import strategies as st

import stochlin as sl
from stochlin.kernels.probability import exceeding, hazards, positive_part

pytestmark = [pytest.mark.oracle, pytest.mark.extreme]

BROAD = sl.KanaiTajimi(2 * np.pi / 15, 0.6, intensity=0.01)
QUAKE = {"envelope": sl.AminAng(4.0, 15.0, 0.35), "duration": 25.0}
ONE, TWO = sl.Bilinear(0.6, 0.05), sl.Bilinear(1.0, 0.05)


def probability(*args, **changes):
    return sl.pounding_probability(*args, **({"paths": 0} | QUAKE | changes))


# --- Crossings ------------------------------------------------------------------------------------


@given(st.floats(-40, 40), st.floats(1e-6, 10))
def test_positive_part_is_the_truncated_mean(mean, deviation):
    if abs(mean / deviation) > 30:
        assert float(positive_part(np.array(mean), np.array(deviation))) == pytest.approx(
            max(mean, 0), abs=1e-12
        )
        return
    reach = mean + 12 * deviation
    law = scipy.stats.norm(mean, deviation)
    if reach <= 0:
        return
    exact = scipy.integrate.quad(
        lambda x: x * law.pdf(x),
        0,
        max(reach, 0),
        points=[min(max(mean, 0), reach)],
        epsabs=0,
        epsrel=1e-9,
        limit=400,
    )[0]
    assert float(positive_part(np.array(mean), np.array(deviation))) == pytest.approx(
        exact, rel=1e-6
    )


@given(st.floats(1e-6, 40), st.floats(-1, 1), st.floats(0, 1))
def test_rates_are_finite_ordered_and_no_rate_where_nothing_moves(h, kappa, bandwidth):
    poisson, first = hazards(*(np.array(x) for x in (h, 1.0, kappa, 1.0, bandwidth)))
    assert np.isfinite(poisson)
    assert np.isfinite(first)
    assert poisson >= 0
    assert first >= 0
    # a clump holds at least one crossing, of those that start below
    assert first <= poisson / -np.expm1(-0.5 * h * h) * (1 + 1e-12)
    still = hazards(*(np.array(x) for x in (h, 0.0, 0.0, 1.0, bandwidth)))
    assert still == (0, 0)
    assert float(exceeding(np.array(h), np.array(0.0))) == 0


def test_rates_of_a_stationary_process_are_rice_and_vanmarcke():
    h, delta = np.linspace(0.5, 5, 10), 0.2
    poisson, first = hazards(h, *(np.array(x) for x in (1.0, 0.0, 4.0, delta)))
    np.testing.assert_allclose(poisson, 2 / (2 * np.pi) * np.exp(-0.5 * h * h), rtol=1e-12)
    clumps = (1 - np.exp(-np.sqrt(2 * np.pi) * delta * h)) / (1 - np.exp(-0.5 * h * h))
    np.testing.assert_allclose(first, poisson * clumps, rtol=1e-12)


def test_crossing_rate_that_changes_with_time_is_that_of_the_formula_written_out():
    kappa, h, s, sv = 0.4, 1.7, 0.3, 2.0
    chi = kappa * h / np.sqrt(1 - kappa**2)
    shape = np.exp(-0.5 * chi**2) + np.sqrt(2 * np.pi) * chi * scipy.stats.norm.cdf(chi)
    expected = np.sqrt(1 - kappa**2) / (2 * np.pi) * sv / s * np.exp(-0.5 * h * h) * shape
    poisson, _ = hazards(*(np.array(x) for x in (h * s, s * s, kappa * s * sv, sv * sv, 0.3)))
    assert float(poisson) == pytest.approx(expected, rel=1e-12)


# --- Against simulation ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("pair", "lowest", "highest"),
    [((0.9, 1.0), -0.02, 0.07), ((0.5, 2.0), -0.18, 0.02)],
    ids=["close", "far apart"],
)
def test_error_of_the_confidence_is_what_the_notes_say(pair, lowest, highest):
    structures = [sl.Bilinear(T, 0.05) for T in pair]
    sigma = float(probability(*structures, BROAD, 1.0).difference_std.max())
    gaps = xr.DataArray(sigma * np.linspace(1, 4, 7), dims="gap")
    last = probability(*structures, BROAD, gaps, paths=8192, points=6).isel(time=-1)
    error = last.confidence_of_no_pounding - last.confidence_of_no_pounding_simulated
    # four standard errors of a share of 8192 are 0.022 at most
    assert float(error.max()) < highest
    assert float(error.min()) > lowest
    assert float(abs(error).sel(gap=6).max()) < 0.02


# --- Limits and symmetries ------------------------------------------------------------------------


def test_time_runs_from_certain_safety_and_gaps_are_ordered():
    gaps = xr.DataArray([1e-3, 0.05, 0.1, 0.2, 5.0], dims="gap")
    table = probability(ONE, TWO, BROAD, gaps, envelope=None)
    safe = table.confidence_of_no_pounding
    assert (safe.isel(time=0) == 1).all()
    assert (safe.diff("time") <= 0).all()
    assert (safe.diff("gap") >= 0).all()
    assert float(safe[-1, 0]) < 1e-3
    assert float(safe[-1, -1]) == 1
    assert (table.instantaneous_probability.diff("gap") <= 0).all()
    assert float(table.instantaneous_probability.max()) <= 0.5
    again = probability(ONE, TWO, BROAD, float(table.required_gap), envelope=None)
    assert float(again.confidence_of_no_pounding[-1]) == pytest.approx(0.9, abs=1e-6)


def test_equal_structures_never_pound():
    table = probability(ONE, ONE, BROAD, 1e-3, paths=64)
    assert (table.confidence_of_no_pounding == 1).all()
    assert (table.instantaneous_probability == 0).all()
    assert (table.confidence_of_no_pounding_simulated == 1).all()
    assert float(table.required_gap) == 0
    assert (table.rho[1:] == pytest.approx(1, abs=1e-9)).all()


def test_linearization_of_a_yielding_pair_is_unsafe():
    pair = [sl.Bilinear(T, 0.05, 0.05, reduction_factor=4) for T in (0.6, 1.0)]
    gaps = xr.DataArray([0.04, 0.06, 0.08, 0.1, 0.12], dims="gap")
    last = probability(*pair, BROAD, gaps, closure="gaussian", paths=2048).isel(time=-1)
    error = last.confidence_of_no_pounding - last.confidence_of_no_pounding_simulated
    assert float(error.max()) > 0.2 - 0.044  # four standard errors of a share of 2048, at most
    assert float(last.required_gap) < 0.85 * float(last.required_gap_simulated)


def test_tables_are_labelled_and_bad_gaps_blank():
    gaps = xr.DataArray([0.1, -0.1, 0.2], dims="gap")
    table, again = (probability(ONE, TWO, BROAD, gaps, paths=64, points=5) for _ in range(2))
    assert table.confidence_of_no_pounding.isnull().all("time").values.tolist() == [
        False,
        True,
        False,
    ]
    assert table.status.values.tolist() == [0, 3, 0]
    check_labels(table)
    xr.testing.assert_identical(table, again)


def test_a_fragility_falls_with_the_gap_and_grows_with_the_intensity():
    pair = [sl.Bilinear(T, 0.05, 0.05, yield_displacement=0.02) for T in (0.6, 1.0)]
    gaps, intensities = np.linspace(0.02, 0.6, 12), [1e-3, 0.01, 0.05]
    quake = {"envelope": sl.AminAng(2.0, 6.0, 0.5), "duration": 8.0}
    table = sl.pounding_fragility(*pair, BROAD, gaps, intensities, paths=0, **quake)
    chance = table.pounding_probability
    assert chance.sizes == {"intensity": 3, "gap": 12}
    assert (chance.diff("gap") <= 0).all()
    assert (chance.diff("intensity") >= 0).all()
    alone = probability(*pair, BROAD, float(gaps[3]), points=11, **quake).confidence_of_no_pounding[
        -1
    ]
    # The drift closure is interpolated between levels, which differ for one intensity and three.
    assert float(chance[1, 3]) == pytest.approx(1 - float(alone), abs=1e-4)


def test_lognormal_fragility_of_elastic_structures_is_that_of_their_separations():
    """Each motion takes the gap at ``S0`` times the square of gap over separation."""
    pair, gap = [sl.Bilinear(T, 0.05) for T in (0.6, 1.0)], 0.1
    intensities = [0.001, 0.004, 0.016, 0.064, 0.256]
    table = sl.pounding_fragility(*pair, BROAD, [gap, 5.0, 1e-4], intensities, paths=256, **QUAKE)
    motions = sl.simulate(pair, BROAD, paths=256, **QUAKE).separation[:, 0, 1].values
    enough = np.log(0.01 * (gap / motions) ** 2)
    found, error = table.sel(gap=gap), enough.std() / np.sqrt(256)
    assert float(found.fragility_median) == pytest.approx(np.exp(enough.mean()), rel=1e-9)
    assert float(found.fragility_dispersion) == pytest.approx(enough.std(), rel=1e-9)
    assert float(found.fragility_median_standard_error / found.fragility_median) == pytest.approx(
        error
    )
    shares = (motions * np.sqrt(np.array(intensities)[:, None] / 0.01) > gap).mean(axis=1)
    np.testing.assert_array_equal(found.pounding_probability_simulated, shares)
    meanings = table.fragility_status.attrs["flag_meanings"].split()
    assert [meanings[code] for code in table.fragility_status.values] == [
        "fitted",
        "fewer_than_two_motions_pound",
        "all_pound_at_the_lowest_intensity",
    ]
    assert table.fragility_median.isnull().values.tolist() == [False, True, True]


# --- Bad input ------------------------------------------------------------------------------------


class Negative(sl.GammaEnvelope):
    def at(self, time):
        return super().at(time) - 0.5


class Nothing(sl.GammaEnvelope):
    def at(self, time):
        return 0 * super().at(time)


def test_fragilities_of_other_intensities_and_of_tables_are_refused():
    for intensity in ([0.02, 0.01], [0.0, 0.01], [0.01, np.inf]):
        with pytest.raises(ValueError, match=r"intensity = .* allowed: a positive number"):
            sl.pounding_fragility(ONE, TWO, BROAD, 0.1, intensity, **QUAKE)
    with pytest.raises(ValueError, match=r"first\.period is an array"):
        sl.pounding_fragility(sl.Bilinear([0.5, 0.6], 0.05), TWO, BROAD, 0.1, 0.01, **QUAKE)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"gap": 0}, "gap = 0"),
        ({"envelope": Negative(1.0, 0.2)}, "allowed: finite values from 0 on"),
        ({"envelope": Nothing(1.0, 0.2)}, "is 0 during the whole"),
        ({"paths": 1}, "paths = 1"),
        ({"method": "hybrid"}, "envelope = .* does not apply: method is hybrid"),
        ({"record": xr.DataArray(0.0)}, "record = .* does not apply: method is evolutionary"),
    ],
    ids=str,
)
def test_bad_input_is_refused(changes, message):
    arguments = {"gap": 0.1, "paths": 0} | QUAKE | changes
    with pytest.raises((TypeError, ValueError), match=message):
        sl.pounding_probability(ONE, TWO, BROAD, **arguments)


# --- Parameters that are not known exactly
# ------------------------------------------------------------


@pytest.mark.slow
def test_an_uncertain_ground_widens_what_is_needed():
    strong = replace(BROAD, intensity=sl.Uncertain(0.01, 1.0))
    known, unknown = (
        probability(ONE, TWO, each, 0.06, paths=1024, points=5) for each in (BROAD, strong)
    )
    assert float(unknown.required_gap_simulated_lower) > float(known.required_gap_simulated_upper)
    assert float(unknown.required_gap) == float(known.required_gap)
    assert unknown.input_factor.sizes == {"path": 1024, "input": 1}


def test_a_fragility_is_of_what_is_known():
    one = sl.Bilinear(sl.Uncertain(1.0, 0.2), 0.05)
    with pytest.raises((TypeError, ValueError), match=r"first = .* ± 20 %.*give its median\(\)"):
        sl.pounding_fragility(one, TWO, BROAD, 0.05, [0.01, 0.02], duration=10.0)
