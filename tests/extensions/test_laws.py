"""A hysteresis law from outside: one class in one file, known to every command."""

import tomllib

import cases
import numpy as np
import pytest
import sympy
import xarray as xr

import stochlin as sl

pytestmark = pytest.mark.cli

V, Z = sympy.symbols("v z")
TOLD = {"beta": 0.6, "gamma": 0.2, "pinching": 0.3, "sharpness": 5.0, "limit": 0.8}
SITE = {"damping": 0.05, "hardening": 0.1, "reduction_factor": 4}
# The same formulas on the same motions: quadrature agrees to 1e-12 or so, and the implicit steps of
# both end within 1e-12 of their solutions; loops that dissipate do not amplify that, and steps add up.
ROUNDING = 1e-9


def the_same(**structure):
    """The law of the page as a user writes it down without an extension, with these numbers in it."""
    slip = TOLD["beta"] * abs(V) * Z + TOLD["gamma"] * V * abs(Z)
    pinched = 1 - TOLD["pinching"] * sympy.exp(-TOLD["sharpness"] * Z**2)
    beyond = abs(V) * sympy.sign(Z) * sympy.Max(abs(Z) - TOLD["limit"], 0)
    return sl.Hysteretic(**structure, law=V - pinched * slip - beyond)


CASE = f"""\
{cases.FIRM_SITE}[building_1]
law = "pinched"
period = "0.7 s"
damping = "5 %"
hardening = "10 %"
reduction_factor = 4
beta = 0.6
gamma = 0.2
pinching = "30 %"
limit = 0.8
[building_2]
period = "1.1 s"
damping = "5 %"
hardening = "10 %"
yield_displacement = "2 cm"
[separation]
confidence = 0.9
[simulation]
paths = 128
"""


@pytest.mark.slow
def test_gap_of_a_case_with_a_law_from_outside(toy, tmp_path):
    (tmp_path / "case.toml").write_text(CASE)
    done = toy("gap", "case.toml", "--out", "gap.nc")
    assert done.returncode == 0, done.stderr
    assert "eq_3_drift: no drift closure for Pinched" in done.stdout
    told = tomllib.loads(CASE)
    assert told["building_1"]["law"] == "pinched"
    first = the_same(period=0.7, **SITE)
    second = sl.Bilinear(1.1, 0.05, 0.1, yield_displacement=0.02)
    firm = sl.named_ground("firm", intensity=0.01)
    expected = sl.separation(first, second, firm, 12.0, paths=128)
    with xr.open_dataset(tmp_path / "gap.nc") as table:
        ours = table.gap.sel(rule=expected.rule)  # without the rules from outside
        np.testing.assert_allclose(ours, expected.gap, rtol=ROUNDING)
        np.testing.assert_allclose(table.peak_mean_1, expected.peak_mean_1, rtol=ROUNDING)
