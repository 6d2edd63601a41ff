"""A ground from outside, the documentation's: its spectrum and response, and in case files."""

from dataclasses import dataclass

import numpy as np
import pytest
import scipy.linalg
from cases import FIRM_SITE, KIOSK

import stochlin as sl
from stochlin.models.grounds import GROUNDS, Filter, Ground
from stochlin.models.parameters import POSITIVE, Parameter, parameter

GROUND = """"hu_zhou"
period = "0.4 s"
damping = 0.6
corner_period = "4 s\""""
CASE = FIRM_SITE.replace('"firm"', GROUND) + KIOSK.format(n=1) + KIOSK.format(n=2)
CASE += "[separation]\nconfidence = 0.9\n[simulation]\npaths = 128\n"


@pytest.mark.oracle
def test_the_ground_of_the_page_has_the_spectrum_of_its_formula(example):
    ground = example("A ground", GROUNDS)(0.4, 0.6, 4.0, 0.02)
    w = np.geomspace(1e-2, 1e3, 61)
    ratio, spread = (w * 0.4 / (2 * np.pi)) ** 2, (2 * 0.6 * w * 0.4 / (2 * np.pi)) ** 2
    removed = w**6 / (w**6 + (2 * np.pi / 4.0) ** 6)
    density = 0.02 * (1 + spread) / ((1 - ratio) ** 2 + spread) * removed
    np.testing.assert_allclose(ground.psd(w), density, rtol=1e-10)


@pytest.mark.oracle
def test_a_structure_on_the_ground_of_the_page_has_the_covariance_of_both(example):
    """By the Lyapunov equation of structure and filter, whose white noise is 2 pi S0 strong."""
    ground = example("A ground", GROUNDS)(0.4, 0.6, 4.0, 0.02)
    filtered = ground.lone_filter().arrays
    w = 2 * np.pi / 1.3
    system = scipy.linalg.block_diag([[0, 1], [-(w**2), -2 * 0.05 * w]], filtered.matrix)
    system[1, 2:] = -filtered.output
    noise = np.concatenate([[0, 0], filtered.noise])
    strength = 2 * np.pi * 0.02 * np.outer(noise, noise)
    covariance = scipy.linalg.solve_continuous_lyapunov(system, -strength)
    table = sl.linearize(sl.Bilinear(1.3, 0.05), ground)
    assert float(table.displacement_std) == pytest.approx(np.sqrt(covariance[0, 0]), rel=1e-9)


@dataclass(frozen=True)
class Growing(Ground):
    """A filter with a sign too many."""

    name = "growing"
    period: Parameter = parameter("s", "ground period", POSITIVE)
    intensity: Parameter = parameter("m^2/s^3", "two-sided PSD of the white noise", POSITIVE, 0.01)

    @staticmethod
    def filter(values):
        w = 2 * np.pi / values["period"]
        return Filter(
            values["intensity"], ("x", "v"), [[0, 1], [-(w**2), 0.2 * w]], [0, 1], [w**2, 0]
        )


PAIR = [sl.Bilinear(1.3, 0.05), sl.Bilinear(0.9, 0.05)]


@pytest.mark.invariant
@pytest.mark.parametrize("period", [0.4, [0.4, 0.8]], ids=["number", "cells"])
@pytest.mark.parametrize(
    "use",
    [
        lambda ground: ground.psd(1.0),
        lambda ground: sl.linearize(PAIR[0], ground),
        lambda ground: sl.correlate(*PAIR, ground),
        lambda ground: sl.correlate(*PAIR, ground, method="simulation"),
    ],
    ids=["psd", "linearize", "correlate", "simulation"],
)
def test_a_filter_that_does_not_come_to_rest_is_refused(use, period):
    with pytest.raises(
        ValueError, match=r"Growing: motions of its filter grow with exp\(.* t\); allowed"
    ):
        use(Growing(period))


@pytest.mark.cli
@pytest.mark.slow
def test_a_case_file_takes_the_ground_by_its_name(toy, tmp_path):
    (tmp_path / "case.toml").write_text(CASE, encoding="utf-8")
    done = toy("gap", "case.toml")
    assert done.returncode == 0, done.stderr
    assert "should stand" in done.stdout
    (tmp_path / "case.toml").write_text(CASE.replace("hu_zhou", "moon"), encoding="utf-8")
    wrong = toy("gap", "case.toml")
    assert wrong.returncode == 2
    assert "hu_zhou" in wrong.stderr
