"""Rates against closed forms, and against counting."""

import numpy as np
import pytest
from scipy.stats import norm

import stochlin as sl
from stochlin.applications.risk.rates import (
    ALL_POUND,
    TOO_FEW_INTENSITIES,
    TOO_FEW_POUND,
    SeparationsByIntensity,
    lognormal_fragility,
)
from stochlin.applications.risk.risk import SimulatedRisk

K0, K = 0.02, 2.7
HAZARD = sl.PowerLawHazard(K0, K)


def lognormal_motions(count=4000, dispersion=0.4, highest=1e4):
    """Structures whose separation is in proportion to the intensity: exact for any intensities."""
    share = (np.arange(count) + 0.5) / count
    of_one = 0.1 * np.exp(dispersion * norm.ppf(share))
    intensity = np.geomspace(1e-3, highest, 9)
    return SeparationsByIntensity(intensity, of_one[:, None] * intensity)


def test_sums_over_motions_are_the_integral():
    """With the quantiles of a lognormal fragility as motions."""
    found = SimulatedRisk(lognormal_motions(), HAZARD).rate(0.3)[0]
    exact = K0 * 3.0**-K * np.exp(0.5 * (K * 0.4) ** 2)
    assert found == pytest.approx(exact, rel=2e-3)  # the quantiles leave out both ends


def test_rate_is_the_power_of_the_gap_where_all_is_linear():
    """``rate ~ gap^-k``, whatever the grid."""
    one, two = (SimulatedRisk(lognormal_motions(), HAZARD).rate(gap)[0] for gap in (0.2, 0.4))
    assert one / two == pytest.approx(2**K, rel=1e-12)


def test_what_pounds_and_then_does_not_is_counted_where_it_does():
    """A yielding pair: beyond the gap from 2 to 4, and from 8 on."""
    intensity = np.array([1.0, 2.0, 4.0, 8.0, 16.0])
    separation = np.array([[0.5, 1.0, 1.0, 1.0, 2.0]])
    separation[0, 1:3] *= [1 + 1e-9, 1 + 1e-9]
    separation[0, 3] *= 1 - 1e-9
    found = SimulatedRisk(SeparationsByIntensity(intensity, separation), HAZARD).rates(1.0).sum()
    wanted = K0 * (2.0**-K - np.sqrt(32.0) ** -K + 8.0**-K)
    assert found == pytest.approx(wanted, rel=1e-6)


@pytest.mark.extreme
@pytest.mark.parametrize("first", [0, 2, 4, 6])
@pytest.mark.parametrize("last", [8, 12, 16, 24])
@pytest.mark.parametrize("gap", [0.03, 0.3, 3.0])
def test_the_interval_contains_the_rate_of_the_whole_hazard_wherever_its_table_ends(
    first, last, gap
):
    """A curve that becomes flatter towards weaker shaking, 1e-3 to 1e5, and parts of its table."""
    intensity = np.geomspace(1e-3, 1e5, 25)
    frequency = K0 * (1 + intensity) ** -K

    def risk(part):
        hazard = sl.HazardCurve(intensity[part], frequency[part])
        levels = np.geomspace(*np.array(hazard.intensities)[[0, -1]], 13)
        motions = SeparationsByIntensity(
            levels, lognormal_motions().separation[:, -1:] / 1e4 * levels
        )
        return SimulatedRisk(motions, hazard)

    whole = risk(slice(None)).rate(gap)[0]
    ends = risk(slice(first, last + 1)).rate_with_ends(gap)
    assert ends["_lower"] <= ends[""] <= whole * (1 + 1e-6) <= ends["_upper"] * (1 + 2e-6)


@pytest.mark.filterwarnings("ignore:.*its rarest shaking")
def test_the_gap_of_an_early_end_has_an_interval_up_to_that_of_the_whole_hazard():
    intensity = np.geomspace(0.1, 20, 12)
    whole = sl.HazardCurve(intensity, K0 * intensity**-K)
    early = sl.HazardCurve(whole.intensities[:6], whole.frequencies[:6])
    risk = 1.5 * early.frequencies[-1]
    gaps = []
    for hazard in (whole, early):
        levels = np.geomspace(hazard.intensities[0], hazard.intensities[-1], 13)
        motions = SeparationsByIntensity(
            levels, lognormal_motions().separation[:, -1:] / 1e4 * levels
        )
        gaps.append(SimulatedRisk(motions, hazard).gap_of(risk))
    assert float(gaps[1].required_gap) < float(gaps[0].required_gap)
    assert float(gaps[1].required_gap_upper) > float(gaps[0].required_gap)


@pytest.mark.parametrize(
    "highest",
    [
        pytest.param(1e4, id="all motions pound"),
        pytest.param(4.0, id="half of them", marks=pytest.mark.slow),
    ],
)
def test_errors_of_the_fragility_are_those_of_repetitions(highest):
    rng = np.random.default_rng(4)
    intensity, found = np.geomspace(1e-2, highest, 7), []
    for _ in range(300):
        of_one = 0.1 * np.exp(0.5 * rng.standard_normal(200))
        found.append(
            lognormal_fragility(SeparationsByIntensity(intensity, of_one[:, None] * intensity), 0.3)
        )
    median, dispersion, median_error, dispersion_error, _ = np.array(found).T
    for values, errors, exact in ((median, median_error, 3.0), (dispersion, dispersion_error, 0.5)):
        covered = (np.abs(values - exact) < 1.96 * errors).mean()
        assert abs(covered - 0.95) < 4 * np.sqrt(0.95 * 0.05 / 300)
    sampling = 4 / np.sqrt(2 * 300)  # of a standard deviation, four standard errors
    assert median.std() == pytest.approx(median_error.mean(), rel=sampling)
    assert dispersion.std() == pytest.approx(dispersion_error.mean(), rel=sampling)


def test_errors_where_motions_never_pound_are_those_of_the_likelihood():
    """By its second differences: density of those that pound, and probability of all others."""
    of_one = 0.1 * np.exp(0.5 * np.random.default_rng(6).standard_normal(400))
    first = 0.3 / of_one
    found = lognormal_fragility(
        SeparationsByIntensity(np.array([1e-2, 4.0]), of_one[:, None] * [1e-2, 4.0]), 0.3
    )
    seen = first[first < 4.0]

    def surprise(median, dispersion):
        above = norm.sf(np.log(4.0 / median) / dispersion)
        density = norm.pdf(np.log(seen / median) / dispersion) / dispersion
        return -np.log(density).sum() - (first.size - seen.size) * np.log(above)

    at, h = np.array(found[:2]), 1e-3 * np.eye(2)
    curvature = [
        [
            sum(s * t * surprise(*(at + s * one + t * two)) for s in (1, -1) for t in (1, -1))
            / 4e-6
            for one in h
        ]
        for two in h
    ]
    assert 100 < seen.size < 300
    np.testing.assert_allclose(found[2:4], np.sqrt(np.diag(np.linalg.inv(curvature))), rtol=1e-3)


@pytest.mark.parametrize(
    ("separation", "status"),
    [
        (np.full((8, 3), 0.2), TOO_FEW_POUND),  # none of them
        (np.vstack([np.full((7, 3), 0.2), [[0.2, 0.2, 0.4]]]), TOO_FEW_POUND),
        (np.full((8, 3), 0.4), ALL_POUND),
        (np.array([[0.2], [0.4]]), TOO_FEW_INTENSITIES),
        (
            np.vstack([np.full((4, 3), 0.2), np.tile([0.2, 0.3, 0.4], (4, 1))]),
            TOO_FEW_POUND,
        ),  # as one
    ],
)
def test_a_fragility_that_cannot_be_fitted_says_why(separation, status):
    found = lognormal_fragility(
        SeparationsByIntensity(np.arange(1.0, separation.shape[1] + 1), separation), 0.3
    )
    assert found[4] == status
    assert np.isnan(found[:4]).all()


def test_below_the_lowest_intensity_separations_go_as_those_of_linear_structures():
    """In proportion to accelerations, with the root of ``S0``."""
    of_one = 0.1 * np.exp(0.5 * np.random.default_rng(5).standard_normal(500))
    for power in (1.0, 0.5):
        low, high = (np.geomspace(lowest, 1e3, 9) for lowest in (1e-3, 6.0))
        whole, cut = (
            lognormal_fragility(SeparationsByIntensity(im, of_one[:, None] * im**power, power), 0.3)
            for im in (low, high)
        )
        np.testing.assert_allclose(cut[:4], whole[:4], rtol=1e-9)
