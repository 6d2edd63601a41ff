"""A ground from outside, that of the documentation: in case files."""

import pytest
from cases import FIRM_SITE, KIOSK

pytestmark = pytest.mark.cli

GROUND = """"two_layers"
period = "0.4 s"
damping = 0.6
layer_period = "1.1 s"
layer_damping = 0.2"""
CASE = FIRM_SITE.replace('"firm"', GROUND) + KIOSK.format(n=1) + KIOSK.format(n=2)
CASE += "[separation]\nconfidence = 0.9\n[simulation]\npaths = 128\n"


@pytest.mark.slow
def test_a_case_file_takes_the_ground_by_its_name(toy, tmp_path):
    (tmp_path / "case.toml").write_text(CASE, encoding="utf-8")
    done = toy("gap", "case.toml")
    assert done.returncode == 0, done.stderr
    assert "should stand" in done.stdout
    (tmp_path / "case.toml").write_text(CASE.replace("two_layers", "moon"), encoding="utf-8")
    wrong = toy("gap", "case.toml")
    assert wrong.returncode == 2
    assert "two_layers" in wrong.stderr
