"""An envelope from outside, the documentation's: its shape, in simulations and in case files."""

import numpy as np
import pytest
from cases import FIRM_SITE, KIOSK

import stochlin as sl
from stochlin.models.envelopes import ENVELOPES

ENVELOPE = """duration = "30 s"
envelope = "yeh_wen"
rise = 3.0
decay = "0.2 1/s"
level = 50.0
bend = 2.0
"""
CASE = FIRM_SITE.replace('duration = "12 s"\n', ENVELOPE) + KIOSK.format(n=1) + KIOSK.format(n=2)
CASE += "[separation]\nconfidence = 0.9\n[simulation]\npaths = 128\n"
SETS = [(3.0, 0.2, 50.0, 2.0), (0.5, 0.05, 1e-3, 4.0), (6.0, 1.5, 2.0, 0.3)]  # b, c, d, e


@pytest.mark.oracle
@pytest.mark.parametrize(("rise", "decay", "level", "bend"), SETS)
def test_the_envelope_of_the_page_is_its_formula_over_the_maximum(
    example, rise, decay, level, bend
):
    time = rise / decay * np.append(0, np.geomspace(1e-6, 1, 400_001))
    shape = np.sqrt(time**rise * np.exp(-decay * time) / (level + time**bend))
    envelope = example("An envelope", ENVELOPES)(rise, decay, level, bend)
    np.testing.assert_allclose(envelope.at(time), shape / shape.max(), rtol=0, atol=1e-8)


@pytest.mark.oracle
def test_without_a_bend_it_is_the_gamma_envelope(example):
    """Of half the powers, since a root is taken; the same motions have the same peaks."""
    bent = example("An envelope", ENVELOPES)(3.0, 0.4, 1e12, 1.0)
    gamma = sl.GammaEnvelope(1.5, 0.2)
    structure, ground = sl.Bilinear(0.7, 0.05), sl.WhiteNoise(0.01)
    peaks = [
        sl.simulate([structure], ground, paths=32, duration=30.0, envelope=each).peak
        for each in (bent, gamma)
    ]
    np.testing.assert_allclose(*peaks, rtol=1e-9)


@pytest.mark.cli
@pytest.mark.slow
def test_a_case_file_takes_the_envelope_by_its_name(toy, tmp_path):
    (tmp_path / "case.toml").write_text(CASE, encoding="utf-8")
    done = toy("gap", "case.toml")
    assert done.returncode == 0, done.stderr
    assert "should stand" in done.stdout
    (tmp_path / "case.toml").write_text(CASE.replace('"0.2 1/s"', '"-0.2 1/s"'), encoding="utf-8")
    wrong = toy("gap", "case.toml")
    assert wrong.returncode == 2
    assert "motion.decay = '-0.2 1/s' is out of range" in " ".join(wrong.stderr.split())
