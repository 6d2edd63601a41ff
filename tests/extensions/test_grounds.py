"""A ground from outside, that of the documentation: in case files."""

import pytest

pytestmark = pytest.mark.cli


def done(result):
    assert result.returncode == 0, result.stderr
    return result.stdout


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
