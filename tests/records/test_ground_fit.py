"""Fitted grounds: published fits, recovery of a known ground, scaling; and the named grounds."""

import re

import numpy as np
import pytest
from motions import motion, needs_records, recorded

import stochlin as sl

pytestmark = pytest.mark.oracle

TAU = 2 * np.pi
ESTIMATORS = ("psd", "log_psd", "whittle")


def lake_bed(column):
    return recorded("SCT", column=column)


def taft():
    return recorded("Taft")


def kanai_tajimi_psd(frequency, wg, xig, intensity):
    ratio = (frequency / wg) ** 2
    return intensity * (1 + 4 * xig**2 * ratio) / ((1 - ratio) ** 2 + 4 * xig**2 * ratio)


def clough_penzien_psd(frequency, wg, xig, wf, xif, intensity):
    ratio = (frequency / wf) ** 2
    high_pass = ratio**2 / ((1 - ratio) ** 2 + 4 * xif**2 * ratio)
    return kanai_tajimi_psd(frequency, wg, xig, intensity) * high_pass


def simulated(psd, duration, step=0.02, seed=0):
    """Piece of a periodic Gaussian process four times as long, which has the PSD to the letter."""
    samples = round(duration / step)
    frequency = TAU * np.fft.rfftfreq(4 * samples, step)
    rng = np.random.default_rng(seed)
    normal = rng.standard_normal((2, frequency.size))
    amplitude = (normal[0] + 1j * normal[1]) * np.sqrt(psd(frequency) * frequency[1] / 2)
    values = 4 * samples * np.fft.irfft(amplitude, 4 * samples)[:samples]
    return motion(values, step)


def standard_errors(wg, xig, duration, estimator, low, high):
    """Relative errors of (wg, xig, S0), by integrals over frequency of the estimating equations.

    With g the slopes of log S in the log parameters and T the duration:
    cov = A^-1 B A^-1 2 pi/T, A = int w g g', B = v int w^2 g g'; w = S^2, v = 1 for least squares
    on the PSD, w = 1 for the others, v = pi^2/6 on its logarithm.
    """
    w = np.linspace(low, high, 200_001)
    ratio, spread = (w / wg) ** 2, 4 * xig**2 * (w / wg) ** 2
    below = (1 - ratio) ** 2 + spread
    by_damping = 2 * spread / (1 + spread) - 2 * spread / below
    by_frequency = -2 * spread / (1 + spread) + (2 * spread - 4 * ratio * (1 - ratio)) / below
    slopes = np.array([by_frequency, by_damping, np.ones_like(w)])
    weight = kanai_tajimi_psd(w, wg, xig, 1.0) ** 2 if estimator == "psd" else np.ones_like(w)
    variance = np.pi**2 / 6 if estimator == "log_psd" else 1.0
    step = w[1] - w[0]
    bread = np.linalg.inv((weight * slopes) @ slopes.T * step)
    filling = variance * (weight**2 * slopes) @ slopes.T * step
    return np.sqrt(np.diag(bread @ filling @ bread) * TAU / duration)


# --- Published fits
# ---------------------------------------------------------------------------------


@needs_records
@pytest.mark.parametrize(
    ("record", "wg", "xig", "tolerance"),
    [
        (lambda: lake_bed(2), 3.09, 0.054, 0.03),
        # 37 s do not resolve this peak: a sinusoid of that duration would give xig = 0.024.
        (lambda: lake_bed(3), 3.11, 0.033, 0.15),
        (taft, 17.8, 0.45, 0.03),
    ],
    ids=["SCT NS", "SCT EW", "Taft"],
)
def test_fits_are_those_that_were_published(record, wg, xig, tolerance):
    ground = sl.fit_ground(record())
    assert TAU / ground.period == pytest.approx(wg, rel=0.005)
    assert ground.damping == pytest.approx(xig, rel=tolerance)


@pytest.mark.parametrize("duration", [20.0, 80.0])
def test_a_sinusoid_has_the_width_of_its_line(duration):
    """That is (sin x/x)^2 of x = (w - wg) T/2 in a periodogram, half as high at x = 1.3916."""
    time = 0.02 * np.arange(round(duration / 0.02) + 1)
    ground = sl.fit_ground(motion(np.sin(np.pi * time)))
    width = 2 * 1.3916 / (0.9 * duration) / np.pi
    assert ground.period == pytest.approx(2.0, rel=1e-3)
    assert ground.damping < width
    assert (
        f"damping not well resolved (a sinusoid of this duration gives {width:.2g})"
        in ground.source
    )


# --- A known ground
# -----------------------------------------------------------------------------------

GROUNDS = [(10.0, 0.3, 300.0), (17.8, 0.45, 200.0), (3.1, 0.1, 2000.0), (5.0, 0.8, 600.0)]


@pytest.mark.slow
@pytest.mark.parametrize("estimator", ESTIMATORS)
@pytest.mark.parametrize(("wg", "xig", "duration"), GROUNDS)
def test_recovers_a_known_ground(wg, xig, duration, estimator):
    """Mean of 8 records: within 3.5 of its standard errors, and the error printed is that one."""
    intensity, low, high = 0.02, 0.05 * wg, 5 * wg
    expected = standard_errors(wg, xig, duration, estimator, low, high)
    logs, printed = [], []
    for seed in range(8):
        record = simulated(
            lambda w: kanai_tajimi_psd(w, wg, xig, intensity), duration, step=0.3 / wg, seed=seed
        )
        ground = sl.fit_ground(
            record, estimator=estimator, part=(0, 1), frequency_range=(low, high)
        )
        logs.append(
            np.log([TAU / ground.period / wg, ground.damping / xig, ground.intensity / intensity])
        )
        shares = re.findall(r"(?:period|damping|intensity) ([\d.]+) %", ground.source)
        printed.append([float(share) / 100 for share in shares])
    assert np.all(np.abs(np.mean(logs, axis=0)) < 3.5 * expected / np.sqrt(8))
    # Seven degrees of freedom: the scatter over its expectation is 0.28 to 1.9 in all but 0.1 %.
    scatter = np.std(logs, axis=0, ddof=1) / expected
    assert np.all((scatter > 0.28) & (scatter < 1.9))
    np.testing.assert_allclose(np.mean(printed, axis=0), expected, rtol=0.2, atol=0.001)


@pytest.mark.parametrize("estimator", ESTIMATORS)
@pytest.mark.parametrize(("factor", "faster"), [(-1.0, 1), (3.0, 1), (1e-6, 1), (1e4, 4)])
def test_scaled_record_has_a_scaled_intensity_and_a_faster_one_a_shorter_period(
    estimator, factor, faster
):
    record = simulated(lambda w: kanai_tajimi_psd(w, 8.0, 0.3, 1.0), 60.0)
    scaled = (factor * record).assign_coords(time=record.time / faster)
    one, other = (sl.fit_ground(r, estimator=estimator) for r in (record, scaled))
    assert other.period == pytest.approx(one.period / faster, rel=1e-6)
    assert other.damping == pytest.approx(one.damping, rel=1e-6)
    assert other.intensity == pytest.approx(factor**2 * one.intensity / faster, rel=1e-6)


# --- Refusals
# -----------------------------------------------------------------------------------------


def test_silence_before_and_after_a_record_changes_nothing():
    values = simulated(lambda w: kanai_tajimi_psd(w, 8.0, 0.3, 1.0), 60.0).to_numpy()
    padded = np.concatenate([np.zeros(700), values, np.zeros(900)])
    alone, within = (sl.fit_ground(motion(each)) for each in (values, padded))
    assert within.period == pytest.approx(alone.period, rel=1e-9)
    assert within.damping == pytest.approx(alone.damping, rel=1e-9)


def test_the_high_pass_filter_of_a_known_ground_is_recovered():
    """With a period of 8 times that of the soil, at a frequency that 600 s resolve."""
    record = simulated(lambda w: clough_penzien_psd(w, 12.0, 0.03, 1.5, 0.5, 1.0), 600.0)
    ground = sl.fit_ground(record, "clough_penzien", estimator="whittle", part=(0, 1))
    assert ground.high_pass_period == pytest.approx(TAU / 1.5, rel=0.2)
    assert ground.period == pytest.approx(TAU / 12.0, rel=0.1)


def test_white_noise_has_no_ground_period():
    noise = motion(np.random.default_rng(0).standard_normal(3000))
    with pytest.raises(ValueError, match=r"ends on a bound of .*try another estimator.*WhiteNoise"):
        sl.fit_ground(noise, estimator="whittle")


# --- Named grounds
# ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "wg", "xig", "wf", "xif"),
    [
        ("firm", 15, 0.6, 1.5, 0.6),
        ("soft", 5, 0.2, 0.5, 0.6),
        ("ec8_c", 7.49, 0.84, 2.14, 1.15),
        ("mexico_city_1985_yeh_wen", 4.2, 0.1, 0.23, 0.1),
    ],
)
def test_named_grounds_have_their_published_spectra(name, wg, xig, wf, xif):
    frequency = np.geomspace(0.05, 100, 50)
    expected = clough_penzien_psd(frequency, wg, xig, wf, xif, 2.0)
    np.testing.assert_allclose(sl.named_ground(name, 2.0).psd(frequency), expected, rtol=1e-12)
