"""Eqs. (9) and (10) by themselves: known values, integration, ends of the loop, and refusals."""

import cases
import numpy as np
import pytest
import sympy
import xarray as xr

import stochlin as sl

pytestmark = [pytest.mark.oracle, pytest.mark.extreme]

V, Z = sympy.symbols("v z")


@pytest.mark.parametrize(("moments", "c_eq", "k_eq"), cases.KNOWN_COEFFICIENTS)
def test_bilinear_coefficients(moments, c_eq, k_eq):
    """To all printed digits."""
    found = sl.equivalent_coefficients(*moments)
    assert float(found.c_eq) == pytest.approx(c_eq, abs=5.1e-11)
    assert float(found.k_eq) == pytest.approx(k_eq, abs=5.1e-11)


@pytest.mark.parametrize(
    ("exponent", "c_eq", "k_eq"),
    [(1, -0.7406875177, 0.5186249645), (2, -0.8279797081, 0.4827442838)],
)
def test_bouc_wen_coefficients(exponent, c_eq, k_eq):
    found = sl.equivalent_coefficients(1, 0.5, 0.3, "bouc_wen", exponent=exponent)
    assert float(found.c_eq) == pytest.approx(c_eq, abs=5.1e-11)
    assert float(found.k_eq) == pytest.approx(k_eq, abs=5.1e-11)


def test_tables_by_dimension_name_and_cells_that_cannot_be():
    z_std = xr.DataArray([0.3, 0.9, 1.2, -1.0], dims="z")
    corr = xr.DataArray([0.1, 0.999], dims="corr")
    table = sl.equivalent_coefficients(2.0, z_std, corr)
    assert table.c_eq.sizes == {"z": 4, "corr": 2}
    assert table.status.values.tolist() == [[0, 0], [0, 0], [0, 0], [3, 3]]
    assert np.isnan(table.k_eq.values[3:]).all()
    alone = sl.equivalent_coefficients(2.0, 0.9, 0.1)
    assert float(table.c_eq[1, 0]) == float(alone.c_eq)
    assert table.k_eq.attrs["units"] == "1/s"


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"velocity_z_corr": 1.0}, "velocity_z_corr = 1 is out of range; allowed: -1 < value < 1"),
        ({"law": "other"}, "law = 'other' is not a known law; allowed: bilinear"),
        ({"law": "hysteretic"}, "give the sympy expression"),
        ({"law": V * Z**2}, r"law = v\*z\*\*2 leaves z at 0, .*; allowed: G\(v, 0\) = v"),
        (
            {"law": V * sympy.Integral(sympy.cos(Z), (Z, 0, Z))},
            "has 'Integral.*, which has no numeric",
        ),
        ({"law": V * sympy.Integer(10) ** 400}, "has '1000"),
        ({"law": V * sympy.oo}, "has 'oo', which has no numeric form; allowed: numbers below"),
        ({"exponent": 2.0}, "the law has no exponent; allowed: none"),
        ({"law": "bouc_wen", "exponent": 0.5}, "exponent = 0.5 is out of range"),
    ],
)
def test_what_cannot_be_is_said(change, message):
    given = {"velocity_std": 1.0, "z_std": 0.5, "velocity_z_corr": 0.3} | change
    with pytest.raises(ValueError, match=message):
        sl.equivalent_coefficients(**given)


def test_no_part_of_a_law_is_run_as_code(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    name = "__import__('pathlib').Path('written').touch() or (lambda z: z)"
    with pytest.raises(ValueError, match="which has no numeric form; allowed"):
        sl.Hysteretic(
            1.0, 0.05, 0.05, yield_displacement=0.02, law=V * sympy.Function(name)(Z) ** 2
        )
    assert not list(tmp_path.iterdir())
