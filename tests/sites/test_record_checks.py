"""Records that do not suit are found, and others are not."""

import numpy as np
import pytest

import stochlin as sl
from stochlin.kernels.records.velocity_pulses import _coefficients, _sampled

STEP = 0.01
SHAPE = sl.AminAng(3.0, 10.0, 0.5)
GROUND = sl.CloughPenzien(0.5, 0.4, 4.0, 0.6, intensity=0.001)
MOTIONS = sl.simulated_motions(GROUND, 25.0, SHAPE, paths=3, seed=5)


def pulse(period, peak, middle=8.0, cycles=1.5):
    """Acceleration of the velocity pulse of Mavroeidis and Papageorgiou (2003)."""
    time = MOTIONS.time.values
    phase = 2 * np.pi * (time - middle) / period
    inside = np.abs(phase) <= np.pi * cycles
    velocity = np.where(inside, 0.5 * peak * (1 + np.cos(phase / cycles)) * np.cos(phase), 0.0)
    return np.gradient(velocity, time)


def with_pulse(period, peak):
    return (MOTIONS[0] + pulse(period, peak)).assign_attrs(MOTIONS[0].attrs)


def test_the_wavelet_is_that_of_daubechies():
    """Four moments vanish, the energy is one, and shifts by whole scales are orthogonal."""
    scale = 128
    wavelet = _sampled(scale)
    time = (np.arange(wavelet.size) + 0.5) / scale
    moments = [float(wavelet @ time**n) for n in range(5)]
    # Of the means over samples, 1/scale of a unit each.
    np.testing.assert_allclose(moments[:4], 0.0, atol=2e-3 * abs(moments[4]))
    assert float(wavelet @ wavelet) == pytest.approx(1.0, abs=2e-3)
    shifts = [float(wavelet[n * scale :] @ wavelet[: -n * scale]) for n in (1, 2, 3)]
    np.testing.assert_allclose(shifts, 0.0, atol=2e-3)


def test_the_transform_finds_a_wavelet_where_it_is():
    signal = np.zeros(2000)
    wavelet = _sampled(40)
    signal[700 : 700 + wavelet.size] = 3.0 * wavelet
    found = _coefficients(signal, 40)
    assert int(np.abs(found).argmax()) == 700 + 7 * 40 // 2
    assert float(found.max()) == pytest.approx(3.0, rel=5e-3)


@pytest.mark.parametrize("period", [1.5, 3.0, 5.0])
def test_a_pulse_is_found_with_its_period(period):
    table = sl.check_records({"plain": MOTIONS[0], "pulse": with_pulse(period, 0.6)})
    plain, found = table.pulse_indicator.values
    assert not plain > 0
    assert found > 0
    # The period of a wavelet of another shape.
    assert float(table.pulse_period[1]) == pytest.approx(period, rel=0.3)
    assert "velocity pulse of" in str(table.doubts.values[1])


def test_a_weak_pulse_is_none():
    table = sl.check_records(with_pulse(3.0, 0.01))
    assert not table.pulse_indicator.values[0] > 0


def test_an_offset_and_a_cut_are_found():
    peak = float(abs(MOTIONS[0]).max())
    whole, shifted = MOTIONS[0], MOTIONS[0] + 0.02 * peak
    table = sl.check_records({"whole": whole, "shifted": shifted, "cut": whole[600:1200]})
    assert [bool(text) for text in table.doubts.values] == [False, True, True]
    assert float(table.offset[1]) == pytest.approx(float(shifted.mean() / abs(shifted).max()))
    assert "subtract it" in str(table.doubts.values[1])
    first = float(np.sqrt((MOTIONS[0][600:700] ** 2).mean()))
    energy = np.cumsum(MOTIONS[0][600:1200].values ** 2)
    strong = MOTIONS[0][600:1200].values[(energy >= 0.05 * energy[-1]) & (energy < 0.95 * energy[-1])]
    assert float(table.start_level[2]) == pytest.approx(first / np.sqrt((strong**2).mean()), rel=1e-2)
    assert "It starts with" in str(table.doubts.values[2])


def test_a_spectrum_of_another_shape_is_told_whatever_its_scale():
    lakebed = sl.CloughPenzien(2.0, 0.05, 8.0, 0.6, intensity=0.01)
    soft = sl.simulated_motions(lakebed, 25.0, SHAPE, paths=2, seed=5)
    suite = {"firm": MOTIONS[0], "loud": 5 * MOTIONS[0], "soft": soft[0]}
    table = sl.check_records(suite, spectrum=sl.eurocode_8(2.5, "B"))
    firm, loud, lake = table.spectral_misfit.values
    assert firm == pytest.approx(loud)
    assert firm < 0.5 < lake
    assert "another shape" in str(table.doubts.values[2])


@pytest.mark.slow
def test_motions_without_doubts_raise_few_false_alarms():
    """None of 100: with a true share of 3 % that happens once in twenty times."""
    shape = sl.AminAng(4.0, 12.0, 0.5)
    made = sl.simulated_motions(GROUND, 25.0, shape, paths=100, seed=7)
    assert [text for text in sl.check_records(list(made)).doubts.values.tolist() if text] == []


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: sl.check_records([]), "record is empty"),
        (lambda: sl.check_records(MOTIONS[0], band=(1.0, 0.5)), "band = .* allowed: 0 < lower < upper"),
        (
            lambda: sl.check_records({"a": 0 * MOTIONS[0]}),
            "record a: record holds only zeros",
        ),
    ],
)
def test_what_cannot_be_checked_is_refused(call, message):
    with pytest.raises(ValueError, match=message):
        call()
