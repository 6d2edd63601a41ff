"""Peak factors: their formulas by another road, exact limits, and simulation."""

import numpy as np
import pytest
import scipy.linalg
from hypothesis import given
from hypothesis import strategies as st

import stochlin as sl
from stochlin.models.rules.peak_factors import PEAK_FACTORS

pytestmark = pytest.mark.oracle

DAVENPORT = sl.rules.peak_factor_model("davenport")
DER_KIUREGHIAN = sl.rules.peak_factor_model("der_kiureghian")
VANMARCKE = sl.rules.peak_factor_model("vanmarcke")
CLUMPING = {2: np.sqrt(np.pi / 2), 1: np.sqrt(2 * np.pi)}

many = st.floats(2, 1e6)
bands = st.floats(0, 1)


def oscillator_bandwidth(damping):
    """Of an elastic oscillator under white noise."""
    ratio = (2 / np.pi) * np.arccos(damping) / np.sqrt(1 - damping**2)
    return np.sqrt(1 - ratio**2)


def exact_vanmarcke(crossings, bandwidth, sides):
    """Mean and standard deviation of the distribution by Gauss-Legendre, one-sided written out."""
    n = crossings * sides / 2

    def exceeding(x):
        rate = -np.expm1(-CLUMPING[sides] * bandwidth**1.2 * x)
        start = -np.expm1(-x * x / 2)
        return 1 - start * np.exp(-n * rate / np.expm1(x * x / 2))

    ends = np.array([0, 1e-4, 1e-3, 0.01, 0.05, 0.1, *np.arange(0.5, 14, 0.5)])
    at, weight = np.polynomial.legendre.leggauss(60)
    middle, half = 0.5 * (ends[1:] + ends[:-1])[:, None], 0.5 * np.diff(ends)[:, None]
    x, weights = middle + half * at, half * weight
    mean, square = (weights * exceeding(x)).sum(), (weights * 2 * x * exceeding(x)).sum()
    return mean, np.sqrt(square - mean**2)


@pytest.mark.parametrize("sides", [1, 2])
@pytest.mark.parametrize(
    ("crossings", "bandwidth"),
    [
        (2, 0),
        (2, 0.001),
        (3, 0.3),
        (2, 1),
        (5, 0.05),
        (40, 0.2463),
        (1e3, 0.001),
        (1e6, 0.01),
        (1e8, 0.5),
    ],
)
def test_vanmarcke_by_another_quadrature(crossings, bandwidth, sides):
    mean, std = exact_vanmarcke(crossings, bandwidth, sides)
    assert float(VANMARCKE.mean(crossings, bandwidth, sides)) == pytest.approx(mean, rel=1e-11)
    assert float(VANMARCKE.std(crossings, bandwidth, sides)) == pytest.approx(std, rel=1e-10)


def stationary_peaks(damping, cycles, paths=8192, steps=48):
    """Peaks of an oscillator of unit variance under white noise, begun stationary: exact steps."""
    rng = np.random.default_rng([8, cycles])
    w = 2 * np.pi
    step = scipy.linalg.expm(np.array([[0, 1], [-w * w, -2 * damping * w]]) / steps)
    covariance = np.diag([1, w * w])
    root = np.linalg.cholesky(covariance - step @ covariance @ step.T)
    state = np.sqrt(covariance) @ rng.standard_normal((2, paths))
    high, low = state[0].copy(), state[0].copy()
    for _ in range(cycles * steps):
        state = step @ state + root @ rng.standard_normal((2, paths))
        np.maximum(high, state[0], out=high)
        np.minimum(low, state[0], out=low)
    return np.maximum(high, -low), high


# Errors of the models for two-sided and one-sided peaks, as measured with 20000 paths (standard
# error .14 %), widened to the next per cent: what each deserves, not what it is asked for.
ERRORS = {
    DAVENPORT: ((0.04, 0.21), (0.03, 0.16)),
    DER_KIUREGHIAN: ((-0.02, 0.06), (0.01, 0.08)),
    VANMARCKE: ((-0.02, 0.05), (-0.01, 0.06)),
}


@pytest.mark.parametrize(
    ("damping", "cycles", "mean", "std"),
    [
        (0.05, 20, 2.617, 0.506),
        pytest.param(0.05, 100, 3.223, 0.415, marks=pytest.mark.slow),
        (0.02, 40, 2.643, 0.517),
        (0.1, 40, 3.021, 0.432),
    ],
)
def test_models_against_simulated_peaks(damping, cycles, mean, std):
    two_sided, one_sided = stationary_peaks(damping, cycles)
    error = two_sided.std() / np.sqrt(two_sided.size)
    assert abs(two_sided.mean() - mean) < 4 * error + 0.01  # known values to a per cent of q
    bandwidth = oscillator_bandwidth(damping)
    for model, limits in ERRORS.items():
        for sides, sample, (low, high) in zip((2, 1), (two_sided, one_sided), limits, strict=True):
            ratio = float(model.mean(2 * cycles, bandwidth, sides)) / sample.mean()
            spare = 4 * error / sample.mean()
            assert low - spare < ratio - 1 < high + spare, (type(model).__name__, sides)
    # std: 1/sqrt(2 n) of sampling, and 4 to 8 % that the envelope models are too narrow
    assert float(VANMARCKE.std(2 * cycles, bandwidth)) == pytest.approx(std, rel=0.09)
    assert float(DER_KIUREGHIAN.std(2 * cycles, bandwidth)) == pytest.approx(std, rel=0.13)


@given(many, bands)
def test_sides_and_order_of_the_models(crossings, bandwidth):
    davenport, fitted, passage = (
        float(m.mean(crossings, bandwidth)) for m in (DAVENPORT, DER_KIUREGHIAN, VANMARCKE)
    )
    # from Rayleigh's peak to that of independent crossings, which is known to 1/L^2
    assert 1.2533 < passage < davenport * (1 + 1 / (2 * np.log(crossings)))
    if not np.isnan(fitted) and 2 * bandwidth * crossings > 2.1:
        assert fitted <= davenport
    for model in (DAVENPORT, DER_KIUREGHIAN, VANMARCKE):
        one, two = (float(model.mean(crossings, bandwidth, sides)) for sides in (1, 2))
        if not np.isnan([one, two]).any():
            # .8 %: the step between two pieces of Der Kiureghian's fit
            assert 0 < one <= two * 1.008
        std = float(model.std(crossings, bandwidth))
        assert np.isnan(std) or 0 < std < 2


@pytest.mark.parametrize("sides", [1, 2])
def test_outside_its_domain_a_model_says_nothing(sides):
    enough = 2 / sides
    for model in (DAVENPORT, DER_KIUREGHIAN, VANMARCKE):
        for crossings, bandwidth in ((0.99 * enough, 0.3), (-1, 0.3), (np.nan, 0.3), (np.inf, 0.3)):
            assert np.isnan(model.mean(crossings, bandwidth, sides))
            assert np.isnan(model.std(crossings, bandwidth, sides))
        for bandwidth in (-0.1, 1.01, np.nan):
            assert np.isnan(model.mean(50.0, bandwidth, sides))
        assert "crossings" in model.domain(sides)
    assert np.isnan(DAVENPORT.mean(1.33 * enough, 0.3, sides))
    assert float(DAVENPORT.mean(1.34 * enough, 0.3, sides)) > 1.5
    assert np.isnan(DER_KIUREGHIAN.mean(1.5 * enough, 0.15 * sides / 2, sides))
    assert float(VANMARCKE.mean(enough, 0.3, sides)) > 1.25


LONG = sl.KanaiTajimi(period=0.8, damping=0.4)


def test_peaks_of_simulated_motions():
    """Elastic oscillators on Kanai-Tajimi ground, from rest, over 40 periods of the slower one."""
    periods, damping, duration = (0.6, 1.0), 0.1, 40.0
    pair = [sl.Bilinear(T, damping) for T in periods]
    run = sl.simulate(pair, LONG, paths=2048, duration=duration, seed=5)
    table = sl.peak_response(sl.Bilinear(list(periods), damping), LONG, duration)
    # The start from rest takes about 1 %, the step 1/32 of a period at most .5 % of every peak;
    # Vanmarcke errs by 2 % at this damping.
    ratio, mean = table.peak_mean.values / run.peak_mean.values, run.peak_mean.values
    assert (np.abs(ratio - 1) < 0.035 + 4 * run.peak_mean_standard_error.values / mean).all()
    spread = run.peak.std("path").values
    np.testing.assert_allclose(table.peak_std, spread, rtol=0.06 + 4 / np.sqrt(2 * 2048))


def test_peaks_of_yielding_structures_by_the_drift_closure_are_those_of_motions():
    """Against motions from rest: what notes say of cells without a caution, and of the Gaussian."""
    period, factor = (0.6, 1.0, 1.0, 2.0), (3.0, 2.0, 5.0, 4.0)
    each = sl.Bilinear(list(period), 0.05, 0.1, reduction_factor=list(factor))
    alone = [
        sl.Bilinear(T, 0.05, 0.1, reduction_factor=R) for T, R in zip(period, factor, strict=True)
    ]
    run = sl.simulate(alone, LONG, paths=512, duration=30.0)
    tables = [sl.peak_response(each, LONG, 30.0, closure=c) for c in ("drift", "gaussian")]
    assert (tables[0].caution == 0).all()
    good, poor = (np.log(table.peak_mean.values / run.peak_mean.values) for table in tables)
    assert (np.abs(good) < 0.15).all()
    assert np.abs(poor).mean() > 1.5 * np.abs(good).mean()
    assert np.abs(poor).max() > np.abs(good).max()


@pytest.mark.extreme
def test_drift_grows_with_the_motion_and_stiff_structures_are_flagged():
    weak = sl.Bilinear(1.0, 0.05, 0.05, reduction_factor=3)
    ends = [sl.peak_response(weak, LONG, duration, closure="drift") for duration in (1e6, 2e6)]
    sigma = float(sl.linearize(weak, LONG, "drift").displacement_std)
    for end in ends:  # a motion without end has all of the drift
        assert float(end.displacement_std) == sigma
        crossings = sl.peak_response(weak, LONG, 2e6, closure="clipped").crossings
        assert float(end.crossings) < float(crossings)
    short = sl.peak_response(weak, LONG, 10.0, closure="drift")
    clipped = sl.peak_response(weak, LONG, 10.0, closure="clipped")
    assert clipped.peak_mean < short.peak_mean
    soil = sl.KanaiTajimi(2.0, 0.3, intensity=0.01)
    stiff = sl.Bilinear([0.9, 1.1], 0.05, 0.1, reduction_factor=3)
    assert sl.peak_response(stiff, soil, 30.0, closure="drift").caution.values.tolist() == [1, 0]
    still = sl.Bilinear([0.9, 1.1], 0.05)
    assert sl.peak_response(still, soil, 30.0).caution.values.tolist() == [0, 0]


def test_a_motion_without_crossings_has_no_peak():
    with pytest.raises(
        ValueError, match=r"holds .* zero crossings; allowed for Vanmarcke1975.*or simulate"
    ):
        sl.peak_response(sl.Bilinear(1.0, 0.05), LONG, 0.1)


@given(many, st.floats(1.001, 10), bands)
def test_a_longer_motion_has_no_lower_peak_and_one_side_none_above_that_of_two(
    n, factor, bandwidth
):
    """By every model; .8 %: the step between two pieces of Der Kiureghian's fit."""
    for model in PEAK_FACTORS.values():
        for sides in (1, 2):
            short, long = (float(model.mean(each, bandwidth, sides)) for each in (n, factor * n))
            assert np.isnan(short) or long >= short * (1 - 1e-14), model.name
        one, two = (float(model.mean(n, bandwidth, sides)) for sides in (1, 2))
        assert np.isnan([one, two]).any() or one <= two * 1.008, model.name


@given(st.floats(2, 1e6), st.floats(0, 0.9), st.floats(1e-3, 0.1))
def test_a_broader_band_has_no_lower_peak(crossings, bandwidth, more):
    low, high = (float(VANMARCKE.mean(crossings, each)) for each in (bandwidth, bandwidth + more))
    assert high >= low
