"""A hysteresis law from outside: one class in one file, known to every command."""

from itertools import pairwise

import cases
import numpy as np
import pytest
import sympy
import xarray as xr
from scipy.integrate import dblquad

import stochlin as sl
from stochlin.models.laws import LAWS
from stochlin.models.symbolic import compiled

V, Z = sympy.symbols("v z")
SITE = {"damping": 0.05, "hardening": 0.1, "reduction_factor": 4}
# The same formulas on the same motions: quadrature agrees to 1e-12 or so, and the implicit steps of
# both end within 1e-12 of their solutions; loops that dissipate do not amplify that, and steps add
# up.
ROUNDING = 1e-9


def dahl(v, z, exponent):
    """The law of the page, written once more."""
    left = 1 - z * np.sign(v)
    return v * np.abs(left) ** exponent * np.sign(left)


def the_same(**structure):
    """The law of the page as a user writes it down without an extension, with its number in it."""
    left = 1 - Z * sympy.sign(V)
    return sl.Hysteretic(**structure, law=V * sympy.sign(left) * abs(left) ** 2)


CASE = f"""\
{cases.FIRM_SITE}[building_1]
law = "dahl"
period = "0.7 s"
damping = "5 %"
hardening = "10 %"
reduction_factor = 4
exponent = 2
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


@pytest.mark.oracle
@pytest.mark.parametrize("exponent", [1.0, 1.5, 2.0, 3.0])
@pytest.mark.parametrize("latent", [(1.0, 0.5, 0.3), (2.0, 1.2, -0.4), (0.6, 0.9, 0.7)])
def test_the_law_of_the_page_is_regressed_under_the_gaussian_density(example, exponent, latent):
    """By QUADPACK over the half plane ``v > 0`` twice, in parts between the kinks."""
    sv, sz, r = latent
    law = compiled(example("A hysteresis law", LAWS)(1.0, 0.05, 0.1).symbolic(), ("exponent",))

    def integrand(v, z, factor):
        square = (v / sv) ** 2 - 2 * r * v * z / (sv * sz) + (z / sz) ** 2
        density = np.exp(-square / (2 * (1 - r * r))) / (2 * np.pi * sv * sz * np.sqrt(1 - r * r))
        return (v - dahl(v, z, exponent)) * (v, z)[factor] * density

    accuracy = {"epsabs": 1e-13, "epsrel": 1e-12}
    edges = [*pairwise((-9 * sz, 0, 1, 9 * sz))]
    products = [
        2 * sum(dblquad(integrand, *edge, 0, 9 * sv, (factor,), **accuracy)[0] for edge in edges)
        for factor in (0, 1)
    ]
    expected = cases.regressed(products, sv * sv, sz * sz, r * sv * sz)
    column = np.array(latent)[:, None]
    found = law.gaussian(column, np.array([[exponent]])).coefficients[:, 0]
    np.testing.assert_allclose(found, expected, rtol=1e-10)


@pytest.mark.oracle
def test_the_first_power_of_the_law_of_the_page_is_a_bouc_wen_law(example):
    ground = sl.KanaiTajimi(0.8, 0.3, 0.02)
    friction = example("A hysteresis law", LAWS)(0.7, **SITE, exponent=1.0)
    known = sl.BoucWen(0.7, **SITE, beta=1.0, gamma=0.0)
    for name in ("displacement_std", "c_eq", "k_eq"):
        both = [float(sl.linearize(each, ground)[name]) for each in (friction, known)]
        assert both[0] == pytest.approx(both[1], rel=1e-9)


@pytest.mark.cli
@pytest.mark.slow
def test_gap_of_a_case_with_a_law_from_outside(toy, tmp_path):
    (tmp_path / "case.toml").write_text(CASE)
    done = toy("gap", "case.toml", "--out", "gap.nc")
    assert done.returncode == 0, done.stderr
    assert "eq_3_drift: no drift closure for Dahl" in done.stdout
    first = the_same(period=0.7, **SITE)
    second = sl.Bilinear(1.1, 0.05, 0.1, yield_displacement=0.02)
    firm = sl.named_ground("firm", intensity=0.01)
    expected = sl.separation(first, second, firm, 12.0, paths=128)
    with xr.open_dataset(tmp_path / "gap.nc") as table:
        ours = table.gap.sel(rule=expected.rule)  # without the rules from outside
        np.testing.assert_allclose(ours, expected.gap, rtol=ROUNDING)
        np.testing.assert_allclose(table.peak_mean_1, expected.peak_mean_1, rtol=ROUNDING)
