"""A ground from outside, that of the documentation: in commands, case files, the explorer."""

import numpy as np
import pytest
import scipy.linalg
import xarray as xr

pytestmark = pytest.mark.cli

SOIL = {"period": 0.4, "damping": 0.6, "layer_period": 1.1, "layer_damping": 0.2}
GROUND = ("--ground", "two-layers", "--ground-period", "0.4s", "--ground-damping", 0.6)
GROUND += ("--layer-period", "1.1s", "--layer-damping", 0.2)
PERIODS = (0.7, 1.0)
PAIR = ("--period-1", f"{PERIODS[0]}s", "--period-2", f"{PERIODS[1]}s")


def covariance(period_1, period_2, damping, soil):
    """Of ``u_1, v_1, u_2, v_2`` and the soil's four states, by the whole system's Lyapunov equation."""
    w, v = 2 * np.pi / soil["period"], 2 * np.pi / soil["layer_period"]
    d, e = 2 * soil["damping"] * w, 2 * soil["layer_damping"] * v
    matrix = np.zeros((8, 8))
    matrix[4:, 4:] = [[0, 1, 0, 0], [-(w**2), -d, 0, 0], [0, 0, 0, 1], [w**2, d, -(v**2), -e]]
    for at, period in ((0, period_1), (2, period_2)):
        own = 2 * np.pi / period
        matrix[at, at + 1] = 1
        matrix[at + 1, at : at + 2] = -(own**2), -2 * damping * own
        matrix[at + 1, 6:] = v**2, e
    noise = np.zeros((8, 8))
    noise[5, 5] = 2 * np.pi
    return scipy.linalg.solve_continuous_lyapunov(matrix, -noise)


def rho(period_1, period_2, damping=0.05, soil=SOIL):
    x = covariance(period_1, period_2, damping, soil)
    return x[0, 2] / np.sqrt(x[0, 0] * x[2, 2])


def done(result):
    assert result.returncode == 0, result.stderr
    return result.stdout


@pytest.mark.slow
def test_rho_by_linearization_and_by_simulation(toy, tmp_path):
    out = tmp_path / "table.nc"
    exact = rho(*PERIODS)
    done(toy("rho", *PAIR, *GROUND, "--out", out))
    with xr.open_dataset(out) as table:
        assert float(table.rho) == pytest.approx(exact, rel=1e-9)
        std = np.sqrt(np.diag(covariance(*PERIODS, 0.05, SOIL))[[0, 2]])
        found = [float(table.displacement_std_1), float(table.displacement_std_2)]
        np.testing.assert_allclose(found, std, rtol=1e-9)
    done(toy("rho", *PAIR, *GROUND, "--method", "simulation", "--paths", 256, "--out", out))
    with xr.open_dataset(out) as table:
        assert abs(float(table.rho) - exact) < 4 * float(table.rho_standard_error)
        assert float(table.rho_standard_error) < 0.02


CASE = """
title = "Two layers"
[site]
ground = "two_layers"
period = "0.4 s"
damping = 0.6
layer_period = "1.1 s"
layer_damping = 0.2
intensity = "0.01 m^2/s^3"
[motion]
duration = "20 s"
envelope = "amin_ang"
rise_end = "4 s"
strong_end = "15 s"
decay = "0.35 1/s"
[building_1]
name = "left"
period = "0.7 s"
damping = 0.05
hardening = 0.05
reduction_factor = 4
[building_2]
name = "right"
period = "1 s"
damping = 0.05
hardening = 0.05
reduction_factor = 4
[separation]
confidence = 0.9
[simulation]
paths = 256
seed = 1
"""


@pytest.mark.slow
def test_a_case_file_takes_the_ground_by_its_name(toy, tmp_path):
    (tmp_path / "case.toml").write_text(CASE, encoding="utf-8")
    text = done(toy("gap", "case.toml"))
    assert "left and right should stand" in text
    (tmp_path / "case.toml").write_text(CASE.replace("two_layers", "moon"), encoding="utf-8")
    wrong = toy("gap", "case.toml")
    assert wrong.returncode == 2
    assert "two_layers" in wrong.stderr
