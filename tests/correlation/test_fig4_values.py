"""Correlation beyond eq. (4): narrow-banded ground and yielding, at the points of Figs. 3 to 5."""

import numpy as np
import pytest

import stochlin as sl

pytestmark = pytest.mark.paper


def oscillator(frequency, damping, **strength):
    return sl.Bilinear(period=2 * np.pi / frequency, damping=damping, **strength)


def kanai_tajimi(frequency, damping, intensity=1.0):
    return sl.KanaiTajimi(period=2 * np.pi / frequency, damping=damping, intensity=intensity)


@pytest.mark.parametrize(
    ("xi_1", "xi_2", "w_1", "w_2", "wg", "xig", "rho"),
    [
        (0.05, 0.05, 1, 0.5, 1, 0.05, -0.0337777317),
        (0.05, 0.05, 2, 1, 1, 0.05, 0.0888759886),
        (0.05, 0.05, 1.5, 2, 1, 0.05, 0.8360166761),
        (0.02, 0.05, 4, 6, 15, 0.6, 0.0231399115),
        (0.05, 0.05, 4, 6, 5, 0.2, -0.0954773332),
    ],
)
def test_elastic_pairs_on_kanai_tajimi_ground(xi_1, xi_2, w_1, w_2, wg, xig, rho):
    pair = oscillator(w_1, xi_1), oscillator(w_2, xi_2)
    # Ten digits are known: half a unit of the last one.
    assert float(sl.correlate(*pair, kanai_tajimi(wg, xig)).rho) == pytest.approx(rho, abs=5e-11)


@pytest.mark.parametrize(
    ("xi", "alpha", "strength_ratio", "known"),
    [
        (
            0.05,
            0.05,
            1,
            {
                "ductility_std": 0.87074544,
                "velocity_std": 0.67949976,
                "z_std": 0.64331539,
                "velocity_z_corr": 0.12961983,
                "c_eq": -0.92768438,
                "k_eq": 0.12700975,
            },
        ),
        (
            0.02,
            0.10,
            2,
            {
                "ductility_std": 1.09833794,
                "velocity_std": 0.86066808,
                "z_std": 0.77496614,
                "velocity_z_corr": 0.21717848,
            },
        ),
    ],
)
def test_bilinear_oscillator_under_white_noise(xi, alpha, strength_ratio, known):
    ground = sl.WhiteNoise(2 * xi * strength_ratio**2 / np.pi)  # so that sigma_el = Rs uy at w = 1
    structure = oscillator(1.0, xi, hardening=alpha, yield_displacement=1.0)
    table = sl.linearize(structure, ground)
    for name, value in known.items():
        assert float(table[name]) == pytest.approx(value, abs=5.01e-9), (
            name
        )  # eight digits are known


@pytest.mark.parametrize(
    ("ground", "rho"),
    [
        (sl.WhiteNoise(1.0), 0.70875953),
        (kanai_tajimi(1.0, 0.05), 0.69646878),
    ],
    ids=["white noise", "narrow band, second structure at half the ground frequency"],
)
def test_yielding_pair_at_period_ratio_seven_tenths(ground, rho):
    strength = {"hardening": 0.05, "reduction_factor": 4.0}  # R = 4 is sigma_el/uy = 4/3
    w_2 = 0.5
    pair = oscillator(w_2 / 0.7, 0.05, **strength), oscillator(w_2, 0.05, **strength)
    assert float(sl.correlate(*pair, ground).rho) == pytest.approx(rho, abs=5.01e-9)
