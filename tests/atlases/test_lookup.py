"""Cases looked up in an atlas."""

import numpy as np
import pytest
import scipy.interpolate
import xarray as xr
from commands import answered, refused

import stochlin as sl

pytestmark = pytest.mark.invariant

pytest.importorskip("zarr", reason="zarr is in the extra 'scale'")

SPEC = """
title = "A small atlas"
[parameters]
period_1 = { start = 0.2, stop = 5, count = 41, spacing = "log" }
period_2 = { start = 0.2, stop = 5, count = 41, spacing = "log" }
ground_damping = [0.05, 0.2]
damping_1 = 0.05
damping_2 = 0.05
hardening = [0.05, 0.1]
reduction_factor = 4
"""
GIVEN = {"ground_damping": 0.1, "hardening": 0.07}


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    folder = tmp_path_factory.mktemp("atlas")
    (folder / "spec.toml").write_text(SPEC)
    done = answered("atlas", folder / "spec.toml", "--out", folder / "a.zarr")
    assert "6724 cells" in done.output
    return folder / "a.zarr"


@pytest.fixture(scope="module")
def atlas(path):
    return sl.open_atlas(path)


def test_a_structure_that_does_not_vary_is_looked_up_too(tmp_path):
    spec = {"ground": "white_noise"}
    spec["parameters"] = {"period_1": [0.5, 1.0], "period_2": 0.7, "damping": 0.05}
    atlas = sl.write_atlas(spec, tmp_path / "a.zarr")
    found = sl.lookup(atlas, period_1=0.5)
    for name, variable in found.items():
        expected = atlas[name].isel(period_1=0, missing_dims="ignore")
        np.testing.assert_array_equal(variable, expected, err_msg=name)


def test_points_of_the_atlas_are_given_back(atlas):
    for name, variable in sl.lookup(
        atlas,
        period_1=float(atlas.period_1[3]),
        period_2=float(atlas.period_2[17]),
        ground_damping=0.2,
        hardening=0.05,
    ).items():
        at = {"period_1": 3, "period_2": 17, "ground_damping": 1, "hardening": 0}
        expected = atlas[name].isel({dim: at[dim] for dim in atlas[name].dims})
        np.testing.assert_allclose(variable, expected, rtol=1e-12, err_msg=name)
        assert variable.dtype == atlas[name].dtype
        assert variable.attrs == atlas[name].attrs


def test_between_them_it_is_scipys(atlas):
    rng = np.random.default_rng(11)
    n = 300
    case = {
        "period_1": rng.uniform(0.1, 6, n),
        "period_2": rng.uniform(0.3, 4, n),
        "ground_damping": rng.uniform(0.05, 0.2, n),
        "hardening": rng.uniform(0.05, 0.1, n),
    }
    found = sl.lookup(atlas, **case)
    dims = atlas.rho.dims
    expected = scipy.interpolate.RegularGridInterpolator(
        [np.log(atlas[dim].values) for dim in dims],
        atlas.rho.values,
        bounds_error=False,
        fill_value=np.nan,
    )(np.log(np.stack([case[dim] for dim in dims], axis=-1)))
    np.testing.assert_allclose(found.rho, expected, rtol=0, atol=1e-13)
    outside = np.isnan(expected)
    assert 10 < outside.sum() < 200
    np.testing.assert_array_equal(found.status == 3, outside)
    assert (found.caution.values[outside] == 2).all()
    # A structure's own variables know nothing of the other's period.
    np.testing.assert_array_equal(np.isnan(found.ductility_std_2), False)


def test_seconds_and_ratios_are_the_same(atlas):
    ratios = sl.lookup(atlas, period_1=0.7, period_2=1.0, **GIVEN)
    seconds = sl.lookup(atlas, ground_period=2.0, period_1=1.4, period_2=2.0, **GIVEN)
    xr.testing.assert_allclose(ratios, seconds, rtol=1e-12)
    exact = sl.correlate(
        sl.Bilinear(1.4, 0.05, 0.07, reduction_factor=4),
        sl.Bilinear(2.0, 0.05, 0.07, reduction_factor=4),
        sl.KanaiTajimi(2.0, 0.1),
    )
    assert float(seconds.rho) == pytest.approx(float(exact.rho), abs=0.03)


def test_arrays_broadcast_by_name(atlas):
    periods = xr.DataArray([0.5, 1.0, 2.0], dims="T", coords={"T": [0.5, 1.0, 2.0]})
    table = sl.lookup(atlas, period_1=periods, period_2=[0.7, 1.1], **GIVEN)
    assert dict(table.rho.sizes) == {"T": 3, "case": 2}
    np.testing.assert_array_equal(table["T"], [0.5, 1.0, 2.0])


PAIR = {"period_1": 1.0, "period_2": 1.0}


@pytest.mark.parametrize(
    ("parameters", "says"),
    [
        (PAIR | {"hardening": 0.05}, "ground_damping missing; this atlas needs"),
        (PAIR | GIVEN | {"colour": 1.0}, "colour unknown"),
        (PAIR | GIVEN | {"damping": 0.02}, "damping_1 is held at 0.05"),
        (PAIR | GIVEN | {"period_1": np.ones((2, 2))}, "2 dimensions"),
        (PAIR | GIVEN | {"period_1": [1.0, 2.0], "period_2": [1.0] * 3}, "share a dimension"),
    ],
)
def test_what_does_not_fit_is_refused(atlas, parameters, says):
    with pytest.raises(ValueError, match=says):
        sl.lookup(atlas, **parameters)
    with pytest.raises(TypeError, match="not a real number"):
        sl.lookup(atlas, **PAIR, ground_damping="soft", hardening=0.05)


def test_what_is_held_may_be_said(atlas):
    assert float(sl.lookup(atlas, **PAIR, **GIVEN, damping=0.05).rho) == pytest.approx(1, abs=1e-12)
    assert np.isnan(sl.lookup(atlas, **(PAIR | {"period_1": -1.0}), **GIVEN).rho)


def test_on_the_command_line(path):
    case = ("--period-1", "1.4s", "--period-2", "2s,2.2s", "--ground-period", "2s")
    options = ("--ground-damping", ".1", "--hardening", ".07")
    done = answered("lookup", path, *case, *options)
    rho = sl.lookup(sl.open_atlas(path), ground_period=2.0, period_1=1.4, period_2=[2, 2.2], **GIVEN).rho
    for value in rho.values:
        assert f"{value:.6g}" in done.output
    assert "Caution" in done.output
    for arguments, says in [
        ([str(path), *case], "ground_damping, hardening missing"),
        ([f"{path}er", *case], "is no atlas"),
    ]:
        assert says in refused("lookup", *arguments)


def test_bad_specifications_exit_with_2(tmp_path):
    spec = tmp_path / "spec.toml"
    for text, says in [
        ("[parameters]\nperiod_1 = 1", "period_2, ground"),
        ("colour = 1", "colour unknown"),
    ]:
        spec.write_text(text)
        assert says in refused("atlas", spec, "--out", tmp_path / "a.zarr")
        assert list(tmp_path.iterdir()) == [spec]
