"""The way of the textbooks: an 8 x 8 system, a general Lyapunov solver, a general root finder.

Roberts and Spanos (1990), Random vibration and statistical linearization, ch. 6.
"""

import cases
import numpy as np
import pytest
from scipy.optimize import root
from scipy.special import ndtr

import stochlin as sl

pytestmark = pytest.mark.oracle

NODES, WEIGHTS = np.polynomial.legendre.leggauss(120)


def conditional_coefficients(sv, sz, r):
    """``(1 + c_e, k_e)``, eqs. (9) and (10): a tail integral and the kick at ``z = 1``."""
    h, q = 1 / sz, np.sqrt(1 - r * r)
    t = h + 6 * (1 + NODES)  # from yielding up to twelve standard deviations beyond
    tail = 6 * WEIGHTS @ (np.exp(-0.5 * t * t) * ndtr(r * t / q)) / np.sqrt(2 * np.pi)
    mean, spread = r * sv / sz, sv * q
    bell = np.exp(-0.5 * (mean / spread) ** 2) / np.sqrt(2 * np.pi)
    kick = mean * ndtr(mean / spread) + spread * bell
    return 2 * tail, 2 * h * np.exp(-0.5 * h * h) / np.sqrt(2 * np.pi) * kick


def elastic_std(structure, filters, intensity):
    w, xi = structure["w"], structure["damping"]
    return np.sqrt(
        cases.lyapunov(cases.augmented_system([(w * w, 2 * xi * w)], filters), intensity)[0, 0]
    )


def textbook_solution(pair, filters, intensity):
    """Both structures in one system, in ductility; returns its covariance."""
    scale = [3 * elastic_std(s, filters, intensity) / s["reduction_factor"] for s in pair]  # uy

    def covariance(y):
        blocks = []
        for s, (log_slip, log_k) in zip(pair, y.reshape(2, 2), strict=True):
            w, alpha = s["w"], s["hardening"]
            blocks.append(
                (
                    w**2,
                    2 * s["damping"] * w,
                    (1 - alpha) * w**2,
                    np.exp(log_slip) - 1,
                    np.exp(log_k) * w,
                )
            )
        return cases.lyapunov(cases.augmented_system(blocks, filters), intensity)

    def implied(y):
        x, found = covariance(y), []
        for number, s in enumerate(pair):
            v, z = 3 * number + 1, 3 * number + 2
            sv, sz = np.sqrt(x[v, v]) / scale[number], np.sqrt(x[z, z]) / scale[number]
            slip, k = conditional_coefficients(sv, sz, x[v, z] / np.sqrt(x[v, v] * x[z, z]))
            found += [np.log(slip), np.log(k / s["w"])]
        return np.array(found)

    y = np.log([0.1, 0.1, 0.1, 0.1])
    for _ in range(20):  # damped substitution brings the root finder near
        y = 0.5 * (y + implied(y))
    solution = root(lambda y: implied(y) - y, y, tol=1e-13)
    assert np.abs(implied(solution.x) - solution.x).max() < 1e-9
    return covariance(solution.x), scale


def compare(rng, filters, ground, intensity):
    pair = [cases.draw_structure(rng, cases.PRACTICE) for _ in range(2)]
    table = sl.correlate(*(sl.Bilinear(**s) for s in pair), ground)
    x, uy = textbook_solution(
        [s | {"w": 2 * np.pi / s["period"]} for s in pair], filters, intensity
    )
    std = np.sqrt(np.diag(x)[[0, 3]])
    # The conditioning of the 8 x 8 solve and the root finder's own tolerance share these digits.
    assert float(table.rho) == pytest.approx(x[0, 3] / std.prod(), abs=1e-9)
    for number in (1, 2):
        found, yielding = table[f"displacement_std_{number}"], table[f"yield_displacement_{number}"]
        assert float(found) == pytest.approx(std[number - 1], rel=1e-8)
        assert float(yielding) == pytest.approx(uy[number - 1], rel=1e-10)


@pytest.mark.parametrize("seed", range(60))
def test_yielding_pair_on_kanai_tajimi_ground(seed):
    rng = np.random.default_rng([8, seed])
    soil = cases.draw_ground(rng, cases.PRACTICE)
    ground = sl.KanaiTajimi(**soil, intensity=0.02)
    compare(rng, (2 * np.pi / soil["period"], soil["damping"]), ground, 0.02)


@pytest.mark.parametrize("seed", range(10))
def test_yielding_pair_on_clough_penzien_ground(seed):
    rng = np.random.default_rng([9, seed])
    soil = cases.draw_ground(rng, cases.PRACTICE)
    layer = {
        "high_pass_period": cases.log_uniform(rng, (3.0, 20.0)),
        "high_pass_damping": rng.uniform(0.1, 1.2),
    }
    filters = (2 * np.pi / soil["period"], soil["damping"])
    filters += (2 * np.pi / layer["high_pass_period"], layer["high_pass_damping"])
    compare(rng, filters, sl.CloughPenzien(**soil, **layer, intensity=0.3), 0.3)


@pytest.mark.parametrize("seed", range(10))
def test_yielding_pair_under_white_noise(seed):
    rng = np.random.default_rng([10, seed])
    compare(rng, (), sl.WhiteNoise(1.7), 1.7)
